//! Coefficients as integers, in steps as fine as a number of bytes allows.

use brdf_model::GgxLobes;

use crate::alternating::Alternating;
use crate::channel::Channel;
use crate::model::stream;
use crate::stream::{Quantized, Steps};

/// Steps of g beside those of the other side, both seen in y.
const HALF_STEP: f64 = 0.7;
/// Finest step of the other side: finer ones lower no error, and integers would end before coefficients do.
const FINEST: f64 = 1e-5;
/// Times that g is rounded, in steps that follow from those found before.
const ROUNDS: usize = 2;
/// Times that the range of steps is halved.
const HALVINGS: usize = 8;

/// Rounds coefficients as finely as the bytes allow.
pub(crate) fn quantize(
    fit: &mut Alternating<'_>,
    channels: &[Channel],
    base: Option<&GgxLobes>,
    bytes: usize,
) -> Quantized {
    let start = fit.sides();
    let shape = fit.shape().clone();
    let exponents: Vec<i8> =
        fit.term_sizes().iter().map(|size| exponent(size / HALF_STEP)).collect();
    let mut guess = 2e-3;
    let mut found = None;
    for round in 0..ROUNDS {
        fit.reset(&start);
        let mut steps =
            Steps { half: narrow(guess), exponents: exponents.clone(), difference: narrow(guess) };
        let half = fit.round_half(&fit.half_equations(), &steps.of_half());
        let equations = fit.difference_equations();
        let factor: f64 = if round == 0 { 500.0 } else { 3.0 };
        let (mut low, mut high) = ((guess / factor).max(FINEST).ln(), (guess * factor).ln());
        let mut fits = None;
        for halving in 0..HALVINGS + 8 {
            let middle = if halving < HALVINGS { 0.5 * (low + high) } else { high };
            steps.difference = narrow(middle.exp());
            let colours = fit.round_difference(&equations, &steps.of_difference(&shape));
            let made = Quantized {
                shape: shape.clone(),
                steps: steps.clone(),
                half: half.clone(),
                difference: together(&colours),
            };
            if stream(&made, channels, base).len() <= bytes {
                (high, fits) = (middle, Some(made));
            } else if halving < HALVINGS {
                low = middle;
            } else {
                // Even the coarsest so far takes too many bytes.
                high += 0.7;
            }
            if halving + 1 >= HALVINGS && fits.is_some() {
                break;
            }
        }
        guess = high.exp();
        found = fits.or(found);
    }
    found.unwrap_or_else(|| {
        let difference = vec![[0; 3]; shape.terms * shape.difference_len()];
        let half = vec![0; shape.terms * shape.half.count];
        Quantized {
            shape,
            steps: Steps { half: 1.0, exponents, difference: 1.0 },
            half,
            difference,
        }
    })
}

/// The colours of each coefficient, from the coefficients of each colour.
fn together(colours: &[Vec<i32>]) -> Vec<[i32; 3]> {
    let at = |index: usize| {
        std::array::from_fn(|colour| colours.get(colour).map_or(0, |own| own[index]))
    };
    (0..colours[0].len()).map(at).collect()
}

/// The exponent of steps for terms of a size.
#[expect(clippy::cast_possible_truncation, reason = "within the range of an i8")]
fn exponent(size: f64) -> i8 {
    (4.0 * size.max(1e-30).log2()).round().clamp(-127.0, 127.0) as i8
}

#[expect(clippy::cast_possible_truncation, reason = "what stands in a stream is f32")]
fn narrow(value: f64) -> f32 {
    value as f32
}
