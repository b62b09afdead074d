//! `tdem info`: this machine, or a run.

use crate::console::data;
use crate::device::word;
use crate::json::{self, Json};
use crate::machine::instructions;
use crate::render::Reports;
use crate::units::{self, argument, bytes, counted, entry, grouped, short};
use clap::Args;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::available_parallelism;
use tdem_engine::gpu::survey;

#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The directory of a run; without it, the devices of this machine are shown
    #[arg(value_name = "DIR")]
    run: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) json: Json,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    if arguments.json.json {
        json::print("info", arguments.run.as_deref().map_or_else(|| Ok(machine_for_programs()), run_for_programs)?)?;
        return Ok(ExitCode::SUCCESS);
    }
    match &arguments.run {
        Some(run) => data(of_run(run)?.trim_end())?,
        None => data(of_machine().trim_end())?,
    }
    Ok(ExitCode::SUCCESS)
}

/// Frames that are named although they cannot be read; of more only the number is told.
const SHOWN: usize = 20;

/// A new line of what stands in the second column.
const INDENT: &str = "\n                 ";

fn of_machine() -> String {
    let cores = available_parallelism().map_or(1, usize::from) as u64;
    let mut text = format!("tdem {}\n", env!("TDEM_VERSION"))
        + &entry("cpu", format!("{}, {}: can be used", counted(cores, "core"), instructions()));
    let survey = survey();
    for device in &survey.devices {
        let name = format!("{}:{}", word(device.api), device.index);
        let kind = if device.processor { ", a processor: taken only if asked for" } else { "" };
        text += &entry(&name, format!("{}{kind}", device.name));
        text += &entry(
            "",
            format!(
                "{}, {}, {}, {}",
                device.driver,
                bytes(device.memory),
                counted(u64::from(device.compute_units), "compute unit"),
                if device.fp64 { "double precision" } else { "no double precision" }
            ),
        );
        text += &entry(
            "",
            match &device.usable {
                Ok(()) => "self-test passed, the bits of the CPU: can be used".to_owned(),
                Err(why) => format!("cannot be used: {}", why.replace('\n', INDENT)),
            },
        );
    }
    for (api, why) in &survey.missing {
        text += &entry(word(*api), format!("none: {why}"));
    }
    text
}

/// This machine for programs.
fn machine_for_programs() -> Value {
    let survey = survey();
    let devices = survey.devices.iter().map(|device| {
        json!({
            "device": format!("{}:{}", word(device.api), device.index),
            "name": device.name,
            "driver": device.driver,
            "memory_bytes": device.memory,
            "compute_units": device.compute_units,
            "double_precision": device.fp64,
            "processor": device.processor,
            "usable": device.usable.is_ok(),
            "why_not": device.usable.as_ref().err(),
        })
    });
    let missing = survey.missing.iter().map(|(api, why)| json!({ "interface": word(*api), "why": why }));
    json!({
        "ok": true,
        "cores": available_parallelism().map_or(1, usize::from),
        "instructions": instructions(),
        "devices": devices.collect::<Value>(),
        "missing": missing.collect::<Value>(),
    })
}

/// A run for programs.
fn run_for_programs(run: &Path) -> Result<Value, Reports> {
    let info = tdem_results::info(run)?;
    let frames = info.frames.iter().map(
        |frame| json!({ "step": frame.step, "time": frame.time, "particles": frame.particles, "file": frame.path.to_string_lossy() }),
    );
    let checkpoints = info.checkpoints.iter().map(|checkpoint| {
        json!({
            "step": checkpoint.step,
            "particles": checkpoint.particles.as_ref().ok(),
            "damage": checkpoint.particles.as_ref().err().map(ToString::to_string),
            "file": checkpoint.path.to_string_lossy(),
        })
    });
    let case = tdem_case::load(&run.join("case.toml"), &[]).ok().map(|loaded| loaded.case);
    Ok(json!({
        "ok": true,
        "run": run.to_string_lossy(),
        "title": case.as_ref().map(|case| case.title.clone()),
        "model": case.as_ref().map(|case| format!("{:?}", case.model)),
        "frames": frames.collect::<Value>(),
        "unreadable_frames": info.unreadable_frames.iter().map(ToString::to_string).collect::<Value>(),
        "blocks": info.blocks,
        "history_rows": info.history_rows,
        "checkpoints": checkpoints.collect::<Value>(),
        "bytes": info.bytes,
    }))
}

fn of_run(run: &Path) -> Result<String, Reports> {
    let info = tdem_results::info(run)?;
    let mut text = format!("{}\n", argument(run));
    // A case that cannot be read any more does not hide what the run holds.
    match tdem_case::load(&run.join("case.toml"), &[]) {
        Ok(loaded) => {
            let case = &loaded.case;
            let end = short(case.time.end.get());
            text += &entry("case", format!("{}, model {:?}, {end} s", title(&case.title), case.model));
        }
        Err(_) => text += &entry("case", "cannot be read; `tdem check` on its case.toml says why"),
    }
    let frames = info.frames.len() as u64;
    text += &entry(
        "frames",
        match (info.frames.first(), info.frames.last()) {
            (Some(first), Some(last)) => format!(
                "{}, t = {} s to {} s, {}",
                grouped(frames),
                short(first.time),
                short(last.time),
                counted(last.particles as u64, "particle")
            ),
            _ => "none".to_owned(),
        },
    );
    for unreadable in info.unreadable_frames.iter().take(SHOWN) {
        text += &entry("", format!("unreadable: {unreadable}"));
    }
    if let more @ 1.. = info.unreadable_frames.len().saturating_sub(SHOWN) {
        text += &entry("", format!("and {} more", grouped(more as u64)));
    }
    if !info.blocks.is_empty() {
        let masters: Vec<String> = info.blocks.iter().map(|block| format!("{block}.vtkhdf")).collect();
        text += &entry("ParaView", masters.join(", "));
        text += &entry(
            "",
            match info.complete {
                Some(true) => "each of these files can be sent by itself".to_owned(),
                _ => format!(
                    "an index: the numbers are in frames/; `tdem pack {}` makes files that can be sent",
                    argument(run)
                ),
            },
        );
    }
    text += &entry("history.csv", counted(info.history_rows as u64, "row"));
    for (index, checkpoint) in info.checkpoints.iter().enumerate() {
        let state = match &checkpoint.particles {
            Ok(particles) => counted(*particles as u64, "particle"),
            Err(damage) => format!("cannot be used, {damage}"),
        };
        let name = if index == 0 { "checkpoints" } else { "" };
        text += &entry(name, format!("step {}, {state}", grouped(checkpoint.step)));
    }
    if info.checkpoints.is_empty() {
        text += &entry("checkpoints", "none");
    }
    Ok(text + &entry("size", bytes(info.bytes)))
}

fn title(title: &str) -> Cow<'_, str> {
    if title.is_empty() { "without title".into() } else { units::title(title) }
}
