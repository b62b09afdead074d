//! How bonds depend on temperature.

use super::super::Context;
use super::Given;
use crate::schema::{Joint, Property};
use tdem_engine::{BondTables, Table};

/// Factors on the numbers of bonds of all pairs of materials; none where no [[bond]] says anything.
pub(super) fn of(context: &Context<'_>, given: &Given) -> BondTables {
    let case = &context.loaded.case;
    let zero = case.heat.as_ref().map_or(0.0, |heat| heat.scale.zero());
    let factors = |of: fn(&Joint) -> &Option<Property>| -> Vec<Table> {
        let tables: Vec<Table> = (case.bond.iter())
            .map(|joint| of(joint).as_ref().map_or(Table::constant(1.0), |property| property.table(zero)))
            .collect();
        if tables.iter().all(|table| table.least() == 1.0 && table.largest() == 1.0) {
            return Vec::new();
        }
        let of_pair = |entry: &Option<usize>| entry.map_or(Table::constant(1.0), |entry| tables[entry].clone());
        given.entries.iter().map(of_pair).collect()
    };
    BondTables {
        stiffness: factors(|joint| &joint.stiffness_over_temperature),
        strength: factors(|joint| &joint.strength_over_temperature),
    }
}
