//! The laws of `tdem`, each written once as a function generic over [`Real`].
//!
//! The CPU calls a law with `f64`, or with eight lanes at a time ([`real::Lanes`]); a GPU compiles the C that the same
//! function prints when it is called with [`real::Symbol`]. All three give the same bits, because a law can only use
//! what IEEE 754 rounds the same way everywhere (see [`Real`]).
//!
//! * [`contact`] two bodies that touch: normal force, damping, friction with history, moments
//! * [`bond`] two bodies that are bonded: beams that stretch, shear, twist, bend and break
//! * [`heat`] bodies that conduct heat, exchange it with their surroundings, and grow
//! * [`motion`] how a particle moves under a force: velocity Verlet, Gear, orientations
//! * [`stability`] how large a time step may be
//! * [`print`](mod@print) all of these as C
//! * [`material`] effective values of a pair of materials
//!
//! SI units throughout. The conventions (normal from the first body to the second, overlap positive in contact, tension
//! positive in a bond, force on the first body) are stated in [`contact`] and [`bond`].

pub mod bond;
pub mod contact;
pub mod heat;
pub mod material;
pub mod motion;
pub mod print;
pub mod real;
pub mod stability;
mod vec3;

pub use real::Real;
pub use vec3::{Vec3, vec3};
