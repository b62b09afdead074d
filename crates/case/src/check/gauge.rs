//! What the text shows to be wrong with gauges and curves.

use super::Checker;
use crate::codes;
use crate::problem::Problem;
use crate::schema::Gauge;
use crate::structure::suggestion;
use std::collections::BTreeMap;
use std::ops::Range;

/// Columns that every run has in `history.csv`.
pub const HISTORY_COLUMNS: [&str; 20] = [
    "step",
    "time",
    "kinetic_translation",
    "kinetic_rotation",
    "elastic_normal",
    "elastic_tangential",
    "gravitational",
    "friction_dissipated",
    "damping_dissipated",
    "stiffening_work",
    "external_work",
    "energy_error",
    "unbalanced_force_ratio",
    "contacts",
    "wall_contacts",
    "largest_speed",
    "largest_overlap",
    "wall_force_x",
    "wall_force_y",
    "wall_force_z",
];

/// Columns that it has in runs with bonds, besides.
pub const HISTORY_COLUMNS_OF_BONDS: [&str; 4] = ["elastic_bonds", "breakage_dissipated", "bonds", "broken_bonds"];

/// Columns that it has in runs with heat, besides.
pub const HISTORY_COLUMNS_OF_HEAT: [&str; 10] = [
    "heat_time",
    "heat_stored",
    "heat_in",
    "heat_out",
    "heat_made",
    "heat_error",
    "expansion_work",
    "lowest_temperature",
    "mean_temperature",
    "highest_temperature",
];

/// Columns of a gauge, behind its name.
const OF: [&str; 6] = ["force_x", "force_y", "force_z", "displacement_x", "displacement_y", "displacement_z"];
const WARM: [&str; 1] = ["temperature"];
const SURFACE: [&str; 2] = ["temperature", "heat_rate"];
const BETWEEN: [&str; 2] = ["elongation", "strain"];

impl Gauge {
    /// Its columns in `history.csv`, of a run with heat or without.
    #[must_use]
    pub fn columns(&self, heat: bool) -> Vec<String> {
        let (endings, more): (&[&str], &[&str]) = match (&self.between, &self.surface) {
            (Some(_), _) => (&BETWEEN, &[]),
            (None, Some(_)) => (&SURFACE, &[]),
            (None, None) => (&OF, if heat { &WARM } else { &[] }),
        };
        endings.iter().chain(more).map(|ending| format!("{}_{ending}", self.name)).collect()
    }
    /// The names of what it watches.
    pub(crate) fn watched(&self) -> impl Iterator<Item = &str> {
        self.of.iter().chain(self.between.iter().flatten()).map(String::as_str)
    }
}

impl Checker<'_> {
    /// Whether a gauge watches, or a surface belongs to, a group or zone of this name.
    pub(super) fn is_watched(&self, name: &str) -> bool {
        let surfaces = self.case.surface.iter().filter_map(|surface| surface.of.as_deref());
        let gauges = self.case.gauge.iter().flat_map(Gauge::watched);
        !name.is_empty() && gauges.chain(surfaces).any(|watched| watched == name)
    }

    pub(super) fn gauges(&mut self) {
        let known = HISTORY_COLUMNS.iter().chain(&HISTORY_COLUMNS_OF_BONDS).chain(&HISTORY_COLUMNS_OF_HEAT);
        let mut columns: BTreeMap<String, Option<Range<usize>>> =
            known.map(|column| ((*column).to_owned(), None)).collect();
        for (k, gauge) in self.case.gauge.iter().enumerate() {
            let index = k.to_string();
            let place = self.place(&["gauge", &index, "name"]);
            self.file_name(&gauge.name, place.clone());
            self.watches(gauge, &index);
            for column in gauge.columns(self.case.heat.is_some()) {
                if let Some(first) = columns.insert(column.clone(), Some(place.clone())) {
                    let problem = Problem::new(
                        codes::DUPLICATE_NAME,
                        format!("two columns of the history would be called `{column}`"),
                    );
                    let problem = problem.at(place.clone(), "again here").help("choose another name");
                    self.push(match first {
                        Some(first) => problem.at(first, "first here"),
                        None => problem,
                    });
                    break;
                }
            }
        }
        self.curves(&columns.into_keys().collect::<Vec<_>>());
    }

    /// What becomes part of a column or of a file must not need quotes anywhere.
    pub(super) fn file_name(&mut self, name: &str, place: Range<usize>) {
        if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-') {
            self.push(
                Problem::new(codes::NAME, format!("\"{name}\" cannot be part of a column or a file name"))
                    .at(place, "letters, digits, `_` and `-` only"),
            );
        }
    }

    fn watches(&mut self, gauge: &Gauge, index: &str) {
        let given =
            [("of", gauge.of.is_some()), ("between", gauge.between.is_some()), ("surface", gauge.surface.is_some())];
        let given: Vec<&str> = given.into_iter().filter_map(|(key, there)| there.then_some(key)).collect();
        if let [one, other, ..] = given.as_slice() {
            return self.exclusive(&["gauge", index], one, other);
        }
        if let Some(name) = &gauge.surface {
            return self.watched_surface(name, &["gauge", index, "surface"]);
        }
        match (&gauge.of, &gauge.between) {
            (None, None) => {
                let place = self.place(&["gauge", index]);
                self.push(
                    Problem::new(codes::MISSING_KEY, format!("nothing says what `{}` watches", gauge.name))
                        .at(place, "`of`, `between` or `surface` belongs here")
                        .help("add of = \"...\", the name of a group of particles or of a zone"),
                );
            }
            (Some(name), None) => self.watched(name, &["gauge", index, "of"]),
            (_, Some(names)) => {
                for (n, name) in names.iter().enumerate() {
                    self.watched(name, &["gauge", index, "between", &n.to_string()]);
                }
                if names[0] == names[1] {
                    let place = self.place(&["gauge", index, "between"]);
                    self.push(
                        Problem::new(codes::GAUGE_OF_ONE, format!("`{}` is not away from itself", names[0]))
                            .at(place, "two different ones belong here"),
                    );
                }
            }
        }
    }

    /// A name that one surface must have.
    fn watched_surface(&mut self, name: &str, path: &[&str]) {
        let names: Vec<&str> =
            self.case.surface.iter().map(|surface| surface.name.as_str()).filter(|name| !name.is_empty()).collect();
        let place = self.place(path);
        match names.iter().filter(|known| **known == name).count() {
            0 => {
                let message = format!("no surface is called `{name}`");
                let help = suggestion(name, &names);
                self.push(Problem::new(codes::UNKNOWN_SURFACE, message).at(place, "not defined").help(help));
            }
            1 => {}
            _ => self.push(
                Problem::new(codes::DUPLICATE_NAME, format!("several surfaces are called `{name}`"))
                    .at(place, "which of them?")
                    .help("give each its own name"),
            ),
        }
    }

    /// A name that one group of particles or one zone must have.
    pub(super) fn watched(&mut self, name: &str, path: &[&str]) {
        let places = self.named(name);
        let place = self.place(path);
        let names: Vec<&str> = (self.case.particles.iter().map(|group| group.name.as_str()))
            .chain(self.case.zone.iter().map(|zone| zone.name.as_str()))
            .filter(|name| !name.is_empty())
            .collect();
        match places.as_slice() {
            [] => {
                let message = format!("no group of particles and no zone is called `{name}`");
                let help = suggestion(name, &names);
                self.push(Problem::new(codes::UNKNOWN_GROUP, message).at(place, "not defined").help(help));
            }
            [first, second, ..] => {
                let problem =
                    Problem::new(codes::DUPLICATE_NAME, format!("two are called `{name}`, and it is referred to"));
                let problem = problem.at(second.clone(), "again here").at(first.clone(), "first here");
                self.push(problem.at(place, "which of them?").help("give each its own name"));
            }
            [_] => {}
        }
    }

    /// Where groups and zones get a name.
    fn named(&self, name: &str) -> Vec<Range<usize>> {
        let groups = self.case.particles.iter().map(|group| &group.name).enumerate().map(|entry| ("particles", entry));
        let zones = self.case.zone.iter().map(|zone| &zone.name).enumerate().map(|entry| ("zone", entry));
        groups
            .chain(zones)
            .filter(|(_, (_, known))| *known == name)
            .map(|(table, (k, _))| self.place(&[table, &k.to_string(), "name"]))
            .collect()
    }

    fn curves(&mut self, columns: &[String]) {
        let bonds = self.case.model.bonds();
        let heat = self.case.heat.is_some();
        let columns: Vec<&str> = columns
            .iter()
            .map(String::as_str)
            .filter(|column| bonds || !HISTORY_COLUMNS_OF_BONDS.contains(column))
            .filter(|column| heat || !HISTORY_COLUMNS_OF_HEAT.contains(column))
            .collect();
        let mut names: BTreeMap<&str, Range<usize>> = BTreeMap::new();
        for (k, curve) in self.case.curve.iter().enumerate() {
            let index = k.to_string();
            let place = self.place(&["curve", &index, "name"]);
            self.file_name(&curve.name, place.clone());
            if let Some(first) = names.insert(&curve.name, place.clone()) {
                self.push(
                    Problem::new(codes::DUPLICATE_NAME, format!("two curves are called `{}`", curve.name))
                        .at(place, "again here")
                        .at(first, "first here")
                        .help("give each its own name"),
                );
            }
            for (key, column, factor) in [("x", &curve.x, curve.x_factor), ("y", &curve.y, curve.y_factor)] {
                if !columns.contains(&column.as_str()) {
                    let place = self.place(&["curve", &index, key]);
                    let message = format!("the history has no column `{column}`");
                    let help = suggestion(column, &columns);
                    self.push(Problem::new(codes::UNKNOWN_COLUMN, message).at(place, "not there").help(help));
                }
                if factor == 0.0 {
                    let place = self.place(&["curve", &index, &format!("{key}_factor")]);
                    let message = format!("a factor of 0 leaves nothing of `{column}`");
                    self.push(Problem::new(codes::OUT_OF_RANGE, message).at(place, "must not be 0"));
                }
            }
        }
    }
}
