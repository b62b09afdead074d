//! Flaws of a state: what it cannot be under any plan. A state that was read from a file is looked at before it is used.

use super::State;
use crate::Bond;
use rayon::prelude::*;
use thiserror::Error;

/// Largest size of a real number. Squares of such numbers, and products of three, are finite.
const LARGEST: f64 = 1e100;
/// Smallest size of what must be above zero: volumes of such radii are above zero, too.
const SMALLEST: f64 = 1e-100;
/// Deviation of a quaternion's norm from 1 that rounding never reaches.
const UNIT: f64 = 1e-3;

/// A field of a state that cannot be.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum Flaw {
    /// Fields differ in length.
    #[error("`{field}` has {rows} rows where {expected} belong")]
    Length {
        /// Name of the field.
        field: &'static str,
        /// Its rows.
        rows: usize,
        /// Rows that the state needs.
        expected: usize,
    },
    /// A row cannot be.
    #[error("row {row} of `{field}` {wrong}")]
    Row {
        /// Name of the field.
        field: &'static str,
        /// Number of the row, from 0.
        row: usize,
        /// What is wrong with it.
        wrong: Wrong,
    },
}

/// What is wrong with a row.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum Wrong {
    /// Not a number, infinite, or beyond all that can be computed with.
    #[error("is not a number below 1e100")]
    NotFinite,
    /// Zero, less, or too little to be computed with.
    #[error("is not above 1e-100")]
    NotPositive,
    /// A quaternion that is no rotation.
    #[error("is not a unit quaternion")]
    NotUnit,
    /// Out of order.
    #[error("does not ascend")]
    Order,
    /// The number that stands for no particle.
    #[error("is no id")]
    NoId,
    /// A particle, a wall or a step that does not exist.
    #[error("names something that does not exist")]
    Unknown,
}

impl State {
    /// Looks for what a state cannot be, whatever its plan: lengths that differ, numbers that are none, ids that do not
    /// exist. Fields have the names that they have in a checkpoint.
    ///
    /// # Errors
    /// The first that is found.
    pub fn look_for_flaws(&self) -> Result<(), Flaw> {
        self.check_lengths()?;
        self.check_reals()?;
        self.check_ids()
    }

    fn check_lengths(&self) -> Result<(), Flaw> {
        let n = self.len();
        for (field, rows) in [
            ("material", self.material.len()),
            ("constraint", self.constraint.len()),
            ("radius", self.radius.len()),
            ("mass", self.mass.len()),
            ("position", self.position.len()),
            ("image", self.image.len()),
            ("velocity", self.velocity.len()),
            ("angular_velocity", self.angular_velocity.len()),
            ("force", self.force.len()),
            ("moment", self.moment.len()),
        ] {
            length(field, rows, n)?;
        }
        for (field, rows) in [("orientation", self.orientation.len()), ("bonded_position", self.bonded_position.len())]
        {
            // Where the last bond was taken away they may have stayed.
            length(field, rows, if rows == 0 && self.bonds.is_empty() { 0 } else { n })?;
        }
        let heated = self.temperature.len();
        for (field, rows, whole) in [
            ("derivatives", self.derivatives.len(), n),
            ("accounts", self.accounts.len(), n),
            ("bonds.history", self.bond_histories.len(), self.bonds.len()),
            ("temperature", heated, n),
            ("reference_radius", self.reference_radius.len(), heated),
            ("heat_accounts", self.heat_accounts.len(), heated),
            ("work_per_kelvin", self.work_per_kelvin.len(), heated),
        ] {
            // These are there for all or for none.
            length(field, rows, if rows == 0 { 0 } else { whole })?;
        }
        length("heat_rate", self.heat_rate.len(), heated)?;
        length("exposure", self.exposure.len(), heated)
    }

    fn check_reals(&self) -> Result<(), Flaw> {
        finite("initial_energy", &[self.initial_energy])?;
        finite("initial_heat", &[self.initial_heat])?;
        for (field, values) in [
            ("radius", &self.radius),
            ("mass", &self.mass),
            ("temperature", &self.temperature),
            ("reference_radius", &self.reference_radius),
        ] {
            finite(field, values)?;
            every(field, values, Wrong::NotPositive, |&value| value >= SMALLEST)?;
        }
        finite("heat_rate", &self.heat_rate)?;
        finite("work_per_kelvin", &self.work_per_kelvin)?;
        for (field, rows) in [
            ("position", &self.position),
            ("velocity", &self.velocity),
            ("angular_velocity", &self.angular_velocity),
            ("force", &self.force),
            ("moment", &self.moment),
            ("bonded_position", &self.bonded_position),
            ("wall_position", &self.wall_position),
        ] {
            every(field, rows, Wrong::NotFinite, |row| row.iter().all(is_finite))?;
        }
        for (field, rows) in
            [("accounts", &self.accounts), ("heat_accounts", &self.heat_accounts), ("orientation", &self.orientation)]
        {
            every(field, rows, Wrong::NotFinite, |row| row.iter().all(is_finite))?;
        }
        every("orientation", &self.orientation, Wrong::NotUnit, |turn| {
            (turn.iter().map(|part| part * part).sum::<f64>() - 1.0).abs() <= UNIT
        })?;
        every("derivatives", &self.derivatives, Wrong::NotFinite, |row| row.iter().flatten().all(is_finite))?;
        every("bonds.history", &self.bond_histories, Wrong::NotFinite, |row| row.numbers().all(|x| is_finite(&x)))?;
        every("contacts.displacement", &self.contacts, Wrong::NotFinite, |c| c.displacement.iter().all(is_finite))?;
        every("wall_contacts.displacement", &self.wall_contacts, Wrong::NotFinite, |c| {
            c.displacement.iter().all(is_finite)
        })?;
        every("bonds.strength", &self.bonds, Wrong::NotFinite, |bond| is_finite(&bond.strength))?;
        every("bonds.strength", &self.bonds, Wrong::NotPositive, |bond| bond.strength >= SMALLEST)?;
        every("bonds.energy", &self.bonds, Wrong::NotFinite, |bond| bond.breakage.is_none_or(|b| is_finite(&b.energy)))
    }

    fn check_ids(&self) -> Result<(), Flaw> {
        let exists = |id: u32| self.index_of(id).is_some();
        ascending("id", &self.id, |&id| id)?;
        every("id", &self.id, Wrong::NoId, |&id| id < u32::MAX)?;
        ascending("contacts.pair", &self.contacts, |contact| (contact.first, contact.second))?;
        every("contacts.pair", &self.contacts, Wrong::Order, |contact| contact.first < contact.second)?;
        every("contacts.pair", &self.contacts, Wrong::Unknown, |c| exists(c.first) && exists(c.second))?;
        ascending("wall_contacts.pair", &self.wall_contacts, |contact| (contact.particle, contact.wall))?;
        every("wall_contacts.pair", &self.wall_contacts, Wrong::Unknown, |contact| {
            exists(contact.particle) && (contact.wall as usize) < self.wall_position.len()
        })?;
        ascending("bonds.pair", &self.bonds, |bond| (bond.first, bond.second))?;
        every("bonds.pair", &self.bonds, Wrong::Order, |bond| bond.first < bond.second)?;
        every("bonds.pair", &self.bonds, Wrong::Unknown, |bond: &Bond| exists(bond.first) && exists(bond.second))?;
        every("bonds.broken_at", &self.bonds, Wrong::Unknown, |bond| bond.breakage.is_none_or(|b| b.step <= self.step))
    }
}

fn length(field: &'static str, rows: usize, expected: usize) -> Result<(), Flaw> {
    if rows == expected { Ok(()) } else { Err(Flaw::Length { field, rows, expected }) }
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "closures over rows hand out references")]
fn is_finite(value: &f64) -> bool {
    value.abs() <= LARGEST
}

fn finite(field: &'static str, values: &[f64]) -> Result<(), Flaw> {
    every(field, values, Wrong::NotFinite, is_finite)
}

/// That all rows are sound; the first that is not is told.
fn every<T: Sync>(
    field: &'static str,
    rows: &[T],
    wrong: Wrong,
    is_sound: impl Fn(&T) -> bool + Sync + Send,
) -> Result<(), Flaw> {
    let found = rows.par_iter().position_first(|row| !is_sound(row));
    found.map_or(Ok(()), |row| Err(Flaw::Row { field, row, wrong }))
}

/// That rows ascend strictly.
fn ascending<T: Sync, K: Ord>(
    field: &'static str,
    rows: &[T],
    key: impl Fn(&T) -> K + Sync + Send,
) -> Result<(), Flaw> {
    let found = rows.par_windows(2).position_first(|pair| key(&pair[0]) >= key(&pair[1]));
    found.map_or(Ok(()), |row| Err(Flaw::Row { field, row: row + 1, wrong: Wrong::Order }))
}
