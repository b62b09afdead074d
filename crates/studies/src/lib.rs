//! Studies made with `tdem`: simulations that answer a question rather than fill a directory.
//!
//! * [`mod@bench`] how fast is it, as data
//! * [`mod@calibrate`] which bonds give a packing the values of a solid
//! * [`mod@ladder`] what it costs to let heat go faster than motion
//! * [`paper_figures`] the paper's performance analysis, made here and set beside what it prints
//! * [`slab`] how warm a slab becomes that is heated from one side, exactly
//! * [`statics`] where bonded particles come to rest under loads, without time
//! * [`uniaxial`] how stiff and how strong a bonded assembly is between two grips
//! * [`verify`] does the engine compute what it should? Comparison with closed forms and published values

pub mod bench;
pub mod calibrate;
pub mod ladder;
pub mod paper_figures;
pub mod slab;
pub mod statics;
pub mod uniaxial;
pub mod verify;
