//! How a run is getting on: a bar on a terminal, a line every tenth elsewhere.

use crate::console::{say, watched};
use crate::signals::{self, Signals};
use crate::units::{clock, grouped, number};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fmt::Write;
use tdem_results::{Control, Note, Observer, Progress};

/// Lines in a log, besides the first.
const LINES: u64 = 10;

/// What shows how far something is.
#[derive(Debug)]
pub(crate) struct Meter {
    quiet: bool,
    bar: Option<ProgressBar>,
    tenth: Option<u64>,
}

impl Meter {
    pub(crate) fn new(quiet: bool) -> Self {
        Meter { quiet, bar: (watched() && !quiet).then(bar), tenth: None }
    }

    /// So many steps of all are done; the line says more.
    pub(crate) fn show(&mut self, done: u64, all: u64, line: impl FnOnce() -> String) {
        if let Some(bar) = &self.bar {
            bar.set_length(all);
            bar.set_position(done);
            bar.set_message(line());
        } else if !self.quiet {
            let tenth = done * LINES / all.max(1);
            if self.tenth.is_some_and(|last| last < tenth) {
                say(format!("{:>4} %  {}", 100 * done / all.max(1), line()));
            }
            self.tenth = Some(tenth);
        }
    }

    /// Tells something beside the bar.
    pub(crate) fn tell(&self, text: String) {
        match &self.bar {
            Some(bar) => bar.suspend(|| say(text)),
            None if self.quiet => {}
            None => say(text),
        }
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Watches a run, and hands signals on to it.
#[derive(Debug)]
pub(crate) struct Watch<'a> {
    signals: &'a Signals,
    meter: Meter,
    told: bool,
    latest: Option<Progress>,
}

impl<'a> Watch<'a> {
    pub(crate) fn new(signals: &'a Signals, quiet: bool) -> Self {
        Watch { signals, meter: Meter::new(quiet), told: false, latest: None }
    }

    /// Takes the bar away and returns the last that was seen.
    pub(crate) fn finish(self) -> Option<Progress> {
        self.meter.finish();
        self.latest
    }
}

impl Observer for Watch<'_> {
    fn progress(&mut self, progress: &Progress) -> Control {
        self.latest = Some(*progress);
        self.meter.show(progress.step, progress.steps, || line(progress));
        let Some(signal) = self.signals.caught() else { return Control::Continue };
        if !std::mem::replace(&mut self.told, true) {
            self.meter.tell(format!("{}: writing a checkpoint", signals::name(signal)));
        }
        Control::Stop
    }

    fn note(&mut self, _: &Note) {}
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{bar:20} {percent:>3} % {wide_msg}") {
        bar.set_style(style);
    }
    bar
}

/// The quantities that matter, the most wanted first: a narrow terminal cuts off the rest.
fn line(progress: &Progress) -> String {
    let mut line = String::new();
    if let Some(left) = progress.time_left.filter(|_| progress.step < progress.steps) {
        let _ = write!(line, "{} left  ", clock(left));
    }
    let _ = write!(line, "t {}/{} s  ", number(progress.time, 3), number(progress.end_time, 3));
    if progress.cundall_number > 0.0 {
        let _ = write!(line, "{} particle-steps/s  ", number(progress.cundall_number, 3));
    }
    let ledger = &progress.ledger;
    let _ = write!(line, "kinetic {} J  ", number(ledger.kinetic(), 3));
    let _ = write!(line, "unbalanced {}  ", number(ledger.unbalanced_force_ratio, 2));
    let _ = write!(line, "step {}/{}", grouped(progress.step), grouped(progress.steps));
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_has_a_style() {
        assert!(ProgressStyle::with_template("{bar:20} {percent:>3} % {wide_msg}").is_ok());
    }
}
