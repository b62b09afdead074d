//! What commands tell programs: one JSON object on standard output, see docs/json.md. Everything else goes to standard error.

use crate::console::data;
use crate::render::Reports;
use clap::Args;
use serde_json::{Map, Value, json};
use std::time::Duration;
use tdem_engine::Ledger;

/// The switch that commands share.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Json {
    /// Print one JSON object instead of text; messages go to standard error (docs/json.md)
    #[arg(long)]
    pub(crate) json: bool,
}

/// Prints the object of a command, which begins with the version of the program and the command.
pub(crate) fn print(command: &str, told: Value) -> Result<(), Reports> {
    let mut object = Map::new();
    object.insert("tdem".to_owned(), env!("TDEM_VERSION").into());
    object.insert("command".to_owned(), command.into());
    if let Value::Object(told) = told {
        object.extend(told);
    }
    data(format_args!("{:#}", Value::Object(object)))
}

/// Prints why a command failed.
pub(crate) fn fail(command: &str, reports: &Reports) -> Result<(), Reports> {
    print(command, json!({ "ok": false, "problems": reports.json() }))
}

/// A hash as it is shown elsewhere.
pub(crate) fn hash(hash: u128) -> Value {
    format!("{hash:032x}").into()
}

/// Seconds on the clock.
pub(crate) fn seconds(time: Duration) -> Value {
    time.as_secs_f64().into()
}

/// Energies and measures, by the names of the columns of `history.csv`.
pub(crate) fn ledger(ledger: &Ledger) -> Value {
    json!({
        "kinetic_translation": ledger.kinetic_translation,
        "kinetic_rotation": ledger.kinetic_rotation,
        "elastic_normal": ledger.elastic_normal,
        "elastic_tangential": ledger.elastic_tangential,
        "elastic_bonds": ledger.elastic_bonds,
        "gravitational": ledger.gravitational,
        "friction_dissipated": ledger.friction_dissipated,
        "damping_dissipated": ledger.damping_dissipated,
        "breakage_dissipated": ledger.breakage_dissipated,
        "stiffening_work": ledger.stiffening_work,
        "external_work": ledger.external_work,
        "expansion_work": ledger.expansion_work,
        "energy_error": ledger.energy_error,
        "contacts": ledger.contacts,
        "wall_contacts": ledger.wall_contacts,
        "bonds": ledger.bonds,
        "broken_bonds": ledger.broken_bonds,
        "largest_speed": ledger.largest_speed,
        "largest_overlap": ledger.largest_overlap,
        "unbalanced_force_ratio": ledger.unbalanced_force_ratio,
    })
}
