//! Figure 6: what models cost over the simplest one.

use super::super::chart::{Bar, grouped};
use super::super::figures::View;
use super::super::published::On;
use super::super::{Measured, Mode, Model, Quantity};
use super::{conditions, digits, escaped, key, maybe, maybe_of_paper, mode_words, section as wrapped, short, table};
use std::fmt::Write;

/// A column of bars: its class, what it is, and the time of a model over that of GN.
struct Column<'a> {
    class: &'static str,
    name: String,
    /// Whether its numbers are the paper's.
    printed: bool,
    value: Box<dyn Fn(Model) -> Option<f64> + 'a>,
}

pub(super) fn section(view: &View<'_>) -> String {
    let printed = |device| move |model| view.published.value(Quantity::TimeOverGn, Some(model), Some(device));
    let mut columns = vec![
        Column { class: "paper", name: "paper, P100".to_owned(), printed: true, value: Box::new(printed(On::Gpu)) },
        Column {
            class: "paper faint",
            name: "paper, 20 cores".to_owned(),
            printed: true,
            value: Box::new(printed(On::Cpu)),
        },
    ];
    let classes = [["c0", "c0 faint"], ["c1", "c1 faint"], ["c2", "c2 faint"], ["c3", "c3 faint"]];
    for (place, machine) in view.record.machines.iter().enumerate() {
        for mode in Mode::ALL {
            let class = classes[place % classes.len()][usize::from(mode == Mode::Best)];
            let name = format!("{}, {}", escaped(&machine.word), mode_words(mode));
            let value = move |model| view.over_gn(place, mode, model, Measured::seconds_per_particle);
            columns.push(Column { class, name, printed: false, value: Box::new(value) });
        }
    }
    columns.retain(|column| Model::ALL.into_iter().any(|model| (column.value)(model).is_some()));
    let group = |model: Model| {
        let bar = |column: &Column<'_>| {
            let value = (column.value)(model)?;
            Some((value, column.class.to_owned(), format!("{model}, {}: {}", column.name, digits(value))))
        };
        Bar { label: model.to_string(), parts: columns.iter().filter_map(bar).collect() }
    };
    let groups: Vec<_> = Model::ALL.into_iter().map(group).collect();
    let drawn = grouped("time over that of GN", &groups, short, "Time of a step over that of GN, by model");
    let entries: Vec<(String, String)> =
        columns.iter().map(|column| (column.class.to_owned(), column.name.clone())).collect();
    let row = |model: Model| {
        let cells = columns.iter().map(|column| {
            let shown = if column.printed { maybe_of_paper } else { maybe };
            shown((column.value)(model))
        });
        [model.to_string()].into_iter().chain(cells).collect::<Vec<_>>()
    };
    let rows: Vec<_> = Model::ALL.into_iter().map(row).collect();
    let head: Vec<&str> =
        ["time over that of GN"].into_iter().chain(columns.iter().map(|column| column.name.as_str())).collect();
    let used = (0..view.record.machines.len()).flat_map(|place| Mode::ALL.map(|mode| view.at(place, mode))).flatten();
    let body = format!(
        "<figure>{drawn}{}{}</figure>\n{}{}",
        key(&entries),
        conditions(view, used),
        table(&head, &rows),
        additions(view, &columns)
    );
    let about = "Time of a step per particle over that of GN at the largest size that all models were measured at. BPM and \
                 TBPM ran in their own applications, as in the paper. In best mode a step of GN is so cheap that the others \
                 look dearer: see Figure 5 for the times themselves.";
    wrapped(6, "overhead over the simplest model", about, &body)
}

/// What models add to the one before, in the order of the paper.
const ADDITIONS: [(&str, Model, Model); 4] = [
    ("tangential forces", Model::GN, Model::GNT),
    ("moments", Model::GNT, Model::GNTM),
    ("bonds", Model::GNTM, Model::BPM),
    ("heat", Model::BPM, Model::TBPM),
];

/// What each addition costs, over a step of GN and in absolute time, and whether that is less than in the paper.
fn additions(view: &View<'_>, columns: &[Column<'_>]) -> String {
    let over = |column: &Column<'_>, from, to| Some((column.value)(to)? - (column.value)(from)?);
    // ns of a step per particle; the paper prints it of some models, and of all over that of GN.
    let of_paper = |model| Some(1e9 / view.cundall(Model::GN)? * (columns[0].value)(model)?);
    let here = |mode, model| {
        let measured = view.one(0, mode, model, view.size(0, mode)?)?;
        Some(1e9 * measured.seconds_per_particle())
    };
    let paper = |(_, from, to)| Some(of_paper(to)? - of_paper(from)?);
    let own = |mode, (_, from, to)| Some(here(mode, to)? - here(mode, from)?);
    let row = |addition: (&'static str, Model, Model)| {
        let (name, from, to) = addition;
        let relative = columns.iter().map(|column| maybe(over(column, from, to)));
        let absolute = [paper(addition), own(Mode::Paper, addition), own(Mode::Best, addition)].map(maybe);
        [name.to_owned()].into_iter().chain(relative).chain(absolute).collect::<Vec<_>>()
    };
    let rows: Vec<_> = ADDITIONS.into_iter().map(row).collect();
    let word = escaped(&view.machine(0).word);
    let units: Vec<String> = ["P100", &format!("{word}, paper mode"), &format!("{word}, best mode")]
        .map(|of| format!("ns a particle: {of}"))
        .to_vec();
    let head: Vec<&str> = ["added over GN"]
        .into_iter()
        .chain(columns.iter().map(|column| column.name.as_str()))
        .chain(units.iter().map(String::as_str))
        .collect();
    let mut text = table(&head, &rows);
    text += "<p class=\"soft\">Each is a model less the one before. Bonds and heat come with another application than what they are \
             added to, here as in the paper, so that a difference may be negative; <code>tdem bench case cases/heating.toml \
             --models TBPM,BPM</code> tells what heat adds in one and the same.</p>\n";
    for mode in Mode::ALL {
        let relative = |(_, from, to)| {
            let here = |model| view.over_gn(0, mode, model, Measured::seconds_per_particle);
            Some((here(to)? - here(from)?) < over(&columns[0], from, to)?)
        };
        let absolute = |addition| Some(own(mode, addition)? < paper(addition)?);
        let parts = [told("over a step of GN", &relative), told("in absolute time", &absolute)];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if !parts.is_empty() {
            let _ = writeln!(text, "<p>On {word} in {}: {}.</p>", mode_words(mode), parts.join("; "));
        }
    }
    text
}

/// Which additions cost less than in the paper and which more, in words; `None` if nothing can be compared.
fn told(measure: &str, less: &dyn Fn((&'static str, Model, Model)) -> Option<bool>) -> Option<String> {
    let those = |wanted: bool| {
        let names: Vec<&str> =
            ADDITIONS.into_iter().filter(|&addition| less(addition) == Some(wanted)).map(|(name, ..)| name).collect();
        (!names.is_empty()).then(|| names.join(", "))
    };
    match (those(true), those(false)) {
        (Some(less), Some(more)) => Some(format!("{measure} {less} cost less than in the paper, {more} more")),
        (Some(less), None) => Some(format!("{measure} {less} cost less than in the paper")),
        (None, Some(more)) => Some(format!("{measure} {more} cost more than in the paper")),
        (None, None) => None,
    }
}
