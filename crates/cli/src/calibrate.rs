//! `tdem calibrate`: which bonds give the packing of a case the values of a solid.

use crate::cases;
use crate::codes;
use crate::console::{data, say};
use crate::json::{self, Json};
use crate::render::{self, Report, Reports};
use crate::units::{counted, number, short};
use clap::Args;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use tdem_case::schema::{Joint as Entry, Positive};
use tdem_engine::physics::bond::Joint;
use tdem_engine::{Device, Plan, Simulation, State, cpu};
use tdem_studies::calibrate::{Calibration, Error, Targets, calibrate};
use tdem_studies::uniaxial::{Elasticity, Error as Untested, Failure, Specimen};

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The case: its particles and one `[[bond]]`
    #[arg(value_name = "CASE.toml")]
    case: PathBuf,
    /// Young's modulus that is to come out, Pa
    #[arg(long, value_name = "PA", value_parser = positive)]
    young_modulus: f64,
    /// Poisson's ratio that is to come out; without it the stiffness ratio of the case stays
    #[arg(long, value_name = "NUMBER")]
    poisson_ratio: Option<f64>,
    /// Tensile strength that is to come out, Pa; without it the strengths of the case stay, and nothing is torn
    #[arg(long, value_name = "PA", value_parser = positive)]
    tensile_strength: Option<f64>,
    /// Crush the packing, too, and tell its strength in compression; it takes longer
    #[arg(long)]
    compression: bool,
    /// Direction of the tests
    #[arg(long, default_value = "z", value_parser = ["x", "y", "z"])]
    axis: String,
    /// Area across the axis, m²; that of the box around all spheres if left out
    #[arg(long, value_name = "M2", value_parser = positive)]
    section: Option<f64>,
    /// Change a line of the case, as for `tdem run`
    #[arg(long, value_name = "KEY=VALUE", value_parser = cases::key_value)]
    set: Vec<(String, String)>,
    #[command(flatten)]
    pub(crate) json: Json,
}

const EXAMPLES: &str = "\
Examples:
  tdem calibrate sandstone.toml --young-modulus 20e9 --poisson-ratio 0.2
  tdem calibrate sandstone.toml --young-modulus 20e9 --poisson-ratio 0.2 --tensile-strength 3e6 --compression

What it prints is TOML: the [[bond]] that takes the place of the one in the case, below comments that say what came out.
The packing is tested alone, between grips at its ends, without walls, gravity and constraints of the case. Keep the ratio
of shear to tensile strength, friction angle, moment contribution and scatter as you want them: they stay.";

fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    Positive::try_from(value).map(Positive::get).map_err(|error| error.to_string())
}

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let loaded = cases::load(&arguments.case, &arguments.set)?;
    let built = cases::build(&loaded)?;
    render::warn(&Reports::from(&built.warnings));
    let axis = ["x", "y", "z"].iter().position(|axis| *axis == arguments.axis).unwrap_or(2);
    let specimen =
        Specimen::of(&built.state, &built.plan, axis, arguments.section).map_err(|error| report(error.into()))?;
    // Every [[bond]] of a case joins something, and here all bonds are of one pair of materials.
    let [entry] = loaded.case.bond.as_slice() else {
        return Err(report(Untested::SeveralKinds { kinds: loaded.case.bond.len() }.into()));
    };
    say(format!(
        "Testing {} with {} along {} ...",
        counted(specimen.state().len() as u64, "particle"),
        counted(specimen.state().bonds.len() as u64, "bond"),
        arguments.axis
    ));
    let targets = Targets {
        young_modulus: arguments.young_modulus,
        poisson_ratio: arguments.poisson_ratio,
        tensile_strength: arguments.tensile_strength,
        compression: arguments.compression,
    };
    let device = Device::from(cpu::Options::default());
    let start = |state: State, plan: Plan| Simulation::new(state, plan, device);
    let found = calibrate(&specimen, &targets, start).map_err(report)?;
    if arguments.json.json {
        json::print("calibrate", for_programs(&specimen, &targets, &found, &toml(entry, &found.joint)))?;
        return Ok(ExitCode::SUCCESS);
    }
    data(comments(&specimen, &targets, &found) + toml(entry, &found.joint).trim_end())?;
    Ok(ExitCode::SUCCESS)
}

/// What stands in the way, and what to do.
fn report(error: Error) -> Reports {
    let message = error.to_string();
    let (code, help) = match error {
        Error::PoissonOutOfReach { .. } => (
            codes::CALIBRATE_POISSON,
            "ask for a value in between; other packings, or a larger `gap`, have other ranges",
        ),
        Error::Uniaxial(error) => match error {
            Untested::NoBonds => (
                codes::CALIBRATE_NOT_BONDED,
                "a case with [[bond]] is needed, whose particles are near enough to each other",
            ),
            Untested::SeveralKinds { .. } => {
                (codes::CALIBRATE_SEVERAL_MATERIALS, "calibrate each material on a case of its own")
            }
            Untested::Periodic => {
                (codes::CALIBRATE_PERIODIC, "take `periodic` out of the [domain], with walls in its place")
            }
            Untested::NotSpanning { .. } => (
                codes::CALIBRATE_NOT_SPANNING,
                "raise the `gap` of the [[bond]], pack closer, or test along another --axis",
            ),
            Untested::Unbreakable => (
                codes::CALIBRATE_UNBREAKABLE,
                "give the [[bond]] a tensile_strength and a shear_strength: their ratio is kept",
            ),
            Untested::DoesNotBreak { .. } => {
                (codes::CALIBRATE_DOES_NOT_BREAK, "tensile and shear strength that are less far apart let it break")
            }
            Untested::Statics(_) => (
                codes::CALIBRATE_LOOSE,
                "particles that hang by too little cannot be held; raise the `gap` of the [[bond]]",
            ),
            Untested::Fault(_) => (codes::CALIBRATE_FAULT, "see whether the case runs with `tdem run`"),
        },
    };
    Report::new(code, message).help(help).into()
}

/// What came out, for programs.
fn for_programs(specimen: &Specimen, targets: &Targets, found: &Calibration, bond: &str) -> Value {
    let elasticity = |of: &Elasticity| json!({ "young_modulus": of.young_modulus, "poisson_ratio": of.poisson_ratio });
    let failure = |of: &Failure| json!({ "strength": of.strength, "strain": of.strain, "broken_bonds": of.broken });
    json!({
        "ok": true,
        "particles": specimen.state().len(),
        "bonds": specimen.state().bonds.len(),
        "length": specimen.length(),
        "section": specimen.section(),
        "asked": {
            "young_modulus": targets.young_modulus,
            "poisson_ratio": targets.poisson_ratio,
            "tensile_strength": targets.tensile_strength,
        },
        "got": elasticity(&found.elasticity),
        "mean_field": elasticity(&found.mean_field),
        "tension": found.tension.as_ref().map(failure),
        "compression": found.compression.as_ref().map(failure),
        "static_solutions": found.solutions,
        "tests_to_failure": found.tests,
        "bond": bond,
    })
}

/// What was asked for and what came out.
fn comments(specimen: &Specimen, targets: &Targets, found: &Calibration) -> String {
    let (state, elasticity) = (specimen.state(), found.elasticity);
    let mut text = format!(
        "# {} and {}, {} m long, section {} m2; {}, {}\n",
        counted(state.len() as u64, "particle"),
        counted(state.bonds.len() as u64, "bond"),
        short(specimen.length()),
        short(specimen.section()),
        counted(found.solutions as u64, "static solution"),
        counted(found.tests as u64, "test to failure"),
    );
    let mut line = |what: &str, asked: Option<f64>, got: f64, unit: &str, more: &str| {
        let asked = asked.map_or("-".to_owned(), |value| number(value, 5));
        let line = format!("# {what:<24} {asked:>12} {:>12} {unit:<3} {more}", number(got, 5));
        let _ = writeln!(text, "{}", line.trim_end());
    };
    line("Young's modulus", Some(targets.young_modulus), elasticity.young_modulus, "Pa", "");
    line("Poisson's ratio", targets.poisson_ratio, elasticity.poisson_ratio, "", "");
    if let Some(torn) = found.tension {
        let more = format!("at {} of strain", short(torn.strain));
        line("tensile strength", targets.tensile_strength, torn.strength, "Pa", &more);
    }
    if let Some(crushed) = found.compression {
        let times =
            found.tension.map(|torn| format!(", {} times that in tension", short(crushed.strength / torn.strength)));
        let more = format!("at {} of strain{}", short(crushed.strain), times.unwrap_or_default());
        line("compressive strength", None, crushed.strength, "Pa", &more);
    }
    let mean = found.mean_field;
    line("mean field, modulus", None, mean.young_modulus, "Pa", "these bonds if all particles moved with the mean");
    line("mean field, ratio", None, mean.poisson_ratio, "", "");
    let heading = format!("# {:<24} {:>12} {:>12}\n", "", "asked", "got");
    match text.find('\n') {
        Some(end) => text.insert_str(end + 1, &heading),
        None => text += &heading,
    }
    text
}

/// The entry of the case with other bonds.
fn toml(entry: &Entry, joint: &Joint<f64>) -> String {
    let cement = &joint.cement;
    let real = |value: f64| {
        if value.is_infinite() {
            return "\"unbreakable\"".to_owned();
        }
        let text = number(value, 7);
        if text.contains(['.', 'e']) { text } else { text + ".0" }
    };
    let [first, second] = &entry.between;
    let mut text = format!("[[bond]]\nbetween = [{first:?}, {second:?}]\n");
    let mut line = |key: &str, value: f64| {
        let _ = writeln!(text, "{key} = {}", real(value));
    };
    line("radius_multiplier", cement.radius_multiplier);
    line("tensile_strength", cement.tensile_strength);
    line("shear_strength", cement.shear_strength);
    line("friction_angle_deg", entry.friction_angle_deg.get());
    line("moment_contribution", cement.moment_contribution);
    line("damping_ratio", cement.damping_ratio);
    line("gap", entry.gap.get());
    if let Some(scatter) = &entry.scatter {
        line("scatter.weibull_shape", scatter.weibull_shape.get());
    }
    let stiffness = if joint.young_modulus > 0.0 {
        format!("young_modulus = {}", real(joint.young_modulus))
    } else {
        format!("stiffness_per_area = {}", real(joint.stiffness_per_area))
    };
    text + &format!("[bond.micro]\n{stiffness}\nstiffness_ratio = {}\n", real(cement.stiffness_ratio))
}
