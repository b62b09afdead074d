//! What particles do while heat goes on: heat and motion have times that differ by many orders of magnitude.

use crate::{Fault, HeatPlan, Plan};

/// What particles do while heat goes on.
///
/// A step of a simulation is one of the motion where heat goes along with it, else one of the heat: then
/// [`Plan::dt`] is a step of the heat, and the time of a simulation is the time of the heat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Motion {
    /// They move: in every step of the motion heat goes on by [`HeatPlan::time_scale`] times as long.
    #[default]
    Stepped,
    /// They stay where they are, as large as they are, and only heat goes on; nothing may expand.
    Frozen(Scheme),
    /// After every step of the heat they move until they are at rest again.
    QuasiStatic(Relaxation),
}

/// How heat advances through bonds and contacts that stay as they are during a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// By Euler's rule, $T \leftarrow T + \Delta t\,Q(T)/(mc)$: as where heat goes along with the motion. A step that is too
    /// long is taken in equal parts, the fewest that do not exceed the least $mc/\sum H$ of a particle.
    Explicit,
    /// By the backward rule of Euler, $T_{n+1} = T_n + \Delta t\,Q(T_{n+1})/(mc)$, stable with any step, right to first order
    /// in it. Radiation is linear in a step, as it is at the temperatures of its beginning.
    Implicit,
}

/// How heat and motion take turns: heat advances by one step while nothing moves; then particles move while no heat flows,
/// until they are at rest.
///
/// They are at rest when the resultant force on a particle, in the mean, is at most `ratio` times the force of a contact or
/// bond, in the mean; both are those of [`crate::Ledger::unbalanced_force_ratio`]. Where forces are small, as in a body that
/// expands freely, what bonds would bear if they were held and became 1 K warmer stands in their place.
///
/// Nothing but dashpots, friction and [`crate::BondPlan::local_damping`] takes motion away: without them there is no rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxation {
    /// How heat advances in its turn.
    pub scheme: Scheme,
    /// $\Delta t$ of the motion, s.
    pub dt: f64,
    /// The ratio of forces at which particles count as being at rest, positive.
    pub ratio: f64,
    /// Steps of the motion after which heat goes on in any case, counted anew whenever bonds broke. That particles were
    /// not at rest is counted in [`crate::Turns::unrelaxed`].
    pub at_most_steps: u64,
    /// Steps of the motion between two looks at the forces.
    pub check_every: u64,
}

impl Motion {
    /// Whether a step of the simulation is one of the heat.
    #[must_use]
    pub fn takes_turns(&self) -> bool {
        !matches!(self, Motion::Stepped)
    }
    /// How heat advances by itself; `None` where it goes along with the motion.
    #[must_use]
    pub fn scheme(&self) -> Option<Scheme> {
        match self {
            Motion::Stepped => None,
            Motion::Frozen(scheme) | Motion::QuasiStatic(Relaxation { scheme, .. }) => Some(*scheme),
        }
    }

    /// Checks that numbers are in range and that nothing is asked for that means nothing.
    pub(crate) fn validate(&self, plan: &Plan, heat: &HeatPlan) -> Result<(), Fault> {
        let check = |holds: bool, what| if holds { Ok(()) } else { Err(Fault::Inconsistent { what }) };
        let positive = |number: f64| number.is_finite() && number > 0.0;
        if !self.takes_turns() {
            return Ok(());
        }
        check(positive(plan.dt), "a step of the heat is positive")?;
        check(heat.time_scale == 1.0, "heat that advances by itself has no other time: its time scale is 1")?;
        match self {
            Motion::Stepped => Ok(()),
            Motion::Frozen(_) => check(!heat.expands(), "where nothing moves, nothing expands"),
            Motion::QuasiStatic(relaxation) => {
                check(positive(relaxation.dt), "a step of the motion is positive")?;
                check(positive(relaxation.ratio), "the ratio of forces at rest is positive")?;
                check(
                    relaxation.at_most_steps > 0 && relaxation.check_every > 0,
                    "particles are given steps to come to rest, and are looked at",
                )?;
                let stands = |velocity: &f64| *velocity == 0.0;
                let held = plan.constraints.iter().all(|constraint| {
                    constraint.velocity.iter().chain(&constraint.angular_velocity).flatten().all(stands)
                });
                let walls = plan.walls.iter().all(|wall| wall.velocity.iter().all(stands));
                check(
                    held && walls && plan.ramps.is_empty(),
                    "what comes to rest after every step of the heat is not driven: prescribed velocities and those of \
                     walls are zero, and nothing follows a ramp",
                )
            }
        }
    }
}
