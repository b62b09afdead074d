//! The GPUs of this machine, and whether they can be used.

use super::cuda::Cuda;
use super::opencl::OpenCl;
use super::runtime::{Error, Runtime};
use super::self_test::check_contraction;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Mutex, PoisonError};

/// A programming interface of GPUs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Api {
    /// Any vendor; on a CPU through PoCL.
    OpenCl,
    /// NVIDIA.
    Cuda,
}

impl fmt::Display for Api {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Api::OpenCl => "OpenCL",
            Api::Cuda => "CUDA",
        })
    }
}

/// A device as one interface shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Listing {
    /// The interface.
    pub api: Api,
    /// Its number within the interface, from 0.
    pub index: usize,
    /// What the vendor calls it.
    pub name: String,
    /// Name and version of the driver.
    pub driver: String,
    /// Memory, bytes.
    pub memory: u64,
    /// Whether it computes with 64-bit reals.
    pub fp64: bool,
    /// Whether it is a processor that is shown as a device.
    pub processor: bool,
    /// Multiprocessors, or what the vendor counts as such.
    pub compute_units: u32,
    /// Whether `tdem` can use it, else why not.
    pub usable: Result<(), String>,
}

/// All devices, and the interfaces that have none.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// Devices, interface by interface.
    pub devices: Vec<Listing>,
    /// Interfaces that cannot be used at all, and why.
    pub missing: Vec<(Api, String)>,
}

/// The devices of all interfaces. Each one runs the self-test.
#[must_use]
pub fn devices() -> Vec<Listing> {
    survey().devices
}

/// The devices of all interfaces, and why an interface has none. Each device runs the self-test.
#[must_use]
pub fn survey() -> Survey {
    let mut all = Survey::of(Api::OpenCl, |_| true);
    let cuda = Survey::of(Api::Cuda, |_| true);
    all.devices.extend(cuda.devices);
    all.missing.extend(cuda.missing);
    all
}

impl Survey {
    /// The devices of one interface. Those that are wanted run the self-test, the others are left out.
    #[must_use]
    pub fn of(api: Api, wanted: impl Fn(&Listing) -> bool) -> Self {
        let list = match api {
            Api::OpenCl => OpenCl::list(),
            Api::Cuda => Cuda::list(),
        };
        let open = |index| match api {
            Api::OpenCl => open_opencl(index).map(drop),
            Api::Cuda => open_cuda(index).map(drop),
        };
        match list {
            Ok(mut devices) => {
                devices.retain(wanted);
                for device in &mut devices {
                    device.usable = open(device.index).map_err(|error| error.to_string());
                }
                Survey { devices, missing: Vec::new() }
            }
            Err(error) => Survey { devices: Vec::new(), missing: vec![(api, error.to_string())] },
        }
    }
}

/// An OpenCL device that passed the self-test.
pub(crate) fn open_opencl(index: usize) -> Result<OpenCl, Error> {
    tested(Api::OpenCl, index, OpenCl::open(index)?)
}

/// A CUDA device that passed the self-test.
pub(crate) fn open_cuda(index: usize) -> Result<Cuda, Error> {
    tested(Api::Cuda, index, Cuda::open(index)?)
}

/// Tests a device once per process: a self-test is compiled, which takes longer than many a run.
fn tested<R: Runtime>(api: Api, index: usize, runtime: R) -> Result<R, Error> {
    static VERDICTS: Mutex<BTreeMap<(Api, usize), bool>> = Mutex::new(BTreeMap::new());
    let verdicts = || VERDICTS.lock().unwrap_or_else(PoisonError::into_inner);
    let known = verdicts().get(&(api, index)).copied();
    let exact = if let Some(exact) = known {
        exact
    } else {
        // A test that fails to run is no verdict, and not remembered.
        let exact = check_contraction(&runtime)?;
        verdicts().insert((api, index), exact);
        exact
    };
    if exact {
        Ok(runtime)
    } else {
        let why = "the device fuses multiply and add, or rounds in its own way: results would not have the CPU's bits";
        Err(Error::Missing { why: why.to_owned() })
    }
}
