//! Progress on a terminal, silence elsewhere; Ctrl-C asks long work to stop.

use std::borrow::Cow;
use std::fmt::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use brdf_job::{Cancel, Job, Progress};
use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};

/// Parts of the bar.
const LENGTH: u32 = 10_000;

/// Shows the progress of a command's jobs on standard error if that is a terminal, and asks them to stop at the first
/// Ctrl-C; the second ends the program, and so does the first where no job is going on. A command has one.
pub(crate) struct Watch {
    bar: ProgressBar,
    cancel: Cancel,
    /// Whether work is going on that looks at `cancel`.
    is_watched: Arc<AtomicBool>,
}

impl Watch {
    pub(crate) fn start() -> Self {
        let bar = ProgressBar::new(LENGTH.into());
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} {bar:24} {left}") {
            bar.set_style(style.with_key("left", left));
        }
        bar.enable_steady_tick(Duration::from_millis(120));
        let cancel = Cancel::new();
        let is_watched = Arc::new(AtomicBool::new(false));
        let (flag, watched) = (cancel.clone(), Arc::clone(&is_watched));
        // Without a handler Ctrl-C simply ends the program, which leaves old outputs whole.
        let _ = ctrlc::set_handler(move || {
            if !watched.load(Ordering::SeqCst) || flag.cancel() {
                std::process::exit(130);
            }
        });
        Self { bar, cancel, is_watched }
    }

    /// Does work whose progress is shown.
    pub(crate) fn run<T>(&self, work: impl FnOnce(&Job<'_>) -> T) -> T {
        self.run_until(None, work)
    }

    /// Does work that is stopped at a deadline, if there is one.
    pub(crate) fn run_until<T>(
        &self,
        deadline: Option<Instant>,
        work: impl FnOnce(&Job<'_>) -> T,
    ) -> T {
        let show = |progress: &Progress<'_>| {
            self.bar.set_message(progress.stage.to_owned());
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share")]
            self.bar.set_position((progress.fraction * f64::from(LENGTH)) as u64);
        };
        self.is_watched.store(true, Ordering::SeqCst);
        let job = Job::watched_by(&show).with_cancel(&self.cancel);
        let done = match deadline {
            Some(deadline) => work(&job.with_deadline(deadline)),
            None => work(&job),
        };
        self.is_watched.store(false, Ordering::SeqCst);
        done
    }

    /// Does work that may print, with the progress out of its way.
    pub(crate) fn aside<T>(&self, work: impl FnOnce() -> T) -> T {
        self.bar.suspend(work)
    }

    /// Names work that does not say how far it is.
    pub(crate) fn step(&self, message: impl Into<Cow<'static, str>>) {
        self.bar.set_message(message);
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

impl Drop for Watch {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
