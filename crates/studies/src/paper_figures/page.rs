//! The page: figures 3 to 7 of the paper from measured data, beside what it prints. One file of HTML that loads nothing.

mod cores;
mod memory;
mod overhead;
mod roofline;
mod scaling;
mod shares;

use super::chart::escaped;
use super::figures::View;
use super::published::{On, Value};
use super::{Machine, Measured, Mode, Model, Published, Quantity, Record};
use std::collections::BTreeSet;
use std::fmt::Write;
use tdem_results::words::grouped;

/// The page of a record.
#[must_use]
pub fn page(record: &Record) -> String {
    let published = Published::read();
    let view = View { record, published: &published };
    let mut text = String::from("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    text += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
    text += "<title>tdem: the paper's figures on this machine</title>\n<style>\n";
    text += include_str!("page.css");
    text += "</style>\n</head>\n<body>\n";
    text += &opening(&view);
    text += &memory::section(&view);
    text += &shares::section(&view);
    text += &scaling::section(&view);
    text += &overhead::section(&view);
    text += &roofline::section(&view);
    text += &measurements(&view);
    text += &printed(&view);
    text + "</body>\n</html>\n"
}

/// What was done, on what, and how it compares.
fn opening(view: &View<'_>) -> String {
    let (record, published) = (view.record, view.published);
    let mut text = String::from("<h1>The paper\u{2019}s figures 3 to 7 on this machine</h1>\n");
    let _ = writeln!(
        text,
        "<p>{}: <i>{}</i>, {}, measures five models of the discrete element method on one {} and on {}. Here the same \
         models ran in the same applications at the same sizes with tdem {}, in double precision, with no energy ledger, in \
         two ways: <b>paper mode</b> is Gear\u{2019}s integrator and a search in every step, as in the paper; <b>best \
         mode</b> is velocity Verlet and a search when it is due, as this program runs by default.</p>",
        escaped(&published.authors),
        escaped(&published.title),
        escaped(&published.published_in),
        escaped(&published.gpu),
        escaped(&published.cpu),
        escaped(&record.version)
    );
    let applications = [Model::GNTM, Model::BPM, Model::TBPM].map(Model::application);
    let _ = writeln!(
        text,
        "<p>GN, GNT and GNTM run in the {}, BPM in the {}, TBPM in the {}.</p>",
        applications[0], applications[1], applications[2]
    );
    let done = record.measurements.len();
    if done < record.planned {
        let _ = writeln!(text, "<p><b>{done} of {} measurements are on this page.</b></p>", record.planned);
    }
    text += "<div class=\"wide\"><table><tr><th class=\"text\">device</th><th class=\"text\">driver</th>\
             <th>a copy moves</th><th>operations at most</th><th>P100 scaled by</th></tr>\n";
    for machine in &record.machines {
        let _ = writeln!(
            text,
            "<tr><td>{}</td><td class=\"text\">{}</td><td>{} GB/s</td><td>{} GOp/s</td><td>{}</td></tr>",
            escaped(&machine.name),
            escaped(&machine.driver),
            digits(1e-9 * machine.copy_bytes_per_second),
            digits(1e-9 * machine.operations_per_second),
            digits(view.scaled(1.0, machine))
        );
    }
    text += "</table></div>\n<p class=\"soft\">A copy counts bytes read and bytes written. At most: additions and \
             multiplications in 64 bits, never fused. \u{201c}P100 scaled\u{201d} is the paper\u{2019}s number times the \
             copy bandwidth of this device over the 549 GB/s that the paper states for its card: a scaling that says what \
             the newer memory alone would give, not a measurement.</p>\n";
    let _ = writeln!(text, "<p>Made with <code>{}</code></p>", escaped(&record.command));
    for line in &record.left_out {
        let _ = writeln!(text, "<p class=\"soft\">Left out: {}.</p>", escaped(line));
    }
    text
}

/// A section with its figure.
fn section(number: u32, title: &str, about: &str, body: &str) -> String {
    format!("<section id=\"figure-{number}\">\n<h2>Figure {number}: {title}</h2>\n<p>{about}</p>\n{body}</section>\n")
}

/// What a figure was measured with: device, driver, numbers of particles, steps, version.
fn conditions<'a>(view: &View<'_>, measured: impl IntoIterator<Item = &'a Measured>) -> String {
    let measured: Vec<&Measured> = measured.into_iter().collect();
    let machines: BTreeSet<usize> = measured.iter().map(|measured| measured.machine).collect();
    let of = |place: usize| {
        let machine = view.machine(place);
        let its = || measured.iter().filter(|measured| measured.machine == place);
        let particles: BTreeSet<usize> = its().map(|measured| measured.particles).collect();
        let particles: Vec<String> = particles.into_iter().map(|count| grouped(count as u64)).collect();
        let steps = its().fold([u64::MAX, 0], |[low, high], m| [low.min(m.steps), high.max(m.steps)]);
        let steps = match steps {
            [1, 1] => "1 step".to_owned(),
            [low, high] if low == high => format!("{} steps", grouped(low)),
            steps => format!("{} steps", range(steps)),
        };
        let repeats = its().map(|measured| measured.repeats).max().unwrap_or(0);
        format!(
            "{} ({}); N = {}; best of {repeats} measurements of {steps}",
            escaped(&machine.name),
            escaped(&machine.driver),
            particles.join(", ")
        )
    };
    let lines: Vec<String> = machines.into_iter().map(of).collect();
    format!("<figcaption>{}; tdem {}.</figcaption>\n", lines.join(". "), escaped(&view.record.version))
}

fn range([low, high]: [u64; 2]) -> String {
    format!("{} to {}", grouped(low), grouped(high))
}

/// Three digits.
fn digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "\u{2013}".to_owned();
    }
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if (1e-3..1e5).contains(&rounded.abs()) { format!("{rounded}") } else { format!("{value:.2e}") }
}

/// The same of what may not be there.
fn maybe(value: Option<f64>) -> String {
    value.map_or_else(|| "\u{2013}".to_owned(), digits)
}

/// A number at an axis.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if (1e-3..1e4).contains(&rounded.abs()) || rounded == 0.0 { format!("{rounded}") } else { format!("{rounded:e}") }
}

/// Numbers of particles at an axis.
fn particles(value: f64) -> String {
    if value >= 1e6 { format!("{}M", short(1e-6 * value)) } else { format!("{}k", short(1e-3 * value)) }
}

/// A machine's name; of a processor the threads, too.
fn called(machine: &Machine) -> String {
    let threads = machine.threads.map(|_| format!(", {}", machine.word));
    machine.name.clone() + threads.as_deref().unwrap_or_default()
}

/// The class that gives a model its colour.
fn colour(model: Model) -> String {
    format!("c{}", Model::ALL.iter().position(|&other| other == model).unwrap_or(0))
}

/// Entries of a key: a class of its mark, and what it means.
fn key(entries: &[(String, String)]) -> String {
    let mut text = String::from("<ul class=\"key\">");
    for (class, meaning) in entries {
        let _ = write!(text, "<li><i class=\"{class}\"></i>{meaning}</li>");
    }
    text + "</ul>\n"
}

/// Models in their colours.
fn models(view: &View<'_>) -> Vec<(String, String)> {
    let shown = |model: &Model| view.record.measurements.iter().any(|measured| measured.model == *model);
    Model::ALL.into_iter().filter(shown).map(|model| (colour(model), model.to_string())).collect()
}

/// A table; the first column is text.
fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let mut text = String::from("<div class=\"wide\"><table><tr>");
    for cell in head {
        let _ = write!(text, "<th>{cell}</th>");
    }
    text += "</tr>\n";
    for row in rows {
        text += "<tr>";
        for cell in row {
            let _ = write!(text, "<td>{cell}</td>");
        }
        text += "</tr>\n";
    }
    text + "</table></div>\n"
}

/// All measurements.
fn measurements(view: &View<'_>) -> String {
    let row = |measured: &Measured| {
        vec![
            measured.model.to_string(),
            measured.size.to_string(),
            mode_words(measured.mode).to_owned(),
            view.machine(measured.machine).word.clone(),
            grouped(measured.particles as u64),
            grouped(measured.bonds as u64),
            grouped(measured.contacts as u64),
            grouped(measured.steps),
            grouped(measured.searches),
            digits(1e3 * measured.seconds_per_step),
            digits(1e3 * measured.median_seconds_per_step),
            digits(measured.cundall()),
            digits(1e-9 * measured.memory_bytes),
            format!("<code>{:.8}</code>", measured.hash),
        ]
    };
    let rows: Vec<_> = view.record.measurements.iter().map(row).collect();
    let head = [
        "model",
        "size",
        "mode",
        "on",
        "N",
        "bonds",
        "contacts",
        "steps",
        "searches",
        "ms/step",
        "median",
        "particle-steps/s",
        "GB",
        "hash",
    ];
    format!("<section id=\"measurements\">\n<h2>All measurements</h2>\n{}</section>\n", table(&head, &rows))
}

/// All numbers of the paper that this page uses.
fn printed(view: &View<'_>) -> String {
    let mut text = String::from(
        "<section id=\"printed\">\n<h2>What the paper prints</h2>\n<div class=\"wide\"><table><tr>\
         <th class=\"text\">quantity</th><th class=\"text\">of</th><th>number</th><th class=\"text\">printed</th>\
         <th class=\"text\">derived</th><th class=\"text\">where</th></tr>\n",
    );
    for value in &view.published.values {
        let of =
            [value.model.map(|model| model.to_string()), value.device.map(|device| device_word(device).to_owned())];
        let of: Vec<String> = of.into_iter().flatten().collect();
        let _ = writeln!(
            text,
            "<tr><td>{}</td><td class=\"text\">{}</td><td>{}</td><td class=\"text\">{}</td><td class=\"text\">{}</td>\
             <td class=\"text\">{}</td></tr>",
            quantity_words(value.quantity),
            of.join(", "),
            number(value),
            escaped(&value.printed),
            escaped(value.derived.as_deref().unwrap_or("")),
            escaped(&value.place)
        );
    }
    text + "</table></div>\n</section>\n"
}

fn device_word(device: On) -> &'static str {
    match device {
        On::Gpu => "P100",
        On::Cpu => "Xeons",
    }
}

/// A published number and its unit.
fn number(value: &Value) -> String {
    let unit = if value.unit == "1" { String::new() } else { format!(" {}", value.unit) };
    match (value.value, value.range) {
        (Some(value), _) => digits_of_paper(value) + &unit,
        (None, Some([low, high])) => format!("{} to {}{unit}", digits_of_paper(low), digits_of_paper(high)),
        (None, None) => String::new(),
    }
}

/// A published number that may not be there.
fn maybe_of_paper(value: Option<f64>) -> String {
    value.map_or_else(|| "\u{2013}".to_owned(), digits_of_paper)
}

/// A published number as it is, without rounding.
fn digits_of_paper(value: f64) -> String {
    if value.abs() >= 1e5 { format!("{value:e}") } else { format!("{value}") }
}

fn quantity_words(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Bandwidth => "bandwidth",
        Quantity::Cores => "cores",
        Quantity::MemoryAtMost => "memory, at most",
        Quantity::MemoryOverGn => "memory over that of GN",
        Quantity::ShareIntegration => "share of integration",
        Quantity::ShareSearch => "share of search",
        Quantity::ShareHistory => "share of contact history",
        Quantity::ShareContact => "share of contact forces",
        Quantity::ShareBonds => "share of bonds",
        Quantity::ShareExternal => "share of external and boundary",
        Quantity::ContactTimeOverGn => "time of contact forces over that of GN",
        Quantity::ContactTimeOverGnt => "time of contact forces over that of GNT",
        Quantity::Cundall => "Cundall number",
        Quantity::SpeedUp => "GPU over CPU",
        Quantity::SpeedUpAtMost => "GPU over CPU, at most",
        Quantity::TimeOverGn => "time over that of GN",
        Quantity::OperationsOfContact => "operations of a contact",
        Quantity::ContactsAtMost => "contacts of a particle, at most",
        Quantity::BytesOfContacts => "bytes of a particle\u{2019}s contacts",
        Quantity::OperationsOfBond => "operations of a bond",
        Quantity::BytesOfBond => "bytes of a bond",
    }
}

/// How the modes are called.
fn mode_words(mode: Mode) -> &'static str {
    match mode {
        Mode::Paper => "paper mode",
        Mode::Best => "best mode",
    }
}

#[cfg(test)]
mod tests;
