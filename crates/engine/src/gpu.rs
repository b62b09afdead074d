//! GPUs through OpenCL and CUDA: one dialect of kernels, and one trait with a runtime for each interface behind it.

mod arithmetic;
mod bodies;
mod bonds;
mod cuda;
mod devices;
mod fault;
mod heat;
mod kernel_cache;
mod layout;
mod memory;
mod network;
mod opencl;
mod pool;
mod profile;
mod program;
mod run;
mod runtime;
mod search;
mod self_test;
mod snapshot;
#[cfg(test)]
mod tests;
mod traffic;

pub use devices::{Api, Listing, Survey, devices, survey};
pub use runtime::Error;

/// What precedes the source of every kernel: the dialect, for both compilers.
const PRELUDE: &str = include_str!("gpu/kernels/prelude.cl");

use crate::network::Field;
use crate::staggered::without_heat;
use crate::step::Backend;
use crate::{Capture, Fault, HeatPlan, Motion, Plan, Profile, State};
use network::Conducting;
use program::Program;
use run::Gpu;
use runtime::Runtime;

/// All that a device's compiler is given for a run from this state: the dialect, the printed laws, the kernels. Where heat
/// advances by itself, its kernels follow, which are a program of their own.
#[must_use]
pub fn source(state: &State, plan: &Plan) -> String {
    if plan.heat.as_ref().is_some_and(|heat| heat.motion.takes_turns()) {
        let motion = program::Variant::of(&without_heat(plan), state);
        return format!("{PRELUDE}\n{}\n// Heat by itself.\n\n{}", motion.source(), network::Alone.source());
    }
    format!("{PRELUDE}\n{}", program::Variant::of(plan, state).source())
}

/// How many bytes a run will hold on a device, all arrays together but for those of walls, with so many pairs in its list,
/// all of which touch, and so many bonds; [`crate::Simulation::bytes`] tells it of a run that is there. Where nothing moves,
/// forces are found before there is heat: the larger of both counts.
#[must_use]
pub fn bytes(plan: &Plan, particles: usize, pairs: usize, bonds: usize) -> usize {
    let Some(heat) = plan.heat.as_ref().filter(|heat| heat.motion.takes_turns()) else {
        return bytes_of_motion(plan, particles, pairs, bonds);
    };
    let [each, end] = network::bytes_each(plan, heat);
    let alone = particles * each + 2 * (pairs + bonds) * end;
    let motion = bytes_of_motion(&without_heat(plan), particles, pairs, bonds);
    match heat.motion {
        Motion::QuasiStatic(_) => alone + motion,
        Motion::Frozen(_) | Motion::Stepped => alone.max(motion),
    }
}

/// The same of what moves, and of heat that goes along with it.
fn bytes_of_motion(plan: &Plan, particles: usize, pairs: usize, bonds: usize) -> usize {
    let [row, slot, kept] = search::bytes_each(plan);
    let [bonded, bond] = bonds::bytes_each(plan);
    let [warm, _] = heat::bytes_each(plan);
    particles * (bodies::bytes_each(plan) + row + bonded + warm) + pairs * (2 * slot + kept) + bonds * bond
}

/// A back end on a device that holds a validated state.
pub(crate) fn open(api: Api, index: usize, state: State, plan: &Plan) -> Result<Box<dyn Backend>, Fault> {
    Ok(match api {
        Api::OpenCl => Box::new(Gpu::new(devices::open_opencl(index)?, state, plan)?),
        Api::Cuda => Box::new(Gpu::new(devices::open_cuda(index)?, state, plan)?),
    })
}

/// Room on a device for the temperatures of a validated state whose heat advances by itself.
pub(crate) fn open_field(
    api: Api,
    index: usize,
    state: &State,
    plan: &Plan,
    heat: &HeatPlan,
) -> Result<Box<dyn Field>, Fault> {
    Ok(match api {
        Api::OpenCl => Box::new(Conducting::new(devices::open_opencl(index)?, state, plan, heat)?),
        Api::Cuda => Box::new(Conducting::new(devices::open_cuda(index)?, state, plan, heat)?),
    })
}

/// How many additions and multiplications in 64 bits a device makes in a second.
pub(crate) fn arithmetic_rate(api: Api, index: usize) -> Result<f64, Fault> {
    Ok(match api {
        Api::OpenCl => arithmetic::rate(devices::open_opencl(index)?)?,
        Api::Cuda => arithmetic::rate(devices::open_cuda(index)?)?,
    })
}

impl<R: Runtime> Backend for Gpu<R> {
    fn advance(&mut self, steps: u64) -> Result<(), Fault> {
        self.advance_all(steps)
    }
    fn prepare(&mut self) -> Result<(), Fault> {
        self.prepare_all()
    }
    fn capture(&mut self) -> Result<Capture, Fault> {
        Ok(Capture::new(self.capture_all()?))
    }
    fn bytes(&self) -> usize {
        self.queue.bytes()
    }
    fn profile(&mut self, steps: u64) -> Result<Profile, Fault> {
        self.profile_all(steps)
    }
    fn copy_bandwidth(&self) -> Result<f64, Fault> {
        Ok(self.queue.copy_bandwidth()?)
    }
    fn searches(&self) -> u64 {
        self.searches
    }
}
