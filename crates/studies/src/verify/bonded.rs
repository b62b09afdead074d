//! Scenes with bonds: what the cases of chains and blocks share.

use super::scene::{Bench, Scene, Solid, solid};
use tdem_engine::physics::Vec3;
use tdem_engine::physics::bond::{Bond as Numbers, Cement, Damping, Form, Joint, Law, Tension};
use tdem_engine::physics::contact;
use tdem_engine::{Bond, BondPlan, BondTables, Constraint, Domain, Fault, State};

pub(super) const RADIUS: f64 = 5e-3;
/// Of touching spheres: the length of a bond.
pub(super) const SPACING: f64 = 2.0 * RADIUS;
/// Of touching spheres on a face-centred cubic lattice.
pub(super) const LATTICE_CONSTANT: f64 = 2.0 * std::f64::consts::SQRT_2 * RADIUS;
pub(super) const ROCK: Solid = solid(1e7, 0.25, 2500.0);

pub(super) const CEMENT: Cement<f64> = Cement {
    stiffness_ratio: 0.4,
    radius_multiplier: 0.8,
    tensile_strength: f64::INFINITY,
    shear_strength: f64::INFINITY,
    internal_friction: 0.0,
    moment_contribution: 1.0,
    damping_ratio: 0.0,
};
pub(super) const JOINT: Joint<f64> = Joint { cement: CEMENT, stiffness_per_area: 7.5e8, young_modulus: 0.0 };

pub(super) const FORMS: [(&str, Form); 2] =
    [("total", Form::Total), ("incremental", Form::Incremental(Tension::FromLength))];

/// The bond of two spheres of [`RADIUS`] that touch.
pub(super) fn numbers(joint: &Joint<f64>) -> Numbers<f64> {
    joint.bond(RADIUS, RADIUS, SPACING, 1.0)
}

/// $\sqrt{m/K_n}$, s: steps are parts of it.
pub(super) fn unit_of_time(joint: &Joint<f64>) -> f64 {
    (ROCK.sphere_mass(RADIUS) / numbers(joint).stiffness.normal).sqrt()
}

/// A scene without particles whose bonds are of one kind and keep contact off; `part` is the step over
/// [`unit_of_time`]. Bonds have dashpots if their cement says so.
pub(super) fn scene(form: Form, joint: Joint<f64>, part: f64) -> Scene {
    let mut scene = Scene::new(contact::Law::GNTM, ROCK.with_itself(), part * unit_of_time(&joint));
    let damping = if joint.cement.damping_ratio > 0.0 { Damping::Viscous } else { Damping::Off };
    scene.plan.bonds = Some(BondPlan {
        law: Law { form, damping },
        joints: vec![Some(joint); scene.plan.materials * scene.plan.materials],
        tables: BondTables::default(),
        contact_in_bonded_pairs: false,
        local_damping: 0.0,
    });
    scene
}

impl Scene {
    /// Sets the coefficient of local damping.
    pub(super) fn damp_locally(&mut self, coefficient: f64) {
        if let Some(bonds) = &mut self.plan.bonds {
            bonds.local_damping = coefficient;
        }
    }

    /// A box of so many cells of the lattice that repeats along some axes.
    pub(super) fn repeat(&mut self, cells: [usize; 3], periodic: [bool; 3]) {
        self.plan.domain = Domain {
            min: [-0.25 * LATTICE_CONSTANT; 3],
            max: cells.map(|n| (n as f64 - 0.25) * LATTICE_CONSTANT),
            periodic,
        };
    }

    /// Adds spheres in a row along x from the origin on, each bonded to the next.
    pub(super) fn chain(&mut self, links: usize) {
        for k in 0..=links {
            self.sphere(RADIUS, ROCK.density, [SPACING * k as f64, 0.0, 0.0]);
        }
        self.state.make_bonds((0..links as u32).map(|k| Bond::new(k, k + 1, 1.0)).collect());
    }

    /// Adds touching spheres on the sites of a face-centred cubic lattice, neighbours bonded, a corner at the origin;
    /// returns the sites in half cells. Bonds reach through the faces of a box that repeats.
    pub(super) fn block(&mut self, cells: [usize; 3]) -> Vec<[usize; 3]> {
        self.lattice(cells, |_| true)
    }

    /// The same, only the sites that are wanted.
    pub(super) fn lattice(&mut self, cells: [usize; 3], wanted: impl Fn([usize; 3]) -> bool) -> Vec<[usize; 3]> {
        let along = |extent: usize| 0..2 * extent;
        let mut sites = Vec::new();
        for z in along(cells[2]) {
            for y in along(cells[1]) {
                sites.extend(along(cells[0]).filter(|x| (x + y + z) % 2 == 0).map(|x| [x, y, z]));
            }
        }
        sites.retain(|&site| wanted(site));
        for site in &sites {
            self.sphere(RADIUS, ROCK.density, site.map(|c| 0.5 * LATTICE_CONSTANT * c as f64));
        }
        let (period, places) = (self.plan.domain.period(), &self.state.position);
        let mut bonds = Vec::new();
        for i in 0..sites.len() {
            for j in i + 1..sites.len() {
                let (first, second): (Vec3<f64>, Vec3<f64>) = (places[i].into(), places[j].into());
                let offset = period.nearest(second - first);
                if offset.dot(offset).sqrt() < 1.01 * SPACING {
                    bonds.push(Bond::new(i as u32, j as u32, 1.0));
                }
            }
        }
        self.state.make_bonds(bonds);
        sites
    }
}

/// Components of a motion that is prescribed.
#[derive(Clone, Copy)]
pub(super) struct Way {
    /// Way of each component, m; `None` is left to the forces.
    pub(super) shift: [Option<f64>; 3],
    /// Angle about each axis, rad.
    pub(super) turn: [Option<f64>; 3],
}

impl Way {
    pub(super) const HELD: Way = Way { shift: [Some(0.0); 3], turn: [Some(0.0); 3] };
    /// What covers a part of it in each step of length `dt`.
    pub(super) fn at_rate(self, part: f64, dt: f64) -> Constraint {
        let rate = |component: Option<f64>| component.map(|whole| whole * part / dt);
        Constraint { velocity: self.shift.map(rate), angular_velocity: self.turn.map(rate), ..Constraint::FREE }
    }
}

/// Steps in which an end is moved before it is held.
const PUSH: u64 = 100;

/// Clamps the first particle, moves the last one along its way, holds it there, and gives the rest time.
pub(super) fn settled(bench: &mut Bench, mut scene: Scene, way: Way, steps: u64) -> Result<State, Fault> {
    let (last, dt) = (scene.state.len() - 1, scene.plan.dt);
    scene.hold(0, Way::HELD.at_rate(0.0, dt));
    scene.hold(last, way.at_rate(1.0 / PUSH as f64, dt));
    scene.state = bench.after(&scene, PUSH)?;
    scene.plan.constraints[2] = way.at_rate(0.0, dt);
    bench.after(&scene, steps)
}
