//! What the cases share: materials, scenes, and the bench that judges.

use super::{Backend, Check, Kind, Tolerance};
use tdem_engine::physics::contact::damping::restitution_factor;
use tdem_engine::physics::contact::{Interaction, Law};
use tdem_engine::physics::material::{Elastic, shear_modulus_eff, young_modulus_eff};
use tdem_engine::{Constraint, Domain, Fault, Integrator, Plan, Search, Simulation, State, Wall};

pub(super) const GRAVITY: f64 = 9.81;
/// Duration of an elastic Hertz impact in units of largest overlap over speed: 4 sqrt(pi) Gamma(2/5) / (5 Gamma(9/10)).
const DURATION: f64 = 2.943_275_184_324_704_3;

/// A material.
#[derive(Clone, Copy)]
pub(super) struct Solid {
    pub(super) elastic: Elastic,
    pub(super) density: f64,
}

pub(super) const fn solid(young_modulus: f64, poisson_ratio: f64, density: f64) -> Solid {
    Solid { elastic: Elastic { young_modulus, poisson_ratio }, density }
}

pub(super) const ALUMINIUM_OXIDE: Solid = solid(3.8e11, 0.23, 4000.0);
pub(super) const ALUMINIUM_ALLOY: Solid = solid(7e10, 0.33, 2700.0);
pub(super) const STEEL: Solid = solid(2.08e11, 0.3, 7850.0);
pub(super) const NYLON: Solid = solid(2.5e9, 0.4, 1000.0);
/// The plastic of the paper's gravity packing.
pub(super) const PLASTIC: Solid = solid(9.33e6, 0.352, 920.0);

impl Solid {
    pub(super) fn sphere_mass(&self, radius: f64) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius * self.density
    }
    /// Elastic contact of two bodies of this material.
    pub(super) fn with_itself(&self) -> Interaction<f64> {
        elastic(self.elastic, self.elastic)
    }
    /// Elastic contact with a rigid wall.
    pub(super) fn with_rigid(&self) -> Interaction<f64> {
        elastic(self.elastic, Elastic::RIGID)
    }
}

/// Elastic and frictionless contact; the dashpot, if any, may attract.
pub(super) fn elastic(a: Elastic, b: Elastic) -> Interaction<f64> {
    Interaction {
        normal_stiffness: 4.0 / 3.0 * young_modulus_eff(a, b),
        tangential_stiffness: 8.0 * shear_modulus_eff(a, b),
        normal_damping: 0.0,
        tangential_damping: 0.0,
        static_friction: 0.0,
        dynamic_friction: 0.0,
        least_normal_force: f64::NEG_INFINITY,
    }
}

/// Changes to an interaction, in words.
pub(super) trait With: Sized {
    fn friction(self, coefficient: f64) -> Self;
    fn restitution(self, e: f64) -> Self;
    fn dashpots(self, normal: f64, tangential: f64) -> Self;
    fn clamped(self) -> Self;
}

impl With for Interaction<f64> {
    fn friction(mut self, coefficient: f64) -> Self {
        (self.static_friction, self.dynamic_friction) = (coefficient, coefficient);
        self
    }
    fn restitution(mut self, e: f64) -> Self {
        self.normal_damping = restitution_factor(e);
        self
    }
    fn dashpots(mut self, normal: f64, tangential: f64) -> Self {
        (self.normal_damping, self.tangential_damping) = (normal, tangential);
        self
    }
    fn clamped(mut self) -> Self {
        self.least_normal_force = 0.0;
        self
    }
}

/// An elastic Hertz impact on paper.
#[derive(Clone, Copy)]
pub(super) struct Hertz {
    /// $k_H = \tfrac43E^*\sqrt{R^*}$.
    pub(super) stiffness: f64,
    pub(super) mass_eff: f64,
}

impl Hertz {
    pub(super) fn new(interaction: &Interaction<f64>, radius_eff: f64, mass_eff: f64) -> Self {
        Hertz { stiffness: interaction.normal_stiffness * radius_eff.sqrt(), mass_eff }
    }
    pub(super) fn largest_overlap(&self, speed: f64) -> f64 {
        libm::pow(1.25 * self.mass_eff * speed * speed / self.stiffness, 0.4)
    }
    pub(super) fn duration(&self, speed: f64) -> f64 {
        DURATION * self.largest_overlap(speed) / speed
    }
    /// Overlap at which the contact carries a force.
    pub(super) fn overlap(&self, force: f64) -> f64 {
        libm::pow(force / self.stiffness, 2.0 / 3.0)
    }
}

/// A scene: spheres, walls and laws.
#[derive(Clone)]
pub(super) struct Scene {
    pub(super) state: State,
    pub(super) plan: Plan,
}

/// Half the width of the box of a scene that does not repeat, m.
const FAR: f64 = 1e4;

impl Scene {
    /// One kind of contact, for all.
    pub(super) fn new(law: Law, interaction: Interaction<f64>, dt: f64) -> Self {
        Scene::side_by_side(law, &[interaction], dt)
    }

    /// Several experiments in one simulation: the sphere of material `k` meets walls by the `k`-th interaction.
    pub(super) fn side_by_side(law: Law, interactions: &[Interaction<f64>], dt: f64) -> Self {
        let materials = interactions.len() + 1;
        let table =
            (0..materials * materials).map(|k| interactions[(k / materials).min(k % materials).min(materials - 2)]);
        let plan = Plan {
            dt,
            integrator: Integrator::VelocityVerlet,
            law,
            materials,
            interactions: table.collect(),
            bonds: None,
            heat: None,
            walls: Vec::new(),
            gravity: [0.0; 3],
            constraints: vec![Constraint::FREE],
            ramps: Vec::new(),
            gauges: Vec::new(),
            domain: Domain { min: [-FAR; 3], max: [FAR; 3], periodic: [false; 3] },
            search: Search { skin: 0.0, every_step: false },
            overlap_limit: 0.5,
            ledger: true,
        };
        Scene { state: State::default(), plan }
    }

    /// Adds a sphere at rest and returns its index.
    pub(super) fn sphere(&mut self, radius: f64, density: f64, position: [f64; 3]) -> usize {
        let state = &mut self.state;
        let index = state.len();
        state.id.push(index as u32);
        state.material.push(0);
        state.constraint.push(0);
        state.radius.push(radius);
        state.mass.push(solid(1.0, 0.0, density).sphere_mass(radius));
        state.position.push(position);
        state.image.push([0; 3]);
        for field in [&mut state.velocity, &mut state.angular_velocity, &mut state.force, &mut state.moment] {
            field.push([0.0; 3]);
        }
        state.accounts.push([0.0; 4]);
        self.plan.search.skin = self.plan.search.skin.max(0.2 * radius);
        index
    }

    /// Adds a sphere that moves.
    pub(super) fn moving(&mut self, radius: f64, density: f64, position: [f64; 3], velocity: [f64; 3]) -> usize {
        let index = self.sphere(radius, density, position);
        self.state.velocity[index] = velocity;
        index
    }

    /// Adds a resting wall; its normal points to the particles.
    pub(super) fn wall(&mut self, normal: [f64; 3], point: [f64; 3]) {
        let name = format!("wall {}", self.plan.walls.len());
        let material = (self.plan.materials - 1) as u16;
        self.plan.walls.push(Wall { name, normal, velocity: [0.0; 3], material });
        self.state.wall_position.push(point);
    }

    /// Adds the plane z = 0.
    pub(super) fn floor(&mut self) {
        self.wall([0.0, 0.0, 1.0], [0.0; 3]);
    }

    /// Holds components of a particle's motion.
    pub(super) fn hold(&mut self, index: usize, constraint: Constraint) {
        self.state.constraint[index] = self.plan.constraints.len() as u16;
        self.plan.constraints.push(constraint);
        for k in 0..3 {
            if let Some(v) = constraint.velocity[k] {
                self.state.velocity[index][k] = v;
            }
            if let Some(v) = constraint.angular_velocity[k] {
                self.state.angular_velocity[index][k] = v;
            }
        }
    }
}

/// Nothing may turn or move, except as said in the fields.
pub(super) const HELD: Constraint =
    Constraint { velocity: [Some(0.0); 3], angular_velocity: [Some(0.0); 3], ..Constraint::FREE };

/// Random numbers in [0, 1) by counting: the n-th number of a stream does not depend on the others.
pub(super) fn random(stream: u64, n: usize) -> f64 {
    let mut z = stream
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add((n as u64).wrapping_add(1).wrapping_mul(0xbf58_476d_1ce4_e5b9));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// A random vector with components in [-1, 1).
pub(super) fn random_vector(stream: u64, n: usize) -> [f64; 3] {
    std::array::from_fn(|d| 2.0 * random(stream, 3 * n + d) - 1.0)
}

/// A sampled value with its instant's fraction of a step: where a sampled quantity crosses zero.
pub(super) fn crossing(before: f64, after: f64) -> f64 {
    before / (before - after)
}

/// Runs simulations on one back end and judges what they give.
pub(super) struct Bench {
    backend: Backend,
    alter: fn(&mut Plan),
    checks: Vec<Check>,
    hash: Option<u128>,
}

impl Bench {
    pub(super) fn new(backend: Backend, alter: fn(&mut Plan)) -> Self {
        Bench { backend, alter, checks: Vec::new(), hash: None }
    }
    pub(super) fn finish(self) -> (Vec<Check>, Option<u128>) {
        (self.checks, self.hash)
    }

    /// A simulation of a scene.
    pub(super) fn start(&self, scene: &Scene) -> Result<Simulation, Fault> {
        self.start_on(scene, 1)
    }
    /// The same on several threads, where the back end has threads.
    pub(super) fn start_on(&self, scene: &Scene, threads: usize) -> Result<Simulation, Fault> {
        let mut plan = scene.plan.clone();
        (self.alter)(&mut plan);
        Simulation::new(scene.state.clone(), plan, self.backend.device(threads))
    }
    /// The state after a number of steps.
    pub(super) fn after(&mut self, scene: &Scene, steps: u64) -> Result<State, Fault> {
        let mut simulation = self.start(scene)?;
        simulation.advance(steps)?;
        let state = simulation.state()?;
        self.seal(&state);
        Ok(state)
    }
    /// Adds a final state to the hash of the case.
    pub(super) fn seal(&mut self, state: &State) {
        let before = self.hash.unwrap_or(0);
        self.hash = Some(before.rotate_left(1) ^ state.hash());
    }

    /// Judges a value.
    pub(super) fn judge(&mut self, what: impl Into<String>, unit: &'static str, got: f64, expect: Expect) {
        let Expect { value: expected, tolerance, kind } = expect;
        let passed = match tolerance {
            Tolerance::Absolute(width) => (got - expected).abs() <= width,
            Tolerance::Relative(part) => (got - expected).abs() <= part * expected.abs(),
            Tolerance::AtMost => got <= expected,
            Tolerance::AtLeast => got >= expected,
        };
        self.checks.push(Check { what: what.into(), unit, expected, got, tolerance, kind, passed });
    }
}

/// What a value should be, how closely, and how that is known.
#[derive(Clone, Copy)]
pub(super) struct Expect {
    value: f64,
    tolerance: Tolerance,
    kind: Kind,
}

impl Kind {
    pub(super) fn within(self, value: f64, width: f64) -> Expect {
        Expect { value, tolerance: Tolerance::Absolute(width), kind: self }
    }
    pub(super) fn relative(self, value: f64, part: f64) -> Expect {
        Expect { value, tolerance: Tolerance::Relative(part), kind: self }
    }
    pub(super) fn at_most(self, value: f64) -> Expect {
        Expect { value, tolerance: Tolerance::AtMost, kind: self }
    }
    pub(super) fn at_least(self, value: f64) -> Expect {
        Expect { value, tolerance: Tolerance::AtLeast, kind: self }
    }
}
