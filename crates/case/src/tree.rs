//! A case file as a tree whose every key and value knows its place in the text.

use crate::codes;
use crate::problem::Problem;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value and its place. The place of a table with a header is the header.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) span: Range<usize>,
    pub(crate) value: Value,
}

#[derive(Clone, Debug)]
pub(crate) enum Value {
    String(String),
    Integer(i64),
    Float(f64),
    Boolean,
    Datetime,
    Array(Vec<Node>),
    Table(Vec<(Key, Node)>),
}

#[derive(Clone, Debug)]
pub(crate) struct Key {
    pub(crate) name: String,
    pub(crate) span: Range<usize>,
}

impl Node {
    /// Reads a text; everything that is not TOML is a problem.
    pub(crate) fn parse(text: &str) -> Result<Node, Vec<Problem>> {
        let (table, errors) = DeTable::parse_recoverable(text);
        if errors.is_empty() {
            let span = table.span();
            return Ok(Node { span, value: convert_table(table.get_ref()) });
        }
        Err(errors
            .iter()
            .map(|e| {
                Problem::new(codes::SYNTAX, "this is not valid TOML")
                    .at(e.span().unwrap_or(0..0), e.message().to_owned())
                    .help("text stands in quotes, tables begin with [name], arrays of tables with [[name]]")
            })
            .collect())
    }

    /// The value at a path of keys and, for arrays, indices.
    pub(crate) fn get(&self, path: &[&str]) -> Option<&Node> {
        path.iter().try_fold(self, |node, step| match &node.value {
            Value::Table(entries) => entries.iter().find(|(key, _)| key.name == *step).map(|(_, value)| value),
            Value::Array(items) => step.parse::<usize>().ok().and_then(|k| items.get(k)),
            _ => None,
        })
    }

    /// The place of the value at a path, or of the innermost table around it if the text does not have it.
    pub(crate) fn place(&self, path: &[&str]) -> Range<usize> {
        (0..=path.len()).rev().find_map(|k| self.get(&path[..k])).map_or(0..0, |node| node.span.clone())
    }

    /// The place of the key at a path, or of the innermost table around it.
    pub(crate) fn key_place(&self, path: &[&str]) -> Range<usize> {
        let key = path.split_last().and_then(|(last, parent)| match &self.get(parent)?.value {
            Value::Table(entries) => entries.iter().find(|(key, _)| key.name == *last).map(|(key, _)| key.span.clone()),
            _ => None,
        });
        key.unwrap_or_else(|| self.place(path))
    }

    /// What it is, in the words of a TOML user.
    pub(crate) fn kind(&self) -> &'static str {
        match self.value {
            Value::String(_) => "text",
            Value::Integer(_) => "an integer",
            Value::Float(_) => "a number",
            Value::Boolean => "true or false",
            Value::Datetime => "a date",
            Value::Array(_) => "an array",
            Value::Table(_) => "a table",
        }
    }
}

fn convert_table(table: &DeTable<'_>) -> Value {
    Value::Table(
        table
            .iter()
            .map(|(key, value)| (Key { name: key.get_ref().to_string(), span: key.span() }, convert(value)))
            .collect(),
    )
}

fn convert(value: &Spanned<DeValue<'_>>) -> Node {
    let node = match value.get_ref() {
        DeValue::String(text) => Value::String(text.to_string()),
        // The parser accepts only digits here; what is too long for 64 bits reads as a float.
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix())
            .map_or_else(|_| Value::Float(number.as_str().parse().unwrap_or(f64::NAN)), Value::Integer),
        DeValue::Float(number) => Value::Float(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(_) => Value::Boolean,
        DeValue::Datetime(_) => Value::Datetime,
        DeValue::Array(items) => Value::Array(items.iter().map(convert).collect()),
        DeValue::Table(table) => convert_table(table),
    };
    Node { span: value.span(), value: node }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_of_values_keys_and_headers() {
        let text = "a = 1\n[t]\nb = [2, 3]\n[[p]]\n[p.q]\nc = 'x'\n";
        let tree = Node::parse(text).unwrap();
        assert_eq!(&text[tree.place(&["a"])], "1");
        assert_eq!(&text[tree.place(&["t"])], "[t]");
        assert_eq!(&text[tree.place(&["t", "b", "1"])], "3");
        assert_eq!(&text[tree.key_place(&["p", "0", "q", "c"])], "c");
        assert_eq!(&text[tree.place(&["p", "0", "q", "missing"])], "[p.q]");
    }
}
