//! Figure 5: time of a step over the number of particles, and how much faster a GPU is.

use super::super::chart::{Axis, Chart, Scale, Shape};
use super::super::figures::View;
use super::super::{Measured, Mode, Model};
use super::{
    called, colour, conditions, cores, digits, grouped, key, maybe, mode_words, models, particles, section as wrapped,
    short, table,
};

/// The paper's largest sizes.
fn largest(model: Model) -> f64 {
    match model {
        Model::GN | Model::GNT | Model::GNTM => 3_015_300.0,
        Model::BPM => 3_000_848.0,
        Model::TBPM => 3_014_284.0,
    }
}

fn milliseconds(measured: &Measured) -> f64 {
    1e3 * measured.seconds_per_step
}

fn chart(view: &View<'_>, mode: Mode) -> String {
    let all: Vec<&Measured> = view.record.measurements.iter().filter(|measured| measured.mode == mode).collect();
    let machine = view.machine(0);
    // ms of a step as the paper prints it, and what it would be at this bandwidth.
    let printed = |model| Some(1e3 * largest(model) / view.cundall(model)?);
    let scaled = |model| Some(1e3 * largest(model) / view.scaled(view.cundall(model)?, machine));
    let of_paper = || Model::ALL.into_iter().flat_map(|model| [printed(model), scaled(model)]).flatten();
    let x = all.iter().map(|m| m.particles as f64).chain([largest(Model::GNTM)]);
    let y = all.iter().map(|m| milliseconds(m)).chain(of_paper());
    let about = format!("Time of a step over the number of particles in {}", mode_words(mode));
    let mut chart = Chart::new(
        Axis::of("particles", Scale::Log, x, particles),
        Axis::of("time of a step (ms)", Scale::Log, y, short),
        &about,
    );
    for place in 0..view.record.machines.len() {
        let shape = if place == 0 { Shape::Disc } else { Shape::Square };
        for model in Model::ALL {
            let series = view.series(place, mode, model);
            let points: Vec<[f64; 2]> = series.iter().map(|m| [m.particles as f64, milliseconds(m)]).collect();
            chart.line(&points, &(colour(model) + stroke(place)));
            for (point, measured) in points.iter().zip(&series) {
                let about = format!(
                    "{model} on {}, {} particles: {} ms",
                    called(view.machine(place)),
                    grouped(measured.particles as u64),
                    digits(milliseconds(measured))
                );
                chart.mark(*point, shape, &colour(model), &about);
            }
        }
    }
    for model in Model::ALL {
        let (Some(printed), Some(scaled)) = (printed(model), scaled(model)) else { continue };
        let about = format!("{model} on the P100, printed: {} ms", digits(printed));
        chart.mark([largest(model), printed], Shape::Ring, &colour(model), &about);
        if scaled.is_finite() {
            let about = format!("{model} on the P100, scaled by bandwidth: {} ms", digits(scaled));
            chart.mark([largest(model), scaled], Shape::Cross, &colour(model), &about);
        }
    }
    format!("<figure><b>{}</b>{}{}</figure>\n", mode_words(mode), chart.finish(), conditions(view, all.iter().copied()))
}

/// How the lines of a machine are drawn.
fn stroke(place: usize) -> &'static str {
    ["", " broken", " dotted"][place.min(2)]
}

/// Particle-steps per second beside those of the paper.
fn cundall(view: &View<'_>) -> String {
    let size = view.size(0, Mode::Paper).or_else(|| view.size(0, Mode::Best));
    let Some(size) = size else { return String::new() };
    let rows: Vec<Vec<String>> = Model::ALL
        .into_iter()
        .map(|model| {
            let [paper, best] = Mode::ALL.map(|mode| view.one(0, mode, model, size).map(Measured::cundall));
            let printed = view.cundall(model);
            let scaled = printed.map(|printed| view.scaled(printed, view.machine(0)));
            let ratio = |a: Option<f64>, b: Option<f64>| maybe(Some(a).zip(b).and_then(|(a, b)| Some(a? / b)));
            vec![
                model.to_string(),
                maybe(printed),
                maybe(scaled),
                maybe(paper),
                ratio(paper, printed),
                ratio(paper, scaled),
                maybe(best),
                ratio(best, printed),
                ratio(best, scaled),
            ]
        })
        .collect();
    let head = [
        "particle-steps/s",
        "P100, printed",
        "P100, scaled",
        "paper mode",
        "over printed",
        "over scaled",
        "best mode",
        "over printed",
        "over scaled",
    ];
    format!("<p>{}, size {size}; the paper: about 3 million particles.</p>\n", super::escaped(&view.machine(0).name))
        + &table(&head, &rows)
}

/// How much faster the paper's GPU is than its 20 cores.
fn printed(view: &View<'_>, model: Model) -> Option<String> {
    let (least, most) = view.published_speed_up(model)?;
    Some(least.map_or(format!("up to {most:.1}"), |least| format!("{least:.1} to {most:.1}")))
}

/// The first machine, if it is a GPU, over the others.
fn speed_ups(view: &View<'_>) -> String {
    if !view.machine(0).gpu {
        let of = |model| printed(view, model).map(|printed| format!("{model} {printed}"));
        let printed: Vec<String> = Model::ALL.into_iter().filter_map(of).collect();
        return format!(
            "<p class=\"soft\">No GPU is the first device: no speed-up. The paper: {}, one P100 over 20 cores.</p>\n",
            printed.join(", ")
        );
    }
    let mut rows = Vec::new();
    for (place, other) in view.record.machines.iter().enumerate().skip(1) {
        for mode in Mode::ALL {
            for (fast, slow) in view.speed_ups(place, mode) {
                let comparable = mode == Mode::Paper && other.threads != Some(1);
                let printed = if comparable { printed(view, fast.model) } else { None };
                rows.push(vec![
                    fast.model.to_string(),
                    mode_words(mode).to_owned(),
                    grouped(fast.particles as u64),
                    other.word.clone(),
                    digits(milliseconds(fast)),
                    digits(milliseconds(slow)),
                    digits(slow.seconds_per_step / fast.seconds_per_step),
                    printed.unwrap_or_else(|| "\u{2013}".to_owned()),
                ]);
            }
        }
    }
    if rows.is_empty() {
        return "<p class=\"soft\">Nothing else was measured at the same size: no speed-up.</p>\n".to_owned();
    }
    let head = ["speed-up", "mode", "N", "against", "ms", "ms there", "times as fast", "paper, over 20 cores"];
    table(&head, &rows)
}

pub(super) fn section(view: &View<'_>) -> String {
    let mut entries = models(view);
    for (place, machine) in view.record.machines.iter().enumerate() {
        entries.push(("stroke".to_owned() + stroke(place), super::escaped(&called(machine))));
    }
    entries.push(("ring".to_owned(), "P100, from the printed Cundall number".to_owned()));
    entries.push(("cross".to_owned(), "the same, scaled by bandwidth".to_owned()));
    let charts: String = Mode::ALL.map(|mode| chart(view, mode)).concat();
    let tables = [cundall(view), speed_ups(view), cores::tables(view)].concat();
    let body = format!("{}<div class=\"charts\">\n{charts}</div>\n{tables}", key(&entries));
    let about = "Whole steps at the best of the repeats; on a GPU stages are joined as this program joins them. The paper\u{2019}s \
                 times are those of its paper mode, also beside our best mode.";
    wrapped(5, "time of a step, and the speed-up", about, &body)
}
