//! What the text alone shows to be wrong once its structure is right.

mod bonds;
mod gauge;
mod heat;
mod picture;
mod shape;

pub use gauge::{HISTORY_COLUMNS, HISTORY_COLUMNS_OF_BONDS, HISTORY_COLUMNS_OF_HEAT};

use crate::codes;
use crate::materials::RIGID;
use crate::problem::Problem;
use crate::schema::{Case, Component, Damping, Interaction, Model, Particles, Radius, Step};
use crate::structure::suggestion;
use crate::tree::Node;
use crate::walls::{FACES, face_name};
use std::collections::BTreeMap;
use std::ops::Range;

/// All such problems of a case.
pub(crate) fn check(case: &Case, tree: &Node) -> Vec<Problem> {
    let mut checker = Checker { case, tree, problems: Vec::new() };
    checker.domain();
    checker.materials();
    checker.interactions();
    checker.bonds();
    checker.heat();
    checker.surfaces();
    checker.walls();
    checker.boxes();
    checker.particles();
    checker.zones();
    checker.gauges();
    checker.pictures();
    checker.time_and_output();
    checker.problems
}

struct Checker<'c> {
    case: &'c Case,
    tree: &'c Node,
    problems: Vec<Problem>,
}

impl Checker<'_> {
    fn push(&mut self, problem: Problem) {
        self.problems.push(problem);
    }
    fn place(&self, path: &[&str]) -> Range<usize> {
        self.tree.place(path)
    }

    /// Corners in the wrong order, one problem per direction. `path` leads to the table that holds them.
    fn corners(&mut self, path: &[&str], min: [f64; 3], max: [f64; 3]) {
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            if min[k] >= max[k] {
                let [low, high] = ["min", "max"].map(|key| self.place(&[path, &[key]].concat()));
                self.push(
                    Problem::new(
                        codes::INVERTED_BOX,
                        format!(
                            "{}: max is {} m and min is {} m in {axis}, but max must be larger",
                            path[0], max[k], min[k]
                        ),
                    )
                    .at(high, "must be larger than min")
                    .at(low, "min is here")
                    .help("exchange them, or correct one"),
                );
            }
        }
    }

    fn domain(&mut self) {
        self.corners(&["domain"], self.case.domain.min, self.case.domain.max);
    }

    fn materials(&mut self) {
        if self.case.material.contains_key(RIGID) {
            let place = self.tree.key_place(&["material", RIGID]);
            self.push(
                Problem::new(codes::RESERVED_NAME, "`rigid` is the built-in material of infinitely stiff walls")
                    .at(place, "choose another name"),
            );
        }
    }

    /// A name of a material that must exist; walls may also be rigid.
    fn material(&mut self, name: &str, rigid_allowed: bool, path: &[&str]) {
        if self.case.material.contains_key(name) || (rigid_allowed && name == RIGID) {
            return;
        }
        let place = self.place(path);
        let problem = if name == RIGID {
            Problem::new(codes::RIGID_PARTICLES, "particles cannot be rigid: they need a density and a stiffness")
                .at(place, "only walls can be rigid")
        } else {
            let names: Vec<&str> = self.case.material.keys().map(String::as_str).collect();
            Problem::new(codes::UNKNOWN_MATERIAL, format!("there is no material `{name}`"))
                .at(place, "not defined")
                .help(suggestion(name, &names))
        };
        self.push(problem);
    }

    fn interactions(&mut self) {
        let mut seen: BTreeMap<[&str; 2], usize> = BTreeMap::new();
        for (k, interaction) in self.case.interaction.iter().enumerate() {
            let index = k.to_string();
            for (n, name) in interaction.between.iter().enumerate() {
                self.material(name, true, &["interaction", &index, "between", &n.to_string()]);
            }
            let mut pair = interaction.between.each_ref().map(String::as_str);
            pair.sort_unstable();
            if let Some(first) = seen.insert(pair, k) {
                let first = self.place(&["interaction", &first.to_string(), "between"]);
                let again = self.place(&["interaction", &index, "between"]);
                self.push(
                    Problem::new(
                        codes::DUPLICATE_INTERACTION,
                        format!("the interaction of `{}` and `{}` is given twice", pair[0], pair[1]),
                    )
                    .at(again, "again here")
                    .at(first, "first here")
                    .help("keep one of them"),
                );
            }
            self.parameters(interaction, &index);
        }
    }

    /// Parameters that the law needs have no defaults, because they are physics.
    fn parameters(&mut self, interaction: &Interaction, index: &str) {
        let rubs = self.case.model != Model::GN;
        let viscous = self.case.contact.damping == Damping::Viscous;
        let (model, damping): (&[&str], &[&str]) = (&["model"], &["contact", "damping"]);
        let needed = [
            ("static_friction", interaction.static_friction.is_none(), rubs, model, "this model rubs"),
            ("dynamic_friction", interaction.dynamic_friction.is_none(), rubs, model, "this model rubs"),
            ("tangential_damping", interaction.tangential_damping.is_none(), rubs, model, "this model rubs"),
            ("normal_damping", interaction.normal_damping.is_none(), viscous, damping, "damping is viscous"),
            ("restitution", interaction.restitution.is_none(), !viscous, damping, "damping is by restitution"),
        ];
        for (key, absent, required, cause, why) in needed {
            if !(absent && required) {
                continue;
            }
            let [first, second] = &interaction.between;
            let mut problem = Problem::new(
                codes::MISSING_PARAMETER,
                format!("the interaction of `{first}` and `{second}` lacks `{key}`"),
            )
            .at(self.place(&["interaction", index]), format!("`{key}` belongs here"));
            // A choice left to its default has no line to show.
            if let Some(cause) = self.tree.get(cause) {
                problem = problem.at(cause.span.clone(), why);
            }
            self.push(problem.help(match key {
                "restitution" => {
                    "add restitution = ..., above 0 and at most 1, or choose contact.damping = \"viscous\""
                }
                "normal_damping" => {
                    "add normal_damping = ... in 1/s; 0.0 for none; or choose contact.damping = \"restitution\""
                }
                "tangential_damping" => "add tangential_damping = ... in 1/s; 0.0 for none",
                _ => "add the coefficient; 0.0 for none",
            }));
        }
        if let (Some(high), Some(low)) = (interaction.static_friction, interaction.dynamic_friction)
            && low > high
        {
            let [high_place, low_place] =
                ["static_friction", "dynamic_friction"].map(|key| self.place(&["interaction", index, key]));
            self.push(
                Problem::new(
                    codes::FRICTION_ORDER,
                    format!("dynamic_friction is {}, but must be at most static_friction, {}", low.get(), high.get()),
                )
                .at(low_place, format!("must be at most {}", high.get()))
                .at(high_place, "this sets the limit")
                .help("lower the dynamic or raise the static coefficient"),
            );
        }
    }

    fn walls(&mut self) {
        let mut names: BTreeMap<&str, Range<usize>> = BTreeMap::new();
        for (k, wall) in self.case.wall.iter().enumerate() {
            let index = k.to_string();
            self.material(&wall.material, true, &["wall", &index, "material"]);
            let name = self.place(&["wall", &index, "name"]);
            if let Some(first) = names.insert(&wall.name, name.clone()) {
                self.duplicate(&wall.name, name, first);
            }
            let normal = self.place(&["wall", &index, "normal"]);
            if wall.normal == [0.0; 3] {
                self.push(
                    Problem::new(codes::ZERO_NORMAL, format!("the normal of wall `{}` has no direction", wall.name))
                        .at(normal, "all components are 0")
                        .help("give the direction from the wall to the particles, such as [0.0, 0.0, 1.0]"),
                );
                continue;
            }
            for (d, axis) in ["x", "y", "z"].into_iter().enumerate() {
                if self.case.domain.periodic[d] && wall.normal[d] != 0.0 {
                    let cause = self.place(&["domain", "periodic"]);
                    self.push(
                        Problem::new(
                            codes::WALL_ACROSS_PERIOD,
                            format!("wall `{}` blocks {axis}, in which the domain repeats", wall.name),
                        )
                        .at(normal.clone(), format!("its {axis} component must be 0"))
                        .at(cause, format!("{axis} repeats"))
                        .help("turn the wall, or do not let this direction repeat"),
                    );
                }
            }
        }
    }

    fn duplicate(&mut self, name: &str, again: Range<usize>, first: Range<usize>) {
        self.push(
            Problem::new(codes::DUPLICATE_NAME, format!("two walls are called `{name}`"))
                .at(again, "again here")
                .at(first, "first here")
                .help("give each its own name"),
        );
    }

    fn boxes(&mut self) {
        let mut names: BTreeMap<&str, usize> = BTreeMap::new();
        for (k, container) in self.case.boxes.iter().enumerate() {
            let index = k.to_string();
            self.material(&container.material, true, &["box", &index, "material"]);
            let domain = &self.case.domain;
            if container.min.is_some() || container.max.is_some() {
                self.corners(
                    &["box", &index],
                    container.min.unwrap_or(domain.min),
                    container.max.unwrap_or(domain.max),
                );
            }
            if let Some(first) = names.insert(&container.name, k) {
                let first = self.place(&["box", &first.to_string(), "name"]);
                self.duplicate(&container.name, self.place(&["box", &index, "name"]), first);
            }
            for (d, axis) in ["x", "y", "z"].into_iter().enumerate() {
                let closed: Vec<&str> = FACES
                    .iter()
                    .filter(|face| face.1 == d && !container.open.contains(&face.0))
                    .map(|face| face_name(face.0))
                    .collect();
                if domain.periodic[d] && !closed.is_empty() {
                    let (place, cause) = (self.place(&["box", &index]), self.place(&["domain", "periodic"]));
                    self.push(
                        Problem::new(
                            codes::WALL_ACROSS_PERIOD,
                            format!("box `{}` blocks {axis}, in which the domain repeats", container.name),
                        )
                        .at(place, format!("has walls across {axis}"))
                        .at(cause, format!("{axis} repeats"))
                        .help(format!("leave these faces out: open = [\"-{axis}\", \"+{axis}\"]")),
                    );
                }
            }
        }
    }

    fn particles(&mut self) {
        if self.case.particles.is_empty() {
            let place = self.place(&["particles"]);
            self.push(
                Problem::new(codes::NO_PARTICLES, "the case has no particles")
                    .at(place, "empty")
                    .help("add a table [[particles]] with a table [particles.lattice], for instance"),
            );
        }
        for (k, group) in self.case.particles.iter().enumerate() {
            self.group(group, &k.to_string());
        }
    }

    fn group(&mut self, group: &Particles, index: &str) {
        let here = self.place(&["particles", index]);
        let sources: Vec<&str> = [
            ("lattice", group.lattice.is_some()),
            ("random", group.random.is_some()),
            ("list", group.list.is_some()),
            ("csv", group.csv.is_some()),
            ("run", group.run.is_some()),
        ]
        .into_iter()
        .filter_map(|(name, present)| present.then_some(name))
        .collect();
        if let [_, second, ..] = sources.as_slice() {
            let place = self.place(&["particles", index, second]);
            let first = self.place(&["particles", index, sources[0]]);
            self.push(
                Problem::new(codes::PARTICLE_SOURCE, "a group of particles comes from one place only")
                    .at(place, "one too many")
                    .at(first, "the other")
                    .help("make a [[particles]] group of its own for each"),
            );
        } else if sources.is_empty() {
            self.push(
                Problem::new(codes::PARTICLE_SOURCE, "nothing says where these particles come from")
                    .at(here.clone(), "has no particles")
                    .help("add one of [particles.lattice], [particles.random], [particles.list], [particles.csv], [particles.run]"),
            );
        }
        match &group.material {
            Some(name) => self.material(name, false, &["particles", index, "material"]),
            None if group.csv.is_none() && group.run.is_none() => self.push(
                Problem::new(codes::MISSING_KEY, "these particles have no material")
                    .at(here, "`material` belongs here")
                    .help("add `material = \"...\"`, the name of a [material.NAME] table"),
            ),
            None => {}
        }
        for (k, name) in group.run.iter().flat_map(|run| &run.materials).enumerate() {
            self.material(name, false, &["particles", index, "run", "materials", &k.to_string()]);
        }
        if let Some([low, high]) = group.random_speed
            && low > high
        {
            let place = self.place(&["particles", index, "random_speed"]);
            self.push(
                Problem::new(
                    codes::INVERTED_RANGE,
                    format!("random_speed goes from {} m/s down to {} m/s", low.get(), high.get()),
                )
                .at(place, "the first must not be larger"),
            );
        }
        for (k, component) in group.fixed.iter().enumerate() {
            let component = *component as usize;
            if group.prescribed.components()[component].is_some() {
                let name = COMPONENTS[component].1;
                let place = self.place(&["particles", index, "fixed", &k.to_string()]);
                let other = self.place(&["particles", index, "prescribed", name]);
                self.push(
                    Problem::new(codes::FIXED_AND_PRESCRIBED, format!("`{name}` is fixed and prescribed"))
                        .at(place, "fixed here")
                        .at(other, "prescribed here")
                        .help("keep one of them"),
                );
            }
        }
        self.cuts(group, index);
        self.lattice_and_random(group, index);
    }

    fn lattice_and_random(&mut self, group: &Particles, index: &str) {
        let domain = &self.case.domain;
        if let Some(lattice) = &group.lattice {
            self.corners_if_given(&["particles", index, "lattice"], lattice.min, lattice.max);
            if lattice.origin.is_some() {
                for key in ["min", "max", "align"] {
                    if self.tree.get(&["particles", index, "lattice", key]).is_some() && lattice.cells.is_some() {
                        self.exclusive(&["particles", index, "lattice"], "origin", key);
                    }
                }
            }
            for key in ["cells", "align", "origin"] {
                if lattice.site.is_some() && self.tree.get(&["particles", index, "lattice", key]).is_some() {
                    self.exclusive(&["particles", index, "lattice"], "site", key);
                }
            }
            if lattice.cells.is_some_and(|cells| cells.contains(&0)) {
                let place = self.place(&["particles", index, "lattice", "cells"]);
                self.push(
                    Problem::new(codes::OUT_OF_RANGE, "a lattice needs at least 1 cell in each direction")
                        .at(place, "must be at least 1"),
                );
            }
        }
        let Some(random) = &group.random else { return };
        self.corners_if_given(&["particles", index, "random"], random.min, random.max);
        match (random.count, random.volume_fraction) {
            (Some(_), Some(_)) => self.exclusive(&["particles", index, "random"], "count", "volume_fraction"),
            (None, None) => {
                let place = self.place(&["particles", index, "random"]);
                self.push(
                    Problem::new(codes::MISSING_KEY, "nothing says how many particles to insert")
                        .at(place, "`count` or `volume_fraction` belongs here"),
                );
            }
            _ => {}
        }
        if let Radius::Range(range) = random.radius
            && range.min > range.max
        {
            let [low, high] = ["min", "max"].map(|key| self.place(&["particles", index, "random", "radius", key]));
            self.push(
                Problem::new(
                    codes::INVERTED_RANGE,
                    format!("radii go from {} m down to {} m", range.min.get(), range.max.get()),
                )
                .at(high, "must not be smaller than min")
                .at(low, "min is here"),
            );
        }
        let room = (0..3)
            .filter(|&k| !domain.periodic[k])
            .map(|k| random.max.unwrap_or(domain.max)[k] - random.min.unwrap_or(domain.min)[k])
            .fold(f64::INFINITY, f64::min);
        let [_, largest] = random.radius.bounds();
        if room > 0.0 && 2.0 * largest > room {
            let place = self.place(&["particles", index, "random", "radius"]);
            let cause = self.place(&["particles", index, "random", "max"]);
            self.push(
                Problem::new(
                    codes::REGION_TOO_SMALL,
                    format!("spheres of radius {largest} m do not fit into a region {room} m wide"),
                )
                .at(place, "too large for the region")
                .at(cause, "the region ends here"),
            );
        }
    }

    fn corners_if_given(&mut self, path: &[&str], min: Option<[f64; 3]>, max: Option<[f64; 3]>) {
        if min.is_some() || max.is_some() {
            let domain = &self.case.domain;
            self.corners(path, min.unwrap_or(domain.min), max.unwrap_or(domain.max));
        }
    }

    fn exclusive(&mut self, path: &[&str], one: &str, other: &str) {
        let [first, second] = [one, other].map(|key| self.tree.key_place(&[path, &[key]].concat()));
        self.push(
            Problem::new(codes::CONFLICTING_KEYS, format!("`{one}` and `{other}` say the same thing twice"))
                .at(second, "conflicts")
                .at(first, "with this")
                .help("keep one of them"),
        );
    }

    fn time_and_output(&mut self) {
        let output = &self.case.output;
        if output.frames.is_some() && output.interval.is_some() {
            self.exclusive(&["output"], "frames", "interval");
        }
        if let Step::Seconds(step) = self.case.time.step
            && step > self.case.time.end
        {
            let [place, cause] = ["step", "end"].map(|key| self.place(&["time", key]));
            let end = self.case.time.end.get();
            self.push(
                Problem::new(
                    codes::STEP_BEYOND_END,
                    format!("time.step is {} s, longer than the whole run, {end} s", step.get()),
                )
                .at(place, format!("must be at most {end} s"))
                .at(cause, "the run ends here")
                .help("write step = \"auto\" to get the largest safe step"),
            );
        }
    }
}

/// Components of motion and their names in a case.
pub(crate) const COMPONENTS: [(Component, &str); 6] = [
    (Component::X, "x"),
    (Component::Y, "y"),
    (Component::Z, "z"),
    (Component::Rx, "rx"),
    (Component::Ry, "ry"),
    (Component::Rz, "rz"),
];
