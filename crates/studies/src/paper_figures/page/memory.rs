//! Figure 3: memory.

use super::super::chart::{Axis, Chart, Scale, Shape};
use super::super::figures::View;
use super::super::{Measured, Mode, Model, Quantity, Size};
use super::{
    colour, conditions, digits, grouped, key, maybe, maybe_of_paper, models, particles, section as wrapped, short,
    table,
};

/// The paper's largest packing, of which it says what GN takes.
const PARTICLES: f64 = 3_015_300.0;

pub(super) fn section(view: &View<'_>) -> String {
    let all = || Mode::ALL.into_iter().flat_map(|mode| Model::ALL.map(|model| view.series(0, mode, model)));
    let shown: Vec<&Measured> = all().flatten().collect();
    let at_most = view.published.value(Quantity::MemoryAtMost, Some(Model::GN), None).unwrap_or(f64::NAN);
    let x = shown.iter().map(|m| m.particles as f64).chain([PARTICLES]);
    let y = shown.iter().map(|m| 1e-9 * m.memory_bytes).chain([1e-9 * at_most]);
    let about = "Memory over the number of particles, by model, in both modes";
    let mut chart = Chart::new(
        Axis::of("particles", Scale::Log, x, particles),
        Axis::of("memory (GB)", Scale::Log, y, short),
        about,
    );
    for (mode, class, shape) in [(Mode::Paper, "", Shape::Disc), (Mode::Best, " broken", Shape::Square)] {
        for model in Model::ALL {
            let series = view.series(0, mode, model);
            let points: Vec<[f64; 2]> = series.iter().map(|m| [m.particles as f64, 1e-9 * m.memory_bytes]).collect();
            chart.line(&points, &(colour(model) + class));
            for (point, measured) in points.iter().zip(&series) {
                let about = format!(
                    "{model}, {mode} mode, {} particles: {} GB",
                    grouped(measured.particles as u64),
                    digits(1e-9 * measured.memory_bytes)
                );
                chart.mark(*point, shape, &colour(model), &about);
            }
        }
    }
    chart.mark([PARTICLES, 1e-9 * at_most], Shape::Ring, "paper", "The paper: GN takes less than 1 GB at 3,015,300");
    let mut entries = models(view);
    entries.extend([
        ("stroke".to_owned(), "paper mode".to_owned()),
        ("stroke broken".to_owned(), "best mode".to_owned()),
        ("ring".to_owned(), "paper: GN takes less than this".to_owned()),
    ]);
    let largest = |mode, model| {
        let at: Vec<&Measured> = view.at(0, mode);
        at.into_iter().find(|measured| measured.model == model).map(Measured::bytes_per_particle)
    };
    let rows: Vec<Vec<String>> = Model::ALL
        .into_iter()
        .map(|model| {
            let [paper, best] = Mode::ALL.map(|mode| view.over_gn(0, mode, model, Measured::bytes_per_particle));
            vec![
                model.to_string(),
                maybe_of_paper(view.published.value(Quantity::MemoryOverGn, Some(model), None)),
                maybe(paper),
                maybe(best),
                maybe(largest(Mode::Paper, model)),
                maybe(largest(Mode::Best, model)),
            ]
        })
        .collect();
    let size = view.size(0, Mode::Paper).map_or_else(String::new, |size: Size| format!(" (size {size})"));
    let head = [
        "memory over that of GN",
        "paper",
        "paper mode",
        "best mode",
        "paper mode, B/particle",
        "best mode, B/particle",
    ];
    let body = format!(
        "<figure>{}{}{}</figure>\n{}",
        chart.finish(),
        key(&entries),
        conditions(view, shown.iter().copied()),
        table(&head, &rows)
    );
    let about = format!(
        "All arrays of a run together. The paper compares models at equal numbers of particles, by interpolation; here \
         memory per particle is compared{size}, as each application has its own number of particles."
    );
    wrapped(3, "memory", &about, &body)
}
