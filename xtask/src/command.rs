//! Running other programs.

use std::ffi::OsStr;
use std::fmt;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

/// Why a part of CI stopped.
#[derive(Debug)]
pub(crate) struct Failure(pub(crate) String);

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// A program with its arguments. It gets no standard input.
pub(crate) struct Command {
    shown: String,
    inner: std::process::Command,
}

/// The cargo that runs this, with arguments separated by spaces.
pub(crate) fn cargo(arguments: &str) -> Command {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = program_at(&program);
    command.shown = "cargo".into();
    arguments.split_whitespace().fold(command, Command::argument)
}

/// A program by its name or path.
pub(crate) fn program_at(program: impl AsRef<OsStr>) -> Command {
    let mut inner = std::process::Command::new(&program);
    inner.stdin(Stdio::null());
    Command { shown: program.as_ref().to_string_lossy().into_owned(), inner }
}

impl Command {
    pub(crate) fn argument(mut self, argument: impl AsRef<OsStr>) -> Self {
        self.shown = format!("{} {}", self.shown, argument.as_ref().to_string_lossy());
        self.inner.arg(argument);
        self
    }
    pub(crate) fn variable(mut self, name: &str, value: impl AsRef<OsStr>) -> Self {
        self.shown = format!("{name}={} {}", value.as_ref().display(), self.shown);
        self.inner.env(name, value);
        self
    }

    /// Runs it, output and all, and wants it to succeed.
    pub(crate) fn run(mut self) -> Result<(), Failure> {
        let status = self.inner.status().map_err(|error| self.failure(&error))?;
        if status.success() { Ok(()) } else { Err(self.failure(&status)) }
    }

    /// Starts it and does not wait; whether it succeeds is found out by who needs its work.
    pub(crate) fn start(mut self) -> Result<std::process::Child, Failure> {
        self.inner.stdout(Stdio::null()).stderr(Stdio::null()).spawn().map_err(|error| self.failure(&error))
    }

    /// Whether it exists and succeeds; its output is thrown away.
    pub(crate) fn succeeds(mut self) -> bool {
        self.inner.stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|status| status.success())
    }

    /// What it prints.
    pub(crate) fn output(mut self) -> Result<String, Failure> {
        let output = self.inner.stderr(Stdio::inherit()).output().map_err(|error| self.failure(&error))?;
        if !output.status.success() {
            return Err(self.failure(&output.status));
        }
        String::from_utf8(output.stdout).map_err(|error| self.failure(&error))
    }

    /// Runs it, shows every line of its output and hands it on.
    pub(crate) fn lines(mut self, mut line: impl FnMut(&str)) -> Result<(), Failure> {
        let (reader, writer) = std::io::pipe().map_err(|error| self.failure(&error))?;
        let errors = writer.try_clone().map_err(|error| self.failure(&error))?;
        self.inner.stdout(writer).stderr(errors);
        let mut child = self.inner.spawn().map_err(|error| self.failure(&error))?;
        // The pipe ends when nobody can write into it any more: this process must not hold it open.
        self.inner.stdout(Stdio::null()).stderr(Stdio::null());
        for text in BufReader::new(reader).split(b'\n') {
            let text = text.map_err(|error| self.failure(&error))?;
            let text = String::from_utf8_lossy(&text);
            println!("{text}");
            line(&text);
        }
        let status = child.wait().map_err(|error| self.failure(&error))?;
        if status.success() { Ok(()) } else { Err(self.failure(&status)) }
    }

    fn failure(&self, reason: &dyn fmt::Display) -> Failure {
        Failure(format!("`{}`: {reason}", self.shown))
    }
}
