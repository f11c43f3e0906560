//! Counting what a search does and telling whoever watches it.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use brdf_job::{Job, StopCause};

/// Steps of the progress of a search.
const UNITS: u64 = 10_000;

/// A stage of a search, as it is planned: how many evaluations it should take, and how long one takes
/// relative to those of other stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stage {
    /// What is done, and how many projections the sets have.
    pub(crate) part: &'static str,
    pub(crate) terms: usize,
    pub(crate) evaluations: f64,
    pub(crate) cost: f64,
}

impl Stage {
    fn work(&self) -> f64 {
        self.evaluations * self.cost
    }
}

/// Counts the evaluations of a search, stage by stage.
///
/// The share of the search that is done is measured in planned work. A stage that takes more than was
/// planned waits at its end, and one that takes less jumps there, so that the share never falls.
#[derive(Debug)]
pub(crate) struct Monitor<'a> {
    job: &'a Job<'a>,
    plan: Vec<Stage>,
    /// Index of the stage that is under way, and the number of evaluations when it began.
    stage: AtomicUsize,
    before: AtomicUsize,
    evaluations: AtomicUsize,
    /// Units told to the job.
    told: AtomicU64,
    /// Bits of the lowest error: those of non-negative numbers are ordered as the numbers are.
    best: AtomicU64,
}

impl<'a> Monitor<'a> {
    /// A search with this plan, whose first stage begins.
    pub(crate) fn new(job: &'a Job<'a>, plan: Vec<Stage>) -> Self {
        job.begin("searching", UNITS);
        Self {
            job,
            plan,
            stage: AtomicUsize::new(0),
            before: AtomicUsize::new(0),
            evaluations: AtomicUsize::new(0),
            told: AtomicU64::new(0),
            best: AtomicU64::new(f64::INFINITY.to_bits()),
        }
    }

    pub(crate) fn stopped(&self) -> bool {
        self.job.is_stopped()
    }

    pub(crate) fn stop_cause(&self) -> Option<StopCause> {
        self.job.stop_cause()
    }

    pub(crate) fn evaluations(&self) -> usize {
        self.evaluations.load(Ordering::Relaxed)
    }

    /// Begins a stage of the plan. Those before it are done.
    pub(crate) fn begin(&self, part: &str, terms: usize) {
        let is_this = |stage: &Stage| stage.part == part && stage.terms == terms;
        let Some(stage) = self.plan.iter().position(is_this) else { return };
        self.stage.store(stage, Ordering::Relaxed);
        self.before.store(self.evaluations(), Ordering::Relaxed);
        self.best.store(f64::INFINITY.to_bits(), Ordering::Relaxed);
        self.tell();
    }

    /// Counts a least-squares problem that was solved.
    pub(crate) fn evaluated(&self) {
        self.evaluations.fetch_add(1, Ordering::Relaxed);
        self.tell();
    }

    /// Takes note of the error that a start ended with.
    pub(crate) fn finished(&self, error: f64) {
        self.best.fetch_min(error.max(0.0).to_bits(), Ordering::Relaxed);
    }

    /// Ends the search: whatever was planned is done, or will not be.
    pub(crate) fn end(&self) {
        self.stage.store(self.plan.len(), Ordering::Relaxed);
        self.advance_to(UNITS);
    }

    fn tell(&self) {
        let index = self.stage.load(Ordering::Relaxed);
        let Some(stage) = self.plan.get(index) else { return };
        let (evaluations, before) = (self.evaluations(), self.before.load(Ordering::Relaxed));
        let here = evaluations.saturating_sub(before) as f64;
        let all: f64 = self.plan.iter().map(Stage::work).sum();
        let past: f64 = self.plan[..index].iter().map(Stage::work).sum();
        let share = (past + stage.cost * here.min(stage.evaluations)) / all;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in [0, 1]")]
        self.advance_to((share * UNITS as f64) as u64);
        // What is still planned follows what is known; a plan that was wrong so far is corrected.
        let ahead: f64 = self.plan[index + 1..].iter().map(|stage| stage.evaluations).sum();
        let expected = before as f64 + stage.evaluations.max(here) + ahead;
        let best = f64::from_bits(self.best.load(Ordering::Relaxed));
        let error = if best.is_finite() { format!(", error {best:.2e}") } else { String::new() };
        let plural = if stage.terms == 1 { "" } else { "s" };
        self.job.rename(format!(
            "searching: {} {} projection{plural}, {evaluations} of about {expected:.0} evaluations{error}",
            stage.part, stage.terms
        ));
    }

    fn advance_to(&self, units: u64) {
        let before = self.told.fetch_max(units, Ordering::Relaxed);
        if units > before {
            self.job.advance(units - before);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use brdf_job::Progress;

    use super::*;

    #[test]
    fn the_share_never_falls_and_the_total_follows_what_happens() {
        let seen = Mutex::new(Vec::new());
        let watch = |progress: &Progress<'_>| {
            seen.lock().unwrap().push((progress.fraction, progress.stage.to_owned()));
        };
        let job = Job::watched_by(&watch);
        let stage = |terms, evaluations, cost| Stage { part: "moving", terms, evaluations, cost };
        let monitor = Monitor::new(&job, vec![stage(1, 10.0, 1.0), stage(2, 10.0, 9.0)]);
        monitor.begin("moving", 1);
        // Fewer than planned, then more.
        (0..5).for_each(|_| monitor.evaluated());
        monitor.finished(0.25);
        monitor.begin("moving", 2);
        (0..15).for_each(|_| monitor.evaluated());
        monitor.end();
        let seen = seen.into_inner().unwrap();
        assert!(seen.is_sorted_by(|a, b| a.0 <= b.0), "{seen:?}");
        let at = |text: &str| seen.iter().find(|(_, stage)| stage.contains(text)).unwrap().0;
        assert!((at("1 projection, 5 of about 20 ") - 0.05).abs() < 1e-4);
        assert!((at("2 projections, 5 of about 15 ") - 0.1).abs() < 1e-4);
        assert!((at("2 projections, 10 of about 15 ") - 0.55).abs() < 1e-4);
        assert!((at("2 projections, 20 of about 20 ") - 1.0).abs() < 1e-9);
        assert!(seen.iter().all(|(_, stage)| !stage.contains("error")), "of one projection");
        assert!((seen.last().unwrap().0 - 1.0).abs() < 1e-9);
    }
}
