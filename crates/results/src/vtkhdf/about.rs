//! What a frame tells beside its numbers, as field data: step, time of the heat, title of the case, names of materials.

use super::array::Array;
use super::frame::Frame;
use super::hdf5::{Label, NewGroup, Packed, Result, StoredFile};

/// Group of field data, in the particles of a frame and in every master.
pub(super) const GROUP: &str = "FieldData";
const STEP: &str = "step";
const HEAT_TIME: &str = "heat_time";
/// VTK reads texts only of a kind that the HDF5 library does not write, so that names are names of arrays of one number.
const TITLE: &str = "title ";
const MATERIAL: &str = "material ";
const OF_HEAT: Label = Label { unit: "s", description: "time of the heat" };

/// Names that a run gives to what its frames show.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    /// Title of the case.
    pub title: String,
    /// Names of materials by their index.
    pub materials: Vec<String>,
}

/// What a frame tells of its moment and its run.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct About {
    /// Time of the heat, s; none without heat.
    pub(crate) heat_time: Option<f64>,
    pub(crate) names: Names,
}

impl About {
    /// Writes it into a block of a frame.
    pub(super) fn write(&self, block: &NewGroup, step: u64) -> Result<()> {
        let group = block.group(GROUP)?;
        group.put_integers(STEP, 1, vec![step.cast_signed()])?;
        if let Some(time) = self.heat_time {
            group.put(HEAT_TIME, &Packed::new(1, &Array::F64(vec![time]), 0)?, OF_HEAT)?;
        }
        self.names.write(&group)
    }

    /// Reads what [`About::write`] wrote; nothing from frames that have none.
    pub(super) fn read(stored: &StoredFile, block: &str) -> Result<Self> {
        let there = stored.names(&format!("{block}/{GROUP}"));
        let path = |name: &str| format!("{block}/{GROUP}/{name}");
        let mut about = About::default();
        let mut materials = Vec::new();
        for name in &there {
            if name == HEAT_TIME {
                about.heat_time = stored.reals(&path(name))?.first().copied();
            } else if let Some(title) = name.strip_prefix(TITLE) {
                title.clone_into(&mut about.names.title);
            } else if let Some((index, material)) = name.strip_prefix(MATERIAL).and_then(|rest| rest.split_once(' ')) {
                materials.push((index.parse().unwrap_or(u64::MAX), material.to_owned()));
            }
        }
        materials.sort();
        about.names.materials = materials.into_iter().map(|(_, name)| name).collect();
        Ok(about)
    }
}

impl Names {
    /// Names of arrays, and the number that each holds: 0 for the title, its index for a material.
    fn arrays(&self) -> Vec<(String, i64)> {
        let title = (!self.title.is_empty()).then(|| (plain(TITLE, &self.title), 0));
        // With the index, no two names are the same.
        let name = |(name, index): (&String, i64)| (plain(&format!("{MATERIAL}{index} "), name), index);
        let materials = self.materials.iter().zip(0..).map(name);
        title.into_iter().chain(materials).collect()
    }

    fn write(&self, group: &NewGroup) -> Result<()> {
        self.arrays().into_iter().try_for_each(|(name, number)| group.put_integers(&name, 1, vec![number]))
    }
}

/// A name that HDF5 and VTK take: without what divides paths, in ASCII.
fn plain(prefix: &str, text: &str) -> String {
    let letter = |letter: char| match letter {
        '/' | '.' => '_',
        ' '..='~' => letter,
        _ => '?',
    };
    prefix.chars().chain(text.chars().map(letter)).collect()
}

/// Writes field data of a series: a value per instant, and names that all instants share.
pub(super) fn write_series(root: &NewGroup, steps: &NewGroup, frames: &[&Frame]) -> Result<()> {
    let Some(last) = frames.last() else { return Ok(()) };
    let count = frames.len();
    let group = root.group(GROUP)?;
    let (offsets, sizes) = (steps.group("FieldDataOffsets")?, steps.group("FieldDataSizes")?);
    // A reader asks for components and rows of each instant: one of one.
    let place = |name: &str, offset: Vec<i64>| -> Result<()> {
        offsets.put_integers(name, 1, offset)?;
        sizes.put_integers(name, 2, vec![1; 2 * count])
    };
    let each = || (0..count as i64).collect();
    group.put_integers(STEP, 1, frames.iter().map(|frame| frame.step.cast_signed()).collect())?;
    place(STEP, each())?;
    let times: Option<Vec<f64>> = frames.iter().map(|frame| frame.about.heat_time).collect();
    if let Some(times) = times {
        group.put(HEAT_TIME, &Packed::new(1, &Array::F64(times), 0)?, OF_HEAT)?;
        place(HEAT_TIME, each())?;
    }
    let names = &last.about.names;
    names.write(&group)?;
    names.arrays().into_iter().try_for_each(|(name, _)| place(&name, vec![0; count]))
}
