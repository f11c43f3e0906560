//! Progress on a terminal, silence elsewhere.

use std::borrow::Cow;
use std::fmt::Write;
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};

/// Steps of a command, weighted by how long they take. Draws on standard error, and only if that
/// is a terminal.
pub(crate) struct Progress(ProgressBar);

impl Progress {
    /// A bar for this much work.
    pub(crate) fn new(work: u64) -> Self {
        let bar = ProgressBar::new(work);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} {bar:24} {left}") {
            bar.set_style(style.with_key("left", left));
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

/// How long the rest takes at the mean speed so far: work is weighted, so that this settles sooner than the speed of the
/// last seconds, which the library's own estimate follows.
fn left(state: &ProgressState, out: &mut dyn Write) {
    let (done, all) = (state.pos(), state.len().unwrap_or(0));
    if done == 0 || all == 0 {
        return;
    }
    let share = all.saturating_sub(done) as f64 / done as f64;
    let left = state.elapsed().mul_f64(share);
    // Nobody is there to hear that a line could not be formatted.
    let _ = match left.as_secs() {
        0..300 => write!(out, "{} s left", left.as_secs()),
        _ => write!(out, "{} left", HumanDuration(left)),
    };
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
