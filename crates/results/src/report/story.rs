//! How a run went, from its log.

use super::html::{clock, grouped, shown};
use crate::lock;
use crate::log::{self, Event};
use std::path::Path;
use std::time::Duration;

/// What the log of a run tells.
#[derive(Debug, Default)]
pub(super) struct Story {
    /// When the folder was made.
    pub(super) created: Option<String>,
    /// When the last line was written.
    pub(super) latest: Option<String>,
    pub(super) state: State,
    /// Everything that computed it, each once.
    pub(super) machines: Vec<String>,
    /// Particles, last step, length of a step (s).
    pub(super) size: Option<(u64, u64, f64)>,
    /// Steps that were told of, and their time on the clock, s, of all processes together.
    pub(super) done: (u64, f64),
    /// Steps and hashes.
    pub(super) hash: Option<(u64, String)>,
    /// Each once, in the order in which they came up.
    pub(super) warnings: Vec<String>,
}

/// Where a run stands.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) enum State {
    /// The log does not say.
    #[default]
    Unknown,
    Finished(u64),
    Interrupted(u64),
    Failed(String),
    /// A process is at it.
    Goes,
    /// The process that was at it died.
    BrokeOff,
}

impl Story {
    pub(super) fn of(run: &Path) -> Self {
        Story::from(log::read(run), lock::is_taken(run))
    }

    fn from(events: Vec<(String, Event)>, taken: bool) -> Self {
        let mut story = Story::default();
        for (when, event) in events {
            match event {
                Event::Created => {
                    story.created = Some(when.clone());
                    story.state = State::BrokeOff;
                }
                Event::Resumed { .. } | Event::BeganAgain => story.state = State::BrokeOff,
                Event::Machine(machine) => once(&mut story.machines, machine),
                Event::Begins { steps, particles, dt, .. } => {
                    story.size = Some((particles, steps, dt));
                    story.state = State::BrokeOff;
                }
                Event::Finished { step, done, secs } => {
                    story.did(done, secs);
                    story.state = State::Finished(step);
                }
                Event::Interrupted { step, done, secs } => {
                    story.did(done, secs);
                    story.state = State::Interrupted(step);
                }
                Event::Failed(why) => story.state = State::Failed(why),
                Event::Warning(what) => once(&mut story.warnings, what),
                Event::Hash { step, hash } => story.hash = Some((step, hash)),
            }
            story.latest = Some(when);
        }
        if taken && story.state == State::BrokeOff {
            story.state = State::Goes;
        }
        story
    }

    fn did(&mut self, steps: u64, secs: f64) {
        self.done = (self.done.0 + steps, self.done.1 + secs);
    }

    /// Names and values of what the log knows.
    pub(super) fn facts(&self) -> Vec<(String, String)> {
        let mut facts = Vec::new();
        let mut add = |name: &str, value: String| facts.push((name.to_owned(), value));
        if let Some((particles, steps, dt)) = self.size {
            add("particles", grouped(particles));
            add("steps", format!("{} of {} s", grouped(steps), shown(dt, 5)));
            let (done, secs) = self.done;
            if secs > 0.0 && done > 0 {
                add("time on the clock", clock(Duration::try_from_secs_f64(secs).unwrap_or_default()));
                add("rate", format!("{} particle-steps/s", shown((particles * done) as f64 / secs, 3)));
            }
        }
        if !self.machines.is_empty() {
            add("computed by", self.machines.join("; then "));
        }
        if let Some((step, hash)) = &self.hash {
            add("hash", format!("{hash}, step {}", grouped(*step)));
        }
        if let Some(created) = &self.created {
            add("begun", created.clone());
        }
        facts
    }
}

impl State {
    /// A word for it, its class in the style sheet, and what else there is to say.
    pub(super) fn told(&self) -> (&'static str, &'static str, String) {
        let at = |step: &u64| format!("step {}", grouped(*step));
        match self {
            State::Unknown => ("unknown", "odd", "the log does not say how it went".to_owned()),
            State::Finished(step) => ("finished", "good", at(step)),
            State::Interrupted(step) => ("interrupted", "odd", format!("{}; `tdem resume` goes on", at(step))),
            State::Failed(why) => ("failed", "bad", why.clone()),
            State::Goes => ("running", "odd", "the page shows what was there when it was made".to_owned()),
            State::BrokeOff => {
                ("broken off", "bad", "its process ended without a word; `tdem resume` goes on".to_owned())
            }
        }
    }
}

fn once(list: &mut Vec<String>, text: String) {
    if !list.contains(&text) {
        list.push(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn story(events: &[Event], taken: bool) -> Story {
        Story::from(events.iter().map(|event| ("2026-01-01T00:00:00Z".to_owned(), event.clone())).collect(), taken)
    }

    #[test]
    fn a_run_stands_where_its_log_ends() {
        let begins = Event::Begins { step: 0, steps: 100, particles: 8, dt: 1e-3 };
        let told = [Event::Created, begins.clone()];
        assert_eq!(story(&told, false).state, State::BrokeOff);
        assert_eq!(story(&told, true).state, State::Goes);
        assert_eq!(story(&[], false).state, State::Unknown);
        let stopped = Event::Interrupted { step: 40, done: 40, secs: 1.0 };
        let ended = Event::Finished { step: 100, done: 60, secs: 2.0 };
        let warning = Event::Warning("the step is long".into());
        let whole =
            [&told[..], &[stopped, Event::Resumed { step: 40 }, warning.clone(), begins, warning, ended]].concat();
        let whole = story(&whole, false);
        assert_eq!((whole.state.clone(), whole.done, whole.warnings.len()), (State::Finished(100), (100, 3.0), 1));
        assert!(whole.facts().contains(&("rate".to_owned(), "266.7 particle-steps/s".replace("266.7", "267"))));
        assert_eq!(story(&[Event::Created, Event::Failed("full".into())], false).state, State::Failed("full".into()));
    }
}
