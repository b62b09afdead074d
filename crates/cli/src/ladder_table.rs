//! A ladder as a table, as a file of numbers, and in words.

use crate::json;
use crate::units::{clock, grouped, number, short};
use serde_json::{Value, json};
use std::fmt::Write;
use std::time::Duration;
use tdem_studies::ladder::{Difference, Halved, Ladder, Outcome, Pair, Spread};

/// Columns of a pair. "and" is the finer of its two rungs.
const COLUMNS: [&str; 13] = [
    "heat s",
    "T rms K",
    "T most K",
    "order",
    "p rms Pa",
    "p most Pa",
    "p of Pa",
    "order",
    "broken",
    "and",
    "in one",
    "kinetic",
    "and",
];
const LEGEND: &str = "\
Each run against the next at equal times of the heat. T: differences of the temperatures of particles; p: of their mean
stresses, beside the root mean square of these stresses on the finer rung; order: log2 of the difference of the pair before
over this one; broken: bonds that are broken on both rungs, and those broken on one only; kinetic: kinetic over elastic
energy on both.";
/// Columns of a rung; the second tells what is halved.
fn outcomes(ladder: &Ladder) -> [&'static str; 7] {
    let halved = match ladder.halved {
        Halved::TimeScale => "time scale",
        Halved::HeatStep => "heat step s",
    };
    ["rung", halved, "heat s", "steps", "time", "broken bonds", "hash"]
}

/// For a terminal.
pub(crate) fn text(ladder: &Ladder) -> String {
    let mut text = format!("{LEGEND}\n\n");
    let _ = writeln!(text, "{}", aligned(&outcomes(ladder), &rungs(ladder)));
    for index in 0..ladder.pairs.len() {
        let _ = writeln!(text, "{}\n{}", heading(ladder, index), aligned(&COLUMNS, &rows(ladder, index)));
    }
    text + verdicts(ladder).join("\n").trim_end()
}

/// For programs.
pub(crate) fn for_programs(ladder: &Ladder, asked: usize) -> Value {
    let spread = |of: &Spread| json!({ "root_mean_square": of.rms, "largest": of.largest });
    let difference = |of: &Difference| {
        json!({
            "heat_time": of.heat_time,
            "temperature": spread(&of.temperature),
            "stress": spread(&of.stress),
            "stress_size": of.stress_size,
            "broken_bonds": of.broken,
            "broken_in_one": of.broken_in_one,
            "kinetic_over_elastic": of.kinetic_over_elastic,
        })
    };
    let rung = |of: &Outcome| {
        json!({
            "label": of.label,
            "time_scale": of.time_scale,
            "step_seconds": of.step_seconds,
            "heat_step_seconds": of.heat_step_seconds,
            "complete": of.complete,
            "heat_time": of.heat_time,
            "steps": of.steps,
            "wall_clock_secs": of.clock_secs,
            "bonds": of.bonds,
            "broken_bonds": of.broken_bonds,
            "hash": of.hash.map(json::hash),
        })
    };
    let pair = |of: &Pair| of.differences.iter().map(difference).collect::<Value>();
    json!({
        "ok": ladder.complete() == asked,
        "halved": match ladder.halved {
            Halved::TimeScale => "time scale",
            Halved::HeatStep => "heat step",
        },
        "rungs": ladder.rungs.iter().map(rung).collect::<Value>(),
        "pairs": ladder.pairs.iter().map(pair).collect::<Value>(),
        "verdicts": verdicts(ladder),
    })
}

/// A document in Markdown.
pub(crate) fn markdown(title: &str, source: &str, ladder: &Ladder) -> String {
    let price = match ladder.halved {
        Halved::TimeScale => "acceleration",
        Halved::HeatStep => "long steps of the heat",
    };
    let mut text = format!("# The price of {price}: {title}\n\n`{source}`, tdem {}\n\n", env!("CARGO_PKG_VERSION"));
    for verdict in verdicts(ladder) {
        let _ = writeln!(text, "- {verdict}");
    }
    text += "\n";
    text += &piped(&outcomes(ladder), &rungs(ladder));
    let _ = writeln!(text, "\n{LEGEND}");
    for index in 0..ladder.pairs.len() {
        let _ = write!(text, "\n## {}\n\n{}", heading(ladder, index), piped(&COLUMNS, &rows(ladder, index)));
    }
    text
}

/// A line for each pair and instant, every digit. What cannot be said is left empty.
pub(crate) fn csv(ladder: &Ladder) -> String {
    let mut text = String::from(
        "rung,finer_rung,time_scale,finer_time_scale,heat_time,temperature_rms,temperature_largest,temperature_order,\
         stress_rms,stress_largest,stress_size,stress_order,broken_bonds,finer_broken_bonds,broken_in_one,\
         kinetic_over_elastic,finer_kinetic_over_elastic,heat_step,finer_heat_step\n",
    );
    for (index, pair) in ladder.pairs.iter().enumerate() {
        let (coarse, fine) = (&ladder.rungs[index], &ladder.rungs[index + 1]);
        for (instant, found) in pair.differences.iter().enumerate() {
            let maybe = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
            let [of_temperature, of_stress] = orders(ladder, index, instant).map(maybe);
            let [kinetic, finer_kinetic] = found.kinetic_over_elastic.map(maybe);
            let Difference { heat_time, temperature, stress, stress_size, broken: [broken, finer], .. } = found;
            let _ = writeln!(
                text,
                "{},{},{:e},{:e},{heat_time:e},{:e},{:e},{of_temperature},{:e},{:e},{stress_size:e},{of_stress},\
                 {broken},{finer},{},{kinetic},{finer_kinetic},{:e},{:e}",
                coarse.label,
                fine.label,
                coarse.time_scale,
                fine.time_scale,
                temperature.rms,
                temperature.largest,
                stress.rms,
                stress.largest,
                found.broken_in_one,
                coarse.heat_step_seconds,
                fine.heat_step_seconds,
            );
        }
    }
    text
}

/// A sentence for each pair: how far it differs at the end, and where it differs most.
fn verdicts(ladder: &Ladder) -> Vec<String> {
    (0..ladder.pairs.len()).filter_map(|index| verdict(ladder, index)).collect()
}

fn verdict(ladder: &Ladder, index: usize) -> Option<String> {
    let (pair, [coarse, fine]) = (&ladder.pairs[index], [&ladder.rungs[index], &ladder.rungs[index + 1]]);
    let last = pair.differences.last()?;
    let hottest = pair.worst(|found| found.temperature.largest)?;
    let tensest = pair.worst(|found| found.stress.rms)?;
    let end =
        if fine.complete { "at the end".to_owned() } else { format!("after {} s of heat", short(last.heat_time)) };
    let mut text = format!(
        "{} in place of {}: {end} temperatures differ by at most {} K, mean stresses by {} Pa{}{}",
        fine.label,
        coarse.label,
        number(last.temperature.largest, 2),
        number(last.stress.rms, 2),
        of(last.stress.rms, last.stress_size),
        broken(last, fine.bonds),
    );
    let _ = write!(
        text,
        "; at worst temperatures by {} K after {} s of heat, stresses by {} Pa after {} s",
        number(hottest.temperature.largest, 2),
        short(hottest.heat_time),
        number(tensest.stress.rms, 2),
        short(tensest.heat_time),
    );
    text += &parting(pair);
    let orders = orders(ladder, index, pair.differences.len() - 1);
    if let [Some(temperature), Some(stress)] = orders {
        let [temperature, stress] = [temperature, stress].map(|order| format!("{order:.2}"));
        let _ = write!(text, "; orders {end}: temperatures {temperature}, stresses {stress}");
    }
    Some(text + ".")
}

/// A part of a whole, in words; nothing where there is no whole.
fn of(part: f64, whole: f64) -> String {
    if whole > 0.0 {
        format!(" ({} % of {} Pa, root mean squares)", number(100.0 * part / whole, 2), number(whole, 2))
    } else {
        String::new()
    }
}

/// Broken bonds at the end.
fn broken(last: &Difference, bonds: u64) -> String {
    let [coarse, fine] = last.broken.map(grouped);
    let one = grouped(last.broken_in_one);
    match last.broken_part() {
        _ if bonds == 0 => String::new(),
        _ if last.broken == [0, 0] => ", and no bond is broken".to_owned(),
        Some(part) => {
            let part = number(100.0 * part, 2);
            format!(", broken bonds by {part} % ({coarse} and {fine}, {one} of them on one rung only)")
        }
        None => format!(", broken bonds are {coarse} and {fine}"),
    }
}

/// Broken bonds on the way.
fn parting(pair: &Pair) -> String {
    let Some(parted) = pair.parted() else { return String::new() };
    let worst = pair.worst(|found| found.broken_part().unwrap_or(0.0));
    let mut text = String::new();
    if let Some((worst, part)) = worst.and_then(|worst| Some((worst, worst.broken_part().filter(|&part| part > 0.0)?)))
    {
        let _ = write!(text, ", broken bonds by {} % after {} s", number(100.0 * part, 2), short(worst.heat_time));
    }
    let _ = write!(text, "; the first bond that is broken on one rung only is seen after {} s", short(parted));
    text
}

/// Observed orders of temperatures and stresses; none for the first pair.
fn orders(ladder: &Ladder, index: usize, instant: usize) -> [Option<f64>; 2] {
    let of = |what: fn(&Difference) -> f64| {
        let before = &ladder.pairs[index.checked_sub(1)?];
        ladder.pairs[index].order(before, instant, what)
    };
    [of(|found| found.temperature.rms), of(|found| found.stress.rms)]
}

fn heading(ladder: &Ladder, index: usize) -> String {
    let [coarse, fine] = [index, index + 1].map(|k| &ladder.rungs[k]);
    let named = |rung: &Outcome| format!("{} = {}", rung.label, halved(ladder, rung));
    format!("{} against {}", named(coarse), named(fine))
}

/// What is halved, of a rung.
fn halved(ladder: &Ladder, rung: &Outcome) -> String {
    match ladder.halved {
        Halved::TimeScale => short(rung.time_scale),
        Halved::HeatStep => short(rung.heat_step_seconds),
    }
}

fn rungs(ladder: &Ladder) -> Vec<[String; 7]> {
    ladder.rungs.iter().map(|rung| outcome(ladder, rung)).collect()
}

fn outcome(ladder: &Ladder, rung: &Outcome) -> [String; 7] {
    [
        rung.label.clone(),
        halved(ladder, rung),
        short(rung.heat_time),
        grouped(rung.steps),
        clock(Duration::try_from_secs_f64(rung.clock_secs).unwrap_or_default()),
        format!("{} of {}", grouped(rung.broken_bonds), grouped(rung.bonds)),
        rung.hash.map_or("-".to_owned(), |hash| format!("{hash:032x}")),
    ]
}

fn rows(ladder: &Ladder, index: usize) -> Vec<[String; 13]> {
    let three = |value: f64| number(value, 3);
    let maybe = |value: Option<f64>| value.map_or("-".to_owned(), |value| number(value, 2));
    let row = |(instant, found): (usize, &Difference)| {
        let [of_temperature, of_stress] =
            orders(ladder, index, instant).map(|order| order.map_or("-".to_owned(), |order| format!("{order:.2}")));
        let [kinetic, finer_kinetic] = found.kinetic_over_elastic.map(maybe);
        [
            short(found.heat_time),
            three(found.temperature.rms),
            three(found.temperature.largest),
            of_temperature,
            three(found.stress.rms),
            three(found.stress.largest),
            three(found.stress_size),
            of_stress,
            grouped(found.broken[0]),
            grouped(found.broken[1]),
            grouped(found.broken_in_one),
            kinetic,
            finer_kinetic,
        ]
    };
    ladder.pairs[index].differences.iter().enumerate().map(row).collect()
}

/// Columns with room, each line ended.
fn aligned<const K: usize>(head: &[&str; K], rows: &[[String; K]]) -> String {
    let width: [usize; K] =
        std::array::from_fn(|k| rows.iter().map(|row| row[k].len()).chain([head[k].len()]).max().unwrap_or(0));
    let line = |cells: [&str; K]| {
        let cells: Vec<String> = cells.iter().zip(width).map(|(cell, width)| format!("{cell:>width$}")).collect();
        format!("  {}\n", cells.join("  "))
    };
    let body = rows.iter().map(|row| line(row.each_ref().map(String::as_str)));
    std::iter::once(line(*head)).chain(body).collect()
}

/// The same in Markdown.
fn piped<const K: usize>(head: &[&str; K], rows: &[[String; K]]) -> String {
    let body = rows.iter().map(|row| format!("| {} |\n", row.join(" | ")));
    let top = [format!("| {} |\n", head.join(" | ")), format!("|{}\n", "---:|".repeat(K))];
    top.into_iter().chain(body).collect()
}
