//! A bonded assembly between two grips: how stiff it is, without time, and how strong, by motion.
//!
//! Grips are the particles whose centres lie within one mean diameter of either end. They are moved along the axis and
//! free across it; nothing else is held. Stress is the force on a grip over the section; strain is the slope of
//! displacements over places in the middle half, where grips are not felt, by least squares.

use crate::statics::{Assembly, Boundary, Error as StaticsError, Solution};
use std::collections::BTreeSet;
use tdem_engine::physics::Vec3;
use tdem_engine::physics::bond::{Damping, Form, Joint};
use tdem_engine::physics::motion::sphere_inertia;
use tdem_engine::physics::stability::BondedParticle;
use tdem_engine::{Constraint, ExactSum, Fault, Plan, Simulation, State};

/// Why a specimen cannot be tested.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The state has no bonds that hold.
    #[error("nothing is bonded")]
    NoBonds,
    /// Bonds are of several kinds.
    #[error("bonds of {kinds} pairs of materials hold the assembly together; only one pair can be calibrated")]
    SeveralKinds {
        /// How many pairs of materials are bonded.
        kinds: usize,
    },
    /// The box repeats, so that the assembly has no ends or no free sides.
    #[error("the domain repeats: a specimen has ends and free sides")]
    Periodic,
    /// Bonds do not lead from one end to the other.
    #[error("bonds do not lead from one end of the assembly to the other along {axis}")]
    NotSpanning {
        /// `x`, `y` or `z`.
        axis: char,
    },
    /// No static equilibrium.
    #[error(transparent)]
    Statics(#[from] StaticsError),
    /// Bonds that cannot break have no strength to measure.
    #[error("bonds are unbreakable: there is no strength to find")]
    Unbreakable,
    /// The load did not fall to half of its greatest.
    #[error("the specimen does not break: at {strain:.3e} of strain the load is still above half of its greatest")]
    DoesNotBreak {
        /// Strain between the grips at which the test was given up.
        strain: f64,
    },
    /// The simulation failed.
    #[error(transparent)]
    Fault(#[from] Fault),
}

/// Which way the grips go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// Apart.
    Tension,
    /// Towards each other.
    Compression,
}

impl Sense {
    const fn sign(self) -> f64 {
        match self {
            Sense::Tension => 1.0,
            Sense::Compression => -1.0,
        }
    }
}

/// A bonded assembly between two grips, with nothing else around it.
#[derive(Clone, Debug)]
pub struct Specimen {
    state: State,
    plan: Plan,
    /// What its bonds are made of.
    joint: Joint<f64>,
    axis: usize,
    /// Particles of the lower and of the upper grip.
    grips: [Vec<usize>; 2],
    /// Particles between the quarter points that bonds join to the grips.
    middle: Vec<usize>,
    /// From surface to surface, m.
    extent: [[f64; 2]; 3],
    section: f64,
    /// Of grips, over the usual.
    rate: f64,
}

/// Elastic constants as a uniaxial test shows them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elasticity {
    /// Pa.
    pub young_modulus: f64,
    /// Mean of both directions across.
    pub poisson_ratio: f64,
}

/// What a test to failure gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failure {
    /// Greatest stress, Pa, positive in either sense.
    pub strength: f64,
    /// Strain between the grips there, positive in either sense.
    pub strain: f64,
    /// From the first sample before anything broke, half way to the first breakage.
    pub elasticity: Elasticity,
    /// Bonds that broke.
    pub broken: usize,
    /// Steps that it took.
    pub steps: u64,
}

/// Coefficient of local damping in tests to failure.
const LOCAL_DAMPING: f64 = 0.7;
/// Part of the proven bound of the step.
const STEP: f64 = 0.8;
/// Transits of a wave from grip to grip until the first bond breaks.
const TRANSITS: f64 = 20.0;
/// Samples until the first bond breaks.
const SAMPLES: f64 = 60.0;
/// Strains at first breakage beyond which a specimen counts as one that does not break.
const MOST_STRAIN: f64 = 60.0;

impl Specimen {
    /// The bonded assembly of a case, taken out of its walls, gravity and constraints. Without a section, m², that of the
    /// box around all spheres is taken.
    ///
    /// # Errors
    /// [`Error::NoBonds`], [`Error::SeveralKinds`], [`Error::Periodic`], [`Error::NotSpanning`].
    pub fn of(state: &State, plan: &Plan, axis: usize, section: Option<f64>) -> Result<Self, Error> {
        if plan.domain.periodic.contains(&true) {
            return Err(Error::Periodic);
        }
        let assembly = Assembly::of(state, plan).map_err(|_| Error::NoBonds)?;
        let kinds = bonded_materials(state);
        if kinds.len() > 1 {
            return Err(Error::SeveralKinds { kinds: kinds.len() });
        }
        let joint = *kinds.first().and_then(|&[a, b]| plan.joint(a, b)).ok_or(Error::NoBonds)?;
        let extent = extent(state);
        let [low, high] = extent[axis];
        let diameter = 2.0 * ExactSum::of(state.radius.iter().copied()).value() / state.len() as f64;
        let along = |k: usize| state.position[k][axis];
        let held = |k: &usize| assembly.bonded_to(*k).next().is_some();
        let all = || (0..state.len()).filter(held);
        let grips: [Vec<usize>; 2] = [
            all().filter(|&k| along(k) <= low + diameter).collect(),
            all().filter(|&k| along(k) >= high - diameter).collect(),
        ];
        let joined = joined(&assembly, &grips[0]);
        if grips[1].iter().all(|&k| !joined[k]) || grips[0].iter().any(|k| grips[1].contains(k)) {
            return Err(Error::NotSpanning { axis: ['x', 'y', 'z'][axis] });
        }
        let (centre, quarter) = (0.5 * (low + high), 0.25 * (high - low));
        let middle = (0..state.len()).filter(|&k| joined[k] && (along(k) - centre).abs() <= quarter).collect();
        let across = |k: usize| extent[(axis + k) % 3][1] - extent[(axis + k) % 3][0];
        let section = section.unwrap_or(across(1) * across(2));
        let (state, plan) = alone(state, plan, &extent);
        Ok(Specimen { state, plan, joint, axis, grips, middle, extent, section, rate: 1.0 })
    }

    /// What its bonds are made of.
    #[must_use]
    pub fn joint(&self) -> Joint<f64> {
        self.joint
    }

    /// The same with bonds of another kind.
    #[must_use]
    pub fn with(&self, joint: Joint<f64>) -> Self {
        let mut changed = Specimen { joint, ..self.clone() };
        if let Some(bonds) = &mut changed.plan.bonds {
            bonds.joints.iter_mut().flatten().for_each(|each| *each = joint);
        }
        changed
    }

    /// The same with grips that move so many times faster in tests to failure.
    #[must_use]
    pub fn at_rate(&self, factor: f64) -> Self {
        Specimen { rate: factor, ..self.clone() }
    }

    /// Its particles and bonds.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The box around its spheres, m.
    #[must_use]
    pub fn extent(&self) -> [[f64; 2]; 3] {
        self.extent
    }

    /// Area across the axis, m².
    #[must_use]
    pub fn section(&self) -> f64 {
        self.section
    }

    /// From surface to surface along the axis, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.extent[self.axis][1] - self.extent[self.axis][0]
    }

    /// Between the mean places of the grips, m.
    fn span(&self) -> f64 {
        let place = |&k: &usize| self.state.position[k][self.axis];
        let mean = |grip: &[usize]| ExactSum::of(grip.iter().map(place)).value() / grip.len() as f64;
        mean(&self.grips[1]) - mean(&self.grips[0])
    }

    /// Young's modulus and Poisson's ratio in static equilibrium, linear.
    ///
    /// # Errors
    /// [`Error::Statics`].
    pub fn elasticity(&self) -> Result<Elasticity, Error> {
        let strain = 1e-6;
        let solution = self.stretched(strain)?;
        let force = ExactSum::of(self.grips[1].iter().map(|&k| solution.reaction[k][self.axis])).value();
        let moved = |k: usize| std::array::from_fn(|d| solution.displacement[k][d]);
        Ok(self.elasticity_of(force, &moved))
    }

    /// At rest under a strain between the grips.
    fn stretched(&self, strain: f64) -> Result<Solution, Error> {
        let mut boundary = Boundary::free(self.state.len());
        for (grip, sign) in self.grips.iter().zip([-0.5, 0.5]) {
            for &k in grip {
                boundary.held[k][self.axis] = Some(sign * strain * self.span());
            }
        }
        Ok(Assembly::of(&self.state, &self.plan)?.solve(&boundary)?)
    }

    /// What a force on the grips and displacements of particles say.
    fn elasticity_of(&self, force: f64, moved: &dyn Fn(usize) -> [f64; 3]) -> Elasticity {
        let slope = |d: usize| {
            let points = self.middle.iter().map(|&k| (self.state.position[k][d], moved(k)[d]));
            let count = self.middle.len() as f64;
            let sum = |of: &dyn Fn((f64, f64)) -> f64| ExactSum::of(points.clone().map(of)).value();
            let (x, u) = (sum(&|point| point.0) / count, sum(&|point| point.1) / count);
            let cross = sum(&|point| (point.0 - x) * (point.1 - u));
            cross / sum(&|point| (point.0 - x) * (point.0 - x))
        };
        let [along, first, second] = [0, 1, 2].map(|k| slope((self.axis + k) % 3));
        Elasticity { young_modulus: force / self.section / along, poisson_ratio: -0.5 * (first + second) / along }
    }

    /// Strain between the grips at which the first bond breaks, by the static solution.
    ///
    /// # Errors
    /// [`Error::Statics`]; [`Error::Unbreakable`].
    pub fn first_breakage(&self, sense: Sense) -> Result<f64, Error> {
        let strain = sense.sign() * 1e-6;
        let moved = self.stretched(strain)?.applied_to(&self.state);
        let mut most = 0.0_f64;
        for bond in (0..moved.bonds.len()).filter_map(|index| moved.evaluate_bond(&self.plan, index)) {
            let stress = &bond.reaction.stress;
            let tension = stress.tensile / bond.bond.tensile_strength;
            // tau = c - s tan(phi), in proportion to the load.
            let shear = (stress.shear + stress.axial * bond.bond.internal_friction) / bond.bond.shear_strength;
            most = most.max(tension).max(shear);
        }
        if most > 0.0 { Ok(strain.abs() / most) } else { Err(Error::Unbreakable) }
    }

    /// Moves the grips until the load has fallen to half of its greatest. `start` makes the simulation of a state and a
    /// plan.
    ///
    /// # Errors
    /// All but those of [`Self::of`].
    pub fn load_to_failure(
        &self,
        sense: Sense,
        start: impl FnOnce(State, Plan) -> Result<Simulation, Fault>,
    ) -> Result<Failure, Error> {
        let first = self.first_breakage(sense)?;
        let Elasticity { young_modulus, poisson_ratio } = self.elasticity()?;
        let bulk_density = ExactSum::of(self.state.mass.iter().copied()).value() / (self.section * self.length());
        let transit = self.length() / (young_modulus / bulk_density).sqrt();
        let rate = self.rate * sense.sign() * first / (TRANSITS * transit);
        let (state, plan) = self.in_motion(rate, poisson_ratio);
        let step = plan.dt;
        let every = ((TRANSITS * transit / step / SAMPLES / self.rate) as u64).max(1);
        let mut simulation = start(state, plan)?;
        let mut found = Failure {
            strength: 0.0,
            strain: 0.0,
            elasticity: Elasticity { young_modulus: f64::NAN, poisson_ratio: f64::NAN },
            broken: 0,
            steps: 0,
        };
        let mut seen = false;
        loop {
            simulation.advance(every)?;
            let state = simulation.state()?;
            let strain = (rate * step * state.step as f64).abs();
            let stress = self.force(&state) / self.section * sense.sign();
            if stress > found.strength {
                (found.strength, found.strain) = (stress, strain);
            }
            if !seen && strain >= 0.5 * first {
                let moved = |k: usize| std::array::from_fn(|d| state.position[k][d] - self.state.position[k][d]);
                found.elasticity = self.elasticity_of(self.force(&state), &moved);
                seen = true;
            }
            if seen && stress < 0.5 * found.strength {
                found.broken = state.bonds.iter().filter(|bond| !bond.holds()).count();
                found.steps = state.step;
                return Ok(found);
            }
            if strain > MOST_STRAIN * first {
                return Err(Error::DoesNotBreak { strain });
            }
        }
    }

    /// Mean of the forces on the grips, N, tension positive.
    fn force(&self, state: &State) -> f64 {
        let of = |grip: &[usize]| ExactSum::of(grip.iter().map(|&k| state.force[k][self.axis])).value();
        0.5 * (of(&self.grips[0]) - of(&self.grips[1]))
    }

    /// The specimen deforming at a rate, 1/s: grips move, and what is between begins with them.
    fn in_motion(&self, rate: f64, poisson_ratio: f64) -> (State, Plan) {
        let (mut state, mut plan) = (self.state.clone(), self.plan.clone());
        let centre = self.extent.map(|[low, high]| 0.5 * (low + high));
        for k in 0..state.len() {
            state.velocity[k] = std::array::from_fn(|d| {
                let part = if d == self.axis { 1.0 } else { -poisson_ratio };
                part * rate * (state.position[k][d] - centre[d])
            });
        }
        for (index, sign) in [-0.5, 0.5].into_iter().enumerate() {
            let mut constraint = Constraint::FREE;
            constraint.velocity[self.axis] = Some(sign * rate * self.span());
            plan.constraints.push(constraint);
            for &k in &self.grips[index] {
                state.constraint[k] = (index + 1) as u16;
                state.velocity[k][self.axis] = sign * rate * self.span();
            }
        }
        plan.dt = STEP * self.stable_step();
        (state, plan)
    }

    /// The proven bound of the step, s.
    fn stable_step(&self) -> f64 {
        let state = &self.state;
        let mut particles = vec![BondedParticle::default(); state.len()];
        for bond in &state.bonds {
            let (Some(i), Some(j)) = (state.index_of(bond.first), state.index_of(bond.second)) else { continue };
            let offset = Vec3::from(state.position[j]) - Vec3::from(state.position[i]);
            let length = offset.dot(offset).sqrt();
            let radii = [state.radius[i], state.radius[j]];
            let numbers = self.joint.bond(radii[0], radii[1], length, 1.0);
            for (k, radius) in [(i, radii[0]), (j, radii[1])] {
                let arm = length * radius / (radii[0] + radii[1]);
                particles[k].hold(&numbers, offset * (1.0 / length), arm);
            }
        }
        let of = |k: usize| particles[k].verlet_step(state.mass[k], sphere_inertia(state.mass[k], state.radius[k]));
        (0..state.len()).map(of).fold(f64::INFINITY, f64::min)
    }
}

/// Pairs of materials that are bonded.
fn bonded_materials(state: &State) -> BTreeSet<[u16; 2]> {
    let pair = |bond: &tdem_engine::Bond| {
        let mut pair = [bond.first, bond.second].map(|id| state.material[state.index_of(id).unwrap_or(0)]);
        pair.sort_unstable();
        pair
    };
    state.bonds.iter().filter(|bond| bond.holds()).map(pair).collect()
}

/// From surface to surface, m.
fn extent(state: &State) -> [[f64; 2]; 3] {
    let mut extent = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for (place, radius) in state.position.iter().zip(&state.radius) {
        for (range, x) in extent.iter_mut().zip(place) {
            *range = [range[0].min(x - radius), range[1].max(x + radius)];
        }
    }
    extent
}

/// Whom bonds join to any of some particles.
fn joined(assembly: &Assembly, from: &[usize]) -> Vec<bool> {
    let mut joined = vec![false; assembly.particles()];
    let mut waiting = from.to_vec();
    for &k in from {
        joined[k] = true;
    }
    while let Some(particle) = waiting.pop() {
        for other in assembly.bonded_to(particle) {
            if !joined[other] {
                joined[other] = true;
                waiting.push(other);
            }
        }
    }
    joined
}

/// Particles at rest with their bonds, without force, in empty space.
fn alone(state: &State, plan: &Plan, extent: &[[f64; 2]; 3]) -> (State, Plan) {
    let mut plan = plan.clone();
    plan.law.moments = true;
    plan.walls.clear();
    plan.gravity = [0.0; 3];
    plan.constraints = vec![Constraint::FREE];
    plan.ramps.clear();
    plan.gauges.clear();
    plan.ledger = false;
    plan.integrator = tdem_engine::Integrator::VelocityVerlet;
    let room = extent.map(|[low, high]| high - low).into_iter().fold(0.0, f64::max);
    plan.domain.min = extent.map(|[low, _]| low - room);
    plan.domain.max = extent.map(|[_, high]| high + room);
    if let Some(bonds) = &mut plan.bonds {
        bonds.law.form = Form::Total;
        bonds.law.damping = Damping::Off;
        bonds.local_damping = LOCAL_DAMPING;
    }
    let nothing = vec![[0.0; 3]; state.len()];
    let mut alone = State {
        id: state.id.clone(),
        material: state.material.clone(),
        constraint: vec![0; state.len()],
        radius: state.radius.clone(),
        mass: state.mass.clone(),
        position: state.position.clone(),
        image: vec![[0; 3]; state.len()],
        velocity: nothing.clone(),
        angular_velocity: nothing.clone(),
        force: nothing.clone(),
        moment: nothing,
        ..State::default()
    };
    alone.make_bonds(state.bonds.iter().filter(|bond| bond.holds()).copied().collect());
    (alone, plan)
}
