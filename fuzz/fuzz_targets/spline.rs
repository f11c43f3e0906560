//! Streams of splines: a model or an error, and values of what is a model.
#![no_main]

use brdf_model::Brdf as _;
use brdf_param::DirectionPair;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    if let Ok(model) = brdf_spline::SplineBrdf::from_bytes(data) {
        let _ = model.eval(&DirectionPair::from_angles(0.5, 0.0, 0.6, 2.0));
    }
});
