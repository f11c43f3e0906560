//! Errors that follow the eye more closely than plain differences.
//!
//! Each is a root mean square, over samples and channels, of the difference of a mapped f̂ and a mapped
//! f. The approximation f̂ is clamped at 0. The errors are 0 for equal values and symmetric in f and f̂;
//! they have no unit except where one is named.

use serde::{Deserialize, Serialize};

use crate::{Brdf, SampleSet};

/// Root mean square errors of mapped reflectances, as [`perceptual_errors`] returns them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PerceptualErrors {
    /// Error of ln(1 + f cosθi). Source: Löw, Kronander, Ynnerman and Unger 2012. Scales like f for dark
    /// materials.
    pub log_cosine_rms: f64,
    /// Error of ∛(f cosθi), sr^(−1/3). Source: Fores, Ferwerda and Gu 2012. Scales with the cube root of
    /// both.
    pub cube_root_rms: f64,
    /// Error of ln(f w + ε), with w = max(cosθi cosθo, ε) and ε = 1e-3. This is the log-relative mapping
    /// of Nielsen, Jensen and Ramamoorthi 2015; its reference cancels in a difference.
    pub log_relative_rms: f64,
}

/// ε of the log-relative mapping.
const EPSILON: f64 = 1e-3;

/// Returns the perceptual errors of a model over a set of samples.
///
/// A set of one channel is compared with the model's luminance.
pub fn perceptual_errors(samples: &SampleSet, model: &dyn Brdf) -> PerceptualErrors {
    let channels = samples.values().len();
    let mut sums = [0.0; 3];
    for (index, pair) in samples.pairs().enumerate() {
        let value = model.eval(&pair);
        let predicted = if channels == 1 { [value.luminance(); 3] } else { value.channels() };
        let (cos_i, cos_o) = (pair.wi.z, pair.wo.z);
        let weight = (cos_i * cos_o).max(EPSILON);
        for (channel, values) in samples.values().iter().enumerate() {
            let off =
                |map: &dyn Fn(f64) -> f64| (map(predicted[channel]) - map(values[index])).powi(2);
            sums[0] += off(&|f| (f * cos_i).ln_1p());
            sums[1] += off(&|f| (f * cos_i).cbrt());
            sums[2] += off(&|f| (f * weight + EPSILON).ln());
        }
    }
    let count = (samples.len() * channels).max(1) as f64;
    let [log_cosine_rms, cube_root_rms, log_relative_rms] = sums.map(|sum| (sum / count).sqrt());
    PerceptualErrors { log_cosine_rms, cube_root_rms, log_relative_rms }
}
