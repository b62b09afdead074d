//! The rungs of a case.

use super::{Error, Follower};
use tdem_case::schema::{Motion, OutOfRange, Positive, Step};
use tdem_case::{Built, Loaded, RunLoader};
use tdem_engine::Plan;

/// What is halved from rung to rung.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halved {
    /// How much faster heat goes than motion.
    TimeScale,
    /// The step of heat that advances by itself.
    HeatStep,
}

/// A case at one acceleration, or with one step of the heat, ready to run.
#[derive(Clone, Debug)]
pub struct Rung {
    /// How it is called in tables.
    pub label: String,
    /// What tells it from the rung before.
    pub halved: Halved,
    /// What runs.
    pub built: Built,
    /// The case as it runs, with the step, the version of this program and the hash of the state that it begins from: two rungs
    /// of the same text have the same results.
    pub case_toml: String,
}

impl Rung {
    /// Time of the heat over time of the motion.
    #[must_use]
    pub fn time_scale(&self) -> f64 {
        self.built.plan.heat.as_ref().map_or(0.0, |heat| heat.time_scale)
    }
    /// What is halved: the time scale, or the step of the heat, s.
    #[must_use]
    pub fn value(&self) -> f64 {
        match self.halved {
            Halved::TimeScale => self.time_scale(),
            Halved::HeatStep => self.built.plan.heat_step(),
        }
    }
    /// Time of the heat when it ends, s.
    #[must_use]
    pub fn heat_end(&self) -> f64 {
        self.built.plan.heat_time(self.built.schedule.steps)
    }
    /// The step that ends nearest to a time of the heat, s.
    pub(super) fn step_at(&self, heat_time: f64) -> u64 {
        libm::round(heat_time / self.built.plan.heat_step()) as u64
    }
}

/// The rungs of a case: as it is, and each with half the time scale of the one before and twice the duration of the
/// motion. All have the step of the first. `runs` reads other runs that the case begins from.
///
/// Where heat advances by itself, each has half the step of the heat of the one before, and as much time.
///
/// Gravity and constant forces act longer on each rung, as they should on what is at rest under them; what falls or swings
/// by itself does so in its own time.
///
/// # Errors
/// [`Error::NoHeat`], [`Error::NotAccelerated`], [`Error::TooManyRungs`], [`Error::FollowsMotion`], [`Error::Refused`],
/// [`Error::OutOfRange`].
pub fn rungs(loaded: &Loaded, count: u32, runs: &dyn RunLoader) -> Result<Vec<Rung>, Error> {
    let heat = loaded.case.heat.as_ref().ok_or(Error::NoHeat)?;
    let halved = if heat.motion == Motion::Scaled { Halved::TimeScale } else { Halved::HeatStep };
    let build = |loaded: &Loaded, label: String| match loaded.build_with(runs) {
        Ok(built) => {
            let case_toml = head(&label, &built) + &loaded.kept(&built)?;
            Ok(Rung { label, halved, built, case_toml })
        }
        Err(problems) => Err(Error::Refused { label, problems }),
    };
    match halved {
        Halved::TimeScale => slower(loaded, count, heat.time_scale(&loaded.case), build),
        Halved::HeatStep => finer(loaded, count, build),
    }
}

/// What a kept case does not tell of what its run depends on.
fn head(label: &str, built: &Built) -> String {
    let (version, hash) = (env!("CARGO_PKG_VERSION"), built.state.hash());
    format!("# Rung {label} of a ladder, tdem {version}, from the state {hash:032x}.\n")
}

/// Rungs with less and less acceleration.
fn slower(
    loaded: &Loaded,
    count: u32,
    time_scale: f64,
    build: impl Fn(&Loaded, String) -> Result<Rung, Error>,
) -> Result<Vec<Rung>, Error> {
    if time_scale <= 1.0 {
        return Err(Error::NotAccelerated { time_scale });
    }
    let lowest = time_scale / factor(count.saturating_sub(1));
    if lowest < 1.0 {
        return Err(Error::TooManyRungs { rungs: count, lowest });
    }
    let first = build(loaded, "S".to_owned())?;
    if let Some(what) = follower(&first.built.plan) {
        return Err(Error::FollowsMotion { what });
    }
    let step = Positive::try_from(first.built.plan.dt)?;
    let mut rungs = vec![first];
    for halvings in 1..count {
        let by = factor(halvings);
        rungs.push(build(&slowed(loaded, step, by)?, format!("S/{by}"))?);
    }
    Ok(rungs)
}

/// Rungs with shorter and shorter steps of the heat.
fn finer(
    loaded: &Loaded,
    count: u32,
    build: impl Fn(&Loaded, String) -> Result<Rung, Error>,
) -> Result<Vec<Rung>, Error> {
    let first = build(loaded, "h".to_owned())?;
    let step = first.built.plan.heat_step();
    let mut rungs = vec![first];
    for halvings in 1..count {
        let by = factor(halvings);
        let mut finer = loaded.clone();
        let shorter = Positive::try_from(step / by)?;
        finer.case.heat.iter_mut().for_each(|heat| heat.step = Some(shorter));
        rungs.push(build(&finer, format!("h/{by}"))?);
    }
    Ok(rungs)
}

/// $2^n$.
fn factor(halvings: u32) -> f64 {
    libm::ldexp(1.0, halvings.cast_signed())
}

/// The case with so much more motion for the same heat.
fn slowed(loaded: &Loaded, step: Positive, by: f64) -> Result<Loaded, OutOfRange> {
    let mut slowed = loaded.clone();
    let case = &mut slowed.case;
    case.time.step = Step::Seconds(step);
    case.time.end = Positive::try_from(by * case.time.end.get())?;
    // A duration of the heat stays, and is spread over the longer motion.
    if let Some(scale) = case.heat.as_mut().and_then(|heat| heat.time_scale.as_mut()) {
        *scale = Positive::try_from(scale.get() / by)?;
    }
    Ok(slowed)
}

/// What would be elsewhere, or pull otherwise, at the same time of the heat.
fn follower(plan: &Plan) -> Option<Follower> {
    if !plan.ramps.is_empty() {
        return Some(Follower::Course);
    }
    let moves = |rate: &Option<f64>| rate.is_some_and(|rate| rate != 0.0);
    if plan.constraints.iter().any(|c| c.velocity.iter().chain(&c.angular_velocity).any(moves)) {
        return Some(Follower::Motion);
    }
    plan.walls.iter().find(|wall| wall.velocity != [0.0; 3]).map(|wall| Follower::Wall(wall.name.clone()))
}
