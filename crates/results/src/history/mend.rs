//! A history as it is found when a run is taken up: which rows are as they were written, which are damaged, which are missing.

use super::sums::{self, Sums};
use crate::words::grouped;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// Lines and gaps that a message names one by one.
const NAMED: usize = 20;

/// What was wrong with the history of a run that is taken up. Good rows stayed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HistoryDamage {
    /// There was no file.
    pub file_missing: bool,
    /// Lines that are not as they were written, counted from 1, and the steps that they seem to be of.
    pub lines: Vec<(usize, Option<u64>)>,
    /// Whether rows did not follow each other. They were put in order.
    pub disordered: bool,
    /// Steps of rows that were written and are not there any more, ascending.
    pub lost: Vec<u64>,
    /// Steps of rows without a checksum, which were taken because they have the form of rows, ascending.
    pub unverified: Vec<u64>,
    /// The file that holds what was found.
    pub aside: Option<PathBuf>,
    /// Steps of the rows that stayed, ascending.
    pub steps: Vec<u64>,
}

/// Rows that are missing between others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Gap {
    first: u64,
    last: u64,
    rows: u64,
}

impl HistoryDamage {
    /// Whether what was found must be kept for whoever wants to look at it.
    pub(super) fn is_of_lines(&self) -> bool {
        !self.lines.is_empty() || self.disordered
    }

    /// Everything that was wrong, in sentences.
    #[must_use]
    pub fn told(&self) -> Vec<String> {
        let mut told = Vec::new();
        if self.file_missing {
            told.push("history.csv is missing; it begins again".to_owned());
        }
        if self.is_of_lines() {
            let aside = self.aside.as_ref().and_then(|path| path.file_name()).map(std::ffi::OsStr::to_string_lossy);
            let kept = aside.map_or(String::new(), |name| format!("; what was found is kept in {name}"));
            let line = |&(line, step): &(usize, Option<u64>)| match step {
                Some(step) => format!("line {line} (step {step})"),
                None => format!("line {line}"),
            };
            let what = match self.lines.len() {
                0 => "its rows did not follow each other and were put in order".to_owned(),
                _ => format!("{} not as written", listed(self.lines.iter().map(line), self.lines.len(), "is", "are")),
            };
            told.push(format!("history.csv is damaged: {what}{kept}"));
        }
        if !self.lost.is_empty() {
            told.push(missing(&gaps_of(&self.lost, &self.steps), "written and are not there any more"));
        }
        if let (Some(first), Some(last)) = (self.unverified.first(), self.unverified.last()) {
            told.push(format!(
                "history.csv has {} without a checksum, steps {first} to {last}: only their form could be looked at",
                rows(self.unverified.len() as u64)
            ));
        }
        told
    }

    /// Rows that a schedule asks for before a step, one every so many steps, and that are neither there nor told of as lost.
    #[must_use]
    pub fn holes(&self, every: u64, before: u64) -> Option<String> {
        let known: BTreeSet<u64> = self.steps.iter().chain(&self.lost).copied().filter(|&at| at < before).collect();
        let mut gaps = Vec::new();
        let mut next = 0;
        if every == 0 {
            return None;
        }
        for at in known.into_iter().chain([before]) {
            let rows = at.saturating_sub(next).div_ceil(every);
            if next < at {
                gaps.push(Gap { first: next, last: next + (rows - 1) * every, rows });
            }
            next = next.max((at / every + 1) * every);
        }
        (!gaps.is_empty()).then(|| missing(&gaps, "asked for by the case and are not there"))
    }
}

fn rows(count: u64) -> String {
    format!("{} {}", grouped(count), if count == 1 { "row" } else { "rows" })
}

/// The first few of many, and how many more there are, with the verb that belongs to them.
fn listed(all: impl Iterator<Item = String>, count: usize, one: &str, several: &str) -> String {
    let named: Vec<String> = all.take(NAMED).collect();
    let more = if count > NAMED { format!(" and {} more", grouped((count - NAMED) as u64)) } else { String::new() };
    format!("{}{more} {}", named.join(", "), if count == 1 { one } else { several })
}

fn missing(gaps: &[Gap], what: &str) -> String {
    let count = gaps.iter().map(|gap| gap.rows).sum();
    let gap = |gap: &Gap| match gap.rows {
        1 => format!("{}", gap.first),
        _ => format!("{} to {}", gap.first, gap.last),
    };
    let named: Vec<String> = gaps.iter().take(NAMED).map(gap).collect();
    let more = gaps.len().saturating_sub(NAMED) as u64;
    let more = if more > 0 { format!(" and {} more gaps", grouped(more)) } else { String::new() };
    format!("history.csv lacks {} that were {what}, of steps {}{more}", rows(count), named.join(", "))
}

/// Missing steps, those together between which no row stayed.
fn gaps_of(lost: &[u64], stayed: &[u64]) -> Vec<Gap> {
    let mut gaps: Vec<Gap> = Vec::new();
    for &step in lost {
        match gaps.last_mut() {
            Some(gap) if stayed.partition_point(|&at| at < gap.last) == stayed.partition_point(|&at| at < step) => {
                (gap.last, gap.rows) = (step, gap.rows + 1);
            }
            _ => gaps.push(Gap { first: step, last: step, rows: 1 }),
        }
    }
    gaps
}

/// A history as it is found.
#[derive(Debug)]
pub(super) struct Found<'t> {
    /// The first line; none if there is no way to know it.
    pub(super) header: Option<String>,
    /// Rows that stay, by their steps.
    pub(super) rows: BTreeMap<u64, &'t [u8]>,
    pub(super) damage: HistoryDamage,
}

/// Looks at a history, of which rows up to a step are wanted. Later rows, and one that was cut off when its process died, go
/// without a word: they are computed again.
pub(super) fn look<'t>(text: &'t [u8], sums: &Sums, step: u64, known: impl Fn(&str) -> bool) -> Found<'t> {
    let mut found = Found { header: sums.header.clone(), rows: BTreeMap::new(), damage: HistoryDamage::default() };
    let mut lines = text.split_inclusive(|&byte| byte == b'\n').enumerate().peekable();
    if let Some(&(_, first)) = lines.peek() {
        let first = std::str::from_utf8(first).ok().filter(|first| first.ends_with('\n'));
        match (first, &sums.header) {
            (Some(first), Some(header)) if first == header => drop(lines.next()),
            (Some(first), None) if known(first) => {
                found.header = Some(first.to_owned());
                lines.next();
            }
            _ => {}
        }
    }
    let columns = found.header.as_deref().map_or(0, |header| header.split(',').count());
    let mut last = None;
    for (index, line) in lines {
        let (claimed, whole) = (step_of(line), line.ends_with(b"\n"));
        let verified = whole && claimed.is_some_and(|claimed| sums.rows.get(&claimed) == Some(&sums::sum(line)));
        let plausible = || claimed.is_some_and(|claimed| sums.may_lack(claimed)) && has_form(line, columns);
        let good = whole && (verified || plausible());
        let later = claimed.is_some_and(|claimed| claimed > step);
        match claimed.filter(|claimed| good && !found.rows.contains_key(claimed)) {
            Some(_) if later => {}
            Some(claimed) => {
                found.rows.insert(claimed, line);
                found.damage.disordered |= last.is_some_and(|last| last > claimed);
                last = Some(claimed);
                if !verified {
                    found.damage.unverified.push(claimed);
                }
            }
            // A later row is computed again, whatever became of it; so is one that a process left unfinished.
            None if later || (!whole && claimed.is_none_or(|claimed| !sums.rows.contains_key(&claimed))) => {}
            None => found.damage.lines.push((index + 1, claimed)),
        }
    }
    found.damage.unverified.sort_unstable();
    found.damage.steps = found.rows.keys().copied().collect();
    // The row of the step itself is written again.
    found.damage.lost = sums.rows.range(..step).map(|(&at, _)| at).filter(|at| !found.rows.contains_key(at)).collect();
    found
}

fn step_of(line: &[u8]) -> Option<u64> {
    std::str::from_utf8(line.split(|&byte| byte == b',').next()?).ok()?.parse().ok()
}

/// Whether a line has a number in every column.
fn has_form(line: &[u8], columns: usize) -> bool {
    let Ok(line) = std::str::from_utf8(line) else { return false };
    let cells = line.trim_end_matches('\n').split(',');
    cells.clone().count() == columns && cells.into_iter().all(|cell| cell.parse::<f64>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_told_from_first_to_last() {
        let damage = HistoryDamage { steps: vec![0, 10, 50, 60, 63], ..HistoryDamage::default() };
        assert_eq!(
            damage.holes(10, 64),
            Some(missing(&[Gap { first: 20, last: 40, rows: 3 }], "asked for by the case and are not there"))
        );
        assert_eq!(damage.holes(0, 64), None);
        let told = damage.holes(10, 95).unwrap();
        assert!(told.contains("6 rows") && told.ends_with("of steps 20 to 40, 70 to 90"), "{told}");
        assert_eq!(damage.holes(10, 10), None);
        let nothing = HistoryDamage::default().holes(10, 25).unwrap();
        assert!(nothing.ends_with("of steps 0 to 20"), "{nothing}");
        let lost = HistoryDamage { lost: vec![20, 30, 40, 70], ..damage };
        assert_eq!(lost.holes(10, 71), None, "what is told as lost is not told twice");
        assert!(lost.told()[0].ends_with("of steps 20 to 40, 70"), "{:?}", lost.told());
    }

    #[test]
    fn a_long_list_is_cut() {
        let lines = (0..1000).map(|line| (line, None)).collect();
        let told = HistoryDamage { lines, ..HistoryDamage::default() }.told().concat();
        assert!(told.contains("line 19 and 980 more are not as written") && told.len() < 400, "{told}");
    }
}
