//! Names for numbers: a law called with them prints itself as C.

/// A named number.
#[derive(Clone, Copy, Debug)]
pub struct Symbol(pub(crate) usize);
/// A named comparison.
#[derive(Clone, Copy, Debug)]
pub struct SymbolMask(pub(crate) usize);
