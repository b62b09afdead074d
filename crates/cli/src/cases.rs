//! Cases, read and built for the commands.

use crate::memory;
use crate::render::{Report, Reports};
use std::path::Path;
use tdem_case::schema::{self, Field, Picture};
use tdem_case::{Built, Case, Fields, Loaded, Problems};
use tdem_engine::{Domain, State};
use tdem_results::curve::{Axis, Curve};
use tdem_results::picture::{self, Background, Colour, ColourMap, Scale, Series, Subject};
use tdem_results::{Contents, Names, Precision, load_final_state};

/// Reads `KEY=VALUE`.
pub(crate) fn key_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => Ok((key.trim().to_owned(), value.trim().to_owned())),
        _ => Err("write KEY=VALUE, such as time.step=1e-6 or size=83k".to_owned()),
    }
}

/// Reads a case file. Lines in messages are those of the text with presets and overrides applied; its name says so.
pub(crate) fn load(path: &Path, set: &[(String, String)]) -> Result<Loaded, Reports> {
    let name = |mut problems: Problems| {
        if !problems.source.text.is_empty() {
            problems.source.name += &with(set);
        }
        Reports::from(problems)
    };
    let mut loaded = tdem_case::load(path, set).map_err(name)?;
    loaded.source.name += &with(set);
    Ok(loaded)
}

fn with(set: &[(String, String)]) -> String {
    set.iter().flat_map(|(key, value)| [" --set ", key, "=", value]).collect()
}

/// Builds a case; other runs that it begins from are read.
pub(crate) fn build(loaded: &Loaded) -> Result<Built, Reports> {
    Ok(loaded.build_within(&run, memory::total())?)
}

/// Reads the final state of another run.
pub(crate) fn run(directory: &Path) -> Result<State, String> {
    load_final_state(directory).map(|last| last.state).map_err(|error| error.to_string())
}

/// The case that a run keeps.
pub(crate) fn kept(loaded: &Loaded, built: &Built) -> Result<String, Reports> {
    let kept = loaded.kept(built);
    kept.map_err(|error| Report::new(tdem_case::codes::STEP, format!("the time step cannot be used: {error}")).into())
}

/// What frames hold.
pub(crate) fn contents(fields: Fields) -> Contents {
    Contents {
        contacts: fields.contacts,
        bonds: fields.bonds,
        precision: match fields.precision {
            tdem_case::schema::Precision::Single => Precision::Single,
            tdem_case::schema::Precision::Double => Precision::Double,
        },
        compression: fields.compression,
    }
}

/// What is drawn at the end.
pub(crate) fn curves(case: &Case) -> Vec<Curve> {
    let axis = |column: &str, [factor, offset]: [f64; 2], title: &Option<String>| Axis {
        offset,
        column: column.to_owned(),
        factor,
        title: title.clone(),
    };
    let curves = case.curve.iter().map(|curve| Curve {
        name: curve.name.clone(),
        x: axis(&curve.x, [curve.x_factor, curve.x_offset], &curve.x_title),
        y: axis(&curve.y, [curve.y_factor, curve.y_offset], &curve.y_title),
        against: curve.against.iter().map(|of| (of.name.clone(), of.values.points())).collect(),
    });
    curves.collect()
}

/// What is drawn as the run goes on.
pub(crate) fn pictures(case: &Case) -> Vec<Series> {
    let scale = scale(case);
    let series = |picture: Picture| Series {
        options: picture::Options {
            width: picture.size[0],
            height: picture.size[1],
            direction: picture.direction.unwrap_or(picture.view.unwrap_or_default().direction()),
            subject: if picture.close { Subject::Particles } else { Subject::Domain },
            colour: colour(picture.field),
            range: picture.range.map(|range| in_kelvin(case, picture.field, range)),
            map: picture.colour_map.map(colour_map),
            background: background(picture.background),
            scale,
            clip: picture.clip.map(|clip| picture::Clip { point: clip.point, normal: clip.normal }),
            walls: picture.walls,
            bar: picture.bar,
            ..picture::Options::default()
        },
        name: picture.name,
    };
    case.pictures().into_iter().map(series).collect()
}

/// What a picture shows.
pub(crate) fn colour(field: Field) -> Colour {
    match field {
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

/// Which colours it has.
pub(crate) fn colour_map(map: schema::ColourMap) -> ColourMap {
    match map {
        schema::ColourMap::Viridis => ColourMap::Viridis,
        schema::ColourMap::Inferno => ColourMap::Inferno,
        schema::ColourMap::Coolwarm => ColourMap::Coolwarm,
        schema::ColourMap::Grey => ColourMap::Grey,
    }
}

/// What lies behind.
pub(crate) fn background(background: schema::Background) -> Background {
    match background {
        schema::Background::White => Background::White,
        schema::Background::Dark => Background::Dark,
        schema::Background::Transparent => Background::Transparent,
    }
}

/// The scale of temperatures of a case.
pub(crate) fn scale(case: &Case) -> Scale {
    match case.heat.as_ref().map(|heat| heat.scale) {
        Some(schema::Scale::Celsius) => Scale::Celsius,
        Some(schema::Scale::Kelvin) | None => Scale::Kelvin,
    }
}

/// A range of a field, in SI units: temperatures stand in cases on the scale of the case.
pub(crate) fn in_kelvin(case: &Case, field: Field, range: [f64; 2]) -> [f64; 2] {
    match (&case.heat, field) {
        (Some(heat), Field::Temperature) => range.map(|value| value + heat.scale.zero()),
        _ => range,
    }
}

/// What frames tell beside their numbers.
pub(crate) fn names(case: &Case) -> Names {
    Names { title: case.title.clone(), materials: case.material.keys().cloned().collect() }
}

/// The domain of a case.
pub(crate) fn domain(case: &Case) -> Domain {
    let schema::Domain { min, max, periodic } = case.domain;
    Domain { min, max, periodic }
}

/// Whether a state belongs to a case: what a run never changes must be what the case says.
pub(crate) fn belongs(state: &State, built: &Built) -> bool {
    let first = &built.state;
    state.id == first.id
        && state.material == first.material
        && state.constraint == first.constraint
        && state.mass == first.mass
}
