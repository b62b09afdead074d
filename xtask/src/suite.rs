//! Tests, counted.

use crate::command::{Command, Failure, cargo};
use std::fmt;

/// How tests ended, as their runners say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Count {
    /// Whether any runner came to its end.
    pub(crate) ran: bool,
    passed: u64,
    failed: u64,
    skipped: u64,
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Count { passed, failed, skipped, .. } = self;
        write!(f, "{passed} passed, {failed} failed")?;
        if *skipped > 0 { write!(f, ", {skipped} skipped") } else { Ok(()) }
    }
}

/// The examples in the documentation.
pub(crate) fn examples(count: &mut Count) -> Result<(), Failure> {
    counted(cargo("test --doc --workspace --no-fail-fast"), count)
}

/// All other tests: with nextest if it is installed, else one binary after the other.
pub(crate) fn all(count: &mut Count) -> Result<(), Failure> {
    let nextest = cargo("nextest --version").succeeds();
    let runner = if nextest { "nextest run --workspace" } else { "test --workspace --all-targets --no-fail-fast" };
    counted(cargo(runner), count)
}

fn counted(command: Command, count: &mut Count) -> Result<(), Failure> {
    command.lines(|line| count.add(line))
}

impl Count {
    /// Adds a runner's summary, if a line is one.
    fn add(&mut self, line: &str) {
        if let Some((_, result)) = line.trim().split_once("test result: ") {
            // ok. 12 passed; 0 failed; 1 ignored; 0 measured; 3 filtered out; finished in 0.5s
            let result = result.split_once(". ").map_or(result, |(_, numbers)| numbers);
            self.passed += number(result, "passed", ';');
            self.failed += number(result, "failed", ';');
            self.skipped += number(result, "ignored", ';');
            self.ran = true;
        } else if let Some((head, result)) = line.trim().split_once(" run: ")
            && head.starts_with("Summary")
        {
            // Summary [ 1.2s] 30 tests run: 28 passed (1 slow), 1 failed, 1 timed out, 2 skipped
            let passed = number(result, "passed", ',');
            let run = head.rsplit(' ').nth(1).and_then(|run| run.split('/').next()?.parse().ok());
            self.passed += passed;
            // Whatever did not pass failed, under whatever name.
            self.failed += run.unwrap_or(passed).saturating_sub(passed);
            self.skipped += number(result, "skipped", ',');
            self.ran = true;
        }
    }
}

/// The number before a word, in one of the fields between separators; 0 without it.
fn number(text: &str, word: &str, separator: char) -> u64 {
    text.split(separator)
        .find_map(|field| {
            let (number, rest) = field.trim().split_once(' ')?;
            if rest.starts_with(word) { number.parse().ok() } else { None }
        })
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::Count;

    #[test]
    fn summaries_of_both_runners() {
        let mut count = Count::default();
        for line in [
            "     Summary [   1.234s] 30 tests run: 28 passed (1 slow), 1 failed, 1 timed out, 2 skipped",
            "     Summary [   0.021s] 3/5 tests run: 3 passed, 0 skipped",
            "test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured; 3 filtered out; finished in 0.00s",
            "test result: FAILED. 2 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s",
            "a test that prints: 7 passed",
        ] {
            count.add(line);
        }
        assert_eq!(count.to_string(), "45 passed, 3 failed, 3 skipped");
    }
}
