//! Studies made with `tdem`: simulations that answer a question rather than fill a directory.
//!
//! * [`mod@bench`] how fast is it, as data
//! * [`statics`] where bonded particles come to rest under loads, without time
//! * [`verify`] does the engine compute what it should? Comparison with closed forms and published values

pub mod bench;
pub mod statics;
pub mod verify;
