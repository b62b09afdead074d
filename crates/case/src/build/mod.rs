//! From a checked case to a state and a plan.

mod bonds;
mod csv;
mod draft;
mod gauges;
mod heat;
mod histories;
mod lattice;
mod motion;
mod placement;
mod random;
mod room;
mod run;
mod shape;
mod zones;

pub(crate) use bonds::Vibration;
pub use heat::SurfaceExtent;
pub(crate) use heat::{Conducting, Warming};
pub use run::{NoRuns, RunLoader};

use crate::codes;
use crate::limits::{Fastest, Found, StepLimits, deep_impact, gear_growth};
use crate::load::Loaded;
use crate::materials::{Materials, law};
use crate::problem::{Problem, Problems, number, unless_error};
use crate::schedule::{Fields, endless, schedule};
use crate::schema::{self, Particles, Precision, Region};
use crate::walls::{Plane, planes};
use bonds::Bonded;
use draft::{Draft, Spheres};
use motion::Motion;
use tdem_engine::{Bond, BondHistory, Contact, Domain, Integrator, Plan, Schedule, Search, State, cpu, gpu};

/// A case ready to run.
#[derive(Clone, Debug)]
pub struct Built {
    /// Where everything is at the start.
    pub state: State,
    /// What stays the same during the run.
    pub plan: Plan,
    /// How long it runs and when it writes.
    pub schedule: Schedule,
    /// What frames hold.
    pub fields: Fields,
    /// What limits the time step.
    pub limits: StepLimits,
    /// How large each `[[surface]]` is, in their order; empty without heat.
    pub surfaces: Vec<SurfaceExtent>,
    /// What does not stop the run but should be known.
    pub warnings: Problems,
    /// How much memory it takes.
    pub memory: Memory,
}

/// An estimate of the memory that a run takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Number of particles.
    pub particles: usize,
    /// One copy of the state, bytes; each particle touches twelve others, as in the densest packing.
    pub state_bytes: u64,
    /// The most that a run on the CPU holds at a time: its arrays, and what it is writing, bytes.
    pub run_bytes: u64,
    /// What a run on a GPU holds there, bytes.
    pub device_bytes: u64,
}

/// Others that a particle is listed with: a crystal of equal spheres has as many, a random packing fewer.
const NEIGHBOURS: usize = 12;
/// While one state is written another waits, and a file takes about as much again until it is closed.
const COPIES: usize = 3;
/// What a frame takes on its way to the disk, bytes per particle, as measured with 686,000 particles; lines of contacts
/// take more.
const FRAME: usize = 700;
/// The same for each bond, as measured with 3.7 million: their loads are worked out for the stress of particles, and most
/// of it goes into the lines.
const FRAME_OF_BOND: [usize; 2] = [175, 330];

impl Memory {
    /// One copy of a state and the arrays of a run on the CPU, bytes per particle, without bonds and contacts: less than any
    /// run takes.
    fn least(plan: &Plan) -> usize {
        Self::of_particle(plan) + cpu::bytes(plan, 1, 0, 0)
    }

    /// What a copy of the state has of a particle, bytes.
    fn of_particle(plan: &Plan) -> usize {
        let fixed = 4 + 2 + 2 + 8 + 8 + 12 + 5 * 24;
        let gear = plan.integrator == Integrator::Gear;
        let heat = plan
            .heat
            .as_ref()
            .map_or(0, |heat| 18 + if heat.expands() { 8 } else { 0 } + if plan.ledger { 16 } else { 0 });
        fixed + if gear { 96 } else { 0 } + if plan.ledger { 32 } else { 0 } + heat
    }

    fn of([particles, bonds]: [usize; 2], plan: &Plan, frames: Option<Fields>) -> Self {
        let contacts = NEIGHBOURS / 2 * size_of::<Contact>();
        let remembered = plan.bonds.as_ref().is_some_and(tdem_engine::BondPlan::remembers);
        let bond = size_of::<Bond>() + if remembered { size_of::<BondHistory>() } else { 0 };
        let bonded = if bonds > 0 { 32 + 24 } else { 0 };
        let state = particles * (Self::of_particle(plan) + contacts + bonded) + bonds * bond;
        let arrays = cpu::bytes(plan, particles, particles * NEIGHBOURS / 2, bonds);
        let frame = frames.map_or(0, |fields| {
            let particle = match (fields.contacts, fields.precision) {
                (false, _) => FRAME,
                (true, Precision::Single) => FRAME + 1000,
                (true, Precision::Double) => FRAME + 1400,
            };
            particles * particle + bonds * FRAME_OF_BOND[usize::from(fields.bonds)]
        });
        Memory {
            particles,
            state_bytes: state as u64,
            run_bytes: (arrays + COPIES * state + frame) as u64,
            device_bytes: gpu::bytes(plan, particles, particles * NEIGHBOURS / 2, bonds) as u64,
        }
    }
}

impl Loaded {
    /// Builds a case that does not begin with the state of another run.
    ///
    /// # Errors
    /// All problems that places, overlaps and the time step show.
    pub fn build(&self) -> Result<Built, Problems> {
        self.build_with(&NoRuns)
    }

    /// Builds a case; `loader` reads the final states of other runs.
    ///
    /// # Errors
    /// All problems that places, overlaps and the time step show.
    pub fn build_with(&self, loader: &dyn RunLoader) -> Result<Built, Problems> {
        self.build_within(loader, None)
    }

    /// The same on a machine that has so much memory, bytes: what cannot fit is refused before it is placed.
    ///
    /// # Errors
    /// As [`Self::build_with`].
    pub fn build_within(&self, loader: &dyn RunLoader, memory: Option<u64>) -> Result<Built, Problems> {
        let case = &self.case;
        let context = Context::new(self, memory);
        let mut problems = Vec::new();
        let mut draft = Draft::default();
        for (k, group) in case.particles.iter().enumerate() {
            let placed = place(&context, loader, &draft, k, group)
                .and_then(|spheres| {
                    shape::cut(&context, k, group, spheres, &mut problems).map_err(|problem| vec![problem])
                })
                .and_then(|spheres| draft.add(&context, k, group, spheres).map_err(|problem| vec![problem]));
            if let Err(found) = placed {
                problems.extend(found);
            }
        }
        let stop = |problems| Err(Problems::new(&self.source, problems));
        let refused = |problems: &[Problem]| problems.iter().any(|p| p.severity == crate::Severity::Error);
        if refused(&problems) {
            return stop(problems);
        }
        problems.extend(draft.repeated_ids(&context));
        problems.extend(placement::check(&context, &mut draft));
        let (zones, empty) = zones::apply(&context, &mut draft);
        problems.extend(empty);
        let (mut motion, contradictions) = Motion::of(&context, &mut draft, &zones);
        problems.extend(contradictions);
        problems.extend(motion.symmetry(&context, &mut draft));
        let (constraints, ramps) = motion.finish(&mut draft);
        let (heat, surfaces) = heat::of(&context, &mut draft, &zones, &mut problems).unzip();
        let found = Found::of(&context, &draft.state, &draft.group, &constraints, &ramps);
        let meeting = context.materials.meeting(&found.counts, &context.wall_materials());
        problems.extend(context.materials.missing(case, &self.tree, &meeting));
        if refused(&problems) {
            return stop(problems);
        }
        if !placement::period_is_wide_enough(&context, &found, &mut problems) {
            return stop(problems);
        }
        let bonded = Bonded::of(&context, &draft, &mut problems);
        if refused(&problems) {
            return stop(problems);
        }
        let interactions = context.materials.interactions(case);
        let vibration = bonded.as_ref().map(|bonded| bonded.vibration(&context.domain, &draft.state, &constraints));
        let warming = heat.as_ref().map(|h| Warming::of(h, bonded.as_ref(), &context.domain, &draft.state));
        let fastest = Fastest { vibration: vibration.as_ref(), warming: warming.as_ref(), state: &draft.state };
        let limits = StepLimits::of(&context, &found, &meeting, &interactions, &fastest);
        problems.extend(limits.problems(self));
        problems.extend(deep_impact(&context, &found, &meeting));
        problems.extend(gear_growth(&context, limits.step, vibration.as_ref()));
        let mut plan = context.plan(&limits, constraints, interactions, found.smallest_radius());
        let bonds = bonded.as_ref().map_or(Vec::new(), |bonded| bonded.bonds(case, &draft.state));
        plan.bonds = bonded.map(|bonded| bonded.plan(case));
        plan.ramps = ramps;
        plan.heat = heat;
        if let (Some(of), Some(heat), Some(warming)) = (&mut plan.heat, &case.heat, &warming) {
            (of.motion, plan.dt) = heat::turns(heat, limits.step, warming, limits.safety);
            plan.dt = plan.dt.min(case.time.end.get());
        }
        let (surfaces, extents) = surfaces.unwrap_or_default();
        let watched = gauges::members(case, &draft, &zones);
        problems.extend(placement::beyond_limit(&context, &draft, &plan, &bonds));
        let histories = std::mem::take(&mut draft.histories);
        let mut state = draft.finish(&context, &plan, bonds);
        problems.extend(histories::transfer(&context, histories, &plan, &mut state));
        let (gauges, coincident) = gauges::gauges(&context, &watched, &surfaces, &state, &plan);
        plan.gauges = gauges;
        problems.extend(coincident);
        problems.extend(heat::quasi_static::check(&context, &plan, &state));
        problems.extend(slow_fall(&context, &state));
        problems.extend(endless(self, plan.dt));
        let schedule = schedule(case, plan.dt);
        let fields = Fields::of(&case.output);
        let memory = Memory::of([state.len(), state.bonds.len()], &plan, (schedule.frame_every > 0).then_some(fields));
        let ((), warnings) = unless_error(&self.source, problems, ())?;
        Ok(Built { state, plan, schedule, fields, limits, surfaces: extents, warnings, memory })
    }
}

/// What all builders look at.
pub(crate) struct Context<'c> {
    pub(crate) loaded: &'c Loaded,
    pub(crate) materials: Materials,
    pub(crate) planes: Vec<Plane>,
    pub(crate) domain: Domain,
    /// Of the machine, bytes, if it is known.
    memory: Option<u64>,
}

impl<'c> Context<'c> {
    fn new(loaded: &'c Loaded, memory: Option<u64>) -> Self {
        let materials = Materials::of(&loaded.case);
        let planes = planes(&loaded.case, &loaded.tree, |name| materials.index(name));
        let schema::Domain { min, max, periodic } = loaded.case.domain;
        Context { loaded, materials, planes, domain: Domain { min, max, periodic }, memory }
    }

    /// Acceleration of what moves, m/s²: weights are those of the true masses.
    pub(crate) fn gravity(&self) -> [f64; 3] {
        let case = &self.loaded.case;
        case.gravity.map(|acceleration| acceleration / case.time.mass_scaling())
    }

    /// A region of the case, the domain's bounds where it says nothing.
    pub(crate) fn region(&self, min: Option<[f64; 3]>, max: Option<[f64; 3]>) -> Region {
        Region { min: min.unwrap_or(self.domain.min), max: max.unwrap_or(self.domain.max) }
    }

    /// The place of a key in a group of particles.
    pub(crate) fn place(&self, group: usize, keys: &[&str]) -> std::ops::Range<usize> {
        self.loaded.tree.place(&[&["particles", &group.to_string()], keys].concat())
    }

    /// The place that says how large particles of a group are.
    pub(crate) fn radius_place(&self, group: usize) -> std::ops::Range<usize> {
        let of = &self.loaded.case.particles[group];
        let keys: &[&str] = if of.lattice.is_some() {
            &["lattice", "radius"]
        } else if of.random.is_some() {
            &["random", "radius"]
        } else if of.list.is_some() {
            &["list", "radius"]
        } else if of.csv.is_some() {
            &["csv", "file"]
        } else {
            &["run", "directory"]
        };
        self.place(group, keys)
    }

    fn wall_materials(&self) -> Vec<bool> {
        let mut present = vec![false; self.materials.len()];
        self.planes.iter().for_each(|plane| present[usize::from(plane.wall.material)] = true);
        present
    }

    fn plan(
        &self,
        limits: &StepLimits,
        constraints: Vec<tdem_engine::Constraint>,
        interactions: Vec<tdem_engine::physics::contact::Interaction<f64>>,
        smallest_radius: f64,
    ) -> Plan {
        let case = &self.loaded.case;
        Plan {
            dt: limits.step,
            integrator: match case.time.integrator {
                schema::Integrator::VelocityVerlet => Integrator::VelocityVerlet,
                schema::Integrator::Gear => Integrator::Gear,
            },
            law: law(case),
            materials: self.materials.len(),
            interactions,
            bonds: None,
            heat: None,
            walls: self.planes.iter().map(|plane| plane.wall.clone()).collect(),
            gravity: self.gravity(),
            constraints,
            ramps: Vec::new(),
            gauges: Vec::new(),
            domain: self.domain,
            search: Search { skin: case.search.skin.get() * smallest_radius, every_step: case.search.every_step },
            overlap_limit: case.contact.overlap_limit.get(),
            ledger: case.output.ledger,
        }
    }
}

/// Heavier particles that are free to fall do so slowly.
fn slow_fall(context: &Context<'_>, state: &State) -> Option<Problem> {
    let scaling = context.loaded.case.time.mass_scaling();
    if scaling == 1.0 || !state.bonds.is_empty() || context.gravity() == [0.0; 3] {
        return None;
    }
    let [place, cause] = [&["time", "mass_scaling"][..], &["gravity"]].map(|path| context.loaded.tree.place(path));
    let message = format!(
        "no particles are bonded, and what falls with {} times its mass takes {} times as long",
        number(scaling),
        number(scaling.sqrt())
    );
    Some(
        Problem::new(codes::MASS_SCALING_FALLS, message)
            .at(place, "for states of rest only")
            .at(cause, "pulls as it does at the true mass")
            .help("remove it where the way to rest matters"),
    )
}

/// The spheres of one group.
fn place(
    context: &Context<'_>,
    loader: &dyn RunLoader,
    draft: &Draft,
    index: usize,
    group: &Particles,
) -> Result<Spheres, Vec<Problem>> {
    if let Some(spec) = &group.lattice {
        return lattice::place(context, index, spec).map_err(|problem| vec![problem]);
    }
    if let Some(spec) = &group.random {
        return random::place(context, draft, index, spec).map_err(|problem| vec![problem]);
    }
    if let Some(spec) = &group.csv {
        return csv::place(context, index, group, spec);
    }
    if let Some(spec) = &group.run {
        return run::place(context, loader, index, group, spec).map_err(|problem| vec![problem]);
    }
    let (positions, radius) = group.list.as_ref().map_or((Vec::new(), 1.0), |l| (l.positions.clone(), l.radius.get()));
    Ok(Spheres { radius: vec![radius; positions.len()], position: positions, ..Spheres::default() })
}
