//! The names, units and meanings of everything a run writes, in one table per place where it is written.
//!
//! Each line also says how the values are found, so that what is written and what is documented cannot part ways.
//! Vectors have three components; in `history.csv` they take three columns, `_x`, `_y`, `_z`. Symmetric tensors have six,
//! in VTK's order: xx, yy, zz, xy, yz, xz.

use crate::blocks::{Link, Pair, Scene, WallSum};
use crate::history::Row;
use rayon::prelude::*;
use std::borrow::Cow;
use tdem_engine::{HeatLedger, Reading};

/// A quantity that is written somewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its name: a dataset, or a column.
    pub name: &'static str,
    /// SI unit; `1` for a pure number.
    pub unit: &'static str,
    /// What it is.
    pub description: &'static str,
    /// How it is stored.
    pub kind: Kind,
    /// 1, 3 for a vector, or 6 for a symmetric tensor.
    pub components: usize,
}

/// How a quantity is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Computed in double precision; stored in single precision in frames unless asked otherwise.
    Real,
    /// A small integer, 32 bits.
    Integer,
    /// A persistent id or a number of steps, 64 bits.
    Id,
}

/// Where quantities are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Points of `particles.vtkhdf`.
    Particles,
    /// Lines of `contacts.vtkhdf`.
    Contacts,
    /// Polygons of `walls.vtkhdf`.
    Walls,
    /// Lines of `bonds.vtkhdf`.
    Bonds,
    /// Points of `cracks.vtkhdf`.
    Cracks,
    /// Columns of `history.csv`.
    History,
}

impl Place {
    /// All places.
    pub const ALL: [Place; 6] =
        [Place::Particles, Place::Contacts, Place::Walls, Place::Bonds, Place::Cracks, Place::History];

    /// Name of the block or file, without ending.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Place::Particles => "particles",
            Place::Contacts => "contacts",
            Place::Walls => "walls",
            Place::Bonds => "bonds",
            Place::Cracks => "cracks",
            Place::History => "history",
        }
    }

    /// What is written there in every run, in the order in which it is written; [`Place::with_bonds`] follows.
    #[must_use]
    pub fn entries(self) -> Vec<Entry> {
        match self {
            Place::Particles => PARTICLES.iter().map(|quantity| quantity.entry).collect(),
            Place::Contacts => CONTACTS.iter().map(|quantity| quantity.entry).collect(),
            Place::Walls => WALLS.iter().map(|quantity| quantity.entry).collect(),
            Place::Bonds => BONDS.iter().map(|quantity| quantity.entry).collect(),
            Place::Cracks => CRACKS.iter().map(|quantity| quantity.entry).collect(),
            Place::History => HISTORY.iter().map(|quantity| quantity.entry).collect(),
        }
    }

    /// What else is written there in runs with bonds.
    #[must_use]
    pub fn with_bonds(self) -> Vec<Entry> {
        match self {
            Place::Particles => PARTICLES_WITH_BONDS.iter().map(|quantity| quantity.entry).collect(),
            Place::History => HISTORY_WITH_BONDS.iter().map(|quantity| quantity.entry).collect(),
            Place::Contacts | Place::Walls | Place::Bonds | Place::Cracks => Vec::new(),
        }
    }

    /// What else is written there in runs with heat, behind what is written with bonds.
    #[must_use]
    pub fn with_heat(self) -> Vec<Entry> {
        match self {
            Place::Particles => PARTICLES_WITH_HEAT.iter().map(|quantity| quantity.entry).collect(),
            Place::History => HISTORY_WITH_HEAT.iter().map(|quantity| quantity.entry).collect(),
            Place::Contacts | Place::Walls | Place::Bonds | Place::Cracks => Vec::new(),
        }
    }

    /// What gauges add, for each [`GaugeKind`] in order; NAME stands for the name of the gauge.
    #[must_use]
    pub fn of_gauges(self) -> [Vec<Entry>; 4] {
        match self {
            Place::History => GaugeKind::ALL.map(|kind| kind.quantities().map(|quantity| quantity.entry).collect()),
            _ => [const { Vec::new() }; 4],
        }
    }
}

impl Entry {
    /// Column names: the name itself, or one per component.
    pub fn columns(&self) -> impl Iterator<Item = String> + use<> {
        let (name, components) = (self.name, self.components);
        let suffix = |component: usize| ["_x", "_y", "_z"].get(component).copied().unwrap_or_default();
        (0..components)
            .map(move |component| if components > 1 { format!("{name}{}", suffix(component)) } else { name.into() })
    }
}

/// The glossary as a table in Markdown, for the documentation of users.
#[must_use]
pub fn markdown() -> String {
    let mut text = String::from("| where | name | unit | components | meaning |\n|---|---|---|---|---|\n");
    for place in Place::ALL {
        let of_gauges = place.of_gauges().concat();
        // What a gauge of a group adds stands there once more with heat.
        let mut told = std::collections::BTreeSet::new();
        let all = place.entries().into_iter().chain(place.with_bonds()).chain(place.with_heat()).chain(of_gauges);
        for entry in all.filter(|entry| told.insert(entry.name)) {
            let Entry { name, unit, description, components, .. } = entry;
            let line = [place.name(), &format!("`{name}`"), unit, &components.to_string(), description].join(" | ");
            text.extend(["| ", &line, " |\n"]);
        }
    }
    text
}

/// Values of a quantity, row by row.
pub(crate) enum Values<'a> {
    Real(Cow<'a, [f64]>),
    Integer(Vec<i64>),
}

/// A quantity and how its values are found.
pub(crate) struct Quantity<F> {
    pub(crate) entry: Entry,
    pub(crate) values: F,
}

type OfParticles = for<'a> fn(&Scene<'a>) -> Values<'a>;
type OfPairs = fn(&[Pair]) -> Values<'static>;
type OfLinks = fn(&[Link]) -> Values<'static>;
type OfWalls = fn(&Scene<'_>, &[WallSum]) -> Values<'static>;
type OfRow = fn(&Row) -> Values<'static>;
type OfReading = fn(&Reading) -> Values<'static>;

const fn real<F>(name: &'static str, unit: &'static str, description: &'static str, values: F) -> Quantity<F> {
    Quantity { entry: Entry { name, unit, description, kind: Kind::Real, components: 1 }, values }
}
const fn vector<F>(name: &'static str, unit: &'static str, description: &'static str, values: F) -> Quantity<F> {
    Quantity { entry: Entry { name, unit, description, kind: Kind::Real, components: 3 }, values }
}
const fn tensor<F>(name: &'static str, unit: &'static str, description: &'static str, values: F) -> Quantity<F> {
    Quantity { entry: Entry { name, unit, description, kind: Kind::Real, components: 6 }, values }
}
const fn integer<F>(name: &'static str, description: &'static str, values: F) -> Quantity<F> {
    Quantity { entry: Entry { name, unit: "1", description, kind: Kind::Integer, components: 1 }, values }
}
const fn id<F>(name: &'static str, description: &'static str, values: F) -> Quantity<F> {
    Quantity { entry: Entry { name, unit: "1", description, kind: Kind::Id, components: 1 }, values }
}

fn borrowed(values: &[f64]) -> Values<'_> {
    Values::Real(Cow::Borrowed(values))
}
fn owned(values: Vec<f64>) -> Values<'static> {
    Values::Real(Cow::Owned(values))
}
fn flat(vectors: &[[f64; 3]]) -> Values<'_> {
    borrowed(vectors.as_flattened())
}
fn integers<T: Copy + Into<i64> + Sync>(values: &[T]) -> Values<'static> {
    Values::Integer(values.par_iter().map(|&value| value.into()).collect())
}
fn reals_of<T: Sync>(items: &[T], value: impl Fn(&T) -> f64 + Send + Sync) -> Values<'static> {
    owned(items.par_iter().map(value).collect())
}
fn vectors_of<T: Sync>(items: &[T], value: impl Fn(&T) -> [f64; 3] + Send + Sync) -> Values<'static> {
    owned(items.par_iter().map(value).collect::<Vec<_>>().into_flattened())
}
fn ids_of<T: Sync>(items: &[T], value: impl Fn(&T) -> i64 + Send + Sync) -> Values<'static> {
    Values::Integer(items.par_iter().map(value).collect())
}
fn one(value: f64) -> Values<'static> {
    owned(vec![value])
}
fn count(value: u64) -> Values<'static> {
    Values::Integer(vec![value.cast_signed()])
}

pub(crate) static PARTICLES: &[Quantity<OfParticles>] = &[
    id("id", "persistent id", |s| integers(&s.state.id)),
    real("radius", "m", "radius", |s| borrowed(&s.state.radius)),
    integer("material", "index of the material", |s| integers(&s.state.material)),
    real("mass", "kg", "mass with which it moves: its own times `time.mass_scaling` of the case", |s| {
        borrowed(&s.state.mass)
    }),
    vector("velocity", "m/s", "velocity", |s| flat(&s.state.velocity)),
    vector("angular_velocity", "rad/s", "angular velocity", |s| flat(&s.state.angular_velocity)),
    vector("force", "N", "resultant force, gravity included", |s| flat(&s.state.force)),
    vector("moment", "N m", "resultant moment", |s| flat(&s.state.moment)),
    vector(
        "displacement",
        "m",
        "way from the start of the run, unfolded where the domain repeats; computed in double precision",
        |s| owned(s.displacement()),
    ),
    integer("coordination_number", "number of particles touched", |s| Values::Integer(s.coordination_number())),
];

pub(crate) static PARTICLES_WITH_BONDS: &[Quantity<OfParticles>] = &[
    tensor(
        "stress",
        "Pa",
        "mean stress in the sphere from the forces of contacts and bonds on it, over the sphere's own volume; tension \
         positive; the symmetric part: xx, yy, zz, xy, yz, xz",
        |s| owned(s.stress().into_flattened()),
    ),
    integer("bonds", "number of bonds that hold", |s| Values::Integer(s.bonds_that_hold())),
    real("damage", "1", "share of the particle's bonds that broke; 0 for a particle without any", |s| {
        owned(s.damage())
    }),
];

pub(crate) static PARTICLES_WITH_HEAT: &[Quantity<OfParticles>] = &[
    real("temperature", "K", "temperature", |s| borrowed(&s.state.temperature)),
    real("heat_rate", "W", "heat that it receives from others and through surfaces", |s| borrowed(&s.state.heat_rate)),
];

pub(crate) static CONTACTS: &[Quantity<OfPairs>] = &[
    id("first", "id of the particle where the line begins", |p| ids_of(p, |pair| pair.first)),
    id("second", "id of the particle where the line ends, -1 for a wall", |p| ids_of(p, |pair| pair.second)),
    integer("wall", "index of the wall where the line ends, -1 for a particle", |p| ids_of(p, |pair| pair.wall)),
    real("overlap", "m", "overlap, positive in contact", |p| reals_of(p, |pair| pair.overlap)),
    real("normal_force", "N", "normal force, positive when it pushes apart", |p| reals_of(p, |pair| pair.normal_force)),
    vector("force", "N", "force on the first particle", |p| vectors_of(p, |pair| pair.force)),
    vector("tangential_displacement", "m", "stored displacement of the second surface relative to the first", |p| {
        vectors_of(p, |pair| pair.displacement)
    }),
];

pub(crate) static BONDS: &[Quantity<OfLinks>] = &[
    id("first", "id of the particle where the line begins", |b| ids_of(b, |link| link.first)),
    id("second", "id of the particle where the line ends", |b| ids_of(b, |link| link.second)),
    integer("holds", "1 while the bond holds, 0 once it is broken; forces and stresses are then zero", |b| {
        ids_of(b, |link| link.breakage.is_none().into())
    }),
    vector("force", "N", "force on the first particle, that of dashpots included", |b| {
        vectors_of(b, |link| link.force)
    }),
    real("normal_force", "N", "normal force of the spring, positive in tension", |b| {
        reals_of(b, |link| link.load.normal)
    }),
    vector("shear_force", "N", "shear force of the spring on the first particle", |b| {
        vectors_of(b, |link| link.load.shear.into())
    }),
    real("torsion_moment", "N m", "moment of torsion of the spring on the first particle, about the normal", |b| {
        reals_of(b, |link| link.load.torsion)
    }),
    vector("bending_moment", "N m", "moment of bending of the spring on the first particle", |b| {
        vectors_of(b, |link| link.load.bending.into())
    }),
    real("tensile_stress", "Pa", "greatest tensile stress in the section, bending included", |b| {
        reals_of(b, |link| link.stress.tensile)
    }),
    real("shear_stress", "Pa", "greatest shear stress in the section, torsion included", |b| {
        reals_of(b, |link| link.stress.shear)
    }),
    integer("failure", "how it broke: 0 it holds, 1 in tension, 2 in shear", |b| ids_of(b, Link::failure)),
    real("breakage_time", "s", "when it broke; not a number while it holds", |b| {
        reals_of(b, |link| link.breakage_time)
    }),
];

pub(crate) static CRACKS: &[Quantity<OfLinks>] = &[
    id("first", "id of the first particle of the bond", |b| ids_of(b, |link| link.first)),
    id("second", "id of the second particle of the bond", |b| ids_of(b, |link| link.second)),
    vector("normal", "1", "unit vector from the first particle to the second, as they lie now", |b| {
        vectors_of(b, |link| link.normal)
    }),
    real("area", "m^2", "section of the bond", |b| reals_of(b, |link| link.area)),
    id("breakage_step", "step in which it broke", |b| ids_of(b, Link::breakage_step)),
    real("breakage_time", "s", "when it broke", |b| reals_of(b, |link| link.breakage_time)),
    integer("failure", "how it broke: 1 in tension, 2 in shear", |b| ids_of(b, Link::failure)),
    real("energy", "J", "energy that left with the bond", |b| reals_of(b, Link::released_energy)),
];

pub(crate) static WALLS: &[Quantity<OfWalls>] = &[
    integer("wall", "index of the wall, in the order of the case", |s, _| {
        Values::Integer((0..s.plan.walls.len() as i64).collect())
    }),
    integer("material", "index of the material", |s, _| {
        Values::Integer(s.plan.walls.iter().map(|wall| wall.material.into()).collect())
    }),
    vector("velocity", "m/s", "velocity", |s, _| owned(s.plan.walls.iter().flat_map(|wall| wall.velocity).collect())),
    vector("force", "N", "force of all particles on the wall", |_, sums| {
        owned(sums.iter().flat_map(|sum| sum.force).collect())
    }),
    integer("touching", "number of particles that touch the wall", |_, sums| {
        Values::Integer(sums.iter().map(|sum| sum.touching).collect())
    }),
];

pub(crate) static HISTORY: &[Quantity<OfRow>] = &[
    id("step", "number of steps done", |r| count(r.step)),
    real("time", "s", "time", |r| one(r.time)),
    real("kinetic_translation", "J", "kinetic energy of translation, of the masses that move", |r| {
        one(r.ledger.kinetic_translation)
    }),
    real("kinetic_rotation", "J", "kinetic energy of rotation, of the masses that move", |r| {
        one(r.ledger.kinetic_rotation)
    }),
    real("elastic_normal", "J", "energy stored in normal springs", |r| one(r.ledger.elastic_normal)),
    real("elastic_tangential", "J", "energy stored in tangential springs", |r| one(r.ledger.elastic_tangential)),
    real("gravitational", "J", "potential energy of gravity", |r| one(r.ledger.gravitational)),
    real("friction_dissipated", "J", "dissipated by sliding since the start", |r| one(r.ledger.friction_dissipated)),
    real("damping_dissipated", "J", "dissipated by dashpots since the start", |r| one(r.ledger.damping_dissipated)),
    real("stiffening_work", "J", "put into tangential springs by a change of their stiffness since the start", |r| {
        one(r.ledger.stiffening_work)
    }),
    real("external_work", "J", "work of walls, prescribed motion and applied forces since the start", |r| {
        one(r.ledger.external_work)
    }),
    real("energy_error", "J", "what the ledger does not explain: present + dissipated - work - initial energy", |r| {
        one(r.ledger.energy_error)
    }),
    real(
        "unbalanced_force_ratio",
        "1",
        "mean resultant force on a particle, prescribed components left out, over mean force of a contact or bond",
        |r| one(r.ledger.unbalanced_force_ratio),
    ),
    id("contacts", "number of touching pairs of particles", |r| count(r.ledger.contacts)),
    id("wall_contacts", "number of particles that touch walls, counted per wall", |r| count(r.ledger.wall_contacts)),
    real("largest_speed", "m/s", "largest speed of a particle", |r| one(r.ledger.largest_speed)),
    real(
        "largest_overlap",
        "1",
        "largest overlap of a pair over its smaller radius, or at a wall over the radius",
        |r| one(r.ledger.largest_overlap),
    ),
    vector("wall_force", "N", "force of the particles on all walls together", |r| owned(r.ledger.wall_force.to_vec())),
];

pub(crate) static HISTORY_WITH_BONDS: &[Quantity<OfRow>] = &[
    real("elastic_bonds", "J", "energy stored in bonds", |r| one(r.ledger.elastic_bonds)),
    real("breakage_dissipated", "J", "gone with bonds that broke since the start", |r| {
        one(r.ledger.breakage_dissipated)
    }),
    id("bonds", "number of bonds that hold", |r| count(r.ledger.bonds)),
    id("broken_bonds", "number of bonds that broke", |r| count(r.ledger.broken_bonds)),
];

pub(crate) static HISTORY_WITH_HEAT: &[Quantity<OfRow>] = &[
    real("heat_time", "s", "time of the heat", |r| one(heat(r).time)),
    real("heat_stored", "J", "heat of all particles, less that at the start", |r| one(heat(r).stored)),
    real("heat_in", "J", "heat that came in since the start", |r| one(heat(r).came_in)),
    real("heat_out", "J", "heat that went out since the start", |r| one(heat(r).went_out)),
    real("heat_made", "J", "heat that friction and dashpots made since the start", |r| one(heat(r).made)),
    real("heat_error", "J", "what the ledger does not explain: stored - in + out - made", |r| one(heat(r).error)),
    real(
        "expansion_work",
        "J",
        "work that expansion and softening did on springs since the start, energy of the motion",
        |r| one(r.ledger.expansion_work),
    ),
    real("lowest_temperature", "K", "lowest temperature of a particle", |r| one(heat(r).lowest)),
    real("mean_temperature", "K", "mean temperature of all particles", |r| one(heat(r).mean)),
    real("highest_temperature", "K", "highest temperature of a particle", |r| one(heat(r).highest)),
];

/// Not a number where there is no heat.
fn heat(row: &Row) -> HeatLedger {
    const NOTHING: HeatLedger = HeatLedger {
        time: f64::NAN,
        stored: f64::NAN,
        came_in: f64::NAN,
        went_out: f64::NAN,
        made: f64::NAN,
        error: f64::NAN,
        lowest: f64::NAN,
        mean: f64::NAN,
        highest: f64::NAN,
    };
    row.ledger.heat.unwrap_or(NOTHING)
}

/// NAME stands for the name of the gauge.
pub(crate) static HISTORY_OF_GROUPS: &[Quantity<OfReading>] = &[
    vector(
        "NAME_force",
        "N",
        "force on the group: contacts, bonds, gravity and applied forces, less local damping; where the group is held or \
         driven, its support exerts the opposite, but for what accelerates the group",
        |r| owned(of_group(r)[0].to_vec()),
    ),
    vector("NAME_displacement", "m", "mean displacement of the group since the start of the run", |r| {
        owned(of_group(r)[1].to_vec())
    }),
];

pub(crate) static HISTORY_BETWEEN_GROUPS: &[Quantity<OfReading>] = &[
    real(
        "NAME_elongation",
        "m",
        "how much farther apart the means of two groups are than at the start, along the line that joined them then",
        |r| one(between_groups(r)[0]),
    ),
    real("NAME_strain", "1", "the elongation over the distance at the start", |r| one(between_groups(r)[1])),
];

pub(crate) static HISTORY_OF_WARM_GROUPS: &[Quantity<OfReading>] =
    &[real("NAME_temperature", "K", "mean temperature of the particles of the group", |r| one(warmth(r)[0]))];

pub(crate) static HISTORY_OF_SURFACES: &[Quantity<OfReading>] = &[
    real("NAME_temperature", "K", "mean temperature of the surface itself", |r| one(warmth(r)[0])),
    real(
        "NAME_heat_rate",
        "W",
        "heat that enters through the surface; where particles are held at its temperature, what they conduct away",
        |r| one(warmth(r)[1]),
    ),
];

/// What gauges may watch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GaugeKind {
    /// A group of particles, without heat.
    Group,
    /// The same with heat.
    WarmGroup,
    /// Two groups.
    Between,
    /// A surface.
    Surface,
}

impl GaugeKind {
    /// All kinds.
    pub const ALL: [GaugeKind; 4] = [GaugeKind::Group, GaugeKind::WarmGroup, GaugeKind::Between, GaugeKind::Surface];

    fn of(reading: &Reading) -> Self {
        match reading {
            Reading::Of { temperature: None, .. } => GaugeKind::Group,
            Reading::Of { temperature: Some(_), .. } => GaugeKind::WarmGroup,
            Reading::Between { .. } => GaugeKind::Between,
            Reading::Surface { .. } => GaugeKind::Surface,
        }
    }

    fn quantities(self) -> impl Iterator<Item = &'static Quantity<OfReading>> {
        let (first, more): (&[_], &[_]) = match self {
            GaugeKind::Group => (HISTORY_OF_GROUPS, &[]),
            GaugeKind::WarmGroup => (HISTORY_OF_GROUPS, HISTORY_OF_WARM_GROUPS),
            GaugeKind::Between => (HISTORY_BETWEEN_GROUPS, &[]),
            GaugeKind::Surface => (HISTORY_OF_SURFACES, &[]),
        };
        first.iter().chain(more)
    }
}

/// What a gauge writes.
pub(crate) fn of_gauge(reading: &Reading) -> impl Iterator<Item = &'static Quantity<OfReading>> {
    GaugeKind::of(reading).quantities()
}

fn warmth(reading: &Reading) -> [f64; 2] {
    match reading {
        Reading::Of { temperature, .. } => [temperature.unwrap_or(f64::NAN), f64::NAN],
        Reading::Surface { temperature, heat_rate } => [*temperature, *heat_rate],
        Reading::Between { .. } => [f64::NAN; 2],
    }
}

fn of_group(reading: &Reading) -> [[f64; 3]; 2] {
    match reading {
        Reading::Of { force, displacement, .. } => [*force, *displacement],
        Reading::Between { .. } | Reading::Surface { .. } => [[f64::NAN; 3]; 2],
    }
}

fn between_groups(reading: &Reading) -> [f64; 2] {
    match reading {
        Reading::Between { elongation, strain } => [*elongation, *strain],
        Reading::Of { .. } | Reading::Surface { .. } => [f64::NAN; 2],
    }
}

/// Unit of a column of `history.csv`, those of gauges included.
#[must_use]
pub fn unit_of_column(column: &str) -> Option<&'static str> {
    let is_it = |entry: &Entry| entry.columns().any(|name| name == column);
    let of_gauge = |entry: &Entry| entry.columns().any(|name| column.ends_with(name.trim_start_matches("NAME")));
    let all = [Place::History.entries(), Place::History.with_bonds(), Place::History.with_heat()].concat();
    let gauges = Place::History.of_gauges().concat();
    all.iter()
        .find(|entry| is_it(entry))
        .or_else(|| gauges.iter().find(|entry| of_gauge(entry)))
        .map(|entry| entry.unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_quantity_is_documented_once_per_place() {
        for place in Place::ALL {
            let [of, _, between, _] = place.of_gauges();
            let entries = [place.entries(), place.with_bonds(), place.with_heat(), of, between].concat();
            let names: BTreeSet<_> = entries.iter().map(|entry| entry.name).collect();
            assert_eq!(names.len(), entries.len(), "a name is used twice in {}", place.name());
            for Entry { name, unit, description, components, .. } in entries {
                assert!(!unit.is_empty() && !description.is_empty(), "{name}");
                assert!(unit.is_ascii() && description.is_ascii(), "attributes of datasets are ASCII: {name}");
                assert!(!name.contains(['/', '.', ',', '|']), "VTK and CSV cannot hold this name: {name}");
                assert!([1, 3, 6].contains(&components), "{name}");
                assert!(components < 6 || place != Place::History, "a column of {name} has no name");
            }
        }
        assert!(markdown().contains("| history | `energy_error` | J | 1 |"));
    }

    #[test]
    fn every_column_has_a_unit() {
        let units = ["time", "wall_force_x", "broken_bonds", "grip_force_y", "a_displacement_z", "middle_strain", "x"]
            .map(unit_of_column);
        assert_eq!(units, [Some("s"), Some("N"), Some("1"), Some("N"), Some("m"), Some("1"), None]);
    }
}
