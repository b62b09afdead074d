//! Spheres from a table in a file.

use super::Context;
use super::draft::Spheres;
use crate::Code;
use crate::codes;
use crate::problem::Problem;
use crate::schema::{Csv, Particles};
use crate::structure::{listed, suggestion};
use crate::table;

/// Columns that a table may have; the first four it must have.
const COLUMNS: [&str; 12] = ["x", "y", "z", "radius", "vx", "vy", "vz", "wx", "wy", "wz", "id", "material"];
const REQUIRED: usize = 4;
/// Problems of one file that are shown; a wrong separator would give one per line.
const SHOWN: usize = 5;

pub(super) fn place(
    context: &Context<'_>,
    group: usize,
    particles: &Particles,
    spec: &Csv,
) -> Result<Spheres, Vec<Problem>> {
    let path = context.loaded.file(&spec.file);
    let name = path.display().to_string();
    let here = context.place(group, &["csv", "file"]);
    let fail = |code, message: String, label: &str, help: &str| {
        Problem::new(code, message).at(here.clone(), label.to_owned()).help(help.to_owned())
    };
    let text = table::read(&path).map_err(|e| {
        vec![fail(
            codes::CSV_UNREADABLE,
            format!("cannot read {name}: {e}"),
            "this file",
            "paths are relative to the folder of the case",
        )]
    })?;
    context.room_for(group, text.lines().count() as f64).map_err(|problem| vec![problem])?;
    let names: Vec<String> = context.loaded.case.material.keys().cloned().collect();
    let table = Table { names: &names, needs_material: particles.material.is_none() };
    table.read(&text).map_err(|faults| {
        let more = faults.len().saturating_sub(SHOWN);
        let mut problems: Vec<Problem> = faults
            .into_iter()
            .take(SHOWN)
            .map(|f| fail(f.code, format!("{name}:{}: {}", f.line, f.what), "in this file", &f.help))
            .collect();
        if let (Some(last), 1..) = (problems.last_mut(), more) {
            last.message = format!("{} (and {more} more problems in this file)", last.message);
        }
        problems
    })
}

/// What is wrong with a line.
#[derive(Debug)]
struct Fault {
    code: Code,
    line: usize,
    what: String,
    help: String,
}

/// What a table may hold.
struct Table<'n> {
    names: &'n [String],
    needs_material: bool,
}

impl Table<'_> {
    fn read(&self, text: &str) -> Result<Spheres, Vec<Fault>> {
        let mut lines = table::lines(text);
        let Some((header_line, header)) = lines.next() else {
            return Err(vec![Fault {
                code: codes::CSV_EMPTY,
                line: 1,
                what: "the file has no header line".to_owned(),
                help: "the first line names the columns, such as x,y,z,radius".to_owned(),
            }]);
        };
        let columns = self.columns(header_line, header)?;
        let mut spheres = Spheres::default();
        let mut faults = Vec::new();
        let mut last = header_line;
        for (line, row) in lines {
            last = line;
            if let Err(fault) = self.row(&columns, line, row, &mut spheres) {
                faults.push(fault);
            }
        }
        if table::is_cut_off(text) {
            faults.push(Fault {
                code: codes::CSV_TRUNCATED,
                line: last,
                what: "the file does not end with a line break: its last line may be cut off".to_owned(),
                help: "write the file again; if it is complete, end its last line".to_owned(),
            });
        }
        if spheres.position.is_empty() && faults.is_empty() {
            faults.push(Fault {
                code: codes::CSV_EMPTY,
                line: last,
                what: "the file has no rows".to_owned(),
                help: "each row after the header is a sphere".to_owned(),
            });
        }
        if faults.is_empty() { Ok(spheres) } else { Err(faults) }
    }

    /// Which column of the file holds what, as positions in [`COLUMNS`].
    fn columns(&self, line: usize, header: &str) -> Result<Vec<usize>, Vec<Fault>> {
        let fault = |what: String, help: String| Fault { code: codes::CSV_COLUMN, line, what, help };
        let mut faults = Vec::new();
        let mut columns: Vec<usize> = Vec::new();
        for name in header.split(',').map(|name| name.trim().trim_matches('"')) {
            match COLUMNS.iter().position(|column| *column == name) {
                Some(column) if columns.contains(&column) => {
                    faults.push(fault(format!("column `{name}` occurs twice"), "keep one of them".to_owned()));
                }
                Some(column) => columns.push(column),
                None => faults.push(fault(format!("unknown column `{name}`"), suggestion(name, &COLUMNS))),
            }
        }
        let missing: Vec<&str> =
            COLUMNS[..REQUIRED].iter().enumerate().filter(|(k, _)| !columns.contains(k)).map(|(_, c)| *c).collect();
        if !missing.is_empty() && faults.is_empty() {
            faults.push(fault(
                format!("the columns {} are missing", listed(missing)),
                "the header must name x, y, z and radius, with commas between".to_owned(),
            ));
        }
        if self.needs_material && !columns.contains(&11) && faults.is_empty() {
            faults.push(fault(
                "there is no column `material`, and the group names no material".to_owned(),
                "add `material = \"...\"` to the group, or the column to the file".to_owned(),
            ));
        }
        if faults.is_empty() { Ok(columns) } else { Err(faults) }
    }

    fn row(&self, columns: &[usize], line: usize, row: &str, spheres: &mut Spheres) -> Result<(), Fault> {
        let fault = |what: String, help: &str| Fault { code: codes::CSV_VALUE, line, what, help: help.to_owned() };
        let fields: Vec<&str> = row.split(',').map(str::trim).collect();
        if fields.len() != columns.len() {
            return Err(Fault {
                code: codes::CSV_TRUNCATED,
                line,
                what: format!("{} values, but the header names {} columns", fields.len(), columns.len()),
                help: "the file is cut off, or a separator is missing".to_owned(),
            });
        }
        let mut number = [0.0; 10];
        let (mut id, mut material) = (None, None);
        for (&column, field) in columns.iter().zip(&fields) {
            match column {
                10 => {
                    let value = field.parse::<u32>().ok().filter(|&id| id < u32::MAX);
                    id = Some(value.ok_or_else(|| {
                        fault(format!("`{field}` is not an id"), "ids are whole numbers from 0 to 4294967294")
                    })?);
                }
                11 => {
                    let name = field.trim_matches('"');
                    let index = self.names.iter().position(|n| n == name).ok_or_else(|| {
                        let known: Vec<&str> = self.names.iter().map(String::as_str).collect();
                        fault(format!("there is no material `{name}`"), &suggestion(name, &known))
                    })?;
                    material = Some(index as u16);
                }
                _ => {
                    let value = field.parse::<f64>().ok().filter(|value| value.is_finite());
                    number[column] = value.ok_or_else(|| {
                        fault(
                            format!("`{field}` in column `{}` is not a number", COLUMNS[column]),
                            "numbers look like 1.5e-3",
                        )
                    })?;
                }
            }
        }
        let [x, y, z, radius, vx, vy, vz, wx, wy, wz] = number;
        if radius <= 0.0 {
            return Err(fault(format!("radius is {radius} m, but must be above 0"), "lengths are in metres"));
        }
        spheres.position.push([x, y, z]);
        spheres.radius.push(radius);
        spheres.velocity.push([vx, vy, vz]);
        spheres.angular_velocity.push([wx, wy, wz]);
        spheres.id.extend(id);
        spheres.material.extend(material);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Spheres, Vec<Fault>> {
        let names = ["glass".to_owned(), "steel".to_owned()];
        Table { names: &names, needs_material: false }.read(text)
    }
    fn code(text: &str) -> (&'static str, usize) {
        let faults = read(text).unwrap_err();
        (faults[0].code.name, faults[0].line)
    }

    #[test]
    fn columns_in_any_order() {
        let spheres = read("# spheres\nradius, x, y, z, id, material, vx\n0.5, 1, 2, 3, 7, steel, 0.1\n").unwrap();
        assert_eq!(spheres.position, [[1.0, 2.0, 3.0]]);
        assert_eq!((spheres.radius[0], spheres.id[0], spheres.material[0]), (0.5, 7, 1));
        assert_eq!(spheres.velocity, [[0.1, 0.0, 0.0]]);
    }

    #[test]
    fn faults_name_their_line() {
        assert_eq!(code(""), ("tdem::case::csv-empty", 1));
        assert_eq!(code("x,y,z,radius\n"), ("tdem::case::csv-empty", 1));
        assert_eq!(code("x,y,z,radios\n1,2,3,4\n"), ("tdem::case::csv-column", 1));
        assert_eq!(code("x,y,z\n1,2,3\n"), ("tdem::case::csv-column", 1));
        assert_eq!(code("x,y,z,radius\n1,2,3,4\n1,2,three,4\n"), ("tdem::case::csv-value", 3));
        assert_eq!(code("x,y,z,radius\n1,2,3,-4\n"), ("tdem::case::csv-value", 2));
        assert_eq!(code("x,y,z,radius\n1,2,3,nan\n"), ("tdem::case::csv-value", 2));
        assert_eq!(code("x,y,z,radius,id\n1,2,3,4,1.5\n"), ("tdem::case::csv-value", 2));
        assert_eq!(code("x,y,z,radius,material\n1,2,3,4,glas\n"), ("tdem::case::csv-value", 2));
    }

    #[test]
    fn a_file_that_was_cut_off_is_noticed() {
        assert_eq!(code("x,y,z,radius\n1,2,3,4\n1,2,"), ("tdem::case::csv-truncated", 3));
        assert_eq!(code("x,y,z,radius\n1,2,3,4.5"), ("tdem::case::csv-truncated", 2));
    }
}
