//! `tdem bench --paper-figures`: the paper's figures 3 to 7 on this machine, beside what it prints.

use crate::codes;
use crate::console::{data, say};
use crate::device::{Choice, Found, word};
use crate::files;
use crate::machine::processor;
use crate::memory;
use crate::render::{Report, Reports};
use crate::units::{argument, clock, counted};
use clap::Args;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::available_parallelism;
use std::time::Instant;
use tdem_engine::{Device, cpu};
use tdem_studies::paper_figures::{Failure, Machine, Measured, Mode, Model, Record, Scene, Size, page, table};

pub(crate) const HELP: &str = "\
Examples:
  tdem bench --paper-figures                                               the best GPU and the CPU, or the CPU alone
  tdem bench --paper-figures --device cuda,cpu --sizes 88k,660k,1.4m,3m    all sizes of the paper
  tdem bench --paper-figures --device cpu --sizes small --models GN,GNTM   a quick look
  tdem bench --paper-figures --redraw                                      the page of measurements that are there

The paper's five models in its three applications, each as the paper computes (Gear's integrator, a search in every step) \
and as this program does by default; without a ledger. Its figures 3 to 7 are drawn from what was measured, with the paper's \
numbers beside it, on one page, index.html, that needs no other file; bench.json and table.md hold the numbers. The files \
are written after each measurement, so that Ctrl-C leaves what is complete.";

// Groups have the names of their structs unless they are told another.
#[derive(Args, Debug)]
#[group(id = "figures")]
pub(crate) struct Arguments {
    /// Draw the paper's figures 3 to 7 from measurements on this machine
    #[arg(long, required = true)]
    paper_figures: bool,
    /// Devices, separated by commas: auto, cpu, opencl, cuda, cuda:1; the first is compared with the paper, and with all
    /// others. "auto" is the best GPU and the CPU, or the CPU alone
    #[arg(long, value_delimiter = ',', default_value = "auto")]
    device: Vec<Choice>,
    /// Sizes, separated by commas: small, 88k, 660k, 1.4m, 3m [default: 88k,660k with a GPU, small,88k without]
    #[arg(long, value_name = "SIZE,...", value_delimiter = ',')]
    sizes: Vec<Size>,
    /// Sizes for the CPU beside a GPU [default: 88k if it is among the others, else the smallest]
    #[arg(long, value_name = "SIZE,...", value_delimiter = ',')]
    cpu_sizes: Vec<Size>,
    /// Models, separated by commas [default: GN,GNT,GNTM,BPM,TBPM]
    #[arg(long, value_name = "MODEL,...", value_delimiter = ',')]
    models: Vec<Model>,
    /// Numbers of threads of the CPU, separated by commas, each measured on its own [default: all cores, then one]
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Vec<u16>,
    /// About how long each measurement takes, s
    #[arg(long, value_name = "SECONDS", default_value_t = 2.0, value_parser = seconds)]
    seconds: f64,
    /// Folder for the page and the numbers
    #[arg(long, value_name = "DIR", default_value = "paper-figures")]
    out: PathBuf,
    /// Measure nothing: draw table and page again from the folder's bench.json
    #[arg(long, conflicts_with_all = ["device", "sizes", "cpu_sizes", "models", "threads", "seconds"])]
    redraw: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse::<f64>().ok().filter(|seconds| (1e-6..=600.0).contains(seconds));
    seconds.ok_or_else(|| "write a number of seconds, at most 600".to_owned())
}

/// What is measured: a size of a model on the machines of these places.
struct Task {
    size: Size,
    model: Model,
    machines: Vec<usize>,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    if arguments.redraw {
        return redraw(&arguments.out);
    }
    let start = Instant::now();
    fs::create_dir_all(&arguments.out).map_err(|error| files::refused(&arguments.out, &error))?;
    for name in ["bench.json", "table.md", "index.html"] {
        files::try_to_write(&arguments.out.join(name))?;
    }
    let machines = machines(arguments)?;
    let tasks = tasks(arguments, &machines);
    let planned = tasks.iter().map(|task| Mode::ALL.len() * task.machines.len()).sum();
    let mut record = Record::new(env!("CARGO_PKG_VERSION"), command(arguments), machines, planned);
    for task in &tasks {
        for mode in Mode::ALL {
            measure(task, mode, arguments, &mut record)?;
        }
    }
    write(&arguments.out, &record)?;
    data(table(&record))?;
    say(format!(
        "{} in {}: {}",
        counted(record.measurements.len() as u64, "measurement"),
        clock(start.elapsed()),
        argument(&arguments.out.join("index.html"))
    ));
    Ok(ExitCode::SUCCESS)
}

/// Draws again what was measured before.
fn redraw(folder: &Path) -> Result<ExitCode, Reports> {
    let path = folder.join("bench.json");
    let text = fs::read_to_string(&path).map_err(|error| {
        Report::new(codes::BENCH_RECORD, format!("cannot read {}: {error}", argument(&path)))
            .help("`--out` says in which folder the measurements are")
    })?;
    let record = Record::read(&text).map_err(|error| {
        Report::new(codes::BENCH_RECORD, format!("{} is not of this benchmark: {error}", argument(&path)))
    })?;
    draw(folder, &record)?;
    data(table(&record))?;
    Ok(ExitCode::SUCCESS)
}

/// One scene on all its machines.
fn measure(task: &Task, mode: Mode, arguments: &Arguments, record: &mut Record) -> Result<(), Reports> {
    let scene = Scene::build(task.model, task.size, mode).map_err(told)?;
    for &place in &task.machines {
        let count = record.measurements.len() + record.left_out.len() + 1;
        let machine = &mut record.machines[place];
        if let Some(why) = scene.too_large(machine) {
            say(format!("left out: {why}"));
            record.left_out.push(why);
            continue;
        }
        let found = scene.measure(place, machine, arguments.seconds).map_err(told)?;
        say(line(&found, &record.machines[place], count, record.planned));
        record.measurements.push(found);
        write(&arguments.out, record)?;
    }
    Ok(())
}

/// A measurement on one line.
fn line(found: &Measured, machine: &Machine, count: usize, planned: usize) -> String {
    format!(
        "{count:>3}/{planned}  {:<5} {:<5} {:<6} {:<10}  {:>9} particles  {:>10.3} ms/step  {:.3e} particle-steps/s",
        found.model,
        found.size,
        found.mode,
        machine.word,
        found.particles,
        1e3 * found.seconds_per_step,
        found.cundall()
    )
}

fn told(failure: Failure) -> Reports {
    match failure {
        Failure::Case { problems, .. } => problems.into(),
        Failure::Fault { .. } => Report::new(codes::BENCH_FAULT, format!("the benchmark broke: {failure}")).into(),
    }
}

fn write(folder: &Path, record: &Record) -> Result<(), Reports> {
    let json = record.json().map_err(|error| {
        Report::new(codes::BENCH_JSON, format!("the measurements cannot be written as JSON: {error}"))
    })?;
    files::write(&folder.join("bench.json"), json.as_bytes())?;
    draw(folder, record)
}

fn draw(folder: &Path, record: &Record) -> Result<(), Reports> {
    files::write(&folder.join("table.md"), table(record).as_bytes())?;
    files::write(&folder.join("index.html"), page(record).as_bytes())
}

/// The devices that were asked for, with what they can do at most.
fn machines(arguments: &Arguments) -> Result<Vec<Machine>, Reports> {
    let mut devices: Vec<Found> = Vec::new();
    for &choice in &arguments.device {
        let found = choice.find(cpu::Options::default())?;
        let gpu = found.listing.is_some();
        if gpu {
            devices.push(found);
        }
        if !gpu || choice == Choice::Auto {
            for threads in threads(arguments) {
                devices.push(Choice::Cpu.find(cpu::Options { threads: Some(threads), ..cpu::Options::default() })?);
            }
        }
    }
    let mut machines: Vec<Machine> = Vec::new();
    for found in &devices {
        if machines.iter().all(|known| known.device != found.device) {
            machines.push(machine(found)?);
        }
    }
    Ok(machines)
}

/// With how many threads the CPU is measured.
fn threads(arguments: &Arguments) -> Vec<usize> {
    if arguments.threads.is_empty() {
        vec![available_parallelism().map_or(1, usize::from), 1]
    } else {
        arguments.threads.iter().copied().map(usize::from).collect()
    }
}

fn machine(found: &Found) -> Result<Machine, Reports> {
    let threads = match found.device {
        Device::Cpu(options) => options.threads,
        Device::Gpu { .. } => None,
    };
    let operations_per_second = found.device.arithmetic_rate().map_err(|fault| {
        Report::new(codes::BENCH_FAULT, format!("{}: arithmetic cannot be measured: {fault}", found.name))
    })?;
    Ok(Machine {
        device: found.device,
        word: match (&found.listing, threads) {
            (Some(listing), _) => word(listing.api).to_owned(),
            (None, threads) => counted(threads.unwrap_or(1) as u64, "thread"),
        },
        name: found.listing.as_ref().map_or_else(processor, |_| found.name.clone()),
        driver: match &found.listing {
            Some(listing) => listing.driver.clone(),
            None => found.name.trim_start_matches("CPU, ").to_owned(),
        },
        gpu: found.listing.is_some(),
        threads,
        memory_bytes: found.listing.as_ref().map_or_else(memory::free, |listing| Some(listing.memory)),
        copy_bytes_per_second: 0.0,
        operations_per_second,
    })
}

/// Sizes from the smallest to the largest, and in each all models: what ends early has complete sizes.
fn tasks(arguments: &Arguments, machines: &[Machine]) -> Vec<Task> {
    let gpu = machines.iter().any(|machine| machine.gpu);
    let mut sizes = arguments.sizes.clone();
    if sizes.is_empty() {
        sizes = if gpu { vec![Size::K88, Size::K660] } else { vec![Size::Small, Size::K88] };
    }
    sizes.sort_unstable();
    sizes.dedup();
    let mut of_cpu = arguments.cpu_sizes.clone();
    if of_cpu.is_empty() {
        of_cpu = match (gpu, sizes.contains(&Size::K88)) {
            (false, _) => sizes.clone(),
            (true, true) => vec![Size::K88],
            (true, false) => sizes[..1].to_vec(),
        };
    }
    let mut all = [&sizes[..], &of_cpu].concat();
    all.sort_unstable();
    all.dedup();
    let mut models = if arguments.models.is_empty() { Model::ALL.to_vec() } else { arguments.models.clone() };
    models.sort_unstable();
    models.dedup();
    let on = |size: Size| -> Vec<usize> {
        let wanted = |machine: &Machine| if machine.gpu { &sizes } else { &of_cpu }.contains(&size);
        (0..machines.len()).filter(|&place| wanted(&machines[place])).collect()
    };
    let of = |size: Size| {
        let models = models.clone();
        models.into_iter().map(move |model| (size, model))
    };
    all.into_iter().flat_map(of).map(|(size, model)| Task { size, model, machines: on(size) }).collect()
}

/// What makes the page again.
fn command(arguments: &Arguments) -> String {
    let mut text = "tdem bench --paper-figures".to_owned();
    let mut add = |name: &str, values: Vec<String>| {
        if !values.is_empty() {
            let _ = write!(text, " --{name} {}", values.join(","));
        }
    };
    let devices = arguments.device.iter().map(|choice| match choice {
        Choice::Auto => "auto".to_owned(),
        Choice::Cpu => "cpu".to_owned(),
        Choice::Gpu(api, None) => word(*api).to_owned(),
        Choice::Gpu(api, Some(index)) => format!("{}:{index}", word(*api)),
    });
    add("device", devices.collect());
    add("sizes", arguments.sizes.iter().map(Size::to_string).collect());
    add("cpu-sizes", arguments.cpu_sizes.iter().map(Size::to_string).collect());
    add("models", arguments.models.iter().map(Model::to_string).collect());
    add("threads", arguments.threads.iter().map(u16::to_string).collect());
    add("seconds", vec![arguments.seconds.to_string()]);
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use tdem_engine::gpu::Api;

    fn machines(gpu: bool) -> Vec<Machine> {
        let machine = |gpu: bool| Machine {
            device: if gpu { Device::Gpu { api: Api::Cuda, index: 0 } } else { Device::default() },
            word: String::new(),
            name: String::new(),
            driver: String::new(),
            gpu,
            threads: None,
            memory_bytes: None,
            copy_bytes_per_second: 0.0,
            operations_per_second: 0.0,
        };
        if gpu { vec![machine(true), machine(false)] } else { vec![machine(false)] }
    }

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        arguments: Arguments,
    }

    fn arguments(given: &str) -> Arguments {
        Line::parse_from(["bench", "--paper-figures"].into_iter().chain(given.split_whitespace())).arguments
    }

    /// Sizes, and on how many machines.
    fn shown(tasks: &[Task]) -> Vec<(String, usize)> {
        tasks.iter().map(|task| (format!("{} {}", task.size, task.model), task.machines.len())).collect()
    }

    #[test]
    fn sizes_follow_the_devices() {
        let gn = |given: &str, gpu| shown(&tasks(&arguments(&format!("--models GN {given}")), &machines(gpu)));
        let of = |sizes: &[(&str, usize)]| -> Vec<(String, usize)> {
            sizes.iter().map(|(size, count)| (format!("{size} GN"), *count)).collect()
        };
        assert_eq!(gn("", true), of(&[("88k", 2), ("660k", 1)]));
        assert_eq!(gn("", false), of(&[("small", 1), ("88k", 1)]));
        assert_eq!(gn("--sizes 3m,660k", true), of(&[("660k", 2), ("3m", 1)]));
        assert_eq!(gn("--sizes 88k --cpu-sizes small", true), of(&[("small", 1), ("88k", 1)]));
        assert_eq!(tasks(&arguments(""), &machines(true)).len(), 10);
    }

    #[test]
    fn the_command_makes_the_same_again() {
        let given = "--device cuda:1,cpu --sizes 88k,3m --cpu-sizes small --models GN,TBPM --threads 3,1 --seconds 0.5";
        let text = command(&arguments(given));
        assert_eq!(text, format!("tdem bench --paper-figures {given}"));
    }
}
