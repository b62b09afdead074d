//! Where the heat is, where it went, and whether the sum closes.

use super::extremes;
use crate::exact::exact_sums;
use crate::heat_accounts::{IN, MADE, OUT};
use crate::{Plan, State};

/// Heat of one instant, as a row of `history.csv` shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatLedger {
    /// Time of the heat, s.
    pub time: f64,
    /// $\sum mc(T - T_0)$, or $\sum m\int_{T_0}^Tc\,dT$, less that at the start, J; where heat goes along with the motion, what is under way into the next
    /// step is included.
    pub stored: f64,
    /// Came in through surfaces and walls and by prescribed temperatures since the start, J.
    pub came_in: f64,
    /// Left through them since the start, J.
    pub went_out: f64,
    /// Made by friction and dashpots since the start, J: energy of the motion that became heat.
    pub made: f64,
    /// What the ledger does not explain: stored - in + out - made, J; 0 without ledger.
    pub error: f64,
    /// Lowest temperature, K.
    pub lowest: f64,
    /// Mean temperature over all particles, K.
    pub mean: f64,
    /// Highest temperature, K.
    pub highest: f64,
}

impl HeatLedger {
    /// Takes stock of a state; `None` without heat. Sums over particles are exact.
    #[must_use]
    pub fn of(state: &State, plan: &Plan) -> Option<HeatLedger> {
        plan.heat.as_ref()?;
        let [came_in, went_out, made] =
            exact_sums(state.heat_accounts.len(), |i| [IN, OUT, MADE].map(|column| state.heat_accounts[i][column]));
        let stored = state.heat(plan) - state.initial_heat;
        let [total] = exact_sums(state.len(), |i| [state.temperature[i]]);
        let [lowest, highest] = extremes(&state.temperature);
        let booked = plan.ledger && state.heat_accounts.len() == state.len();
        Some(HeatLedger {
            time: plan.heat_time(state.step),
            stored,
            came_in,
            went_out,
            made,
            error: if booked { stored - came_in + went_out - made } else { 0.0 },
            lowest,
            mean: total / state.len().max(1) as f64,
            highest,
        })
    }
}

impl State {
    /// $\sum m\int_{T_0}^Tc\,dT$, J; 0 without heat. Where heat goes along with the motion, with what is under way into the next
    /// step: accounts are booked with heat rates, which that step follows.
    pub(crate) fn heat(&self, plan: &Plan) -> f64 {
        let Some(heat) = &plan.heat else { return 0.0 };
        let step = if heat.motion.takes_turns() { 0.0 } else { plan.heat_step() };
        let [total] = exact_sums(self.len(), |i| {
            let (material, reference) = (self.material[i], heat.reference_temperature);
            let warmth = heat.heat_between(material, self.mass[i], reference, self.temperature[i]);
            [warmth + self.heat_rate[i] * step]
        });
        total
    }
}
