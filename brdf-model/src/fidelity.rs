//! How faithful a small model is, away from the highlight and in it.
//!
//! Pairs that are uniform over two hemispheres hardly see gloss: one in a thousand lies within 2° of the
//! mirror direction. So errors are taken over two sets of pairs, and by measures that weigh values
//! differently: displays, cube roots, energy, logarithms.

use brdf_param::DirectionPair;
use serde::{Deserialize, Serialize};

use crate::{Brdf, PairSampling, Rgb};

/// Number of pairs of each set of a [`Fidelity`].
pub const FIDELITY_PAIRS: u32 = 20_000;

/// Errors of a model over one set of pairs, root mean squares over pairs and channels.
///
/// c is the cosine of the angle of incidence, f the reference, f̂ the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FidelityErrors {
    /// Of ln(1 + f̂ c) − ln(1 + f c).
    pub log_cosine: f64,
    /// Of ∛(f̂ c) − ∛(f c).
    pub cube_root: f64,
    /// √(Σ c (f̂ − f)² / Σ c f²).
    pub cosine_relative: f64,
    /// Of ln(a + f̂) − ln(a + f), where a is 1e-5 of the mean of each channel.
    pub log: f64,
}

/// Errors of a model over pairs of directions that are uniform, and over pairs half of which are around
/// the mirror direction.
///
/// ```
/// use brdf_model::{FidelityPairs, Preset};
///
/// let brdf = |name| Preset::find(name).expect("a preset of this crate").brdf();
/// let pairs = FidelityPairs::new(1, 80_f64.to_radians());
/// let [gold, grey] = ["ggx", "lambert"].map(brdf);
/// let same = pairs.measure(&gold, &gold);
/// let other = pairs.measure(&gold, &grey);
/// assert!(same.score() == 0.0 && other.score() > 0.1);
/// assert!(other.highlight.log_cosine > other.uniform.log_cosine);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fidelity {
    /// Over uniform pairs.
    pub uniform: FidelityErrors,
    /// Over pairs half of which are around the mirror direction.
    pub highlight: FidelityErrors,
}

impl Fidelity {
    /// Returns the geometric mean J of the eight errors.
    pub fn score(&self) -> f64 {
        let errors = [self.uniform, self.highlight].map(|e| e.all());
        let product: f64 = errors.as_flattened().iter().product();
        product.powf(1.0 / 8.0)
    }
}

impl FidelityErrors {
    /// Returns the four errors, in the order of the fields.
    pub fn all(&self) -> [f64; 4] {
        [self.log_cosine, self.cube_root, self.cosine_relative, self.log]
    }

    /// Returns the errors of values beside reference values at the same pairs; 0 without pairs.
    pub fn of(pairs: &[DirectionPair], reference: &[Rgb], model: &[Rgb]) -> Self {
        let count = pairs.len().max(1) as f64;
        let sum = reference.iter().fold([0.0; 3], |sum, f| {
            let f = f.channels();
            std::array::from_fn(|c| sum[c] + f[c].max(0.0))
        });
        let offsets = sum.map(|sum| if sum > 0.0 { 1e-5 * sum / count } else { 1e-5 });
        let (mut squares, mut energy) = ([0.0; 4], 0.0);
        for ((pair, reference), model) in pairs.iter().zip(reference).zip(model) {
            let cosine = pair.wi.z;
            let values = reference.channels().into_iter().zip(model.channels()).zip(offsets);
            for ((f, g), a) in values {
                let (f, g) = (f.max(0.0), g.max(0.0));
                let differences = [
                    (g * cosine).ln_1p() - (f * cosine).ln_1p(),
                    (g * cosine).cbrt() - (f * cosine).cbrt(),
                    cosine.sqrt() * (g - f),
                    ((a + g) / (a + f)).ln(),
                ];
                for (sum, difference) in squares.iter_mut().zip(differences) {
                    *sum += difference * difference;
                }
                energy += cosine * f * f;
            }
        }
        let mean = |square: f64| (square / (3.0 * count)).sqrt();
        Self {
            log_cosine: mean(squares[0]),
            cube_root: mean(squares[1]),
            cosine_relative: if energy > 0.0 { (squares[2] / energy).sqrt() } else { 0.0 },
            log: mean(squares[3]),
        }
    }
}

/// The two sets of pairs of a [`Fidelity`].
#[derive(Clone, Debug)]
pub struct FidelityPairs {
    uniform: Vec<DirectionPair>,
    highlight: Vec<DirectionPair>,
}

impl FidelityPairs {
    /// Returns [`FIDELITY_PAIRS`] pairs of each set (a few less in the second), within an angle to the normal,
    /// in radians.
    pub fn new(seed: u64, theta_max: f64) -> Self {
        let sampling = PairSampling { count: FIDELITY_PAIRS, seed, theta_max };
        let half =
            PairSampling { count: FIDELITY_PAIRS / 2, seed: seed ^ 0x6d69_7272_6f72, theta_max };
        let highlight = half.pairs().chain(half.highlight_pairs()).collect();
        Self { uniform: sampling.pairs().collect(), highlight }
    }

    /// Returns the errors of a model; pairs that the reference has no data for are left out.
    pub fn measure(&self, reference: &dyn Brdf, model: &dyn Brdf) -> Fidelity {
        let [uniform, highlight] = [&self.uniform, &self.highlight].map(|pairs| {
            let known: Vec<_> = pairs.iter().copied().filter(|p| reference.has_data(p)).collect();
            let (mut expected, mut found) = (Vec::new(), Vec::new());
            reference.eval_pairs(&known, &mut expected);
            model.eval_pairs(&known, &mut found);
            FidelityErrors::of(&known, &expected, &found)
        });
        Fidelity { uniform, highlight }
    }
}
