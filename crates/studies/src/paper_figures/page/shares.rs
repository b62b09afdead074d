//! Figure 4: where the time of a step goes.

use super::super::chart::{Bar, stacked};
use super::super::figures::View;
use super::super::{Measured, Mode, Model, Procedures, Quantity};
use super::{called, conditions, key, section as wrapped, table};

/// The published quantity of each procedure.
const QUANTITIES: [Quantity; 6] = [
    Quantity::ShareIntegration,
    Quantity::ShareSearch,
    Quantity::ShareHistory,
    Quantity::ShareContact,
    Quantity::ShareBonds,
    Quantity::ShareExternal,
];

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// What the paper prints of a model; what it does not tell apart is one part at the end.
fn of_paper(view: &View<'_>, model: Model) -> Option<Bar> {
    let share = |quantity| view.published.value(quantity, Some(model), None);
    let known: Vec<(usize, f64)> =
        QUANTITIES.into_iter().enumerate().filter_map(|(k, quantity)| Some((k, share(quantity)?))).collect();
    if known.is_empty() {
        return None;
    }
    let rest = 1.0 - known.iter().map(|(_, share)| share).sum::<f64>();
    let part = |(k, share): (usize, f64)| {
        (share, format!("p{k} faint"), format!("paper, {model}: {} {}", Procedures::NAMES[k], percent(share)))
    };
    let rest = (rest, "p6 faint".to_owned(), format!("paper, {model}: {} that are not told apart", percent(rest)));
    Some(Bar { label: format!("{model}, paper"), parts: known.into_iter().map(part).chain([rest]).collect() })
}

fn bars(view: &View<'_>, machine: usize) -> Vec<Bar> {
    let here = |measured: &Measured| {
        let shares = measured.procedures.shares().into_iter().enumerate();
        let part = |(k, share): (usize, f64)| {
            (share, format!("p{k}"), format!("{}: {} {}", measured.model, Procedures::NAMES[k], percent(share)))
        };
        Bar { label: format!("{}, here", measured.model), parts: shares.map(part).collect() }
    };
    let pair = |measured: &Measured| [Some(here(measured)), of_paper(view, measured.model)];
    view.at(machine, Mode::Paper).into_iter().flat_map(pair).flatten().collect()
}

pub(super) fn section(view: &View<'_>) -> String {
    let mut charts = String::from("<div class=\"charts\">\n");
    let mut rows = Vec::new();
    for (place, machine) in view.record.machines.iter().enumerate() {
        let found = view.at(place, Mode::Paper);
        if found.is_empty() {
            continue;
        }
        let about = format!("Shares of procedures in a step in paper mode on {}", called(machine));
        charts += "<figure>";
        charts += &stacked(&bars(view, place), &about);
        charts += &conditions(view, found.iter().copied());
        charts += "</figure>\n";
        for measured in found {
            let shares = measured.procedures.shares().map(percent);
            rows.push([vec![measured.model.to_string(), machine.word.clone()], shares.to_vec()].concat());
        }
    }
    for model in Model::ALL {
        let printed = QUANTITIES.map(|quantity| {
            if let Some(share) = view.published.value(quantity, Some(model), None) {
                return percent(share);
            }
            let bonded = model >= Model::BPM;
            let range = view.published.find(quantity, None, None).and_then(|value| value.range);
            let applies = match quantity {
                Quantity::ShareHistory => model > Model::GN,
                Quantity::ShareBonds => bonded,
                _ => true,
            };
            match range {
                Some([low, high]) if applies => format!("{} to {}", percent(low), percent(high)),
                _ => "\u{2013}".to_owned(),
            }
        });
        rows.push([vec![model.to_string(), "paper".to_owned()], printed.to_vec()].concat());
    }
    charts += "</div>\n";
    let mut entries: Vec<(String, String)> =
        Procedures::NAMES.iter().enumerate().map(|(k, name)| (format!("p{k}"), (*name).to_owned())).collect();
    entries.push(("p6".to_owned(), "not told apart by the paper".to_owned()));
    let head = [&["model", "on"], &Procedures::NAMES[..]].concat();
    let body = key(&entries) + &charts + &table(&head, &rows);
    let about = "Paper mode, with the stages of a step apart and a clock around each; per cent of their sum. On a GPU the \
                 contact history is what the search does with what pairs remember, and the kernel of contacts also adds \
                 gravity, walls and the results of bonds, so that nothing is left for \u{201c}external and \
                 boundary\u{201d}. On the CPU the search carries the history over by itself: it is in \
                 \u{201c}search\u{201d} there; heat is timed with the stages that it is part of.";
    wrapped(4, "share of each procedure", about, &body)
}
