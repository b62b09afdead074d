//! Courses of a case, and tables over temperature: files that they are measured in are read, and points that do not follow
//! each other are found.

use crate::Code;
use crate::check::COMPONENTS;
use crate::codes;
use crate::problem::Problem;
use crate::schema::{Case, Course, Force, Prescribed, Property};
use crate::structure::suggestion;
use crate::table;
use crate::tree::Node;
use std::path::Path;

/// A course of a case, and the keys that lead to it.
type Found<'c> = (Vec<String>, &'c mut Course);

/// Reads what is in files, and checks all courses.
pub(crate) fn settle(case: &mut Case, tree: &Node, base_dir: &Path) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (keys, course) in all(case) {
        let path: Vec<&str> = keys.iter().map(String::as_str).collect();
        if let Course::Measured(measured) = course {
            let columns = [("time", measured.time.as_str()), ("value", measured.value.as_str())];
            match read(&measured.file, columns, measured.time_factor.get(), base_dir) {
                Ok(points) => *course = Course::Points(points),
                Err(fault) => problems.push(fault.problem(tree, &path)),
            }
        } else if let Course::Points(points) = course {
            problems.extend(backwards(points).map(|(point, before, after)| {
                let place = tree.place(&[&path[..], &[&point.to_string()]].concat());
                Problem::new(codes::INVERTED_RANGE, format!("the course goes from {before} s to {after} s"))
                    .at(place, "must be later than the point before it")
                    .help("give points [time in s, value] in the order of time; a jump takes a short time")
            }));
        }
    }
    for (keys, property) in properties(case) {
        let path: Vec<&str> = keys.iter().map(String::as_str).collect();
        if let Property::Measured(measured) = property {
            let columns = [("temperature", measured.temperature.as_str()), ("value", measured.value.as_str())];
            match read(&measured.file, columns, 1.0, base_dir) {
                Ok(points) => *property = Property::Points(points),
                Err(fault) => problems.push(fault.problem(tree, &path)),
            }
        } else if let Property::Points(points) = property {
            problems.extend(backwards(points).map(|(point, before, after)| {
                let place = tree.place(&[&path[..], &[&point.to_string()]].concat());
                let message = format!("the table goes from a temperature of {before} to {after}");
                Problem::new(codes::INVERTED_RANGE, message)
                    .at(place, "must be warmer than the point before it")
                    .help("give points [temperature, value] from cold to warm; a jump takes a small step")
            }));
        }
    }
    problems
}

/// All properties of a case that may depend on temperature.
fn properties(case: &mut Case) -> Vec<(Vec<String>, &mut Property)> {
    let mut found = Vec::new();
    for (name, material) in &mut case.material {
        let path = ["material".to_owned(), name.clone()];
        let of = [
            ("thermal_conductivity", material.thermal_conductivity.as_mut()),
            ("specific_heat", material.specific_heat.as_mut()),
        ];
        found.extend(of.into_iter().filter_map(|(key, property)| Some((below(&path, &[key]), property?))));
    }
    for (k, joint) in case.bond.iter_mut().enumerate() {
        let path = ["bond".to_owned(), k.to_string()];
        let of = [
            ("stiffness_over_temperature", joint.stiffness_over_temperature.as_mut()),
            ("strength_over_temperature", joint.strength_over_temperature.as_mut()),
        ];
        found.extend(of.into_iter().filter_map(|(key, property)| Some((below(&path, &[key]), property?))));
    }
    found
}

/// All courses of a case.
fn all(case: &mut Case) -> Vec<Found<'_>> {
    let mut found = Vec::new();
    let index = |table: &str, k: usize| vec![table.to_owned(), k.to_string()];
    for (k, group) in case.particles.iter_mut().enumerate() {
        driven(&index("particles", k), &mut group.prescribed, &mut group.force, &mut found);
    }
    for (k, zone) in case.zone.iter_mut().enumerate() {
        driven(&index("zone", k), &mut zone.prescribed, &mut zone.force, &mut found);
    }
    let walls = case.wall.iter_mut().map(|wall| &mut wall.temperature).enumerate().map(|entry| ("wall", entry));
    let boxes = case.boxes.iter_mut().map(|of| &mut of.temperature).enumerate().map(|entry| ("box", entry));
    for (table, (k, temperature)) in walls.chain(boxes) {
        found.extend(temperature.iter_mut().map(|course| (below(&index(table, k), &["temperature"]), course)));
    }
    for (k, curve) in case.curve.iter_mut().enumerate() {
        let path = index("curve", k);
        let values = curve.against.iter_mut().map(|against| &mut against.values).enumerate();
        found.extend(values.map(|(n, course)| (below(&path, &["against", &n.to_string(), "values"]), course)));
    }
    for (k, surface) in case.surface.iter_mut().enumerate() {
        let path = index("surface", k);
        let convection = surface.convection.as_mut().map(|c| &mut c.temperature);
        let radiation = surface.radiation.as_mut().map(|r| &mut r.temperature);
        let courses = [
            (&["temperature"][..], surface.temperature.as_mut()),
            (&["flux"], surface.flux.as_mut()),
            (&["convection", "temperature"], convection),
            (&["radiation", "temperature"], radiation),
        ];
        found.extend(courses.into_iter().filter_map(|(keys, course)| Some((below(&path, keys), course?))));
    }
    found
}

fn below(path: &[String], keys: &[&str]) -> Vec<String> {
    path.iter().cloned().chain(keys.iter().map(|&key| key.to_owned())).collect()
}

fn driven<'c>(path: &[String], prescribed: &'c mut Prescribed, force: &'c mut Force, found: &mut Vec<Found<'c>>) {
    let rates =
        prescribed.components_mut().into_iter().zip(COMPONENTS).map(|(course, (_, name))| ("prescribed", name, course));
    let forces = force.components_mut().into_iter().zip(COMPONENTS).map(|(course, (_, name))| ("force", name, course));
    found.extend(rates.chain(forces).filter_map(|(key, name, course)| Some((below(path, &[key, name]), course?))));
}

/// Points that do not follow those before them: their indices, and both times or temperatures.
fn backwards(points: &[[f64; 2]]) -> impl Iterator<Item = (usize, f64, f64)> {
    let times = |k: usize| (k, points[k - 1][0], points[k][0]);
    (1..points.len()).map(times).filter(|(_, before, after)| before >= after)
}

/// What is wrong with a file.
struct Fault {
    code: Code,
    /// The key of the course that it is about.
    key: &'static str,
    what: String,
    help: String,
}

impl Fault {
    /// The same of the course or table to which these keys lead.
    fn problem(self, tree: &Node, path: &[&str]) -> Problem {
        let place = tree.place(&[path, &[self.key]].concat());
        Problem::new(self.code, self.what).at(place, "see there").help(self.help)
    }
}

/// Points of a file: keys and names of two columns, and what multiplies the first, which ascends.
fn read(file: &str, columns: [(&'static str, &str); 2], factor: f64, base_dir: &Path) -> Result<Vec<[f64; 2]>, Fault> {
    let path = base_dir.join(file);
    let name = path.display();
    let fault = |code, key, what: String, help: &str| Fault { code, key, what, help: help.to_owned() };
    let text = table::read(&path).map_err(|error| {
        let help = "paths are relative to the folder of the case";
        fault(codes::CSV_UNREADABLE, "file", format!("cannot read {name}: {error}"), help)
    })?;
    let mut lines = table::lines(&text);
    let Some((_, header)) = lines.next() else {
        return Err(fault(codes::CSV_EMPTY, "file", format!("{name} is empty"), "its first line names the columns"));
    };
    let known: Vec<&str> = header.split(',').map(|column| column.trim().trim_matches('"')).collect();
    let [along, _] = columns.map(|(key, _)| key);
    let column = |(key, wanted): (&'static str, &str)| {
        known.iter().position(|column| *column == wanted).ok_or_else(|| {
            let what = format!("{name} has no column `{wanted}`");
            fault(codes::CSV_COLUMN, key, what, &suggestion(wanted, &known))
        })
    };
    let chosen = [column(columns[0])?, column(columns[1])?];
    let mut points = Vec::new();
    for (number, line) in lines {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let value = |column: usize| fields.get(column).and_then(|f| f.parse::<f64>().ok()).filter(|v| v.is_finite());
        let [Some(place), Some(value)] = chosen.map(value) else {
            let what = format!("{name}:{number}: `{line}` has no numbers in both columns");
            return Err(fault(codes::CSV_VALUE, "file", what, "numbers look like 1.5e-3, with commas between"));
        };
        points.push([place * factor, value]);
    }
    if points.is_empty() {
        return Err(fault(
            codes::CSV_EMPTY,
            "file",
            format!("{name} has no rows"),
            &format!("each row is a {along} and a value"),
        ));
    }
    if table::is_cut_off(&text) {
        let what = format!("{name} does not end with a line break: its last line may be cut off");
        return Err(fault(codes::CSV_TRUNCATED, "file", what, "write the file again"));
    }
    if let Some((_, before, after)) = backwards(&points).next() {
        let unit = if along == "time" { " s" } else { "" };
        let what = format!("{name}: {along} goes from {before}{unit} to {after}{unit}");
        let help = format!("rows follow each other, from the lowest {along} on");
        return Err(fault(codes::INVERTED_RANGE, "file", what, &help));
    }
    Ok(points)
}
