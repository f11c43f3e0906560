//! Neural BRDFs: small networks fitted to measured materials.
//!
//! Source: A. Sztrajman, G. Rainer, T. Ritschel and T. Weyrich, "Neural BRDF Representation and
//! Importance Sampling", 2021. A network has layers of 6, 21, 21 and 3 numbers: two rectified layers,
//! then exp(·) − 1. Its input is the half vector with phi_h = 0 and the difference vector. Networks are
//! fitted to MERL cells with phi_d in [0, π), so the other half is read by reciprocity.

use brdf_param::{DirectionPair, Parametrization};

use crate::brdf::is_lit;
use crate::{Brdf, ModelError, Rgb};

const INPUTS: usize = 6;
const HIDDEN: usize = 21;
const OUTPUTS: usize = 3;

/// A BRDF as a neural network of 675 weights; isotropic, and reciprocal unless its [`NbrdfDomain`] is the whole circle.
#[derive(Clone, Debug, PartialEq)]
pub struct Nbrdf {
    domain: NbrdfDomain,
    first: Layer<INPUTS, HIDDEN>,
    second: Layer<HIDDEN, HIDDEN>,
    last: Layer<HIDDEN, OUTPUTS>,
}

/// The difference vectors that a network is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NbrdfDomain {
    /// Those with φd in [0, π), others turned there, which makes a network reciprocal: the published ones.
    HalfCircle,
    /// All, for materials that are not reciprocal.
    WholeCircle,
}

#[derive(Clone, Debug, PartialEq)]
struct Layer<const IN: usize, const OUT: usize> {
    /// `[input][output]`.
    weights: [[f32; OUT]; IN],
    biases: [f32; OUT],
}

impl<const IN: usize, const OUT: usize> Layer<IN, OUT> {
    /// Takes its weights, then its biases, from the front of `flat`.
    fn take(flat: &mut impl Iterator<Item = f32>) -> Self {
        let mut next = || flat.next().unwrap_or(0.0);
        let weights = std::array::from_fn(|_| std::array::from_fn(|_| next()));
        Self { weights, biases: std::array::from_fn(|_| next()) }
    }

    fn apply(&self, input: [f32; IN]) -> [f32; OUT] {
        let mut sum = self.biases;
        for (value, weights) in input.iter().zip(&self.weights) {
            for (sum, weight) in sum.iter_mut().zip(weights) {
                *sum += value * weight;
            }
        }
        sum
    }
}

impl Nbrdf {
    /// Number of weights in all.
    pub const WEIGHTS: usize =
        (INPUTS + 1) * HIDDEN + (HIDDEN + 1) * HIDDEN + (HIDDEN + 1) * OUTPUTS;

    /// Returns the network of these weights: for each layer the matrix `[input, output]`, row by row, then
    /// the biases.
    ///
    /// # Errors
    ///
    /// [`ModelError::TableSize`] unless there are [`Nbrdf::WEIGHTS`] of them; [`ModelError::TableValue`]
    /// for one that is not finite.
    pub fn new(weights: &[f32]) -> Result<Self, ModelError> {
        if weights.len() != Self::WEIGHTS {
            return Err(ModelError::TableSize {
                table: "neural BRDF",
                expected: Self::WEIGHTS,
                found: weights.len(),
            });
        }
        if let Some(index) = weights.iter().position(|w| !w.is_finite()) {
            return Err(ModelError::TableValue {
                table: "neural BRDF",
                index,
                value: weights[index].into(),
                expected: "finite weights",
            });
        }
        let mut flat = weights.iter().copied();
        let first = Layer::take(&mut flat);
        let second = Layer::take(&mut flat);
        let last = Layer::take(&mut flat);
        Ok(Self { domain: NbrdfDomain::HalfCircle, first, second, last })
    }

    /// Returns the same network, to be given other difference vectors; [`Nbrdf::new`] takes the half circle.
    #[must_use]
    pub fn over(self, domain: NbrdfDomain) -> Self {
        Self { domain, ..self }
    }
}

impl NbrdfDomain {
    /// Returns what a network is given for a pair: x, y and z of the half vector, turned to azimuth 0, and of the
    /// difference vector.
    pub fn input(self, pair: &DirectionPair) -> [f32; 6] {
        let [h, d] = Parametrization::HalfDifference.isotropic_hemispheres(pair);
        let is_turned = self == Self::HalfCircle && d.y < 0.0;
        let side = if is_turned { -1.0 } else { 1.0 };
        #[expect(clippy::cast_possible_truncation, reason = "the networks were trained in f32")]
        [h.x, h.y, h.z, side * d.x, side * d.y, d.z].map(|v| v as f32)
    }
}

impl Brdf for Nbrdf {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        if !is_lit(pair) {
            return Rgb::BLACK;
        }
        let input = self.domain.input(pair);
        let rectified = |layer: [f32; HIDDEN]| layer.map(|v| v.max(0.0));
        let hidden = rectified(self.second.apply(rectified(self.first.apply(input))));
        Rgb::from(self.last.apply(hidden).map(|v| f64::from(v.exp_m1().max(0.0))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_output_bias_alone_is_a_diffuser() {
        let mut weights = vec![0.0; Nbrdf::WEIGHTS];
        weights[Nbrdf::WEIGHTS - 3..].copy_from_slice(&[0.1, 0.2, 0.3]);
        let value =
            Nbrdf::new(&weights).unwrap().eval(&DirectionPair::from_angles(0.3, 1.0, 0.9, 2.0));
        assert!((value.g - f64::from(0.2_f32.exp_m1())).abs() < 1e-7, "{value:?}");
    }

    #[test]
    fn networks_are_reciprocal() {
        let weights: Vec<f32> = (0..675_u16).map(|i| (f32::from(i) * 0.7).sin() * 0.2).collect();
        let network = Nbrdf::new(&weights).unwrap();
        let pair = DirectionPair::from_angles(0.3, 1.0, 0.9, 2.7);
        let (a, b) = (network.eval(&pair).r, network.eval(&pair.swapped()).r);
        assert!((a - b).abs() < 1e-5 * (1.0 + a), "{a} against {b}");
    }

    #[test]
    fn a_network_of_the_whole_circle_need_not_be_reciprocal() {
        let weights: Vec<f32> = (0..675_u16).map(|i| (f32::from(i) * 0.7).sin() * 0.2).collect();
        let network = Nbrdf::new(&weights).unwrap();
        let pair = DirectionPair::from_angles(0.3, 1.0, 0.9, 2.7);
        let whole = network.clone().over(NbrdfDomain::WholeCircle);
        let (a, b) = (whole.eval(&pair), whole.eval(&pair.swapped()));
        let half = network.eval(&pair);
        assert!(a != b && (half == a || half == b), "{a:?}, {b:?}, {half:?}");
    }

    #[test]
    fn wrong_weights_are_refused() {
        assert!(matches!(Nbrdf::new(&[0.0; 674]), Err(ModelError::TableSize { .. })));
        let mut weights = vec![0.0; Nbrdf::WEIGHTS];
        weights[5] = f32::NAN;
        assert!(matches!(Nbrdf::new(&weights), Err(ModelError::TableValue { index: 5, .. })));
    }
}
