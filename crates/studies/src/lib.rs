//! Studies made with `tdem`: simulations that answer a question rather than fill a directory.
//!
//! * [`mod@bench`] how fast is it, as data
//! * [`verify`] does the engine compute what it should? Comparison with closed forms and published values

pub mod bench;
pub mod verify;
