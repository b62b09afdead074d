//! Tests, counted.

use crate::command::{Command, Failure, cargo};
use crate::workspace::Workspace;
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

/// The test that compiles most kernels: most of its time it takes one core.
const LONGEST: &str = "test(equal_bits_on_every_back_end)";

/// All other tests: with nextest if it is installed, else one binary after the other.
///
/// With nextest the longest test runs beside the others. Both use PoCL, whose cache on disk processes must not share at the same
/// time, and so it has one of its own.
pub(crate) fn all(workspace: &Workspace, count: &mut Count) -> Result<(), Failure> {
    if !cargo("nextest --version").succeeds() {
        return counted(cargo("test --workspace --all-targets --no-fail-fast"), count);
    }
    let nextest = || cargo("nextest run --workspace");
    nextest().argument("--no-run").run()?;
    let cache = workspace.target.join("longest-test").join("pocl");
    let longest = nextest().argument("-E").argument(LONGEST).variable("POCL_CACHE_DIR", &cache);
    let others = nextest().argument("-E").argument(format!("not {LONGEST}"));
    let (mut first, mut second) = (Count::default(), Count::default());
    let (one, other) = std::thread::scope(|scope| {
        let beside = scope.spawn(|| counted(longest, &mut first));
        let others = counted(others, &mut second);
        (beside.join().unwrap_or_else(|_| Err(Failure("the thread of the longest test panicked".into()))), others)
    });
    count.join(first, second);
    one.and(other)
}

fn counted(command: Command, count: &mut Count) -> Result<(), Failure> {
    command.lines(|line| count.add(line))
}

impl Count {
    /// Adds two runs that shared the tests: each leaves out what the other ran, and both what is ignored.
    fn join(&mut self, first: Count, second: Count) {
        self.ran |= first.ran || second.ran;
        self.passed += first.passed + second.passed;
        self.failed += first.failed + second.failed;
        self.skipped += second.skipped.saturating_sub(first.passed + first.failed);
    }

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

    #[test]
    fn what_one_of_two_runs_leaves_to_the_other_is_not_skipped() {
        let (mut first, mut second, mut both) = (Count::default(), Count::default(), Count::default());
        first.add("     Summary [ 300.000s] 1 test run: 1 passed (1 slow), 473 skipped");
        second.add("     Summary [ 200.000s] 462 tests run: 461 passed, 1 failed, 12 skipped");
        both.join(first, second);
        assert_eq!(both.to_string(), "462 passed, 1 failed, 11 skipped");
    }
}
