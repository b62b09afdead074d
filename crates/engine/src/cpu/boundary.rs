//! Stage `boundary`: gravity, and the work of prescribed motion.

use super::bodies::Quad;
use super::predict::optional;
use super::{CHUNK, Cpu};
use crate::energy_accounts::EXTERNAL;
use rayon::prelude::*;
use tdem_physics::Vec3;

impl Cpu {
    /// Adds gravity to all particles and books what it takes to hold prescribed components.
    pub(super) fn boundary_all(&mut self) {
        let gravity: Vec3<f64> = self.plan.gravity.into();
        let (constraints, step, ledger) = (&self.plan.constraints, self.history_step, self.plan.ledger);
        let bodies = &mut self.bodies;
        (
            bodies.force.par_chunks_mut(CHUNK),
            bodies.motion.par_chunks(CHUNK),
            bodies.constraint.par_chunks(CHUNK),
            optional(&mut bodies.moment),
            optional(&mut bodies.accounts),
        )
            .into_par_iter()
            .for_each(|(force, motion, constraint, moment, accounts)| {
                for i in 0..force.len() {
                    let total = force[i].vector() + gravity * motion[i].scalar();
                    force[i].set_vector(total);
                    if ledger && constraint[i] != 0 {
                        let constraint = &constraints[usize::from(constraint[i])];
                        accounts[i][EXTERNAL] -= power(&force[i], &constraint.velocity) * step;
                        if let Some(moment) = moment.get(i) {
                            accounts[i][EXTERNAL] -= power(moment, &constraint.angular_velocity) * step;
                        }
                    }
                }
            });
    }
}

/// Power of the forces on prescribed components, W.
fn power(force: &Quad, prescribed: &[Option<f64>; 3]) -> f64 {
    (0..3).map(|k| force.0[k] * prescribed[k].unwrap_or(0.0)).fold(0.0, |sum, term| sum + term)
}
