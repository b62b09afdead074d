//! On what a run is computed.

use crate::codes;
use crate::device::{Choice, Found};
use crate::render::{Report, Reports};
use clap::{Args, ValueEnum};
use tdem_engine::cpu;

/// Choices that change the speed of a run, and no bit of its result.
#[derive(Args, Debug)]
#[command(next_help_heading = "Machine (no bit of the result depends on it)")]
pub(crate) struct Machine {
    /// What computes: auto, cpu, opencl, cuda, or one of several: cuda:1; "auto" takes a GPU that can be used, else the CPU
    #[arg(long, value_name = "DEVICE", default_value = "auto")]
    device: Choice,
    /// Threads of the CPU [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// On the CPU, compute contacts one by one instead of eight at a time: slower, for comparison
    #[arg(long)]
    scalar: bool,
    /// On the CPU, list each pair once, or from both sides: slower, for comparison
    #[arg(long, value_enum, default_value_t = List::Half)]
    list: List,
}

/// How pairs are listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum List {
    /// Each pair once
    Half,
    /// Each pair from both sides
    Full,
}

impl Machine {
    /// Lets everything in this process use the threads asked for, not only the engine.
    pub(crate) fn prepare(&self) -> Result<(), Reports> {
        let threads = usize::from(self.threads.unwrap_or(0));
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().map_err(|error| {
            Report::new(codes::CLI_THREADS, format!("cannot start the threads: {error}"))
                .help("ask for fewer, --threads 1")
                .into()
        })
    }

    /// The device asked for.
    pub(crate) fn find(&self) -> Result<Found, Reports> {
        let options = cpu::Options {
            threads: self.threads.map(usize::from),
            width: width(self.scalar),
            list: if self.list == List::Half { cpu::List::Half } else { cpu::List::Full },
            ..cpu::Options::default()
        };
        self.device.find(options)
    }
}

/// Contacts at a time.
pub(crate) fn width(scalar: bool) -> cpu::Width {
    if scalar { cpu::Width::One } else { cpu::Width::Widest }
}

/// The widest instruction set that the engine uses here.
pub(crate) fn instructions() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
        {
            return "AVX-512";
        }
        if is_x86_feature_detected!("avx2") {
            return "AVX2";
        }
    }
    "no vector instructions beyond the platform's own"
}

/// The processor's name, where the system tells it.
pub(crate) fn processor() -> String {
    std::fs::read_to_string("/proc/cpuinfo")
        .ok()
        .and_then(|text| {
            let line = text.lines().find(|line| line.starts_with("model name"))?;
            Some(line.split_once(':')?.1.trim().to_owned())
        })
        .unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}
