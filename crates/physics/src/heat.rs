//! Heat: bodies that touch or are bonded conduct it, surfaces give and take it, and what becomes warmer grows.
//!
//! # Conventions
//! | symbol | meaning |
//! |---|---|
//! | $T$ | temperature of a body, K; a body has one |
//! | $\lambda$ | thermal conductivity, W/(m K) |
//! | $c$ | specific heat, J/(kg K) |
//! | $\alpha$ | coefficient of linear thermal expansion, 1/K |
//! | $H$ | conductance between two bodies, W/K |
//! | $Q = H(T_2 - T_1)$ | heat rate **into the first body**, W; the second gets $-Q$ |
//!
//! Every expression is exactly odd or even under exchange of the bodies, as in [`crate::contact`] and [`crate::bond`].
//!
//! * [`conduction`] what goes through a contact or a bond
//! * [`surface`] what goes through the surface of a group: flux, convection, radiation
//! * [`warming`] how temperature and radius follow
//! * [`implicit`] the equation of a body in an implicit step
//! * [`table`] what depends on temperature
//! * [`dissipation`] heat of friction and of dashpots
//! * [`expansion_work`] work that expansion does on springs
//!
//! # References
//! Pacevič & Kačeniauskas (2022), eqs. 4 to 7; Rojek (2014), where the bar between two particles comes from.

pub mod conduction;
pub mod dissipation;
pub mod expansion_work;
pub mod implicit;
pub mod surface;
pub mod table;
pub mod warming;

pub use conduction::{Conductor, Link, Path};
pub use dissipation::Dissipation;
pub use surface::{Exchange, Outside};
