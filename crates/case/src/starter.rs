//! The case that `tdem new` writes.

/// A small, complete, commented case with a name of its own: a few hundred spheres fall into a box.
#[must_use]
pub fn starter(name: &str) -> String {
    let title = toml_edit::Value::from(name).to_string();
    include_str!("starter.toml").replacen("\"TITLE\"", &title, 1)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    #[test]
    fn the_starter_runs_whatever_its_name() {
        for name in ["silo", "it's \"quoted\" \\ strange"] {
            let loaded = crate::parse("new.toml", &super::starter(name), Path::new(""), &[]).unwrap();
            assert_eq!(loaded.case.title, name);
            let built = loaded.build().unwrap();
            assert!(built.warnings.problems.is_empty(), "{}", built.warnings);
        }
    }
}
