//! How long a run lasts and when it writes.

use crate::codes;
use crate::load::Loaded;
use crate::problem::{Problem, number};
use crate::schema::{Case, Output, Positive, Precision};
use tdem_engine::Schedule;

/// Frames after the first, if the case does not say.
const FRAMES: u32 = 50;
/// Pictures of each kind after the first, if the case does not say.
const PICTURES: u32 = 4;
/// Rows of the history after the first, if the case does not say.
const HISTORY_ROWS: f64 = 1000.0;

/// What frames hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fields {
    /// Whether contacts are written as lines between centres.
    pub contacts: bool,
    /// Whether bonds, if there are some, are written as lines between centres.
    pub bonds: bool,
    /// Precision of real numbers.
    pub precision: Precision,
    /// How hard frames are compressed, 0 to 9.
    pub compression: u32,
}

/// The schedule that a case asks for.
pub(crate) fn schedule(case: &Case, dt: f64) -> Schedule {
    let (end, output) = (case.time.end.get(), &case.output);
    // A duration that is a whole number of steps must not get one more from rounding.
    let steps = (end / dt * (1.0 - 1e-9)).ceil().max(1.0) as u64;
    let every = |interval: f64| ((interval / dt).round() as u64).clamp(1, steps);
    let frame_every = match (output.interval, output.frames) {
        (Some(interval), _) => every(interval.get()),
        (None, Some(0)) => 0,
        // Rounded up, so that there are never more frames than asked for.
        (None, frames) => steps.div_ceil(u64::from(frames.unwrap_or(FRAMES))),
    };
    // Who wants no frames and no picture in particular wants none at all.
    let unasked = if output.frames == Some(0) && case.picture.is_empty() { 0 } else { PICTURES };
    let picture_every = match output.pictures.unwrap_or(unasked) {
        0 => 0,
        pictures => steps.div_ceil(u64::from(pictures)),
    };
    Schedule {
        steps,
        picture_every,
        frame_every,
        history_every: every(output.history_interval.map_or(end / HISTORY_ROWS, Positive::get)),
        checkpoint_every: output.checkpoint_interval.map(|interval| every(interval.get())),
        checkpoint_interval_secs: output.checkpoint_interval_secs.get(),
    }
}

/// A run of so many steps that they cannot be counted one by one in a real number.
pub(crate) fn endless(loaded: &Loaded, dt: f64) -> Option<Problem> {
    const MOST: f64 = (1_u64 << 53) as f64;
    let steps = loaded.case.time.end.get() / dt;
    (steps > MOST).then(|| {
        Problem::new(codes::ENDLESS, format!("the run would take {} steps of {} s", number(steps), number(dt)))
            .at(loaded.tree.place(&["time", "end"]), "too long for steps like these")
            .help("`tdem check` tells what limits the step once the run is shorter; a time scale of heat may be too large")
    })
}

impl Fields {
    pub(crate) fn of(output: &Output) -> Self {
        Fields {
            contacts: output.contacts,
            bonds: output.bonds.unwrap_or(true),
            precision: output.precision,
            compression: output.compression,
        }
    }
}
