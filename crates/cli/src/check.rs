//! `tdem check`: what is wrong with a case; if nothing is, what limits its step and what it costs.

use crate::console::data;
use crate::json::{self, Json};
use crate::render::{self, Reports};
use crate::units::{bytes, counted, cut, entry, grouped, number, short};
use crate::{cases, memory, summary};
use clap::Args;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;
use tdem_case::schema::{Damping, Precision, Surface};
use tdem_case::{Built, Loaded, StepLimits, SurfaceExtent};
use tdem_engine::State;

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The case file
    #[arg(value_name = "CASE.toml")]
    case: PathBuf,
    /// Change a line of the case, as for `tdem run`
    #[arg(long, value_name = "KEY=VALUE", value_parser = cases::key_value)]
    set: Vec<(String, String)>,
    #[command(flatten)]
    pub(crate) json: Json,
}

const EXAMPLES: &str = "\
Examples:
  tdem check cases/packing.toml
  tdem check cases/packing.toml --set size=3m";

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let loaded = cases::load(&arguments.case, &arguments.set)?;
    let built = cases::build(&loaded)?;
    render::warn(&Reports::from(&built.warnings));
    memory::warn(&built.memory);
    if arguments.json.json {
        json::print("check", for_programs(&loaded, &built))?;
        return Ok(ExitCode::SUCCESS);
    }
    let case = &loaded.case;
    let materials: Vec<&str> = case.material.keys().map(String::as_str).collect();
    let mut text = format!("{} can run.\n", loaded.source.name);
    text += &entry("particles", format!("{}, model {:?}", grouped(built.state.len() as u64), case.model));
    text += &extent(&built.state);
    text += &bonds(&built.state, &materials);
    text += &entry("memory", format!("about {}", bytes(built.memory.run_bytes)));
    text += &entry("on a GPU", format!("about {} of its memory", bytes(built.memory.device_bytes)));
    text += &entry("step", summary::step(&built));
    text += &summary::masses(&loaded);
    text += &consequences(&loaded);
    text += &summary::heat(&built);
    text += &surfaces(&loaded, &built);
    text += &schedule(&built);
    text += &limits(&built.limits);
    data(text.trim_end())?;
    Ok(ExitCode::SUCCESS)
}

/// The same for programs.
fn for_programs(loaded: &Loaded, built: &Built) -> Value {
    let (case, schedule, limits) = (&loaded.case, &built.schedule, &built.limits);
    let limits_of_step = limits.limits.iter().map(
        |limit| json!({ "seconds": limit.seconds, "proven": limit.proven, "name": limit.name, "cause": limit.cause }),
    );
    json!({
        "ok": true,
        "source": loaded.source.name,
        "title": case.title,
        "model": format!("{:?}", case.model),
        "particles": built.state.len(),
        "bonds": built.state.bonds.len(),
        "memory_bytes": built.memory.run_bytes,
        "device_memory_bytes": built.memory.device_bytes,
        "step_seconds": built.plan.dt,
        "steps": schedule.steps,
        "duration_seconds": built.plan.time(schedule.steps),
        "heat_seconds": built.plan.heat.as_ref().map(|_| built.plan.heat_time(schedule.steps)),
        "limits": limits_of_step.collect::<Value>(),
        "warnings": Reports::from(&built.warnings).json(),
    })
}

/// What the particles fill and how large they are.
fn extent(state: &State) -> String {
    if state.is_empty() {
        return String::new();
    }
    let over = |start: f64, pick: fn(f64, f64) -> f64, value: &dyn Fn(usize) -> f64| {
        (0..state.len()).map(value).fold(start, pick)
    };
    let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
    let least = |k: usize| over(low, f64::min, &|i| state.position[i][k] - state.radius[i]);
    let most = |k: usize| over(high, f64::max, &|i| state.position[i][k] + state.radius[i]);
    let corner = |edge: &dyn Fn(usize) -> f64| [0, 1, 2].map(|k| short(edge(k))).join(", ");
    let (small, large) = (over(low, f64::min, &|i| state.radius[i]), over(high, f64::max, &|i| state.radius[i]));
    let radii = if small == large { short(small) } else { format!("{} to {}", short(small), short(large)) };
    entry("radius", format!("{radii} m"))
        + &entry("they fill", format!("({}) to ({}) m", corner(&least), corner(&most)))
}

/// How many bonds there are, and between which materials, by name in the order of their indices.
fn bonds(state: &State, materials: &[&str]) -> String {
    if state.bonds.is_empty() {
        return String::new();
    }
    let material = |id: u32| state.index_of(id).map_or(0, |index| usize::from(state.material[index]));
    let mut counts: BTreeMap<[usize; 2], u64> = BTreeMap::new();
    for bond in &state.bonds {
        let mut pair = [material(bond.first), material(bond.second)];
        pair.sort_unstable();
        *counts.entry(pair).or_insert(0) += 1;
    }
    let count = state.bonds.len() as u64;
    let each = 2.0 * count as f64 / state.len() as f64;
    let mut text = entry("bonds", format!("{}, {} per particle", grouped(count), number(each, 3)));
    for ([a, b], count) in counts {
        let name = |index: usize| materials.get(index).copied().unwrap_or("rigid");
        text += &entry("", format!("{} of {} and {}", grouped(count), name(a), name(b)));
    }
    text
}

/// How large surfaces are, and what acts through them.
fn surfaces(loaded: &Loaded, built: &Built) -> String {
    let line = |(surface, extent): (&Surface, &SurfaceExtent)| {
        let name = match (&surface.name, &surface.of) {
            (name, _) if !name.is_empty() => format!("{name}: "),
            (_, Some(of)) => format!("of {of}: "),
            _ => String::new(),
        };
        let mut parts = vec![counted(extent.particles as u64, "particle")];
        if extent.area > 0.0 {
            parts.push(format!("{} m²", number(extent.area, 5)));
        }
        parts.push(format!("depth {} m", number(extent.depth, 4)));
        if surface.temperature.is_some() {
            parts.push("temperature held".to_owned());
        }
        if surface.flux.is_some() {
            parts.push("flux prescribed".to_owned());
        }
        if let Some(convection) = &surface.convection {
            parts.push(format!("coefficient {} W/(m² K)", short(convection.coefficient.get())));
        }
        if let Some(radiation) = &surface.radiation {
            parts.push(format!("emissivity {}", short(radiation.emissivity.get())));
        }
        entry("surface", format!("{name}{}", parts.join(", ")))
    };
    loaded.case.surface.iter().zip(&built.surfaces).map(line).collect()
}

/// What scaled masses do and do not change.
fn consequences(loaded: &Loaded) -> String {
    let (case, scaling) = (&loaded.case, loaded.case.time.mass_scaling());
    if scaling == 1.0 {
        return String::new();
    }
    let root = short(scaling.sqrt());
    let mut lines = vec![
        format!("steps may be {root} times as long; vibrations last as much longer"),
        "weight, forces that are applied and heat capacity stay".to_owned(),
        "kinetic energy is that of the scaled masses; keep it below 1 to 5 % of the elastic energy".to_owned(),
    ];
    if case.contact.damping == Damping::Viscous {
        lines.push(format!(
            "dashpots in 1/s go with the mass: {} times the coefficient in N s/m, {root} times the part of the critical",
            short(scaling)
        ));
    }
    if case.model.bonds() {
        lines.push("damping_ratio and local_damping of bonds keep their part of the critical".to_owned());
    }
    lines.iter().map(|line| entry("", line)).collect()
}

/// When what is written, and how much.
fn schedule(built: &Built) -> String {
    let schedule = &built.schedule;
    let time = |steps: u64| format!("{} s", short(built.plan.time(steps)));
    let count = |every: u64| if every == 0 { 0 } else { schedule.steps.div_ceil(every) + 1 };
    let frames = count(schedule.frame_every);
    let disk = frames * frame_bytes(built);
    let mut text = entry("duration", format!("{}, {}", time(schedule.steps), counted(schedule.steps, "step")));
    text += &entry(
        "frames",
        if frames == 0 {
            "none".to_owned()
        } else {
            format!(
                "{}, one every {} ({}), about {} on the disk",
                grouped(frames),
                time(schedule.frame_every),
                counted(schedule.frame_every, "step"),
                bytes(disk)
            )
        },
    );
    text += &entry(
        "history",
        format!(
            "{}, one every {} ({})",
            counted(count(schedule.history_every), "row"),
            time(schedule.history_every),
            counted(schedule.history_every, "step")
        ),
    );
    let clock = format!("every {} s on the clock", short(schedule.checkpoint_interval_secs));
    let steps = schedule.checkpoint_every.map_or(String::new(), |every| format!(", every {}", time(every)));
    text + &entry("checkpoints", format!("{clock}{steps}, about {} each", bytes(built.memory.state_bytes)))
}

/// An estimate of one frame, from the sizes of frames of a settled packing and of a single ball.
fn frame_bytes(built: &Built) -> u64 {
    let fields = built.fields;
    let particle = BYTES_PER_PARTICLE + if fields.contacts { BYTES_OF_CONTACTS } else { 0 };
    let precision = if fields.precision == Precision::Double { 2 } else { 1 };
    let bonds = if fields.bonds { built.state.bonds.len() as u64 } else { 0 };
    FRAME_BYTES + precision * (particle * built.state.len() as u64 + BYTES_PER_BOND * bonds)
}

const FRAME_BYTES: u64 = 15_000;
const BYTES_PER_PARTICLE: u64 = 63;
const BYTES_OF_CONTACTS: u64 = 70;
/// Of bodies of 3,000 to 3,500 particles under load, stress and damage of their particles included: 53 to 58, and 60 with
/// the cracks when two thirds of the bonds are broken.
const BYTES_PER_BOND: u64 = 60;

/// Letters of what sets a limit.
const LONGEST: usize = 500;

/// All limits of the step, the smallest first, one line each.
fn limits(limits: &StepLimits) -> String {
    let mut text = String::from("Limits of the time step:\n");
    if limits.limits.is_empty() {
        return text + "  none: nothing collides\n";
    }
    let cells: Vec<[String; 4]> = limits
        .limits
        .iter()
        .map(|limit| {
            [
                format!("{} s", number(limit.seconds, 4)),
                if limit.proven { "proven" } else { "estimate" }.to_owned(),
                number(limits.step / limit.seconds, 3),
                limit.name.to_owned(),
            ]
        })
        .collect();
    let header = ["limit", "kind", "step/limit", "set by"].map(str::to_owned);
    let width: [usize; 4] =
        std::array::from_fn(|k| cells.iter().chain([&header]).map(|row| row[k].chars().count()).max().unwrap_or(0));
    let causes = std::iter::once("").chain(limits.limits.iter().map(|limit| limit.cause.as_str()));
    for (row, cause) in std::iter::once(&header).chain(&cells).zip(causes) {
        let padded: Vec<String> = row.iter().zip(width).map(|(cell, width)| format!("{cell:<width$}")).collect();
        let line = format!("  {}  {}", padded.join("  "), cut(cause, LONGEST));
        text += line.trim_end();
        text.push('\n');
    }
    text + "Beyond a proven limit a run diverges and is refused; beyond an estimate it is warned of.\n"
}
