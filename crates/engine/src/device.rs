//! What a simulation runs on.

use crate::staggered::Staggered;
use crate::step::Backend;
use crate::{Fault, Plan, State, cpu, gpu};

/// What a simulation runs on. The choice does not change a bit of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Device {
    /// The processor.
    Cpu(cpu::Options),
    /// A device of an interface for GPUs, by its place in [`gpu::devices`].
    Gpu {
        /// The interface.
        api: gpu::Api,
        /// The device's index within the interface.
        index: usize,
    },
}

impl Default for Device {
    fn default() -> Self {
        Device::Cpu(cpu::Options::default())
    }
}

impl From<cpu::Options> for Device {
    fn from(options: cpu::Options) -> Self {
        Device::Cpu(options)
    }
}
impl From<&cpu::Options> for Device {
    fn from(options: &cpu::Options) -> Self {
        Device::Cpu(*options)
    }
}
impl From<&Device> for Device {
    fn from(device: &Device) -> Self {
        *device
    }
}

impl Device {
    /// How many additions and multiplications in 64 bits the device makes in a second, where nothing waits for memory: the
    /// best of several measurements of chains $x \leftarrow a x + b$, rounded twice as all laws are, never fused. On the CPU
    /// all its threads take part.
    ///
    /// # Errors
    /// [`Fault::Device`] if the device cannot be used, [`Fault::Threads`] if threads cannot be started.
    pub fn arithmetic_rate(&self) -> Result<f64, Fault> {
        match *self {
            Device::Cpu(options) => cpu::arithmetic_rate(&options),
            Device::Gpu { api, index } => gpu::arithmetic_rate(api, index),
        }
    }

    /// A back end that holds the state.
    pub(crate) fn open(self, state: State, plan: &Plan) -> Result<Box<dyn Backend>, Fault> {
        if plan.heat.as_ref().is_some_and(|heat| heat.motion.takes_turns()) {
            return Ok(Box::new(Staggered::open(self, state, plan)?));
        }
        match self {
            Device::Cpu(options) => Ok(Box::new(cpu::Cpu::new(state, plan, &options)?)),
            Device::Gpu { api, index } => gpu::open(api, index, state, plan),
        }
    }
}
