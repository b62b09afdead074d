//! Rungs of a small block that is heated from above: what differs shrinks with the acceleration.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;
use tdem_case::{Loaded, NoRuns, parse};
use tdem_engine::{Fault, Plan, Simulation, State, cpu};
use tdem_studies::ladder::{
    Earlier, Error, Follower, Halt, Halved, Ladder, Pair, Rung, climb, folder_of, prepare, rungs, step_seconds,
};

/// 108 spheres on a lattice; the lowest layer is held, and the top follows a course.
const BLOCK: &str = r#"
model = "TBPM"
gravity = [0.0, 0.0, 0.0]
[time]
step = "auto"
end = 2e-3
[domain]
min = [-0.05, -0.05, -0.05]
max = [0.15, 0.15, 0.15]
[material.concrete]
density = 3038.57
young_modulus = 23.2e9
poisson_ratio = 0.2
thermal_conductivity = 1.5
specific_heat = 900.0
thermal_expansion = 6.6e-6
[[interaction]]
between = ["concrete", "concrete"]
static_friction = 0.6
dynamic_friction = 0.6
normal_damping = 1500.0
tangential_damping = 150.0
[heat]
scale = "celsius"
initial_temperature = 20.0
contacts = "circle"
bar_radius = "fcc"
duration = 1000.0
[bonds]
local_damping = 0.5
[[bond]]
between = ["concrete", "concrete"]
damping_ratio = 0.05
moment_contribution = 0.0
[bond.lattice]
young_modulus = 23.2e9
poisson_ratio = 0.2
tensile_strength = 1e12
shear_factor = 3.0
[[particles]]
name = "block"
material = "concrete"
lattice = { kind = "fcc", radius = 6.4e-3, cells = [3, 3, 3], origin = [0.0, 0.0, 0.0] }
[[zone]]
name = "foot"
box = { min = [-1.0, -1.0, -0.001], max = [1.0, 1.0, 0.001] }
fixed = ["x", "y", "z"]
[[surface]]
name = "top"
face = "+z"
temperature = [[0.0, 20.0], [500.0, 320.0]]
"#;

fn case_of(text: &str, set: &[(&str, &str)]) -> Loaded {
    let set: Vec<(String, String)> = set.iter().map(|(key, value)| ((*key).into(), (*value).into())).collect();
    parse("block.toml", text, Path::new("."), &set).unwrap_or_else(|problems| panic!("{problems}"))
}

fn start(state: State, plan: Plan) -> Result<Simulation, Fault> {
    Simulation::new(state, plan, cpu::Options { threads: Some(1), ..cpu::Options::default() })
}

fn ladder(set: &[(&str, &str)], parts: u32) -> Ladder {
    let rungs = rungs(&case_of(BLOCK, set), 3, &NoRuns).expect("the case has a ladder");
    climb(rungs, parts, None, start, &mut |_| ControlFlow::Continue(())).expect("nothing goes wrong")
}

fn refusal(text: &str, count: u32) -> Error {
    rungs(&case_of(text, &[]), count, &NoRuns).expect_err("such a case has no ladder")
}

#[test]
fn without_cracks_what_differs_shrinks() {
    let ladder = ladder(&[], 4);
    let [before, after] = &ladder.pairs[..] else { panic!("three rungs are two pairs") };
    let times: Vec<f64> = after.differences.iter().map(|found| found.heat_time).collect();
    assert!(times.len() == 4 && times.is_sorted() && (times[3] - 1000.0).abs() < 1.0, "{times:?}");
    for (instant, found) in after.differences.iter().enumerate() {
        // Euler's rule with half the step.
        let order = after.order(before, instant, |found| found.temperature.rms).expect("temperatures differ");
        assert!((order - 1.0).abs() < 0.1, "order {order} at {} s", found.heat_time);
        assert_eq!((found.broken, found.broken_in_one), ([0, 0], 0));
        assert!(found.stress_size > 0.0 && found.stress.rms < 0.1 * found.stress_size, "{found:?}");
    }
    let worst = |pair: &Pair| pair.worst(|found| found.stress.rms).map_or(0.0, |found| found.stress.rms);
    assert!(worst(after) < 0.8 * worst(before), "{} {}", worst(after), worst(before));
    assert_eq!(after.parted(), None);
}

#[test]
fn a_rung_is_a_run_of_the_case() {
    // As weak as this, bonds near the foot break.
    let weak = [("bond.0.lattice.tensile_strength", "2e6")];
    let ladder = ladder(&weak, 3);
    let halved = [5e5, 2.5e5, 1.25e5];
    assert_eq!(ladder.rungs.iter().map(|rung| rung.time_scale).collect::<Vec<f64>>(), halved);
    let [first, second, _] = &ladder.rungs[..] else { panic!("there are three rungs") };
    assert_eq!((second.step_seconds, second.steps), (first.step_seconds, 2 * first.steps));
    let built = case_of(BLOCK, &weak).build().expect("the case can be built");
    let mut simulation = start(built.state, built.plan).expect("the case starts");
    simulation.advance(built.schedule.steps).expect("the case runs");
    let state = simulation.state().expect("the processor does not fail");
    let broken = state.bonds.iter().filter(|bond| !bond.holds()).count() as u64;
    assert_eq!((first.hash, first.broken_bonds), (Some(state.hash()), broken));
    let [pair, _] = &ladder.pairs[..] else { panic!("three rungs are two pairs") };
    let last = pair.differences.last().expect("there are instants");
    assert!(broken > 0, "bonds break");
    assert_eq!(last.broken, [broken, second.broken_bonds]);
    assert!(last.broken_in_one >= broken.abs_diff(second.broken_bonds));
}

#[test]
fn a_time_scale_is_halved_where_a_duration_is_spread() {
    let scaled = BLOCK.replace("duration = 1000.0", "time_scale = 5e5");
    let [by_duration, by_scale] = [BLOCK, &scaled].map(|text| {
        let rungs = rungs(&case_of(text, &[]), 3, &NoRuns).expect("the case has a ladder");
        rungs.iter().map(|rung| (rung.time_scale(), rung.built.plan.dt, rung.built.schedule.steps)).collect::<Vec<_>>()
    });
    assert_eq!(by_duration, by_scale);
}

/// The block with heat that advances by itself, 200 s of it in steps of 50 s.
fn by_itself(motion: &str) -> Ladder {
    let heat = format!("motion = \"{motion}\"\nstep = 50.0");
    let text = BLOCK.replace("duration = 1000.0", &heat).replace("end = 2e-3", "end = 200.0");
    let rungs = rungs(&case_of(&text, &[]), 3, &NoRuns).expect("the case has a ladder");
    assert_eq!(rungs.iter().map(Rung::value).collect::<Vec<f64>>(), [50.0, 25.0, 12.5]);
    climb(rungs, 4, None, start, &mut |_| ControlFlow::Continue(())).expect("nothing goes wrong")
}

#[test]
fn heat_by_itself_goes_in_shorter_steps() {
    for motion in ["frozen", "quasi-static"] {
        let ladder = by_itself(motion);
        assert_eq!(ladder.halved, Halved::HeatStep);
        assert_eq!(ladder.rungs.iter().map(|rung| rung.label.as_str()).collect::<Vec<_>>(), ["h", "h/2", "h/4"]);
        assert_eq!(ladder.rungs.iter().map(|rung| rung.steps).collect::<Vec<u64>>(), [4, 8, 16]);
        let [before, after] = &ladder.pairs[..] else { panic!("three rungs are two pairs") };
        let times: Vec<f64> = after.differences.iter().map(|found| found.heat_time).collect();
        assert_eq!(times, [50.0, 100.0, 150.0, 200.0]);
        // The backward rule of Euler, in steps as long as heat needs from layer to layer.
        let order = after.order(before, 3, |found| found.temperature.rms).expect("temperatures differ");
        assert!((0.7..1.2).contains(&order), "{motion}: {order}");
        let stress = after.differences[3].stress_size;
        // Nothing but rounding, or some kelvins between the foot and the top.
        assert!(if motion == "frozen" { stress < 1e-3 } else { stress > 1e3 }, "{motion}: {stress}");
    }
}

#[test]
fn a_ladder_that_is_ended_keeps_the_rungs_that_are_complete() {
    let complete = ladder(&[], 4);
    let rungs = rungs(&case_of(BLOCK, &[]), 3, &NoRuns).expect("the case has a ladder");
    let ended = climb(rungs, 4, None, start, &mut |progress| match progress.rung {
        2 => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    });
    let ended = ended.expect("nothing goes wrong");
    assert_eq!(ended.rungs.len(), 2);
    assert_eq!(ended.pairs[..], complete.pairs[..1]);
}

/// What does not depend on the clock.
fn timeless(mut ladder: Ladder) -> Ladder {
    ladder.rungs.iter_mut().for_each(|rung| rung.clock_secs = 0.0);
    ladder
}

#[test]
fn a_ladder_that_was_stopped_goes_on_to_the_same_bits() {
    // As weak as this, bonds near the foot break.
    let weak = [("bond.0.lattice.tensile_strength", "2e6")];
    let whole = timeless(ladder(&weak, 4));
    let here = tempfile::tempdir().expect("there is room for temporary files");
    let of = || rungs(&case_of(BLOCK, &weak), 3, &NoRuns).expect("the case has a ladder");
    let mut seen = Vec::new();
    let mut go = |rungs: Vec<Rung>, earlier: Earlier, parts: u32, until: f64| {
        seen.clear();
        let there = prepare(here.path(), &rungs, earlier).expect("the folders are free, or of this ladder");
        let ended = climb(rungs, parts, Some(here.path()), start, &mut |progress| {
            seen.push(progress.rung);
            let stop = progress.rung == 1 && progress.heat_time > until;
            if stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        (there, ended.expect("nothing goes wrong"), seen.clone())
    };
    // Behind the second of four instants of the second rung.
    let (there, stopped, _) = go(of(), Earlier::Refuse, 4, 510.0);
    assert_eq!(there, [0, 0, 0]);
    assert_eq!(stopped.rungs.iter().map(|rung| rung.complete).collect::<Vec<_>>(), [true, false]);
    let [pair] = &stopped.pairs[..] else { panic!("two rungs are a pair") };
    assert_eq!(pair.differences[..], whole.pairs[0].differences[..pair.differences.len()]);
    assert!((2..4).contains(&pair.differences.len()));

    let (there, ended, seen) = go(of(), Earlier::GoOn, 4, f64::INFINITY);
    assert!(there[0] == whole.rungs[0].steps && there[1] > whole.rungs[1].steps / 2 && there[2] == 0, "{there:?}");
    assert_eq!(timeless(ended), whole);
    assert!(seen.iter().all(|&rung| rung > 0), "the first rung is only read");
    // All is there, also for fewer instants.
    let (_, again, seen) = go(of(), Earlier::GoOn, 2, f64::INFINITY);
    assert!(seen.is_empty() && again.pairs[1].differences[..] == [1, 3].map(|k| whole.pairs[1].differences[k].clone()));

    // What is compared of an instant is lost: its rung begins anew, and the others are read.
    let instants = folder_of(here.path(), 2).join("instants");
    let first = std::fs::read_dir(&instants).expect("there are instants").next().expect("there are some");
    std::fs::remove_file(first.expect("it has a name").path()).expect("it can be removed");
    let (_, again, seen) = go(of(), Earlier::GoOn, 4, f64::INFINITY);
    assert_eq!(timeless(again), whole);
    assert!(!seen.is_empty() && seen.iter().all(|&rung| rung == 2), "{seen:?}");

    let other = rungs(&case_of(BLOCK, &[]), 3, &NoRuns).expect("the case has a ladder");
    assert!(matches!(prepare(here.path(), &other, Earlier::GoOn), Err(Halt::OtherCase { label, .. }) if label == "S"));
    assert!(prepare(here.path(), &other, Earlier::Refuse).is_err());
    assert_eq!(prepare(here.path(), &other, Earlier::Remove).expect("an old ladder may go"), [0, 0, 0]);
}

#[test]
fn a_fault_ends_a_ladder_with_what_there_is() {
    // A grain leaves the domain when the second rung is at three quarters.
    let grain = "[[particles]]\nmaterial = \"concrete\"\nlist = { radius = 0.006, positions = [[0.1, 0.1, 0.02]] }\n\
                 velocity = [10.5, 0.0, 0.0]\n";
    let text = BLOCK.replace("[[zone]]", &format!("{grain}[[zone]]")).replace("end = 2e-3", "end = 3e-3");
    let rungs = rungs(&case_of(&text, &[]), 3, &NoRuns).expect("the case has a ladder");
    let ladder = climb(rungs, 4, None, start, &mut |_| ControlFlow::Continue(())).expect("there is something to show");
    let failure = ladder.failure.expect("the second rung fails");
    assert_eq!(failure.label, "S/2");
    assert!(failure.fault.to_string().contains("left the domain"), "{}", failure.fault);
    let [first, second] = &ladder.rungs[..] else { panic!("two rungs came to an instant") };
    assert!(first.complete && !second.complete && second.heat_time == ladder.pairs[0].differences[2].heat_time);
    assert_eq!((ladder.pairs.len(), ladder.pairs[0].differences.len()), (1, 3));
}

#[test]
fn a_case_without_acceleration_is_refused() {
    let starter = tdem_case::starter(tdem_case::Starter::Packing, "cold");
    assert_eq!(refusal(&starter, 3), Error::NoHeat);
    let natural = BLOCK.replace("duration = 1000.0\n", "");
    assert_eq!(refusal(&natural, 3), Error::NotAccelerated { time_scale: 1.0 });
    let hurried = BLOCK.replace("duration = 1000.0", "time_scale = 3.0");
    assert_eq!(refusal(&hurried, 3), Error::TooManyRungs { rungs: 3, lowest: 0.75 });
    assert_eq!(rungs(&case_of(&hurried, &[]), 2, &NoRuns).map(|rungs| rungs.len()), Ok(2));
}

#[test]
fn what_goes_by_the_clock_of_the_motion_is_refused() {
    let foot = "fixed = [\"x\", \"y\", \"z\"]";
    let driven = |x: &str| refusal(&BLOCK.replace(foot, &format!("prescribed = {{ x = {x}, y = 0.0, z = 0.0 }}")), 2);
    assert_eq!(driven("0.1"), Error::FollowsMotion { what: Follower::Motion });
    assert_eq!(driven("[[0.0, 0.0], [1e-3, 0.1]]"), Error::FollowsMotion { what: Follower::Course });
    let wall = "[[wall]]\nname = \"press\"\npoint = [0.0, 0.0, 0.12]\nnormal = [0.0, 0.0, -1.0]\n\
                velocity = [0.0, 0.0, -0.1]\nmaterial = \"concrete\"\n";
    let pressed = refusal(&format!("{BLOCK}{wall}"), 2);
    assert_eq!(pressed, Error::FollowsMotion { what: Follower::Wall("press".to_owned()) });
    // What is prescribed to stay is no motion.
    let still = BLOCK.replace(foot, "prescribed = { x = 0.0, y = 0.0, z = 0.0 }");
    assert!(rungs(&case_of(&still, &[]), 2, &NoRuns).is_ok());
}

#[test]
fn rungs_of_two_cases_are_not_compared() {
    let two = |cells: &str| {
        let set = [("particles.0.lattice.cells", cells)];
        rungs(&case_of(BLOCK, &set), 2, &NoRuns).expect("the case has a ladder")
    };
    let mixed = [two("[3, 3, 3]"), two("[3, 3, 2]")].map(|rungs| rungs.into_iter().next().expect("there are two"));
    let halt = climb(mixed.into(), 2, None, start, &mut |_| ControlFlow::Continue(()));
    assert!(matches!(halt, Err(Halt::Different)), "{halt:?}");
}

#[test]
fn how_it_goes_is_told_from_the_first_step_to_the_last() {
    let rungs = rungs(&case_of(BLOCK, &[]), 2, &NoRuns).expect("the case has a ladder");
    assert!(step_seconds(&rungs[0], Duration::from_millis(20), start).expect("steps can be taken") > 0.0);
    let mut seen: Vec<(usize, u64, u64)> = Vec::new();
    climb(rungs, 2, None, start, &mut |progress| {
        seen.push((progress.rung, progress.done, progress.steps));
        ControlFlow::Continue(())
    })
    .expect("nothing goes wrong");
    assert!(seen.is_sorted() && seen.first().is_some_and(|first| first.0 == 0), "{seen:?}");
    assert!(seen.last().is_some_and(|&(rung, done, steps)| rung == 1 && done == steps), "{seen:?}");
}
