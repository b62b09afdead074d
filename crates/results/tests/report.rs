//! The page about a run: all that belongs to it is there, and it loads nothing.

mod common;

use std::fs;
use std::path::Path;
use tdem_results::curve::{Axis, Curve};
use tdem_results::report::{Subject, write};
use tdem_results::{Error, Event, RunDirectory};

fn subject() -> Subject {
    let axis = |column: &str| Axis { column: column.into(), factor: 1.0, offset: 0.0, title: None };
    let against = vec![("hand & pencil".to_owned(), vec![[0.0, 0.0], [0.02, 0.5]])];
    let speed = Curve { name: "speed".into(), x: axis("time"), y: axis("largest_speed"), against };
    let missing = Curve { name: "missing".into(), x: axis("time"), y: axis("nothing"), against: Vec::new() };
    Subject {
        title: "Balls <fall> & \"rest\"".into(),
        facts: vec![("model".into(), "GNTM".into()), ("duration".into(), "0.04 s".into())],
        curves: vec![speed, missing],
        materials: vec!["glass".into()],
        problem: None,
    }
}

fn page(run: &Path) -> String {
    let path = write(run, &subject(), None).expect("the page can be written");
    assert_eq!(path, run.join("report.html"));
    fs::read_to_string(path).expect("the page can be read")
}

#[test]
fn a_page_holds_all_that_a_run_left() {
    let folder = tempfile::tempdir().expect("a folder");
    common::run_new(folder.path(), 400);
    let page = page(folder.path());
    well_formed(&page);
    assert!(page.contains("<h1>Balls &lt;fall&gt; &amp; &quot;rest&quot;</h1>"));
    for part in
        ["<strong>finished</strong> step 400", "<dt>particles</dt><dd>100</dd>", "<dd>GNTM</dd>", "energy error"]
    {
        assert!(page.contains(part), "`{part}` is not there");
    }
    for section in ["summary", "pictures", "curves", "energy", "motion", "case", "files"] {
        assert!(page.contains(&format!("<section id=\"{section}\">")), "there is no section {section}");
    }
    let pictures = page.matches("src=\"data:image/png;base64,").count();
    assert_eq!(pictures, 10, "two series of five");
    let charts = page.matches("<figure class=\"chart\">").count();
    assert_eq!(charts, 4, "a curve, energies, their error, speeds: nothing has touched yet");
    assert_eq!(page.matches("<svg viewBox=").count(), charts, "each chart is drawn without a script");
    assert_eq!(page.matches("<script type=\"application/json\">").count(), charts);
    assert!(page.contains("hand &amp; pencil") && page.contains("in the root mean square, at most"));
    assert!(page.contains("there is no column `nothing`"), "what cannot be drawn is told");
    assert!(page.contains("# a test"), "the case is there");
    assert!(!page.contains("<section id=\"heat\">") && !page.contains("<section id=\"bonds\">"));
}

#[test]
fn a_page_loads_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    common::run_new(folder.path(), 50);
    let page = page(folder.path());
    for loading in ["@import", "url(http", "fetch(", "XMLHttpRequest", "<iframe", "<object"] {
        assert!(!page.contains(loading), "{loading}");
    }
    for attribute in ["src=\"", "href=\""] {
        for target in page.split(attribute).skip(1) {
            assert!(target.starts_with("data:") || target.starts_with('#'), "{}", &target[..20]);
        }
    }
}

#[test]
fn a_run_that_failed_or_has_just_begun_has_a_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let directory = RunDirectory::create(folder.path(), "# a test\n", false).expect("a run");
    let begun = page(folder.path());
    well_formed(&begun);
    assert!(begun.contains("<strong>running</strong>"), "the folder is held by this process");
    directory.log(&Event::Warning("the step is <long>".into())).expect("it can be written");
    directory.log(&Event::Failed("the disk is full".into())).expect("it can be written");
    drop(directory);
    let failed = page(folder.path());
    assert!(failed.contains("<strong>failed</strong> the disk is full"));
    assert!(failed.contains("<section id=\"warnings\">") && failed.contains("the step is &lt;long&gt;"));
    // A row that is cut off, a picture that is none, and a log that is.
    common::run_new(&folder.path().join("other"), 100);
    let other = folder.path().join("other");
    fs::write(other.join("pictures/speed-000000000000.png"), "half").expect("it can be written");
    let log = fs::read_to_string(other.join("log.txt")).expect("it can be read");
    fs::write(other.join("log.txt"), &log[..log.len() - 60]).expect("it can be written");
    let torn = page(&other);
    well_formed(&torn);
    assert!(torn.contains("<strong>broken off</strong>"), "nobody holds it");
    assert!(matches!(write(&folder.path().join("nowhere"), &subject(), None), Err(Error::NotARun { .. })));
}

/// Every element that begins ends, in the right order.
fn well_formed(page: &str) {
    const EMPTY: [&str; 3] = ["meta", "link", "img"];
    assert!(page.starts_with("<!DOCTYPE html>"));
    let mut open: Vec<&str> = Vec::new();
    let mut rest = &page["<!DOCTYPE html>".len()..];
    while let Some(begin) = rest.find('<') {
        let tag = &rest[begin + 1..];
        let end = tag.find('>').expect("a tag ends");
        let (inside, after) = (&tag[..end], &tag[end + 1..]);
        rest = after;
        if let Some(name) = inside.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "before `{}`", &after[..after.len().min(60)]);
            continue;
        }
        let name = inside.split([' ', '\n']).next().expect("a tag has a name");
        if EMPTY.contains(&name) || inside.ends_with('/') {
            continue;
        }
        if ["script", "style"].contains(&name) {
            let close = format!("</{name}>");
            rest = &rest[rest.find(&close).expect("it ends") + close.len()..];
            continue;
        }
        open.push(name);
    }
    assert_eq!(open, Vec::<&str>::new());
}
