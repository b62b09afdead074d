//! The processor by the core: how fast one is, and what of that is left where all work.

use super::super::figures::View;
use super::super::{Measured, Mode, Model, Quantity};
use super::{digits, escaped, grouped, maybe, mode_words, table};
use std::fmt::Write;

/// What one core of the paper does: its GPU's rate over the largest speed-up, over the number of cores.
fn of_paper(view: &View<'_>, model: Model) -> Option<f64> {
    let (_, most) = view.published_speed_up(model)?;
    Some(view.cundall(model)? / most / view.published.constant(Quantity::Cores))
}

/// A table for each number of threads beside that of one thread.
pub(super) fn tables(view: &View<'_>) -> String {
    let machines = view.record.machines.iter().enumerate();
    let Some((one, single)) = machines.clone().find(|(_, machine)| machine.threads == Some(1)) else {
        return String::new();
    };
    let mut text = String::new();
    for (all, machine) in machines {
        let Some(threads) = machine.threads.filter(|&threads| threads > 1) else { continue };
        let mut rows = Vec::new();
        for mode in Mode::ALL {
            for alone in Model::ALL.into_iter().flat_map(|model| view.series(one, mode, model)) {
                let together = view.one(all, mode, alone.model, alone.size).map(Measured::cundall);
                let each = together.map(|rate| rate / threads as f64);
                let kept =
                    each.map_or("\u{2013}".to_owned(), |each| format!("{:.0} %", 100.0 * each / alone.cundall()));
                let printed = if mode == Mode::Paper { of_paper(view, alone.model) } else { None };
                rows.push(vec![
                    alone.model.to_string(),
                    mode_words(mode).to_owned(),
                    grouped(alone.particles as u64),
                    digits(alone.cundall()),
                    maybe(together),
                    maybe(each),
                    kept,
                    maybe(printed),
                ]);
            }
        }
        if rows.is_empty() {
            continue;
        }
        let each = format!("each of {threads}");
        let head = [
            "particle-steps/s",
            "mode",
            "N",
            &single.word,
            &machine.word,
            &each,
            "of one alone",
            "paper\u{2019}s core, derived",
        ];
        let _ = writeln!(text, "<p>{}, by the core:</p>\n{}", escaped(&machine.name), table(&head, &rows));
    }
    if !text.is_empty() {
        text += "<p class=\"soft\">The paper prints no rates of its processors. Derived: the Cundall number of its GPU over the \
                 largest speed-up that it prints, over its 20 cores, though both need not be of the same size.</p>\n";
    }
    text
}
