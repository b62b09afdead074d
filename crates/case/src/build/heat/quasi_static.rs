//! Whether the motion has time to follow the heat.

use super::super::Context;
use crate::codes;
use crate::problem::{Problem, number};
use tdem_engine::{Plan, State};

/// A program of heat lasts at least so many times as long as the slowest vibration of the whole.
const VIBRATIONS: f64 = 20.0;

/// A time scale with which bodies would swing instead of expanding: $S \le t/(20\,T)$ with the period $T = 4L/c$ of the
/// slowest vibration of a body of length $L$, where waves go with $c = \sqrt{E/\rho}$, and the length $t$ of the program.
pub(in crate::build) fn check(context: &Context<'_>, plan: &Plan, state: &State) -> Option<Problem> {
    let heat = plan.heat.as_ref().filter(|heat| heat.expands() && heat.time_scale > 1.0)?;
    if state.bonds.is_empty() {
        return None;
    }
    let courses = heat.exposures.iter().flat_map(tdem_engine::Exposure::courses);
    let last = courses.chain(heat.walls.iter().flatten()).filter_map(|course| course.0.last()).map(|point| point[0]);
    let case = &context.loaded.case;
    let program = last.fold(case.time.end.get() * heat.time_scale, f64::max);
    let period = 4.0 * extent(state) / slowest_wave(context, state);
    let most = program / (VIBRATIONS * period);
    if heat.time_scale <= most {
        return None;
    }
    let key = if case.heat.as_ref().is_some_and(|heat| heat.duration.is_some()) { "duration" } else { "time_scale" };
    let place = context.loaded.tree.place(&["heat", key]);
    let message = format!(
        "heat goes {} times as fast as motion, so that {} s of it pass within {} s: bodies would swing instead of expanding",
        number(heat.time_scale),
        number(program),
        number(program / heat.time_scale)
    );
    // With a duration of the heat, a longer run has a smaller scale; with a scale, the programme grows with the run.
    let duration = case.heat.as_ref().and_then(|heat| heat.duration).map(crate::schema::Positive::get);
    let end = VIBRATIONS * period * duration.map_or(1.0, |duration| duration / program);
    // Rounded up in the digits that are shown, so that what is read is enough.
    let end = number(end * (1.0 + 1e-4));
    Some(Problem::new(codes::TIME_SCALE, message).at(place, format!("at most {} times as fast", number(most))).help(
        format!(
            "the slowest vibration takes {} s, and {VIBRATIONS} of them are needed: time.end must be at least {end} s",
            number(period)
        ),
    ))
}

/// The longest side of the box around all centres, m.
fn extent(state: &State) -> f64 {
    let side = |k: usize| {
        let places = state.position.iter().map(|place| place[k]);
        let [low, high] = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        high - low
    };
    (0..3).map(side).fold(0.0, f64::max)
}

/// $\sqrt{E/\rho}$ of the slowest material that particles are made of, m/s.
fn slowest_wave(context: &Context<'_>, state: &State) -> f64 {
    let mut present = vec![false; context.materials.len()];
    state.material.iter().for_each(|&material| present[usize::from(material)] = true);
    let speed = |k: usize| (context.materials.elastic[k].young_modulus / context.materials.density[k]).sqrt();
    (0..present.len()).filter(|&k| present[k]).map(speed).fold(f64::INFINITY, f64::min)
}
