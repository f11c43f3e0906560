//! Counting what a search does and telling whoever watches it.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use brdf_job::{Job, StopCause};

/// Units of progress for each number of terms.
const UNITS: u64 = 1000;

/// Counts evaluations over a whole search, and starts over one stage of it.
#[derive(Debug)]
pub(crate) struct Monitor<'a> {
    job: &'a Job<'a>,
    evaluations: AtomicUsize,
    terms: AtomicUsize,
    starts: AtomicUsize,
    finished: AtomicUsize,
    told: AtomicU64,
    /// Bits of the lowest error: those of non-negative numbers are ordered as the numbers are.
    best: AtomicU64,
}

impl<'a> Monitor<'a> {
    /// A search for up to so many terms.
    pub(crate) fn new(job: &'a Job<'a>, terms: usize) -> Self {
        job.begin("searching", UNITS * terms as u64);
        Self {
            job,
            evaluations: AtomicUsize::new(0),
            terms: AtomicUsize::new(0),
            starts: AtomicUsize::new(0),
            finished: AtomicUsize::new(0),
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

    pub(crate) fn evaluated(&self) {
        self.evaluations.fetch_add(1, Ordering::Relaxed);
    }

    pub(crate) fn begin(&self, terms: usize, starts: usize) {
        self.terms.store(terms, Ordering::Relaxed);
        self.starts.store(starts, Ordering::Relaxed);
        self.finished.store(0, Ordering::Relaxed);
        self.best.store(f64::INFINITY.to_bits(), Ordering::Relaxed);
    }

    pub(crate) fn finished(&self, error: f64) {
        let bits = error.max(0.0).to_bits();
        let best = f64::from_bits(self.best.fetch_min(bits, Ordering::Relaxed).min(bits));
        let start = 1 + self.finished.fetch_add(1, Ordering::Relaxed);
        let (terms, starts) =
            (self.terms.load(Ordering::Relaxed), self.starts.load(Ordering::Relaxed).max(start));
        let evaluations = self.evaluations();
        self.job.rename(format!(
            "searching: term {terms}, start {start} of {starts}, error {best:.3e}, {evaluations} evaluations"
        ));
        let reached =
            UNITS * (terms as u64).saturating_sub(1) + UNITS * start as u64 / starts as u64;
        let before = self.told.fetch_max(reached, Ordering::Relaxed);
        self.job.advance(reached.saturating_sub(before));
    }
}
