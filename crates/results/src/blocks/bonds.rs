//! Bonds as lines, what broke as points, and what bonds say of particles.

use super::contacts::array;
use super::{Precision, Scene, field};
use crate::glossary::{BONDS, CRACKS, Place};
use crate::vtkhdf::block::{Block, Cells};
use rayon::prelude::*;
use tdem_engine::physics::bond::{Modes, Section, Stress};
use tdem_engine::physics::{Vec3, vec3};
use tdem_engine::{Bond, Breakage, Contact};

/// A bond of one instant, broken or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Link {
    pub(crate) first: i64,
    pub(crate) second: i64,
    /// The first centre and the nearest image of the second, m.
    pub(crate) ends: [[f64; 3]; 2],
    /// Where its lever arms meet, m.
    pub(crate) middle: [f64; 3],
    /// From the first particle to the second.
    pub(crate) normal: [f64; 3],
    /// Of its section, m².
    pub(crate) area: f64,
    /// On the first particle, dashpots included, N; none once it is broken, as all below.
    pub(crate) force: [f64; 3],
    /// Of the springs, N and N m.
    pub(crate) load: Modes<f64>,
    pub(crate) stress: Stress<f64>,
    pub(crate) breakage: Option<Breakage>,
    /// s; not a number while it holds.
    pub(crate) breakage_time: f64,
}

impl Link {
    /// A bond of particles that a state does not have; no back end hands out such a state.
    const UNKNOWN: Link = Link {
        first: -1,
        second: -1,
        ends: [[f64::NAN; 3]; 2],
        middle: [f64::NAN; 3],
        normal: [f64::NAN; 3],
        area: f64::NAN,
        force: [f64::NAN; 3],
        load: NO_LOAD,
        stress: NO_STRESS,
        breakage: None,
        breakage_time: f64::NAN,
    };

    /// 0 while it holds, else the code of how it failed.
    pub(crate) fn failure(&self) -> i64 {
        self.breakage.map_or(0, |breakage| breakage.failure.code() as i64)
    }
    /// Step in which it broke, 0 while it holds.
    pub(crate) fn breakage_step(&self) -> i64 {
        self.breakage.map_or(0, |breakage| breakage.step.cast_signed())
    }
    /// Energy that left with it, J.
    pub(crate) fn released_energy(&self) -> f64 {
        self.breakage.map_or(0.0, |breakage| breakage.energy)
    }
}

const NO_VECTOR: Vec3<f64> = vec3(0.0, 0.0, 0.0);
const NO_LOAD: Modes<f64> = Modes { normal: 0.0, shear: NO_VECTOR, torsion: 0.0, bending: NO_VECTOR };
const NO_STRESS: Stress<f64> = Stress { axial: 0.0, tensile: 0.0, shear: 0.0 };

/// All bonds, broken ones too.
pub(super) fn lines(links: &[Link], precision: Precision) -> Block {
    // As of contacts, every line has its own two points: the end beyond a seam is an image, not a particle.
    let points = links.par_iter().map(|link| link.ends).collect::<Vec<_>>();
    Block {
        name: Place::Bonds.name(),
        points: precision.store(points.as_flattened().as_flattened()),
        cells: Cells::Lines,
        point_fields: Vec::new(),
        cell_fields: BONDS.par_iter().map(|q| field(q.entry, (q.values)(links), precision)).collect(),
        fixed: false,
    }
}

/// What broke so far.
pub(super) fn cracks(links: &[Link], precision: Precision) -> Block {
    let broken: Vec<Link> = links.iter().filter(|link| link.breakage.is_some()).copied().collect();
    let points = broken.par_iter().map(|link| link.middle).collect::<Vec<_>>();
    Block {
        name: Place::Cracks.name(),
        points: precision.store(points.as_flattened()),
        cells: Cells::Vertices,
        point_fields: CRACKS.par_iter().map(|q| field(q.entry, (q.values)(&broken), precision)).collect(),
        cell_fields: Vec::new(),
        fixed: false,
    }
}

impl Scene<'_> {
    /// Whether particles are, or were, bonded: the same at every instant of a run.
    pub(super) fn has_bonds(&self) -> bool {
        !self.state.bonds.is_empty()
    }

    /// All bonds, in the order of the state.
    pub(super) fn links(&self) -> Vec<Link> {
        let all = (0..self.state.bonds.len()).into_par_iter();
        all.map(|index| self.link(index).unwrap_or(Link::UNKNOWN)).collect()
    }

    fn link(&self, index: usize) -> Option<Link> {
        let (state, plan) = (self.state, self.plan);
        let bond = state.bonds.get(index)?;
        let (i, j) = (state.index_of(bond.first)?, state.index_of(bond.second)?);
        let holding = state.evaluate_bond(plan, index);
        let offset = match &holding {
            Some(found) => found.ends.offset,
            None => self.offset(bond)?,
        };
        let from = Vec3::from(state.position[i]);
        let (first_radius, second_radius) = (state.radius[i], state.radius[j]);
        let cement = plan.joint(state.material[i], state.material[j])?.cement;
        Some(Link {
            first: bond.first.into(),
            second: bond.second.into(),
            ends: [array(from), array(from + offset)],
            middle: array(from + offset * (first_radius / (first_radius + second_radius))),
            normal: array(offset * (1.0 / offset.dot(offset).sqrt())),
            area: Section::between(cement.radius_multiplier, first_radius, second_radius).area,
            force: holding.map_or([0.0; 3], |found| array(found.reaction.force)),
            load: holding.map_or(NO_LOAD, |found| found.reaction.load),
            stress: holding.map_or(NO_STRESS, |found| found.reaction.stress),
            breakage: bond.breakage,
            breakage_time: bond.breakage.map_or(f64::NAN, |breakage| plan.time(breakage.step)),
        })
    }

    /// From the first particle of a bond to the nearest image of the second, m.
    fn offset(&self, bond: &Bond) -> Option<Vec3<f64>> {
        let pair = Contact { first: bond.first, second: bond.second, displacement: [0.0; 3] };
        Some(self.state.evaluate(self.plan, &pair)?.touch.offset)
    }

    /// Of each particle, the bonds that hold and all of them.
    fn bond_counts(&self) -> Vec<[u32; 2]> {
        let mut counts = vec![[0; 2]; self.state.len()];
        for bond in &self.state.bonds {
            for index in [bond.first, bond.second].into_iter().filter_map(|id| self.state.index_of(id)) {
                counts[index][0] += u32::from(bond.holds());
                counts[index][1] += 1;
            }
        }
        counts
    }

    pub(crate) fn bonds_that_hold(&self) -> Vec<i64> {
        self.bond_counts().into_iter().map(|[holding, _]| holding.into()).collect()
    }

    /// Of each particle, the share of its bonds that broke; 0 without any.
    pub(crate) fn damage(&self) -> Vec<f64> {
        let share = |[holding, all]: [u32; 2]| f64::from(all - holding) / f64::from(all.max(1));
        self.bond_counts().into_iter().map(share).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Contents;
    use crate::run_directory::RunDirectory;
    use crate::vtkhdf::hdf5::StoredFile;
    use std::f64::consts::PI;
    use tdem_engine::physics::bond::{Cement, Damping, Failure, Form, Joint, Law};
    use tdem_engine::physics::contact;
    use tdem_engine::{
        BondPlan, BondTables, Constraint, Domain, Integrator, Ledger, Plan, Search, Simulation, State, cpu,
    };

    const RADIUS: f64 = 5e-3;
    const STIFFNESS_PER_AREA: f64 = 7.5e8;
    /// m/s.
    const SPEED: f64 = 0.3;

    /// Four bonded spheres in a row through the face of a box that repeats in x; the first is held, the last is pulled,
    /// and the bond in the middle, at the face, is the weakest.
    fn row() -> (State, Plan) {
        let cement = Cement {
            stiffness_ratio: 0.4,
            radius_multiplier: 1.0,
            tensile_strength: 1e5,
            shear_strength: f64::INFINITY,
            internal_friction: 0.0,
            moment_contribution: 1.0,
            damping_ratio: 0.0,
        };
        let joint = Joint { cement, stiffness_per_area: STIFFNESS_PER_AREA, young_modulus: 0.0 };
        let interaction = contact::Interaction {
            normal_stiffness: 1e6,
            tangential_stiffness: 1e6,
            normal_damping: 0.0,
            tangential_damping: 0.0,
            static_friction: 0.5,
            dynamic_friction: 0.5,
            least_normal_force: 0.0,
        };
        let moving = |speed| Constraint { velocity: [Some(speed), None, None], ..Constraint::FREE };
        let plan = Plan {
            dt: 1e-5,
            integrator: Integrator::VelocityVerlet,
            law: contact::Law::GNTM,
            materials: 1,
            interactions: vec![interaction],
            bonds: Some(BondPlan {
                law: Law { form: Form::Total, damping: Damping::Off },
                joints: vec![Some(joint)],
                tables: BondTables::default(),
                contact_in_bonded_pairs: false,
                local_damping: 0.0,
            }),
            heat: None,
            walls: Vec::new(),
            gravity: [0.0; 3],
            constraints: vec![Constraint::FREE, moving(0.0), moving(SPEED)],
            ramps: Vec::new(),
            gauges: Vec::new(),
            domain: Domain { min: [0.0; 3], max: [0.1; 3], periodic: [true, false, false] },
            search: Search { skin: 1e-3, every_step: false },
            overlap_limit: 0.5,
            ledger: true,
        };
        let mut state = State {
            id: vec![3, 4, 7, 9],
            material: vec![0; 4],
            constraint: vec![1, 0, 0, 2],
            radius: vec![RADIUS; 4],
            mass: vec![1.3e-3; 4],
            position: [0.085, 0.095, 0.005, 0.015].map(|x| [x, 0.05, 0.05]).to_vec(),
            image: [0, 0, 1, 1].map(|image| [image, 0, 0]).to_vec(),
            velocity: [0.0, 0.0, 0.0, SPEED].map(|speed| [speed, 0.0, 0.0]).to_vec(),
            angular_velocity: vec![[0.0; 3]; 4],
            force: vec![[0.0; 3]; 4],
            moment: vec![[0.0; 3]; 4],
            accounts: vec![[0.0; 4]; 4],
            ..State::default()
        };
        state.make_bonds(vec![Bond::new(3, 4, 1.0), Bond::new(4, 7, 0.5), Bond::new(7, 9, 1.0)]);
        (state, plan)
    }

    fn scene<'a>(state: &'a State, plan: &'a Plan) -> Scene<'a> {
        Scene { state, plan, start: None }
    }

    fn simulation() -> Simulation {
        let (state, plan) = row();
        let options = cpu::Options { threads: Some(1), ..cpu::Options::default() };
        Simulation::new(state, plan, options).unwrap()
    }

    #[test]
    fn a_bond_across_the_seam_is_a_short_line_and_pulls_when_stretched() {
        let (mut state, plan) = row();
        let stretch = 1e-5;
        state.position[2][0] += stretch;
        state.position[3][0] += stretch;
        let links = scene(&state, &plan).links();
        let [Link { force: [0.0, 0.0, 0.0], .. }, stretched, _] = links[..] else { panic!("{links:?}") };
        assert_eq!((stretched.first, stretched.second), (4, 7));
        let [from, to] = stretched.ends;
        assert_eq!(from, state.position[1]);
        assert!((to[0] - (0.105 + stretch)).abs() < 1e-12, "an image, outside the domain: {to:?}");
        assert!((stretched.middle[0] - (0.1 + 0.5 * stretch)).abs() < 1e-12 && stretched.normal == [1.0, 0.0, 0.0]);
        let expected = STIFFNESS_PER_AREA * PI * RADIUS * RADIUS * stretch;
        assert!((stretched.load.normal / expected - 1.0).abs() < 1e-9, "tension is positive");
        assert!((stretched.force[0] / expected - 1.0).abs() < 1e-9, "the first is pulled towards the second");
        assert!((stretched.stress.tensile / (STIFFNESS_PER_AREA * stretch) - 1.0).abs() < 1e-9);
        assert!(stretched.breakage_time.is_nan() && stretched.failure() == 0);
    }

    #[test]
    fn stress_is_that_of_forces_along_lever_arms() {
        let (mut state, plan) = row();
        state.position[3][0] += 2e-5;
        state.position[2][1] += 1e-5;
        // A contact beside the bonds: 3 and 4 are pressed together and no longer bonded.
        state.bonds[0].breakage = Some(Breakage { step: 0, failure: Failure::Tension, energy: 0.0 });
        state.position[0][0] += 3e-5;
        state.contacts = vec![Contact { first: 3, second: 4, displacement: [0.0; 3] }];
        let scene = scene(&state, &plan);
        let stress = scene.stress();
        let volume = 4.0 / 3.0 * PI * RADIUS * RADIUS * RADIUS;
        let pressed = state.evaluate(&plan, &state.contacts[0]).unwrap();
        let expected = pressed.force.x * (RADIUS - 0.5 * pressed.touch.overlap) / volume;
        assert!((stress[0][0] / expected - 1.0).abs() < 1e-12 && expected < 0.0, "pressure is negative");

        // Arms add up to the way between the centres, so that all spheres together have the stress of all pairs.
        let mut sum = [0.0; 4];
        for link in scene.links() {
            let [from, to] = link.ends;
            let way: [f64; 3] = std::array::from_fn(|k| to[k] - from[k]);
            let [x, y, z] = link.force;
            let terms = [way[0] * x, way[1] * y, way[2] * z, 0.5 * (way[0] * y + way[1] * x)];
            sum.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        }
        sum[0] += pressed.force.x * pressed.touch.offset.x;
        for (k, pairs) in sum.into_iter().enumerate() {
            let spheres: f64 = stress.iter().map(|stress| stress[k] * volume).sum();
            assert!((spheres - pairs).abs() < 1e-12 * sum[0].abs(), "component {k}: {spheres} and {pairs}");
        }
        assert!(sum[0] != 0.0 && sum[3] != 0.0);
    }

    #[test]
    fn a_broken_bond_is_a_crack_and_damages_its_particles() {
        let mut simulation = simulation();
        simulation.advance(400).unwrap();
        let (state, plan) = (simulation.state().unwrap(), simulation.plan().clone());
        let scene = scene(&state, &plan);
        let links = scene.links();
        let [_, broken, _] = links[..] else { panic!("{links:?}") };
        let breakage = state.bonds[1].breakage.expect("the weakest breaks");
        assert_eq!(broken.force, [0.0; 3]);
        assert_eq!((broken.load, broken.stress), (NO_LOAD, NO_STRESS));
        assert_eq!(broken.breakage_time, plan.time(breakage.step));
        assert_eq!((broken.failure(), broken.breakage_step()), (1, breakage.step.cast_signed()));
        assert!((broken.area / (PI * RADIUS * RADIUS) - 1.0).abs() < 1e-15);
        let [from, to] = broken.ends;
        assert!((broken.middle[0] - 0.5 * (from[0] + to[0])).abs() < 1e-15 && to[0] - from[0] > 2.0 * RADIUS);
        assert_eq!(scene.damage(), [0.0, 0.5, 0.5, 0.0]);
        assert_eq!(scene.bonds_that_hold(), [1, 1, 1, 1]);

        let cracks = cracks(&links, Precision::Double);
        assert_eq!(cracks.point_count(), 1);
        let energy: f64 = links.iter().map(Link::released_energy).sum();
        assert_eq!(energy, Ledger::of(&state, &plan).breakage_dissipated);
    }

    #[test]
    fn without_bonds_frames_hold_what_they_held_before() {
        let (mut state, plan) = row();
        let names = |state: &State| -> Vec<&str> {
            scene(state, &plan).blocks(Contents::default()).iter().map(|block| block.name).collect()
        };
        assert_eq!(names(&state), ["particles", "walls", "bonds", "cracks"]);
        let without = Contents { bonds: false, ..Contents::default() };
        assert_eq!(scene(&state, &plan).blocks(without).len(), 3, "cracks are few");
        state.make_bonds(Vec::new());
        assert_eq!(names(&state), ["particles", "walls"]);
        let particles = scene(&state, &plan).particles(Precision::Single);
        assert!(particles.point_fields.iter().all(|field| !["stress", "bonds", "damage"].contains(&&*field.name)));
    }

    #[test]
    fn masters_show_bonds_and_the_cracks_so_far() {
        let folder = tempfile::tempdir().unwrap();
        let mut directory = RunDirectory::create(folder.path(), "", false).unwrap();
        directory.set_contents(Contents { precision: Precision::Double, ..Contents::default() });
        let mut simulation = simulation();
        let plan = simulation.plan().clone();
        for _ in 0..3 {
            directory.frame(&simulation.state().unwrap(), &plan).unwrap();
            simulation.advance(200).unwrap();
        }
        directory.publish().unwrap();
        let breakage = simulation.state().unwrap().bonds[1].breakage.unwrap();
        assert!(breakage.step <= 200);

        let bonds = StoredFile::open(&folder.path().join("bonds.vtkhdf")).unwrap();
        assert_eq!(bonds.integers("VTKHDF/CellData/first").unwrap(), [3, 4, 7].repeat(3));
        let times = bonds.reals("VTKHDF/CellData/breakage_time").unwrap();
        let broken: Vec<bool> = times.iter().map(|time| time.is_finite()).collect();
        assert_eq!(broken, [false, false, false, false, true, false, false, true, false]);
        assert_eq!(bonds.integers("VTKHDF/Steps/PointOffsets").unwrap(), [0, 6, 12]);
        let cracks = StoredFile::open(&folder.path().join("cracks.vtkhdf")).unwrap();
        assert_eq!(cracks.integers("VTKHDF/NumberOfPoints").unwrap(), [0, 1, 1]);
        assert_eq!(cracks.reals("VTKHDF/PointData/breakage_time").unwrap(), [plan.time(breakage.step); 2]);
        assert_eq!(cracks.reals("VTKHDF/PointData/energy").unwrap(), [breakage.energy; 2]);
        assert_eq!(cracks.integers("VTKHDF/PointData/breakage_step").unwrap(), [breakage.step.cast_signed(); 2]);
        let particles = StoredFile::open(&folder.path().join("particles.vtkhdf")).unwrap();
        assert_eq!(particles.reals("VTKHDF/PointData/damage").unwrap()[4..8], [0.0, 0.5, 0.5, 0.0]);
        let (_, components) = particles.layout("VTKHDF/PointData/stress").unwrap();
        assert_eq!(components, 6);
    }
}
