//! Stage `boundary`: gravity, applied forces, local damping, and the work of applied forces and prescribed motion.

use super::bodies::Quad;
use super::correct::hold;
use super::predict::optional;
use super::{CHUNK, Cpu};
use crate::energy_accounts::{DAMPING, EXTERNAL};
use rayon::prelude::*;
use tdem_physics::Vec3;
use tdem_physics::motion::{local_damping, sphere_inertia};

impl Cpu {
    /// Adds gravity and applied forces to all particles, damps them, and books what it takes to hold and to drive prescribed
    /// components, and what applied forces do on the way of the step.
    pub(super) fn boundary_all(&mut self) {
        let gravity: Vec3<f64> = self.plan.gravity.into();
        let (plan, step, ledger) = (&self.plan, self.history_step, self.plan.ledger);
        let constraints = plan.constraints_at(self.time());
        let former = plan.constraints_at(plan.time(self.step.saturating_sub(1)));
        let (applied, ramped, moments) = (plan.applies_forces(), !plan.ramps.is_empty(), plan.law.moments);
        let local_damping = self.plan.bonds.as_ref().map_or(0.0, |bonds| bonds.local_damping);
        let bodies = &mut self.bodies;
        (
            bodies.force.par_chunks_mut(CHUNK),
            (bodies.place.par_chunks(CHUNK), bodies.motion.par_chunks(CHUNK)),
            bodies.spin.par_chunks(CHUNK),
            bodies.constraint.par_chunks(CHUNK),
            optional(&mut bodies.moment),
            optional(&mut bodies.accounts),
            optional(&mut bodies.kick),
            optional(&mut bodies.twist),
        )
            .into_par_iter()
            .for_each(|(force, (place, motion), spin, constraint, moment, accounts, kick, twist)| {
                for i in 0..force.len() {
                    let constrained = constraint[i] != 0;
                    let [constraint, before] = [&constraints, &former].map(|table| &table[usize::from(constraint[i])]);
                    let mut total = force[i].vector() + gravity * motion[i].scalar();
                    if applied {
                        total = total + constraint.force.into();
                    }
                    force[i].set_vector(total);
                    if local_damping > 0.0 {
                        let [kick, twist] = [&*kick, &*twist].map(|k| k.get(i).copied().unwrap_or_default().vector());
                        let velocity = motion[i].vector();
                        let mut taken = damp(&mut force[i], velocity, kick, &constraint.velocity, local_damping);
                        if let Some(moment) = moment.get_mut(i) {
                            let (velocity, prescribed) = (spin[i].vector(), &constraint.angular_velocity);
                            taken += damp(moment, velocity, twist, prescribed, local_damping);
                        }
                        if ledger {
                            accounts[i][DAMPING] += taken * step;
                        }
                    }
                    if ledger && constrained {
                        let external = &mut accounts[i][EXTERNAL];
                        *external -= power(&force[i], &constraint.velocity) * step;
                        if let Some(moment) = moment.get(i) {
                            *external -= power(moment, &constraint.angular_velocity) * step;
                        }
                        if ramped {
                            let mass = motion[i].scalar();
                            *external += gain(mass, [&before.velocity, &constraint.velocity]);
                            if moments {
                                let inertia = sphere_inertia(mass, place[i].scalar());
                                *external += gain(inertia, [&before.angular_velocity, &constraint.angular_velocity]);
                            }
                        }
                        if applied {
                            let mean = (Vec3::from(before.force) + constraint.force.into()) * 0.5;
                            *external += mean.dot(motion[i].vector()) * step;
                        }
                    }
                }
            });
    }
}

/// Damps a force or moment in the components that it governs, and tells the power that this takes, W: at the velocity of
/// the end of the step as well as it is known, which is `velocity` and once more its last change, `kick`.
#[inline(always)]
fn damp(
    force: &mut Quad,
    velocity: Vec3<f64>,
    kick: Vec3<f64>,
    prescribed: &[Option<f64>; 3],
    coefficient: f64,
) -> f64 {
    let whole = force.vector();
    let damped = hold(local_damping::damped(whole, velocity, coefficient), whole, prescribed);
    force.set_vector(damped);
    (whole - damped).dot(velocity + kick)
}

/// What prescribed components gained in kinetic energy since the step before, J.
fn gain(inertia: f64, [before, now]: [&[Option<f64>; 3]; 2]) -> f64 {
    let square = |k: usize| match (before[k], now[k]) {
        (Some(before), Some(now)) => (now - before) * (now + before),
        _ => 0.0,
    };
    0.5 * inertia * (0..3).map(square).fold(0.0, |sum, term| sum + term)
}

/// Power of the forces on prescribed components, W.
fn power(force: &Quad, prescribed: &[Option<f64>; 3]) -> f64 {
    (0..3).map(|k| force.0[k] * prescribed[k].unwrap_or(0.0)).fold(0.0, |sum, term| sum + term)
}
