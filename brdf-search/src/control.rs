//! Watching a search and stopping it.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// What a search tells whoever watches it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Terms of the models under search.
    pub terms: usize,
    /// Starts finished, and how many there are for this many terms.
    pub start: usize,
    /// How many starts there are.
    pub starts: usize,
    /// Lowest error so far with this many terms.
    pub best: f64,
    /// Linear least-squares problems solved so far.
    pub evaluations: usize,
}

/// How a search is watched and stopped. Both functions may be called from several threads.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Asked between evaluations; once it says true, the search returns its best so far.
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// Told when a start is finished.
    pub report: &'a (dyn Fn(&Progress) + Sync),
}

impl Default for Control<'_> {
    /// Never stops, tells nobody.
    fn default() -> Self {
        Self { stop: &|| false, report: &|_| () }
    }
}

impl std::fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Control").finish_non_exhaustive()
    }
}

/// Counts evaluations over a whole search, and starts over one stage of it.
#[derive(Debug)]
pub(crate) struct Monitor<'a> {
    control: Control<'a>,
    evaluations: AtomicUsize,
    terms: AtomicUsize,
    starts: AtomicUsize,
    finished: AtomicUsize,
    /// Bits of the lowest error: those of non-negative numbers are ordered as the numbers are.
    best: AtomicU64,
}

impl<'a> Monitor<'a> {
    pub(crate) fn new(control: Control<'a>) -> Self {
        Self {
            control,
            evaluations: AtomicUsize::new(0),
            terms: AtomicUsize::new(0),
            starts: AtomicUsize::new(0),
            finished: AtomicUsize::new(0),
            best: AtomicU64::new(f64::INFINITY.to_bits()),
        }
    }

    pub(crate) fn stopped(&self) -> bool {
        (self.control.stop)()
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
        let best = self.best.fetch_min(bits, Ordering::Relaxed).min(bits);
        let start = 1 + self.finished.fetch_add(1, Ordering::Relaxed);
        (self.control.report)(&Progress {
            terms: self.terms.load(Ordering::Relaxed),
            start,
            starts: self.starts.load(Ordering::Relaxed),
            best: f64::from_bits(best),
            evaluations: self.evaluations(),
        });
    }
}
