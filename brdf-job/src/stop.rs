//! Flags, causes and errors of work that is stopped early.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that asks jobs to stop. It can be set from any thread or from a signal handler.
///
/// Clones are the same flag.
///
/// ```
/// use brdf_job::{Cancel, Job, StopCause};
///
/// let cancel = Cancel::new();
/// let job = Job::new().with_cancel(&cancel);
/// assert!(!job.is_stopped());
/// cancel.clone().cancel();
/// assert_eq!(job.stop_cause(), Some(StopCause::Cancelled));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// Returns a flag that is not set.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the flag and returns whether it was set before.
    pub fn cancel(&self) -> bool {
        self.0.swap(true, Ordering::SeqCst)
    }

    /// Returns whether the flag is set.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// The cause for which work ended early.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StopCause {
    /// By a [`Cancel`] flag that was set.
    Cancelled,
    /// By a deadline that passed.
    Deadline,
}

impl StopCause {
    /// Returns the name of the cause in records: `interrupted` or `time limit`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cancelled => "interrupted",
            Self::Deadline => "time limit",
        }
    }
}

impl fmt::Display for StopCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The error of work that was stopped before it had a result worth keeping.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopped {
    /// Cause for which the work was stopped.
    pub cause: StopCause,
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "stopped before the end ({})", self.cause)
    }
}

impl std::error::Error for Stopped {}
