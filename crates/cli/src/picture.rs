//! `tdem picture`: a quick look.

use crate::cases;
use crate::codes;
use crate::console::{data, say};
use crate::files::{self, refused};
use crate::render::{Report, Reports};
use crate::units::{argument, grouped, number, short};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tdem_case::schema::{Background, ColourMap, Field, View};
use tdem_engine::{Plan, State};
use tdem_results::picture::{self, Clip, Options, Scale, Subject, render};
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
    #[arg(long, default_value = "velocity", value_parser = one_of(Field::ALL))]
    field: Field,
    /// Which colours [default: coolwarm for stresses, inferno for temperatures, viridis for others]
    #[arg(long, value_name = "MAP", alias = "color-map", value_parser = one_of(ColourMap::ALL))]
    colour_map: Option<ColourMap>,
    /// What lies behind
    #[arg(long, default_value = "white", value_parser = one_of(Background::ALL))]
    background: Background,
    /// Values at the two ends of the colours, temperatures on the scale of the case [default: the smallest and the largest]
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

/// One of some words.
pub(crate) fn one_of<T: Copy + Send + Sync + 'static>(
    all: &'static [(T, &'static str, &'static str)],
) -> impl TypedValueParser<Value = T> {
    let words = all.iter().map(|(_, word, about)| PossibleValue::new(*word).help(about.trim().trim_end_matches('.')));
    PossibleValuesParser::new(words).try_map(|chosen: String| {
        let found = all.iter().find(|(_, word, _)| *word == chosen);
        found.map(|(value, _, _)| *value).ok_or("there is no such word")
    })
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
    let loaded = cases::load(&run.join("case.toml"), &[])?;
    let built = cases::build(&loaded)?;
    let state = choose(arguments, &built.plan)?;
    let colour = cases::colour(arguments.field);
    let map = arguments.colour_map.map_or(colour.map(), cases::colour_map);
    let range = match arguments.range.as_deref() {
        Some(&[low, high]) => cases::in_kelvin(&loaded.case, arguments.field, [low, high]),
        _ => colour.range(colour.extent(&colour.values(&state, &built.plan)), map),
    };
    let scale = cases::scale(&loaded.case);
    let (width, height) = arguments.size;
    let options = Options {
        width,
        height,
        direction: arguments.view,
        subject: if arguments.close { Subject::Particles } else { Subject::Domain },
        colour,
        range: Some(range),
        map: Some(map),
        background: cases::background(arguments.background),
        scale,
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
    let (unit, zero) = match (arguments.field, scale) {
        (Field::Temperature, Scale::Celsius) => ("°C", tdem_case::schema::Scale::Celsius.zero()),
        _ => (colour.unit(), 0.0),
    };
    let end = |value: f64| format!("{} {unit}", number(value - zero, 3)).trim_end().to_owned();
    say(format!(
        "Step {}, t = {} s; {name} from {} to {}, {} colours",
        grouped(state.step),
        short(built.plan.time(state.step)),
        end(range[0]),
        end(range[1]),
        map.name()
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
