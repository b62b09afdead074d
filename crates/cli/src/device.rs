//! Which device the command line asks for.

use crate::machine::instructions;
use crate::render::{Report, Reports};
use crate::units::counted;
use std::str::FromStr;
use std::thread::available_parallelism;
use tdem_engine::gpu::{Api, Listing, survey};
use tdem_engine::{Device, cpu};

/// What was asked for: `auto`, `cpu`, `opencl`, `cuda:1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Choice {
    /// The fastest that can be used.
    Auto,
    /// The processor.
    Cpu,
    /// The device of this index, or the first that can be used.
    Gpu(Api, Option<usize>),
}

impl FromStr for Choice {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let (name, index) = match text.split_once(':') {
            None => (text, None),
            Some((name, index)) => {
                let index = index.parse().map_err(|_| format!("{index:?} is not the number of a device"))?;
                (name, Some(index))
            }
        };
        match (name, index) {
            ("auto", None) => Ok(Choice::Auto),
            ("cpu", None) => Ok(Choice::Cpu),
            ("opencl", index) => Ok(Choice::Gpu(Api::OpenCl, index)),
            ("cuda", index) => Ok(Choice::Gpu(Api::Cuda, index)),
            _ => Err("write auto, cpu, opencl or cuda, and the number of the device behind a colon if there are \
                      several: cuda:1"
                .to_owned()),
        }
    }
}

/// How an interface is called on the command line.
pub(crate) fn word(api: Api) -> &'static str {
    match api {
        Api::OpenCl => "opencl",
        Api::Cuda => "cuda",
    }
}

/// A device that can be used, and how it is called.
pub(crate) struct Found {
    pub(crate) device: Device,
    pub(crate) name: String,
}

impl Choice {
    /// Finds the device; `options` are for the processor.
    pub(crate) fn find(self, options: cpu::Options) -> Result<Found, Reports> {
        let processor = Found { device: options.into(), name: processor(&options) };
        match self {
            Choice::Cpu => Ok(processor),
            Choice::Auto => {
                let mut usable: Vec<Listing> =
                    survey().devices.into_iter().filter(|d| d.usable.is_ok() && !d.processor).collect();
                // Both interfaces show the same cards; CUDA is a little faster.
                usable.sort_by_key(|d| d.api != Api::Cuda);
                Ok(usable.into_iter().next().map_or(processor, found))
            }
            Choice::Gpu(api, index) => {
                let survey = survey();
                let mut candidates =
                    survey.devices.into_iter().filter(|d| d.api == api && index.is_none_or(|index| d.index == index));
                let mut refused = Vec::new();
                candidates
                    .find_map(|d| match &d.usable {
                        Ok(()) => Some(found(d)),
                        Err(why) => {
                            refused.push(format!("{}: {why}", d.name));
                            None
                        }
                    })
                    .ok_or_else(|| {
                        refused.extend(survey.missing.into_iter().filter(|m| m.0 == api).map(|(_, why)| why));
                        let why =
                            if refused.is_empty() { "there is no such device".to_owned() } else { refused.join("\n") };
                        Report::new("tdem::device::missing", format!("{api} cannot be used: {why}"))
                            .help("`tdem info` lists the devices; --device cpu always works")
                            .into()
                    })
            }
        }
    }
}

fn processor(options: &cpu::Options) -> String {
    let threads = options.threads.unwrap_or_else(|| available_parallelism().map_or(1, usize::from));
    let width = if options.width == cpu::Width::One { "one contact at a time" } else { instructions() };
    format!("CPU, {}, {width}", counted(threads as u64, "thread"))
}

fn found(listing: Listing) -> Found {
    Found {
        device: Device::Gpu { api: listing.api, index: listing.index },
        name: format!("{} through {}", listing.name, listing.api),
    }
}
