//! The only module that names the HDF5 library: what VTKHDF files need of it, and no more.

use super::array::{Array, Storage, each};
use bytemuck::{NoUninit, cast_slice};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;
use rust_hdf5::{
    DatatypeMessage, FileLocking, H5Dataset, H5File, H5Group, H5Type, Hdf5Error, Hyperslab, HyperslabBlock, Selection,
    StorageLayout,
};
use std::io::Write;
use std::path::Path;
use thiserror::Error;

/// Why an HDF5 file could not be written or understood.
#[derive(Debug, Error)]
pub enum FormatError {
    /// The library of the format says why.
    #[error(transparent)]
    Library(#[from] Hdf5Error),
    /// A dataset would hold more than its file can.
    #[error("`{dataset}` says that it holds {values} values, more than a file of {file_bytes} bytes can")]
    TooLarge {
        /// Its name.
        dataset: String,
        /// Values that its shape stands for.
        values: u128,
        /// Length of the file.
        file_bytes: u64,
    },
    /// Counts of points or cells are not those of the datasets they count.
    #[error("`{dataset}` has {rows} rows where {expected} are counted")]
    Counts {
        /// The dataset.
        dataset: String,
        /// Its rows.
        rows: usize,
        /// What the counts say.
        expected: i64,
    },
    /// A number or a name is none that this program writes.
    #[error("`{dataset}` is not as this program writes it")]
    Unusable {
        /// Where it stands.
        dataset: String,
    },
}

impl FormatError {
    /// The operating system's error, if it was one.
    pub(crate) fn into_io(self) -> std::result::Result<std::io::Error, FormatError> {
        match self {
            FormatError::Library(Hdf5Error::Io(error)) => Ok(error),
            // The library keeps the type of its inner error to itself; what it prints ends with the system's number.
            FormatError::Library(other) => match os_error(&other.to_string()) {
                Some(code) => Ok(std::io::Error::from_raw_os_error(code)),
                None => Err(FormatError::Library(other)),
            },
            other => Err(other),
        }
    }
}

/// The number in `... (os error 28)`.
fn os_error(message: &str) -> Option<i32> {
    let (_, rest) = message.rsplit_once("(os error ")?;
    rest.split(')').next()?.parse().ok()
}

pub(crate) type Result<T> = std::result::Result<T, FormatError>;

/// Rows per chunk of a compressed dataset.
const CHUNK: usize = 65_536;
/// Shorter datasets are stored as they are: a chunk index would cost more than compression saves.
const WORTH_COMPRESSING: usize = 256;

/// No filter was left out of a chunk.
const ALL_FILTERS: u32 = 0;
/// Deflate packs at most 1032 bytes into one; a compressed dataset holds no more than this times its file.
const MOST_PACKED: u128 = 1032;
/// Chunks that are compressed at a time when numbers are copied: as many as cores can share, few enough for the memory.
const BATCH: usize = 32;

fn compressed(rows: usize, level: u32) -> bool {
    level > 0 && rows >= WORTH_COMPRESSING
}

/// Numbers as a dataset will hold them.
pub(crate) struct Packed<'a> {
    array: &'a Array,
    components: usize,
    level: u32,
    /// None if they are stored as they are.
    chunks: Option<Vec<Vec<u8>>>,
}

impl<'a> Packed<'a> {
    /// Compressed on all cores when that is worth it; `level` 0 never compresses.
    pub(crate) fn new(components: usize, array: &'a Array, level: u32) -> Result<Self> {
        let rows = array.len() / components;
        let chunks = if compressed(rows, level) {
            Some(each!(array, values => pack(values, rows.min(CHUNK) * components, level))?)
        } else {
            None
        };
        Ok(Packed { array, components, level, chunks })
    }
}

/// Chunks of so many values, each filtered as the library would do it, which does it on one core.
fn pack<T: NoUninit + Sync>(values: &[T], chunk: usize, level: u32) -> Result<Vec<Vec<u8>>> {
    let filter = |values: &[T]| {
        // The last chunk is as long as the others: zeros follow.
        let mut planes = vec![0; chunk * size_of::<T>()];
        for (byte, plane) in planes.chunks_exact_mut(chunk).enumerate() {
            let of_values = cast_slice::<T, u8>(values).iter().skip(byte).step_by(size_of::<T>());
            plane.iter_mut().zip(of_values).for_each(|(place, &value)| *place = value);
        }
        let mut encoder = ZlibEncoder::new(Vec::with_capacity(planes.len()), Compression::new(level));
        encoder.write_all(&planes)?;
        encoder.finish()
    };
    let packed: std::io::Result<_> = values.par_chunks(chunk).map(filter).collect();
    packed.map_err(|error| Hdf5Error::Io(error).into())
}

/// A file that is being written.
pub(crate) struct NewFile(H5File);

/// A group of a file that is being written.
pub(crate) struct NewGroup(H5Group);

/// Documentation that travels with a dataset, as attributes.
#[derive(Clone, Copy, Default)]
pub(crate) struct Label {
    pub(crate) unit: &'static str,
    pub(crate) description: &'static str,
}

/// Rows of a dataset of another file.
pub(crate) struct Source {
    /// Relative to the file that refers to it.
    pub(crate) file: String,
    pub(crate) dataset: String,
    pub(crate) rows: usize,
}

impl NewFile {
    /// `ordered` keeps links in the order of creation: VTK walks an `Assembly` in that order.
    pub(crate) fn create(path: &Path, ordered: bool) -> Result<Self> {
        // Nobody knows the temporary name, so a lock would only cost file systems without locks their files.
        let file = H5File::options().locking(FileLocking::Disabled).track_order(ordered).create(path)?;
        file.set_track_order(ordered)?;
        Ok(NewFile(file))
    }
    pub(crate) fn group(&self, name: &str) -> Result<NewGroup> {
        Ok(NewGroup(self.0.create_group(name)?))
    }
    /// An attribute of the file itself.
    pub(crate) fn text_attribute(&self, name: &str, text: &str) -> Result<()> {
        Ok(self.0.set_attr_typed(name, ascii(text), text.as_bytes().to_vec())?)
    }
    pub(crate) fn close(self) -> Result<()> {
        // Whoever gives the file its name syncs it.
        Ok(self.0.close_no_sync()?)
    }
}

impl NewGroup {
    pub(crate) fn group(&self, name: &str) -> Result<NewGroup> {
        Ok(NewGroup(self.0.create_group(name)?))
    }

    /// Version and type, as every VTKHDF group has them.
    pub(crate) fn header(&self, kind: &str) -> Result<()> {
        self.0.set_attr_array_numeric("Version", &[2_i64, 2])?;
        Ok(self.0.set_attr_typed("Type", ascii(kind), kind.as_bytes().to_vec())?)
    }
    pub(crate) fn integer_attribute(&self, name: &str, value: i64) -> Result<()> {
        Ok(self.0.set_attr_numeric(name, &value)?)
    }
    pub(crate) fn text_attribute(&self, name: &str, text: &str) -> Result<()> {
        Ok(self.0.set_attr_typed(name, ascii(text), text.as_bytes().to_vec())?)
    }
    pub(crate) fn soft_link(&self, name: &str, target: &str) -> Result<()> {
        Ok(self.0.create_soft_link(name, target)?)
    }

    /// A dataset.
    pub(crate) fn put(&self, name: &str, packed: &Packed<'_>, label: Label) -> Result<()> {
        let Packed { array, components, level, chunks } = packed;
        each!(*array, values => {
            let rows = values.len() / components;
            let dataset = self.create(name, rows, *components, *level, label, values.first())?;
            match chunks {
                Some(chunks) => {
                    for (index, chunk) in chunks.iter().enumerate() {
                        dataset.write_chunk_raw(index, chunk, ALL_FILTERS)?;
                    }
                }
                // The library refuses to write nothing.
                None if values.is_empty() => {}
                None => dataset.write_raw(values)?,
            }
            Ok(())
        })
    }
    /// A short dataset of integers without documentation.
    pub(crate) fn put_integers(&self, name: &str, components: usize, values: Vec<i64>) -> Result<()> {
        self.put(name, &Packed::new(components, &Array::I64(values), 0)?, Label::default())
    }

    /// A virtual dataset: the rows of the sources, one after the other, which stay where they are. Where a source is not
    /// found, readers see not a number, and this integer.
    pub(crate) fn put_virtual(
        &self,
        name: &str,
        components: usize,
        storage: Storage,
        sources: &[Source],
        nothing: i32,
        label: Label,
    ) -> Result<()> {
        match storage {
            Storage::F32 => self.map::<f32>(name, components, sources, f32::NAN, label),
            Storage::F64 => self.map::<f64>(name, components, sources, f64::NAN, label),
            Storage::I32 => self.map::<i32>(name, components, sources, nothing, label),
            Storage::I64 => self.map::<i64>(name, components, sources, nothing.into(), label),
        }
    }

    /// A dataset that holds copies of the rows of the sources, one after the other, never more than one source and
    /// one chunk in memory.
    pub(crate) fn put_copy(
        &self,
        name: &str,
        components: usize,
        storage: Storage,
        sources: &[Source],
        copying: &Copying<'_>,
        label: Label,
    ) -> Result<()> {
        match storage {
            Storage::F32 => self.copy::<f32>(name, components, sources, copying, label),
            Storage::F64 => self.copy::<f64>(name, components, sources, copying, label),
            Storage::I32 => self.copy::<i32>(name, components, sources, copying, label),
            Storage::I64 => self.copy::<i64>(name, components, sources, copying, label),
        }
    }

    fn create<T: H5Type>(
        &self,
        name: &str,
        rows: usize,
        components: usize,
        level: u32,
        label: Label,
        _: Option<&T>,
    ) -> Result<H5Dataset> {
        let mut builder = self.0.new_dataset::<T>().shape(shape(rows, components));
        if compressed(rows, level) {
            // VTK's reader knows no other filters than these two.
            builder = builder.chunk(&shape(rows.min(CHUNK), components)).shuffle_deflate(level);
        }
        let dataset = builder.create(name)?;
        describe(&dataset, label)?;
        Ok(dataset)
    }

    fn map<T: H5Type>(
        &self,
        name: &str,
        components: usize,
        sources: &[Source],
        nothing: T,
        label: Label,
    ) -> Result<()> {
        let rows = sources.iter().map(|source| source.rows).sum();
        let mut builder = self.0.new_dataset::<T>().shape(shape(rows, components)).fill_value(nothing);
        let mut first = 0;
        for source in sources.iter().filter(|source| source.rows > 0) {
            let last = first + source.rows as u64 - 1;
            let block = if components > 1 {
                HyperslabBlock { start: vec![first, 0], end: vec![last, components as u64 - 1] }
            } else {
                HyperslabBlock { start: vec![first], end: vec![last] }
            };
            let rank = if components > 1 { 2 } else { 1 };
            let target = Selection::Hyperslab { rank, form: Hyperslab::Blocks(vec![block]) };
            builder = builder.virtual_mapping(target, &source.file, &source.dataset, Selection::All);
            first = last + 1;
        }
        describe(&builder.create(name)?, label)
    }

    fn copy<T: H5Type + NoUninit + Sync>(
        &self,
        name: &str,
        components: usize,
        sources: &[Source],
        copying: &Copying<'_>,
        label: Label,
    ) -> Result<()> {
        let rows: usize = sources.iter().map(|source| source.rows).sum();
        let dataset = self.create::<T>(name, rows, components, copying.level, label, None)?;
        let chunk = rows.min(CHUNK) * components;
        let compressed = compressed(rows, copying.level);
        let mut waiting: Vec<T> = Vec::new();
        let mut written = 0;
        let mut write = |values: &[T]| -> Result<()> {
            if compressed {
                for (index, packed) in pack(values, chunk, copying.level)?.iter().enumerate() {
                    dataset.write_chunk_raw(written / CHUNK + index, packed, ALL_FILTERS)?;
                }
            } else if !values.is_empty() {
                let (start, count) = (values.len() / components, components);
                let (start, count) =
                    if components > 1 { (vec![written, 0], vec![start, count]) } else { (vec![written], vec![start]) };
                dataset.write_slice(&start, &count, values)?;
            }
            written += values.len() / components;
            Ok(())
        };
        for source in sources.iter().filter(|source| source.rows > 0) {
            let file = StoredFile::open(&copying.folder.join(&source.file))?;
            let values = file.dataset(&source.dataset)?.read_raw::<T>()?;
            if values.len() != source.rows * components {
                let (dataset, rows) = (source.dataset.clone(), values.len() / components);
                return Err(FormatError::Counts { dataset, rows, expected: source.rows as i64 });
            }
            waiting.extend(values);
            // Whole chunks only, so that each is packed once.
            if waiting.len() >= BATCH * chunk {
                let whole = waiting.len() / chunk * chunk;
                write(&waiting[..whole])?;
                waiting.drain(..whole);
            }
        }
        write(&waiting)
    }
}

/// Where copies come from and how hard they are compressed.
pub(crate) struct Copying<'a> {
    pub(crate) folder: &'a Path,
    pub(crate) level: u32,
}

/// A finished file.
pub(crate) struct StoredFile {
    file: H5File,
    /// Its length; nothing in it is larger than that lets it be.
    bytes: u64,
}

impl StoredFile {
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let bytes = std::fs::metadata(path).map_err(Hdf5Error::Io)?.len();
        // Frames never change once they have their name.
        Ok(StoredFile { file: H5File::options().no_locking().open(path)?, bytes })
    }
    /// A dataset, of which no more is said than its file can hold: only then is room made for it.
    fn dataset(&self, name: &str) -> Result<H5Dataset> {
        let dataset = self.file.dataset(name.trim_start_matches('/'))?;
        let count = |dims: &[usize]| dims.iter().fold(1_u128, |all, &dim| all.saturating_mul(dim as u128));
        let values = count(&dataset.shape()).max(dataset.chunk_dims().map_or(0, |dims| count(&dims)));
        let room = match dataset.storage_layout()? {
            StorageLayout::Chunked => MOST_PACKED * u128::from(self.bytes),
            StorageLayout::Contiguous | StorageLayout::Compact => u128::from(self.bytes),
            // The numbers of a master are in other files.
            StorageLayout::Virtual => u128::MAX,
        };
        if values.saturating_mul(dataset.element_size() as u128) > room {
            return Err(FormatError::TooLarge { dataset: name.into(), values, file_bytes: self.bytes });
        }
        Ok(dataset)
    }
    /// A text that belongs to the file itself, if there is one of this name.
    pub(crate) fn text_attribute(&self, name: &str) -> Option<String> {
        self.file.attr_string(name).ok()
    }
    /// Number of rows of a dataset.
    pub(crate) fn rows(&self, dataset: &str) -> Result<usize> {
        Ok(self.dataset(dataset)?.shape().first().copied().unwrap_or(1))
    }
    /// Names of the datasets directly in a group; none if there is no such group.
    pub(crate) fn names(&self, group: &str) -> Vec<String> {
        let prefix = format!("{}/", group.trim_matches('/'));
        let names = self.file.dataset_names();
        let inside = names.iter().filter_map(|name| name.trim_start_matches('/').strip_prefix(&prefix));
        inside.filter(|name| !name.contains('/')).map(Into::into).collect()
    }
    pub(crate) fn integers(&self, dataset: &str) -> Result<Vec<i64>> {
        Ok(self.dataset(dataset)?.read_raw::<i64>()?)
    }
    pub(crate) fn reals(&self, dataset: &str) -> Result<Vec<f64>> {
        Ok(self.dataset(dataset)?.read_raw::<f64>()?)
    }
    /// Numbers as they are stored.
    pub(crate) fn array(&self, name: &str) -> Result<Array> {
        let dataset = self.dataset(name)?;
        Ok(match self.layout(name)?.0 {
            Storage::F32 => Array::F32(dataset.read_raw()?),
            Storage::F64 => Array::F64(dataset.read_raw()?),
            Storage::I32 => Array::I32(dataset.read_raw()?),
            Storage::I64 => Array::I64(dataset.read_raw()?),
        })
    }
    /// How a dataset is stored, and how many components a row has.
    pub(crate) fn layout(&self, name: &str) -> Result<(Storage, usize)> {
        let dataset = self.dataset(name)?;
        let storage = match dataset.datatype()? {
            DatatypeMessage::FloatingPoint { size: 4, .. } => Storage::F32,
            DatatypeMessage::FloatingPoint { size: 8, .. } => Storage::F64,
            DatatypeMessage::FixedPoint { size: 4, signed: true, .. } => Storage::I32,
            DatatypeMessage::FixedPoint { size: 8, signed: true, .. } => Storage::I64,
            other => return Err(Hdf5Error::Unsupported(format!("a dataset of type {other:?}")).into()),
        };
        match dataset.shape().as_slice() {
            [_] => Ok((storage, 1)),
            &[_, components] if components > 0 => Ok((storage, components)),
            _ => Err(FormatError::Unusable { dataset: name.into() }),
        }
    }
}

fn shape(rows: usize, components: usize) -> Vec<usize> {
    if components > 1 { vec![rows, components] } else { vec![rows] }
}

/// Fixed length, null-padded: VTK does not read the variable-length kind.
fn ascii(text: &str) -> DatatypeMessage {
    DatatypeMessage::FixedString { size: text.len() as u32, padding: 1, charset: 0 }
}

fn describe(dataset: &H5Dataset, label: Label) -> Result<()> {
    for (name, text) in [("unit", label.unit), ("description", label.description)] {
        if !text.is_empty() {
            dataset.set_attr_typed(name, ascii(text), text.as_bytes().to_vec())?;
        }
    }
    Ok(())
}
