//! A master: one block of all frames as a series in time.

use super::about;
use super::array::{Array, Storage};
use super::block::TOPOLOGIES;
use super::frame::{BlockSize, FieldKind, Frame, POINTS, label};
use super::hdf5::{Copying, Label, NewFile, NewGroup, Packed, Result, Source, StoredFile};
use crate::error::{Action, Context, Error};
use crate::files::atomically;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Where the numbers of a master are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Numbers {
    /// In the frames: the master is small and needs them beside it.
    InFrames,
    /// In the master itself, compressed this hard: it can be sent.
    Copied(u32),
}

/// Integers of fields where a frame is missing.
const NOTHING: i32 = -1;
/// The same of counts, offsets and ids of points: VTK then shows an instant without points, and no filter looks for points that
/// do not exist, which ends some of them.
const NONE_THERE: i32 = 0;
const TOPOLOGY: [&str; 2] = ["Offsets", "Connectivity"];
/// What an index says of itself.
const INDEX: &str = "An index of a run of tdem: the numbers are in the folder frames/ beside this file. A copy without \
                     that folder shows not a number, and -1 for integers. `tdem pack` makes a file that can be sent.";
/// What a file says of itself that needs no other.
const COMPLETE: &str = "All instants of a run of tdem. This file needs no other.";
/// Attributes of the file that tell what it is, what it lacks, and of which frames it is.
const CONTENT: &str = "content";
const LEFT_OUT: &str = "left_out";
const FRAMES: &str = "frames";

/// What masters show.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown<'a> {
    pub(crate) frames: &'a [Frame],
    /// Names of frames that are damaged or gone.
    pub(crate) left_out: &'a [String],
    /// Stands for all that the frames hold.
    pub(crate) hash: u128,
}

/// Whether a master needs its frames; `None` where it does not say.
pub(crate) fn is_complete(master: &Path) -> Option<bool> {
    Some(StoredFile::open(master).ok()?.text_attribute(CONTENT)? == COMPLETE)
}

/// Whether the masters in a folder hold the numbers of these frames themselves.
pub(crate) fn are_complete(folder: &Path, shown: Shown<'_>) -> bool {
    let is_complete = |name: &String| {
        let Ok(stored) = StoredFile::open(&file_of(folder, name)) else { return false };
        stored.text_attribute(CONTENT).as_deref() == Some(COMPLETE)
            && stored.text_attribute(FRAMES) == Some(format!("{:032x}", shown.hash))
    };
    let names = block_names(shown.frames);
    !names.is_empty() && names.iter().all(is_complete)
}

/// The master of a block in a folder.
pub(crate) fn file_of(folder: &Path, block: &str) -> PathBuf {
    folder.join(format!("{block}.vtkhdf"))
}

/// Names of the blocks that occur in any frame.
pub(crate) fn block_names(frames: &[Frame]) -> Vec<String> {
    let names: BTreeSet<&String> = frames.iter().flat_map(|frame| &frame.blocks).map(|block| &block.name).collect();
    names.into_iter().cloned().collect()
}

/// Writes a master for each block into `folder`. `run` is where the frames' paths begin.
///
/// A block that only some frames have is shown at the times of those; a field that only some frames have is left
/// out: VTK needs every array at every time.
pub(crate) fn write(
    run: &Path,
    folder: &Path,
    shown: Shown<'_>,
    numbers: Numbers,
) -> std::result::Result<Vec<PathBuf>, Error> {
    let mut paths = Vec::new();
    for name in block_names(shown.frames) {
        let path = file_of(folder, &name);
        let series = Series::new(run, &name, shown, numbers);
        atomically(&path, |unfinished| series.write(unfinished).context(Action::Write, &path))?;
        paths.push(path);
    }
    Ok(paths)
}

/// A block at an instant.
struct Instant<'a> {
    frame: &'a Frame,
    block: &'a BlockSize,
}

/// A block at all its instants.
struct Series<'a> {
    run: &'a Path,
    name: &'a str,
    numbers: Numbers,
    shown: Shown<'a>,
    instants: Vec<Instant<'a>>,
    /// Whether points and cells are the same at all instants, and so stored once.
    fixed: bool,
}

impl<'a> Series<'a> {
    fn new(run: &'a Path, name: &'a str, shown: Shown<'a>, numbers: Numbers) -> Self {
        let instants: Vec<Instant<'_>> = shown
            .frames
            .iter()
            .filter_map(|frame| Some((frame, frame.blocks.iter().find(|block| block.name == name)?)))
            .map(|(frame, block)| Instant { frame, block })
            .collect();
        let fixed =
            instants.iter().all(|instant| instant.block.fixed && instant.block.cells == instants[0].block.cells);
        Series { run, name, numbers, shown, instants, fixed }
    }

    /// The instants whose points and cells are stored.
    fn stored(&self) -> &[Instant<'a>] {
        if self.fixed { &self.instants[..1] } else { &self.instants }
    }

    fn write(&self, path: &Path) -> Result<()> {
        let file = NewFile::create(path, false)?;
        let root = file.group("VTKHDF")?;
        root.header("PolyData")?;
        self.describe(&file, &root)?;
        self.write_geometry(&root)?;

        let steps = root.group("Steps")?;
        let count = self.instants.len();
        steps.integer_attribute("NSteps", count as i64)?;
        let times = self.instants.iter().map(|instant| instant.frame.time).collect();
        steps.put("Values", &Packed::new(1, &Array::F64(times), 0)?, Label { unit: "s", description: "time" })?;
        let parts = if self.fixed { vec![0; count] } else { (0..count as i64).collect() };
        steps.put_integers("PartOffsets", 1, parts)?;
        steps.put_integers("NumberOfParts", 1, vec![1; count])?;
        steps.put_integers("PointOffsets", 1, self.geometry_offsets(|block| block.points))?;
        steps.put_integers("CellOffsets", 4, self.by_kind(|block, kind| block.cells[kind]))?;
        steps.put_integers("ConnectivityIdOffsets", 4, self.by_kind(|block, kind| block.connectivity[kind]))?;

        self.write_fields(&root, &steps, "PointData", |block| &block.point_fields, |block| block.points)?;
        self.write_fields(&root, &steps, "CellData", |block| &block.cell_fields, BlockSize::cell_count)?;
        let frames: Vec<&Frame> = self.instants.iter().map(|instant| instant.frame).collect();
        about::write_series(&root, &steps, &frames)?;
        file.close()
    }

    /// What the file is and what it lacks: once for whoever lists the file, once for whoever looks at VTK's group.
    fn describe(&self, file: &NewFile, root: &NewGroup) -> Result<()> {
        let content = if self.numbers == Numbers::InFrames { INDEX } else { COMPLETE };
        file.text_attribute(CONTENT, content)?;
        root.text_attribute(CONTENT, content)?;
        file.text_attribute(FRAMES, &format!("{:032x}", self.shown.hash))?;
        if !self.shown.left_out.is_empty() {
            let left_out = in_brief(self.shown.left_out);
            file.text_attribute(LEFT_OUT, &left_out)?;
            root.text_attribute(LEFT_OUT, &left_out)?;
        }
        Ok(())
    }

    fn write_geometry(&self, root: &NewGroup) -> Result<()> {
        self.put_counts(root, "NumberOfPoints", "NumberOfPoints", |block| block.points)?;
        // The wider storage holds what the narrower one does.
        let wide = self.stored().iter().any(|instant| instant.block.point_storage == Storage::F64);
        let storage = if wide { Storage::F64 } else { Storage::F32 };
        let points = self.sources(self.stored(), "Points", |block| block.points);
        self.put(root, "Points", 3, storage, &points, POINTS)?;
        for (k, kind) in TOPOLOGIES.iter().enumerate() {
            let group = root.group(kind)?;
            let name = "NumberOfCells";
            self.put_counts(&group, name, &format!("{kind}/{name}"), |block| block.cells[k])?;
            let name = "NumberOfConnectivityIds";
            self.put_counts(&group, name, &format!("{kind}/{name}"), |block| block.connectivity[k])?;
            let offsets = self.sources(self.stored(), &format!("{kind}/Offsets"), |block| block.cells[k] + 1);
            self.put(&group, TOPOLOGY[0], 1, Storage::I64, &offsets, Label::default())?;
            let ids = self.sources(self.stored(), &format!("{kind}/Connectivity"), |block| block.connectivity[k]);
            self.put(&group, TOPOLOGY[1], 1, Storage::I64, &ids, Label::default())?;
        }
        Ok(())
    }

    /// Counts of stored instants. An index takes them from the frames, too: without those, there is nothing to count.
    fn put_counts(
        &self,
        group: &NewGroup,
        name: &str,
        dataset: &str,
        count: impl Fn(&BlockSize) -> usize,
    ) -> Result<()> {
        match self.numbers {
            Numbers::InFrames => {
                let sources = self.sources(self.stored(), dataset, |_| 1);
                group.put_virtual(name, 1, Storage::I64, &sources, NONE_THERE, Label::default())
            }
            Numbers::Copied(_) => {
                let counts = self.stored().iter().map(|instant| count(instant.block) as i64);
                group.put_integers(name, 1, counts.collect())
            }
        }
    }

    /// Fields have values at every instant, also where points and cells are stored once.
    fn write_fields(
        &self,
        root: &NewGroup,
        steps: &NewGroup,
        place: &str,
        fields: fn(&BlockSize) -> &Vec<FieldKind>,
        rows: fn(&BlockSize) -> usize,
    ) -> Result<()> {
        let group = root.group(place)?;
        let offsets = steps.group(&format!("{place}Offsets"))?;
        let everywhere = |field: &&FieldKind| self.instants.iter().all(|instant| fields(instant.block).contains(field));
        let first = self.instants.first().map(|instant| fields(instant.block).as_slice()).unwrap_or_default();
        for field in first.iter().filter(everywhere) {
            let sources = self.sources(&self.instants, &format!("{place}/{}", field.name), rows);
            let label = label(self.name, &field.name);
            self.put(&group, &field.name, field.components, field.storage, &sources, label)?;
            offsets.put_integers(&field.name, 1, running(&self.instants, rows))?;
        }
        Ok(())
    }

    fn sources(&self, instants: &[Instant<'_>], dataset: &str, rows: impl Fn(&BlockSize) -> usize) -> Vec<Source> {
        let source = |instant: &Instant<'_>| Source {
            file: instant.frame.file.clone(),
            dataset: format!("/VTKHDF/{}/{dataset}", self.name),
            rows: rows(instant.block),
        };
        instants.iter().map(source).collect()
    }

    fn put(
        &self,
        group: &NewGroup,
        name: &str,
        components: usize,
        storage: Storage,
        sources: &[Source],
        label: Label,
    ) -> Result<()> {
        match self.numbers {
            Numbers::InFrames => {
                let nothing = if TOPOLOGY.contains(&name) { NONE_THERE } else { NOTHING };
                group.put_virtual(name, components, storage, sources, nothing, label)
            }
            Numbers::Copied(level) => {
                let copying = Copying { folder: self.run, level };
                group.put_copy(name, components, storage, sources, &copying, label)
            }
        }
    }

    fn geometry_offsets(&self, rows: impl Fn(&BlockSize) -> usize) -> Vec<i64> {
        if self.fixed { vec![0; self.instants.len()] } else { running(&self.instants, rows) }
    }

    /// Offsets of the four kinds of cells, `(steps, 4)`.
    fn by_kind(&self, rows: impl Fn(&BlockSize, usize) -> usize) -> Vec<i64> {
        let columns: [Vec<i64>; 4] = std::array::from_fn(|kind| self.geometry_offsets(|block| rows(block, kind)));
        (0..self.instants.len()).flat_map(|step| columns.each_ref().map(|column| column[step])).collect()
    }
}

/// The first few names, and how many more there are.
fn in_brief(names: &[String]) -> String {
    const SHOWN: usize = 20;
    let shown = names.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
    let more = names.len().saturating_sub(SHOWN);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{shown}{more}: damaged or gone")
}

/// Where the rows of each instant begin.
fn running(instants: &[Instant<'_>], rows: impl Fn(&BlockSize) -> usize) -> Vec<i64> {
    let mut end = 0;
    let begin = |instant: &Instant<'_>| {
        let begin = end;
        end += rows(instant.block) as i64;
        begin
    };
    instants.iter().map(begin).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Seal;
    use crate::vtkhdf::about::{About, Names};
    use crate::vtkhdf::block::{Block, Cells, Field};
    use crate::vtkhdf::frame::Moment;
    use crate::vtkhdf::hdf5::StoredFile;
    use std::fs;

    fn points(name: &'static str, count: usize, fixed: bool) -> Block {
        let ids = (0..count as i64).collect();
        Block {
            name,
            points: Array::F64((0..3 * count).map(|k| k as f64).collect()),
            cells: Cells::Vertices,
            point_fields: vec![Field { name: "id".into(), components: 1, data: Array::I64(ids) }],
            cell_fields: Vec::new(),
            fixed,
        }
    }

    fn names() -> Names {
        Names { title: "M\u{fc}ller's disc".into(), materials: vec!["glass".into(), "steel".into()] }
    }

    fn frames(run: &Path, blocks: &[Vec<Block>]) -> Vec<Frame> {
        fs::create_dir(run.join("frames")).unwrap();
        let write = |(step, blocks): (usize, &Vec<Block>)| {
            let file = format!("frames/{step}.vtkhdf");
            let told = || About { heat_time: Some(10.0 * step as f64), names: names() };
            let about = if blocks[0].name == "particles" { told() } else { About::default() };
            let moment = Moment { step: step as u64, time: step as f64, about };
            let (frame, seal) = Frame::write(run, file.clone(), moment, blocks, 4).unwrap();
            assert_eq!(seal, Seal::of(&run.join(&file)).unwrap());
            let mut read = Frame::read(run, file).unwrap();
            read.blocks.sort_by_key(|block| blocks.iter().position(|other| other.name == block.name));
            // Letters that VTK does not read are not there any more.
            read.about.names.title = read.about.names.title.replace('?', "\u{fc}");
            assert_eq!(read, frame, "a frame on the disk is what its writer remembers");
            frame
        };
        blocks.iter().enumerate().map(write).collect()
    }

    fn all(frames: &[Frame]) -> Shown<'_> {
        Shown { frames, left_out: &[], hash: 7 }
    }

    #[test]
    fn virtual_and_copied_numbers_are_those_of_the_frames() {
        let run = tempfile::tempdir().unwrap();
        // Sizes on both sides of a chunk, and none at all.
        let counts = [3, 0, 70_000, 300, 65_536];
        let frames = frames(run.path(), &counts.map(|count| vec![points("particles", count, false)]));
        let expected: Vec<i64> = counts.iter().flat_map(|&count| 0..count as i64).collect();
        for numbers in [Numbers::InFrames, Numbers::Copied(0), Numbers::Copied(6)] {
            let paths = write(run.path(), run.path(), all(&frames), numbers).unwrap();
            let stored = StoredFile::open(&paths[0]).unwrap();
            assert_eq!(stored.integers("VTKHDF/PointData/id").unwrap(), expected, "{numbers:?}");
            assert_eq!(stored.integers("VTKHDF/Steps/PointOffsets").unwrap(), [0, 3, 3, 70_003, 70_303]);
            let offsets = stored.integers("VTKHDF/Vertices/Offsets").unwrap();
            assert_eq!(&offsets[..6], [0, 1, 2, 3, 0, 0], "an empty part holds one 0");
        }
    }

    #[test]
    fn fixed_geometry_is_stored_once_and_fields_at_every_time() {
        let run = tempfile::tempdir().unwrap();
        let frames = frames(run.path(), &[(); 3].map(|()| vec![points("walls", 2, true)]));
        let paths = write(run.path(), run.path(), all(&frames), Numbers::InFrames).unwrap();
        let stored = StoredFile::open(&paths[0]).unwrap();
        assert_eq!(stored.integers("VTKHDF/NumberOfPoints").unwrap(), [2]);
        assert_eq!(stored.integers("VTKHDF/Steps/PartOffsets").unwrap(), [0, 0, 0]);
        assert_eq!(stored.integers("VTKHDF/Steps/PointDataOffsets/id").unwrap(), [0, 2, 4]);
        assert_eq!(stored.integers("VTKHDF/PointData/id").unwrap(), [0, 1, 0, 1, 0, 1]);
    }

    #[test]
    fn a_series_tells_times_of_the_heat_and_names() {
        let run = tempfile::tempdir().unwrap();
        let frames = frames(run.path(), &[(); 3].map(|()| vec![points("particles", 2, false)]));
        let paths = write(run.path(), run.path(), all(&frames), Numbers::InFrames).unwrap();
        let stored = StoredFile::open(&paths[0]).unwrap();
        assert_eq!(stored.reals("VTKHDF/FieldData/heat_time").unwrap(), [0.0, 10.0, 20.0]);
        assert_eq!(stored.integers("VTKHDF/FieldData/step").unwrap(), [0, 1, 2]);
        assert_eq!(stored.integers("VTKHDF/FieldData/title M?ller's disc").unwrap(), [0]);
        assert_eq!(stored.integers("VTKHDF/FieldData/material 0 glass").unwrap(), [0]);
        assert_eq!(stored.integers("VTKHDF/FieldData/material 1 steel").unwrap(), [1]);
        assert_eq!(stored.integers("VTKHDF/Steps/FieldDataOffsets/heat_time").unwrap(), [0, 1, 2]);
        assert_eq!(stored.integers("VTKHDF/Steps/FieldDataOffsets/material 1 steel").unwrap(), [0, 0, 0]);
        assert_eq!(stored.integers("VTKHDF/Steps/FieldDataSizes/material 1 steel").unwrap(), [1; 6]);
    }

    #[test]
    fn a_block_that_came_later_begins_later() {
        let run = tempfile::tempdir().unwrap();
        let both = vec![points("particles", 2, false), points("contacts", 1, false)];
        let frames = frames(run.path(), &[vec![points("particles", 2, false)], both]);
        let paths = write(run.path(), run.path(), all(&frames), Numbers::InFrames).unwrap();
        assert!(paths[0].ends_with("contacts.vtkhdf") && paths[1].ends_with("particles.vtkhdf"));
        assert_eq!(StoredFile::open(&paths[0]).unwrap().reals("VTKHDF/Steps/Values").unwrap(), [1.0]);
        assert_eq!(StoredFile::open(&paths[1]).unwrap().reals("VTKHDF/Steps/Values").unwrap(), [0.0, 1.0]);
    }

    #[test]
    fn a_master_without_its_frames_shows_no_numbers_and_says_that_it_is_an_index() {
        let (run, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let frames = frames(run.path(), &[3, 5].map(|count| vec![points("particles", count, false)]));
        for (numbers, content) in [(Numbers::InFrames, INDEX), (Numbers::Copied(4), COMPLETE)] {
            let path = write(run.path(), run.path(), all(&frames), numbers).unwrap().remove(0);
            let copy = elsewhere.path().join("particles.vtkhdf");
            fs::copy(&path, &copy).unwrap();
            let stored = StoredFile::open(&copy).unwrap();
            assert_eq!(stored.text_attribute(CONTENT).as_deref(), Some(content));
            let (points, ids) =
                (stored.reals("VTKHDF/Points").unwrap(), stored.integers("VTKHDF/PointData/id").unwrap());
            assert_eq!((points.len(), ids.len()), (24, 8));
            let alone = numbers == Numbers::InFrames;
            assert_eq!(points.iter().all(|value| value.is_nan()), alone, "{points:?}");
            assert_eq!(ids.iter().all(|&id| id == -1), alone, "{ids:?}");
            let counts = stored.integers("VTKHDF/NumberOfPoints").unwrap();
            assert_eq!(counts, if alone { [0, 0] } else { [3, 5] });
            assert_eq!(are_complete(run.path(), all(&frames)), !alone);
            assert!(!are_complete(run.path(), Shown { hash: 8, ..all(&frames) }), "they are of other frames");
        }
    }

    #[test]
    fn a_master_tells_which_frames_it_lacks() {
        let run = tempfile::tempdir().unwrap();
        let frames = frames(run.path(), &[vec![points("particles", 3, false)]]);
        let names: Vec<String> = (1..25).map(|number| format!("frames/{number}.vtkhdf")).collect();
        for (count, end) in
            [(1, "frames/1.vtkhdf: damaged or gone"), (24, "frames/20.vtkhdf and 4 more: damaged or gone")]
        {
            let shown = Shown { left_out: &names[..count], ..all(&frames) };
            let path = write(run.path(), run.path(), shown, Numbers::InFrames).unwrap().remove(0);
            let told = StoredFile::open(&path).unwrap().text_attribute(LEFT_OUT).unwrap();
            assert!(told.starts_with("frames/1.vtkhdf") && told.ends_with(end), "{told}");
        }
    }
}
