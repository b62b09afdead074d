//! Stage `correct`: velocities at the end of the step.

use super::bodies::trajectory;
use super::predict::optional;
use super::{CHUNK, Cpu};
use crate::Integrator;
use crate::plan::prescribe;
use rayon::prelude::*;
use tdem_physics::Vec3;
use tdem_physics::motion::{gear, sphere_inertia, verlet};

impl Cpu {
    /// Corrects all particles by the forces of the end of the step.
    pub(super) fn correct_all(&mut self) {
        let dt = self.plan.dt;
        let constraints = self.plan.constraints_at(self.time());
        let (integrator, moments) = (self.plan.integrator, self.plan.law.moments);
        let bodies = &mut self.bodies;
        (
            bodies.place.par_chunks_mut(CHUNK),
            bodies.motion.par_chunks_mut(CHUNK),
            bodies.spin.par_chunks_mut(CHUNK),
            bodies.force.par_chunks(CHUNK),
            bodies.constraint.par_chunks(CHUNK),
            optional(&mut bodies.derivatives),
            optional(&mut bodies.moment),
        )
            .into_par_iter()
            .for_each(|(place, motion, spin, force, constraint, derivatives, moment)| {
                for i in 0..place.len() {
                    let constraint = &constraints[usize::from(constraint[i])];
                    let mass = motion[i].scalar();
                    // Euler's rule for rotation under Gear is the paper's.
                    let spin_step = match integrator {
                        Integrator::VelocityVerlet => {
                            let kicked = verlet::kick(motion[i].vector(), force[i].vector(), mass, 0.5 * dt);
                            motion[i].set_vector(prescribe(kicked, &constraint.velocity));
                            0.5 * dt
                        }
                        Integrator::Gear => {
                            let predicted = trajectory(&place[i], &motion[i], &derivatives[i]);
                            let corrected = gear::correct(&predicted, force[i].vector(), mass, dt);
                            let free =
                                |corrected: Vec3<f64>, held: Vec3<f64>| hold(corrected, held, &constraint.velocity);
                            place[i].set_vector(free(corrected.position, predicted.position));
                            motion[i].set_vector(prescribe(corrected.velocity, &constraint.velocity));
                            derivatives[i] = corrected.derivatives.map(|d| free(d, Vec3::zero()).into());
                            dt
                        }
                    };
                    if moments {
                        let inertia = sphere_inertia(mass, place[i].scalar());
                        let kicked = verlet::kick(spin[i].vector(), moment[i].vector(), inertia, spin_step);
                        spin[i].set_vector(prescribe(kicked, &constraint.angular_velocity));
                    }
                }
            });
    }
}

/// `held` in the components that are prescribed, `free` in the others.
#[inline(always)]
pub(super) fn hold(free: Vec3<f64>, held: Vec3<f64>, prescribed: &[Option<f64>; 3]) -> Vec3<f64> {
    let one = |free, held, prescribed: Option<f64>| if prescribed.is_some() { held } else { free };
    Vec3 {
        x: one(free.x, held.x, prescribed[0]),
        y: one(free.y, held.y, prescribed[1]),
        z: one(free.z, held.z, prescribed[2]),
    }
}
