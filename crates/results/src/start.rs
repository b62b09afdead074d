//! `start.safetensors`: where particles were when the run began. Displacements count from there, whatever becomes of the first
//! checkpoint.

use crate::error::Error;
use crate::tensors::{self, Damage, Reader, Tensor};
use std::fs;
use std::path::{Path, PathBuf};
use tdem_engine::{Flaw, State, Wrong};

/// Name of the file in a run.
pub(crate) const FILE: &str = "start.safetensors";
const FORMAT: &str = "tdem-start-1";

/// The file of a run.
pub(crate) fn path_of(run: &Path) -> PathBuf {
    run.join(FILE)
}

/// Writes where the particles of a state are.
pub(crate) fn write(run: &Path, state: &State) -> Result<(), Error> {
    let tensors =
        [Tensor::new("position", &state.position), Tensor::new("image", &state.image), Tensor::new("id", &state.id)];
    tensors::write(&path_of(run), FORMAT, &tensors)
}

/// Reads it back, as a state that has nothing else.
pub(crate) fn read(run: &Path) -> Result<State, Damage> {
    let bytes = fs::read(path_of(run)).map_err(|error| Damage::Inaccessible { kind: error.kind() })?;
    let file = Reader::new(&bytes, FORMAT)?;
    let state = State {
        id: file.rows("id")?,
        position: file.rows("position")?,
        image: file.rows("image")?,
        ..State::default()
    };
    for (field, rows) in [("position", state.position.len()), ("image", state.image.len())] {
        if rows != state.len() {
            return Err(Flaw::Length { field, rows, expected: state.len() }.into());
        }
    }
    if let Some(row) = state.position.iter().position(|row| !row.iter().all(|x| x.is_finite())) {
        return Err(Flaw::Row { field: "position", row, wrong: Wrong::NotFinite }.into());
    }
    if state.id.is_sorted_by(|a, b| a < b) { Ok(state) } else { Err(Damage::Layout { tensor: "id" }) }
}
