//! Materials in one channel.

use brdf_param::DirectionPair;

use crate::{Brdf, Channels, Rgb};

/// A material in grey: the luminance of the inner material in all three channels.
///
/// Negative channels, which colours outside the gamut have, enter the luminance before they are clamped.
///
/// ```
/// use brdf_model::{Brdf, Luminance, Preset};
/// use brdf_param::DirectionPair;
///
/// let paint = Preset::ALL[0].brdf();
/// let pair = DirectionPair::from_angles(0.3, 0.0, 0.6, 2.0);
/// let grey = Luminance(&paint).eval(&pair);
/// assert!(grey.r == grey.b && (grey.g - paint.eval(&pair).luminance()).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Luminance<B>(pub B);

impl<B: Brdf> Brdf for Luminance<B> {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        self.eval_unclamped(pair).map(|v| v.max(0.0))
    }

    fn eval_unclamped(&self, pair: &DirectionPair) -> Rgb {
        Rgb::splat(self.0.eval_unclamped(pair).luminance())
    }

    fn has_data(&self, pair: &DirectionPair) -> bool {
        self.0.has_data(pair)
    }
}

impl Channels {
    /// Returns a material reduced to these channels: itself, or its [`Luminance`].
    pub fn of<'a>(self, brdf: &'a dyn Brdf) -> Box<dyn Brdf + 'a> {
        match self {
            Self::Rgb => Box::new(brdf),
            Self::Luminance => Box::new(Luminance(brdf)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct OutsideTheGamut;

    impl Brdf for OutsideTheGamut {
        fn eval(&self, pair: &DirectionPair) -> Rgb {
            self.eval_unclamped(pair).map(|v| v.max(0.0))
        }

        fn eval_unclamped(&self, _: &DirectionPair) -> Rgb {
            Rgb::new(-0.5, 1.0, 0.0)
        }
    }

    #[test]
    fn negative_channels_count() {
        let pair = DirectionPair::from_angles(0.1, 0.0, 0.2, 0.0);
        let grey = Channels::Luminance.of(&OutsideTheGamut).eval(&pair);
        assert!((grey.r - (0.7152 - 0.5 * 0.2126)).abs() < 1e-12, "{grey:?}");
        assert!((Channels::Rgb.of(&OutsideTheGamut).eval(&pair).g - 1.0).abs() < 1e-12);
    }
}
