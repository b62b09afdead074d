//! Presets and `--set`: changes to the text of a case before it is read, so that every message can show its line.

use crate::codes;
use crate::problem::Problem;
use crate::structure::suggestion;
use crate::tree::Node;
use toml_edit::{Array, DocumentMut, Item, TableLike, Value};

/// Applies the preset that `size` chooses, then every `key.path=value`. Returns the effective text.
pub(crate) fn apply(text: &str, overrides: &[(String, String)]) -> Result<String, Vec<Problem>> {
    // A text that is not TOML is reported by the parser that knows all errors.
    let Ok(mut document) = text.parse::<DocumentMut>() else { return Ok(text.to_owned()) };
    let mut problems = Vec::new();
    let chooses = |path: &str| path == "size" || path.starts_with("sizes.");
    // What chooses or defines presets goes first, so that all other overrides win over the preset.
    for (path, value) in overrides.iter().filter(|(path, _)| chooses(path)) {
        set(&mut document, path, value, &mut problems);
    }
    preset(&mut document, text, &mut problems);
    for (path, value) in overrides.iter().filter(|(path, _)| !chooses(path)) {
        set(&mut document, path, value, &mut problems);
    }
    if problems.is_empty() { Ok(document.to_string()) } else { Err(problems) }
}

/// A span for each problem is impossible here: the text it would point into is the command line.
fn refused(path: &str, value: &str, why: &str) -> Problem {
    Problem::new(codes::BAD_OVERRIDE, format!("--set {path}={value}: {why}"))
}

fn preset(document: &mut DocumentMut, text: &str, problems: &mut Vec<Problem>) {
    let Some(size) = document.get("size").and_then(Item::as_str).map(str::to_owned) else { return };
    let names: Vec<String> = document
        .get("sizes")
        .and_then(Item::as_table_like)
        .map_or(Vec::new(), |sizes| sizes.iter().map(|(name, _)| name.to_owned()).collect());
    let overlay = document.get("sizes").and_then(|sizes| sizes.get(&size)).cloned();
    let Some(overlay) = overlay.as_ref().and_then(Item::as_table_like) else {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let help = if names.is_empty() { "the case defines no [sizes]".to_owned() } else { suggestion(&size, &names) };
        let problem = Problem::new(codes::UNKNOWN_SIZE, format!("there is no preset `{size}`")).help(help);
        // The presets are shown where the choice itself came from the command line.
        let tree = Node::parse(text).ok();
        let place = tree.and_then(|tree| tree.get(&["size"]).or(tree.get(&["sizes"])).map(|node| node.span.clone()));
        problems.push(match place {
            Some(place) => problem.at(place, format!("`{size}` is not among the presets")),
            None => problem,
        });
        return;
    };
    merge(document.as_table_mut(), overlay);
}

/// Tables are merged key by key; anything else replaces what was there.
fn merge(base: &mut dyn TableLike, overlay: &dyn TableLike) {
    for (key, item) in overlay.iter() {
        if let (Some(below), Some(above)) = (base.get_mut(key).and_then(Item::as_table_like_mut), item.as_table_like())
        {
            merge(below, above);
            continue;
        }
        let mut item = item.clone();
        if let Some(value) = item.as_value_mut() {
            value.decor_mut().clear();
        }
        base.insert(key, item);
    }
}

fn set(document: &mut DocumentMut, path: &str, value: &str, problems: &mut Vec<Problem>) {
    let steps: Vec<&str> = path.split('.').collect();
    if steps.iter().any(|step| step.trim().is_empty()) {
        problems.push(refused(path, value, "a path is keys with dots between them, such as time.step"));
        return;
    }
    // Words may stand without quotes, as a shell takes them away; names of presets may look like numbers.
    let parsed = match value.parse::<Value>() {
        Ok(parsed) if path != "size" || parsed.is_str() => parsed,
        _ if value.contains(['"', '\'', '[', '{', '=', '\n']) => {
            problems.push(refused(path, value, "the value is neither a number, a word, an array nor a table"));
            return;
        }
        _ => Value::from(value),
    };
    let Some((last, parents)) = steps.split_last() else { return };
    let mut place = Place::Table(document.as_table_mut());
    for (depth, step) in steps.iter().enumerate() {
        if step.parse::<usize>().is_err()
            && let Some(entries) = place.entries()
        {
            let (list, rest) = (steps[..depth].join("."), steps[depth..].join("."));
            problems.push(refused(path, value, &of_a_list(&list, &rest, value, &entries)));
            return;
        }
        if depth == parents.len() {
            break;
        }
        match place.enter(step) {
            Ok(next) => place = next,
            Err(why) => {
                problems.push(refused(path, value, &why));
                return;
            }
        }
    }
    if let Err(why) = place.put(last, parsed) {
        problems.push(refused(path, value, &why));
    }
}

/// Where a path has led so far.
enum Place<'d> {
    Table(&'d mut dyn TableLike),
    Tables(&'d mut toml_edit::ArrayOfTables),
    Array(&'d mut Array),
}

impl<'d> Place<'d> {
    fn of(item: &'d mut Item, step: &str) -> Result<Place<'d>, String> {
        match item {
            Item::ArrayOfTables(tables) => Ok(Place::Tables(tables)),
            Item::Value(Value::Array(array)) => Ok(Place::Array(array)),
            other => other.as_table_like_mut().map(Place::Table).ok_or(format!("`{step}` is not a table")),
        }
    }

    /// What distinguishes the entries of a list; `None` for a table.
    fn entries(&self) -> Option<Vec<String>> {
        let told = |table: &dyn TableLike| {
            let of =
                |key: &str| table.get(key).and_then(Item::as_value).map(|value| value.to_string().trim().to_owned());
            of("name").or(of("between")).or(of("material")).unwrap_or_default()
        };
        match self {
            Place::Table(_) => None,
            Place::Tables(tables) => Some(tables.iter().map(|table| told(table)).collect()),
            Place::Array(array) => Some(
                array.iter().map(|value| value.as_inline_table().map_or(String::new(), |table| told(table))).collect(),
            ),
        }
    }

    fn enter(self, step: &str) -> Result<Place<'d>, String> {
        match self {
            Place::Table(table) => {
                let inline = toml_edit::table();
                Place::of(table.entry(step).or_insert(inline), step)
            }
            Place::Tables(tables) => {
                let index = index(step, tables.len())?;
                tables.get_mut(index).map(|table| Place::Table(table)).ok_or_else(|| no_entry(step, index))
            }
            Place::Array(array) => {
                let index = index(step, array.len())?;
                match array.get_mut(index) {
                    Some(Value::InlineTable(table)) => Ok(Place::Table(table)),
                    Some(Value::Array(inner)) => Ok(Place::Array(inner)),
                    _ => Err(format!("`{step}` is neither a table nor an array")),
                }
            }
        }
    }

    fn put(self, key: &str, value: Value) -> Result<(), String> {
        match self {
            Place::Table(table) => {
                table.insert(key, Item::Value(value));
                Ok(())
            }
            Place::Array(array) => {
                let index = index(key, array.len())?;
                array.replace(index, value);
                Ok(())
            }
            Place::Tables(_) => Err(format!("`{key}` would replace a whole table; name a key in it")),
        }
    }
}

/// What to write for an entry of a list, and which entries there are.
fn of_a_list(list: &str, rest: &str, value: &str, entries: &[String]) -> String {
    const SHOWN: usize = 8;
    let known: Vec<String> = (entries.iter().enumerate().take(SHOWN))
        .filter(|(_, name)| !name.is_empty())
        .map(|(k, name)| format!("{k} is {name}"))
        .collect();
    let known = if known.is_empty() { String::new() } else { format!(" ({})", known.join(", ")) };
    format!(
        "`{list}` is a list of {}, counted from 0{known}: name one of them, such as --set {list}.0.{rest}={value}",
        if entries.len() == 1 { "1 entry".to_owned() } else { format!("{} entries", entries.len()) }
    )
}

fn index(step: &str, length: usize) -> Result<usize, String> {
    match step.parse::<usize>() {
        Ok(index) if index < length => Ok(index),
        Ok(index) => Err(no_entry(step, index) + &format!("; there are {length}, counted from 0")),
        Err(_) => Err(format!("`{step}` must be the number of an entry, counted from 0")),
    }
}

fn no_entry(step: &str, index: usize) -> String {
    format!("`{step}`: there is no entry {index}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const CASE: &str = "size = 'small'\n[time]\nend = 1 # s\nstep = 2\n[[particles]]\na = 1\n[[particles]]\na = 2\n\
                        [sizes.big.time]\nstep = 3\n[[sizes.big.particles]]\na = 9\n[sizes.small]\n";

    fn applied(overrides: &[(&str, &str)]) -> Result<toml::Table, Vec<Problem>> {
        let overrides: Vec<(String, String)> =
            overrides.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
        apply(CASE, &overrides).map(|text| text.parse().unwrap())
    }

    #[test]
    fn a_preset_replaces_parts() {
        let table = applied(&[("size", "big")]).unwrap();
        assert_eq!(table["time"]["step"].as_integer(), Some(3));
        assert_eq!(table["time"]["end"].as_integer(), Some(1));
        assert_eq!(table["particles"].as_array().unwrap().len(), 1);
    }

    #[test]
    fn set_wins_over_the_preset() {
        let table = applied(&[("time.step", "auto"), ("size", "big"), ("particles.0.a", "5")]).unwrap();
        assert_eq!(table["time"]["step"].as_str(), Some("auto"));
        assert_eq!(table["particles"][0]["a"].as_integer(), Some(5));
    }

    #[test]
    fn a_key_of_a_list_says_how_to_name_an_entry() {
        let case = "[[interaction]]\nbetween = ['a', 'b']\n[[interaction]]\nbetween = ['a', 'rigid']\n";
        let set = |path: &str| apply(case, &[(path.to_owned(), "0.4".to_owned())]);
        let said = set("interaction.static_friction").unwrap_err()[0].message.clone();
        for part in ["a list of 2 entries", "1 is ['a', 'rigid']", "--set interaction.0.static_friction=0.4"] {
            assert!(said.contains(part), "`{part}` is not in: {said}");
        }
        assert!(set("interaction.1.static_friction").is_ok());
        let said = set("interaction.1.between.x").unwrap_err()[0].message.clone();
        assert!(said.contains("`interaction.1.between` is a list of 2 entries"), "{said}");
    }

    #[test]
    fn what_cannot_be_set_is_refused() {
        for (path, value) in [("time..step", "1"), ("particles.7.a", "1"), ("time.end.x", "1"), ("time.step", "[1")] {
            let problems = applied(&[(path, value)]).unwrap_err();
            assert_eq!(problems[0].code, "tdem::case::bad-override", "{path}");
        }
        assert_eq!(applied(&[("size", "bgi")]).unwrap_err()[0].help.as_deref(), Some("did you mean `big`?"));
    }
}
