//! What stands around particles during a step: temperatures of walls, outside values of surfaces, prescribed temperatures.

use crate::{HeatPlan, Scheme};
use tdem_physics::heat::Outside;

/// A stretch of the time of the heat, s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub(crate) from: f64,
    pub(crate) until: f64,
}

impl Span {
    /// One of so many equal parts, counted from 0.
    pub(crate) fn part(self, part: u64, parts: u64) -> Span {
        let at = |k: u64| match k {
            0 => self.from,
            k if k == parts => self.until,
            k => self.from + (self.until - self.from) * (k as f64 / parts as f64),
        };
        Span { from: at(part), until: at(part + 1) }
    }
    fn middle(self) -> f64 {
        0.5 * (self.from + self.until)
    }
}

/// What stands around particles in a step.
///
/// | | explicit | implicit |
/// |---|---|---|
/// | walls | beginning | end |
/// | outside temperatures | middle | end |
/// | fluxes | middle | middle |
/// | prescribed temperatures | end | end |
///
/// So the explicit scheme has the values of a step of the motion, and with the implicit one a body follows outside
/// temperatures that change evenly without a lag of the step, and a flux that does brings what it says.
#[derive(Default)]
pub(crate) struct Surroundings {
    /// Temperatures of walls, K, `(walls)`; those of insulated ones are not used.
    pub(crate) walls: Vec<f64>,
    /// Outside values of the exchanges of each exposure; none where temperatures are prescribed.
    pub(crate) outside: Vec<Vec<Outside<f64>>>,
    /// Prescribed temperatures of each exposure, K.
    pub(crate) prescribed: Vec<Option<f64>>,
}

impl Surroundings {
    pub(crate) fn during(span: Span, scheme: Scheme, heat: &HeatPlan) -> Self {
        let (walls, temperatures) = match scheme {
            Scheme::Explicit => (span.from, span.middle()),
            Scheme::Implicit => (span.until, span.until),
        };
        Surroundings {
            walls: heat.walls.iter().map(|wall| wall.as_ref().map_or(0.0, |course| course.value(walls))).collect(),
            outside: heat.exposures.iter().map(|exposure| exposure.outside(span.middle(), temperatures)).collect(),
            prescribed: heat
                .exposures
                .iter()
                .map(|exposure| exposure.temperature.as_ref().map(|course| course.value(span.until)))
                .collect(),
        }
    }
}
