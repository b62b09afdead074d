//! What a run is about to do, and what came of it.

use crate::units::{argument, bytes, clock, counted, entry, grouped, number, short, title};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tdem_case::{Built, Loaded};
use tdem_engine::{Ledger, Motion, Schedule, Scheme};
use tdem_results::{Progress, glance};

/// What a run is about to do.
pub(crate) fn before(loaded: &Loaded, built: &Built, schedule: &Schedule, device: &str, out: &Path) -> String {
    let case = &loaded.case;
    let mut text = format!("{}\n", title(if case.title.is_empty() { &loaded.source.name } else { &case.title }));
    text += &entry("particles", format!("{}, model {:?}", grouped(built.state.len() as u64), case.model));
    text += &entry("step", step(built));
    text += &masses(loaded);
    text += &heat(built);
    let end = short(built.plan.time(schedule.steps));
    text += &entry("duration", format!("{end} s, {}", counted(schedule.steps, "step")));
    text += &entry("memory", format!("about {}", bytes(built.memory.run_bytes)));
    text += &entry("device", device);
    text + entry("results in", argument(out)).trim_end()
}

/// The step and what limits it.
pub(crate) fn step(built: &Built) -> String {
    let limits = &built.limits;
    if built.plan.heat.as_ref().is_some_and(|heat| heat.motion.takes_turns()) {
        return format!("{} s of heat", number(built.plan.dt, 5));
    }
    let step = format!("{} s", number(limits.step, 5));
    match limits.smallest() {
        Some(limit) if limits.auto && limits.step < limits.safety * limit.seconds * (1.0 - 1e-9) => {
            format!("{step}, the whole duration")
        }
        Some(limit) if limits.auto => {
            format!("{step}, {} of the limit by {} ({})", short(limits.safety), limit.name, limit.cause)
        }
        Some(limit) => {
            let ratio = short(limits.step / limit.seconds);
            format!("{step}, as given; {ratio} of the limit by {} ({})", limit.name, limit.cause)
        }
        None => format!("{step}, nothing limits it"),
    }
}

/// That masses are scaled, if they are.
pub(crate) fn masses(loaded: &Loaded) -> String {
    let scaling = loaded.case.time.mass_scaling();
    if scaling == 1.0 {
        return String::new();
    }
    entry("masses", format!("{} times the true ones where they move, for states of rest", short(scaling)))
}

/// How heat goes on, if there is any.
pub(crate) fn heat(built: &Built) -> String {
    let Some(heat) = &built.plan.heat else { return String::new() };
    let scheme = |scheme: Scheme| match scheme {
        Scheme::Explicit => "explicit",
        Scheme::Implicit => "implicit",
    };
    let text = match heat.motion {
        Motion::Stepped if heat.time_scale == 1.0 => "along with the motion".to_owned(),
        Motion::Stepped => {
            let duration = short(built.plan.heat_time(built.schedule.steps));
            format!("{} times as fast as the motion, {duration} s in all", short(heat.time_scale))
        }
        Motion::Frozen(of) => format!("alone, {}; nothing moves", scheme(of)),
        Motion::QuasiStatic(relaxation) => format!(
            "{}; after each step particles come to rest, in steps of {} s",
            scheme(relaxation.scheme),
            short(relaxation.dt)
        ),
    };
    entry("heat", text)
}

/// A run that has come to its end.
#[derive(Debug)]
pub(crate) struct Ended<'a> {
    pub(crate) path: &'a Path,
    pub(crate) step: u64,
    /// The step at which this process took it up.
    pub(crate) first: u64,
    pub(crate) particles: usize,
    pub(crate) took: Duration,
    pub(crate) last: Option<&'a Progress>,
    /// The largest overlap in all rows of the history, those of earlier processes included, over the mean radius of a
    /// pair, and its time, s.
    pub(crate) overlap: Option<[f64; 2]>,
    /// Files of curves.
    pub(crate) curves: &'a [PathBuf],
}

/// What came of a run.
pub(crate) fn after(ended: &Ended<'_>) -> String {
    let steps = ended.step - ended.first;
    let cundall = ended.particles as f64 * steps as f64 / ended.took.as_secs_f64().max(1e-9);
    let mut text = format!("Finished at step {}", grouped(ended.step));
    if let Some(last) = ended.last {
        let _ = write!(text, ", t = {} s", short(last.time));
    }
    let _ = writeln!(text, ": {} in {}, results written.", counted(steps, "step"), clock(ended.took));
    text += &entry("rate", format!("{} particle-steps/s", number(cundall, 3)));
    if let Some(last) = ended.last {
        text += &ledger(&last.ledger, ended.overlap);
        if last.ledger_step != ended.step {
            text += &entry("", format!("as of step {}", grouped(last.ledger_step)));
        }
    }
    text + files(ended.path, ended.curves).trim_end()
}

/// Energies and measures.
fn ledger(ledger: &Ledger, overlap: Option<[f64; 2]>) -> String {
    let mut text = entry(
        "contacts",
        format!("{} between particles, {} with walls", grouped(ledger.contacts), grouped(ledger.wall_contacts)),
    );
    if let Some([largest, time]) = overlap.filter(|[largest, _]| *largest > 0.0) {
        let (percent, time) = (number(100.0 * largest, 3), short(time));
        text += &entry(
            "overlap",
            format!("at most {percent} % of the smaller radius of a pair or of the radius at a wall, at t = {time} s"),
        );
    }
    let unbalanced = match ledger.contacts + ledger.wall_contacts {
        0 => String::new(),
        _ => format!(", unbalanced force ratio {}", number(ledger.unbalanced_force_ratio, 3)),
    };
    text += &entry("kinetic", format!("{} J{unbalanced}", number(ledger.kinetic(), 3)));
    text + &entry("energy error", energy_error(ledger))
}

/// The error as a share of what the ledger moved about; with that alone one can tell whether it is small.
fn energy_error(ledger: &Ledger) -> String {
    let moved = ledger.kinetic()
        + ledger.elastic_normal
        + ledger.elastic_tangential
        + ledger.elastic_bonds
        + ledger.friction_dissipated.abs()
        + ledger.damping_dissipated.abs()
        + ledger.breakage_dissipated;
    let error = format!("{} J", number(ledger.energy_error, 2));
    if moved > 0.0 {
        let share = number(100.0 * (ledger.energy_error / moved).abs(), 2);
        format!("{error}, {share} % of the {} J in motion, springs and losses", number(moved, 3))
    } else {
        error
    }
}

/// What a run left on the disk, and what to do with it.
fn files(run: &Path, curves: &[PathBuf]) -> String {
    let page = argument(&run.join("report.html"));
    let mut text = entry("report", format!("{page}; open it in a browser")) + &format!("Files in {}:\n", argument(run));
    let mut file = |name: &str, what: &str| {
        let _ = writeln!(text, "  {name:<31} {what}");
    };
    // A run that cannot be looked at has already said why.
    if let Ok(seen) = glance(run)
        && !seen.masters.is_empty()
    {
        let frames = counted(seen.frames as u64, "frame");
        file(&seen.masters.join(", "), &format!("{frames}; open them in ParaView and press Apply"));
        if !seen.complete {
            file("", &format!("they need frames/ beside them: send what `tdem pack {}` makes", argument(run)));
        }
    }
    file("history.csv", "energies and contacts over time");
    for curve in curves {
        file(&curve.file_name().unwrap_or_default().to_string_lossy(), "a curve of two of its columns");
    }
    if run.join("pictures").exists() {
        file("pictures/", "what it looked like; also in the report");
    }
    file("checkpoints/", "complete states, for `tdem resume` and `tdem picture`");
    text
}
