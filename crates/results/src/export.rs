//! Particles of frames in formats of other programs.
//!
//! * extended XYZ, which OVITO reads: all instants in one file; names of materials stand for elements
//! * the text dump of LAMMPS: all instants in one file
//! * VTP, which ParaView and VisIt read: a file per instant, and a `.pvd` file that knows their times
//! * CSV: all instants in one file, with `step` and `time` in front
//!
//! Columns have the names of the glossary, and the names that the program gives them that is to read them, such as `velo` and `vx`.

use crate::error::{Action, Context, Error};
use crate::files::{atomically, parent};
use crate::info::require_run;
use crate::report::base64;
use crate::run_directory::stored_frames;
use crate::vtkhdf::array::{Array, each};
use crate::vtkhdf::block::Field;
use crate::vtkhdf::frame::{Frame, Loaded, load_particles};
use crate::words::escape;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use tdem_engine::Domain;

/// A format of another program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Extended XYZ.
    Xyz,
    /// A text dump of LAMMPS.
    Lammps,
    /// VTK's poly data in XML.
    Vtp,
    /// Values separated by commas.
    Csv,
}

/// Which instants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instants {
    /// All frames.
    All,
    /// The last frame.
    Last,
    /// The frame of a step.
    Step(u64),
}

/// Writes particles of a run, and returns the files: the last one is the one to open.
///
/// # Errors
/// [`Error::NotARun`], [`Error::NoFrames`], [`Error::NoFrameOfStep`], and whatever the file system says.
pub fn export(
    run: &Path,
    format: Format,
    instants: Instants,
    domain: &Domain,
    out: &Path,
) -> Result<Vec<PathBuf>, Error> {
    require_run(run)?;
    let frames = stored_frames(run)?.frames;
    let chosen = choose(run, &frames, instants)?;
    let folder = parent(out);
    fs::create_dir_all(folder).context(Action::CreateFolder, folder)?;
    if format == Format::Vtp {
        return vtp_series(run, chosen, out);
    }
    write(out, |file| {
        for (place, frame) in chosen.iter().enumerate() {
            let instant = Instant::load(run, frame)?;
            let text = match format {
                Format::Xyz => instant.xyz(domain),
                Format::Lammps => instant.lammps(domain, place == 0),
                Format::Csv | Format::Vtp => instant.csv(place == 0),
            };
            file.write_all(text.as_bytes()).context(Action::Write, out)?;
        }
        Ok(())
    })?;
    Ok(vec![out.to_owned()])
}

fn choose<'f>(run: &Path, frames: &'f [Frame], instants: Instants) -> Result<&'f [Frame], Error> {
    let last = frames.len().checked_sub(1).ok_or_else(|| Error::NoFrames { path: run.into() })?;
    match instants {
        Instants::All => Ok(frames),
        Instants::Last => Ok(&frames[last..]),
        Instants::Step(step) => {
            if let Some(place) = frames.iter().position(|frame| frame.step == step) {
                return Ok(&frames[place..=place]);
            }
            let nearest = frames.iter().map(|frame| frame.step).min_by_key(|other| other.abs_diff(step));
            Err(Error::NoFrameOfStep { step, nearest: nearest.unwrap_or(0), path: run.into() })
        }
    }
}

/// Writes a file whole or not at all.
fn write(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> Result<(), Error>) -> Result<(), Error> {
    atomically(path, |unfinished| {
        let mut file = BufWriter::new(File::create(unfinished).context(Action::Write, path)?);
        fill(&mut file)?;
        file.flush().context(Action::Write, path)
    })
}

/// A file per instant beside the file that lists them.
fn vtp_series(run: &Path, frames: &[Frame], out: &Path) -> Result<Vec<PathBuf>, Error> {
    let stem = out.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut paths = Vec::new();
    let mut list = String::new();
    for frame in frames {
        let name = format!("{stem}-{:012}.vtp", frame.step);
        let path = out.with_file_name(&name);
        let text = Instant::load(run, frame)?.vtp();
        write(&path, |file| file.write_all(text.as_bytes()).context(Action::Write, &path))?;
        let _ = writeln!(list, "    <DataSet timestep=\"{:?}\" file=\"{}\"/>", frame.time, escape(&name));
        paths.push(path);
    }
    let path = out.with_extension("pvd");
    let text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n  <Collection>\n{list}  </Collection>\n</VTKFile>\n"
    );
    write(&path, |file| file.write_all(text.as_bytes()).context(Action::Write, &path))?;
    paths.push(path);
    Ok(paths)
}

/// Particles at an instant.
struct Instant<'f> {
    frame: &'f Frame,
    /// `(N, 3)`, flat, m.
    points: Array,
    fields: Vec<Field>,
}

/// Names of fields in extended XYZ, where they are not ours.
const IN_XYZ: &[(&str, &str)] = &[("velocity", "velo"), ("force", "forces")];
/// Names of columns in dumps of LAMMPS, where they are not ours.
const IN_LAMMPS: &[(&str, &[&str])] = &[
    ("velocity", &["vx", "vy", "vz"]),
    ("angular_velocity", &["omegax", "omegay", "omegaz"]),
    ("force", &["fx", "fy", "fz"]),
    ("moment", &["tqx", "tqy", "tqz"]),
];

impl<'f> Instant<'f> {
    fn load(run: &Path, frame: &'f Frame) -> Result<Self, Error> {
        let Loaded { points, fields } = load_particles(run, frame)?;
        Ok(Instant { frame, points, fields })
    }

    fn len(&self) -> usize {
        self.points.len() / 3
    }

    /// A position as text.
    fn place(&self, particle: usize, separator: &str) -> String {
        [0, 1, 2].map(|k| self.points.text(3 * particle + k)).join(separator)
    }

    /// The material of a particle by its index.
    fn material(&self, particle: usize) -> usize {
        let of = self.fields.iter().find(|field| field.name == "material");
        match of.map(|field| &field.data) {
            Some(Array::I32(materials)) => usize::try_from(materials[particle]).unwrap_or(0),
            _ => 0,
        }
    }

    /// Numbers of a particle, each behind a separator.
    fn numbers(&self, text: &mut String, particle: usize, separator: char, left_out: &[&str]) {
        for field in self.fields.iter().filter(|field| !left_out.contains(&field.name.as_str())) {
            for component in 0..field.components {
                text.push(separator);
                *text += &field.data.text(particle * field.components + component);
            }
        }
    }

    fn xyz(&self, domain: &Domain) -> String {
        let [x, y, z] = domain.length();
        let [a, b, c] = domain.min;
        let repeats = domain.periodic.map(|periodic| if periodic { "T" } else { "F" }).join(" ");
        let heat = self.frame.about.heat_time.map_or(String::new(), |time| format!(" Heat_time={time:?}"));
        let mut text = format!(
            "{}\nLattice=\"{x:?} 0.0 0.0 0.0 {y:?} 0.0 0.0 0.0 {z:?}\" Origin=\"{a:?} {b:?} {c:?}\" pbc=\"{repeats}\" \
             Properties=species:S:1:pos:R:3",
            self.len()
        );
        for field in &self.fields {
            let name =
                IN_XYZ.iter().find(|(ours, _)| *ours == field.name).map_or(field.name.as_str(), |(_, name)| name);
            let kind = if matches!(field.data, Array::I32(_) | Array::I64(_)) { 'I' } else { 'R' };
            let _ = write!(text, ":{name}:{kind}:{}", field.components);
        }
        let _ = writeln!(text, " Step={} Time={:?}{heat}", self.frame.step, self.frame.time);
        let names = &self.frame.about.names.materials;
        for particle in 0..self.len() {
            let material = self.material(particle);
            let species = names
                .get(material)
                .map_or_else(|| format!("M{material}"), |name| name.replace(char::is_whitespace, "_"));
            let _ = write!(text, "{species} {}", self.place(particle, " "));
            self.numbers(&mut text, particle, ' ', &[]);
            text.push('\n');
        }
        text
    }

    /// Units stand before the first instant only.
    fn lammps(&self, domain: &Domain, first: bool) -> String {
        // Types and ids of LAMMPS count from one.
        const TOLD: [&str; 2] = ["id", "material"];
        let bounds = domain.periodic.map(|periodic| if periodic { "pp" } else { "ff" }).join(" ");
        let mut text = format!(
            "{}ITEM: TIME\n{:?}\nITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\nITEM: BOX BOUNDS {bounds}\n",
            if first { "ITEM: UNITS\nsi\n" } else { "" },
            self.frame.time,
            self.frame.step,
            self.len()
        );
        for (low, high) in domain.min.iter().zip(domain.max) {
            let _ = writeln!(text, "{low:?} {high:?}");
        }
        text += "ITEM: ATOMS id type x y z";
        for field in self.fields.iter().filter(|field| !TOLD.contains(&field.name.as_str())) {
            let theirs = IN_LAMMPS.iter().find(|(ours, _)| *ours == field.name).map(|(_, names)| *names);
            for component in 0..field.components {
                let name = theirs.and_then(|names| names.get(component));
                let _ = match (name, field.components) {
                    (Some(name), _) => write!(text, " {name}"),
                    (None, 1) => write!(text, " {}", field.name),
                    (None, _) => write!(text, " {}[{}]", field.name, component + 1),
                };
            }
        }
        text.push('\n');
        let ids = self.fields.iter().find(|field| field.name == "id");
        for particle in 0..self.len() {
            let id = match ids.map(|field| &field.data) {
                Some(Array::I64(ids)) => ids[particle],
                _ => particle as i64,
            };
            let _ = write!(text, "{} {} {}", id + 1, self.material(particle) + 1, self.place(particle, " "));
            self.numbers(&mut text, particle, ' ', &TOLD);
            text.push('\n');
        }
        text
    }

    fn csv(&self, header: bool) -> String {
        const ENDINGS: [&str; 3] = ["x", "y", "z"];
        const OF_TENSORS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "xz"];
        let mut text = String::new();
        if header {
            text += "step,time,x,y,z";
            for field in &self.fields {
                for component in 0..field.components {
                    let _ = match field.components {
                        1 => write!(text, ",{}", field.name),
                        3 => write!(text, ",{}_{}", field.name, ENDINGS[component]),
                        _ => write!(text, ",{}_{}", field.name, OF_TENSORS.get(component).unwrap_or(&"")),
                    };
                }
            }
            text.push('\n');
        }
        for particle in 0..self.len() {
            let _ = write!(text, "{},{:?},{}", self.frame.step, self.frame.time, self.place(particle, ","));
            self.numbers(&mut text, particle, ',', &[]);
            text.push('\n');
        }
        text
    }

    fn vtp(&self) -> String {
        let count = self.len();
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n{}</FieldData>\n<Piece NumberOfPoints=\"{count}\" \
             NumberOfVerts=\"{count}\">\n<PointData>\n",
            array("TimeValue", 1, &Array::F64(vec![self.frame.time]))
        );
        for field in &self.fields {
            text += &array(&field.name, field.components, &field.data);
        }
        text += "</PointData>\n<Points>\n";
        text += &array("Points", 3, &self.points);
        text += "</Points>\n<Verts>\n";
        text += &array("connectivity", 1, &Array::I64((0..count as i64).collect()));
        text += &array("offsets", 1, &Array::I64((1..=count as i64).collect()));
        text + "</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n"
    }
}

/// Numbers as VTK's XML files hold them: their bytes behind how many these are, as text.
fn array(name: &str, components: usize, array: &Array) -> String {
    let kind = match array {
        Array::F32(_) => "Float32",
        Array::F64(_) => "Float64",
        Array::I32(_) => "Int32",
        Array::I64(_) => "Int64",
    };
    let numbers: Vec<u8> = each!(array, values => values.iter().flat_map(|value| value.to_le_bytes()).collect());
    let bytes = [&(numbers.len() as u64).to_le_bytes()[..], &numbers].concat();
    let tuples = if name == "TimeValue" { " NumberOfTuples=\"1\"" } else { "" };
    format!(
        "<DataArray type=\"{kind}\" Name=\"{}\" NumberOfComponents=\"{components}\"{tuples} format=\"binary\">{}</DataArray>\n",
        escape(name),
        base64(&bytes)
    )
}
