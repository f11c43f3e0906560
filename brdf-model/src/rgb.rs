//! Linear RGB triples.

use std::iter::Sum;
use std::ops::{Add, Div, Mul, Sub};

use serde::{Deserialize, Serialize};

/// A linear RGB colour with Rec. 709 primaries; for a BRDF value, in sr⁻¹.
///
/// Arithmetic acts on each channel.
///
/// ```
/// use brdf_model::Rgb;
///
/// let grey = (Rgb::new(1.0, 0.0, 0.0) + Rgb::new(0.0, 1.0, 1.0)) * 0.5;
/// assert_eq!(grey, Rgb::splat(0.5));
/// assert!((grey.luminance() - 0.5).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Rgb {
    /// Red channel.
    pub r: f64,
    /// Green channel.
    pub g: f64,
    /// Blue channel.
    pub b: f64,
}

impl Rgb {
    /// The colour whose channels are all zero.
    pub const BLACK: Self = Self::splat(0.0);

    /// Returns the colour of these channels.
    pub const fn new(r: f64, g: f64, b: f64) -> Self {
        Self { r, g, b }
    }

    /// Returns the grey whose channels are all `value`.
    pub const fn splat(value: f64) -> Self {
        Self::new(value, value, value)
    }

    /// Returns the channels in the order red, green, blue.
    pub const fn channels(self) -> [f64; 3] {
        [self.r, self.g, self.b]
    }

    /// Returns the Rec. 709 luminance, .2126 r + .7152 g + .0722 b.
    pub fn luminance(self) -> f64 {
        0.2126 * self.r + 0.7152 * self.g + 0.0722 * self.b
    }

    /// Returns the colour with a function applied to each channel.
    pub fn map(self, mut f: impl FnMut(f64) -> f64) -> Self {
        Self::new(f(self.r), f(self.g), f(self.b))
    }

    /// Returns the colour with a function applied to each channel and the same channel of `other`.
    pub fn zip(self, other: Self, mut f: impl FnMut(f64, f64) -> f64) -> Self {
        Self::new(f(self.r, other.r), f(self.g, other.g), f(self.b, other.b))
    }

    /// Returns the largest channel.
    pub fn max_channel(self) -> f64 {
        self.r.max(self.g).max(self.b)
    }

    /// Returns whether no channel is NaN or infinite.
    pub fn is_finite(self) -> bool {
        self.channels().iter().all(|v| v.is_finite())
    }
}

impl From<[f64; 3]> for Rgb {
    fn from([r, g, b]: [f64; 3]) -> Self {
        Self::new(r, g, b)
    }
}

impl Add for Rgb {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Rgb {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Rgb {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Mul<f64> for Rgb {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        self.map(|v| v * factor)
    }
}

impl Div<f64> for Rgb {
    type Output = Self;
    fn div(self, divisor: f64) -> Self {
        self.map(|v| v / divisor)
    }
}

impl Sum for Rgb {
    fn sum<I: Iterator<Item = Self>>(values: I) -> Self {
        values.fold(Self::BLACK, Add::add)
    }
}

/// The channels of a material that are fitted and measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Channels {
    /// Three channels: red, green and blue.
    Rgb,
    /// One channel: Rec. 709 luminance, or the only channel that was measured.
    Luminance,
}

impl Channels {
    /// Returns the number of channels, 3 or 1.
    pub fn count(self) -> usize {
        match self {
            Self::Rgb => 3,
            Self::Luminance => 1,
        }
    }
}
