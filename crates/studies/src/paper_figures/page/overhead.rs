//! Figure 6: what models cost over the simplest one.

use super::super::chart::{Bar, grouped};
use super::super::figures::View;
use super::super::published::On;
use super::super::{Measured, Mode, Model, Quantity};
use super::{conditions, digits, escaped, key, maybe, maybe_of_paper, mode_words, section as wrapped, short, table};

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
    let body = format!("<figure>{drawn}{}{}</figure>\n{}", key(&entries), conditions(view, used), table(&head, &rows));
    let about = "Time of a step per particle over that of GN at the largest size that all models were measured at. BPM and \
                 TBPM ran in their own applications, as in the paper. In best mode a step of GN is so cheap that the others \
                 look dearer: see Figure 5 for the times themselves.";
    wrapped(6, "overhead over the simplest model", about, &body)
}
