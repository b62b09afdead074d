//! The motion's turn: particles move, while no heat flows, until they are at rest.

use super::Staggered;
use crate::exact::exact_sums;
use crate::heat_accounts::EXPANSION;
use crate::ledger::{Imbalance, elastic_energy};
use crate::{Exposure, Fault, HeatPlan, Motion, Plan, Relaxation, State};
use std::sync::Arc;
use tdem_physics::heat::Path;

/// How much warmer bonds are thought to become to say which forces are small, K.
const WARMTH: f64 = 1.0;

/// A plan of the motion alone: temperatures are there, because bodies expand, but no heat flows. Where nothing moves a step
/// takes no time.
pub(crate) fn without_heat(plan: &Plan) -> Plan {
    let still = |heat: &HeatPlan| HeatPlan {
        time_scale: 0.0,
        contacts: Path::Closed,
        exposures: vec![Exposure::default(); heat.exposures.len()],
        walls: vec![None; heat.walls.len()],
        motion: Motion::Stepped,
        ..heat.clone()
    };
    let dt = relaxation(plan).map_or(0.0, |relaxation| relaxation.dt);
    Plan { dt, heat: plan.heat.as_ref().map(still), gauges: Vec::new(), ..plan.clone() }
}

/// How particles come to rest; `None` where nothing moves.
fn relaxation(plan: &Plan) -> Option<Relaxation> {
    match plan.heat.as_ref()?.motion {
        Motion::QuasiStatic(relaxation) => Some(relaxation),
        Motion::Stepped | Motion::Frozen(_) => None,
    }
}

/// A state behind the motion's turn, in which nobody follows the work of expansion from step to step.
pub(super) fn at_rest(state: State) -> State {
    State { work_per_kelvin: Vec::new(), ..state }
}

impl Staggered {
    /// Energy in all springs, J, if the ledger follows the work of expansion and particles move at all.
    pub(super) fn elastic_energy(&self) -> Option<f64> {
        let follows = self.plan.books_expansion() && relaxation(&self.plan).is_some();
        follows.then(|| elastic_energy(&self.state, &self.plan))
    }

    /// Lets radii follow temperatures before anything moves, and books what that put into springs, from their energy before
    /// temperatures changed. The account is one of all particles; it is kept with the first.
    pub(super) fn expand(&mut self, before: Option<f64>) -> Result<(), Fault> {
        if relaxation(&self.plan).is_none() {
            return Ok(());
        }
        self.state.temperature = self.field.temperatures()?;
        self.shrunk = self.state.follow_temperatures(&self.plan);
        if let Some(before) = before {
            self.field.book(EXPANSION, elastic_energy(&self.state, &self.plan) - before);
        }
        Ok(())
    }

    /// Lets particles move until they are at rest under the present temperatures. Whether anything may have moved.
    ///
    /// The back end is opened anew: it goes on from a state to the same bits as if it had never been closed.
    pub(super) fn relax(&mut self) -> Result<bool, Fault> {
        let Some(relaxation) = relaxation(&self.plan) else { return Ok(false) };
        let mut plan = without_heat(&self.plan);
        let begun = self.state.step;
        let state = std::mem::take(&mut self.state);
        // Pairs that touched are listed although they have shrunk: the contact stage closes their histories.
        plan.search.skin = plan.search.skin.max(2.001 * self.shrunk);
        let pool = Arc::clone(&self.pool);
        let small = pool.install(|| thermal_force(&state, &plan));
        let mut broken = state.bonds.iter().filter(|bond| !bond.holds()).count();
        let fault = |fault: Fault| fault.at(begun + 1, self.plan.time(begun + 1));
        let mut motion = self.device.open(state, &plan).map_err(fault)?;
        let mut taken = 0;
        self.state = loop {
            let steps = relaxation.check_every.min(relaxation.at_most_steps - taken);
            motion.advance(steps).map_err(fault)?;
            self.turns.motion_steps += steps;
            taken += steps;
            let state = at_rest(motion.capture()?.state()?);
            let now = state.bonds.iter().filter(|bond| !bond.holds()).count();
            if now > broken {
                (broken, taken) = (now, 0);
                continue;
            }
            let ratio = pool.install(|| Imbalance::of(&state, &plan)).ratio(small);
            if ratio <= relaxation.ratio {
                break state;
            }
            if taken >= relaxation.at_most_steps {
                self.turns.unrelaxed += 1;
                self.turns.last_unrelaxed = begun + 1;
                self.turns.largest_ratio = self.turns.largest_ratio.max(ratio);
                break state;
            }
        };
        self.searches += motion.searches();
        self.motion_bytes = motion.bytes();
        // Whatever broke, did so in this step of the heat.
        for breakage in self.state.bonds.iter_mut().filter_map(|bond| bond.breakage.as_mut()) {
            breakage.step = breakage.step.min(begun + 1);
        }
        self.state.step = begun;
        // They are kept where heat flows.
        self.state.heat_accounts = Vec::new();
        Ok(true)
    }
}

/// What bonds would bear, in the mean, if they were held and became a little warmer, N; 0 without bonds.
fn thermal_force(state: &State, plan: &Plan) -> f64 {
    let [force] = exact_sums(state.bonds.len(), |k| [thermal_force_of(state, plan, k).unwrap_or(0.0)]);
    force / state.bonds.len().max(1) as f64
}

/// The same of one bond; `None` if it has no numbers.
fn thermal_force_of(state: &State, plan: &Plan, bond: usize) -> Option<f64> {
    let (i, j) = (state.index_of(state.bonds[bond].first)?, state.index_of(state.bonds[bond].second)?);
    let offset = state.bonded_offset(plan, i, j);
    let length = offset.dot(offset).sqrt();
    let stiffness = state.bond_numbers(plan, [i, j], 1.0)?.stiffness.normal;
    let free_strain = state.link(plan, i, j)?.free_strain(WARMTH, WARMTH);
    Some((stiffness * free_strain * length).abs())
}
