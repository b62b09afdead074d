//! Studies made with `tdem`: simulations that answer a question rather than fill a directory.
//!
//! * [`verify`] does the engine compute what it should? Comparison with closed forms and published values

pub mod verify;
