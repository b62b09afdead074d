//! A small run that every test can afford: spheres that fall into a box which repeats in x, under a moving lid.

#![allow(dead_code, reason = "each test uses its share")]
#![allow(clippy::unwrap_used, reason = "the sample run uses this too, and may panic like a test")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use tdem_engine::physics::bond::{self, Cement, Damping, Form, Joint};
use tdem_engine::physics::contact::{Friction, Interaction, Law};
use tdem_engine::{
    Bond, BondPlan, BondTables, Constraint, Domain, Integrator, Plan, Schedule, Search, Simulation, State, Wall, cpu,
};
use tdem_results::picture::{Clip, Colour, Options, Series};
use tdem_results::{Control, Note, Observer, Progress, RunDirectory};

pub(crate) const RADIUS: f64 = 0.05;

pub(crate) fn plan() -> Plan {
    let wall = |name: &str, normal, velocity| Wall { name: name.into(), normal, velocity, material: 0 };
    Plan {
        dt: 1e-4,
        integrator: Integrator::VelocityVerlet,
        law: Law { friction: Friction::Rescaled, ..Law::GNTM },
        materials: 1,
        interactions: vec![Interaction {
            normal_stiffness: 1e7,
            tangential_stiffness: 1e7,
            normal_damping: 200.0,
            tangential_damping: 50.0,
            static_friction: 0.5,
            dynamic_friction: 0.4,
            least_normal_force: 0.0,
        }],
        bonds: None,
        heat: None,
        walls: vec![
            wall("floor", [0.0, 0.0, 1.0], [0.0; 3]),
            wall("front", [0.0, 1.0, 0.0], [0.0; 3]),
            wall("back", [0.0, -1.0, 0.0], [0.0; 3]),
            wall("lid", [0.0, 0.0, -1.0], [0.0, 0.0, -0.1]),
        ],
        gravity: [0.0, 0.0, -9.81],
        constraints: vec![Constraint::FREE],
        ramps: Vec::new(),
        gauges: Vec::new(),
        domain: Domain { min: [0.0; 3], max: [0.6, 0.5, 0.8], periodic: [true, false, false] },
        search: Search { skin: 0.01, every_step: false },
        overlap_limit: 0.5,
        ledger: true,
    }
}

pub(crate) fn state() -> State {
    let mut state = State::default();
    for k in 0..5 {
        for j in 0..4 {
            for i in 0..5 {
                let id = state.id.len() as u32;
                state.id.push(id);
                state.position.push([
                    0.119 * f64::from(i) + 0.01 * f64::from(k) + 1e-3,
                    0.07 + 0.115 * f64::from(j) + 0.003 * f64::from(i),
                    0.06 + 0.125 * f64::from(k),
                ]);
                state.velocity.push([0.4 - 0.1 * f64::from(j), 0.05 * f64::from(i), -0.2 * f64::from(k)]);
            }
        }
    }
    let count = state.id.len();
    state.material = vec![0; count];
    state.constraint = vec![0; count];
    state.radius = (0..count).map(|index| RADIUS * (1.0 - 0.2 * (index % 3) as f64)).collect();
    state.mass = state.radius.iter().map(|radius| 1e4 * radius * radius * radius).collect();
    state.image = vec![[0; 3]; count];
    state.angular_velocity = vec![[0.0, -0.0, 1.0]; count];
    state.force = vec![[0.0; 3]; count];
    state.moment = vec![[0.0; 3]; count];
    state.accounts = vec![[0.0; 4]; count];
    state.wall_position = vec![[0.0; 3], [0.0; 3], [0.0, 0.5, 0.0], [0.0, 0.0, 0.8]];
    state
}

pub(crate) fn simulation(state: State) -> Simulation {
    let options = cpu::Options { threads: Some(1), ..cpu::Options::default() };
    Simulation::new(state, plan(), options).unwrap()
}

pub(crate) fn schedule(steps: u64) -> Schedule {
    Schedule {
        steps,
        frame_every: 50,
        history_every: 10,
        picture_every: 120,
        checkpoint_every: Some(70),
        ..Schedule::default()
    }
}

/// Stops at a step, or never.
#[derive(Default)]
pub(crate) struct Watcher {
    pub(crate) stop_at: Option<u64>,
    pub(crate) seen: Vec<Progress>,
    pub(crate) notes: Vec<Note>,
}

impl Observer for Watcher {
    fn progress(&mut self, progress: &Progress) -> Control {
        self.seen.push(*progress);
        if self.stop_at.is_some_and(|step| progress.step >= step) { Control::Stop } else { Control::Continue }
    }
    fn note(&mut self, note: &Note) {
        self.notes.push(*note);
    }
}

/// A bonded block that falls on the floor of the same box and breaks there.
pub(crate) fn bonded() -> (State, Plan) {
    let cement = Cement {
        stiffness_ratio: 0.4,
        radius_multiplier: 1.0,
        tensile_strength: 5e4,
        shear_strength: 5e4,
        internal_friction: 0.3,
        moment_contribution: 1.0,
        damping_ratio: 0.05,
    };
    let bonds = BondPlan {
        law: bond::Law { form: Form::Total, damping: Damping::Viscous },
        joints: vec![Some(Joint { cement, stiffness_per_area: 2e7, young_modulus: 0.0 })],
        tables: BondTables::default(),
        contact_in_bonded_pairs: false,
        local_damping: 0.0,
    };
    let (radius, cells) = (0.8 * RADIUS, [4, 3, 3]);
    let mut state = state();
    state.position = Vec::new();
    for k in 0..cells[0] * cells[1] * cells[2] {
        let place = [k % cells[0], k / cells[0] % cells[1], k / (cells[0] * cells[1])];
        // Through the face that repeats, in front of the others.
        let first = [0.42, 0.1, 1.2 * radius];
        let [x, y, z] = std::array::from_fn(|d| first[d] + 2.0 * radius * f64::from(place[d]));
        state.position.push([if x < 0.6 { x } else { x - 0.6 }, y, z]);
    }
    let count = state.position.len();
    state.id.truncate(count);
    state.material.truncate(count);
    state.constraint.truncate(count);
    state.image.truncate(count);
    state.angular_velocity.truncate(count);
    state.force.truncate(count);
    state.moment.truncate(count);
    state.accounts.truncate(count);
    state.radius = vec![radius; count];
    state.mass = vec![0.64; count];
    state.velocity = vec![[0.5, 0.0, -3.0]; count];
    let plan = Plan { bonds: Some(bonds), ..plan() };
    let period = plan.domain.period();
    let place = |index: u32| tdem_engine::physics::Vec3::from(state.position[index as usize]);
    let near = |&(i, j): &(u32, u32)| {
        let offset = period.nearest(place(j) - place(i));
        offset.dot(offset).sqrt() < 2.01 * radius
    };
    let pairs = (0..count as u32).flat_map(|i| (i + 1..count as u32).map(move |j| (i, j)));
    let bonds = pairs.filter(near).map(|(i, j)| Bond::new(i, j, 1.0)).collect();
    state.make_bonds(bonds);
    (state, plan)
}

/// Begins a run and runs it to a step.
pub(crate) fn run_new(path: &Path, steps: u64) {
    let mut directory = RunDirectory::create(path, "# a test\n", false).unwrap();
    directory.set_contents(contents());
    directory.set_pictures(pictures());
    tdem_results::session::run(simulation(state()), &mut directory, &schedule(steps), &mut Watcher::default()).unwrap();
}

/// Goes on with a run to a step.
pub(crate) fn run_on(path: &Path, steps: u64) {
    let resumed = RunDirectory::open(path).unwrap();
    let mut directory = resumed.directory;
    directory.set_contents(contents());
    directory.set_pictures(pictures());
    let simulation = simulation(resumed.state.unwrap_or_else(state));
    tdem_results::session::run(simulation, &mut directory, &schedule(steps), &mut Watcher::default()).unwrap();
}

pub(crate) fn contents() -> tdem_results::Contents {
    tdem_results::Contents { contacts: true, ..tdem_results::Contents::default() }
}

/// Two small series of pictures.
pub(crate) fn pictures() -> Vec<Series> {
    let options = Options { width: 48, height: 36, ..Options::default() };
    let cut = Some(Clip { point: [0.3, 0.2, 0.0], normal: [0.0, -1.0, 0.0] });
    vec![
        Series { name: "speed".into(), options },
        Series { name: "cut".into(), options: Options { clip: cut, colour: Colour::Height, ..options } },
    ]
}

/// All files that must not depend on interruptions, by name.
pub(crate) fn results(run: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for (folder, ending) in [("", "vtkhdf"), ("", "csv"), ("frames", "vtkhdf"), ("pictures", "png")] {
        for entry in fs::read_dir(run.join(folder)).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|found| found == ending) {
                files.insert(path.strip_prefix(run).unwrap().display().to_string(), fs::read(&path).unwrap());
            }
        }
    }
    files
}

/// Copies the folder of a run over another.
pub(crate) fn copy(from: &Path, to: &Path) {
    let _ = fs::remove_dir_all(to);
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), &target).unwrap();
        }
    }
}

pub(crate) fn assert_same_results(one: &Path, other: &Path) {
    let (one, other) = (results(one), results(other));
    assert_eq!(one.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>());
    for (name, bytes) in &one {
        assert!(*bytes == other[name], "{name} differs");
    }
}
