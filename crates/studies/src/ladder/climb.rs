//! Rungs run one after the other; of each, what is compared is kept at equal times of the heat.

use super::compare::{Pair, Sample, Track};
use super::record::{Reached, Record, folder_of};
use super::{Halt, Halved, Rung};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};
use tdem_engine::{Fault, Ledger, Plan, Simulation, State};
use tdem_results::{Pace, Rate, mean_stress};

/// What a ladder shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Ladder {
    /// What is halved from rung to rung.
    pub halved: Halved,
    /// Each rung that came to an instant, in the order of the ladder; only the last may be incomplete.
    pub rungs: Vec<Outcome>,
    /// Each rung against the one that follows, one fewer.
    pub pairs: Vec<Pair>,
    /// What ended the climb before its end, if not who watched it.
    pub failure: Option<Failure>,
}

impl Ladder {
    /// How many rungs are complete.
    #[must_use]
    pub fn complete(&self) -> usize {
        self.rungs.iter().filter(|rung| rung.complete).count()
    }
}

/// A rung that came to no end.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Its label.
    pub label: String,
    /// Why.
    pub fault: Fault,
}

/// How far a rung got.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Its label.
    pub label: String,
    /// Time of the heat over time of the motion.
    pub time_scale: f64,
    /// A step of the plan: of the motion, or of heat that advances by itself, s.
    pub step_seconds: f64,
    /// Time of the heat in a step, s.
    pub heat_step_seconds: f64,
    /// Whether it came to its end. If not, all that follows is of its last instant.
    pub complete: bool,
    /// Time of the heat at its last instant, s.
    pub heat_time: f64,
    /// Steps until then.
    pub steps: u64,
    /// Time on the clock, s.
    pub clock_secs: f64,
    /// Bonds of the case.
    pub bonds: u64,
    /// Of these, broken by then.
    pub broken_bonds: u64,
    /// Hash of the state then, the same on every machine; `None` where only a later one is known.
    pub hash: Option<u128>,
}

/// How the climb is getting on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress<'a> {
    /// The rung under way, from 0.
    pub rung: usize,
    /// How many there are.
    pub rungs: usize,
    /// Its label.
    pub label: &'a str,
    /// Time of the heat, s.
    pub heat_time: f64,
    /// Time of the heat when the rung ends, s.
    pub heat_end: f64,
    /// Steps done on all rungs.
    pub done: u64,
    /// Steps of all rungs.
    pub steps: u64,
    /// Particles times steps per second of wall clock, lately; 0 until that can be said.
    pub cundall_number: f64,
    /// Wall clock until the end of all, if the pace stays.
    pub time_left: Option<Duration>,
}

/// Runs all rungs and compares each with the next at so many equal parts of the time of the heat. `start` makes the
/// simulation of a state and a plan, `watch` is told several times a second how it goes, and may end it. A fault ends it, too.
/// The rung under way is then compared as far as it got.
///
/// With the folder of a ladder, in which [`super::prepare`] made those of its rungs, they leave checkpoints and what is
/// compared: rungs that are complete there are read, others go on. Whether they do changes no bit.
///
/// Instants end steps of the first rung; with rungs from [`super::rungs`] they end steps of all, and times are equal to the
/// last bit. [`kept_bytes`] says how much memory it takes beside the run.
///
/// # Errors
/// [`Halt::Different`], [`Halt::OtherCase`], [`Halt::Results`].
pub fn climb(
    rungs: Vec<Rung>,
    parts: u32,
    folder: Option<&Path>,
    start: impl Fn(State, Plan) -> Result<Simulation, Fault>,
    watch: &mut dyn FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Ladder, Halt> {
    if rungs.windows(2).any(|two| !alike(&two[0].built.state, &two[1].built.state)) {
        return Err(Halt::Different);
    }
    let instants = rungs.first().map_or(Vec::new(), |first| instants(first, parts));
    let targets: Vec<Vec<u64>> =
        rungs.iter().map(|rung| instants.iter().map(|&time| rung.step_at(time)).collect()).collect();
    let steps = targets.iter().filter_map(|targets| targets.last()).sum();
    let mut walk = Walk { rungs: rungs.len(), done: 0, steps, pace: Pace::default(), rate: Rate::new(0), watch };
    let halved = rungs.first().map_or(Halved::TimeScale, |first| first.halved);
    let mut ladder = Ladder { halved, rungs: Vec::new(), pairs: Vec::new(), failure: None };
    let mut before: Option<Track> = None;
    for (index, (rung, targets)) in rungs.into_iter().zip(&targets).enumerate() {
        let (record, reached) = match folder {
            Some(folder) => {
                let (record, reached) = Record::open(&folder_of(folder, index), &rung, targets)?;
                (Some(record), reached)
            }
            None => (None, None),
        };
        let mut way = Way::new(rung, targets, record);
        let ended = walk.along(index, &mut way, reached, &start);
        if let Some(outcome) = way.outcome {
            ladder.rungs.push(outcome);
            ladder.pairs.extend(before.map(|before| Pair::of(&before, &way.track, &instants)));
            before = Some(way.track);
        }
        match ended {
            Ok(()) => {}
            Err(Stop::Watched) => break,
            Err(Stop::Results(error)) => return Err(error.into()),
            Err(Stop::Fault(fault)) => {
                if let Some(record) = &way.record {
                    record.log(&fault.to_string())?;
                }
                ladder.failure = Some(Failure { label: way.rung.label, fault });
                break;
            }
        }
    }
    Ok(ladder)
}

/// Memory that a climb takes beside that of one run, bytes: what is compared, of two rungs at a time, and the states of rungs
/// that have not begun.
#[must_use]
pub fn kept_bytes(rungs: &[Rung], parts: u32) -> u64 {
    let of_instant = 2 * size_of::<f64>() as u64;
    let compared = rungs.iter().take(2).map(|rung| {
        let state = &rung.built.state;
        of_instant * u64::from(parts) * state.len() as u64 + (size_of::<Option<u64>>() * state.bonds.len()) as u64
    });
    let waiting = rungs.iter().skip(1).map(|rung| rung.built.memory.state_bytes);
    compared.sum::<u64>() + waiting.sum::<u64>()
}

/// How long a step of a rung takes on the clock, s: some steps of a copy of it, for about so long.
///
/// # Errors
/// What the copy met.
pub fn step_seconds(
    rung: &Rung,
    budget: Duration,
    start: impl Fn(State, Plan) -> Result<Simulation, Fault>,
) -> Result<f64, Fault> {
    let mut simulation = start(rung.built.state.clone(), rung.built.plan.clone())?;
    // The first step lists neighbours and wakes caches; it says nothing of the others.
    simulation.advance(1)?;
    let (began, first, mut pace) = (Instant::now(), simulation.step(), Pace::default());
    while began.elapsed() < budget && simulation.step() < rung.built.schedule.steps {
        let batch = pace.batch().min(rung.built.schedule.steps - simulation.step());
        let batch_began = Instant::now();
        simulation.advance(batch)?;
        pace.took(batch, batch_began.elapsed());
    }
    Ok(began.elapsed().as_secs_f64() / (simulation.step() - first).max(1) as f64)
}

/// Whether two states hold the same particles and bonds.
fn alike(a: &State, b: &State) -> bool {
    let pairs = |state: &State| state.bonds.iter().map(|bond| (bond.first, bond.second)).collect::<Vec<_>>();
    a.id == b.id && pairs(a) == pairs(b)
}

/// Times of the heat at which rungs are compared, s, ascending; the last is the end of the first rung.
fn instants(first: &Rung, parts: u32) -> Vec<f64> {
    let steps = first.built.schedule.steps.max(1);
    let parts = u64::from(parts).clamp(1, steps);
    (1..=parts).map(|part| first.built.plan.heat_time((2 * part * steps + parts) / (2 * parts))).collect()
}

/// Why a rung ends before its end.
enum Stop {
    /// Who watches it wants it to.
    Watched,
    Fault(Fault),
    Results(tdem_results::Error),
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Stop::Fault(fault)
    }
}

impl From<tdem_results::Error> for Stop {
    fn from(error: tdem_results::Error) -> Self {
        Stop::Results(error)
    }
}

/// One rung, as far as it is known.
struct Way {
    rung: Rung,
    record: Option<Record>,
    began: Instant,
    /// Time on the clock that earlier climbs took for it, s.
    earlier_secs: f64,
    track: Track,
    outcome: Option<Outcome>,
}

impl Way {
    fn new(rung: Rung, targets: &[u64], record: Option<Record>) -> Self {
        let track = Track { targets: targets.to_vec(), ..Track::default() };
        Way { rung, record, began: Instant::now(), earlier_secs: 0.0, track, outcome: None }
    }

    fn clock_secs(&self) -> f64 {
        self.earlier_secs + self.began.elapsed().as_secs_f64()
    }

    /// Takes down an instant.
    fn keep(&mut self, state: &State) -> Result<(), tdem_results::Error> {
        let sample = sample(state, &self.rung.built.plan);
        if let Some(record) = &self.record {
            record.keep(state.step, &sample)?;
        }
        self.track.samples.push(sample);
        self.conclude(state);
        self.checkpoint(state)
    }

    /// What is known at the last instant, by a state then or later.
    fn conclude(&mut self, state: &State) {
        let instants = self.track.samples.len();
        let Some(&step) = self.track.targets[..instants].last() else { return };
        self.track.breaks = state.bonds.iter().map(|bond| bond.breakage.map(|breakage| breakage.step)).collect();
        let complete = instants == self.track.targets.len();
        let plan = &self.rung.built.plan;
        self.outcome = Some(Outcome {
            label: self.rung.label.clone(),
            time_scale: self.rung.time_scale(),
            step_seconds: plan.dt,
            heat_step_seconds: plan.heat_step(),
            complete,
            heat_time: plan.heat_time(step),
            steps: step,
            clock_secs: self.clock_secs(),
            bonds: state.bonds.len() as u64,
            broken_bonds: self.track.breaks.iter().filter(|at| at.is_some_and(|at| at <= step)).count() as u64,
            hash: (state.step == step).then(|| state.hash()),
        });
    }

    fn checkpoint(&mut self, state: &State) -> Result<(), tdem_results::Error> {
        let clock_secs = self.clock_secs();
        self.record.as_mut().map_or(Ok(()), |record| record.checkpoint(state, clock_secs))
    }
}

/// The way over all rungs.
struct Walk<'w> {
    rungs: usize,
    done: u64,
    steps: u64,
    pace: Pace,
    rate: Rate,
    watch: &'w mut dyn FnMut(&Progress<'_>) -> ControlFlow<()>,
}

impl Walk<'_> {
    /// Runs one rung to its last instant, from where it got before.
    fn along(
        &mut self,
        index: usize,
        way: &mut Way,
        reached: Option<Reached>,
        start: impl Fn(State, Plan) -> Result<Simulation, Fault>,
    ) -> Result<(), Stop> {
        let first = match reached {
            Some(Reached { state, samples, clock_secs }) => {
                (way.track.samples, way.earlier_secs) = (samples, clock_secs);
                way.conclude(&state);
                // Steps of earlier climbs say nothing of the pace of this one.
                self.done += state.step;
                self.rate = Rate::new(self.done);
                state
            }
            None => std::mem::take(&mut way.rung.built.state),
        };
        let left = way.track.targets[way.track.samples.len()..].to_vec();
        if left.is_empty() {
            return Ok(());
        }
        let interval = Duration::try_from_secs_f64(way.rung.built.schedule.checkpoint_interval_secs);
        let mut kept = Instant::now();
        let mut simulation = start(first, way.rung.built.plan.clone())?;
        for target in left {
            let mut told = ControlFlow::Continue(());
            while simulation.step() < target && told.is_continue() {
                told = self.batch(index, &way.rung, &mut simulation, target)?;
                let due = interval.as_ref().is_ok_and(|&interval| kept.elapsed() >= interval);
                if way.record.is_some() && simulation.step() < target && (due || told.is_break()) {
                    way.checkpoint(&simulation.state()?)?;
                    kept = Instant::now();
                }
            }
            if simulation.step() == target {
                way.keep(&simulation.state()?)?;
                kept = Instant::now();
            }
            if told.is_break() {
                return Err(Stop::Watched);
            }
        }
        Ok(())
    }

    /// Some steps towards a target, and a word to who watches.
    fn batch(
        &mut self,
        index: usize,
        rung: &Rung,
        simulation: &mut Simulation,
        target: u64,
    ) -> Result<ControlFlow<()>, Fault> {
        let batch = self.pace.batch().min(target - simulation.step());
        let began = Instant::now();
        simulation.advance(batch)?;
        self.pace.took(batch, began.elapsed());
        self.done += batch;
        self.rate.reached(self.done);
        let particles = simulation.particles() as f64;
        Ok((self.watch)(&Progress {
            rung: index,
            rungs: self.rungs,
            label: &rung.label,
            heat_time: simulation.plan().heat_time(simulation.step()),
            heat_end: rung.heat_end(),
            done: self.done,
            steps: self.steps,
            cundall_number: self.rate.steps_per_second().map_or(0.0, |rate| rate * particles),
            time_left: self.rate.time_for(self.steps - self.done),
        }))
    }
}

/// What is kept of an instant.
fn sample(state: &State, plan: &Plan) -> Sample {
    let ledger = Ledger::of(state, plan);
    let elastic = ledger.elastic_normal + ledger.elastic_tangential + ledger.elastic_bonds;
    Sample {
        stress: mean_stress(state, plan),
        temperature: state.temperature.clone(),
        kinetic_over_elastic: (elastic > 0.0).then(|| ledger.kinetic() / elastic),
    }
}
