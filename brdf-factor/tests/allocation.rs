//! Solving for new values allocates nothing.

#![allow(
    clippy::unwrap_used,
    unsafe_code,
    reason = "a test; counting allocations needs an allocator"
)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use brdf_factor::{FactorParams, FactorSpec, Inversion, Plan, Preinverted, Problem};
use brdf_model::{Channels, PairSampling, Preset, SampleSet};
use glam::DVec2;

struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call goes to the system's allocator as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_repaint_does_not_allocate() {
    let sampling = PairSampling { count: 3000, seed: 1, theta_max: 1.3 };
    let samples = SampleSet::draw(&Preset::ALL[0].brdf(), &sampling, Channels::Rgb);
    let problem = Problem::new(&samples, &FactorParams::default()).unwrap();
    let places = vec![DVec2::splat(0.4); samples.len()];
    let plan = Plan::of(&FactorSpec::radial(false), 64).with_surface(16, true);
    let inverted = Preinverted::new(&problem, &places, plan, Inversion::Cholesky).unwrap();
    let mut workspace = inverted.workspace(3);
    inverted.solve(samples.values(), problem.maps(), &mut workspace);
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    inverted.solve(samples.values(), problem.maps(), &mut workspace);
    assert_eq!(ALLOCATIONS.load(Ordering::Relaxed), before);
}
