//! `tdem verify`: the engine against closed forms and published values.

use crate::codes;
use crate::console::{data, say};
use crate::device::{Choice, word};
use crate::json::{self, Json};
use crate::render::{Report, Reports};
use crate::units::clock;
use clap::Args;
use serde_json::{Value, json};
use std::process::ExitCode;
use std::str::FromStr;
use std::time::Duration;
use tdem_engine::gpu::devices;
use tdem_engine::{Device, cpu};
use tdem_studies::verify::{Backend, Case, Check, Outcome, Tier, Tolerance, catalogue, markdown, run, table};

#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Only cases of these names or groups, whatever their tier; all of the quick tier without any
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// The full tier too, which takes minutes
    #[arg(long)]
    full: bool,
    /// What computes: auto, cpu, opencl, cuda, one of several: cuda:1; cpu-scalar for contacts one by one, cpu-portable
    /// without the instructions that only some machines have; all for every back end of this machine, and their results
    /// must be the same to the last bit
    #[arg(long, default_value = "auto")]
    device: Asked,
    /// Print the table in Markdown
    #[arg(long)]
    markdown: bool,
    /// Print the names of the cases and what they look at, and run none
    #[arg(long)]
    list: bool,
    #[command(flatten)]
    pub(crate) json: Json,
}

const EXAMPLES: &str = "\
Examples:
  tdem verify                      the quick tier, seconds
  tdem verify --full --markdown    everything, as a report
  tdem verify --list               what there is
  tdem verify contact --device all

The exit code is 1 if a check fails.";

/// What was asked for.
#[derive(Clone, Copy, Debug)]
enum Asked {
    /// What a run can be computed on.
    Device(Choice),
    /// The CPU in a way that serves for comparison only.
    Compared(Backend),
    /// Every back end of this machine.
    All,
}

impl FromStr for Asked {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "cpu-scalar" => Ok(Asked::Compared(Backend::CpuScalar)),
            "cpu-portable" => Ok(Asked::Compared(Backend::CpuPortable)),
            "all" => Ok(Asked::All),
            _ => text
                .parse()
                .map(Asked::Device)
                .map_err(|why: String| format!("{why}; or cpu-scalar, cpu-portable, all")),
        }
    }
}

impl Asked {
    fn backends(self) -> Result<Vec<Backend>, Reports> {
        Ok(match self {
            Asked::Device(choice) => vec![match choice.find(cpu::Options::default())?.device {
                Device::Cpu(_) => Backend::CpuLanes,
                Device::Gpu { api, index } => Backend::Gpu { api, index },
            }],
            Asked::Compared(backend) => vec![backend],
            Asked::All => Backend::all(),
        })
    }
}

pub(crate) fn execute(arguments: &Arguments) -> Result<ExitCode, Reports> {
    let cases = chosen(arguments)?;
    if arguments.list && arguments.json.json {
        let cases = cases.iter().map(|case| json!({ "name": case.name, "tier": tier(case), "about": case.about }));
        json::print("verify", json!({ "ok": true, "cases": cases.collect::<Value>() }))?;
        return Ok(ExitCode::SUCCESS);
    }
    if arguments.list {
        for case in &cases {
            data(format!("{:<44} {:<6} {}", case.name, tier(case), case.about))?;
        }
        return Ok(ExitCode::SUCCESS);
    }
    let backends = arguments.device.backends()?;
    if let Asked::All = arguments.device {
        tell_left_out();
    }
    let mut outcomes: Vec<Outcome> = Vec::new();
    let mut agree = true;
    for case in &cases {
        let first = outcomes.len();
        for &backend in &backends {
            let outcome = run(case, backend);
            say(line(&outcome));
            outcomes.push(outcome);
        }
        let hashes = outcomes[first..].iter().map(|outcome| outcome.hash);
        if hashes.clone().any(|hash| hash != outcomes[first].hash) {
            say(format!("FAILED  {}: the back ends do not agree to the last bit", case.name));
            agree = false;
        }
    }
    let good = agree && outcomes.iter().all(Outcome::passed);
    let code = if good { ExitCode::SUCCESS } else { ExitCode::FAILURE };
    if arguments.json.json {
        json::print("verify", for_programs(&outcomes, good, agree))?;
        return Ok(code);
    }
    let shown = if arguments.markdown { markdown(&outcomes) } else { table(&outcomes) };
    data(shown.trim_end())?;
    Ok(code)
}

fn tier(case: &Case) -> &'static str {
    if case.tier == Tier::Quick { "quick" } else { "full" }
}

/// Outcomes for programs.
fn for_programs(outcomes: &[Outcome], good: bool, agree: bool) -> Value {
    let check = |check: &Check| {
        let (tolerance, kind) = match check.tolerance {
            Tolerance::Absolute(size) => (Some(size), "absolute"),
            Tolerance::Relative(size) => (Some(size), "relative"),
            Tolerance::AtMost => (None, "at most"),
            Tolerance::AtLeast => (None, "at least"),
        };
        json!({
            "what": check.what,
            "unit": check.unit,
            "expected": check.expected,
            "got": check.got,
            "tolerance": tolerance,
            "tolerance_kind": kind,
            "kind": check.kind.name(),
            "passed": check.passed,
        })
    };
    let outcome = |outcome: &Outcome| {
        json!({
            "name": outcome.case.name,
            "tier": tier(&outcome.case),
            "backend": outcome.backend.name(),
            "passed": outcome.passed(),
            "checks": outcome.checks.iter().map(check).collect::<Value>(),
            "fault": outcome.fault.as_ref().map(ToString::to_string),
            "hash": outcome.hash.map(json::hash),
            "wall_clock_secs": outcome.seconds,
        })
    };
    json!({ "ok": good, "back_ends_agree": agree, "cases": outcomes.iter().map(outcome).collect::<Value>() })
}

/// Names the devices that cannot be used: what is not tested must not look as if it had passed.
fn tell_left_out() {
    for device in devices() {
        if let Err(why) = device.usable {
            say(format!("left out: {}:{}, {}: {why}", word(device.api), device.index, device.name));
        }
    }
}

fn line(outcome: &Outcome) -> String {
    let verdict = if outcome.passed() { "ok" } else { "FAILED" };
    let time = clock(Duration::try_from_secs_f64(outcome.seconds).unwrap_or_default());
    let fault = outcome.fault.as_ref().map_or(String::new(), |fault| format!(": {fault}"));
    format!("{verdict:<7} {}, {}, {time}{fault}", outcome.case.name, outcome.backend.name())
}

/// The cases that were asked for.
fn chosen(arguments: &Arguments) -> Result<Vec<Case>, Reports> {
    let all = catalogue();
    if arguments.names.is_empty() {
        let wanted = |case: &Case| arguments.full || arguments.list || case.tier == Tier::Quick;
        return Ok(all.into_iter().filter(wanted).collect());
    }
    for name in &arguments.names {
        if !all.iter().any(|case| answers_to(case, name)) {
            let mut groups: Vec<&str> = all.iter().map(Case::group).collect();
            groups.dedup();
            return Err(Report::new(codes::UNKNOWN_NAME, format!("there is no case or group `{name}`"))
                .help(format!("groups are {}; `tdem verify --list` shows all cases", groups.join(", ")))
                .into());
        }
    }
    Ok(all.into_iter().filter(|case| arguments.names.iter().any(|name| answers_to(case, name))).collect())
}

fn answers_to(case: &Case, name: &str) -> bool {
    case.name == name || case.group() == name || case.name.split_once('/').is_some_and(|(_, own)| own == name)
}
