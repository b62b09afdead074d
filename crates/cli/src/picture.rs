//! `tdem picture`: a quick look.

use crate::cases;
use crate::codes;
use crate::console::{data, say};
use crate::files::{self, refused};
use crate::render::{Report, Reports};
use crate::units::{argument, grouped, number, short};
use clap::{Args, ValueEnum};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tdem_case::schema::View;
use tdem_engine::{Plan, State};
use tdem_results::picture::{self, Clip, Colour, Options, Subject, render};
use tdem_results::{Error, FinalState, checkpoint, info};

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The directory of the run
    #[arg(value_name = "DIR")]
    run: PathBuf,
    /// Draw the checkpoint nearest to this time, s; a run keeps its first and its last two [default: the last]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    time: Option<f64>,
    /// What colours mean
    #[arg(long, value_enum, default_value_t = Field::Velocity)]
    field: Field,
    /// Values at the two ends of the colours [default: the smallest and the largest]
    #[arg(long, num_args = 2, value_names = ["LOW", "HIGH"], allow_negative_numbers = true)]
    range: Option<Vec<f64>>,
    /// From where: corner, front, back, left, right, top, bottom, or a direction X,Y,Z
    #[arg(long, default_value = "corner", value_parser = direction, allow_hyphen_values = true)]
    view: Direction,
    /// Leave out what lies beyond a plane: one of its points, and the direction towards what is left out
    #[arg(long, value_name = "X,Y,Z:X,Y,Z", value_parser = clip, allow_hyphen_values = true)]
    clip: Option<Clip>,
    /// Draw no bar of colours beside it
    #[arg(long)]
    no_bar: bool,
    /// Fill the picture with the particles instead of the whole domain
    #[arg(long)]
    close: bool,
    /// Pixels, WIDTHxHEIGHT
    #[arg(long, default_value = "1200x900", value_parser = size)]
    size: Size,
    /// The file [default: DIR/pictures/FIELD-STEP.png]
    #[arg(long, value_name = "FILE.png")]
    out: Option<PathBuf>,
}

const EXAMPLES: &str = "\
Examples:
  tdem picture runs/packing
  tdem picture runs/packing --field force --view front --out force.png
  tdem picture runs/heating --field temperature --close --clip 0,0.1,0:0,-1,0

A case draws such pictures while it runs: see `picture` in docs/case-file.md.";

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Field {
    /// Speed, m/s
    Velocity,
    /// Size of the angular velocity, rad/s
    AngularVelocity,
    /// Third coordinate, m
    Height,
    /// Radius, m
    Radius,
    /// Size of the resultant force, N
    Force,
    /// Number of the material
    Material,
    /// Mean of the three normal stresses from contacts and bonds, Pa, tension positive
    Stress,
    /// Share of the bonds that broke
    Damage,
    /// Temperature, K; grey without heat
    Temperature,
}

impl Field {
    fn colour(self) -> Colour {
        match self {
            Field::Velocity => Colour::Speed,
            Field::AngularVelocity => Colour::Spin,
            Field::Height => Colour::Height,
            Field::Radius => Colour::Radius,
            Field::Force => Colour::Force,
            Field::Material => Colour::Material,
            Field::Stress => Colour::Stress,
            Field::Damage => Colour::Damage,
            Field::Temperature => Colour::Temperature,
        }
    }
}

type Direction = [f64; 3];
type Size = (u32, u32);

fn direction(text: &str) -> Result<Direction, String> {
    let named = [
        ("corner", View::Corner),
        ("front", View::Front),
        ("back", View::Back),
        ("left", View::Left),
        ("right", View::Right),
        ("top", View::Top),
        ("bottom", View::Bottom),
    ];
    if let Some((_, view)) = named.iter().find(|(name, _)| *name == text) {
        return Ok(view.direction());
    }
    vector(text).ok_or_else(|| {
        "neither corner, front, back, left, right, top, bottom nor three numbers such as 1,-1,0.5".to_owned()
    })
}

/// Three finite numbers that are not all 0.
fn vector(text: &str) -> Option<Direction> {
    numbers(text).filter(|direction| *direction != [0.0; 3])
}

fn numbers(text: &str) -> Option<Direction> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    <[f64; 3]>::try_from(numbers?).ok().filter(|numbers| numbers.iter().all(|x| x.is_finite()))
}

/// A point and a direction.
fn clip(text: &str) -> Result<Clip, String> {
    let plane =
        text.split_once(':').and_then(|(point, normal)| Some(Clip { point: numbers(point)?, normal: vector(normal)? }));
    plane.ok_or_else(|| {
        "write POINT:NORMAL, such as 0,0.1,0:0,-1,0; what lies towards the normal is left out".to_owned()
    })
}

fn size(text: &str) -> Result<Size, String> {
    let pixels = text.split_once('x').and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
    pixels.ok_or_else(|| "write WIDTHxHEIGHT, such as 1200x900".to_owned())
}

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let run = &arguments.run;
    if !run.join("case.toml").exists() {
        return Err(Error::NotARun { path: run.clone() }.into());
    }
    let built = cases::build(&cases::load(&run.join("case.toml"), &[])?)?;
    let state = choose(arguments, &built.plan)?;
    let colour = arguments.field.colour();
    let range = match arguments.range.as_deref() {
        Some(&[low, high]) => [low, high],
        _ => colour.range_of(&colour.values(&state, &built.plan)),
    };
    let (width, height) = arguments.size;
    let options = Options {
        width,
        height,
        direction: arguments.view,
        subject: if arguments.close { Subject::Particles } else { Subject::Domain },
        colour,
        range: Some(range),
        clip: arguments.clip,
        bar: !arguments.no_bar,
        ..Options::default()
    };
    let picture = render(&state, &built.plan, &options)?;
    let name = colour.name();
    let path = arguments.out.clone().unwrap_or_else(|| picture::file_of(run, name, state.step));
    if let (Some(folder), None) = (path.parent(), &arguments.out) {
        fs::create_dir_all(folder).map_err(|error| refused(folder, &error))?;
        if folder.is_symlink() {
            return Err(Error::Linked { path: folder.into() }.into());
        }
    }
    files::write(&path, &picture)?;
    say(format!(
        "Step {}, t = {} s; {name} from {} {unit} (dark) to {} {unit} (bright)",
        grouped(state.step),
        short(built.plan.time(state.step)),
        number(range[0], 3),
        number(range[1], 3),
        unit = colour.unit()
    ));
    data(argument(&path))?;
    Ok(ExitCode::SUCCESS)
}

/// The checkpoint to draw.
fn choose(arguments: &Arguments, plan: &Plan) -> Result<State, Reports> {
    let run = &arguments.run;
    let Some(time) = arguments.time else {
        let FinalState { state, path, .. } = tdem_results::load_final_state(run)?;
        return fitting(state, plan, &path);
    };
    let mut good: Vec<_> =
        info(run)?.checkpoints.into_iter().filter(|checkpoint| checkpoint.particles.is_ok()).collect();
    good.sort_by(|a, b| (plan.time(a.step) - time).abs().total_cmp(&(plan.time(b.step) - time).abs()));
    let Some(nearest) = good.first() else {
        return Err(Error::NoCheckpoint { damaged: 0, path: run.clone() }.into());
    };
    let state = checkpoint::read(&nearest.path).map_err(|damage| {
        Report::new(codes::NO_CHECKPOINT, format!("a checkpoint is damaged, {damage}: {}", argument(&nearest.path)))
    })?;
    fitting(state, plan, &nearest.path)
}

/// The state, if it is one of this case: what is drawn looks up its materials, walls and bonds.
fn fitting(state: State, plan: &Plan, path: &Path) -> Result<State, Reports> {
    state.validate(plan).map_err(|fault| {
        let message = format!("a checkpoint does not fit the case of the run, {fault}: {}", argument(path));
        Report::new(codes::RESULTS_OTHER_CASE, message)
    })?;
    Ok(state)
}
