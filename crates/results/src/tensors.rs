//! Files of numbers in the safetensors format, in which a change of any byte is found.
//!
//! Every tensor has its XXH3 hash (128 bits, hexadecimal) in the header's metadata, and the header has its own.

use crate::error::{Action, Context, Error};
use crate::files::atomically;
use bytemuck::{Pod, cast_slice, pod_read_unaligned};
use rayon::prelude::*;
use safetensors::{Dtype, SafeTensors};
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use tdem_engine::Flaw;
use thiserror::Error;
use xxhash_rust::xxh3::xxh3_128;

#[cfg(target_endian = "big")]
compile_error!("files hold little-endian numbers as they are in memory");

/// Where the header's own hash will stand, while it is computed.
const NO_HASH: &str = "00000000000000000000000000000000";
/// Safetensors pads its header to this.
const ALIGNMENT: usize = 8;

/// Why a file of numbers cannot be trusted.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum Damage {
    /// The file is not in the format at all, or cut off.
    #[error("it is cut off or not a checkpoint")]
    Unreadable,
    /// The header was changed.
    #[error("its header was changed")]
    Header,
    /// The numbers of a tensor were changed.
    #[error("`{tensor}` was changed")]
    Tensor {
        /// Its name.
        tensor: &'static str,
    },
    /// A tensor is missing or has another type or shape than this version writes.
    #[error("`{tensor}` is missing or not as this version writes it")]
    Layout {
        /// Its name.
        tensor: &'static str,
    },
    /// The numbers belong together in no state.
    #[error("{0}")]
    Flaw(#[from] Flaw),
    /// It is under the name of another step.
    #[error("it is of step {step}, not of that in its name")]
    Name {
        /// The step.
        step: u64,
    },
    /// The operating system cannot read it.
    #[error("it cannot be read ({kind})")]
    Inaccessible {
        /// Why not.
        kind: std::io::ErrorKind,
    },
}

/// Writes tensors into a file, which then exists whole or not at all.
pub(crate) fn write(path: &Path, format: &str, tensors: &[Tensor<'_>]) -> Result<(), Error> {
    let header = header(format, tensors);
    atomically(path, |unfinished| {
        let put = || -> std::io::Result<()> {
            let mut file = BufWriter::with_capacity(1 << 20, File::create(unfinished)?);
            file.write_all(&(header.len() as u64).to_le_bytes())?;
            file.write_all(&header)?;
            for tensor in tensors {
                file.write_all(tensor.bytes)?;
            }
            file.into_inner()?.sync_all()
        };
        put().context(Action::Write, path)
    })
}

fn hash(bytes: &[u8]) -> String {
    format!("{:032x}", xxh3_128(bytes))
}

/// Numbers and their name in a file.
pub(crate) struct Tensor<'a> {
    pub(crate) name: &'static str,
    kind: &'static str,
    shape: Vec<usize>,
    bytes: &'a [u8],
}

impl<'a> Tensor<'a> {
    pub(crate) fn new<T: Element>(name: &'static str, values: &'a [T]) -> Self {
        let mut shape = vec![values.len()];
        shape.extend(T::SHAPE);
        Tensor { name, kind: T::KIND, shape, bytes: cast_slice(values) }
    }
}

#[cfg(test)]
impl Tensor<'_> {
    /// Name, type, shape and bytes.
    pub(crate) fn parts(&self) -> (String, String, Vec<usize>, Vec<u8>) {
        (self.name.into(), self.kind.into(), self.shape.clone(), self.bytes.into())
    }
}

/// The bytes of a file of any tensors, with right hashes.
#[cfg(test)]
pub(crate) fn file<'a>(format: &str, tensors: impl Iterator<Item = Column<'a>>) -> Vec<u8> {
    let tensors: Vec<Column<'_>> = tensors.collect();
    let header = header_of(format, &tensors);
    let data: Vec<u8> = tensors.iter().flat_map(|(_, _, _, bytes)| bytes.iter().copied()).collect();
    [&(header.len() as u64).to_le_bytes()[..], &header, &data].concat()
}

/// What rows of a tensor may be.
pub(crate) trait Element: Pod {
    const KIND: &'static str;
    const DTYPE: Dtype;
    /// Shape of one row.
    const SHAPE: &'static [usize];
}

macro_rules! element {
    ($($row:ty: $kind:ident $shape:expr),* $(,)?) => {$(
        impl Element for $row {
            const KIND: &'static str = stringify!($kind);
            const DTYPE: Dtype = Dtype::$kind;
            const SHAPE: &'static [usize] = &$shape;
        }
    )*};
}
element! {
    u8: U8 [], u16: U16 [], u32: U32 [], u64: U64 [], f64: F64 [],
    [u32; 2]: U32 [2], [i32; 3]: I32 [3], [f64; 3]: F64 [3], [f64; 4]: F64 [4], [f64; 10]: F64 [10],
    [[f64; 3]; 4]: F64 [4, 3],
}

/// The header of the file. The format is simple enough to be written here; the library would need all tensors
/// before their hashes, in one buffer or in a temporary file of its own naming.
fn header(format: &str, tensors: &[Tensor<'_>]) -> Vec<u8> {
    let columns = tensors.iter().map(|tensor| (tensor.name, tensor.kind, &tensor.shape[..], tensor.bytes));
    header_of(format, &columns.collect::<Vec<_>>())
}

/// Name, type, shape and bytes of a tensor.
pub(crate) type Column<'a> = (&'a str, &'a str, &'a [usize], &'a [u8]);

fn header_of(format: &str, tensors: &[Column<'_>]) -> Vec<u8> {
    let mut metadata = Map::new();
    metadata.insert("format".into(), format.into());
    metadata.insert("header".into(), NO_HASH.into());
    let mut entries = Map::new();
    let mut begin = 0;
    let hashes: Vec<String> = tensors.par_iter().map(|(_, _, _, bytes)| hash(bytes)).collect();
    for (&(name, kind, shape, bytes), hash) in tensors.iter().zip(hashes) {
        let end = begin + bytes.len();
        entries.insert(name.into(), json!({ "dtype": kind, "shape": shape, "data_offsets": [begin, end] }));
        metadata.insert(format!("xxh3.{name}"), hash.into());
        begin = end;
    }
    entries.insert("__metadata__".into(), Value::Object(metadata));
    let mut text = Value::Object(entries).to_string();
    let padded = text.len().next_multiple_of(ALIGNMENT);
    text.extend(std::iter::repeat_n(' ', padded - text.len()));
    // The format's own hash stands in for itself; it is the first run of zeros of this length.
    let own = hash(text.as_bytes());
    text.replacen(NO_HASH, &own, 1).into_bytes()
}

/// A file whose header is as it was written.
pub(crate) struct Reader<'a> {
    tensors: SafeTensors<'a>,
    hashes: HashMap<String, String>,
}

impl<'a> Reader<'a> {
    /// Looks at the bytes of a file of a format.
    pub(crate) fn new(bytes: &'a [u8], format: &str) -> Result<Self, Damage> {
        let (length, metadata) = SafeTensors::read_metadata(bytes).map_err(|_| Damage::Unreadable)?;
        let hashes = metadata.metadata().as_ref().ok_or(Damage::Header)?;
        if hashes.get("format").map(String::as_str) != Some(format) {
            return Err(Damage::Header);
        }
        let header = std::str::from_utf8(&bytes[8..8 + length]).map_err(|_| Damage::Header)?;
        let own = hashes.get("header").ok_or(Damage::Header)?;
        if *own != hash(header.replacen(own.as_str(), NO_HASH, 1).as_bytes()) {
            return Err(Damage::Header);
        }
        let tensors = SafeTensors::deserialize(bytes).map_err(|_| Damage::Unreadable)?;
        Ok(Reader { tensors, hashes: hashes.clone() })
    }

    /// Whether there is a tensor of this name.
    pub(crate) fn has(&self, tensor: &str) -> bool {
        self.tensors.tensor(tensor).is_ok()
    }

    /// All rows of a tensor, once its hash is found to be right.
    pub(crate) fn rows<T: Element>(&self, tensor: &'static str) -> Result<Vec<T>, Damage> {
        let layout = || Damage::Layout { tensor };
        let view = self.tensors.tensor(tensor).map_err(|_| layout())?;
        if view.dtype() != T::DTYPE || view.shape().get(1..) != Some(T::SHAPE) {
            return Err(layout());
        }
        if self.hashes.get(&format!("xxh3.{tensor}")) != Some(&hash(view.data())) {
            return Err(Damage::Tensor { tensor });
        }
        Ok(view.data().chunks_exact(size_of::<T>()).map(pod_read_unaligned).collect())
    }
    /// The only row of a tensor.
    pub(crate) fn one<T: Element>(&self, tensor: &'static str) -> Result<T, Damage> {
        match self.rows(tensor)?.as_slice() {
            [one] => Ok(*one),
            _ => Err(Damage::Layout { tensor }),
        }
    }
}
