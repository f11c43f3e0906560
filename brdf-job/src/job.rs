//! The handle that functions with long work take.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use crate::{Cancel, StopCause, Stopped};

/// The state of a job, as its watcher is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress<'a> {
    /// Name of the stage that is running.
    pub stage: &'a str,
    /// Amount of this stage's work that is done, in the stage's own unit.
    pub done: u64,
    /// Amount of this stage's work in all; 0 where it is not known.
    pub total: u64,
    /// Share of the whole job that is done, [0, 1].
    pub fraction: f64,
}

/// A piece of long work: the handle by which it reports progress and learns when to stop.
///
/// A job has one stage at a time. Work of several stages is [split](Job::split) into jobs of their own, whose
/// shares of the whole are known beforehand. All methods take `&self` and may be called from several threads.
///
/// ```
/// use std::sync::atomic::{AtomicU64, Ordering};
///
/// use brdf_job::{Job, Progress};
///
/// let percent = AtomicU64::new(0);
/// let watch = |progress: &Progress<'_>| {
///     percent.store((100.0 * progress.fraction).round() as u64, Ordering::Relaxed);
/// };
/// let job = Job::watched_by(&watch);
/// let [reading, fitting] = job.split([1.0, 3.0]);
/// reading.begin("reading", 10);
/// reading.advance(10);
/// assert_eq!(percent.load(Ordering::Relaxed), 25);
/// fitting.begin("fitting", 2);
/// fitting.advance(1);
/// assert_eq!(percent.load(Ordering::Relaxed), 63);
/// ```
pub struct Job<'a> {
    watch: Option<&'a (dyn Fn(&Progress<'_>) + Sync)>,
    cancel: Option<&'a Cancel>,
    deadline: Option<Instant>,
    /// Where this job begins and ends within the whole one, both in [0, 1].
    span: [f64; 2],
    stage: Mutex<String>,
    done: AtomicU64,
    total: AtomicU64,
}

impl Default for Job<'_> {
    fn default() -> Self {
        Self::new()
    }
}

impl fmt::Debug for Job<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Job")
            .field("span", &self.span)
            .field("deadline", &self.deadline)
            .finish_non_exhaustive()
    }
}

impl<'a> Job<'a> {
    /// Returns a job that is not watched and never told to stop.
    pub fn new() -> Self {
        Self {
            watch: None,
            cancel: None,
            deadline: None,
            span: [0.0, 1.0],
            stage: Mutex::new(String::new()),
            done: AtomicU64::new(0),
            total: AtomicU64::new(0),
        }
    }

    /// Returns a job that calls `watch` with its progress, from the thread that makes the progress.
    pub fn watched_by(watch: &'a (dyn Fn(&Progress<'_>) + Sync)) -> Self {
        Self { watch: Some(watch), ..Self::new() }
    }

    /// Returns the job, to be stopped once a flag is set.
    #[must_use]
    pub fn with_cancel(self, cancel: &'a Cancel) -> Self {
        Self { cancel: Some(cancel), ..self }
    }

    /// Returns the job, to be stopped at an instant, or at its own deadline if that comes first.
    #[must_use]
    pub fn with_deadline(self, deadline: Instant) -> Self {
        let deadline = self.deadline.map_or(deadline, |own| own.min(deadline));
        Self { deadline: Some(deadline), ..self }
    }

    /// Returns the deadline, if there is one.
    pub fn deadline(&self) -> Option<Instant> {
        self.deadline
    }

    /// Returns one job for each weight: parts of this job that follow each other.
    ///
    /// Each part has a share of the whole in proportion to its weight. The parts are told to stop when this
    /// job is.
    pub fn split<const N: usize>(&self, weights: [f64; N]) -> [Job<'a>; N] {
        let parts = self.split_into(&weights);
        parts.try_into().unwrap_or_else(|_| unreachable!("one part for each weight"))
    }

    /// Returns one job for each of any number of weights, as [`Job::split`] does.
    pub fn split_into(&self, weights: &[f64]) -> Vec<Job<'a>> {
        let whole: f64 = weights.iter().sum();
        let [begin, end] = self.span;
        let place =
            |sum: f64| if whole > 0.0 { begin + (end - begin) * sum / whole } else { begin };
        let mut sum = 0.0;
        let part = |weight: &f64| {
            let from = place(sum);
            sum += weight;
            Self {
                watch: self.watch,
                cancel: self.cancel,
                deadline: self.deadline,
                span: [from, place(sum)],
                ..Self::new()
            }
        };
        weights.iter().map(part).collect()
    }

    /// Begins a stage of `total` work, in any unit; 0 if the amount is not known.
    pub fn begin(&self, stage: impl Into<String>, total: u64) {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = stage.into();
        self.done.store(0, Ordering::Relaxed);
        self.total.store(total, Ordering::Relaxed);
        self.tell(0);
    }

    /// Changes the name of the stage; the work done so far still counts.
    pub fn rename(&self, stage: impl Into<String>) {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = stage.into();
        self.tell(self.done.load(Ordering::Relaxed));
    }

    /// Adds to the work of the stage that is done.
    pub fn advance(&self, work: u64) {
        let done = self.done.fetch_add(work, Ordering::Relaxed) + work;
        self.tell(done);
    }

    fn tell(&self, done: u64) {
        let Some(watch) = self.watch else { return };
        let total = self.total.load(Ordering::Relaxed);
        let share = if total > 0 { (done as f64 / total as f64).min(1.0) } else { 0.0 };
        let [begin, end] = self.span;
        let stage = self.stage.lock().unwrap_or_else(PoisonError::into_inner).clone();
        watch(&Progress { stage: &stage, done, total, fraction: begin + share * (end - begin) });
    }

    /// Returns the cause for which the work should end now, or `None` if it may go on.
    pub fn stop_cause(&self) -> Option<StopCause> {
        if self.cancel.is_some_and(Cancel::is_cancelled) {
            return Some(StopCause::Cancelled);
        }
        let is_late = self.deadline.is_some_and(|end| Instant::now() >= end);
        is_late.then_some(StopCause::Deadline)
    }

    /// Returns whether the work should end now.
    pub fn is_stopped(&self) -> bool {
        self.stop_cause().is_some()
    }

    /// Returns an error if the work should end now, for use with `?`.
    ///
    /// # Errors
    ///
    /// [`Stopped`] if the work should end now.
    pub fn check(&self) -> Result<(), Stopped> {
        self.stop_cause().map_or(Ok(()), |cause| Err(Stopped { cause }))
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn parts_fill_the_whole_in_order() {
        let seen = Mutex::new(Vec::new());
        let watch = |p: &Progress<'_>| seen.lock().unwrap().push((p.stage.to_owned(), p.fraction));
        let job = Job::watched_by(&watch);
        let [first, second] = job.split([1.0, 3.0]);
        first.begin("first", 2);
        first.advance(2);
        let [_, inner] = second.split([1.0, 1.0]);
        inner.begin("inner", 1);
        inner.advance(1);
        let expected = [("first", 0.0), ("first", 0.25), ("inner", 0.625), ("inner", 1.0)];
        let expected = expected.map(|(stage, fraction)| (stage.to_owned(), fraction));
        assert_eq!(*seen.lock().unwrap(), expected);
    }

    #[test]
    fn parts_stop_with_the_whole() {
        let cancel = Cancel::new();
        let job = Job::new().with_cancel(&cancel);
        let [part] = job.split([1.0]);
        assert!(part.check().is_ok());
        assert!(!cancel.clone().cancel(), "not set before");
        assert_eq!(part.check(), Err(Stopped { cause: StopCause::Cancelled }));
        let now = Instant::now();
        let late = Job::new().with_deadline(now).with_deadline(now + Duration::from_secs(9));
        assert_eq!(late.stop_cause(), Some(StopCause::Deadline), "the earlier one holds");
    }
}
