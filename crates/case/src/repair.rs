//! Repairs of a case whose structure is wrong, so that the checks behind it can be made all the same.
//!
//! What is repaired is never run: it only lets the other problems be told together with those of the structure.

use crate::problem::Problem;
use crate::tree::{Key, Node, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// What would mend a place.
#[derive(Clone, Debug)]
pub(crate) enum Repair {
    /// The key and its value go.
    Remove,
    /// The key that was meant.
    Rename(String),
    /// Another value.
    Replace(toml::Value),
    /// A key that is missing in the table.
    Insert(String, toml::Value),
}

/// Repairs by the place of the key, value or table that they are about.
#[derive(Clone, Debug, Default)]
pub(crate) struct Repairs {
    by_place: BTreeMap<(usize, usize), Vec<Repair>>,
    hopeless: bool,
}

impl Repairs {
    pub(crate) fn add(&mut self, span: &Range<usize>, repair: Repair) {
        self.by_place.entry((span.start, span.end)).or_default().push(repair);
    }
    /// Something is wrong that nothing mends.
    pub(crate) fn give_up(&mut self) {
        self.hopeless = true;
    }

    /// The text with all repairs, as TOML; `None` if that makes no sense.
    pub(crate) fn applied(&self, tree: &Node, text: &str) -> Option<toml::Value> {
        if self.hopeless {
            return None;
        }
        let mut value = toml::Value::Table(text.parse::<toml::Table>().ok()?);
        self.mend(tree, &mut value);
        Some(value)
    }

    fn at(&self, span: &Range<usize>) -> &[Repair] {
        self.by_place.get(&(span.start, span.end)).map_or(&[], Vec::as_slice)
    }

    fn mend(&self, node: &Node, value: &mut toml::Value) {
        for repair in self.at(&node.span) {
            match (repair, &mut *value) {
                (Repair::Replace(new), _) => *value = new.clone(),
                (Repair::Insert(key, new), toml::Value::Table(table)) => {
                    table.insert(key.clone(), new.clone());
                }
                _ => {}
            }
        }
        match (&node.value, value) {
            (Value::Table(entries), toml::Value::Table(table)) => {
                // Made anew: to take one of many keys out of a table may take as long as to look at all.
                let known: BTreeMap<&str, (&Key, &Node)> =
                    entries.iter().map(|(key, inner)| (key.name.as_str(), (key, inner))).collect();
                for (name, mut value) in std::mem::take(table) {
                    let Some((key, inner)) = known.get(name.as_str()) else {
                        // Put in for one that is missing, unless a key was meant to be it.
                        table.entry(name).or_insert(value);
                        continue;
                    };
                    self.mend(inner, &mut value);
                    match self.at(&key.span).first() {
                        Some(Repair::Remove) => {}
                        Some(Repair::Rename(new)) => drop(table.insert(new.clone(), value)),
                        _ => drop(table.insert(name, value)),
                    }
                }
            }
            (Value::Array(items), toml::Value::Array(values)) => {
                items.iter().zip(values).for_each(|(item, value)| self.mend(item, value));
            }
            _ => {}
        }
    }

    /// Those of the problems of a repaired case that are not about what was repaired.
    pub(crate) fn not_of_repairs(&self, problems: Vec<Problem>) -> impl Iterator<Item = Problem> {
        let repaired: BTreeSet<(usize, usize)> = self.by_place.keys().copied().collect();
        problems.into_iter().filter(move |problem| {
            !problem.labels.iter().any(|label| repaired.contains(&(label.span.start, label.span.end)))
        })
    }
}
