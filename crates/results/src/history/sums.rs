//! Checksums of the rows of a history, in a file beside the checkpoints: by them a run that is taken up knows which rows are as
//! they were written.
//!
//! A line is the checksum of the rest of the line, and that rest: the first line of the history, or the step of a row and the
//! checksum of the row.

use std::collections::BTreeMap;
use xxhash_rust::xxh3::xxh3_64;

/// The line for the first line of a history.
pub(super) fn of_header(header: &str) -> String {
    line(header.trim_end_matches('\n'))
}

/// The line for a row, which ends with a line feed.
pub(super) fn of_row(step: u64, row: &[u8]) -> String {
    line(&format!("{step} {:016x}", sum(row)))
}

/// The checksum of a row, which ends with a line feed.
pub(super) fn sum(row: &[u8]) -> u64 {
    xxh3_64(row)
}

fn line(text: &str) -> String {
    format!("{:016x} {text}\n", xxh3_64(text.as_bytes()))
}

/// What the file tells. Lines that are not as they were written tell nothing.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Sums {
    /// The first line of the history, with its line feed.
    pub(super) header: Option<String>,
    /// Checksums of rows by their steps.
    pub(super) rows: BTreeMap<u64, u64>,
    /// Whether it is not known what rows there were: the file is not there, or a line of it is damaged.
    pub(super) broken: bool,
}

impl Sums {
    pub(super) fn read(text: &[u8]) -> Self {
        let mut sums = Sums::default();
        for line in text.split(|&byte| byte == b'\n') {
            let Some(text) = whole(line) else {
                sums.broken |= !line.is_empty();
                continue;
            };
            match text.split_once(' ').and_then(|(step, sum)| Some((step.parse().ok()?, hexadecimal(sum)?))) {
                Some((step, sum)) => {
                    sums.rows.insert(step, sum);
                }
                None => sums.header = Some(format!("{text}\n")),
            }
        }
        sums.broken |= sums.header.is_none();
        sums
    }

    /// Whether a row without a checksum may be as it was written: its checksum is damaged or cut off.
    pub(super) fn may_lack(&self, step: u64) -> bool {
        !self.rows.contains_key(&step) && (self.broken || self.rows.keys().next_back().is_none_or(|&last| last < step))
    }
}

/// The text of a line whose checksum is right.
fn whole(line: &[u8]) -> Option<&str> {
    let (sum, text) = std::str::from_utf8(line).ok()?.split_once(' ')?;
    (hexadecimal(sum)? == xxh3_64(text.as_bytes())).then_some(text)
}

fn hexadecimal(digits: &str) -> Option<u64> {
    u64::from_str_radix(digits, 16).ok()
}
