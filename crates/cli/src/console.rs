//! The only two ways out: data to standard output, everything else to standard error.

use crate::codes;
use crate::render::{Report, Reports};
use std::fmt::Display;
use std::io::{ErrorKind, IsTerminal, Write, stderr, stdout};
use tdem_results::words::plain;

/// Writes a line of data, with everything spelled out that a terminal would obey.
///
/// # Errors
/// If standard output cannot take it. A reader that has seen enough (`tdem schema | head`) is no error.
pub(crate) fn data(text: impl Display) -> Result<(), Reports> {
    let text = text.to_string();
    match writeln!(stdout(), "{}", plain(&text)).and_then(|()| stdout().flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Report::new(codes::OUTPUT, format!("cannot write to standard output: {error}")).into())
        }
        _ => Ok(()),
    }
}

/// Tells the user something, with everything spelled out that a terminal would obey. If nobody can hear it, the work goes on.
pub(crate) fn say(text: impl Display) {
    say_drawn(plain(&text.to_string()));
}

/// Tells the user something that has colours of its own.
pub(crate) fn say_drawn(text: impl Display) {
    let _ = writeln!(stderr(), "{text}");
}

/// Whether somebody watches.
pub(crate) fn watched() -> bool {
    stderr().is_terminal()
}

/// Whether colours are welcome, see <https://no-color.org>.
pub(crate) fn colours() -> bool {
    let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    watched() && !refused && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}
