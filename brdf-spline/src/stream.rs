//! A sum of products in as few bytes as it takes: integers under an arithmetic coder.

use crate::coder::{Bit, Coder, Decoder, Encoder, Magnitudes};
use crate::opponent::from_opponent;
use crate::products::{Products, Shape};
use crate::warp::difference_angle;

/// Least share of a coefficient's function, below which steps grow no more.
const LEAST_ENVELOPE: f64 = 0.125;
/// Classes of numbers by the size of their neighbours.
const SIZES: usize = 14;

/// What integers are multiples of.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Steps {
    /// Of g: this times 2^(−exponent/4) of its term.
    pub(crate) half: f32,
    pub(crate) exponents: Vec<i8>,
    /// Of the other side, before it grows where harmonics are small.
    pub(crate) difference: f32,
}

/// A sum of products whose coefficients are multiples of steps.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Quantized {
    pub(crate) shape: Shape,
    pub(crate) steps: Steps,
    pub(crate) half: Vec<i32>,
    /// C\[term\]\[spline\]\[harmonic\]\[opponent colour\].
    pub(crate) difference: Vec<[i32; 3]>,
}

impl Steps {
    /// The step of g for each term.
    pub(crate) fn of_half(&self) -> Vec<f64> {
        let step = f64::from(self.half);
        self.exponents.iter().map(|&e| step * (-0.25 * f64::from(e)).exp2()).collect()
    }

    /// The steps of a term's coefficients over θd and φd, in their order.
    pub(crate) fn of_difference(&self, shape: &Shape) -> Vec<f64> {
        let step = f64::from(self.difference);
        let harmonics = shape.harmonics();
        (0..shape.difference.count)
            .flat_map(|j| {
                let sin = difference_angle(shape.difference.place(j)).sin();
                harmonics
                    .iter()
                    .map(move |harmonic| step / harmonic.envelope(sin).max(LEAST_ENVELOPE))
            })
            .collect()
    }
}

impl Quantized {
    /// Returns the coefficients.
    pub(crate) fn products(&self) -> Products {
        let (count, steps) = (self.shape.half.count, self.steps.of_half());
        let half = self.half.iter().enumerate().map(|(i, &v)| f64::from(v) * steps[i / count]);
        let steps = self.steps.of_difference(&self.shape);
        let difference = self.difference.iter().enumerate().map(|(i, v)| {
            from_opponent(v.map(|v| f64::from(v) * steps[i % steps.len()]), self.shape.channels)
        });
        Products {
            shape: self.shape.clone(),
            half: half.collect(),
            difference: difference.collect(),
        }
    }

    /// Returns the coded integers.
    pub(crate) fn encode(&self) -> Vec<u8> {
        let mut encoder = Encoder::new();
        let mut copy = self.clone();
        copy.code(&mut encoder);
        encoder.finish()
    }

    /// Reads integers of this shape and these steps; anything that follows the integers is not looked at.
    pub(crate) fn decode(shape: Shape, steps: Steps, bytes: &[u8]) -> Self {
        let half = vec![0; shape.terms * shape.half.count];
        let difference = vec![[0; 3]; shape.terms * shape.difference_len()];
        let mut made = Self { shape, steps, half, difference };
        made.code(&mut Decoder::new(bytes));
        made
    }

    fn code(&mut self, coder: &mut impl Coder) {
        let count = self.shape.half.count;
        let mut models = Models::default();
        for half in self.half.chunks_exact_mut(count) {
            let mut line = half.to_vec();
            models.line(coder, 0, &mut line, None);
            half.copy_from_slice(&line);
        }
        let harmonics = self.shape.harmonics();
        let splines = self.shape.difference.count;
        let length = self.shape.difference_len();
        let mut before: Vec<[Vec<i32>; 3]> = Vec::new();
        for difference in self.difference.chunks_exact_mut(length) {
            let mut lines: Vec<[Vec<i32>; 3]> = Vec::with_capacity(harmonics.len());
            for m in 0..harmonics.len() {
                let mut own: [Vec<i32>; 3] = Default::default();
                for colour in 0..self.shape.channels {
                    let at = |j: usize| j * harmonics.len() + m;
                    let mut line: Vec<i32> =
                        (0..splines).map(|j| difference[at(j)][colour]).collect();
                    let above = match m.checked_sub(1) {
                        Some(above) => lines.get(above),
                        None => before.first(),
                    };
                    let above = above.map(|lines| &lines[colour][..]);
                    let kind = 1 + usize::from(colour > 0);
                    own[colour] = models.line(coder, kind, &mut line, above);
                    for (j, value) in line.into_iter().enumerate() {
                        difference[at(j)][colour] = value;
                    }
                }
                lines.push(own);
            }
            before = lines;
        }
    }
}

/// How a number is guessed from those before it in its line.
const GUESSES: usize = 3;

fn guess(kind: usize, line: &[i32]) -> i32 {
    match (kind, line) {
        (1 | 2, [last]) | (1, [.., last]) => *last,
        (2, [.., before, last]) => last.saturating_mul(2).saturating_sub(*before),
        _ => 0,
    }
}

/// Models of what was coded so far.
struct Models {
    /// For g, means and differences of colours; by size of neighbours.
    magnitudes: [[Magnitudes; SIZES]; 3],
    guesses: [[Bit; 2]; 3],
}

impl Default for Models {
    fn default() -> Self {
        Self { magnitudes: [[Magnitudes::default(); SIZES]; 3], guesses: [[Bit::default(); 2]; 3] }
    }
}

impl Models {
    /// Codes a line of numbers and returns what was left after guessing them.
    fn line(
        &mut self,
        coder: &mut impl Coder,
        kind: usize,
        line: &mut [i32],
        above: Option<&[i32]>,
    ) -> Vec<i32> {
        let cheapest = (0..GUESSES).min_by_key(|&guessing| {
            let rests =
                (0..line.len()).map(|i| line[i].saturating_sub(guess(guessing, &line[..i])));
            rests
                .map(|rest| u64::from(u32::BITS - rest.unsigned_abs().leading_zeros()))
                .sum::<u64>()
        });
        let wanted = cheapest.unwrap_or(0);
        let bits = &mut self.guesses[kind];
        let guessing = if coder.code(&mut bits[0], wanted > 0) {
            1 + usize::from(coder.code(&mut bits[1], wanted > 1))
        } else {
            0
        };
        let mut rests: Vec<i32> = Vec::with_capacity(line.len());
        for i in 0..line.len() {
            let guessed = guess(guessing, &line[..i]);
            let size = size(&rests, above, i);
            let rest = line[i].saturating_sub(guessed);
            let rest = self.magnitudes[kind][size].code(coder, rest);
            line[i] = guessed.saturating_add(rest);
            rests.push(rest);
        }
        rests
    }
}

/// The class of a number by what its neighbours are: those before it, and those beside it in the line above.
fn size(rests: &[i32], above: Option<&[i32]>, at: usize) -> usize {
    let of = |value: Option<&i32>, weight: u64| {
        value.map(|v| (weight * u64::from(v.unsigned_abs()), weight))
    };
    let found = [
        of(rests.last(), 3),
        of(rests.len().checked_sub(2).and_then(|i| rests.get(i)), 1),
        of(above.and_then(|line| line.get(at)), 3),
        of(above.and_then(|line| line.get(at + 1)), 1),
    ];
    let (sum, weight) =
        found.into_iter().flatten().fold((0, 0), |(a, b), (value, weight)| (a + value, b + weight));
    if weight == 0 {
        return SIZES - 1;
    }
    let mean = 2 * sum / weight;
    ((u64::BITS - mean.leading_zeros()) as usize).min(SIZES - 2)
}
