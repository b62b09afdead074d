//! Bonds: who is bonded to whom, with what, and how fast that can vibrate.

mod crystal;
mod file;
mod joint;
mod tables;
mod vibration;

pub(crate) use vibration::Vibration;

use super::Context;
use super::draft::Draft;
use crate::codes;
use crate::grid::Grid;
use crate::problem::{Problem, counted};
use crate::rng::{Stream, uniform4};
use crate::schema::{BondForm, Case, RunBonds};
use joint::Extent;
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};
use tdem_engine::physics::Vec3;
use tdem_engine::physics::bond::strength::{weibull, weibull_scale};
use tdem_engine::physics::bond::{Damping, Form, Joint, Law, Tension};
use tdem_engine::{Bond, BondPlan, BondTables, Domain, State, Table};

/// The bonds of a case, before particles are in the order of their ids.
#[derive(Clone, Debug)]
pub(crate) struct Bonded {
    /// Indices of particles that are bonded now, each pair once.
    pairs: Vec<[u32; 2]>,
    /// Indices of particles that were bonded in another run, each pair once.
    carried: Vec<[u32; 2]>,
    /// What joins two materials, `(materials, materials)`.
    joints: Vec<Option<Joint<f64>>>,
    /// How that depends on temperature.
    tables: BondTables,
    /// Which [[bond]] says it.
    given: Given,
}

/// The [[bond]] of each pair of materials, `(materials, materials)`.
#[derive(Clone, Debug)]
struct Given {
    materials: usize,
    entries: Vec<Option<usize>>,
}

impl Given {
    fn of(context: &Context<'_>) -> Self {
        let materials = context.materials.len();
        let mut entries = vec![None; materials * materials];
        for (k, joint) in context.loaded.case.bond.iter().enumerate() {
            let [a, b] = joint.between.each_ref().map(|name| usize::from(context.materials.index(name)));
            entries[a * materials + b] = Some(k);
            entries[b * materials + a] = Some(k);
        }
        Given { materials, entries }
    }
    fn entry(&self, state: &State, [first, second]: [usize; 2]) -> Option<usize> {
        self.entries[usize::from(state.material[first]) * self.materials + usize::from(state.material[second])]
    }
}

impl Bonded {
    /// What joins two particles.
    fn joint(&self, state: &State, pair: [usize; 2]) -> Option<&Joint<f64>> {
        let [a, b] = pair.map(|index| usize::from(state.material[index]));
        self.joints[a * self.given.materials + b].as_ref()
    }
    /// The least and the largest factor on the stiffness of a bond, at whatever temperature.
    fn stiffness_factors(&self, state: &State, pair: [usize; 2]) -> [f64; 2] {
        let [a, b] = pair.map(|index| usize::from(state.material[index]));
        let table = self.tables.stiffness.get(a * self.given.materials + b);
        table.map_or([1.0; 2], |table: &Table| [table.least(), table.largest()])
    }
}

/// From one particle to another when they were bonded, m: the nearest image.
fn offset(domain: &Domain, state: &State, [first, second]: [usize; 2]) -> Vec3<f64> {
    let place = |index: usize| Vec3::from(state.bonded_position[index]);
    domain.period().nearest(place(second) - place(first))
}

impl Bonded {
    /// The bonds of a case; none unless its model bonds, or if something is wrong, which is added to `problems`.
    pub(super) fn of(context: &Context<'_>, draft: &Draft, problems: &mut Vec<Problem>) -> Option<Self> {
        let case = &context.loaded.case;
        if case.bond.is_empty() {
            return None;
        }
        let before = problems.len();
        let given = Given::of(context);
        let pairs = match &case.bonds.file {
            Some(file) => file::read(context, draft, &given, file).map_err(|found| problems.extend(found)).ok()?,
            None => near(context, draft, &given, problems),
        };
        let carried = carried(context, draft, &given, problems);
        let mut extents = vec![Extent::default(); case.bond.len()];
        for &pair in pairs.iter().chain(&carried) {
            let pair = pair.map(|index| index as usize);
            if let Some(entry) = given.entry(&draft.state, pair) {
                let length = offset(&context.domain, &draft.state, pair);
                extents[entry].add(pair.map(|index| draft.state.radius[index]), length.dot(length).sqrt());
            }
        }
        let joints: Vec<Option<Joint<f64>>> = (0..case.bond.len())
            .map(|entry| joint::of(context, entry, &extents).map_err(|problem| problems.push(problem)).ok())
            .collect();
        if problems[before..].iter().any(|p| p.severity == crate::Severity::Error) {
            return None;
        }
        problems.extend(crystal::check(context, draft, &given, &[pairs.as_slice(), &carried].concat()));
        let joints = given.entries.iter().map(|entry| entry.and_then(|entry| joints[entry])).collect();
        let tables = tables::of(context, &given);
        Some(Bonded { pairs, carried, joints, tables, given })
    }

    /// Indices of the particles of each bond, and its length, m.
    pub(super) fn lengths(&self, domain: &Domain, state: &State) -> impl Iterator<Item = ([usize; 2], f64)> {
        self.pairs.iter().chain(&self.carried).map(|pair| {
            let pair = pair.map(|index| index as usize);
            let offset = offset(domain, state, pair);
            (pair, offset.dot(offset).sqrt())
        })
    }

    /// What a plan says of them.
    pub(super) fn plan(self, case: &Case) -> BondPlan {
        let damped = self.joints.iter().flatten().any(|joint| joint.cement.damping_ratio > 0.0);
        BondPlan {
            law: Law {
                form: match case.bonds.form {
                    BondForm::Total => Form::Total,
                    BondForm::Incremental => Form::Incremental(Tension::FromLength),
                    BondForm::IncrementalStored => Form::Incremental(Tension::Stored),
                },
                damping: if damped { Damping::Viscous } else { Damping::Off },
            },
            joints: self.joints,
            tables: self.tables,
            contact_in_bonded_pairs: case.bonds.contact_in_bonded_pairs,
            local_damping: case.bonds.local_damping.get(),
        }
    }

    /// The bonds that are made now by ids, with their strengths.
    pub(super) fn bonds(&self, case: &Case, state: &State) -> Vec<Bond> {
        let shapes: Vec<Option<f64>> =
            case.bond.iter().map(|joint| joint.scatter.as_ref().map(|scatter| scatter.weibull_shape.get())).collect();
        let scales: Vec<Option<[f64; 2]>> =
            shapes.iter().map(|shape| shape.map(|shape| [shape, weibull_scale(1.0, shape)])).collect();
        self.pairs
            .par_iter()
            .map(|&pair| {
                let mut ids = pair.map(|index| state.id[index as usize]);
                ids.sort_unstable();
                let entry = self.given.entry(state, pair.map(|index| index as usize));
                let strength = entry.and_then(|entry| scales[entry]).map_or(1.0, |[shape, scale]| {
                    let uniform = uniform4(case.seed, Stream::Strength, ids[0], ids[1], 0)[0];
                    // The middle of the step between two random numbers: a bond without any strength is none.
                    weibull(uniform + 0.5 / 4_294_967_296.0, shape, scale)
                });
                Bond::new(ids[0], ids[1], strength)
            })
            .collect()
    }
}

/// Indices of the particles whose bonds another run made. Each needs a [[bond]] here.
fn carried(context: &Context<'_>, draft: &Draft, given: &Given, problems: &mut Vec<Problem>) -> Vec<[u32; 2]> {
    if draft.carried.is_empty() {
        return Vec::new();
    }
    let state = &draft.state;
    let index_of: HashMap<u32, u32> = state.id.iter().zip(0..).map(|(&id, index)| (id, index)).collect();
    let mut missing: BTreeMap<[u16; 2], (usize, u16)> = BTreeMap::new();
    let mut pairs = Vec::new();
    for (bond, _) in &draft.carried {
        let [Some(&first), Some(&second)] = [bond.first, bond.second].map(|id| index_of.get(&id)) else { continue };
        let pair = [first, second];
        if given.entry(state, pair.map(|index| index as usize)).is_none() {
            let mut materials = pair.map(|index| state.material[index as usize]);
            materials.sort_unstable();
            missing.entry(materials).or_insert((0, draft.group[first as usize])).0 += 1;
        } else {
            pairs.push(pair);
        }
    }
    for (pair, (count, group)) in missing {
        let [a, b] = pair.map(|material| &context.materials.names[usize::from(material)]);
        let message =
            format!("nothing says how `{a}` and `{b}` are bonded, as {} of that run are", counted(count, "pair"));
        problems.push(
            Problem::new(codes::MISSING_BOND, message)
                .at(context.place(usize::from(group), &["run", "bonds"]), "carries these bonds")
                .help(format!("add a [[bond]] with between = [\"{a}\", \"{b}\"]")),
        );
    }
    pairs
}

/// A pair that is bonded, or not because nothing joins its materials.
struct Near {
    pair: [u32; 2],
    joined: bool,
}

/// All pairs that are near enough to each other for the [[bond]] of their materials. Materials that are bonded
/// otherwise, but not where they meet, are worth a warning.
fn near(context: &Context<'_>, draft: &Draft, given: &Given, problems: &mut Vec<Problem>) -> Vec<[u32; 2]> {
    let (case, state, domain) = (&context.loaded.case, &draft.state, &context.domain);
    let bounds = state.position.iter().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[low, high], p| {
        [std::array::from_fn(|k| low[k].min(p[k])), std::array::from_fn(|k| high[k].max(p[k]))]
    });
    let largest = state.radius.iter().copied().fold(0.0, f64::max);
    let reaches = |first: f64, second: f64| case.bond.iter().map(move |joint| joint.reach(first, second));
    let width = reaches(largest, largest).fold(2.0 * largest, f64::max);
    let mut grid = Grid::new(domain, bounds[0], bounds[1], width * (1.0 + 1e-9), state.len());
    state.position.iter().for_each(|&point| grid.push(point));
    let groups = &case.particles;
    let loose = |index: usize| {
        let group = &groups[usize::from(draft.group[index])];
        group.loose || group.run.as_ref().is_some_and(|run| run.bonds == RunBonds::Carry)
    };

    let found: Vec<Near> = (0..state.len())
        .into_par_iter()
        .with_min_len(1024)
        .flat_map_iter(|first| {
            let mut found = Vec::new();
            grid.any_near(state.position[first], |second| {
                if second <= first || loose(first) || loose(second) {
                    return false;
                }
                let entry = given.entry(state, [first, second]);
                let radii = [state.radius[first], state.radius[second]];
                let reach = entry.map_or_else(
                    || reaches(radii[0], radii[1]).fold(f64::INFINITY, f64::min),
                    |entry| case.bond[entry].reach(radii[0], radii[1]),
                );
                let offset = offset(domain, state, [first, second]);
                if offset.dot(offset) <= reach * reach {
                    found.push(Near { pair: [first as u32, second as u32], joined: entry.is_some() });
                }
                false
            });
            found
        })
        .collect();

    let used =
        |material: u16| case.bond.iter().any(|j| j.between.contains(&context.materials.names[usize::from(material)]));
    let mut left: BTreeMap<[u16; 2], usize> = BTreeMap::new();
    for near in found.iter().filter(|near| !near.joined) {
        let mut pair = near.pair.map(|index| state.material[index as usize]);
        pair.sort_unstable();
        if pair.into_iter().all(used) {
            *left.entry(pair).or_insert(0) += 1;
        }
    }
    for (pair, count) in left {
        let [a, b] = pair.map(|material| &context.materials.names[usize::from(material)]);
        problems.push(
            Problem::new(
                codes::BOND_MISSING,
                format!(
                    "{} of `{a}` and `{b}` near enough to be bonded, but no [[bond]] joins them",
                    counted(count, "pair")
                ),
            )
            .at(context.loaded.tree.place(&["bond", "0", "between"]), "both are bonded otherwise")
            .help(format!("add a [[bond]] with between = [\"{a}\", \"{b}\"]; without one they only touch")),
        );
    }
    found.into_iter().filter(|near| near.joined).map(|near| near.pair).collect()
}
