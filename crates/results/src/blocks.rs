//! What a frame shows: particles, walls, contacts and bonds of a state, as blocks of geometry with fields.

mod bonds;
mod contacts;
mod particles;
mod stress;
mod walls;

pub(crate) use bonds::Link;
pub(crate) use contacts::{Pair, WallSum};
pub(crate) use particles::Start;
pub use stress::mean_stress;

use crate::glossary::{Entry, Kind, Place, Values};
use crate::vtkhdf::array::Array;
use crate::vtkhdf::block::{Block, Field};
use rayon::prelude::*;
use tdem_engine::{Plan, State};

/// What goes into frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contents {
    /// Whether contacts are written as lines between centres.
    pub contacts: bool,
    /// Whether bonds, if there are some, are written as lines between centres.
    pub bonds: bool,
    /// Precision of reals.
    pub precision: Precision,
    /// How hard frames are compressed, 0 (not at all) to 9.
    pub compression: u32,
}

impl Default for Contents {
    fn default() -> Self {
        // Of a million particles, level 4 saves 2 % more space than level 1 and takes three times as long.
        Contents { contacts: false, bonds: true, precision: Precision::Single, compression: 1 }
    }
}

/// Precision of reals in frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 32 bits: what pictures need. `displacement` is computed in 64 bits and shows strains that positions hide.
    Single,
    /// 64 bits.
    Double,
}

/// A state seen under its plan, with the start it came from.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub(crate) state: &'a State,
    pub(crate) plan: &'a Plan,
    pub(crate) start: Option<&'a Start>,
}

impl Scene<'_> {
    /// All blocks, in the order in which frames list them.
    pub(crate) fn blocks(&self, contents: Contents) -> Vec<Block> {
        let mut blocks = vec![self.particles(contents.precision), self.walls(contents.precision)];
        if contents.contacts {
            blocks.push(self.contacts(contents.precision));
        }
        if self.has_bonds() {
            let links = self.links();
            if contents.bonds {
                blocks.push(bonds::lines(&links, contents.precision));
            }
            blocks.push(bonds::cracks(&links, contents.precision));
        }
        blocks
    }
}

impl Precision {
    fn store(self, values: &[f64]) -> Array {
        match self {
            Precision::Single => Array::F32(values.par_iter().map(|&value| value as f32).collect()),
            Precision::Double => Array::F64(values.to_vec()),
        }
    }
}

/// A field as the glossary says it is stored.
fn field(entry: Entry, values: Values<'_>, precision: Precision) -> Field {
    let data = match (values, entry.kind) {
        (Values::Real(values), _) => precision.store(&values),
        (Values::Integer(values), Kind::Id) => Array::I64(values),
        (Values::Integer(values), _) => Array::I32(values.par_iter().map(|&value| value as i32).collect()),
    };
    Field { name: entry.name.into(), components: entry.components, data }
}

/// The entry that documents a field.
pub(crate) fn entry_of(block: &str, field: &str) -> Option<Entry> {
    let place = Place::ALL.into_iter().find(|place| place.name() == block)?;
    place.entries().into_iter().chain(place.with_bonds()).chain(place.with_heat()).find(|entry| entry.name == field)
}
