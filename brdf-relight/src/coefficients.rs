//! Which wavelet coefficients of a transport vector are kept, and how.

use serde::{Deserialize, Serialize};

use crate::cube::TEXELS;

/// The form in which values of kept coefficients are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Coding {
    /// Red, green and blue of 11, 11 and 10 bits in a word.
    Rgb,
    /// One number of 16 bits.
    Scalar,
}

impl Coding {
    /// Returns the coding for `channels` values a coefficient: one or three.
    pub fn of(channels: usize) -> Self {
        if channels == 1 { Self::Scalar } else { Self::Rgb }
    }

    /// Returns the bytes of a stored value.
    pub fn bytes(self) -> usize {
        match self {
            Self::Rgb => 4,
            Self::Scalar => 2,
        }
    }

    /// A value of which all channels are at most `largest`, as bits; 0 for what rounds to 0.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "bits of rounded numbers"
    )]
    pub(crate) fn encode(self, value: &[f32], largest: f32) -> u32 {
        let code = |v: f32, most: f32| (v / largest * most).round().clamp(-most, most) as i32;
        match (self, value) {
            (Self::Rgb, &[r, g, b]) => {
                let [r, g, b] = [code(r, 1023.0), code(g, 1023.0), code(b, 511.0)];
                ((r as u32) << 21) | ((g as u32 & 0x7ff) << 10) | (b as u32 & 0x3ff)
            }
            _ => code(value[0], 32767.0) as u32 & 0xffff,
        }
    }

    /// Red, green and blue of a code, in units of the vector's scale.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_wrap,
        clippy::cast_possible_truncation,
        reason = "signed numbers of few bits"
    )]
    pub(crate) fn decode(self, code: u32) -> [f32; 3] {
        match self {
            Self::Rgb => {
                let word = code as i32;
                let [r, g, b] = [word >> 21, word << 11 >> 21, word << 22 >> 22];
                // Blue has a bit less.
                [r as f32, g as f32, b as f32 * (1023.0 / 511.0)]
            }
            Self::Scalar => [f32::from(code as u16 as i16); 3],
        }
    }

    /// What the largest value is in units of the scale.
    pub(crate) fn top(self) -> f32 {
        match self {
            Self::Rgb => 1023.0,
            Self::Scalar => 32767.0,
        }
    }
}

/// Buckets by the upper bits of magnitudes: sign is 0, exponent 8, and 5 of the mantissa.
const SHIFT: u32 = 18;
const BUCKETS: usize = 1 << (31 - SHIFT);

/// Scratch memory that chooses the largest of many magnitudes in linear time.
///
/// ```
/// let mut chosen = Vec::new();
/// brdf_relight::Selection::default().largest(&[0.1, 3.0, 0.0, 2.0], 2, &mut chosen);
/// assert_eq!(chosen, [1, 3]);
/// ```
#[derive(Clone, Debug)]
pub struct Selection {
    histogram: Vec<u32>,
    undecided: Vec<u32>,
}

impl Default for Selection {
    fn default() -> Self {
        Self { histogram: vec![0; BUCKETS], undecided: Vec::new() }
    }
}

impl Selection {
    /// Writes the places of the `count` largest magnitudes that are not 0 into `chosen`, in ascending order; of
    /// equal ones the first.
    ///
    /// # Panics
    ///
    /// If there are more than 2¹⁶ magnitudes.
    pub fn largest(&mut self, magnitudes: &[f32], count: usize, chosen: &mut Vec<u16>) {
        assert!(magnitudes.len() <= 1 << 16, "places have sixteen bits");
        chosen.clear();
        self.histogram.fill(0);
        for magnitude in magnitudes {
            self.histogram[(magnitude.to_bits() >> SHIFT) as usize] += 1;
        }
        // From above, the bucket in which the last place falls; bucket 0 holds zeros and what is as good.
        let (mut above, mut border) = (0, 0);
        for bucket in (1..BUCKETS).rev() {
            let more = above + self.histogram[bucket] as usize;
            if more > count {
                border = bucket;
                break;
            }
            above = more;
        }
        self.undecided.clear();
        let bucket = |at: usize| (magnitudes[at].to_bits() >> SHIFT) as usize;
        for at in 0..magnitudes.len() {
            let place = u16::try_from(at).unwrap_or(u16::MAX);
            if bucket(at) > border {
                chosen.push(place);
            } else if border > 0 && bucket(at) == border {
                self.undecided.push(place.into());
            }
        }
        let rest = count - above;
        if border == 0 || rest == 0 {
            return;
        }
        let by_size = |a: &u32, b: &u32| {
            let [x, y] = [a, b].map(|at| magnitudes[*at as usize]);
            y.total_cmp(&x).then(a.cmp(b))
        };
        self.undecided.select_nth_unstable_by(rest - 1, by_size);
        let more = self.undecided[..rest].iter();
        chosen.extend(more.map(|at| u16::try_from(*at).unwrap_or(u16::MAX)));
        chosen.sort_unstable();
    }
}

/// Sums of squares over the channels of a term, of interleaved coefficients.
pub(crate) fn magnitudes(
    coefficients: &[f32],
    width: usize,
    first: usize,
    channels: usize,
    out: &mut [f32],
) {
    debug_assert_eq!(coefficients.len(), TEXELS * width, "all faces");
    for (magnitude, values) in out.iter_mut().zip(coefficients.chunks_exact(width)) {
        *magnitude = values[first..][..channels].iter().map(|v| v * v).sum();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_largest_are_those_of_a_sort(
            values in prop::collection::vec(prop_oneof![Just(0.0_f32), Just(0.25), 0.0..1.0_f32, 1e-8..1e-3_f32], 1..400),
            count in 0_usize..100,
        ) {
            let mut chosen = Vec::new();
            Selection::default().largest(&values, count, &mut chosen);
            let mut order: Vec<usize> = (0..values.len()).filter(|at| values[*at] > 0.0).collect();
            order.sort_by(|a, b| values[*b].total_cmp(&values[*a]).then(a.cmp(b)));
            order.truncate(count);
            order.sort_unstable();
            let chosen: Vec<usize> = chosen.iter().map(|at| usize::from(*at)).collect();
            prop_assert_eq!(chosen, order);
        }

        #[test]
        fn codes_come_back_within_half_a_step(value in prop::array::uniform3(-1.0..1.0_f32)) {
            let largest = value.iter().fold(0.0_f32, |a, v| a.max(v.abs()));
            prop_assume!(largest > 1e-3);
            let back = Coding::Rgb.decode(Coding::Rgb.encode(&value, largest));
            let steps = [1023.0, 1023.0, 511.0];
            for ((value, back), steps) in value.iter().zip(back).zip(steps) {
                prop_assert!((value - back * largest / 1023.0).abs() <= 0.501 * largest / steps);
            }
            let back = Coding::Scalar.decode(Coding::Scalar.encode(&value[..1], largest))[0];
            // A step of sixteen bits is a few hundred of f32.
            prop_assert!((value[0] - back * largest / 32767.0).abs() <= 0.51 * largest / 32767.0);
        }
    }
}
