//! Pictures of a run, as parts of the page.

use super::html::{base64, escape, grouped, shown};
use crate::error::Error;
use crate::picture::{self, Stored};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::io::Cursor;
use std::path::Path;

/// Pictures of one kind that a page holds; of more, the first, the last and some between.
const MOST: usize = 6;

/// All series of pictures; empty if there are none. Files that are not whole are left out.
pub(super) fn html(run: &Path, materials: &[String]) -> Result<String, Error> {
    let mut series: BTreeMap<String, Vec<Stored>> = BTreeMap::new();
    for stored in picture::list(run)? {
        series.entry(stored.name.clone()).or_default().push(stored);
    }
    let mut text = String::new();
    for (name, stored) in series {
        let figures: Vec<String> = spread(stored.len()).into_iter().filter_map(|k| figure(&name, &stored[k])).collect();
        let _ = writeln!(text, "<h3>{}</h3>\n<div class=\"pictures\">\n{}</div>", escape(&name), figures.concat());
    }
    // Numbers of materials mean nothing without their names.
    if text.contains("data-field=\"material\"") && !materials.is_empty() {
        let names: Vec<String> = materials.iter().enumerate().map(|(k, name)| format!("{k} {name}")).collect();
        let _ = writeln!(text, "<p class=\"note\">Materials: {}.</p>", escape(&names.join(", ")));
    }
    Ok(text)
}

/// Places spread evenly over so many, the first and the last among them.
fn spread(count: usize) -> Vec<usize> {
    if count <= MOST { (0..count).collect() } else { (0..MOST).map(|k| k * (count - 1) / (MOST - 1)).collect() }
}

fn figure(name: &str, stored: &Stored) -> Option<String> {
    let bytes = fs::read(&stored.path).ok()?;
    let reader = png::Decoder::new(Cursor::new(&bytes)).read_info().ok()?;
    let info = reader.info();
    let told = |key| picture::told(&bytes, key);
    let time = told("time").and_then(|time| time.parse::<f64>().ok());
    let time = time.map_or(String::new(), |time| format!("t = {} s, ", shown(time, 4)));
    let caption = format!("{time}step {}", grouped(stored.step));
    Some(format!(
        "<figure data-field=\"{}\"><img width=\"{}\" height=\"{}\" alt=\"{}, {}\" src=\"data:image/png;base64,{}\">\
         <figcaption>{}</figcaption></figure>\n",
        escape(&told("field").unwrap_or_default()),
        info.width,
        info.height,
        escape(name),
        escape(&caption),
        base64(&picture::without_values(&bytes)),
        escape(&caption)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_pictures_the_first_and_the_last_are_shown() {
        assert_eq!(spread(3), [0, 1, 2]);
        assert_eq!(spread(101), [0, 20, 40, 60, 80, 100]);
        assert_eq!(spread(0), Vec::<usize>::new());
    }
}
