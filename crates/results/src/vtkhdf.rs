//! VTKHDF files that survive a process being killed at any moment, and that ParaView opens.
//!
//! A growing HDF5 file is damaged when its writer dies. So every instant has a file of its own, written once
//! ([`frame`]), and a small *master* per block presents the frames as one series in time ([`master`]): its large
//! arrays are HDF5 virtual datasets, rows that stay in the frames. A master is never changed, it is replaced.
//!
//! There is one master per block, because VTK's reader (up to 9.7) returns the first instant for every time of a
//! series that holds several blocks.

pub(crate) mod about;
pub(crate) mod array;
pub(crate) mod block;
pub(crate) mod frame;
pub(crate) mod hdf5;
pub(crate) mod master;

pub use about::Names;
pub use hdf5::FormatError;
