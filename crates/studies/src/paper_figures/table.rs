//! The measurements as a table in Markdown.

use super::figures::View;
use super::{Mode, Model, Published, Record};
use std::fmt::Write;

/// One line for each measurement, then the models of the first machine beside what the paper prints.
#[must_use]
pub fn table(record: &Record) -> String {
    let published = Published::read();
    let view = View { record, published: &published };
    let mut text = String::new();
    for (place, machine) in record.machines.iter().enumerate() {
        let _ = writeln!(
            text,
            "{} ({}): a copy moves {:.4} GB/s, {:.4} GOp/s at most\n",
            machine.name,
            machine.driver,
            1e-9 * machine.copy_bytes_per_second,
            1e-9 * machine.operations_per_second
        );
        text += "| model | mode | particles | steps | us/step | particle-steps/s | B/particle | GB/s of a step | hash |\n\
                 |---|---|---|---|---|---|---|---|---|\n";
        for measured in record.measurements.iter().filter(|measured| measured.machine == place) {
            let whole = measured.points.iter().find(|point| point.name == "step");
            let moved = whole.map_or("-".to_owned(), |point| format!("{:.4}", 1e-9 * point.bytes / point.seconds));
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {:.1} | {:.3e} | {:.0} | {moved} | {:.8} |",
                measured.model,
                measured.mode,
                measured.particles,
                measured.steps,
                1e6 * measured.seconds_per_step,
                measured.cundall(),
                measured.bytes_per_particle(),
                measured.hash
            );
        }
        text.push('\n');
    }
    if let (Some(machine), Some(size)) = (record.machines.first(), view.size(0, Mode::Paper)) {
        let _ = writeln!(
            text,
            "Particle-steps/s at size {size} beside the paper's at about 3 million; scaled: by bandwidth, {:.0} GB/s copied \
             here over the 549 GB/s that the paper states. It is a scaling, not a measurement.\n\n\
             | model | P100, printed | P100, scaled | paper mode | over scaled | best mode | over printed |\n\
             |---|---|---|---|---|---|---|",
            1e-9 * machine.copy_bytes_per_second
        );
        for model in Model::ALL {
            let [paper, best] = Mode::ALL.map(|mode| view.one(0, mode, model, size).map(super::Measured::cundall));
            let printed = view.cundall(model);
            let scaled = printed.map(|printed| view.scaled(printed, machine));
            let ratio = |a: Option<f64>, b: Option<f64>| Some(a? / b?);
            let times = |ratio: Option<f64>| ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.2}"));
            let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3e}"));
            let _ = writeln!(
                text,
                "| {model} | {} | {} | {} | {} | {} | {} |",
                number(printed),
                number(scaled),
                number(paper),
                times(ratio(paper, scaled)),
                number(best),
                times(ratio(best, printed))
            );
        }
    }
    for line in &record.left_out {
        let _ = writeln!(text, "\nleft out: {line}");
    }
    text
}
