//! Which device the command line asks for.

use crate::codes;
use crate::machine::instructions;
use crate::render::{Report, Reports};
use crate::units::counted;
use std::cmp::Reverse;
use std::str::FromStr;
use std::thread::available_parallelism;
use tdem_engine::gpu::{Api, Listing, Survey};
use tdem_engine::{Device, cpu};

/// What was asked for: `auto`, `cpu`, `opencl`, `cuda:1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Choice {
    /// The best GPU that can be used, CUDA's before OpenCL's, else the processor.
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
    /// What its interface tells of it; nothing of the processor.
    pub(crate) listing: Option<Listing>,
}

impl Found {
    /// What it is, for whoever reads of a run on another machine.
    pub(crate) fn in_full(&self) -> String {
        if self.listing.is_some() {
            self.name.clone()
        } else {
            format!("{} ({})", self.name, crate::machine::processor())
        }
    }
}

impl Choice {
    /// Finds the device; `options` are for the processor.
    pub(crate) fn find(self, options: cpu::Options) -> Result<Found, Reports> {
        let processor = || Found { device: options.into(), name: processor(&options), listing: None };
        match self {
            Choice::Cpu => Ok(processor()),
            Choice::Auto => {
                Ok([Api::Cuda, Api::OpenCl].into_iter().find_map(best).map_or_else(processor, |best| found(&best)))
            }
            Choice::Gpu(api, index) => {
                let survey = Survey::of(api, |device| index.is_none_or(|index| device.index == index));
                let usable = survey.devices.iter().find(|device| device.usable.is_ok()).map(found);
                usable.ok_or_else(|| refusal(api, index, survey).into())
            }
        }
    }
}

/// Both interfaces show the same cards; CUDA is a little faster, and lists the fastest first. Of OpenCL, the card with the
/// most memory is taken, the first of several.
fn best(api: Api) -> Option<Listing> {
    let usable = Survey::of(api, |device| !device.processor).devices.into_iter().filter(|device| device.usable.is_ok());
    match api {
        Api::Cuda => usable.min_by_key(|device| device.index),
        Api::OpenCl => usable.min_by_key(|device| (Reverse(device.memory), device.index)),
    }
}

fn processor(options: &cpu::Options) -> String {
    let threads = options.threads.unwrap_or_else(|| available_parallelism().map_or(1, usize::from));
    let width = if options.width == cpu::Width::One { "one contact at a time" } else { instructions() };
    format!("CPU, {}, {width}", counted(threads as u64, "thread"))
}

fn found(listing: &Listing) -> Found {
    Found {
        device: Device::Gpu { api: listing.api, index: listing.index },
        name: format!("{} through {}", listing.name, listing.api),
        listing: Some(listing.clone()),
    }
}

/// Why there is no such device.
fn refusal(api: Api, index: Option<usize>, survey: Survey) -> Report {
    let refused = survey.devices.into_iter().filter_map(|device| {
        let why = device.usable.err()?;
        Some(format!("{}:{} ({}) cannot be used: {why}", word(api), device.index, device.name))
    });
    let missing = survey.missing.into_iter().map(|(api, why)| format!("{api} cannot be used: {why}"));
    let mut reasons: Vec<String> = refused.chain(missing).collect();
    if let (true, Some(index)) = (reasons.is_empty(), index) {
        reasons.push(format!("there is no device {}:{index}", word(api)));
    }
    Report::new(codes::DEVICE_MISSING, reasons.join("\n"))
        .help("`tdem info` lists the devices that there are; --device cpu works everywhere, with the same bits")
}
