//! A damaged history loses nothing without a word.

#![allow(clippy::unwrap_used, reason = "helpers of tests may panic like tests")]

mod common;

use common::{run_new, run_on};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use tdem_results::{Error, HistoryDamage, RunDirectory};

const HISTORY: &str = "history.csv";
const SUMS: &str = "checkpoints/history.sums";
const END: u64 = 400;

struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % end.max(1)
    }
}

/// What disks, editors and people do to a file of lines; `None` removes it.
fn damaged(text: &[u8], random: &mut Random) -> Option<Vec<u8>> {
    let mut bytes = text.to_vec();
    let at = random.below(bytes.len());
    let mut lines: Vec<&[u8]> = text.split_inclusive(|&byte| byte == b'\n').collect();
    let [one, other] = [random.below(lines.len()), random.below(lines.len())];
    match random.below(11) {
        0 => bytes[at] ^= 1 << random.below(8),
        1 => bytes[at] = random.below(256) as u8,
        2 => bytes.truncate(at),
        3 => drop(bytes.drain(at..(at + 1 + random.below(300)).min(text.len()))),
        4 => {
            let end = (at + 1 + random.below(300)).min(text.len());
            bytes[at..end].fill(0);
        }
        5 => drop(bytes.splice(at..at, *b"\0garbage,\n")),
        6 => {
            let digits: Vec<usize> = (0..bytes.len()).filter(|&k| bytes[k].is_ascii_digit()).collect();
            let digit = &mut bytes[digits[random.below(digits.len())]];
            *digit = b'0' + (*digit - b'0' + 1 + random.below(9) as u8) % 10;
        }
        7 => {
            lines.insert(one, lines[other]);
            bytes = lines.concat();
        }
        8 => {
            lines.swap(one, other);
            bytes = lines.concat();
        }
        9 => {
            lines.remove(one);
            bytes = lines.concat();
        }
        _ => return None,
    }
    Some(bytes)
}

/// The rows of a history by their steps, and its first line.
fn rows(run: &Path) -> (String, BTreeMap<u64, String>) {
    let text = fs::read_to_string(run.join(HISTORY)).unwrap();
    assert!(text.ends_with('\n'));
    let mut lines = text.lines().map(str::to_owned);
    let header = lines.next().unwrap();
    let step = |line: &str| line.split(',').next().unwrap().parse::<u64>().unwrap();
    let rows: Vec<(u64, String)> = lines.map(|line| (step(&line), line)).collect();
    assert!(rows.is_sorted_by(|a, b| a.0 < b.0), "rows follow each other");
    (header, rows.into_iter().collect())
}

fn copy(run: &Path, to: &Path) {
    for folder in ["frames", "checkpoints"] {
        fs::create_dir_all(to.join(folder)).unwrap();
    }
    let checkpoints = fs::read_dir(run.join("checkpoints")).unwrap().map(|entry| entry.unwrap().path());
    for file in checkpoints.chain([run.join("case.toml"), run.join(HISTORY)]) {
        fs::copy(&file, to.join(file.strip_prefix(run).unwrap())).unwrap();
    }
}

#[test]
fn a_damaged_history_ends_in_right_rows_or_a_word_about_it() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole");
    run_new(&whole, END + 50);
    let (header, right) = rows(&whole);
    let before = folder.path().join("before");
    run_new(&before, END);
    let mut random = Random(0x2545_f491_4f6c_dd1d);
    // Runs that are refused, that go on in silence, and that go on with a word.
    let mut counts = [0; 3];
    for trial in 0..240 {
        let run = folder.path().join(format!("trial{trial}"));
        copy(&before, &run);
        let victims: &[&str] = [&[HISTORY][..], &[HISTORY], &[HISTORY], &[SUMS], &[HISTORY, SUMS]][random.below(5)];
        for victim in victims {
            let text = fs::read(run.join(victim)).unwrap();
            match damaged(&text, &mut random) {
                Some(bytes) => fs::write(run.join(victim), bytes).unwrap(),
                None => fs::remove_file(run.join(victim)).unwrap(),
            }
        }
        let found = fs::read(run.join(HISTORY)).unwrap_or_default();
        let damage = match RunDirectory::open(&run) {
            Ok(resumed) => resumed.history,
            Err(Error::HistoryColumns { .. }) if victims.len() == 2 => {
                counts[0] += 1;
                continue;
            }
            Err(error) => panic!("trial {trial}: {error}"),
        };
        let told = damage.told().into_iter().chain(damage.holes(10, END)).collect::<Vec<_>>();
        let (first, left) = rows(&run);
        assert_eq!(first, header, "trial {trial}");
        for (step, row) in &left {
            let unverified = damage.unverified.contains(step) && !told.is_empty();
            assert!(unverified || right.get(step) == Some(row), "trial {trial}: step {step} is not what it was: {row}");
        }
        let missing = right.range(..END).filter(|(step, _)| !left.contains_key(step)).count();
        assert!(missing == 0 || !told.is_empty(), "trial {trial}: {missing} rows are missing without a word");
        counts[if told.is_empty() { 1 } else { 2 }] += 1;
        if *victims == [HISTORY] {
            let stayed = found.split_inclusive(|&byte| byte == b'\n').filter_map(|line| std::str::from_utf8(line).ok());
            for line in stayed.filter(|line| right.values().any(|row| line.strip_suffix('\n') == Some(row))) {
                assert!(left.values().any(|row| *row == line.trim_end()), "trial {trial}: a good row is gone: {line}");
            }
        }
        let log = fs::read_to_string(run.join("log.txt")).unwrap();
        assert!(damage.told().iter().all(|told| log.contains(told)), "trial {trial}: {told:?} is not in:\n{log}");
        if let Some(aside) = &damage.aside {
            assert!(fs::read(aside).unwrap() == found, "trial {trial}: what was found is kept");
        }
        // Whatever it was, the run goes on, and is not told of it again as far as its rows go.
        if trial % 12 == 0 {
            run_on(&run, END + 50);
            let (_, end) = rows(&run);
            assert!(end.range(END..).eq(right.range(END..)), "trial {trial}");
            let again = RunDirectory::open(&run).unwrap().history;
            assert_eq!(again.told(), Vec::<String>::new(), "trial {trial}");
        }
    }
    assert!(counts[1] > 0 && counts[2] > 150, "{counts:?}");
}

fn open(run: &Path) -> HistoryDamage {
    RunDirectory::open(run).unwrap().history
}

#[test]
fn one_wrong_digit_costs_its_row_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path();
    run_new(run, END);
    let (header, right) = rows(run);
    let found = fs::read_to_string(run.join(HISTORY)).unwrap();
    let line = &right[&70];
    let wrong = format!("{}{}", &line[..line.len() - 1], if line.ends_with('1') { '2' } else { '1' });
    fs::write(run.join(HISTORY), found.replace(line, &wrong)).unwrap();
    let damage = open(run);
    let told = damage.told();
    assert!(
        told[0].contains("line 9 (step 70) is not as written") && told[0].contains("history.damaged.csv"),
        "{told:?}"
    );
    assert!(told[1].ends_with("of steps 70"), "{told:?}");
    let (first, left) = rows(run);
    assert_eq!((first, left.len()), (header, right.len() - 1));
    assert!(left.iter().all(|(step, row)| right[step] == *row));
    assert!(fs::read_to_string(run.join("history.damaged.csv")).unwrap().contains(&wrong));
    assert_eq!(damage.holes(10, END), None);
    assert!(open(run).holes(10, END).unwrap().ends_with("of steps 70"), "a hole is told each time");
    // A second damage does not take the place of the first.
    fs::write(run.join(HISTORY), "rubbish\n").unwrap();
    let damage = open(run);
    assert_eq!(fs::read_to_string(run.join("history.damaged-2.csv")).unwrap(), "rubbish\n");
    assert!(damage.told().iter().any(|told| told.contains("lacks 39 rows")), "{:?}", damage.told());
}

#[test]
fn a_run_of_an_older_version_has_no_checksums_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    run_new(folder.path(), END);
    fs::remove_file(folder.path().join(SUMS)).unwrap();
    let right = rows(folder.path());
    let told = open(folder.path()).told();
    assert!(told.len() == 1 && told[0].contains("41 rows without a checksum, steps 0 to 400"), "{told:?}");
    assert!(rows(folder.path()) == right);
    assert_eq!(open(folder.path()).told(), Vec::<String>::new());
}

#[test]
fn a_run_whose_checkpoints_are_gone_is_not_begun_again_over_its_results() {
    let folder = tempfile::tempdir().unwrap();
    run_new(folder.path(), 100);
    fs::remove_dir_all(folder.path().join("checkpoints")).unwrap();
    let before = common::results(folder.path());
    assert!(matches!(RunDirectory::open(folder.path()), Err(Error::NoCheckpoint { damaged: 0, .. })));
    assert!(before == common::results(folder.path()));
}
