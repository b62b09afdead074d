//! Figure 7: operations per second over operations per byte, below what the device can do.

use super::super::chart::{Axis, Chart, Scale, Shape};
use super::super::figures::View;
use super::super::{Machine, Measured, Mode, Model, Point, Quantity};
use super::{called, colour, conditions, digits, escaped, key, models, section as wrapped, short, table};

/// Kernels of the paper mode and whole steps of the best one.
fn points<'a>(view: &'a View<'_>, place: usize) -> Vec<(&'a Measured, &'a Point)> {
    let of = |mode, keep: fn(&Point) -> bool| {
        let all = view.at(place, mode).into_iter();
        all.flat_map(move |measured| {
            let kept = measured.points.iter().filter(move |point| keep(point));
            kept.map(move |point| (measured, point))
        })
    };
    let kernels = of(Mode::Paper, |point| matches!(point.name.as_str(), "predict" | "contact" | "bond"));
    kernels.chain(of(Mode::Best, |point| point.name == "step")).collect()
}

/// The paper's kernels 4 and 5: operations and bytes in words, and operations per byte.
fn intensities(view: &View<'_>) -> [(&'static str, [String; 2], f64); 2] {
    let number = |quantity| view.published.constant(quantity);
    let contacts = number(Quantity::OperationsOfContact) * number(Quantity::ContactsAtMost);
    let counted = |name, operations: f64, bytes: f64, of: &str| {
        (name, [operations, bytes].map(|count| format!("{count}{of}")), operations / bytes)
    };
    [
        counted("paper\u{2019}s kernel 4, contacts", contacts, number(Quantity::BytesOfContacts), ""),
        counted(
            "paper\u{2019}s kernel 5, bonds",
            number(Quantity::OperationsOfBond),
            number(Quantity::BytesOfBond),
            " a bond",
        ),
    ]
}

/// What a device can do at most at this intensity.
fn roof(machine: &Machine, intensity: f64) -> f64 {
    (machine.copy_bytes_per_second * intensity).min(machine.operations_per_second)
}

fn chart(view: &View<'_>, place: usize) -> String {
    let machine = view.machine(place);
    let points = points(view, place);
    let bandwidth = view.published.constant(Quantity::Bandwidth);
    let marks = intensities(view);
    let knee = machine.operations_per_second / machine.copy_bytes_per_second;
    let x: Vec<f64> = points
        .iter()
        .map(|(_, point)| point.intensity())
        .chain(marks.iter().map(|(.., intensity)| *intensity))
        .chain([3.0 * knee, 0.1])
        .filter(|x| x.is_finite())
        .collect();
    let (left, right) = x.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &x| (low.min(x), high.max(x)));
    let rates = points.iter().map(|(_, point)| 1e-9 * point.rate());
    let y = rates.chain([1e-9 * machine.operations_per_second, 1e-9 * roof(machine, left), 1e-9 * bandwidth * left]);
    let about = format!("Roofline of {}", called(machine));
    let mut chart = Chart::new(
        Axis::of("operations per byte", Scale::Log, x.iter().copied(), short),
        Axis::of("1e9 operations per second", Scale::Log, y, short),
        &about,
    );
    let ceiling: Vec<[f64; 2]> = [left, knee, right].map(|x| [x, 1e-9 * roof(machine, x)]).to_vec();
    chart.line(&ceiling, "paper");
    let until = right.min(machine.operations_per_second / bandwidth);
    chart.line(&[left, until].map(|x| [x, 1e-9 * bandwidth * x]), "paper broken thin");
    for (.., intensity) in marks {
        chart.upright(intensity, 1e-9 * roof(machine, intensity), "paper dotted thin");
    }
    for (measured, point) in points {
        let (class, x, y) = (colour(measured.model), point.intensity(), 1e-9 * point.rate());
        // Where branches of the law may be taken, the point may lie further up and to the right.
        let more = point.operations.at_most / point.operations.always;
        if more > 1.02 {
            chart.line(&[[x, y], [x * more, y * more]], &format!("{class} thin"));
        }
        let (shape, what) = if point.name == "step" {
            (Shape::Square, "whole step, best mode".to_owned())
        } else {
            (Shape::Disc, format!("{}, paper mode", point.name))
        };
        let about = format!("{}, {what}: {} operations per byte, {} GOp/s", measured.model, digits(x), digits(y));
        chart.mark([x, y], shape, &class, &about);
        let letter = match point.name.as_str() {
            "predict" => "p",
            "contact" => "c",
            "bond" => "b",
            _ => "s",
        };
        chart.note([x, y], letter);
    }
    let used = Mode::ALL.into_iter().flat_map(|mode| view.at(place, mode));
    format!("<figure><b>{}</b>{}{}</figure>\n", escaped(&called(machine)), chart.finish(), conditions(view, used))
}

pub(super) fn section(view: &View<'_>) -> String {
    let mut charts = String::from("<div class=\"charts\">\n");
    let mut rows = Vec::new();
    for (place, machine) in view.record.machines.iter().enumerate() {
        let points = points(view, place);
        if points.is_empty() {
            continue;
        }
        charts += &chart(view, place);
        for (measured, point) in points {
            let per = 1.0 / measured.particles as f64;
            rows.push(vec![
                measured.model.to_string(),
                machine.word.clone(),
                if point.name == "step" { "whole step, best mode".to_owned() } else { point.name.clone() },
                range(per * point.operations.always, per * point.operations.at_most),
                digits(per * point.bytes),
                digits(point.intensity()),
                digits(1e-9 * point.rate()),
                format!("{:.0} %", 100.0 * point.rate() / roof(machine, point.intensity())),
            ]);
        }
    }
    charts += "</div>\n";
    for (name, counted, intensity) in intensities(view) {
        let rest = ["\u{2013}".to_owned(), "\u{2013}".to_owned()];
        rows.push(vec![
            name.to_owned(),
            "paper".to_owned(),
            String::new(),
            counted[0].clone(),
            counted[1].clone(),
            digits(intensity),
            rest[0].clone(),
            rest[1].clone(),
        ]);
    }
    let models: Vec<(String, String)> = models(view)
        .into_iter()
        .filter(|(_, name)| Model::ALL.iter().any(|model| model.to_string() == *name))
        .chain([
            ("paper stroke".to_owned(), "measured: copy, and multiplications and additions".to_owned()),
            ("paper stroke broken".to_owned(), "the P100\u{2019}s 549 GB/s".to_owned()),
            ("paper stroke dotted".to_owned(), "intensities that the paper counts: kernel 5, kernel 4".to_owned()),
        ])
        .collect();
    let head = [
        "model",
        "on",
        "kernel",
        "operations/particle",
        "B/particle",
        "operations/B",
        "1e9 operations/s",
        "of the roof",
    ];
    let body = key(&models) + &charts + &table(&head, &rows);
    let about = "Operations are counted by the laws as they are printed for kernels: additions, multiplications, divisions and \
                 roots, one each, without branches that sliding takes (a short line shows how much they may add); sums around \
                 the laws are not counted. Bytes are the least that must be moved: all that is needed once, whatever caches \
                 make of it; so a point may lie above the roof where data stay in caches. Letters: p predict (on a GPU with \
                 the correction of the step before), c contact, b bond, s a whole step. Where all that touch are bonded, \
                 contacts compute nothing and have no point. The paper prints no rates of its kernels, and no peak of \
                 operations of its card.";
    wrapped(7, "roofline", about, &body)
}

fn range(low: f64, high: f64) -> String {
    if high / low > 1.005 { format!("{} to {}", digits(low), digits(high)) } else { digits(low) }
}
