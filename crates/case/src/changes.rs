//! What two cases say differently.

use crate::load::Loaded;
use std::collections::BTreeMap;
use toml::Value;

/// A key to which two cases give other values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// The keys that lead to it, with dots between them; entries of lists are counted from 0.
    pub key: String,
    /// What the older case says, if it has the key.
    pub old: Option<String>,
    /// What the newer one says.
    pub new: Option<String>,
}

impl Loaded {
    /// What this case says otherwise than an older one, in the order of keys. Comments, the order of keys, defaults that are
    /// written out and the way in which numbers are written are no change.
    #[must_use]
    pub fn changes_since(&self, older: &Loaded) -> Vec<Change> {
        let (mut old, new) = (older.values(), self.values());
        let mut changes = Vec::new();
        for (key, new) in new {
            let old = old.remove(&key);
            if old.as_ref() != Some(&new) {
                changes.push(Change { key: spelled(&key), old, new: Some(new) });
            }
        }
        changes.extend(old.into_iter().map(|(key, old)| Change { key: spelled(&key), old: Some(old), new: None }));
        changes.sort_by(|a, b| a.key.cmp(&b.key));
        changes
    }

    /// All values of the case with every default, by the keys and places that lead to them.
    fn values(&self) -> BTreeMap<Vec<Step>, String> {
        let mut values = BTreeMap::new();
        // All types serialise, as `effective_toml` counts on, too.
        if let Ok(value) = Value::try_from(self.whole()) {
            collect(&value, &mut Vec::new(), &mut values);
        }
        values
    }
}

/// A step of the way to a value.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Step {
    Key(String),
    Entry(usize),
}

fn spelled(way: &[Step]) -> String {
    let steps = way.iter().map(|step| match step {
        Step::Key(key) => key.clone(),
        Step::Entry(entry) => entry.to_string(),
    });
    steps.collect::<Vec<_>>().join(".")
}

fn collect(value: &Value, way: &mut Vec<Step>, values: &mut BTreeMap<Vec<Step>, String>) {
    let mut below = |step: Step, value: &Value| {
        way.push(step);
        collect(value, way, values);
        way.pop();
    };
    match value {
        Value::Table(table) if !table.is_empty() => {
            table.iter().for_each(|(key, value)| below(Step::Key(key.clone()), value));
        }
        Value::Array(entries) if !entries.is_empty() => {
            entries.iter().enumerate().for_each(|(entry, value)| below(Step::Entry(entry), value));
        }
        value => {
            values.insert(way.clone(), value.to_string());
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    const CASE: &str = "model = 'GN'\ngravity = [0.0, 0.0, -9.81]\n[time]\nstep = 1e-5\nend = 1.0\n[domain]\nmin = [0.0, 0.0, 0.0]\n\
                        max = [1.0, 1.0, 1.0]\n[material.a]\ndensity = 1000.0\nyoung_modulus = 1e6\npoisson_ratio = 0.3\n\
                        [[interaction]]\nbetween = ['a', 'a']\nnormal_damping = 10.0\n[[particles]]\nmaterial = 'a'\n\
                        list = { positions = [[0.5, 0.5, 0.5], [0.7, 0.5, 0.5]], radius = 0.05 }\n";

    fn changes(replaced: &[(&str, &str)]) -> Vec<(String, Option<String>, Option<String>)> {
        let load = |text: &str| crate::parse("a.toml", text, Path::new("/runs"), &[]).unwrap_or_else(|p| panic!("{p}"));
        let edited = replaced.iter().fold(CASE.to_owned(), |text, (old, new)| {
            assert!(text.contains(old), "{old}");
            text.replace(old, new)
        });
        let changes = load(&edited).changes_since(&load(CASE));
        changes.into_iter().map(|change| (change.key, change.old, change.new)).collect()
    }

    #[test]
    fn words_that_mean_the_same_are_no_change() {
        let same = [
            ("model = 'GN'\n", "# a remark\nmodel = \"GN\"\n\n"),
            ("step = 1e-5\nend = 1.0\n", "end = 1.0 # s\nstep = 0.00001\nintegrator = \"velocity-verlet\"\n"),
            ("0.0, -9.81", "0, -9.810"),
        ];
        assert_eq!(changes(&same), []);
    }

    #[test]
    fn what_was_changed_added_and_removed_is_named() {
        let some = |text: &str| Some(text.to_owned());
        let found = changes(&[
            ("end = 1.0", "end = 2.0"),
            ("[0.7, 0.5, 0.5]", "[0.7, 0.55, 0.5]"),
            ("model", "title = 'x'\nmodel"),
        ]);
        let expected = [
            ("particles.0.list.positions.1.1".to_owned(), some("0.5"), some("0.55")),
            ("time.end".to_owned(), some("1.0"), some("2.0")),
            ("title".to_owned(), None, some("\"x\"")),
        ];
        assert_eq!(found, expected);
        let fewer = changes(&[("[[0.5, 0.5, 0.5], [0.7, 0.5, 0.5]]", "[[0.5, 0.5, 0.5]]")]);
        assert_eq!(fewer.len(), 3);
        assert!(
            fewer.iter().all(|(key, old, new)| key.starts_with("particles.0.list.positions.1.")
                && old.is_some()
                && new.is_none())
        );
    }
}
