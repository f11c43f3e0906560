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
        (self.uniform.score() * self.highlight.score()).sqrt()
    }
}

/// A reflectance as the four measures of [`FidelityErrors`] see it, in the order of its fields.
///
/// ```
/// use brdf_model::MeasuredValue;
///
/// // A value of 2 sr⁻¹ under a cosine of ½, with an offset a of 0.1 sr⁻¹.
/// let value = MeasuredValue { value: 2.0, cosine: 0.5, offset: 0.1 };
/// assert!((value.measures()[0] - 2_f64.ln()).abs() < 1e-12);
/// assert!((value.slopes()[0] - 0.5 * 2.1 / 2.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredValue {
    /// f in sr⁻¹; negative ones count as 0.
    pub value: f64,
    /// c, the cosine of the angle of incidence.
    pub cosine: f64,
    /// a in sr⁻¹, above 0.
    pub offset: f64,
}

impl MeasuredValue {
    /// Returns ln(1 + f c), ∛(f c), √c f and ln(a + f).
    #[inline]
    pub fn measures(self) -> [f64; 4] {
        let (f, c) = (self.value.max(0.0), self.cosine);
        [(f * c).ln_1p(), (f * c).cbrt(), c.sqrt() * f, (self.offset + f).ln()]
    }

    /// Returns the derivatives of the measures by ln(a + f); that of the cube root, which is infinite at 0, as if f
    /// were a + f.
    #[inline]
    pub fn slopes(self) -> [f64; 4] {
        let (f, c) = (self.value.max(0.0), self.cosine);
        let shifted = self.offset + f;
        [c * shifted / (1.0 + c * f), (c * shifted).cbrt() / 3.0, c.sqrt() * shifted, 1.0]
    }
}

impl FidelityErrors {
    /// Returns the four errors, in the order of the fields.
    pub fn all(&self) -> [f64; 4] {
        [self.log_cosine, self.cube_root, self.cosine_relative, self.log]
    }

    /// Returns the geometric mean of the four errors.
    pub fn score(&self) -> f64 {
        self.all().iter().product::<f64>().powf(0.25)
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
                let measures = |value| MeasuredValue { value, cosine, offset: a }.measures();
                for ((sum, found), wanted) in squares.iter_mut().zip(measures(g)).zip(measures(f)) {
                    *sum += (found - wanted) * (found - wanted);
                }
                let f = f.max(0.0);
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
        FidelityReference::new(self, reference).measure(model)
    }
}

/// A reference at the pairs of a [`Fidelity`], evaluated once for any number of models.
#[derive(Clone, Debug)]
pub struct FidelityReference {
    uniform: ReferenceSet,
    highlight: ReferenceSet,
}

#[derive(Clone, Debug)]
struct ReferenceSet {
    pairs: Vec<DirectionPair>,
    values: Vec<Rgb>,
}

impl FidelityReference {
    /// Returns the values of a reference; pairs that it has no data for are left out.
    pub fn new(pairs: &FidelityPairs, reference: &dyn Brdf) -> Self {
        let [uniform, highlight] = [&pairs.uniform, &pairs.highlight].map(|pairs| {
            let known: Vec<_> = pairs.iter().copied().filter(|p| reference.has_data(p)).collect();
            let mut values = Vec::new();
            reference.eval_pairs(&known, &mut values);
            ReferenceSet { pairs: known, values }
        });
        Self { uniform, highlight }
    }

    /// Returns the errors of a model.
    pub fn measure(&self, model: &dyn Brdf) -> Fidelity {
        let [uniform, highlight] = [&self.uniform, &self.highlight].map(|set| {
            let mut found = Vec::new();
            model.eval_pairs(&set.pairs, &mut found);
            FidelityErrors::of(&set.pairs, &set.values, &found)
        });
        Fidelity { uniform, highlight }
    }
}
