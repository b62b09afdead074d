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
