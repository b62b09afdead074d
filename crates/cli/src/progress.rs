//! How a run is getting on: a bar on a terminal, a line every tenth elsewhere.

use crate::console::{say, watched};
use crate::signals::{self, Signals};
use crate::units::{clock, grouped, number};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fmt::Write;
use tdem_results::{Control, Note, Observer, Progress};

/// Lines in a log, besides the first.
const LINES: u64 = 10;

/// Watches a run, and hands signals on to it.
#[derive(Debug)]
pub(crate) struct Watch<'a> {
    signals: &'a Signals,
    quiet: bool,
    bar: Option<ProgressBar>,
    tenth: Option<u64>,
    told: bool,
    latest: Option<Progress>,
}

impl<'a> Watch<'a> {
    pub(crate) fn new(signals: &'a Signals, quiet: bool) -> Self {
        let bar = (watched() && !quiet).then(bar);
        Watch { signals, quiet, bar, tenth: None, told: false, latest: None }
    }

    /// Takes the bar away and returns the last that was seen.
    pub(crate) fn finish(self) -> Option<Progress> {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        self.latest
    }

    fn show(&mut self, progress: &Progress) {
        if let Some(bar) = &self.bar {
            bar.set_length(progress.steps);
            bar.set_position(progress.step);
            bar.set_message(line(progress));
        } else if !self.quiet {
            let tenth = progress.step * LINES / progress.steps.max(1);
            if self.tenth.is_some_and(|last| last < tenth) {
                say(format!("{:>4} %  {}", 100 * progress.step / progress.steps.max(1), line(progress)));
            }
            self.tenth = Some(tenth);
        }
    }
}

impl Observer for Watch<'_> {
    fn progress(&mut self, progress: &Progress) -> Control {
        self.latest = Some(*progress);
        self.show(progress);
        let Some(signal) = self.signals.caught() else { return Control::Continue };
        if !std::mem::replace(&mut self.told, true) && !self.quiet {
            let text = format!("{}: writing a checkpoint", signals::name(signal));
            match &self.bar {
                Some(bar) => bar.suspend(|| say(text)),
                None => say(text),
            }
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
