//! `log.txt`: what happened to a run and when, a line each. Lines are written and read here, so that the report of a run knows
//! what the log knows.

use crate::error::{Action, Context, Error};
use crate::files;
use crate::words::{cut, plain};
use std::fmt::{self, Display};
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// Name of the log in a run.
pub(crate) const FILE: &str = "log.txt";

/// Letters of a remark.
const LONGEST: usize = 4000;

/// What happens to a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The folder was made.
    Created,
    /// A process took it up again at a checkpoint.
    Resumed {
        /// Step of the checkpoint.
        step: u64,
    },
    /// A process took it up again that found no checkpoint.
    BeganAgain,
    /// What computes it from here on: program and version, device, threads.
    Machine(String),
    /// The simulation begins.
    Begins {
        /// Step from which it goes on.
        step: u64,
        /// Step at which it shall end.
        steps: u64,
        /// Number of particles.
        particles: u64,
        /// Time step, s.
        dt: f64,
    },
    /// All steps are done.
    Finished {
        /// Their number.
        step: u64,
        /// How many of them this process did,
        done: u64,
        /// and in what time on the clock, s.
        secs: f64,
    },
    /// Somebody asked to stop, and a checkpoint was written.
    Interrupted {
        /// Its step.
        step: u64,
        /// How many steps this process did,
        done: u64,
        /// and in what time on the clock, s.
        secs: f64,
    },
    /// It could not go on.
    Failed(String),
    /// Something that should be known.
    Warning(String),
    /// The hash of a state.
    Hash {
        /// Its step.
        step: u64,
        /// 32 hexadecimal digits.
        hash: String,
    },
}

impl Display for Event {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Event::Created => f.write_str("created"),
            Event::Resumed { step } => write!(f, "resumed at step {step}"),
            Event::BeganAgain => f.write_str("resumed before the first checkpoint: begins again"),
            Event::Machine(machine) => write!(f, "computed by {}", one_line(machine)),
            Event::Begins { step, steps, particles, dt } => {
                write!(f, "goes from step {step} to {steps}: {particles} particles, steps of {dt:e} s")
            }
            Event::Finished { step, done, secs } => write!(f, "finished at step {step}: {done} steps in {secs:.3} s"),
            Event::Interrupted { step, done, secs } => {
                write!(f, "interrupted at step {step}: {done} steps in {secs:.3} s")
            }
            Event::Failed(why) => write!(f, "failed: {}", one_line(why)),
            Event::Warning(what) => write!(f, "warning: {}", one_line(what)),
            Event::Hash { step, hash } => write!(f, "hash of step {step}: {hash}"),
        }
    }
}

/// A text in one line that is not too long, with nothing in it that a terminal would obey.
fn one_line(text: &str) -> String {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    cut(&plain(&text), LONGEST).into_owned()
}

impl Event {
    /// Reads what [`Display`] writes; `None` for a line of another version.
    fn read(text: &str) -> Option<Self> {
        let words: Vec<&str> = text.split(' ').collect();
        let count = |word: &str| word.trim_end_matches(':').parse::<u64>().ok();
        Some(match words.as_slice() {
            ["created"] => Event::Created,
            ["resumed", "at", "step", step] => Event::Resumed { step: count(step)? },
            ["resumed", "before", ..] => Event::BeganAgain,
            ["computed", "by", ..] => Event::Machine(text.strip_prefix("computed by ")?.to_owned()),
            ["goes", "from", "step", step, "to", steps, particles, "particles,", "steps", "of", dt, "s"] => {
                Event::Begins {
                    step: count(step)?,
                    steps: count(steps)?,
                    particles: count(particles)?,
                    dt: dt.parse().ok()?,
                }
            }
            ["finished", "at", "step", step, done, "steps", "in", secs, "s"] => {
                Event::Finished { step: count(step)?, done: count(done)?, secs: secs.parse().ok()? }
            }
            ["interrupted", "at", "step", step, done, "steps", "in", secs, "s"] => {
                Event::Interrupted { step: count(step)?, done: count(done)?, secs: secs.parse().ok()? }
            }
            ["failed:", ..] => Event::Failed(text.strip_prefix("failed: ")?.to_owned()),
            ["warning:", ..] => Event::Warning(text.strip_prefix("warning: ")?.to_owned()),
            ["hash", "of", "step", step, hash] => Event::Hash { step: count(step)?, hash: (*hash).to_owned() },
            _ => return None,
        })
    }
}

/// Adds a line to the log of a run.
pub(crate) fn append(run: &Path, event: &Event) -> Result<(), Error> {
    let path = run.join(FILE);
    let line = format!("{} {event}\n", timestamp(SystemTime::now()));
    let mut file = files::open(&path, OpenOptions::new().append(true), true, Action::Write)?;
    file.write_all(line.as_bytes()).context(Action::Write, &path)
}

/// What the log of a run tells, with the moments; lines that cannot be read are left out, and a log that is not there is empty.
pub(crate) fn read(run: &Path) -> Vec<(String, Event)> {
    // The last line may be cut off in the middle of a letter.
    let text = fs::read(run.join(FILE)).unwrap_or_default();
    let events = String::from_utf8_lossy(&text);
    let line = |line: &str| line.split_once(' ').and_then(|(when, text)| Some((when.to_owned(), Event::read(text)?)));
    events.lines().filter_map(line).collect()
}

/// A moment as `2026-01-31T23:59:59Z`.
fn timestamp(moment: SystemTime) -> String {
    let seconds = moment.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    let (year, month, day) = date(days);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

/// Year, month and day of the Gregorian calendar, days after 1970-01-01.
///
/// Years are counted from March, so that the leap day is a year's last; 400 years have 146097 days.
fn date(days: u64) -> (u64, u64, u64) {
    let days = days + 719_468; // from 0000-03-01
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    (year, month, day)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn what_is_written_reads_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let events = [
            Event::Created,
            Event::Machine("tdem 0.1.0 on some CPU, 2 threads".into()),
            Event::Begins { step: 0, steps: 1000, particles: 8000, dt: 5.5e-5 },
            Event::Warning("the step is long".into()),
            Event::Interrupted { step: 10, done: 10, secs: 0.25 },
            Event::Resumed { step: 10 },
            Event::BeganAgain,
            Event::Failed("the disk is full: a/b".into()),
            Event::Finished { step: 1000, done: 990, secs: 12.5 },
            Event::Hash { step: 1000, hash: "00ff".into() },
        ];
        for event in &events {
            append(folder.path(), event).expect("it can be written");
        }
        let path = folder.path().join(FILE);
        let text = fs::read_to_string(&path).expect("it can be read");
        fs::write(&path, text + "2026-01-01T00:00:00Z a line of another version\n2026-01-0")
            .expect("it can be written");
        let read: Vec<Event> = read(folder.path()).into_iter().map(|(_, event)| event).collect();
        assert_eq!(read, events);
    }

    #[test]
    fn an_event_is_one_line() {
        assert_eq!(Event::Failed("a\n  b".into()).to_string(), "failed: a b");
        assert_eq!(Event::Warning("\u{1b}[31mred".into()).to_string(), "warning: \\u{1b}[31mred");
        assert!(Event::Warning("x".repeat(1 << 20)).to_string().len() < 5000);
    }

    #[test]
    fn dates_follow_the_calendar() {
        let at = |seconds| timestamp(UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(at(0), "1970-01-01T00:00:00Z");
        assert_eq!(at(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(at(951_868_799), "2000-02-29T23:59:59Z");
        assert_eq!(at(951_868_800), "2000-03-01T00:00:00Z");
        assert_eq!(at(4_102_444_799), "2099-12-31T23:59:59Z");
    }
}
