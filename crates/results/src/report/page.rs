//! The page, from its title to the list of files.

use super::Subject;
use super::figures::{Group, of_curve, of_history};
use super::history::History;
use super::html::{bytes, escape, grouped, shown};
use super::images;
use super::story::Story;
use crate::error::Error;
use crate::files::entries;
use crate::frame_list;
use crate::run_directory::{CASE, CHECKPOINTS, FRAMES, HISTORY, PICTURES, REPORT};
use crate::start;
use std::fmt::Write;
use std::fs;
use std::path::Path;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("charts.js");

/// The page of a run.
pub(super) fn page(run: &Path, subject: &Subject) -> Result<String, Error> {
    let story = Story::of(run);
    let path = run.join(HISTORY);
    // A run that has just begun has none.
    let text = fs::read_to_string(&path).unwrap_or_default();
    let history = History::read(&text);
    let folder = run.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let title = if subject.title.is_empty() { &folder } else { &subject.title };

    let mut sections = Vec::new();
    let mut section = |id: &'static str, title: &'static str, body: String| {
        if !body.is_empty() {
            sections.push((id, title, body));
        }
    };
    section("summary", "Summary", summary(subject, &story, &history));
    section("warnings", "Warnings", warnings(subject, &story, &history));
    section("pictures", "Pictures", images::html(run, &subject.materials)?);
    section("curves", "Curves", curves(&path, &text, subject));
    let groups = of_history(&history);
    let drawn: Vec<(&'static str, &'static str, String)> = groups.iter().map(of_group).collect();
    for (id, title, body) in drawn {
        section(id, title, body);
    }
    section("case", "Case", case(run));
    section("files", "Files", files(run, history.rows())?);

    let mut body = String::new();
    let _ = write!(body, "<header>\n<h1>{}</h1>\n{}", escape(title), state(&story));
    let links: Vec<String> =
        sections.iter().map(|(id, title, _)| format!("<a href=\"#{id}\">{}</a>", escape(title))).collect();
    let _ = writeln!(body, "<nav>{}</nav>\n</header>\n<main>", links.join("\n"));
    for (id, title, text) in &sections {
        let _ = writeln!(body, "<section id=\"{id}\">\n<h2>{}</h2>\n{text}</section>", escape(title));
    }
    let _ = write!(
        body,
        "</main>\n<footer><p>Made by tdem {} from what lies in <code>{}</code>.</p></footer>\n",
        env!("CARGO_PKG_VERSION"),
        escape(&folder)
    );
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n\
         <title>{}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}<script>\n{SCRIPT}</script>\n</body>\n</html>\n",
        escape(title)
    ))
}

fn state(story: &Story) -> String {
    let (word, class, more) = story.state.told();
    format!("<p class=\"state {class}\"><strong>{word}</strong> {}</p>\n", escape(&more))
}

/// What should be known at a glance.
fn summary(subject: &Subject, story: &Story, history: &History) -> String {
    let mut facts = story.facts();
    let (first, rest) = subject.facts.split_at(subject.facts.len().min(1));
    let particles = facts.iter().position(|(name, _)| name == "particles").map_or(0, |place| place + 1);
    facts.splice(particles..particles, first.iter().cloned());
    facts.extend(rest.iter().cloned());
    facts.extend(at_the_end(history));
    let entries: Vec<String> = facts
        .iter()
        .map(|(name, value)| format!("<div><dt>{}</dt><dd>{}</dd></div>\n", escape(name), escape(value)))
        .collect();
    format!("<dl class=\"facts\">\n{}</dl>\n", entries.concat())
}

/// What the last row of the history says.
fn at_the_end(history: &History) -> Vec<(String, String)> {
    let mut facts = Vec::new();
    let mut add = |name: &str, value: String| facts.push((name.to_owned(), value));
    let last = |name: &str| history.last(name);
    let count = |value: f64| grouped(value as u64);
    if let Some(time) = last("time") {
        let heat = last("heat_time").map_or(String::new(), |heat| format!(", {} s of heat", shown(heat, 5)));
        add("reached", format!("{} s{heat}", shown(time, 5)));
    }
    if let (Some(contacts), Some(walls)) = (last("contacts"), last("wall_contacts")) {
        add("contacts", format!("{}, {} with walls", count(contacts), count(walls)));
    }
    if let (Some(bonds), Some(broken)) = (last("bonds"), last("broken_bonds")) {
        let share = 100.0 * broken / (bonds + broken).max(1.0);
        add("bonds", format!("{} hold, {} broke ({} %)", count(bonds), count(broken), shown(share, 2)));
    }
    if let (Some(low), Some(high)) = (last("lowest_temperature"), last("highest_temperature")) {
        add("temperatures", format!("{} to {} K", shown(low, 5), shown(high, 5)));
    }
    if let Some((error, moved)) = energy(history) {
        add("energy error", share(error, moved, "J"));
    }
    if let Some((error, moved)) = heat(history) {
        add("heat error", share(error, moved, "J"));
    }
    facts
}

fn share(error: f64, moved: f64, unit: &str) -> String {
    let of = if moved > 0.0 {
        format!(", {} % of {} {unit} moved", shown(100.0 * (error / moved).abs(), 2), shown(moved, 3))
    } else {
        String::new()
    };
    format!("{} {unit}{of}", shown(error, 3))
}

/// The error of the energy ledger and all that it moved, J; none where no ledger was kept of losses.
fn energy(history: &History) -> Option<(f64, f64)> {
    const MOVED: [&str; 8] = [
        "kinetic_translation",
        "kinetic_rotation",
        "elastic_normal",
        "elastic_tangential",
        "elastic_bonds",
        "friction_dissipated",
        "damping_dissipated",
        "breakage_dissipated",
    ];
    let error = history.last("energy_error")?;
    Some((error, MOVED.iter().filter_map(|name| history.last(name)).map(f64::abs).sum()))
}

/// The same of the balance of heat.
fn heat(history: &History) -> Option<(f64, f64)> {
    let error = history.last("heat_error")?;
    let moved = ["heat_in", "heat_out", "heat_made"].iter().filter_map(|name| history.last(name)).map(f64::abs).sum();
    Some((error, moved))
}

/// An energy error beyond this share of what was moved is told.
const ENERGY_LIMIT: f64 = 0.05;
/// The balance of heat closes to rounding, so that far less is told.
const HEAT_LIMIT: f64 = 1e-6;

fn warnings(subject: &Subject, story: &Story, history: &History) -> String {
    let mut all: Vec<String> = subject.problem.iter().chain(&story.warnings).cloned().collect();
    let beyond = |found: Option<(f64, f64)>, limit: f64| found.filter(|(error, moved)| error.abs() > limit * moved);
    if let Some((error, moved)) = beyond(energy(history), ENERGY_LIMIT) {
        all.push(format!(
            "The energy ledger does not close: its error is {}. A shorter step makes it smaller, if it is the step's.",
            share(error, moved, "J")
        ));
    }
    if let Some((error, moved)) = beyond(heat(history), HEAT_LIMIT) {
        all.push(format!("The balance of heat does not close: its error is {}.", share(error, moved, "J")));
    }
    if all.is_empty() {
        return String::new();
    }
    let items: Vec<String> = all.iter().map(|warning| format!("<li>{}</li>\n", escape(warning))).collect();
    format!("<ul class=\"warnings\">\n{}</ul>\n", items.concat())
}

fn curves(path: &Path, history: &str, subject: &Subject) -> String {
    let mut text = String::new();
    for curve in &subject.curves {
        match of_curve(path, history, curve) {
            Ok(chart) => text += &chart.html().unwrap_or_default(),
            Err(why) => text.extend(["<p class=\"note\">", &escape(&why), "</p>\n"]),
        }
    }
    if text.is_empty() { text } else { format!("<div class=\"charts\">\n{text}</div>\n") }
}

fn of_group(group: &Group) -> (&'static str, &'static str, String) {
    let charts: Vec<String> = group.charts.iter().filter_map(super::chart::Chart::html).collect();
    let id = match group.title {
        "Heat" => "heat",
        "Bonds" => "bonds",
        "Gauges" => "gauges",
        "Energy ledger" => "energy",
        _ => "motion",
    };
    let body =
        if charts.is_empty() { String::new() } else { format!("<div class=\"charts\">\n{}</div>\n", charts.concat()) };
    (id, group.title, body)
}

fn case(run: &Path) -> String {
    let text = fs::read_to_string(run.join(CASE)).unwrap_or_default();
    format!("<details><summary>case.toml as it ran</summary>\n<pre>{}</pre>\n</details>\n", escape(&text))
}

/// What lies in the folder, and what it is.
fn files(run: &Path, rows_of_history: usize) -> Result<String, Error> {
    let mut paths = entries(run)?;
    paths.sort();
    let mut rows = String::new();
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.starts_with('.') || name == REPORT {
            continue;
        }
        // A run that goes on may remove a file at any moment.
        let Ok(metadata) = fs::metadata(&path) else { continue };
        let (count, size) = if metadata.is_dir() { held(&path)? } else { (0, metadata.len()) };
        let name = if metadata.is_dir() { format!("{name}/") } else { name };
        let count = match count {
            0 if name == HISTORY => format!(", {} rows", grouped(rows_of_history as u64)),
            0 => String::new(),
            count => format!(", {} files", grouped(count)),
        };
        let _ = writeln!(
            rows,
            "<tr><td><code>{}</code></td><td>{}</td><td>{}{count}</td></tr>",
            escape(&name),
            meaning(&name),
            bytes(size)
        );
    }
    Ok(format!("<div class=\"wide\"><table>\n{rows}</table></div>\n"))
}

/// Number of files and bytes in a folder.
fn held(folder: &Path) -> Result<(u64, u64), Error> {
    let sizes = entries(folder)?.into_iter().filter_map(|path| fs::metadata(path).ok()).map(|metadata| metadata.len());
    Ok(sizes.fold((0, 0), |(count, total), size| (count + 1, total + size)))
}

fn meaning(name: &str) -> &'static str {
    let ending = Path::new(name).extension().unwrap_or_default();
    match name {
        CASE => "the case as it ran, every default written out",
        HISTORY => "energies, counts and gauges over time, one row per recorded step",
        "log.txt" => "what happened and when",
        frame_list::FILE => "steps, times and checksums of the frames",
        start::FILE => "where particles were at the start; displacements count from there",
        _ if name.trim_end_matches('/') == FRAMES => "one file per instant, written once",
        _ if name.trim_end_matches('/') == CHECKPOINTS => "complete states; `tdem resume` goes on from the last",
        _ if name.trim_end_matches('/') == PICTURES => "pictures that were drawn as the run went on",
        _ if ending == "vtkhdf" => "for ParaView: all instants in time",
        _ if ending == "svg" => "a curve that the case asks for",
        _ => "",
    }
}
