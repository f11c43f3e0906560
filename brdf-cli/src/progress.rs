//! Progress on a terminal, silence elsewhere.

use std::borrow::Cow;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Steps of a command, weighted by how long they take. Draws on standard error, and only if that
/// is a terminal.
pub(crate) struct Progress(ProgressBar);

impl Progress {
    /// A bar for this much work.
    pub(crate) fn new(work: u64) -> Self {
        let bar = ProgressBar::new(work);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} {bar:24} {eta} left") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(120));
        Self(bar)
    }

    /// Names the step that begins.
    pub(crate) fn step(&self, message: impl Into<Cow<'static, str>>) {
        self.0.set_message(message);
    }

    /// Work that is done.
    pub(crate) fn done(&self, work: u64) {
        self.0.inc(work);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
