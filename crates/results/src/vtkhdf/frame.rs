//! A frame: all blocks of one instant in a file of its own.

use super::about::About;
use super::array::{Array, Storage};
use super::block::{Block, Field, TOPOLOGIES};
use super::hdf5::{FormatError, Label, NewFile, NewGroup, Packed, Result, StoredFile};
use crate::blocks::entry_of;
use crate::error::{Action, Context, Error};
use crate::files::{Seal, atomically};
use rayon::prelude::*;
use std::path::Path;

/// Our own notes about a frame, outside the group that VTK reads.
const NOTES: &str = "tdem";

/// The block whose field data tells what the frame is about.
const PARTICLES: &str = "particles";

/// A frame that is on the disk, as far as a master must know it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Frame {
    /// Where it is, relative to the run.
    pub(crate) file: String,
    pub(crate) step: u64,
    pub(crate) time: f64,
    pub(crate) about: About,
    pub(crate) blocks: Vec<BlockSize>,
}

/// The moment that a frame shows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Moment {
    pub(crate) step: u64,
    /// s.
    pub(crate) time: f64,
    pub(crate) about: About,
}

/// A block of a frame without its numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BlockSize {
    pub(crate) name: String,
    pub(crate) fixed: bool,
    pub(crate) points: usize,
    pub(crate) point_storage: Storage,
    /// Cells and connectivity ids of each of VTK's kinds of cells.
    pub(crate) cells: [usize; 4],
    pub(crate) connectivity: [usize; 4],
    pub(crate) point_fields: Vec<FieldKind>,
    pub(crate) cell_fields: Vec<FieldKind>,
}

/// A field without its numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FieldKind {
    pub(crate) name: String,
    pub(crate) components: usize,
    pub(crate) storage: Storage,
}

impl BlockSize {
    pub(crate) fn cell_count(&self) -> usize {
        self.cells.iter().sum()
    }

    fn of(block: &Block) -> Self {
        let (cells, connectivity) = block.counts();
        BlockSize {
            name: block.name.into(),
            fixed: block.fixed,
            points: block.point_count(),
            point_storage: block.points.storage(),
            cells,
            connectivity,
            point_fields: block.point_fields.iter().map(FieldKind::of).collect(),
            cell_fields: block.cell_fields.iter().map(FieldKind::of).collect(),
        }
    }
}

impl FieldKind {
    fn of(field: &Field) -> Self {
        FieldKind { name: field.name.clone(), components: field.components, storage: field.data.storage() }
    }
}

impl Frame {
    /// Writes a frame into a run. What the file holds is told beside it.
    pub(crate) fn write(
        run: &Path,
        file: String,
        moment: Moment,
        blocks: &[Block],
        compression: u32,
    ) -> std::result::Result<(Self, Seal), Error> {
        let path = run.join(&file);
        let mut seal = Seal::default();
        atomically(&path, |unfinished| {
            write(unfinished, &moment, blocks, compression).context(Action::Write, &path)?;
            seal = Seal::of(unfinished).context(Action::Write, &path)?;
            Ok(())
        })?;
        let Moment { step, time, about } = moment;
        Ok((Frame { file, step, time, about, blocks: blocks.iter().map(BlockSize::of).collect() }, seal))
    }

    /// Looks at a frame of a run.
    pub(crate) fn read(run: &Path, file: String) -> std::result::Result<Self, Error> {
        let path = run.join(&file);
        let stored = StoredFile::open(&path).context(Action::Read, &path)?;
        read(&stored, file).context(Action::Read, &path)
    }
}

/// The particles of a frame, with their numbers.
pub(crate) struct Loaded {
    /// `(N, 3)`, flat, m.
    pub(crate) points: Array,
    pub(crate) fields: Vec<Field>,
}

/// Reads the numbers of the particles of a frame.
pub(crate) fn load_particles(run: &Path, frame: &Frame) -> std::result::Result<Loaded, Error> {
    let path = run.join(&frame.file);
    let read = || -> Result<Loaded> {
        let stored = StoredFile::open(&path)?;
        let group = format!("VTKHDF/{PARTICLES}");
        let points = stored.array(&format!("{group}/Points"))?;
        let kinds =
            frame.blocks.iter().find(|block| block.name == PARTICLES).map_or(&[][..], |block| &block.point_fields);
        let field = |kind: &FieldKind| {
            let data = stored.array(&format!("{group}/PointData/{}", kind.name))?;
            Ok(Field { name: kind.name.clone(), components: kind.components, data })
        };
        Ok(Loaded { points, fields: kinds.iter().map(field).collect::<Result<_>>()? })
    };
    read().context(Action::Read, &path)
}

fn write(path: &Path, moment: &Moment, blocks: &[Block], compression: u32) -> Result<()> {
    let file = NewFile::create(path, true)?;
    let root = file.group("VTKHDF")?;
    root.header("PartitionedDataSetCollection")?;
    for (index, block) in blocks.iter().enumerate() {
        let group = root.group(block.name)?;
        group.header("PolyData")?;
        group.integer_attribute("Index", index as i64)?;
        write_block(&group, block, compression)?;
        if block.name == PARTICLES {
            moment.about.write(&group, moment.step)?;
        }
    }
    let assembly = root.group("Assembly")?;
    for block in blocks {
        assembly.soft_link(block.name, &format!("/VTKHDF/{}", block.name))?;
    }

    let notes = file.group(NOTES)?;
    notes.put_integers("step", 1, vec![moment.step.cast_signed()])?;
    notes.put("time", &Packed::new(1, &Array::F64(vec![moment.time]), 0)?, Label { unit: "s", description: "time" })?;
    let fixed = notes.group("fixed")?;
    for block in blocks {
        fixed.put_integers(block.name, 1, vec![block.fixed.into()])?;
    }
    file.close()
}

fn write_block(group: &NewGroup, block: &Block, compression: u32) -> Result<()> {
    let (cells, connectivity) = block.counts();
    let topologies = block.topologies();
    // All is packed before anything is written, so that every core has something to do.
    let pack = |components, array| Packed::new(components, array, compression);
    let kinds = || -> Result<Vec<_>> {
        topologies.par_iter().map(|kind| Ok([pack(1, &kind.offsets)?, pack(1, &kind.connectivity)?])).collect()
    };
    let ((points, kinds), (point_fields, cell_fields)) = rayon::join(
        || rayon::join(|| pack(3, &block.points), kinds),
        || {
            rayon::join(
                || pack_fields(&block.point_fields, compression),
                || pack_fields(&block.cell_fields, compression),
            )
        },
    );

    group.put_integers("NumberOfPoints", 1, vec![block.point_count() as i64])?;
    group.put("Points", &points?, POINTS)?;
    for (k, (name, [offsets, ids])) in TOPOLOGIES.iter().zip(kinds?).enumerate() {
        let kind = group.group(name)?;
        kind.put_integers("NumberOfCells", 1, vec![cells[k] as i64])?;
        kind.put_integers("NumberOfConnectivityIds", 1, vec![connectivity[k] as i64])?;
        kind.put("Offsets", &offsets, Label::default())?;
        kind.put("Connectivity", &ids, Label::default())?;
    }
    for (name, fields, packed) in
        [("PointData", &block.point_fields, point_fields), ("CellData", &block.cell_fields, cell_fields)]
    {
        let group = group.group(name)?;
        for (field, packed) in fields.iter().zip(packed?) {
            group.put(&field.name, &packed, label(block.name, &field.name))?;
        }
    }
    Ok(())
}

fn pack_fields(fields: &[Field], compression: u32) -> Result<Vec<Packed<'_>>> {
    fields.par_iter().map(|field| Packed::new(field.components, &field.data, compression)).collect()
}

/// The documentation of the positions.
pub(super) const POINTS: Label = Label { unit: "m", description: "position" };

/// The documentation of a field.
pub(super) fn label(block: &str, field: &str) -> Label {
    entry_of(block, field).map_or(Label::default(), |entry| Label { unit: entry.unit, description: entry.description })
}

/// Reads what a master must know. Every count is compared with what it counts, so that nothing later relies on a count that
/// was changed.
fn read(stored: &StoredFile, file: String) -> Result<Frame> {
    let first = |dataset: &str| -> Result<i64> {
        stored.integers(dataset)?.first().copied().ok_or_else(|| FormatError::Unusable { dataset: dataset.into() })
    };
    let mut blocks = Vec::new();
    for name in stored.names(&format!("{NOTES}/fixed")) {
        let group = format!("VTKHDF/{name}");
        if !name.bytes().all(|letter| letter.is_ascii_alphanumeric() || letter == b'_') {
            // The name becomes that of a file.
            return Err(FormatError::Unusable { dataset: group });
        }
        let counted = |number: &str, dataset: &str, more: i64| -> Result<usize> {
            let (count, rows) = (first(number)?, stored.rows(dataset)?);
            match usize::try_from(count) {
                Ok(found) if found.checked_add(more as usize) == Some(rows) => Ok(found),
                _ => Err(FormatError::Counts { dataset: dataset.into(), rows, expected: count.saturating_add(more) }),
            }
        };
        let points = format!("{group}/Points");
        let (point_storage, components) = stored.layout(&points)?;
        if components != 3 {
            return Err(FormatError::Unusable { dataset: points });
        }
        let mut size = BlockSize {
            fixed: first(&format!("{NOTES}/fixed/{name}"))? != 0,
            points: counted(&format!("{group}/NumberOfPoints"), &points, 0)?,
            point_storage,
            cells: [0; 4],
            connectivity: [0; 4],
            point_fields: Vec::new(),
            cell_fields: Vec::new(),
            name,
        };
        for (k, kind) in TOPOLOGIES.iter().enumerate() {
            let kind = format!("{group}/{kind}");
            size.cells[k] = counted(&format!("{kind}/NumberOfCells"), &format!("{kind}/Offsets"), 1)?;
            size.connectivity[k] =
                counted(&format!("{kind}/NumberOfConnectivityIds"), &format!("{kind}/Connectivity"), 0)?;
        }
        size.point_fields = fields(stored, &format!("{group}/PointData"), size.points)?;
        size.cell_fields = fields(stored, &format!("{group}/CellData"), size.cell_count())?;
        blocks.push(size);
    }
    let step = first(&format!("{NOTES}/step"))?.cast_unsigned();
    let time = format!("{NOTES}/time");
    let time = match stored.reals(&time)?.first() {
        Some(value) if value.is_finite() => *value,
        _ => return Err(FormatError::Unusable { dataset: time }),
    };
    let about = About::read(stored, &format!("VTKHDF/{PARTICLES}"))?;
    Ok(Frame { file, step, time, about, blocks })
}

fn fields(stored: &StoredFile, group: &str, rows: usize) -> Result<Vec<FieldKind>> {
    let kind = |name: String| {
        let dataset = format!("{group}/{name}");
        let (storage, components) = stored.layout(&dataset)?;
        match stored.rows(&dataset)? {
            found if found == rows => Ok(FieldKind { name, components, storage }),
            found => Err(FormatError::Counts { dataset, rows: found, expected: rows as i64 }),
        }
    };
    stored.names(group).into_iter().map(kind).collect()
}
