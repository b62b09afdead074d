//! Which columns of a history belong into one chart.

use super::chart::{Chart, Line};
use super::history::History;
use super::html::shown;
use crate::axis::{prefix, unit_of_time};
use crate::curve::{self, Curve, Found};
use crate::glossary::unit_of_column;
use std::path::Path;

/// A part of the page with charts.
pub(super) struct Group {
    pub(super) title: &'static str,
    pub(super) charts: Vec<Chart>,
}

/// A chart of columns that every run, or every run of its kind, may have.
struct Plan {
    title: &'static str,
    /// What the vertical axis measures.
    measure: &'static str,
    columns: &'static [(&'static str, &'static str)],
    logarithmic: bool,
}

const ENERGY: &[Plan] = &[
    Plan {
        title: "Energies",
        measure: "energy",
        columns: &[
            ("kinetic_translation", "kinetic, translation"),
            ("kinetic_rotation", "kinetic, rotation"),
            ("elastic_normal", "normal springs"),
            ("elastic_tangential", "tangential springs"),
            ("elastic_bonds", "bonds"),
            ("gravitational", "gravity"),
        ],
        logarithmic: false,
    },
    Plan {
        title: "Work and losses since the start",
        measure: "energy",
        columns: &[
            ("external_work", "work of walls, motion and forces"),
            ("expansion_work", "work of expansion"),
            ("stiffening_work", "work of stiffening"),
            ("friction_dissipated", "lost by friction"),
            ("damping_dissipated", "lost by dashpots"),
            ("breakage_dissipated", "gone with bonds"),
        ],
        logarithmic: false,
    },
    Plan {
        title: "What the energy ledger does not explain",
        measure: "energy",
        columns: &[("energy_error", "error")],
        logarithmic: false,
    },
];

const HEAT: &[Plan] = &[
    Plan {
        title: "Temperatures of particles",
        measure: "temperature",
        columns: &[("highest_temperature", "highest"), ("mean_temperature", "mean"), ("lowest_temperature", "lowest")],
        logarithmic: false,
    },
    Plan {
        title: "Heat since the start",
        measure: "heat",
        columns: &[
            ("heat_in", "came in"),
            ("heat_out", "went out"),
            ("heat_stored", "stored"),
            ("heat_made", "made by friction and dashpots"),
        ],
        logarithmic: false,
    },
    Plan {
        title: "What the balance of heat does not explain",
        measure: "heat",
        columns: &[("heat_error", "error")],
        logarithmic: false,
    },
];

const MOTION: &[Plan] = &[
    Plan {
        title: "Largest speed",
        measure: "speed",
        columns: &[("largest_speed", "largest speed")],
        logarithmic: false,
    },
    Plan {
        title: "Unbalanced force ratio",
        measure: "ratio",
        columns: &[("unbalanced_force_ratio", "mean resultant over mean force of a contact or bond")],
        logarithmic: true,
    },
    Plan {
        title: "Contacts",
        measure: "number",
        columns: &[("contacts", "between particles"), ("wall_contacts", "with walls")],
        logarithmic: false,
    },
    Plan {
        title: "Largest overlap",
        measure: "overlap over radius",
        columns: &[("largest_overlap", "over the smaller radius, walls included")],
        logarithmic: false,
    },
    Plan {
        title: "Force on all walls together",
        measure: "force",
        columns: &[("wall_force_x", "x"), ("wall_force_y", "y"), ("wall_force_z", "z")],
        logarithmic: false,
    },
];

const BONDS: &[Plan] = &[Plan {
    title: "Bonds that broke",
    measure: "number",
    columns: &[("broken_bonds", "broken bonds")],
    logarithmic: false,
}];

/// Endings of columns of gauges, what they measure, and whether all gauges share a chart.
const OF_GAUGES: &[(&str, &str, bool)] = &[
    ("_temperature", "temperature", true),
    ("_heat_rate", "heat rate", true),
    ("_strain", "strain", true),
    ("_elongation", "elongation", true),
    ("_force_", "force", false),
    ("_displacement_", "displacement", false),
];

/// All charts of a history.
pub(super) fn of_history(history: &History) -> Vec<Group> {
    let charts = |plans: &[Plan]| plans.iter().filter_map(|plan| of_plan(history, plan)).collect();
    let groups = [
        Group { title: "Heat", charts: charts(HEAT) },
        Group { title: "Bonds", charts: charts(BONDS) },
        Group { title: "Gauges", charts: of_gauges(history) },
        Group { title: "Energy ledger", charts: charts(ENERGY) },
        Group { title: "Motion and contacts", charts: charts(MOTION) },
    ];
    groups.into_iter().filter(|group| !group.charts.is_empty()).collect()
}

fn of_plan(history: &History, plan: &Plan) -> Option<Chart> {
    let columns: Vec<(String, &str)> =
        plan.columns.iter().map(|(column, name)| ((*name).to_owned(), *column)).collect();
    chart(history, plan.title.to_owned(), plan.measure, &columns, plan.logarithmic)
}

/// Charts of what gauges add, which stands behind all other columns.
fn of_gauges(history: &History) -> Vec<Chart> {
    let known = drawn_always();
    let of_gauges: Vec<&str> =
        history.names().iter().map(String::as_str).filter(|name| !known.contains(name)).collect();
    let mut charts = Vec::new();
    for (ending, measure, shared) in OF_GAUGES {
        let found: Vec<(&str, &str)> = of_gauges
            .iter()
            .filter_map(|column| {
                let place = column.rfind(ending).filter(|place| {
                    // Endings with an underscore behind have a component there.
                    let rest = column.len() - place - ending.len();
                    rest == usize::from(ending.ends_with('_'))
                })?;
                Some((&column[..place], *column))
            })
            .collect();
        if *shared {
            let columns: Vec<(String, &str)> =
                found.iter().map(|(gauge, column)| ((*gauge).to_owned(), *column)).collect();
            charts.extend(chart(history, capital(measure), measure, &columns, false));
        } else {
            let mut gauges: Vec<&str> = found.iter().map(|(gauge, _)| *gauge).collect();
            gauges.dedup();
            for gauge in gauges {
                let of_one = found.iter().filter(|(owner, _)| *owner == gauge);
                let columns: Vec<(String, &str)> =
                    of_one.map(|(_, column)| (column[column.len() - 1..].to_owned(), *column)).collect();
                charts.extend(chart(history, format!("{} of {gauge}", capital(measure)), measure, &columns, false));
            }
        }
    }
    charts
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Columns that belong to no gauge and are drawn.
fn drawn_always() -> Vec<&'static str> {
    [ENERGY, HEAT, MOTION, BONDS]
        .into_iter()
        .flatten()
        .flat_map(|plan| plan.columns)
        .map(|(column, _)| *column)
        .collect()
}

/// A chart of columns over time: of the heat, where there is any. Columns that are not there, or always 0, are left out.
fn chart(
    history: &History,
    title: String,
    measure: &str,
    columns: &[(String, &str)],
    logarithmic: bool,
) -> Option<Chart> {
    let (times, what) = match history.column("heat_time") {
        Some(times) => (times, "time of the heat"),
        None => (history.column("time")?, "time"),
    };
    let (unit, size) = unit_of_time(largest(times));
    let present: Vec<(&String, &[f64])> = columns
        .iter()
        .filter_map(|(name, column)| Some((name, history.column(column)?)))
        .filter(|(_, values)| values.iter().any(|value| value.is_finite() && *value != 0.0))
        .collect();
    let unit_of_values = columns.iter().find_map(|(_, column)| unit_of_column(column)).unwrap_or("1");
    let most = present.iter().map(|(_, values)| largest(values)).fold(0.0, f64::max);
    let (values_title, scale) = scaled(measure, unit_of_values, most, logarithmic);
    let line = |(name, values): (&String, &[f64])| Line {
        name: name.clone(),
        points: times
            .iter()
            .zip(values)
            .map(|(time, value)| (time / size, value / scale))
            .filter(|(time, value)| time.is_finite() && value.is_finite() && (!logarithmic || *value > 0.0))
            .collect(),
        dashed: false,
    };
    let lines: Vec<Line> = present.into_iter().map(line).collect();
    let axes = [format!("{what} ({unit})"), values_title];
    (!lines.is_empty()).then(|| Chart { title, axes, logarithmic, lines, notes: Vec::new() })
}

fn largest(values: &[f64]) -> f64 {
    values.iter().filter(|value| value.is_finite()).fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// Title of a vertical axis, and what its values are divided by.
fn scaled(measure: &str, unit: &str, largest: f64, logarithmic: bool) -> (String, f64) {
    match unit {
        "1" => (measure.to_owned(), 1.0),
        "J" | "N" | "W" | "m" | "Pa" | "m/s" if !logarithmic => {
            let (prefix, size) = prefix(largest);
            (format!("{measure} ({prefix}{unit})"), size)
        }
        _ => (format!("{measure} ({unit})"), 1.0),
    }
}

/// The chart of a curve that the case asks for, with how far it is from what it is drawn against; or why there is none.
pub(super) fn of_curve(path: &Path, history: &str, curve: &Curve) -> Result<Chart, String> {
    let Found { points, titles } = curve::find(path, history, curve).map_err(|error| error.to_string())?;
    if points.len() < 2 {
        return Err(format!("the curve `{}` has no two points yet", curve.name));
    }
    let mut notes = Vec::new();
    for (name, reference) in &curve.against {
        if let Some(apart) = Apart::of(&points, reference) {
            notes.push(format!(
                "Computed less \u{201c}{name}\u{201d}: {} in the root mean square, at most {} (at {}), over {} points.",
                shown(apart.root_mean_square, 3),
                shown(apart.largest, 3),
                shown(apart.at, 4),
                apart.count
            ));
        }
    }
    let name = if curve.against.is_empty() { curve.name.clone() } else { "computed".to_owned() };
    let computed = Line { name, points, dashed: false };
    let others = curve.against.iter().map(|(name, points)| Line {
        name: name.clone(),
        points: points.iter().map(|&[x, y]| (x, y)).collect(),
        dashed: true,
    });
    let lines = std::iter::once(computed).chain(others).collect();
    Ok(Chart { title: curve.name.clone(), axes: titles, logarithmic: false, lines, notes })
}

/// How far a curve is from points.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Apart {
    root_mean_square: f64,
    /// The difference of largest size, with its sign.
    largest: f64,
    /// Where it is.
    at: f64,
    count: usize,
}

impl Apart {
    /// Compares at the points that lie within the curve; between its own points, it is straight. A curve that turns back has
    /// no one value there, and is not compared.
    fn of(curve: &[(f64, f64)], points: &[[f64; 2]]) -> Option<Self> {
        if !curve.is_sorted_by(|a, b| a.0 <= b.0) {
            return None;
        }
        let differences: Vec<(f64, f64)> =
            points.iter().filter_map(|&[x, y]| Some((x, value_at(curve, x)? - y))).collect();
        let largest = differences.iter().copied().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let squares: f64 = differences.iter().map(|(_, difference)| difference * difference).sum();
        let root_mean_square = (squares / differences.len() as f64).sqrt();
        Some(Apart { root_mean_square, largest: largest.1, at: largest.0, count: differences.len() })
    }
}

/// The value of a curve; none outside it.
fn value_at(curve: &[(f64, f64)], x: f64) -> Option<f64> {
    let after = curve.partition_point(|point| point.0 < x);
    match (after.checked_sub(1).and_then(|before| curve.get(before)), curve.get(after)) {
        (_, Some(&(at, y))) if at == x => Some(y),
        (Some(&(x0, y0)), Some(&(x1, y1))) => Some(y0 + (y1 - y0) * (x - x0) / (x1 - x0)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glossary::Place;

    #[test]
    fn every_column_of_the_glossary_is_drawn_or_left_out_on_purpose() {
        let drawn = drawn_always();
        let left_out = ["step", "time", "heat_time", "bonds"];
        let entries = [Place::History.entries(), Place::History.with_bonds(), Place::History.with_heat()].concat();
        for column in entries.iter().flat_map(crate::glossary::Entry::columns) {
            assert!(drawn.contains(&column.as_str()) != left_out.contains(&column.as_str()), "{column}");
        }
        for column in drawn {
            assert!(unit_of_column(column).is_some(), "there is no column {column}");
        }
    }

    #[test]
    fn gauges_are_told_apart() {
        let text = "step,time,top_temperature,bottom_temperature,a_force_x,a_force_y,my_grip_displacement_z\n\
                    0,0,300,290,1,0,1e-6\n1,1,310,291,2,0,2e-6\n";
        let charts = of_gauges(&History::read(text));
        let told: Vec<(&str, usize)> = charts.iter().map(|chart| (chart.title.as_str(), chart.lines.len())).collect();
        // Columns that are always 0 are left out.
        assert_eq!(told, [("Temperature", 2), ("Force of a", 1), ("Displacement of my_grip", 1)]);
        assert_eq!(charts[2].axes[1], "displacement (\u{b5}m)");
    }

    #[test]
    fn a_curve_is_compared_where_its_reference_has_points() {
        let curve: Vec<(f64, f64)> = (0..=10).map(|k| (f64::from(k), 2.0 * f64::from(k))).collect();
        let apart = Apart::of(&curve, &[[0.5, 1.0], [4.0, 11.0], [20.0, 0.0]]).expect("two points lie within");
        assert_eq!((apart.largest, apart.at, apart.count), (-3.0, 4.0, 2));
        assert!((apart.root_mean_square - (4.5_f64).sqrt()).abs() < 1e-12);
        assert_eq!(Apart::of(&[(0.0, 0.0), (1.0, 1.0), (0.5, 2.0)], &[[0.2, 0.0]]), None);
        assert_eq!(Apart::of(&curve, &[[11.0, 0.0]]), None);
    }
}
