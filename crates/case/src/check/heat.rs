//! What the text shows to be wrong with heat and surfaces.

use super::Checker;
use crate::codes;
use crate::materials::RIGID;
use crate::problem::{Problem, number};
use crate::schema::{
    BarRadius, BondForm, ContactPath, Course, Face, Heat, Model, Motion, OpenSides, Property, Scheme, Surface,
};
use crate::walls::{FACES, face_name};

/// The law of expansion is one of small strains.
const LARGEST_STRAIN: f64 = 0.1;

impl Checker<'_> {
    pub(super) fn heat(&mut self) {
        let Some(heat) = &self.case.heat else { return self.without_heat() };
        if self.case.model == Model::BPM {
            let [place, heat] = [&["model"][..], &["heat"]].map(|path| self.place(path));
            self.push(
                Problem::new(codes::HEAT_AND_MODEL, "the case describes heat, but its model has none")
                    .at(place, "bonds without heat")
                    .at(heat, "heat is described here")
                    .help("write model = \"TBPM\", which is BPM with heat, or remove [heat]"),
            );
        }
        self.temperature(heat, heat.initial_temperature, &["heat", "initial_temperature"]);
        if let Some(reference) = heat.reference_temperature {
            self.temperature(heat, reference, &["heat", "reference_temperature"]);
        }
        if heat.time_scale.is_some() && heat.duration.is_some() {
            self.exclusive(&["heat"], "time_scale", "duration");
        }
        self.turns(heat);
        self.open_sides(heat);
        self.heat_of_motion(heat);
        for (k, group) in self.case.particles.iter().enumerate() {
            if let Some(temperature) = group.temperature {
                self.temperature(heat, temperature, &["particles", &k.to_string(), "temperature"]);
            }
        }
        self.thermal_materials(heat);
        self.tables_of_bonds(heat);
        self.warm_walls(heat);
    }

    fn open_sides(&mut self, heat: &Heat) {
        let Some(sides) = &heat.open_sides else { return };
        let place = self.place(&["heat", "open_sides"]);
        if let OpenSides::Faces(faces) = sides {
            self.open_faces(faces);
        }
        if matches!(sides, OpenSides::Cells(cells) if cells.contains(&0)) {
            self.push(
                Problem::new(codes::OUT_OF_RANGE, "a block has at least 1 cell in each direction")
                    .at(place, "must be at least 1"),
            );
        } else if heat.bar_radius != BarRadius::FaceCentred {
            let cause = self.place(&["heat", "bar_radius"]);
            self.push(
                Problem::new(codes::CONFLICTING_KEYS, "`open_sides` corrects \"fcc\", not a number")
                    .at(place, "conflicts")
                    .at(cause, "with this")
                    .help("write bar_radius = \"fcc\", or remove `open_sides`"),
            );
        }
    }

    /// Sides must be there.
    fn open_faces(&mut self, faces: &[Face]) {
        for face in faces {
            let across = FACES.iter().find(|known| known.0 == *face).map_or(0, |&(_, axis, _)| axis);
            if self.case.domain.periodic[across] {
                let [place, cause] = [["heat", "open_sides"], ["domain", "periodic"]].map(|path| self.place(&path));
                let message = format!("there is no side in the direction \"{}\", which repeats", face_name(*face));
                self.push(
                    Problem::new(codes::SURFACE_ACROSS_PERIOD, message)
                        .at(place, "no side")
                        .at(cause, "repeats")
                        .help("leave out this side, or do not let this direction repeat"),
                );
            }
        }
    }

    /// Factors on bonds over temperature.
    fn tables_of_bonds(&mut self, heat: &Heat) {
        for (k, joint) in self.case.bond.iter().enumerate() {
            let index = k.to_string();
            let (stiffness, strength) = (&joint.stiffness_over_temperature, &joint.strength_over_temperature);
            for (key, property, positive) in
                [("stiffness_over_temperature", stiffness, true), ("strength_over_temperature", strength, false)]
            {
                if let Some(property) = property {
                    self.property(heat, property, &["bond", &index, key], "", positive);
                }
            }
            if stiffness.is_some() && self.case.bonds.form != BondForm::Total {
                let place = self.place(&["bonds", "form"]);
                let cause = self.tree.key_place(&["bond", &index, "stiffness_over_temperature"]);
                self.push(
                    Problem::new(
                        codes::STIFFNESS_OF_STORED_FORCES,
                        "the stiffness of these bonds depends on temperature, but a bond that stores forces keeps the old force when its stiffness changes",
                    )
                    .at(place, "stores forces")
                    .at(cause, "changes with temperature")
                    .help("write bonds.form = \"total\", with which forces follow from places"),
                );
            }
            let softens = |name: &String| {
                let own = |joint: &&crate::schema::Joint| joint.between.iter().all(|n| n == name);
                self.case.bond.iter().filter(own).any(|joint| joint.stiffness_over_temperature.is_some())
            };
            if let (true, None, Some(name)) = (joint.series, stiffness, joint.between.iter().find(|name| softens(name)))
            {
                let place = self.place(&["bond", &index, "series"]);
                self.push(
                    Problem::new(
                        codes::MISSING_PARAMETER,
                        format!("half of each of these bonds is `{name}`, whose stiffness depends on temperature"),
                    )
                    .at(place, "`stiffness_over_temperature` belongs here")
                    .help("add stiffness_over_temperature = [[temperature, factor], ...] of the whole bond"),
                );
            }
        }
    }

    /// A property over temperature: temperatures that are some, values in range.
    fn property(&mut self, heat: &Heat, property: &Property, path: &[&str], unit: &str, positive: bool) {
        let points = match property {
            Property::Constant(value) => vec![(0, [f64::INFINITY, value.get()])],
            Property::Points(points) => points.iter().copied().enumerate().collect(),
            Property::Measured(_) => Vec::new(),
        };
        for (k, [temperature, value]) in points {
            // Points that were read from a file stand where the file is named.
            let index = k.to_string();
            let point = [path, &[index.as_str()]].concat();
            let path = if self.tree.get(&point).is_some() { &point[..] } else { path };
            if !matches!(property, Property::Constant(_)) {
                self.temperature(heat, temperature, path);
            }
            if !value.is_finite() || value < 0.0 || positive && value == 0.0 {
                let (place, allowed) = (self.place(path), if positive { "above" } else { "at least" });
                let (name, unit) = (path[2], if unit.is_empty() { String::new() } else { format!(" {unit}") });
                self.push(
                    Problem::new(
                        codes::OUT_OF_RANGE,
                        format!("`{name}` has the value {value}{unit}, but must be {allowed} 0"),
                    )
                    .at(place, format!("must be {allowed} 0{unit}")),
                );
            }
        }
    }

    /// Keys that belong to another way through time.
    fn turns(&mut self, heat: &Heat) {
        let scaled = heat.motion == Motion::Scaled;
        if heat.motion == Motion::Frozen && self.case.time.mass_scaling.is_some() {
            let [place, cause] = [["time", "mass_scaling"], ["heat", "motion"]].map(|path| self.tree.key_place(&path));
            self.push(
                Problem::new(codes::CONFLICTING_KEYS, "`mass_scaling` has no effect where nothing moves")
                    .at(place, "has no effect")
                    .at(cause, "with this")
                    .help("remove it"),
            );
        }
        let idle: &[&str] = match heat.motion {
            Motion::Scaled => &["step", "scheme", "relaxation"],
            Motion::Frozen => &["time_scale", "duration", "relaxation", "from_friction", "from_damping"],
            Motion::QuasiStatic => &["time_scale", "duration", "from_friction", "from_damping"],
        };
        for key in idle {
            if self.tree.get(&["heat", key]).is_none() {
                continue;
            }
            let [place, cause] = [&["heat", key], &["heat", "motion"]].map(|path| self.tree.key_place(path));
            let problem = Problem::new(codes::CONFLICTING_KEYS, format!("`{key}` has no effect with this motion"))
                .at(place, "has no effect");
            let help = if scaled { "write motion = \"quasi-static\" or \"frozen\", or remove it" } else { "remove it" };
            self.push(if scaled { problem.help(help) } else { problem.at(cause, "with this").help(help) });
        }
        if !scaled && heat.step.is_none() && heat.scheme.unwrap_or_default() == Scheme::Implicit {
            let place = self.place(&["heat", "motion"]);
            self.push(
                Problem::new(codes::MISSING_KEY, "nothing says how long a step of the heat is")
                    .at(place, "takes steps of the heat")
                    .help("add step = ... in s; or write scheme = \"explicit\", which finds the largest safe one"),
            );
        }
        if let Some(step) = heat.step.filter(|step| *step > self.case.time.end) {
            let [place, cause] = [&["heat", "step"], &["time", "end"]].map(|path| self.place(path));
            let end = self.case.time.end.get();
            let message = format!("heat.step is {} s, longer than the whole run, {end} s", step.get());
            self.push(
                Problem::new(codes::STEP_BEYOND_END, message)
                    .at(place, format!("must be at most {end} s"))
                    .at(cause, "the run ends here"),
            );
        }
    }

    /// What motion loses is known from the ledger, and only where there is friction.
    fn heat_of_motion(&mut self, heat: &Heat) {
        for (key, part) in [("from_friction", heat.from_friction), ("from_damping", heat.from_damping)] {
            if part.is_none_or(|part| part.get() == 0.0) {
                continue;
            }
            let place = self.tree.key_place(&["heat", key]);
            if !self.case.output.ledger {
                let cause = self.place(&["output", "ledger"]);
                self.push(
                    Problem::new(codes::CONFLICTING_KEYS, "what becomes heat is known from the energy ledger")
                        .at(place, "needs the ledger")
                        .at(cause, "which is off")
                        .help("remove `ledger = false`"),
                );
            } else if key == "from_friction" && self.case.model == Model::GN {
                let cause = self.place(&["model"]);
                self.push(
                    Problem::new(codes::CONFLICTING_KEYS, "the model GN has no friction")
                        .at(place, "has no effect")
                        .at(cause, "with this")
                        .help("write model = \"GNT\" or \"GNTM\", or remove it"),
                );
            }
        }
    }

    /// What only heat can use.
    fn without_heat(&mut self) {
        if self.case.model == Model::TBPM {
            let place = self.place(&["model"]);
            self.push(
                Problem::new(codes::MISSING_HEAT, "the model is TBPM, but nothing says anything of heat")
                    .at(place, "bonds with heat")
                    .help("add a table [heat], or write model = \"BPM\""),
            );
        }
        let groups = self.case.particles.iter().map(|group| group.temperature.is_some());
        let walls = self.case.wall.iter().map(|wall| wall.temperature.is_some());
        let boxes = self.case.boxes.iter().map(|of| of.temperature.is_some());
        let all = groups.enumerate().map(|(k, warm)| ("particles", k, warm));
        let all = all.chain(walls.enumerate().map(|(k, warm)| ("wall", k, warm)));
        let all = all.chain(boxes.enumerate().map(|(k, warm)| ("box", k, warm)));
        let mut places: Vec<_> = all
            .filter(|&(_, _, warm)| warm)
            .map(|(table, k, _)| self.place(&[table, &k.to_string(), "temperature"]))
            .collect();
        for (k, joint) in self.case.bond.iter().enumerate() {
            let tables = [
                ("stiffness_over_temperature", joint.stiffness_over_temperature.is_some()),
                ("strength_over_temperature", joint.strength_over_temperature.is_some()),
            ];
            let given = tables.into_iter().filter(|(_, there)| *there);
            places.extend(given.map(|(key, _)| self.tree.key_place(&["bond", &k.to_string(), key])));
        }
        places.extend((0..self.case.surface.len()).map(|k| self.place(&["surface", &k.to_string()])));
        for place in places {
            self.push(
                Problem::new(codes::MISSING_HEAT, "this is about heat, and the case has no table [heat]")
                    .at(place, "has no effect")
                    .help("add a table [heat], or remove this"),
            );
        }
    }

    /// A temperature must be above absolute zero.
    fn temperature(&mut self, heat: &Heat, value: f64, path: &[&str]) {
        let zero = -heat.scale.zero();
        if value <= zero || !value.is_finite() {
            let unit = heat.scale.unit();
            let place = self.place(path);
            self.push(
                Problem::new(codes::BELOW_ABSOLUTE_ZERO, format!("{value} {unit} is no temperature"))
                    .at(place, format!("must be above {zero} {unit}"))
                    .help("heat.scale says whether temperatures are in °C or K"),
            );
        }
    }

    fn temperatures(&mut self, heat: &Heat, course: &Course, path: &[&str]) {
        if let Course::Constant(value) = course {
            self.temperature(heat, *value, path);
        } else if let Some(coldest) = course.points().iter().map(|point| point[1]).min_by(f64::total_cmp) {
            self.temperature(heat, coldest, path);
        }
    }

    /// All temperatures that the case names, on its scale.
    fn named_temperatures(&self, heat: &Heat) -> Vec<f64> {
        let walls = self.case.wall.iter().flat_map(|wall| &wall.temperature);
        let boxes = self.case.boxes.iter().flat_map(|of| &of.temperature);
        let surfaces = self.case.surface.iter().flat_map(|surface| {
            let convection = surface.convection.iter().map(|convection| &convection.temperature);
            let radiation = surface.radiation.iter().map(|radiation| &radiation.temperature);
            surface.temperature.iter().chain(convection).chain(radiation)
        });
        let courses = walls.chain(boxes).chain(surfaces).flat_map(Course::points).map(|point| point[1]);
        let groups = self.case.particles.iter().filter_map(|group| group.temperature);
        courses.chain(groups).chain([heat.initial_temperature]).collect()
    }

    /// Lengths that change by a good part: the law is one of small strains, and far beyond it radii vanish.
    fn expansion(&mut self, heat: &Heat, name: &str, expansion: f64) {
        let reference = heat.reference_temperature.unwrap_or(heat.initial_temperature);
        let warmth =
            self.named_temperatures(heat).into_iter().fold(0.0, |most: f64, t| most.max((t - reference).abs()));
        let strain = expansion * warmth;
        if strain.abs() > LARGEST_STRAIN {
            let place = self.place(&["material", name, "thermal_expansion"]);
            self.push(
                Problem::new(
                    codes::LARGE_EXPANSION,
                    format!("`{name}` would change its length by {} of it over {warmth} K", number(strain)),
                )
                .at(place, format!("at most {} 1/K", number(LARGEST_STRAIN / warmth)))
                .help("solids have some 1e-6 to 1e-4 1/K"),
            );
        }
    }

    /// Heat needs three values of every material.
    fn thermal_materials(&mut self, heat: &Heat) {
        for (name, material) in &self.case.material {
            let given = [
                ("thermal_conductivity", material.thermal_conductivity.is_some(), "W/(m K)"),
                ("specific_heat", material.specific_heat.is_some(), "J/(kg K)"),
                ("thermal_expansion", material.thermal_expansion.is_some(), "1/K; 0.0 for none"),
            ];
            for (key, _, unit) in given.into_iter().filter(|(_, there, _)| !there) {
                let [place, cause] = [&["material", name][..], &["heat"]].map(|path| self.tree.key_place(path));
                self.push(
                    Problem::new(codes::MISSING_PARAMETER, format!("the material `{name}` lacks `{key}`"))
                        .at(place, format!("`{key}` belongs here"))
                        .at(cause, "the case has heat")
                        .help(format!("add {key} = ... in {unit}")),
                );
            }
            let constant = matches!(material.thermal_conductivity, Some(Property::Constant(_)));
            let properties = [
                // What conducts at some temperatures does so at all.
                ("thermal_conductivity", &material.thermal_conductivity, "W/(m K)", !constant),
                ("specific_heat", &material.specific_heat, "J/(kg K)", true),
            ];
            for (key, property, unit, positive) in properties {
                if let Some(property) = property {
                    self.property(heat, property, &["material", name, key], unit, positive);
                }
            }
            if let Some(expansion) = material.thermal_expansion {
                self.expansion(heat, name, expansion);
            }
            let expands = material.thermal_expansion.is_some_and(|expansion| expansion != 0.0);
            if expands && self.case.bonds.form != BondForm::Total && self.case.model.bonds() {
                let place = self.place(&["bonds", "form"]);
                let cause = self.place(&["material", name, "thermal_expansion"]);
                self.push(
                    Problem::new(
                        codes::EXPANSION_OF_STORED_FORCES,
                        format!("`{name}` expands, but bonds that store forces cannot"),
                    )
                    .at(place, "stores forces")
                    .at(cause, "expands")
                    .help("write bonds.form = \"total\", with which free expansion is free of stress"),
                );
            }
        }
    }

    fn warm_walls(&mut self, heat: &Heat) {
        let walls = self.case.wall.iter().map(|wall| (&wall.temperature, &wall.material));
        let boxes = self.case.boxes.iter().map(|of| (&of.temperature, &of.material));
        let all = walls.enumerate().map(|entry| ("wall", entry)).chain(boxes.enumerate().map(|entry| ("box", entry)));
        for (table, (k, (temperature, material))) in all {
            let Some(course) = temperature else { continue };
            let index = k.to_string();
            let path = [table, &index, "temperature"];
            self.temperatures(heat, course, &path);
            let idle = if material == RIGID {
                Some(([table, &index, "material"], "a rigid wall conducts nothing", "name a material that conducts"))
            } else if heat.contacts == ContactPath::Closed {
                Some((
                    ["heat", "contacts", ""],
                    "no heat goes through contacts",
                    "write heat.contacts = \"circle\" or \"bar\"",
                ))
            } else {
                None
            };
            if let Some((cause, why, help)) = idle {
                let [place, cause] = [&path[..], &cause].map(|path| self.place(path));
                self.push(
                    Problem::new(codes::IDLE_TEMPERATURE, "the temperature of this wall reaches no particle")
                        .at(place, "has no effect")
                        .at(cause, why)
                        .help(help),
                );
            }
        }
    }

    pub(super) fn surfaces(&mut self) {
        let Some(heat) = &self.case.heat else { return };
        for (k, surface) in self.case.surface.iter().enumerate() {
            self.surface(heat, surface, &k.to_string());
        }
    }

    fn surface(&mut self, heat: &Heat, surface: &Surface, index: &str) {
        if let Some(of) = &surface.of {
            self.watched(of, &["surface", index, "of"]);
        }
        let across = surface.face.and_then(|face| FACES.iter().find(|known| known.0 == face)).map(|&(_, axis, _)| axis);
        if across.is_some_and(|axis| self.case.domain.periodic[axis]) {
            let [place, cause] =
                [&["surface", index, "face"][..], &["domain", "periodic"]].map(|path| self.place(path));
            self.push(
                Problem::new(codes::SURFACE_ACROSS_PERIOD, "there is no face in a direction that repeats")
                    .at(place, "no face")
                    .at(cause, "repeats")
                    .help("choose another face, or do not let this direction repeat"),
            );
        }
        if surface.face.is_none() && surface.area.is_none() && !surface.needs_no_area() {
            let place = self.place(&["surface", index]);
            self.push(
                Problem::new(codes::MISSING_KEY, "nothing says how large this surface is")
                    .at(place, "`area` or `face` belongs here")
                    .help(
                        "add area = ... in m², which its particles share equally; or, for particles of one lattice, the \
                         face that they form, such as face = \"+z\"",
                    ),
            );
        }
        let acts = [
            ("temperature", surface.temperature.is_some()),
            ("flux", surface.flux.is_some()),
            ("convection", surface.convection.is_some()),
            ("radiation", surface.radiation.is_some()),
        ];
        let acts: Vec<&str> = acts.into_iter().filter_map(|(key, there)| there.then_some(key)).collect();
        match acts.as_slice() {
            [] => {
                let place = self.place(&["surface", index]);
                self.push(
                    Problem::new(codes::MISSING_KEY, "nothing goes through this surface")
                        .at(place, "`temperature`, `flux`, `convection` or `radiation` belongs here")
                        .help("remove it if it is insulated: whatever is in no surface is"),
                );
            }
            ["temperature", other, ..] => self.exclusive(&["surface", index], "temperature", other),
            _ => {}
        }
        let courses = [
            (&["temperature"][..], surface.temperature.as_ref()),
            (&["convection", "temperature"], surface.convection.as_ref().map(|c| &c.temperature)),
            (&["radiation", "temperature"], surface.radiation.as_ref().map(|r| &r.temperature)),
        ];
        for (keys, course) in courses {
            if let Some(course) = course {
                self.temperatures(heat, course, &[&["surface", index], keys].concat());
            }
        }
    }
}
