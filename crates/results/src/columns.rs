//! Named columns of reals in a file, exact to the bit, in the safetensors format: for whoever keeps of a run what its frames
//! do not show. Python reads the file with `safetensors.numpy.load_file`.

use crate::error::Error;
use crate::tensors::{self, Damage, Reader, Tensor};
use std::fs;
use std::path::Path;

const FORMAT: &str = "tdem-columns-1";

/// Writes columns, each of a length of its own, into a file, which then exists whole or not at all.
///
/// # Errors
/// [`Error::DiskFull`] and [`Error::Io`].
pub fn write(path: &Path, columns: &[(&'static str, &[f64])]) -> Result<(), Error> {
    let columns: Vec<Tensor<'_>> = columns.iter().map(|&(name, values)| Tensor::new(name, values)).collect();
    tensors::write(path, FORMAT, &columns)
}

/// Reads some columns of a file and checks their hashes.
///
/// # Errors
/// What is wrong with it; [`Damage::Inaccessible`] if it is not there.
pub fn read<const K: usize>(path: &Path, names: [&'static str; K]) -> Result<[Vec<f64>; K], Damage> {
    let bytes = fs::read(path).map_err(|error| Damage::Inaccessible { kind: error.kind() })?;
    let file = Reader::new(&bytes, FORMAT)?;
    let mut columns = names.map(|_| Vec::new());
    for (column, name) in columns.iter_mut().zip(names) {
        *column = file.rows(name)?;
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_read_as_they_were_written_or_not_at_all() {
        let folder = tempfile::tempdir().expect("there is room for temporary files");
        let path = folder.path().join("columns.safetensors");
        let (long, short) = ([0.1, -0.0, f64::MIN_POSITIVE], [f64::INFINITY]);
        write(&path, &[("long", &long), ("short", &short), ("none", &[])]).expect("the disk has room");
        let [none, again, first] = read(&path, ["none", "short", "long"]).expect("the file is whole");
        assert_eq!((none.len(), again), (0, short.to_vec()));
        assert_eq!(first.iter().map(|value| value.to_bits()).collect::<Vec<_>>(), long.map(f64::to_bits));
        assert_eq!(read(&path, ["other"]), Err(Damage::Layout { tensor: "other" }));
        let mut bytes = fs::read(&path).expect("the file is there");
        *bytes.last_mut().expect("the file is not empty") ^= 1;
        fs::write(&path, bytes).expect("the disk has room");
        assert_eq!(read(&path, ["short"]), Err(Damage::Tensor { tensor: "short" }));
        assert!(matches!(read(&folder.path().join("none"), ["long"]), Err(Damage::Inaccessible { .. })));
    }
}
