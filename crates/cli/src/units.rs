//! Numbers as people read them.

use std::borrow::Cow;
use std::fmt::Display;
use std::path::Path;
pub(crate) use tdem_results::words::{bytes, clock, cut, grouped, number};

/// Four digits, enough for a look.
pub(crate) fn short(value: f64) -> String {
    number(value, 4)
}

/// A number of things: "1 frame", "3 frames".
pub(crate) fn counted(count: u64, thing: &str) -> String {
    format!("{} {thing}{}", grouped(count), if count == 1 { "" } else { "s" })
}

/// A path as a shell takes it.
pub(crate) fn argument(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || "/._-+,@%:=\\".contains(c);
    if !text.is_empty() && text.chars().all(plain) { text } else { format!("'{}'", text.replace('\'', r"'\''")) }
}

/// Letters of what stands in a line of a list.
const LONGEST: usize = 2000;

/// A line of a list: a name in a column of its own, and what belongs to it.
pub(crate) fn entry(name: impl Display, value: impl Display) -> String {
    format!("  {name:<14} {}\n", cut(&value.to_string(), LONGEST))
}

/// The title of a case, as long as a line.
pub(crate) fn title(title: &str) -> Cow<'_, str> {
    cut(title, 200)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_are_counted() {
        assert_eq!([1, 2].map(|n| counted(n, "frame")), ["1 frame", "2 frames"]);
    }

    #[test]
    fn a_path_with_a_space_is_quoted() {
        assert_eq!(argument(Path::new("runs/a b")), "'runs/a b'");
        assert_eq!(argument(Path::new("runs/silo_2.5")), "runs/silo_2.5");
    }
}
