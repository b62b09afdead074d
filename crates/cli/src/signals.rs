//! Ctrl-C, SIGTERM and SIGHUP: the first asks for a checkpoint and an end, the second ends at once. Before there is
//! anything to checkpoint, the first ends at once.

use crate::codes;
use crate::render::{Report, Reports};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::flag;
use signal_hook::iterator;
use signal_hook::low_level::exit;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Some programs (`timeout`, batch systems) signal a process and then its group, so that one request arrives twice.
/// What comes so soon is no second request.
const ECHO: Duration = Duration::from_millis(500);

/// A limit on the size of files (`ulimit -f`) ends a process that does not catch its signal. Caught, it lets writing fail, which
/// is told as an error.
pub(crate) fn outlive_limits() {
    // Where the signal cannot be caught it does what it always did.
    let _ = flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
}

/// What was caught so far.
#[derive(Debug)]
pub(crate) struct Signals {
    caught: Arc<AtomicU8>,
    /// Whether a run is under way.
    running: Arc<AtomicBool>,
}

impl Signals {
    /// From now on, signals are caught. This comes before drivers of devices are loaded: some of them (PoCL) handle
    /// signals as well, and do so only once, for whoever was there before them.
    pub(crate) fn catch() -> Result<Self, Reports> {
        Self::listen().map_err(|error| Report::new(codes::SIGNALS, format!("cannot catch signals: {error}")).into())
    }

    fn listen() -> io::Result<Self> {
        let (caught, running) = (Arc::new(AtomicU8::new(0)), Arc::new(AtomicBool::new(false)));
        let mut incoming = iterator::Signals::new([SIGINT, SIGTERM])?;
        if hears_hangup() {
            incoming.add_signal(SIGHUP)?;
        }
        let (told, graceful) = (Arc::clone(&caught), Arc::clone(&running));
        thread::Builder::new().name("signals".to_owned()).spawn(move || {
            let mut first: Option<Instant> = None;
            for signal in incoming.forever() {
                match first {
                    None if !graceful.load(Ordering::Relaxed) => exit(128 + signal),
                    None => {
                        first = Some(Instant::now());
                        told.store(signal as u8, Ordering::Relaxed);
                    }
                    Some(first) if first.elapsed() > ECHO => exit(128 + signal),
                    Some(_) => {}
                }
            }
        })?;
        Ok(Signals { caught, running })
    }

    /// From now on, the first signal only asks for an end.
    pub(crate) fn defer(&self) {
        self.running.store(true, Ordering::Relaxed);
    }

    /// The number of a signal that asks to stop.
    pub(crate) fn caught(&self) -> Option<u8> {
        Some(self.caught.load(Ordering::Relaxed)).filter(|&signal| signal > 0)
    }
}

/// Whether a terminal that closes may end the run. Who starts it with `nohup` wants it to go on, and catching the signal
/// would undo that; where it cannot be known (without `/proc`), the signal keeps its meaning.
fn hears_hangup() -> bool {
    std::fs::read_to_string("/proc/self/status").is_ok_and(|status| !ignores_hangup(&status))
}

/// Whether a process of this status ignores SIGHUP: one bit per signal, in hexadecimal digits.
fn ignores_hangup(status: &str) -> bool {
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_none_or(|mask| mask >> (SIGHUP - 1) & 1 != 0)
}

/// What a signal is called.
pub(crate) fn name(signal: u8) -> &'static str {
    match i32::from(signal) {
        SIGINT => "Ctrl-C",
        SIGHUP => "SIGHUP",
        _ => "SIGTERM",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nohup_is_seen() {
        assert!(ignores_hangup("Name:\ttdem\nSigIgn:\t0000000000001001\n"));
        assert!(!ignores_hangup("Name:\ttdem\nSigIgn:\t0000000000001000\n"));
        assert!(ignores_hangup(""), "what is not known is left alone");
    }
}
