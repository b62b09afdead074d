//! The cases that `tdem new` writes.

/// What a starter case is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Starter {
    /// Spheres that fall into a box.
    Packing,
    /// A bonded cube that is heated from above and cracks.
    Heating,
    /// A bonded bar that is pulled until it breaks.
    Bonded,
    /// A hot ceramic disc that is quenched at its rim.
    Quench,
}

/// Name of the file of the JSON schema that starters point to, beside them.
pub const SCHEMA_FILE: &str = "case.schema.json";

impl Starter {
    /// All of them.
    pub const ALL: [Starter; 4] = [Starter::Packing, Starter::Heating, Starter::Bonded, Starter::Quench];

    /// Its name on the command line, and what it is about.
    #[must_use]
    pub const fn told(self) -> (&'static str, &'static str) {
        match self {
            Starter::Packing => ("packing", "spheres that fall into a box"),
            Starter::Heating => ("heating", "a bonded cube that is heated from above and cracks"),
            Starter::Bonded => ("bonded", "a bonded bar that is pulled until it breaks"),
            Starter::Quench => ("quench", "a hot ceramic disc that is quenched at its rim"),
        }
    }

    fn text(self) -> &'static str {
        match self {
            Starter::Packing => include_str!("starter/packing.toml"),
            Starter::Heating => include_str!("starter/heating.toml"),
            Starter::Bonded => include_str!("starter/bonded.toml"),
            Starter::Quench => include_str!("starter/quench.toml"),
        }
    }
}

/// A small, complete, commented case with a name of its own.
#[must_use]
pub fn starter(of: Starter, name: &str) -> String {
    let title = toml_edit::Value::from(name).to_string();
    let text = of.text().replacen("\"TITLE\"", &title, 1);
    format!("#:schema ./{SCHEMA_FILE}\n{text}")
}

#[cfg(test)]
mod tests {
    use super::{Starter, starter};
    use std::path::Path;

    #[test]
    fn starters_run_whatever_their_names() {
        for of in Starter::ALL {
            for name in ["silo", "it's \"quoted\" \\ strange"] {
                let loaded = crate::parse("new.toml", &starter(of, name), Path::new(""), &[]).unwrap();
                assert_eq!(loaded.case.title, name);
                let built = loaded.build().unwrap();
                assert!(built.warnings.problems.is_empty(), "{}", built.warnings);
            }
        }
    }

    #[test]
    fn the_quench_that_is_shipped_is_the_one_to_start_from() {
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/quench.toml");
        let shipped = std::fs::read_to_string(shipped).unwrap();
        let own = starter(Starter::Quench, "Quench of a ceramic disc");
        assert_eq!(shipped.replace("#:schema ../docs/case", "#:schema ./case"), own);
    }
}
