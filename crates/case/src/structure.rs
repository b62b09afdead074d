//! Checks a file against the schema: keys, types, ranges, choices. Finds everything at once, which `serde` cannot.

use crate::codes;
use crate::habits::instead;
use crate::problem::Problem;
use crate::repair::{Repair, Repairs};
use crate::tree::{Key, Node, Value};
use serde_json::Value as Json;

/// Unknown keys for which the nearest word is looked for; more are shown without one.
const MOST_SUGGESTIONS: usize = 1000;

/// All structural problems of a tree, and what would mend it well enough for the checks that follow.
pub(crate) fn check(tree: &Node, schema: &Json) -> (Vec<Problem>, Repairs) {
    let mut checker = Checker { root: schema, problems: Vec::new(), repairs: Repairs::default() };
    checker.node(tree, schema, "", None);
    (checker.problems, checker.repairs)
}

/// Which of some words an unknown one may have meant.
pub(crate) fn nearest<'w>(unknown: &str, words: impl IntoIterator<Item = &'w str>) -> Option<&'w str> {
    let unknown = unknown.to_lowercase();
    let likeness = |word: &str| {
        let word = word.to_lowercase();
        // One slip of the finger in a short word is much by any relative measure.
        if strsim::damerau_levenshtein(&unknown, &word) == 1 { 1.0 } else { strsim::jaro_winkler(&unknown, &word) }
    };
    words
        .into_iter()
        .map(|word| (likeness(word), word))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|best| best.0 > 0.75)
        .map(|best| best.1)
}

/// Words for a message: `a`, `b`, `c`.
pub(crate) fn listed<'w>(words: impl IntoIterator<Item = &'w str>) -> String {
    words.into_iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")
}

/// "did you mean", or all that is allowed.
pub(crate) fn suggestion(unknown: &str, words: &[&str]) -> String {
    match nearest(unknown, words.iter().copied()) {
        Some(word) => format!("did you mean `{word}`?"),
        None if words.is_empty() => "nothing is defined that could stand here".to_owned(),
        None => format!("one of {}", listed(words.iter().copied())),
    }
}

struct Checker<'s> {
    root: &'s Json,
    problems: Vec<Problem>,
    repairs: Repairs,
}

impl<'s> Checker<'s> {
    fn node(&mut self, node: &Node, schema: &'s Json, path: &str, unit: Option<&'s str>) {
        let unit = schema.get("x-unit").and_then(Json::as_str).or(unit);
        if let Some(target) = schema.get("$ref").and_then(Json::as_str) {
            let target = target.strip_prefix('#').and_then(|pointer| self.root.pointer(pointer));
            if let Some(target) = target {
                self.node(node, target, path, unit);
            }
            return;
        }
        if let Some(words) = self.words(schema) {
            self.choice(node, &words, path);
            return;
        }
        if let Some(options) = schema.get("anyOf").and_then(Json::as_array) {
            self.any_of(node, options, path, unit);
            return;
        }
        let Some(kind) = schema.get("type").and_then(Json::as_str) else { return };
        match (&node.value, kind) {
            (Value::Table(_), "object") => self.table(node, schema, path),
            (Value::Array(items), "array") => self.array(node, items, schema, path, unit),
            (Value::Integer(value), "integer") => {
                if schema.get("format").and_then(Json::as_str) == Some("uint32") && *value > i64::from(u32::MAX) {
                    let message = format!("`{path}` is {value}, more than {}", u32::MAX);
                    let problem = Problem::new(codes::OUT_OF_RANGE, message);
                    self.problems.push(problem.at(node.span.clone(), "too large"));
                    self.replace(node, schema);
                }
                self.range(node, *value as f64, schema, path, unit);
            }
            (Value::Integer(value), "number") => self.range(node, *value as f64, schema, path, unit),
            (Value::Float(value), "number") => self.range(node, *value, schema, path, unit),
            (Value::String(_), "string") | (Value::Boolean, "boolean") => {}
            _ => {
                self.wrong_type(node, &self.describe(schema, unit), path);
                self.replace(node, schema);
            }
        }
    }

    /// Puts a value that the schema allows in the place of one that it does not, for the checks that follow.
    fn replace(&mut self, node: &Node, schema: &Json) {
        match stand_in(schema) {
            Some(value) => self.repairs.add(&node.span, Repair::Replace(value)),
            None => self.repairs.give_up(),
        }
    }

    fn wrong_type(&mut self, node: &Node, expected: &str, path: &str) {
        let what = if path.is_empty() { "the case".to_owned() } else { format!("`{path}`") };
        let mut problem = Problem::new(codes::WRONG_TYPE, format!("{what} is {}, but must be {expected}", node.kind()))
            .at(node.span.clone(), format!("expected {expected}"));
        if matches!(&node.value, Value::String(text) if text.trim().starts_with(|c: char| c.is_ascii_digit() || c == '-'))
            && expected.contains("number")
        {
            problem = problem.help("numbers stand without quotes and without units; all units are SI");
        }
        self.problems.push(problem);
    }

    fn range(&mut self, node: &Node, value: f64, schema: &Json, path: &str, unit: Option<&str>) {
        let bound = |key: &str| schema.get(key).and_then(Json::as_f64);
        let (least, above, most) = (bound("minimum"), bound("exclusiveMinimum"), bound("maximum"));
        let fine = value.is_finite()
            && least.is_none_or(|b| value >= b)
            && above.is_none_or(|b| value > b)
            && most.is_none_or(|b| value <= b);
        if fine {
            return;
        }
        let lower = least.map(|b| format!("at least {b}")).or(above.map(|b| format!("above {b}")));
        let upper = most.map(|b| format!("at most {b}"));
        let allowed = match (lower, upper) {
            (Some(lower), Some(upper)) => format!("{lower} and {upper}"),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => "finite".to_owned(),
        };
        self.replace(node, schema);
        let unit = unit.map_or(String::new(), |unit| format!(" {unit}"));
        self.problems.push(
            Problem::new(codes::OUT_OF_RANGE, format!("`{path}` is {value}{unit}, but must be {allowed}{unit}"))
                .at(node.span.clone(), format!("must be {allowed}{unit}")),
        );
    }

    fn array(&mut self, node: &Node, items: &[Node], schema: &'s Json, path: &str, unit: Option<&'s str>) {
        let length = |key: &str| schema.get(key).and_then(Json::as_u64).map(|n| n as usize);
        let (least, most) = (length("minItems").unwrap_or(0), length("maxItems").unwrap_or(usize::MAX));
        if items.len() < least || items.len() > most {
            self.repairs.give_up();
            let allowed = if least == most { format!("{least}") } else { format!("at least {least}") };
            self.problems.push(
                Problem::new(
                    codes::WRONG_LENGTH,
                    format!("`{path}` has {} entries, but must have {allowed}", items.len()),
                )
                .at(node.span.clone(), format!("expected {allowed} entries")),
            );
        }
        if let Some(inner) = schema.get("items") {
            for (index, item) in items.iter().enumerate() {
                self.node(item, inner, &format!("{path}[{index}]"), unit);
            }
        }
    }

    fn table(&mut self, node: &Node, schema: &'s Json, path: &str) {
        let Value::Table(entries) = &node.value else { return };
        let properties = schema.get("properties").and_then(Json::as_object);
        let join = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        for (key, value) in entries {
            if let Some(inner) = properties.and_then(|p| p.get(&key.name)) {
                self.node(value, inner, &join(&key.name), None);
                continue;
            }
            match schema.get("additionalProperties") {
                Some(inner @ Json::Object(_)) => self.node(value, inner, &join(&key.name), None),
                Some(Json::Bool(true)) => {}
                _ => {
                    let known: Vec<&str> = properties.map_or(Vec::new(), |p| p.keys().map(String::as_str).collect());
                    let problem = Problem::new(codes::UNKNOWN_KEY, format!("unknown key `{}`", join(&key.name)))
                        .at(key.span.clone(), "not a key of this table");
                    self.unknown(problem, key, &known, entries);
                }
            }
        }
        let required = schema.get("required").and_then(Json::as_array).into_iter().flatten().filter_map(Json::as_str);
        for key in required.filter(|key| !entries.iter().any(|(present, _)| present.name == *key)) {
            let inner = properties.and_then(|p| p.get(key));
            match inner.and_then(|inner| stand_in(self.resolve(inner))).filter(|value| !value.is_str()) {
                Some(value) => self.repairs.add(&node.span, Repair::Insert(key.to_owned(), value)),
                None => self.repairs.give_up(),
            }
            let what = inner.and_then(|i| i.get("description")).and_then(Json::as_str).unwrap_or_default();
            let example = inner.map(|i| self.example(i)).unwrap_or_default();
            let add = match example {
                "table" => format!("add a table [{}]", join(key)),
                "tables" => format!("add a table [[{}]]", join(key)),
                _ => format!("add `{key} = {example}`"),
            };
            let place = if path.is_empty() { 0..0 } else { node.span.clone() };
            self.problems.push(
                Problem::new(codes::MISSING_KEY, format!("`{}` is missing", join(key)))
                    .at(place, format!("`{key}` belongs here"))
                    .help(format!("{add}: {what}").replace('\n', " ")),
            );
        }
    }

    /// What a value could look like, for a missing key.
    fn example(&self, schema: &Json) -> &'static str {
        if let Some(target) = schema.get("$ref").and_then(Json::as_str) {
            return target.strip_prefix('#').and_then(|p| self.root.pointer(p)).map_or("...", |s| self.example(s));
        }
        match schema.get("type").and_then(Json::as_str) {
            Some("array") if schema.get("minItems").and_then(Json::as_u64) == Some(3) => "[..., ..., ...]",
            Some("array") => match schema.get("items").map(|items| self.example(items)) {
                Some("table") => "tables",
                _ => "[...]",
            },
            Some("object") => "table",
            Some("string") => "\"...\"",
            _ => "...",
        }
    }

    fn any_of(&mut self, node: &Node, options: &'s [Json], path: &str, unit: Option<&'s str>) {
        let fits = |option: &&'s Json| {
            let option = self.resolve(option);
            let kind = option.get("type").and_then(Json::as_str);
            matches!(
                (&node.value, kind),
                (Value::Integer(_) | Value::Float(_), Some("number"))
                    | (Value::Table(_), Some("object"))
                    | (Value::Array(_), Some("array"))
                    | (Value::Boolean, Some("boolean"))
            )
        };
        // Of several lists the one whose entries are like the first.
        let like = |option: &&'s Json| fits(option) && self.holds_alike(node, self.resolve(option));
        if let Some(option) = options.iter().find(like).or_else(|| options.iter().find(fits)) {
            self.node(node, option, path, unit);
            return;
        }
        let words: Vec<&str> = options.iter().filter_map(|o| o.get("const").and_then(Json::as_str)).collect();
        if let Value::String(text) = &node.value
            && words.contains(&text.as_str())
        {
            return;
        }
        let value = options.iter().find_map(|option| stand_in(self.resolve(option)));
        match value {
            Some(value) => self.repairs.add(&node.span, Repair::Replace(value)),
            None => self.repairs.give_up(),
        }
        let expected: Vec<String> = options.iter().map(|option| self.describe(option, unit)).collect();
        self.wrong_type(node, &expected.join(" or "), path);
    }

    /// Whether the first entry of a list is a word or a number where the schema has one; true of what is no list.
    fn holds_alike(&self, node: &Node, schema: &'s Json) -> bool {
        let Value::Array(items) = &node.value else { return true };
        let inner = schema.get("items").map(|inner| self.resolve(inner));
        let Some((first, inner)) = items.first().zip(inner) else { return true };
        let kind = inner.get("type").and_then(Json::as_str);
        match &first.value {
            Value::String(_) => kind == Some("string") || self.words(inner).is_some(),
            Value::Integer(_) | Value::Float(_) => matches!(kind, Some("integer" | "number")),
            _ => true,
        }
    }

    /// An unknown key: what may have been meant, or what stands in its place.
    fn unknown(&mut self, problem: Problem, key: &Key, known: &[&str], entries: &[(Key, Node)]) {
        let told = self.problems.len() < MOST_SUGGESTIONS;
        let meant = if told { nearest(&key.name, known.iter().copied()) } else { None };
        let free = |word: &str| !entries.iter().any(|(other, _)| other.name == word);
        let instead = if told { instead(&key.name) } else { None };
        let help = match instead {
            _ if !told => None,
            Some(instead) => Some(instead.to_owned()),
            None => Some(suggestion(&key.name, known)),
        };
        let repair = match meant.filter(|word| instead.is_none() && free(word)) {
            Some(word) => Repair::Rename(word.to_owned()),
            None => Repair::Remove,
        };
        self.repairs.add(&key.span, repair);
        self.problems.push(match help {
            Some(help) => problem.help(help),
            None => problem,
        });
    }

    fn choice(&mut self, node: &Node, words: &[&str], path: &str) {
        let given = if let Value::String(text) = &node.value { text.as_str() } else { "" };
        if !words.contains(&given) {
            match nearest(given, words.iter().copied()).or(words.first().copied()) {
                Some(word) => self.repairs.add(&node.span, Repair::Replace(toml::Value::String(word.to_owned()))),
                None => self.repairs.give_up(),
            }
        }
        let Value::String(text) = &node.value else {
            self.wrong_type(node, &format!("one of {}", listed(words.iter().copied())), path);
            return;
        };
        if !words.contains(&text.as_str()) {
            let message = format!("`{path}` is \"{text}\", but must be one of {}", listed(words.iter().copied()));
            let mut problem =
                Problem::new(codes::UNKNOWN_CHOICE, message).at(node.span.clone(), "not one of the choices");
            if let Some(word) = nearest(text, words.iter().copied()) {
                problem = problem.help(format!("did you mean `{word}`?"));
            } else if let Some(instead) = instead(text) {
                problem = problem.help(instead);
            }
            self.problems.push(problem);
        }
    }

    /// The words of a choice, if the schema is one.
    fn words(&self, schema: &'s Json) -> Option<Vec<&'s str>> {
        if let Some(words) = schema.get("enum").and_then(Json::as_array) {
            return Some(words.iter().filter_map(Json::as_str).collect());
        }
        if let Some(word) = schema.get("const").and_then(Json::as_str) {
            return Some(vec![word]);
        }
        let options = schema.get("oneOf").and_then(Json::as_array)?;
        let words: Option<Vec<Vec<&str>>> = options.iter().map(|option| self.words(self.resolve(option))).collect();
        Some(words?.concat())
    }

    fn resolve(&self, schema: &'s Json) -> &'s Json {
        let target = schema.get("$ref").and_then(Json::as_str);
        target.and_then(|t| t.strip_prefix('#')).and_then(|p| self.root.pointer(p)).unwrap_or(schema)
    }

    fn describe(&self, schema: &'s Json, unit: Option<&str>) -> String {
        let schema = self.resolve(schema);
        if let Some(word) = schema.get("const").and_then(Json::as_str) {
            return format!("\"{word}\"");
        }
        match schema.get("type").and_then(Json::as_str) {
            Some("number") => unit.map_or("a number".to_owned(), |unit| format!("a number in {unit}")),
            Some("integer") => "an integer".to_owned(),
            Some("string") => "text in quotes".to_owned(),
            Some("boolean") => "true or false".to_owned(),
            Some("array") => match schema.get("minItems").and_then(Json::as_u64) {
                Some(n) if schema.get("maxItems").and_then(Json::as_u64) == Some(n) => format!("an array of {n}"),
                _ => "an array".to_owned(),
            },
            _ => "a table".to_owned(),
        }
    }
}

/// Some value that a schema of a number, a choice or a truth allows.
fn stand_in(schema: &Json) -> Option<toml::Value> {
    let bound = |key: &str| schema.get(key).and_then(Json::as_f64);
    let fits = |value: &f64| {
        bound("minimum").is_none_or(|b| *value >= b)
            && bound("exclusiveMinimum").is_none_or(|b| *value > b)
            && bound("maximum").is_none_or(|b| *value <= b)
    };
    let number = || [1.0, 0.25].into_iter().chain(bound("minimum")).chain(bound("maximum")).find(fits);
    match schema.get("type").and_then(Json::as_str)? {
        "number" => number().map(toml::Value::Float),
        "integer" => number().map(|value| toml::Value::Integer(value as i64)),
        "boolean" => Some(toml::Value::Boolean(false)),
        _ => None,
    }
}
