//! Where the time of a step goes, as a table and as data.

use crate::units::{counted, grouped};
use serde_json::{Value, json};
use std::fmt::Write;
use tdem_engine::{Part, Profile};
use tdem_studies::bench::Measurement;

/// A line for each stage, for each kernel if they are wanted, and for their sum; nothing without a profile.
pub(crate) fn table(measured: &Measurement, kernels: bool) -> Option<String> {
    let profiled = measured.profiled.as_ref()?;
    let (profile, copy) = (&profiled.profile, profiled.copy_bandwidth);
    let mut text = format!(
        "{} with stages apart, {}; a copy moves {:.1} GB/s",
        counted(profile.steps, "step"),
        if profile.searches == 1 { "1 search".to_owned() } else { format!("{} searches", grouped(profile.searches)) },
        1e-9 * copy
    );
    text += "\n  stage             calls      us/step   GB/step      GB/s  % of copy";
    let mut line = |name: &str, calls: Option<u64>, seconds: f64, bytes: u64| {
        let rate = if seconds > 0.0 { bytes as f64 / seconds } else { 0.0 };
        let per_step = 1.0 / profile.steps as f64;
        let _ = write!(
            text,
            "\n  {name:<16}  {:>5}  {:>11.3}  {:>8}  {:>8.1}  {:>9.1}",
            calls.map_or(String::new(), |calls| calls.to_string()),
            1e6 * seconds * per_step,
            gigabytes(1e-9 * bytes as f64 * per_step),
            1e-9 * rate,
            100.0 * rate / copy
        );
    };
    for stage in profile.stages() {
        line(stage.name, Some(stage.calls), stage.seconds, stage.bytes);
        let parts = profile.parts.iter().filter(|part| kernels && part.stage == stage.name && part.name != stage.name);
        parts.for_each(|part| line(&format!("  {}", part.name), Some(part.calls), part.seconds, part.bytes));
    }
    let (sum, bytes) = (profile.seconds_of_parts(), profile.parts.iter().map(|part| part.bytes).sum());
    line("sum", None, sum, bytes);
    let step = profile.seconds / profile.steps as f64;
    let _ = write!(
        text,
        "\n  the sum is {:.1} % of a step with stages apart, {:.3} us; a whole step takes {:.3} us at best",
        100.0 * sum / profile.seconds,
        1e6 * step,
        1e6 * measured.step_seconds()
    );
    Some(text)
}

/// Gigabytes in a narrow column.
pub(crate) fn gigabytes(amount: f64) -> String {
    if amount >= 1e-3 { format!("{amount:.4}") } else { format!("{amount:.1e}") }
}

/// The profile as data.
pub(crate) fn json(profile: &Profile) -> Value {
    let parts = |parts: &[Part]| -> Vec<Value> {
        let one = |part: &Part| {
            json!({
                "stage": part.stage,
                "name": part.name,
                "calls": part.calls,
                "seconds": part.seconds,
                "bytes": part.bytes,
            })
        };
        parts.iter().map(one).collect()
    };
    json!({
        "steps": profile.steps,
        "searches": profile.searches,
        "seconds": profile.seconds,
        "seconds_of_parts": profile.seconds_of_parts(),
        "stages": parts(&profile.stages()),
        "kernels": parts(&profile.parts),
    })
}
