//! A run looks the same however often it was interrupted.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic like tests")]

mod common;

use common::{Watcher, assert_same_results, results, run_new, run_on, schedule, simulation, state};
use std::fs;
use std::time::Duration;
use tdem_engine::cpu::Options;
use tdem_engine::physics::heat::{Conductor, Path};
use tdem_engine::{
    Exposure, Fault, HeatPlan, Ledger, Motion, Relaxation, Schedule, Scheme, Simulation, Thermal, ThermalTables,
};
use tdem_results::session::run;
use tdem_results::{Control, Note, Observer, Outcome, Progress, Row, RunDirectory, RunError, load_final_state};

#[test]
fn a_run_leaves_frames_rows_and_checkpoints_on_schedule() {
    let folder = tempfile::tempdir().unwrap();
    run_new(folder.path(), 410);
    let info = tdem_results::info(folder.path()).unwrap();
    let steps: Vec<u64> = info.frames.iter().map(|frame| frame.step).collect();
    assert_eq!(steps, [0, 50, 100, 150, 200, 250, 300, 350, 400, 410]);
    assert!(info.frames.iter().all(|frame| frame.particles == 100 && frame.time == frame.step as f64 * 1e-4));
    assert_eq!(info.history_rows, 42);
    assert_eq!(info.blocks, ["contacts", "particles", "walls"]);
    let checkpoints: Vec<u64> = info.checkpoints.iter().map(|checkpoint| checkpoint.step).collect();
    assert_eq!(checkpoints, [0, 350, 410], "the first and the last two");
    let names: Vec<String> = results(folder.path()).into_keys().collect();
    let pictures: Vec<&str> = names.iter().filter_map(|name| name.strip_prefix("pictures/speed-")).collect();
    let expected = [0, 120, 240, 360, 410].map(|step: u64| format!("{step:012}.png"));
    assert_eq!(pictures, expected, "the first, those on schedule, and the last");
    assert!(names.contains(&"walls.vtkhdf".into()) && names.contains(&"frames/000009.vtkhdf".into()));
    assert!(fs::read_to_string(folder.path().join("log.txt")).unwrap().contains("finished at step 410"));
}

#[test]
fn the_files_are_those_of_writing_one_after_the_other() {
    let (session, plain) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    run_new(session.path(), 400);
    let mut directory = RunDirectory::create(plain.path(), "# a test\n", false).unwrap();
    directory.set_contents(common::contents());
    directory.set_pictures(common::pictures());
    let mut simulation = simulation(state());
    let plan = simulation.plan().clone();
    directory.checkpoint(&simulation.state().unwrap()).unwrap();
    for step in (0..=400).step_by(10) {
        let state = simulation.state().unwrap();
        directory.row(&Row::of(&state, &plan, Ledger::of(&state, &plan))).unwrap();
        if step % 50 == 0 {
            directory.frame(&state, &plan).unwrap();
        }
        if step % 120 == 0 || step == 400 {
            directory.pictures(&state, &plan).unwrap();
        }
        if step > 0 && (step % 70 == 0 || step == 400) {
            directory.checkpoint(&state).unwrap();
        }
        simulation.advance(10).unwrap();
    }
    directory.finish().unwrap();
    directory.unify_pictures().unwrap();
    assert_same_results(session.path(), plain.path());
    for step in [0, 350, 400] {
        let [one, other] = [&session, &plain].map(|run| {
            let checkpoints = tdem_results::info(run.path()).unwrap().checkpoints;
            assert_eq!(checkpoints.len(), 3);
            fs::read(&checkpoints.iter().find(|checkpoint| checkpoint.step == step).unwrap().path).unwrap()
        });
        assert!(one == other, "the checkpoint of step {step} differs");
    }
}

#[test]
fn a_colour_is_the_same_value_in_all_pictures_of_a_series() {
    let folder = tempfile::tempdir().unwrap();
    run_new(folder.path(), 400);
    let ranges = |series: &str| -> Vec<[f64; 2]> {
        let names = results(folder.path()).into_iter().filter(|(name, _)| name.contains(series));
        let told = |bytes: Vec<u8>, key: &str| {
            let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
            let chunk = reader.info().uncompressed_latin1_text.iter().find(|chunk| chunk.keyword == key);
            chunk.unwrap().text.parse().unwrap()
        };
        names.map(|(_, bytes)| [told(bytes.clone(), "low"), told(bytes, "high")]).collect()
    };
    for series in ["pictures/speed-", "pictures/cut-"] {
        let ranges = ranges(series);
        assert!(ranges.len() > 3 && ranges.iter().all(|range| *range == ranges[0]), "{series}: {ranges:?}");
    }
    // The range is that of the whole series: no row of the history is faster than its fastest picture was at its step.
    let fastest = ranges("pictures/speed-")[0][1];
    let speeds = fs::read_to_string(folder.path().join("history.csv")).unwrap();
    let column = speeds.lines().next().unwrap().split(',').position(|name| name == "largest_speed").unwrap();
    let of_steps = speeds
        .lines()
        .skip(1)
        .filter(|line| ["0", "120", "240", "360", "400"].contains(&line.split(',').next().unwrap()));
    let most = of_steps.map(|line| line.split(',').nth(column).unwrap().parse::<f64>().unwrap()).fold(0.0, f64::max);
    assert!((fastest - most).abs() < 1e-12 * most, "{fastest} {most}");
}

#[test]
fn a_run_that_was_interrupted_and_resumed_is_the_same_to_the_last_byte() {
    let (straight, broken) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    run_new(straight.path(), 400);
    let mut directory = RunDirectory::create(broken.path(), "", false).unwrap();
    directory.set_contents(common::contents());
    directory.set_pictures(common::pictures());
    let mut watcher = Stopper { after: 23 };
    let outcome = run(simulation(state()), &mut directory, &schedule(400), &mut watcher).unwrap();
    drop(directory);
    let Outcome::Interrupted { step } = outcome else { panic!("it was to stop") };
    assert_eq!(load_final_state(broken.path()).unwrap().state.step, step);
    run_on(broken.path(), 400);
    assert_same_results(straight.path(), broken.path());
    let hashes = [&straight, &broken].map(|run| load_final_state(run.path()).unwrap().state.hash());
    assert_eq!(hashes[0], hashes[1]);
}

#[test]
fn the_log_says_where_heat_went_on_before_particles_were_at_rest() {
    let (mut state, mut plan) = common::bonded();
    let count = state.len();
    state.velocity.fill([0.0; 3]);
    (state.temperature, state.heat_rate, state.exposure) = (vec![300.0; count], vec![0.0; count], vec![0; count]);
    plan.walls.iter_mut().for_each(|wall| wall.velocity = [0.0; 3]);
    let relaxation =
        Relaxation { scheme: Scheme::Implicit, dt: plan.dt, ratio: 1e-9, at_most_steps: 10, check_every: 10 };
    plan.dt = 60.0;
    plan.heat = Some(HeatPlan {
        dissipation: tdem_engine::physics::heat::Dissipation::default(),
        time_scale: 1.0,
        reference_temperature: 300.0,
        materials: vec![Thermal { specific_heat: 900.0, expansion: 0.0 }],
        conductors: vec![Conductor { conductivity: 1.5, section: 0.35 }],
        tables: ThermalTables::default(),
        contacts: Path::Bar,
        exposures: vec![Exposure::default()],
        sides: Vec::new(),
        walls: vec![None; plan.walls.len()],
        motion: Motion::QuasiStatic(relaxation),
    });
    let folder = tempfile::tempdir().unwrap();
    let mut directory = RunDirectory::create(folder.path(), "# a test\n", false).unwrap();
    directory.set_contents(common::contents());
    let simulation = Simulation::new(state, plan, Options::default()).unwrap();
    let mut watcher = Watcher::default();
    run(simulation, &mut directory, &Schedule { steps: 4, ..schedule(4) }, &mut watcher).unwrap();
    let turns = watcher.seen.last().and_then(|progress| progress.turns).unwrap();
    assert_eq!((turns.unrelaxed, turns.last_unrelaxed, turns.motion_steps), (4, 4, 40));
    let log = fs::read_to_string(folder.path().join("log.txt")).unwrap();
    assert!(log.contains("particles were not at rest behind 4 steps of the heat, the last of them step 4"), "{log}");
    // Time is that of the heat.
    let frames = tdem_results::info(folder.path()).unwrap().frames;
    assert_eq!(frames.last().map(|frame| (frame.step, frame.time)), Some((4, 240.0)));
}

/// Stops as soon as so many steps are done; the notes come at every frame, so it stops long before the end.
struct Stopper {
    after: u64,
}
impl Observer for Stopper {
    fn progress(&mut self, progress: &Progress) -> Control {
        if progress.step >= self.after { Control::Stop } else { Control::Continue }
    }
    fn note(&mut self, note: &Note) {
        // Slow enough that the observer is asked again before the run is over.
        if matches!(note, Note::Frame { .. }) {
            std::thread::sleep(Duration::from_millis(160));
        }
    }
}

#[test]
fn a_run_that_goes_on_after_its_end_looks_as_if_it_had_never_ended() {
    let (straight, extended) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    run_new(straight.path(), 300);
    run_new(extended.path(), 133);
    run_on(extended.path(), 300);
    assert_same_results(straight.path(), extended.path());
}

#[test]
fn resuming_a_finished_run_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    run_new(folder.path(), 133);
    let before = results(folder.path());
    run_on(folder.path(), 133);
    assert!(before == results(folder.path()));
}

#[test]
fn what_came_after_the_checkpoint_is_computed_again() {
    let (straight, broken) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    run_new(straight.path(), 400);
    run_new(broken.path(), 400);
    for checkpoint in tdem_results::info(broken.path()).unwrap().checkpoints {
        if checkpoint.step > 0 {
            fs::remove_file(checkpoint.path).unwrap();
        }
    }
    let resumed = RunDirectory::open(broken.path()).unwrap();
    assert_eq!(resumed.state.as_ref().map(|state| state.step), Some(0));
    assert_eq!((resumed.directory.last_frame(), resumed.directory.last_row()), (Some(0), Some(0)));
    drop(resumed);
    run_on(broken.path(), 400);
    assert_same_results(straight.path(), broken.path());
}

#[test]
fn a_fault_names_the_last_good_checkpoint_and_keeps_the_results() {
    let folder = tempfile::tempdir().unwrap();
    let mut directory = RunDirectory::create(folder.path(), "", false).unwrap();
    let mut state = state();
    state.velocity[7] = [0.0, 0.0, 100.0];
    let error = run(simulation(state), &mut directory, &schedule(100_000), &mut Watcher::default()).unwrap_err();
    drop(directory);
    let RunError::Fault { checkpoint, path, .. } = &error else { panic!("{error}") };
    assert_eq!(path, folder.path());
    assert_eq!(load_final_state(folder.path()).unwrap().state.step, *checkpoint);
    assert!(error.to_string().contains("the last good checkpoint is of step"));
    assert!(tdem_results::info(folder.path()).unwrap().frames.len() as u64 > checkpoint / 50);
    let history = fs::read_to_string(folder.path().join("history.csv")).unwrap();
    let last: u64 = history.lines().last().unwrap().split(',').next().unwrap().parse().unwrap();
    assert!(last >= *checkpoint && history.lines().count() as u64 == last / 10 + 2, "no row is missing");
    assert!(fs::read_to_string(folder.path().join("log.txt")).unwrap().lines().count() >= 2);
}

#[test]
fn an_infinite_energy_is_a_fault_and_no_row() {
    let folder = tempfile::tempdir().unwrap();
    let mut directory = RunDirectory::create(folder.path(), "", false).unwrap();
    let mut state = state();
    state.angular_velocity[3] = [0.0, 1e200, 0.0];
    let error = run(simulation(state), &mut directory, &schedule(100), &mut Watcher::default()).unwrap_err();
    drop(directory);
    let RunError::Fault { fault: Fault::Unbounded { quantity, value, .. }, .. } = &error else { panic!("{error}") };
    assert_eq!((*quantity, *value), ("kinetic_rotation", f64::INFINITY));
    assert!(error.to_string().contains("`kinetic_rotation` is inf J at step 0"), "{error}");
    assert_eq!(fs::read_to_string(folder.path().join("history.csv")).unwrap().lines().count(), 1);
}

#[test]
fn the_observer_is_asked_several_times_a_second_and_sees_the_pace() {
    let folder = tempfile::tempdir().unwrap();
    let mut directory = RunDirectory::create(folder.path(), "", false).unwrap();
    let schedule = Schedule { steps: u64::MAX, checkpoint_interval_secs: 0.3, ..Schedule::default() };
    let mut watcher = Impatient { began: std::time::Instant::now(), seen: Vec::new(), checkpoints: 0 };
    let outcome = run(simulation(state()), &mut directory, &schedule, &mut watcher).unwrap();
    let Outcome::Interrupted { step } = outcome else { panic!("it was to stop") };
    assert_eq!(directory.last_checkpoint(), Some(step));
    assert!(watcher.seen.len() >= 3, "{}", watcher.seen.len());
    assert!(watcher.checkpoints >= 3, "by the clock, and at the end");
    let last = watcher.seen.last().unwrap();
    assert!(last.cundall_number > 0.0 && last.time_left.is_some());
}

struct Impatient {
    began: std::time::Instant,
    seen: Vec<Progress>,
    checkpoints: usize,
}
impl Observer for Impatient {
    fn progress(&mut self, progress: &Progress) -> Control {
        self.seen.push(*progress);
        // On a busy machine it takes longer; a run that is never asked, or never writes by the clock, ends all the same.
        let enough = self.seen.len() >= 3 && self.checkpoints >= 2;
        if enough || self.began.elapsed() > Duration::from_mins(1) { Control::Stop } else { Control::Continue }
    }
    fn note(&mut self, note: &Note) {
        self.checkpoints += usize::from(matches!(note, Note::Checkpoint { .. }));
    }
}
