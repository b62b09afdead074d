//! `history.csv`: one row per recorded step, columns as the glossary says.

mod mend;
mod sums;

pub use mend::HistoryDamage;

use crate::error::{Action, Context, Error};
use crate::files::{self, atomically, remove, with_ending};
use crate::glossary::{HISTORY, HISTORY_WITH_BONDS, HISTORY_WITH_HEAT, Place, Values, of_gauge};
use crate::run_directory::{self, CHECKPOINTS};
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use sums::Sums;
use tdem_engine::{Ledger, Plan, Reading, State};

/// What a row shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Steps done.
    pub step: u64,
    /// Time, s.
    pub time: f64,
    /// Energies and measures.
    pub ledger: Ledger,
    /// Names of the gauges, and what they show.
    pub gauges: Vec<(String, Reading)>,
}

impl Row {
    /// The row of a state, with its ledger.
    #[must_use]
    pub fn of(state: &State, plan: &Plan, ledger: Ledger) -> Self {
        let gauges = plan.gauges.iter().map(|gauge| (gauge.name.clone(), gauge.read(state, plan))).collect();
        Row { step: state.step, time: plan.time(state.step), ledger, gauges }
    }

    /// The first energy or temperature that is no finite number, with its value and unit.
    pub(crate) fn unbounded(&self) -> Option<(&'static str, f64, &'static str)> {
        let of_heat = if self.ledger.heat.is_some() { HISTORY_WITH_HEAT } else { &[] };
        let all = HISTORY.iter().chain(HISTORY_WITH_BONDS).chain(of_heat);
        let bounded = all.filter(|quantity| ["J", "K"].contains(&quantity.entry.unit));
        bounded.into_iter().find_map(|quantity| match (quantity.values)(self) {
            Values::Real(values) => {
                let value = values.iter().find(|value| !value.is_finite())?;
                Some((quantity.entry.name, *value, quantity.entry.unit))
            }
            Values::Integer(_) => None,
        })
    }

    /// Whether the run has bonds, broken ones too.
    fn has_bonds(&self) -> bool {
        self.ledger.bonds + self.ledger.broken_bonds > 0
    }

    /// The first line of a history that has such rows: what every run has, what runs with bonds and with heat have, gauges.
    fn header(&self) -> String {
        let mut columns = columns_of_all();
        if self.has_bonds() {
            columns.extend(Place::History.with_bonds().iter().flat_map(crate::glossary::Entry::columns));
        }
        if self.ledger.heat.is_some() {
            columns.extend(Place::History.with_heat().iter().flat_map(crate::glossary::Entry::columns));
        }
        for (name, reading) in &self.gauges {
            let columns_of_gauge = of_gauge(reading).flat_map(|quantity| quantity.entry.columns());
            columns.extend(columns_of_gauge.map(|column| column.replacen("NAME", name, 1)));
        }
        columns.join(",") + "\n"
    }

    /// The row as text, without the end of the line. Every number reads back to the same bits.
    fn text(&self) -> String {
        let of_bonds = if self.has_bonds() { HISTORY_WITH_BONDS } else { &[] };
        let mut cells = Vec::new();
        let mut add = |values: Values<'_>| match values {
            // Scientific notation prints as few digits as tell the number from its neighbours.
            Values::Real(values) => cells.extend(values.iter().map(|value| format!("{value:e}"))),
            Values::Integer(values) => cells.extend(values.iter().map(ToString::to_string)),
        };
        let of_heat = if self.ledger.heat.is_some() { HISTORY_WITH_HEAT } else { &[] };
        HISTORY.iter().chain(of_bonds).chain(of_heat).for_each(|quantity| add((quantity.values)(self)));
        for (_, reading) in &self.gauges {
            for quantity in of_gauge(reading) {
                add((quantity.values)(reading));
            }
        }
        cells.join(",")
    }
}

/// Columns of every run.
fn columns_of_all() -> Vec<String> {
    Place::History.entries().iter().flat_map(crate::glossary::Entry::columns).collect()
}

/// The checksums of its rows, in the folder of a run.
const SUMS: &str = "history.sums";
/// First part of the name under which a damaged history is kept, and the ending.
const ASIDE: [&str; 2] = ["history.damaged", ".csv"];

/// The history of a run, open at its end, and the checksums of its rows.
#[derive(Debug)]
pub(crate) struct History {
    rows: Tail,
    sums: Tail,
    /// The folder of the run.
    run: PathBuf,
    /// The first line.
    header: String,
    last_step: Option<u64>,
}

impl History {
    /// Begins a history in the folder of a run, over an old one if there is one. Its first row decides which columns it has
    /// besides those of all.
    pub(crate) fn create(run: &Path) -> Result<Self, Error> {
        History::with_header(run, &(columns_of_all().join(",") + "\n"))
    }

    fn with_header(run: &Path, header: &str) -> Result<Self, Error> {
        let [path, sums] = [run.join(run_directory::HISTORY), run.join(CHECKPOINTS).join(SUMS)];
        let written = sums::of_header(header);
        atomically(&path, |unfinished| fs::write(unfinished, header).context(Action::Write, &path))?;
        atomically(&sums, |unfinished| fs::write(unfinished, &written).context(Action::Write, &sums))?;
        let (rows, sums) = (Tail::open(path, header.len() as u64)?, Tail::open(sums, written.len() as u64)?);
        Ok(History { rows, sums, run: run.into(), header: header.to_owned(), last_step: None })
    }

    /// Opens a history to go on after a step: later rows and a row that was cut off are removed. What is damaged is set aside,
    /// and good rows stay.
    pub(crate) fn open(run: &Path, step: u64) -> Result<(Self, HistoryDamage), Error> {
        let [path, sums_path] = [run.join(run_directory::HISTORY), run.join(CHECKPOINTS).join(SUMS)];
        let (text, old_sums) = (read(&path)?, read(&sums_path)?.unwrap_or_default());
        let file_missing = text.is_none();
        let text = text.unwrap_or_default();
        let found = mend::look(&text, &Sums::read(&old_sums), step, is_known);
        let header = match found.header {
            Some(header) if is_known(&header) => header,
            None if text.is_empty() => columns_of_all().join(",") + "\n",
            _ => return Err(Error::HistoryColumns { path }),
        };
        let mut damage = HistoryDamage { file_missing, ..found.damage };
        let good = found.rows.values().fold(header.clone().into_bytes(), |mut good, row| {
            good.extend_from_slice(row);
            good
        });
        let sums =
            found.rows.iter().fold(sums::of_header(&header), |sums, (&step, row)| sums + &sums::of_row(step, row));
        if damage.is_of_lines() {
            damage.aside = Some(set_aside(run, &text)?);
        }
        if !text.starts_with(&good) {
            atomically(&path, |unfinished| fs::write(unfinished, &good).context(Action::Write, &path))?;
        }
        if old_sums != sums.as_bytes() {
            atomically(&sums_path, |unfinished| fs::write(unfinished, &sums).context(Action::Write, &sums_path))?;
        }
        let last_step = damage.steps.last().copied();
        let (rows, sums) = (Tail::open(path, good.len() as u64)?, Tail::open(sums_path, sums.len() as u64)?);
        Ok((History { rows, sums, run: run.into(), header, last_step }, damage))
    }

    pub(crate) fn last_step(&self) -> Option<u64> {
        self.last_step
    }

    /// Adds a row, or nothing.
    pub(crate) fn append(&mut self, row: &Row) -> Result<(), Error> {
        let header = row.header();
        if self.header != header {
            if self.last_step.is_some() {
                return Err(Error::HistoryColumns { path: self.rows.path.clone() });
            }
            *self = History::with_header(&self.run, &header)?;
        }
        let text = row.text() + "\n";
        let before = self.rows.length;
        self.rows.add(text.as_bytes())?;
        if let Err(error) = self.sums.add(sums::of_row(row.step, text.as_bytes()).as_bytes()) {
            // A row without its checksum is none. The first error is the one to tell.
            self.rows.length = before;
            let _ = self.rows.cut();
            return Err(error);
        }
        self.last_step = Some(row.step);
        Ok(())
    }

    /// Makes all rows survive a power cut.
    pub(crate) fn sync(&self) -> Result<(), Error> {
        self.rows.sync()?;
        self.sums.sync()
    }
}

/// A file that grows at its end.
#[derive(Debug)]
struct Tail {
    file: File,
    path: PathBuf,
    /// Bytes of complete lines.
    length: u64,
}

impl Tail {
    /// Opens a file whose first bytes are complete lines; the rest is removed.
    fn open(path: PathBuf, length: u64) -> Result<Self, Error> {
        let file = files::open(&path, OpenOptions::new().read(true).write(true), false, Action::Read)?;
        let tail = Tail { file, path, length };
        if tail.file.metadata().context(Action::Read, &tail.path)?.len() > length {
            tail.cut()?;
            tail.sync()?;
        }
        Ok(tail)
    }

    /// Adds a line, or nothing.
    fn add(&mut self, line: &[u8]) -> Result<(), Error> {
        let result = self.file.seek(SeekFrom::Start(self.length)).and_then(|_| self.file.write_all(line));
        if let Err(error) = result {
            // Part of the line may be there. The first error is the one to tell.
            let _ = self.cut();
            return Err(Error::io(Action::Write, error, &self.path));
        }
        self.length += line.len() as u64;
        Ok(())
    }

    fn sync(&self) -> Result<(), Error> {
        self.file.sync_all().context(Action::Write, &self.path)
    }

    fn cut(&self) -> Result<(), Error> {
        self.file.set_len(self.length).context(Action::Write, &self.path)
    }
}

/// Removes what was set aside of the history of an older run.
pub(crate) fn remove_aside(run: &Path) -> Result<(), Error> {
    let name = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(ASIDE[0]));
    let found = with_ending(run, ASIDE[1].trim_start_matches('.'))?;
    found.iter().filter(|path| name(path)).try_for_each(|path| remove(path))
}

/// Keeps a damaged history beside the one that goes on.
fn set_aside(run: &Path, text: &[u8]) -> Result<PathBuf, Error> {
    let [name, ending] = ASIDE;
    let numbered = (2..).map(|number| format!("{name}-{number}{ending}"));
    let free = std::iter::once(format!("{name}{ending}")).chain(numbered).map(|name| run.join(name));
    let path = free.into_iter().find(|path| fs::symlink_metadata(path).is_err()).unwrap_or_default();
    atomically(&path, |unfinished| fs::write(unfinished, text).context(Action::Write, &path))?;
    Ok(path)
}

/// What is in a file, if it is there.
fn read(path: &Path) -> Result<Option<Vec<u8>>, Error> {
    files::refuse_link(path)?;
    match fs::read(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        read => read.map(Some).context(Action::Read, path),
    }
}

/// Whether a first line is one that this version writes. Which columns follow those of all, the first row tells that is added.
fn is_known(header: &str) -> bool {
    header.strip_prefix(&columns_of_all().join(",")).is_some_and(|rest| rest.starts_with([',', '\n']))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(step: u64) -> Row {
        let ledger = Ledger {
            kinetic_translation: 0.1 + 0.2,
            kinetic_rotation: 5e-324,
            elastic_normal: -0.0,
            elastic_tangential: f64::MAX,
            elastic_bonds: 0.0,
            gravitational: 1.0 / 3.0,
            friction_dissipated: 0.0,
            damping_dissipated: 0.0,
            breakage_dissipated: 0.0,
            stiffening_work: 0.0,
            external_work: 0.0,
            expansion_work: 0.0,
            energy_error: -1e-17,
            contacts: 3,
            wall_contacts: 4,
            bonds: 0,
            broken_bonds: 0,
            largest_speed: 1.0,
            largest_overlap: 0.0,
            unbalanced_force_ratio: 0.0,
            heat: None,
            wall_force: [1.0, 2.0, 3.0],
        };
        Row { step, time: step as f64 * 1e-6, ledger, gauges: Vec::new() }
    }

    /// The folder of a run, and where its history will be.
    fn folder() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join(CHECKPOINTS)).unwrap();
        let path = folder.path().join(run_directory::HISTORY);
        (folder, path)
    }

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        let text = row(7).text();
        let cells: Vec<&str> = text.split(',').collect();
        let header = row(7).header();
        let names: Vec<&str> = header.trim_end().split(',').collect();
        assert_eq!(cells.len(), names.len());
        let read = |name: &str| -> f64 { cells[names.iter().position(|&n| n == name).unwrap()].parse().unwrap() };
        assert_eq!(read("kinetic_translation").to_bits(), (0.1_f64 + 0.2).to_bits());
        assert_eq!(read("kinetic_rotation").to_bits(), 5e-324_f64.to_bits());
        assert_eq!(read("elastic_normal").to_bits(), (-0.0_f64).to_bits());
        assert_eq!(read("elastic_tangential"), f64::MAX);
        assert_eq!(read("wall_force_z"), 3.0);
        assert_eq!(read("contacts"), 3.0);
    }

    #[test]
    fn rows_after_the_checkpoint_and_a_torn_row_are_cut_off() {
        let (folder, path) = folder();
        let mut history = History::create(folder.path()).unwrap();
        (0..5).for_each(|k| history.append(&row(10 * k)).unwrap());
        drop(history);
        let whole = fs::read_to_string(&path).unwrap();
        fs::write(&path, whole.clone() + "50,5e-5,0.1").unwrap();
        let (history, damage) = History::open(folder.path(), 1000).unwrap();
        assert_eq!((history.last_step(), damage.told()), (Some(40), Vec::new()));
        assert_eq!(fs::read_to_string(&path).unwrap(), whole, "a torn row is gone");
        let mut history = History::open(folder.path(), 25).unwrap().0;
        assert_eq!(history.last_step(), Some(20));
        history.append(&row(30)).unwrap();
        history.append(&row(40)).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), whole);
    }

    #[test]
    fn only_runs_with_bonds_have_columns_for_them() {
        let (folder, path) = folder();
        History::create(folder.path()).unwrap().append(&row(0)).unwrap();
        let plain = fs::read_to_string(&path).unwrap();
        assert_eq!(plain.lines().next().unwrap().split(',').next_back(), Some("wall_force_z"));

        let mut with_bonds = row(0);
        (with_bonds.ledger.bonds, with_bonds.ledger.broken_bonds) = (0, 2);
        with_bonds.ledger.breakage_dissipated = 0.25;
        let mut history = History::create(folder.path()).unwrap();
        history.append(&with_bonds).unwrap();
        history.append(&Row { step: 10, ..with_bonds.clone() }).unwrap();
        drop(history);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with(plain.lines().next().unwrap()), "columns that all runs have stay where they are");
        assert!(text.lines().next().unwrap().ends_with(",elastic_bonds,breakage_dissipated,bonds,broken_bonds"));
        assert!(text.lines().skip(1).all(|line| line.ends_with(",0e0,2.5e-1,0,2")), "{text}");

        let mut history = History::open(folder.path(), 5).unwrap().0;
        history.append(&Row { step: 10, ..with_bonds.clone() }).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), text, "and a run that goes on keeps them");
    }

    #[test]
    fn gauges_have_columns_behind_all_others() {
        let (folder, path) = folder();
        let grip = Reading::Of { force: [1.0, -2.0, 0.5], displacement: [0.0, 0.1 + 0.2, 0.0], temperature: None };
        let gauges =
            vec![("grip".to_owned(), grip), ("core".to_owned(), Reading::Between { elongation: 1e-6, strain: 1e-5 })];
        let mut history = History::create(folder.path()).unwrap();
        let watched = Row { gauges, ..row(0) };
        history.append(&watched).unwrap();
        drop(history);
        let text = fs::read_to_string(&path).unwrap();
        let expected = "wall_force_z,grip_force_x,grip_force_y,grip_force_z,grip_displacement_x,grip_displacement_y,\
                        grip_displacement_z,core_elongation,core_strain";
        assert!(text.lines().next().unwrap().ends_with(expected), "{text}");
        assert!(text.trim_end().ends_with(",1e0,-2e0,5e-1,0e0,3.0000000000000004e-1,0e0,1e-6,1e-5"), "{text}");

        let mut history = History::open(folder.path(), 0).unwrap().0;
        assert!(matches!(history.append(&row(10)), Err(Error::HistoryColumns { .. })), "rows of another run");
        history.append(&Row { step: 10, ..watched }).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap().lines().count(), 3);
    }

    #[test]
    fn other_columns_are_refused() {
        let (folder, path) = folder();
        fs::write(&path, "step,time\n0,0\n").unwrap();
        assert!(matches!(History::open(folder.path(), 0), Err(Error::HistoryColumns { .. })));
        assert_eq!(fs::read_to_string(&path).unwrap(), "step,time\n0,0\n", "and left alone");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_told_as_such() {
        let (folder, _) = folder();
        let mut history = History::create(folder.path()).unwrap();
        history.append(&row(0)).unwrap();
        let before = fs::read(&history.rows.path).unwrap();
        let full = || OpenOptions::new().write(true).open("/dev/full").unwrap();
        let file = std::mem::replace(&mut history.sums.file, full());
        assert!(matches!(history.append(&row(1)), Err(Error::DiskFull { .. })));
        assert_eq!(fs::read(&history.rows.path).unwrap(), before, "a row without its checksum is gone");
        history.sums.file = file;
        history.rows.file = full();
        assert!(matches!(history.append(&row(1)), Err(Error::DiskFull { .. })));
        assert_eq!(history.last_step(), Some(0));
    }
}
