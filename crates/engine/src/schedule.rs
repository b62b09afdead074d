//! When a run ends and when its state is wanted.

/// When a run ends and when its state is wanted, in steps. A case says it and a session keeps to it; the engine itself
/// does not look at it.
///
/// Frames, rows and pictures fall on multiples of their intervals, whenever a run was interrupted, and on the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// Total number of steps at which the run ends.
    pub steps: u64,
    /// Steps between frames; 0 is never.
    pub frame_every: u64,
    /// Steps between rows of the history; 0 is never.
    pub history_every: u64,
    /// Steps between pictures; 0 is never.
    pub picture_every: u64,
    /// Steps between checkpoints, if they shall fall on certain steps.
    pub checkpoint_every: Option<u64>,
    /// Time between checkpoints, s of wall clock; infinite is never.
    pub checkpoint_interval_secs: f64,
}

impl Default for Schedule {
    fn default() -> Self {
        Schedule {
            steps: 0,
            frame_every: 0,
            history_every: 0,
            picture_every: 0,
            checkpoint_every: None,
            checkpoint_interval_secs: 300.0,
        }
    }
}
