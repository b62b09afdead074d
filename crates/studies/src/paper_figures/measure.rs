//! One application at one size and in one mode, measured on machines.

use super::counting::{Count, Evaluations, Numbers, Work};
use super::{Machine, Measured, Mode, Model, Point, Procedures, Size};
use crate::bench::{Measurement, Phase, Profiled};
use std::path::Path;
use std::time::Instant;
use tdem_case::{Built, Problems};
use tdem_engine::physics::bond::Form;
use tdem_engine::{Device, Fault, Plan, Profile, Simulation, cpu, gpu};
use thiserror::Error;

/// Measurements of each kind, of which the best counts.
const REPEATS: usize = 3;
/// Steps of a measurement and of a profile.
const MOST_STEPS: f64 = 20_000.0;
const PROFILED: [f64; 2] = [2.0, 40.0];
/// A profile takes this part of the time of the measurements.
const PROFILE: f64 = 0.3;
/// Pairs that a particle of a crystal shares with its neighbours.
const PAIRS: usize = 6;
/// A device keeps some of its memory for itself.
const USABLE: f64 = 0.95;

/// What keeps a scene from being measured.
#[derive(Debug, Error)]
pub enum Failure {
    /// The case of this program is not accepted.
    #[error("the case of {model} at size {size} cannot be built")]
    Case {
        /// Which model.
        model: Model,
        /// Which size.
        size: Size,
        /// What is wrong with it.
        problems: Problems,
    },
    /// The run stopped.
    #[error("{model} at size {size}, {mode} mode, on {machine}: {fault}")]
    Fault {
        /// Which model.
        model: Model,
        /// Which size.
        size: Size,
        /// How a step is computed.
        mode: Mode,
        /// On what.
        machine: String,
        /// What happened.
        fault: Fault,
    },
}

/// An application of the paper at one size, ready to be measured.
#[derive(Clone, Debug)]
pub struct Scene {
    model: Model,
    size: Size,
    mode: Mode,
    built: Built,
}

impl Scene {
    /// Builds the case.
    ///
    /// # Errors
    /// [`Failure::Case`], which would be a bug.
    pub fn build(model: Model, size: Size, mode: Mode) -> Result<Self, Failure> {
        let (file, text) = model.case();
        let mut set = vec![("model".to_owned(), model.to_string()), ("output.ledger".to_owned(), "false".to_owned())];
        set.extend(size.preset(model).map(|preset| ("size".to_owned(), preset.to_owned())));
        if mode == Mode::Paper {
            set.push(("time.integrator".to_owned(), "gear".to_owned()));
        }
        let built = tdem_case::parse(file, text, Path::new("."), &set).and_then(|loaded| loaded.build());
        let mut built = built.map_err(|problems| Failure::Case { model, size, problems })?;
        built.plan.ledger = false;
        built.plan.search.every_step = mode == Mode::Paper;
        Ok(Scene { model, size, mode, built })
    }

    /// State, plan, and what follows from them.
    #[must_use]
    pub fn built(&self) -> &Built {
        &self.built
    }

    /// Why the scene is not measured on a machine: it has too little memory.
    #[must_use]
    pub fn too_large(&self, machine: &Machine) -> Option<String> {
        let (plan, particles, bonds) = (&self.built.plan, self.built.state.len(), self.built.state.bonds.len());
        let needed = match machine.device {
            Device::Gpu { .. } => gpu::bytes(plan, particles, PAIRS * particles, bonds) as u64,
            // The state it begins from and the one it ends with lie beside it.
            Device::Cpu(_) => {
                cpu::bytes(plan, particles, PAIRS * particles, bonds) as u64 + 2 * self.built.memory.state_bytes
            }
        };
        let usable = USABLE * machine.memory_bytes? as f64;
        (needed as f64 > usable).then(|| {
            format!(
                "{} at size {}, {} mode, needs about {:.1} GB, of which {} has {:.1} GB",
                self.model,
                self.size,
                self.mode,
                1e-9 * needed as f64,
                machine.name,
                1e-9 * usable
            )
        })
    }

    /// Measures the scene on the machine of this place in a record, for about so many seconds, and tells the machine how
    /// fast it copies.
    ///
    /// # Errors
    /// [`Failure::Fault`] if the run stops.
    pub fn measure(&self, place: usize, machine: &mut Machine, seconds: f64) -> Result<Measured, Failure> {
        self.run(place, machine, seconds).map_err(|fault| Failure::Fault {
            model: self.model,
            size: self.size,
            mode: self.mode,
            machine: machine.name.clone(),
            fault,
        })
    }

    fn run(&self, place: usize, machine: &mut Machine, seconds: f64) -> Result<Measured, Fault> {
        let (plan, device) = (&self.built.plan, machine.device);
        let mut simulation = Simulation::new(self.built.state.clone(), plan.clone(), device)?;
        let each = pace(&mut simulation, 0.1 * seconds)?;
        let phase = Phase {
            after: 0,
            steps: (seconds / each / REPEATS as f64).clamp(1.0, MOST_STEPS) as u64,
            repeats: REPEATS,
            profile: (PROFILE * seconds / each).clamp(PROFILED[0], PROFILED[1]) as u64,
        };
        let found = phase.measure_in(&mut simulation, &device)?;
        let Some(Profiled { profile, copy_bandwidth }) = &found.profiled else {
            return Err(Fault::Inconsistent { what: "a profile was asked for" });
        };
        machine.copy_bytes_per_second = machine.copy_bytes_per_second.max(*copy_bandwidth);
        let particles = found.particles;
        let contacts = (0.5 * found.contacts_per_particle * particles as f64).round() as usize;
        let bonds = self.built.state.bonds.iter().filter(|bond| bond.holds()).count();
        let work = Work::of_step(plan, Numbers { particles, contacts, bonds }, evaluations(plan, &device));
        Ok(Measured {
            model: self.model,
            size: self.size,
            mode: self.mode,
            machine: place,
            particles,
            contacts,
            bonds,
            steps: found.steps,
            repeats: phase.repeats,
            searches: found.searches,
            seconds_per_step: found.step_seconds(),
            median_seconds_per_step: particles as f64 / found.median_rate,
            memory_bytes: found.bytes_per_particle * particles as f64,
            profiled_steps: profile.steps,
            procedures: procedures(profile),
            points: points(&found, profile, &work, machine.gpu, self.mode),
            hash: format!("{:032x}", found.hash),
        })
    }
}

/// How long a step takes, s, roughly; behind it page faults and the first lists are over.
fn pace(simulation: &mut Simulation, seconds: f64) -> Result<f64, Fault> {
    simulation.advance(2)?;
    let mut steps = 1;
    loop {
        let start = Instant::now();
        simulation.advance(steps)?;
        let took = start.elapsed().as_secs_f64();
        if took >= seconds || steps as f64 >= MOST_STEPS {
            return Ok(took / steps as f64);
        }
        steps *= 4;
    }
}

/// A device evaluates a contact from both sides, and a bond, too, unless it is evaluated apart; the processor lists pairs once.
fn evaluations(plan: &Plan, device: &Device) -> Evaluations {
    let remembers = plan.bonds.as_ref().is_some_and(|bonds| matches!(bonds.law.form, Form::Incremental(_)));
    match device {
        Device::Gpu { .. } => Evaluations { contact: 2, bond: if plan.search.every_step || remembers { 1 } else { 2 } },
        Device::Cpu(options) => Evaluations { contact: if options.list == cpu::List::Half { 1 } else { 2 }, bond: 1 },
    }
}

/// The stages and kernels of a profile in the paper's words.
fn procedures(profile: &Profile) -> Procedures {
    let mut procedures = Procedures::default();
    for part in &profile.parts {
        let seconds = part.seconds / profile.steps as f64;
        let procedure = match (part.stage, part.name) {
            ("search", name) if name.starts_with("history_") => &mut procedures.history,
            ("search", _) => &mut procedures.search,
            ("bond", _) => &mut procedures.bonds,
            ("contact" | "gather", _) => &mut procedures.contact,
            ("boundary", _) => &mut procedures.external,
            _ => &mut procedures.integration,
        };
        *procedure += seconds;
    }
    procedures
}

/// What stands in a roofline: stages that compute, and a whole step where searches, which are not counted, are rare.
fn points(found: &Measurement, profile: &Profile, work: &Work, gpu: bool, mode: Mode) -> Vec<Point> {
    let steps = profile.steps as f64;
    let part = |name: &'static str, operations: Count| {
        let part = profile.parts.iter().find(|part| part.name == name)?;
        let point = Point {
            name: name.to_owned(),
            operations,
            bytes: part.bytes as f64 / steps,
            seconds: part.seconds / steps,
        };
        (point.operations.always > 0.0 && point.bytes > 0.0 && point.seconds > 0.0).then_some(point)
    };
    let stages = if gpu {
        // On a device a prediction begins with the correction of the step before, and contacts end with what is outside.
        let correct = profile.parts.iter().find(|part| part.name == "correct").map_or(0.0, |part| part.calls as f64);
        let correct = work.correct * (1.0 - correct / steps).max(0.0);
        vec![
            part("predict", work.predict + correct),
            part("bond", work.bond),
            part("contact", work.contact + work.boundary),
        ]
    } else {
        vec![
            part("predict", work.predict),
            part("bond", work.bond),
            part("contact", work.contact),
            part("boundary", work.boundary),
            part("correct", work.correct),
        ]
    };
    let whole = (mode == Mode::Best).then(|| Point {
        name: "step".to_owned(),
        operations: work.sum(),
        bytes: profile.bytes_per_step,
        seconds: found.step_seconds(),
    });
    stages.into_iter().flatten().chain(whole).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tdem_engine::Part;

    fn machine(device: Device, gpu: bool) -> Machine {
        Machine {
            device,
            word: "word".into(),
            name: "name".into(),
            driver: String::new(),
            gpu,
            threads: None,
            memory_bytes: None,
            copy_bytes_per_second: 0.0,
            operations_per_second: 0.0,
        }
    }

    #[test]
    fn each_model_is_measured_in_both_modes_with_the_hash_of_every_device() {
        let processor = Device::from(cpu::Options { threads: Some(2), ..cpu::Options::default() });
        let opencl = Device::Gpu { api: gpu::Api::OpenCl, index: 0 };
        for model in Model::ALL {
            for mode in Mode::ALL {
                let scene = Scene::build(model, Size::Small, mode).expect("the cases of this program are sound");
                let mut machine = machine(processor, false);
                // So short that one step is a measurement: it is not the numbers that are tested.
                let found = scene.measure(3, &mut machine, 1e-9).expect("it runs");
                assert_eq!((found.machine, found.steps, found.profiled_steps), (3, 1, 2));
                assert_eq!(found.searches > 0, mode == Mode::Paper, "{found:?}");
                assert_eq!(found.bonds > 0, model >= Model::BPM);
                assert!(machine.copy_bytes_per_second > 1e8 && found.cundall() > 1e3, "{found:?}");
                let bonds = found.procedures.bonds > 0.0;
                assert_eq!(bonds, model >= Model::BPM);
                assert!((found.procedures.shares().iter().sum::<f64>() - 1.0).abs() < 1e-12);
                assert_eq!(found.points.iter().any(|point| point.name == "step"), mode == Mode::Best);
                assert!(found.points.iter().all(|point| point.intensity() > 0.0 && point.rate() > 0.0), "{found:?}");
            }
        }
        // Devices are not asked for the same number of steps, but these are.
        let scene = Scene::build(Model::GNTM, Size::Small, Mode::Paper).expect("the cases of this program are sound");
        let hash = |device, gpu| scene.measure(0, &mut machine(device, gpu), 1e-9).expect("it runs").hash;
        assert_eq!(hash(processor, false), hash(opencl, true));
    }

    #[test]
    fn what_does_not_fit_is_told_before_it_is_run() {
        let scene = Scene::build(Model::TBPM, Size::Small, Mode::Paper).expect("the cases of this program are sound");
        for (device, gpu) in [(Device::default(), false), (Device::Gpu { api: gpu::Api::Cuda, index: 0 }, true)] {
            let with = |memory| scene.too_large(&Machine { memory_bytes: memory, ..machine(device, gpu) });
            assert_eq!((with(None), with(Some(1 << 30))), (None, None));
            let why = with(Some(1 << 20)).expect("a MiB is too little");
            assert!(why.contains("TBPM at size small, paper mode, needs about 0.0"), "{why}");
        }
    }

    #[test]
    fn kernels_and_stages_belong_to_the_procedures_of_the_paper() {
        let part = |stage, name, seconds| Part { stage, name, calls: 4, seconds, bytes: 8 };
        let profile = Profile {
            steps: 4,
            searches: 4,
            seconds: 100.0,
            parts: vec![
                part("predict", "predict", 4.0),
                part("correct", "correct", 8.0),
                part("search", "rows_fill", 16.0),
                part("search", "history_write", 20.0),
                part("contact", "contact", 24.0),
                part("gather", "gather", 4.0),
                part("bond", "bond", 32.0),
                part("boundary", "boundary", 36.0),
            ],
            bytes_per_step: 1.0,
        };
        assert_eq!(procedures(&profile).seconds(), [3.0, 4.0, 5.0, 7.0, 8.0, 9.0]);
    }
}
