//! What the writer and the simulation owe each other.

use super::*;
use crate::error::Error;
use crate::history::Row;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::{ThreadId, current};
use tdem_engine::physics::contact::{Interaction, Law};
use tdem_engine::{Constraint, Domain, Integrator, Plan, Search, State, cpu};

/// A sphere that rests for ever, or one on its way out of the domain, which it leaves after 100 000 steps.
fn sphere(leaves: bool) -> Simulation {
    let interaction = Interaction {
        normal_stiffness: 1e6,
        tangential_stiffness: 1e6,
        normal_damping: 0.0,
        tangential_damping: 0.0,
        static_friction: 0.5,
        dynamic_friction: 0.5,
        least_normal_force: 0.0,
    };
    let plan = Plan {
        dt: 1e-3,
        integrator: Integrator::VelocityVerlet,
        law: Law::GNTM,
        materials: 1,
        interactions: vec![interaction],
        bonds: None,
        heat: None,
        walls: Vec::new(),
        gravity: [0.0; 3],
        constraints: vec![Constraint::FREE],
        ramps: Vec::new(),
        gauges: Vec::new(),
        domain: Domain { min: [0.0; 3], max: [101.0; 3], periodic: [false; 3] },
        search: Search { skin: 10.0, every_step: false },
        overlap_limit: 0.5,
        ledger: false,
    };
    let state = State {
        id: vec![0],
        material: vec![0],
        constraint: vec![0],
        radius: vec![0.1],
        mass: vec![1.0],
        position: vec![[1.0; 3]],
        image: vec![[0; 3]],
        velocity: vec![[f64::from(u8::from(leaves)), 0.0, 0.0]],
        angular_velocity: vec![[0.0; 3]],
        force: vec![[0.0; 3]],
        moment: vec![[0.0; 3]],
        ..State::default()
    };
    let options = cpu::Options { threads: Some(1), ..cpu::Options::default() };
    Simulation::new(state, plan, options).unwrap()
}

/// Notes what is written, and may be held up or fail there.
#[derive(Default)]
struct Notebook {
    lines: Arc<Mutex<Vec<String>>>,
    /// Tells that a frame is being written, and waits for leave.
    gate: Option<(Sender<()>, Receiver<()>)>,
    /// Step of the row that no longer finds space.
    full_at: Option<u64>,
    checkpoints: u64,
}

impl Notebook {
    fn add(&self, line: String) {
        self.lines.lock().unwrap().push(line);
    }
}

impl Sink for Notebook {
    fn row(&mut self, row: &Row) -> Result<(), Error> {
        if self.full_at == Some(row.step) {
            return Err(Error::DiskFull { path: "history.csv".into() });
        }
        self.add(format!("row {}", row.step));
        Ok(())
    }
    fn frame(&mut self, state: &State, _: &Plan) -> Result<(), Error> {
        if let Some((entered, leave)) = &self.gate {
            entered.send(()).unwrap();
            leave.recv_timeout(Duration::from_mins(1)).expect("the simulation goes on and gives leave");
        }
        self.add(format!("frame {}", state.step));
        Ok(())
    }
    fn pictures(&mut self, state: &State, _: &Plan) -> Result<(), Error> {
        self.add(format!("pictures {}", state.step));
        Ok(())
    }
    fn checkpoint(&mut self, state: &State) -> Result<(), Error> {
        self.checkpoints += 1;
        self.add(format!("checkpoint {}", state.step));
        Ok(())
    }
    fn has_checkpoint(&self) -> bool {
        self.checkpoints > 0
    }
    fn publish(&mut self) -> Result<(), Error> {
        self.add("publish".to_owned());
        Ok(())
    }
}

/// An observer made of a function.
struct Watch<F> {
    control: F,
    notes: Vec<Note>,
    thread: ThreadId,
}

fn watch<F: FnMut(&Progress) -> Control>(control: F) -> Watch<F> {
    Watch { control, notes: Vec::new(), thread: current().id() }
}

impl<F: FnMut(&Progress) -> Control> Observer for Watch<F> {
    fn progress(&mut self, progress: &Progress) -> Control {
        assert_eq!(current().id(), self.thread);
        (self.control)(progress)
    }
    fn note(&mut self, note: &Note) {
        assert_eq!(current().id(), self.thread);
        self.notes.push(*note);
    }
}

const ENDLESS: Schedule = Schedule {
    steps: u64::MAX,
    frame_every: 0,
    history_every: 0,
    picture_every: 0,
    checkpoint_every: None,
    checkpoint_interval_secs: f64::INFINITY,
};

#[test]
fn steps_go_on_while_a_frame_is_written_and_the_checkpoint_of_a_stop_comes_after_it() {
    let (entered, writing) = channel();
    let (give, leave) = channel();
    let mut sink = Notebook { gate: Some((entered, leave)), ..Notebook::default() };
    let mut written_since = None;
    let mut observer = watch(|progress| {
        if written_since.is_none() && writing.try_recv().is_ok() {
            written_since = Some(progress.step);
        }
        // The frame is in the writer's hands and stays there until these steps are done.
        if written_since.is_some_and(|step| progress.step > step) {
            give.send(()).unwrap();
            return Control::Stop;
        }
        Control::Continue
    });
    let schedule = Schedule { frame_every: u64::MAX, ..ENDLESS };
    let outcome = carry_on(sphere(false), &mut sink, Some(0), &schedule, &mut observer).unwrap();
    let Outcome::Interrupted { step } = outcome else { panic!("it was to stop") };
    assert_eq!(observer.notes, [Note::Frame { step: 0 }, Note::Checkpoint { step }]);
    assert_eq!(*sink.lines.lock().unwrap(), ["frame 0".to_owned(), format!("checkpoint {step}")]);
}

#[test]
fn moments_are_written_in_the_order_in_which_they_were_taken() {
    let mut sink = Notebook::default();
    let schedule = Schedule { steps: 5, frame_every: 2, history_every: 1, checkpoint_every: Some(4), ..ENDLESS };
    let mut observer = watch(|_| Control::Continue);
    carry_on(sphere(false), &mut sink, None, &schedule, &mut observer).unwrap();
    let expected = [
        "row 0",
        "checkpoint 0",
        "frame 0",
        "row 1",
        "row 2",
        "frame 2",
        "row 3",
        "row 4",
        "frame 4",
        "checkpoint 4",
        "row 5",
        "frame 5",
        "checkpoint 5",
    ];
    assert_eq!(*sink.lines.lock().unwrap(), expected);
    assert_eq!(observer.notes.len(), 7);
}

#[test]
fn a_full_disk_stops_a_simulation_that_would_go_on_for_ever() {
    let mut sink = Notebook { full_at: Some(20), ..Notebook::default() };
    let lines = Arc::clone(&sink.lines);
    let schedule = Schedule { history_every: 10, ..ENDLESS };
    let mut observer = watch(|_| Control::Continue);
    let failure = carry_on(sphere(false), &mut sink, Some(0), &schedule, &mut observer).unwrap_err();
    assert!(matches!(failure, Failure::Results(Error::DiskFull { .. })), "{failure:?}");
    assert_eq!(*lines.lock().unwrap(), ["row 0", "row 10"], "and nothing is written after it");
}

#[test]
fn a_full_disk_is_noticed_though_nothing_more_is_due() {
    let mut sink = Notebook { full_at: Some(0), ..Notebook::default() };
    let schedule = Schedule { steps: u64::MAX, history_every: u64::MAX, ..ENDLESS };
    let mut observer = watch(|_| Control::Continue);
    let failure = carry_on(sphere(false), &mut sink, Some(0), &schedule, &mut observer).unwrap_err();
    assert!(matches!(failure, Failure::Results(Error::DiskFull { .. })), "{failure:?}");
}

#[test]
fn after_a_fault_everything_taken_before_it_is_written() {
    let mut sink = Notebook::default();
    let schedule = Schedule { history_every: 2500, ..ENDLESS };
    let mut observer = watch(|_| Control::Continue);
    let failure = carry_on(sphere(true), &mut sink, Some(0), &schedule, &mut observer).unwrap_err();
    let Failure::Fault(Fault::Escaped { step, .. }) = failure else { panic!("{failure:?}") };
    assert!((99_900..=100_100).contains(&step), "{step}");
    let expected: Vec<String> = (0..step).step_by(2500).map(|step| format!("row {step}")).collect();
    assert_eq!(*sink.lines.lock().unwrap(), expected);
}

#[test]
fn what_was_taken_so_far_is_published_before_the_run_goes_on() {
    let mut sink = Notebook::default();
    let lines = Arc::clone(&sink.lines);
    let mut calls = 0;
    let mut observer = watch(|_| {
        calls += 1;
        if calls == 1 {
            return Control::Publish;
        }
        assert_eq!(*lines.lock().unwrap(), ["frame 0", "publish"]);
        Control::Stop
    });
    let schedule = Schedule { frame_every: u64::MAX, ..ENDLESS };
    carry_on(sphere(false), &mut sink, Some(0), &schedule, &mut observer).unwrap();
}

#[test]
fn no_more_than_two_moments_are_under_way() {
    let (entered, writing) = channel();
    let (give, leave) = channel();
    let mut sink = Notebook { gate: Some((entered, leave)), ..Notebook::default() };
    let lines = Arc::clone(&sink.lines);
    let plan = sphere(false).plan().clone();
    let alive = Arc::new(());
    let moment = |step| {
        let held = Arc::clone(&alive);
        Capture::new(move || {
            drop(held);
            Ok(State { step, ..State::default() })
        })
    };
    let frame = Wanted { frame: true, ..Wanted::default() };
    thread::scope(|scope| {
        let mut writer = Writer::start(scope, &mut sink, &plan).unwrap();
        writer.write(moment(0), Duration::ZERO, frame);
        writing.recv().unwrap();
        writer.write(moment(1), Duration::ZERO, frame);
        // One is being written, the other waits, and there is no room for a third.
        assert_eq!((Arc::strong_count(&alive) - 1, writer.under_way()), (1, LIMIT));
        for step in 2..50 {
            assert!(writer.told().unwrap().is_none(), "nothing is done without leave");
            give.send(()).unwrap();
            while writer.under_way() == LIMIT {
                writer.listen().unwrap();
            }
            writing.recv().unwrap();
            assert_eq!(Arc::strong_count(&alive) - 1, 0, "the one that waited is being written");
            writer.write(moment(step), Duration::ZERO, frame);
        }
        (0..LIMIT).for_each(|_| give.send(()).unwrap());
        while writer.under_way() > 0 {
            writer.listen().unwrap();
        }
    });
    let expected: Vec<String> = (0..50).map(|step| format!("frame {step}")).collect();
    assert_eq!(*lines.lock().unwrap(), expected);
}

#[test]
#[should_panic(expected = "waits for room")]
fn a_third_moment_is_refused() {
    let mut sink = Notebook::default();
    let plan = sphere(false).plan().clone();
    thread::scope(|scope| {
        let mut writer = Writer::start(scope, &mut sink, &plan).unwrap();
        (0..=LIMIT).for_each(|_| writer.write(State::default().into(), Duration::ZERO, Wanted::default()));
    });
}

#[test]
fn a_fault_in_a_capture_ends_the_writing() {
    let mut sink = Notebook::default();
    let plan = sphere(false).plan().clone();
    let failure = thread::scope(|scope| {
        let mut writer = Writer::start(scope, &mut sink, &plan).unwrap();
        let frame = Wanted { frame: true, ..Wanted::default() };
        writer.write(Capture::new(|| Err(Fault::Inconsistent { what: "a test" })), Duration::ZERO, frame);
        writer.write(State::default().into(), Duration::ZERO, frame);
        writer.listen().unwrap_err()
    });
    assert!(matches!(failure, Failure::Fault(Fault::Inconsistent { .. })), "{failure:?}");
    assert!(sink.lines.lock().unwrap().is_empty());
}

#[test]
#[should_panic(expected = "gives leave")]
fn a_panic_of_the_writer_is_one_of_the_run() {
    let (entered, _writing) = channel();
    let (_, leave) = channel();
    let mut sink = Notebook { gate: Some((entered, leave)), ..Notebook::default() };
    let schedule = Schedule { frame_every: u64::MAX, ..ENDLESS };
    let _ = carry_on(sphere(false), &mut sink, Some(0), &schedule, &mut watch(|_| Control::Continue));
}
