//! What limits the time step, and the step that follows.

use crate::build::{Context, Vibration, Warming};
use crate::codes;
use crate::load::Loaded;
use crate::problem::{Label, Problem, number};
use crate::schema::{BondForm, Damping, Integrator, Model, Motion, Step};
use std::ops::Range;
use tdem_engine::physics::contact::Interaction;
use tdem_engine::physics::material::young_modulus_eff;
use tdem_engine::physics::stability::{
    DENSE_PACKING_DAMPING, GEAR_DASHPOT_LIMIT, GEAR_OSCILLATOR_LIMIT, VERLET_DASHPOT_LIMIT, VERLET_OSCILLATOR_LIMIT,
    gear_damped_oscillator_limit, hertz_collision_time, hertz_largest_overlap, rayleigh_time,
};
use tdem_engine::{Constraint, Driven, Ramp, State};

/// Steps per Hertz impact.
const STEPS_PER_IMPACT: f64 = 20.0;
/// Rate at which a tangential dashpot slows the contact point of two turning spheres, over that of its coefficient:
/// the point gives way by $1/m^* + R^2/I$ on each side, 7/2 times as easily as without turning.
const TURNING: f64 = 3.5;

/// With more particles than this, one can have twelve neighbours, and dashpots add up as in a dense packing.
const FEW: usize = 12;
/// With fewer, a sphere feels at most about this multiple of the damping of one contact: estimate.
const FEW_CONTACTS: f64 = 2.0;

/// One limit of the time step.
#[derive(Clone, Debug, PartialEq)]
pub struct StepLimit {
    /// What limits it.
    pub name: &'static str,
    /// The largest step, s.
    pub seconds: f64,
    /// Whether a larger step is known to diverge; otherwise the limit is an estimate.
    pub proven: bool,
    /// What sets it: materials, radius, interaction.
    pub cause: String,
    /// The lines of the case that set it.
    pub labels: Vec<Label>,
}

/// All limits of the time step, and the step itself.
#[derive(Clone, Debug, PartialEq)]
pub struct StepLimits {
    /// The step of the run, s.
    pub step: f64,
    /// Whether it was chosen here: `safety` times the smallest limit.
    pub auto: bool,
    /// Fraction of the smallest limit that an automatic step takes.
    pub safety: f64,
    /// The limits, the smallest first.
    pub limits: Vec<StepLimit>,
}

/// What the limits need to know of the particles.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// Particles of each material.
    pub(crate) counts: Vec<usize>,
    /// Smallest radius of each material, m, and the group that has it.
    smallest: Vec<(f64, usize)>,
    /// m.
    pub(crate) largest_radius: f64,
    /// The group that has it.
    pub(crate) largest_group: usize,
    /// Largest speed at the start, or of what is driven, m/s.
    speed: f64,
    /// Largest speed that gravity can give before something is in the way, m/s.
    falling: f64,
    /// Largest speed of a wall, m/s.
    wall_speed: f64,
}

impl Found {
    pub(crate) fn of(
        context: &Context<'_>,
        state: &State,
        group: &[u16],
        constraints: &[Constraint],
        ramps: &[Ramp],
    ) -> Self {
        let count = context.materials.len();
        let mut found = Found {
            counts: vec![0; count],
            smallest: vec![(f64::INFINITY, 0); count],
            largest_radius: 0.0,
            largest_group: 0,
            speed: 0.0,
            falling: 0.0,
            wall_speed: context.planes.iter().map(|plane| length(plane.wall.velocity)).fold(0.0, f64::max),
        };
        let gravity = context.gravity();
        let strength = length(gravity);
        for k in 0..state.len() {
            let material = usize::from(state.material[k]);
            let (radius, origin) = (state.radius[k], usize::from(group[k]));
            found.counts[material] += 1;
            if radius < found.smallest[material].0 {
                found.smallest[material] = (radius, origin);
            }
            if radius > found.largest_radius {
                (found.largest_radius, found.largest_group) = (radius, origin);
            }
            let speed = length(state.velocity[k]);
            found.speed = found.speed.max(speed);
            let ordered = constraints[usize::from(state.constraint[k])].velocity.iter().all(Option::is_some);
            if strength > 0.0 && !ordered {
                let direction = gravity.map(|g| g / strength);
                let height = fall(context, state.position[k], radius, direction);
                found.falling = found.falling.max((speed * speed + 2.0 * strength * height).sqrt());
            }
        }
        // What is driven may become faster than it starts.
        let driven = ramps.iter().filter(|ramp| ramp.drives == Driven::Velocity).flat_map(|ramp| &ramp.points);
        found.speed = driven.fold(found.speed, |fastest, [_, speed]| fastest.max(speed.abs()));
        found.falling = found.falling.max(found.speed);
        found
    }

    /// Smallest radius of all, m.
    pub(crate) fn smallest_radius(&self) -> f64 {
        self.smallest.iter().map(|s| s.0).fold(f64::INFINITY, f64::min)
    }
}

fn length(v: [f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// How far a particle can fall before it meets a wall or leaves the domain, m; 0 if nothing is in the way anywhere.
fn fall(context: &Context<'_>, point: [f64; 3], radius: f64, direction: [f64; 3]) -> f64 {
    let mut height = f64::INFINITY;
    for plane in &context.planes {
        let against: f64 = (0..3).map(|k| -plane.wall.normal[k] * direction[k]).sum();
        if against > 1e-9 {
            height = height.min((plane.distance(point) - radius).max(0.0) / against);
        }
    }
    let domain = &context.domain;
    for k in 0..3 {
        if !domain.periodic[k] && direction[k].abs() > 1e-9 {
            let face = if direction[k] > 0.0 { domain.max[k] } else { domain.min[k] };
            height = height.min((face - point[k]) / direction[k]);
        }
    }
    if height.is_finite() { height.max(0.0) } else { 0.0 }
}

/// The fastest that bonds and heat can do in a state.
pub(crate) struct Fastest<'s> {
    pub(crate) vibration: Option<&'s Vibration>,
    pub(crate) warming: Option<&'s Warming>,
    pub(crate) state: &'s State,
}

impl StepLimits {
    pub(crate) fn of(
        context: &Context<'_>,
        found: &Found,
        meeting: &[(usize, usize)],
        interactions: &[Interaction<f64>],
        fastest: &Fastest<'_>,
    ) -> Self {
        let motion = context.loaded.case.heat.as_ref().map_or(Motion::Scaled, |heat| heat.motion);
        let mut limits = Finder { context, found, limits: Vec::new() };
        if let Some(vibration) = fastest.vibration {
            limits.bonds(vibration, fastest.state);
        }
        if let Some(warming) = fastest.warming.filter(|_| motion == Motion::Scaled) {
            limits.heat(warming, fastest.state);
        }
        for material in (0..context.materials.len()).filter(|&m| found.counts[m] > 0) {
            limits.rayleigh(material);
        }
        for &(a, b) in meeting {
            limits.impact(a, b);
            limits.dashpots(a, b, &interactions[a * context.materials.len() + b]);
        }
        let mut limits = limits.limits;
        limits.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let time = &context.loaded.case.time;
        let safety = time.safety.get();
        let (step, auto) = match time.step {
            Step::Seconds(step) => (step.get(), false),
            Step::Auto => (safety * limits.first().map_or(time.end.get(), |limit| limit.seconds), true),
        };
        // A run shorter than one step takes one step.
        StepLimits { step: step.min(time.end.get()), auto, safety, limits }
    }

    /// The limit that sets an automatic step.
    #[must_use]
    pub fn smallest(&self) -> Option<&StepLimit> {
        self.limits.first()
    }

    /// A step beyond a proven limit is an error, beyond an estimate a warning; one problem for each kind of limit.
    /// Estimates are not worth a word beside an error.
    /// Where nothing moves, no step of the motion is too large.
    pub(crate) fn problems(&self, loaded: &Loaded) -> Vec<Problem> {
        let mut problems = Vec::new();
        if loaded.case.heat.as_ref().is_some_and(|heat| heat.motion == Motion::Frozen) {
            return problems;
        }
        let mut told: Vec<&str> = Vec::new();
        let refused = self.limits.iter().any(|limit| limit.proven && self.step > limit.seconds);
        for limit in self.limits.iter().filter(|limit| self.step > limit.seconds) {
            if refused && !limit.proven {
                continue;
            }
            if told.contains(&limit.name) {
                continue;
            }
            told.push(limit.name);
            let message = format!(
                "time.step is {} s, larger than {} s, the limit by {} ({})",
                number(self.step),
                number(limit.seconds),
                limit.name,
                limit.cause
            );
            let mut problem = if limit.proven {
                Problem::new(codes::STEP_UNSTABLE, message + ": the run would diverge")
            } else {
                Problem::new(codes::STEP_LARGE, message + ", which is an estimate")
            };
            let remedy = if limit.proven { "must be at most" } else { "should be at most" };
            problem = problem.at(loaded.tree.place(&["time", "step"]), format!("{remedy} {} s", number(limit.seconds)));
            problem.labels.extend(limit.labels.iter().cloned());
            problems.push(problem.help("write step = \"auto\" to get the largest safe step"));
        }
        problems
    }
}

/// The hardest impact that would exceed the overlap limit, if any.
pub(crate) fn deep_impact(context: &Context<'_>, found: &Found, meeting: &[(usize, usize)]) -> Option<Problem> {
    let finder = Finder { context, found, limits: Vec::new() };
    let limit = context.loaded.case.contact.overlap_limit.get();
    let depth = |&(a, b): &(usize, usize)| {
        let smaller = found.smallest[a].0.min(found.smallest[b].0);
        (finder.largest_overlap(a, b) / smaller, a, b)
    };
    let (ratio, a, b) = meeting.iter().map(depth).max_by(|x, y| x.0.total_cmp(&y.0))?;
    if !(ratio > limit && ratio.is_finite()) {
        return None;
    }
    let (_, _, speed) = finder.encounter(a, b);
    let message = format!(
        "an impact of `{}` on `{}` at {} m/s would overlap by {} of the smaller radius, more than contact.overlap_limit \
         = {}: the run would stop there",
        finder.name(a),
        finder.name(b),
        number(speed),
        number(ratio),
        number(limit)
    );
    let softer = if found.counts[a] == 0 { b } else { a };
    let problem = Problem::new(codes::IMPACT_DEEP, message).at(
        context.loaded.tree.place(&["material", finder.name(softer), "young_modulus"]),
        "stiffness of the material",
    );
    Some(
        problem.help(
            "make the material stiffer or the impact slower; the speed counts what falls and is driven, undamped",
        ),
    )
}

/// Damping ratio, over the greatest frequency times the step, above which Gear's method with bonds that take the normal force
/// from the length does not gain energy.
///
/// # Numerics
/// There, the stored shear forces and moments see the translations of the end of a step, half a step ahead of the rotations.
/// To first order in the step this acts as $\tfrac12\Delta t\,\mathbf K_s\mathbf P$ beside the dashpots, with the stiffness
/// $\mathbf K_s$ of what is stored and the projection $\mathbf P$ on translations, which is not positive semidefinite. The
/// eigenvalues of seven assemblies from a pair to a block of 108 spheres (shear over normal stiffness 0.4, radius multiplier
/// 0.8) ask for at most 0.0061. Where all forces are stored it damps.
const GEAR_DAMPING: f64 = 0.01;

/// Bonds whose vibration would grow at any step.
pub(crate) fn gear_growth(context: &Context<'_>, step: f64, vibration: Option<&Vibration>) -> Option<Problem> {
    let case = &context.loaded.case;
    if case.time.integrator != Integrator::Gear || case.bonds.form != BondForm::Incremental {
        return None;
    }
    let needed = GEAR_DAMPING * vibration?.greatest_frequency * step;
    let (entry, joint) = case.bond.iter().enumerate().find(|(_, joint)| joint.damping_ratio.get() < needed)?;
    let ratio = joint.damping_ratio.get();
    let message = format!(
        "the vibration of these bonds would grow at any step: with Gear's integrator and form = \"incremental\" a damping \
         ratio of {} is less than {} (0.01 of the greatest frequency times the step)",
        number(ratio),
        number(needed)
    );
    let place = context.loaded.tree.place(&["bond", &entry.to_string(), "damping_ratio"]);
    let problem = Problem::new(codes::GEAR_GROWTH, message).at(place, format!("at least {}", number(needed)));
    Some(problem.help(
        "give the bonds this damping ratio, take form = \"total\" or \"incremental-stored\", or the integrator \
         velocity-verlet",
    ))
}

struct Finder<'c> {
    context: &'c Context<'c>,
    found: &'c Found,
    limits: Vec<StepLimit>,
}

impl Finder<'_> {
    fn gear(&self) -> bool {
        self.context.loaded.case.time.integrator == Integrator::Gear
    }
    fn name(&self, material: usize) -> &str {
        &self.context.materials.names[material]
    }
    fn label(&self, path: &[&str], text: &str) -> Label {
        Label { span: self.context.loaded.tree.place(path), text: text.to_owned() }
    }
    /// Where the smallest radius of a material comes from.
    fn radius_label(&self, material: usize) -> Option<Label> {
        let (radius, group) = self.found.smallest[material];
        radius.is_finite().then(|| Label {
            span: self.context.radius_place(group),
            text: format!("smallest radius of `{}`: {} m", self.name(material), number(radius)),
        })
    }

    fn add(&mut self, name: &'static str, seconds: f64, proven: bool, cause: String, labels: Vec<Label>) {
        if seconds.is_finite() {
            self.limits.push(StepLimit { name, seconds, proven, cause, labels });
        }
    }

    /// Vibration of bonded particles: up to one step all is stable, beyond another something is not.
    fn bonds(&mut self, vibration: &Vibration, state: &State) {
        let (frequency, rate) = (vibration.greatest_frequency, vibration.greatest_damping_rate);
        if frequency == 0.0 {
            return;
        }
        let (safe, limit) = if self.gear() {
            let damped = gear_damped_oscillator_limit(0.5 * rate / frequency) / frequency;
            (damped.min(GEAR_DASHPOT_LIMIT / rate), GEAR_OSCILLATOR_LIMIT)
        } else {
            (vibration.verlet_step, VERLET_OSCILLATOR_LIMIT)
        };
        let material = usize::from(state.material[vibration.particle]);
        let cause = format!(
            "no vibration above {} rad/s, `{}` of radius {} m",
            number(frequency),
            self.name(material),
            number(state.radius[vibration.particle])
        );
        let case = &self.context.loaded.case;
        let name = self.name(material);
        let entry = case.bond.iter().position(|joint| joint.between.iter().any(|n| n == name)).unwrap_or(0);
        let labels = vec![self.label(&["bond", &entry.to_string(), "between"], "stiffness of these bonds")];
        self.add("bonds", safe, false, cause, labels.clone());
        let cause = format!("one particle alone vibrates at {} rad/s", number(vibration.least_frequency));
        // Dashpots may help Gear's method, if only a little.
        let proven = !self.gear() || rate == 0.0;
        self.add("the bonds of one particle", limit / vibration.least_frequency, proven, cause, labels);
    }

    /// Heat: up to one step temperatures do not oscillate, beyond another something diverges.
    fn heat(&mut self, warming: &Warming, state: &State) {
        let case = &self.context.loaded.case;
        let Some(heat) = case.heat.as_ref().filter(|_| warming.safe_step.is_finite()) else { return };
        let scale = heat.time_scale(case);
        let name = self.name(usize::from(state.material[warming.particle]));
        let radius = number(state.radius[warming.particle]);
        let of = |step: f64| {
            let time = if scale == 1.0 { String::new() } else { format!(" of heat, {} times as fast", number(scale)) };
            format!("{} s{time}, `{name}` of radius {radius} m", number(step))
        };
        let mut labels = vec![self.label(&["material", name, "thermal_conductivity"], "how well it conducts")];
        for key in ["time_scale", "duration"] {
            if self.context.loaded.tree.get(&["heat", key]).is_some() {
                labels.push(self.label(&["heat", key], "how much faster heat goes than motion"));
            }
        }
        let (safe, certain) = (of(warming.safe_step), of(warming.certain_step));
        self.add("conduction of heat", warming.safe_step / scale, false, safe, labels.clone());
        self.add("the heat of one particle", warming.certain_step / scale, true, certain, labels);
    }

    fn rayleigh(&mut self, material: usize) {
        let radius = self.found.smallest[material].0;
        let time =
            rayleigh_time(radius, self.context.materials.density[material], self.context.materials.elastic[material]);
        let fraction = if self.gear() { 0.1 } else { 0.2 };
        let cause =
            format!("{fraction} of {} s, `{}` of radius {} m", number(time), self.name(material), number(radius));
        let mut labels: Vec<Label> = self.radius_label(material).into_iter().collect();
        labels.push(self.label(&["material", self.name(material), "young_modulus"], "stiffness of the material"));
        self.add("Rayleigh waves", fraction * time, false, cause, labels);
    }

    /// Effective mass, effective radius and relative speed of the hardest impact of two materials.
    fn encounter(&self, a: usize, b: usize) -> (f64, f64, f64) {
        let (found, materials) = (self.found, &self.context.materials);
        let mass = |m: usize| {
            let radius = found.smallest[m].0;
            4.0 / 3.0 * std::f64::consts::PI * (radius * radius * radius) * materials.density[m]
        };
        let sum = |x: f64, y: f64| if y.is_finite() { x * y / (x + y) } else { x };
        // A material without particles is a wall: infinitely large and heavy.
        let (mut body, mut other) = ((mass(a), found.smallest[a].0), (mass(b), found.smallest[b].0));
        if found.counts[a] == 0 {
            std::mem::swap(&mut body, &mut other);
        }
        if found.counts[a] == 0 || found.counts[b] == 0 || (a == b && found.counts[a] < 2) {
            return (body.0, body.1, found.falling + found.wall_speed);
        }
        let speed = (found.falling + found.speed).max(found.falling + found.wall_speed);
        (sum(body.0, other.0), sum(body.1, other.1), speed)
    }

    fn impact(&mut self, a: usize, b: usize) {
        let (mass, radius, speed) = self.encounter(a, b);
        let modulus = young_modulus_eff(self.context.materials.elastic[a], self.context.materials.elastic[b]);
        let time = hertz_collision_time(mass, radius, modulus, speed);
        let cause = format!(
            "1/{STEPS_PER_IMPACT} of {} s, impact of `{}` on `{}` at {} m/s",
            number(time),
            self.name(a),
            self.name(b),
            number(speed)
        );
        let labels = self.radius_label(a).or_else(|| self.radius_label(b)).into_iter().collect();
        self.add("impact", time / STEPS_PER_IMPACT, false, cause, labels);
    }

    fn dashpots(&mut self, a: usize, b: usize, interaction: &Interaction<f64>) {
        let Some(given) = self.context.materials.given(a, b) else { return };
        let given = given.to_string();
        let (alone, dense) = if self.gear() { (GEAR_DASHPOT_LIMIT, 0.16) } else { (VERLET_DASHPOT_LIMIT, 1.0) };
        let crowd = if self.found.counts.iter().sum::<usize>() > FEW { DENSE_PACKING_DAMPING } else { FEW_CONTACTS };
        let dense = dense / crowd;
        let case = &self.context.loaded.case;
        let pair = format!("`{}` and `{}`", self.name(a), self.name(b));

        let viscous = case.contact.damping == Damping::Viscous;
        let (rate, key) = if viscous {
            (interaction.normal_damping, "normal_damping")
        } else {
            (self.restitution_rate(a, b, interaction), "restitution")
        };
        let labels = vec![self.label(&["interaction", &given, key], "damping of this pair")];
        let cause = format!("damping {} 1/s of {pair}", number(rate));
        // By restitution the rate depends on how hard the impact is, so that no bound can be proved.
        self.add("the normal dashpot alone", alone / rate, viscous, cause.clone(), labels.clone());
        self.add("the normal dashpots of all contacts", dense / rate, false, cause, labels);

        if case.model != Model::GN {
            let rate = interaction.tangential_damping * if case.model.turns() { TURNING } else { 1.0 };
            let labels = vec![self.label(&["interaction", &given, "tangential_damping"], "damping of this pair")];
            let cause = format!("damping {} 1/s of {pair}, turning included", number(rate));
            // Sliding caps the force, so that too large a step does not diverge here.
            self.add("the tangential dashpots of all contacts", dense / rate, false, cause, labels);
        }
    }

    /// Largest overlap of the hardest impact without damping, m.
    fn largest_overlap(&self, a: usize, b: usize) -> f64 {
        let (mass, radius, speed) = self.encounter(a, b);
        let modulus = young_modulus_eff(self.context.materials.elastic[a], self.context.materials.elastic[b]);
        hertz_largest_overlap(mass, radius, modulus, speed)
    }

    /// The dashpot's rate at the deepest point of the hardest impact, 1/s.
    fn restitution_rate(&self, a: usize, b: usize, interaction: &Interaction<f64>) -> f64 {
        let (mass, radius, _) = self.encounter(a, b);
        let modulus = young_modulus_eff(self.context.materials.elastic[a], self.context.materials.elastic[b]);
        let overlap = self.largest_overlap(a, b);
        let stiffness = 2.0 * modulus * (radius * overlap).sqrt();
        interaction.normal_damping * (stiffness / mass).sqrt()
    }
}

/// Places in the text that a limit refers to, for tests and reports.
impl StepLimit {
    /// The spans of its labels.
    pub fn spans(&self) -> impl Iterator<Item = Range<usize>> {
        self.labels.iter().map(|label| label.span.clone())
    }
}
