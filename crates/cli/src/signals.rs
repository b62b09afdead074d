//! Ctrl-C and SIGTERM: the first asks for a checkpoint and an end, the second ends at once.

use crate::render::{Report, Reports};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// What was caught so far.
#[derive(Debug)]
pub(crate) struct Signals {
    caught: Arc<AtomicUsize>,
}

impl Signals {
    /// From now on, signals are caught.
    pub(crate) fn catch() -> Result<Self, Reports> {
        Self::register()
            .map_err(|error| Report::new("tdem::cli::signals", format!("cannot catch signals: {error}")).into())
    }

    fn register() -> io::Result<Self> {
        let caught = Arc::new(AtomicUsize::new(0));
        let once = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            // In this order: the first signal finds the shutdown unarmed, and arms it.
            flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&once))?;
            flag::register(signal, Arc::clone(&once))?;
            flag::register_usize(signal, Arc::clone(&caught), signal.unsigned_abs() as usize)?;
        }
        Ok(Signals { caught })
    }

    /// The number of a signal that asks to stop.
    pub(crate) fn caught(&self) -> Option<u8> {
        u8::try_from(self.caught.load(Ordering::Relaxed)).ok().filter(|&signal| signal > 0)
    }
}

/// What a signal is called.
pub(crate) fn name(signal: u8) -> &'static str {
    if i32::from(signal) == SIGINT { "Ctrl-C" } else { "SIGTERM" }
}
