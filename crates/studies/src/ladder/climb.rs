//! Rungs run one after the other; of each, what is compared is kept at equal times of the heat.

use super::compare::{Pair, Sample, Track};
use super::{Error, Halved, Rung};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};
use tdem_engine::{Fault, Ledger, Plan, Simulation, State};
use tdem_results::{Pace, Rate, mean_stress};

/// What a ladder shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Ladder {
    /// What is halved from rung to rung.
    pub halved: Halved,
    /// Each rung that is complete, in the order of the ladder.
    pub rungs: Vec<Outcome>,
    /// Each rung against the one that follows, one fewer.
    pub pairs: Vec<Pair>,
}

/// How a rung ended.
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
    /// Steps taken.
    pub steps: u64,
    /// Time on the clock, s.
    pub clock_secs: f64,
    /// Bonds of the case.
    pub bonds: u64,
    /// Of these, broken at the end.
    pub broken_bonds: u64,
    /// Hash of the final state, the same on every machine.
    pub hash: u128,
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
/// simulation of a state and a plan, `watch` is told several times a second how it goes, and may end it: the rung under way is
/// then dropped.
///
/// Instants end steps of the first rung; with rungs from [`super::rungs`] they end steps of all, and times are equal to the
/// last bit. [`kept_bytes`] says how much memory it takes beside the run.
///
/// # Errors
/// [`Error::Different`], [`Error::Fault`].
pub fn climb(
    rungs: Vec<Rung>,
    parts: u32,
    start: impl Fn(State, Plan) -> Result<Simulation, Fault>,
    watch: &mut dyn FnMut(&Progress<'_>) -> ControlFlow<()>,
) -> Result<Ladder, Error> {
    if rungs.windows(2).any(|two| !alike(&two[0].built.state, &two[1].built.state)) {
        return Err(Error::Different);
    }
    let instants = rungs.first().map_or(Vec::new(), |first| instants(first, parts));
    let targets: Vec<Vec<u64>> =
        rungs.iter().map(|rung| instants.iter().map(|&time| rung.step_at(time)).collect()).collect();
    let steps = targets.iter().filter_map(|targets| targets.last()).sum();
    let mut walk = Walk { rungs: rungs.len(), done: 0, steps, pace: Pace::default(), rate: Rate::new(0), watch };
    let halved = rungs.first().map_or(Halved::TimeScale, |first| first.halved);
    let mut ladder = Ladder { halved, rungs: Vec::new(), pairs: Vec::new() };
    let mut before: Option<Track> = None;
    for (index, (rung, targets)) in rungs.into_iter().zip(&targets).enumerate() {
        let label = rung.label.clone();
        let walked = walk.along(index, rung, targets, &start).map_err(|fault| Error::Fault { label, fault })?;
        let Some((outcome, track)) = walked else { break };
        ladder.rungs.push(outcome);
        ladder.pairs.extend(before.map(|before| Pair::of(&before, &track, &instants)));
        before = Some(track);
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
/// [`Error::Fault`].
pub fn step_seconds(
    rung: &Rung,
    budget: Duration,
    start: impl Fn(State, Plan) -> Result<Simulation, Fault>,
) -> Result<f64, Error> {
    let measure = || {
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
    };
    measure().map_err(|fault| Error::Fault { label: rung.label.clone(), fault })
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
    /// Runs one rung to its last instant; `None` if it was told to end before.
    fn along(
        &mut self,
        index: usize,
        rung: Rung,
        targets: &[u64],
        start: impl Fn(State, Plan) -> Result<Simulation, Fault>,
    ) -> Result<Option<(Outcome, Track)>, Fault> {
        let (began, time_scale, heat_end) = (Instant::now(), rung.time_scale(), rung.heat_end());
        let Rung { label, built, .. } = rung;
        let particles = built.state.len() as f64;
        let mut simulation = start(built.state, built.plan)?;
        let mut samples = Vec::with_capacity(targets.len());
        for &target in targets {
            while simulation.step() < target {
                let batch = self.pace.batch().min(target - simulation.step());
                let batch_began = Instant::now();
                simulation.advance(batch)?;
                self.pace.took(batch, batch_began.elapsed());
                self.done += batch;
                self.rate.reached(self.done);
                let told = (self.watch)(&Progress {
                    rung: index,
                    rungs: self.rungs,
                    label: &label,
                    heat_time: simulation.plan().heat_time(simulation.step()),
                    heat_end,
                    done: self.done,
                    steps: self.steps,
                    cundall_number: self.rate.steps_per_second().map_or(0.0, |rate| rate * particles),
                    time_left: self.rate.time_for(self.steps - self.done),
                });
                if told.is_break() {
                    return Ok(None);
                }
            }
            let state = simulation.state()?;
            samples.push(sample(state, simulation.plan()));
        }
        let state = simulation.state()?;
        let breaks = state.bonds.iter().map(|bond| bond.breakage.map(|breakage| breakage.step)).collect();
        let track = Track { targets: targets.to_vec(), samples, breaks };
        let outcome = Outcome {
            label,
            time_scale,
            step_seconds: simulation.plan().dt,
            heat_step_seconds: simulation.plan().heat_step(),
            steps: simulation.step(),
            clock_secs: began.elapsed().as_secs_f64(),
            bonds: state.bonds.len() as u64,
            broken_bonds: state.bonds.iter().filter(|bond| !bond.holds()).count() as u64,
            hash: state.hash(),
        };
        Ok(Some((outcome, track)))
    }
}

/// What is kept of an instant.
fn sample(state: State, plan: &Plan) -> Sample {
    let ledger = Ledger::of(&state, plan);
    let elastic = ledger.elastic_normal + ledger.elastic_tangential + ledger.elastic_bonds;
    Sample {
        stress: mean_stress(&state, plan),
        temperature: state.temperature,
        kinetic_over_elastic: (elastic > 0.0).then(|| ledger.kinetic() / elastic),
    }
}
