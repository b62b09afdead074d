//! The engine of `tdem`: what a simulation is, and how it advances.
//!
//! * [`State`] all that is needed to go on, in the order of persistent ids
//! * [`Plan`] what stays the same during a run: laws, walls, boundary conditions, step
//! * [`Simulation`] a state advanced by a back end under a plan
//! * [`Ledger`] where the energy is and where it went
//! * [`ExactSum`] a sum that knows no order
//! * [`Gauge`] force on a group of particles, how far it went
//! * [`Profile`] where the time of a step goes
//! * [`Schedule`] when a run ends and when its state is wanted
//! * [`Motion`] what particles do while heat goes on
//!
//! The engine does no input or output, and no clock is looked at but for a [`Profile`] and for what a
//! device can do at most ([`Device::arithmetic_rate`]). One step is `step.rs`; its stages have the same names as the files of the
//! back ends, [`cpu`] and [`gpu`].

mod arithmetic;
mod bond;
mod capture;
pub mod cpu;
mod device;
mod evaluate;
mod exact;
mod fault;
mod gauge;
pub mod gpu;
mod heat;
mod ledger;
mod motion;
mod network;
mod plan;
mod profile;
mod schedule;
mod simulation;
mod staggered;
mod state;
mod step;
mod table;

pub use bond::{Bond, BondHistory, BondPlan, BondTables, Breakage};
pub use capture::Capture;
pub use device::Device;
pub use evaluate::{Evaluated, EvaluatedBond};
pub use exact::{ExactSum, exact_sums};
pub use fault::Fault;
pub use gauge::{Gauge, Group, Measure, Part as SurfacePart, Reading, Surface};
pub use heat::{Around, Course, Exposure, HeatPlan, Thermal, ThermalTables, heat_accounts};
pub use ledger::{HeatLedger, Ledger};
pub use motion::{Motion, Relaxation, Scheme};
pub use plan::{Constraint, Domain, Driven, Integrator, Plan, Ramp, Search, Wall};
pub use profile::{Part, Profile, STAGES};
pub use schedule::Schedule;
pub use simulation::Simulation;
pub use staggered::Turns;
pub use state::{Contact, Flaw, State, WallContact, Wrong, energy_accounts};
pub use table::Table;
pub use tdem_physics as physics;
