//! Painted pixels as samples of reflectance.

use std::fmt;
use std::ops::AddAssign;

use brdf_model::{Channels, Rgb, SampleSet};
use brdf_param::DirectionPair;
use glam::DVec2;
use serde::Serialize;

use crate::{PaintError, ViewBuffers};

/// A picture of a view in linear RGB with coverage.
#[derive(Clone, Debug, PartialEq)]
pub struct PaintedImage {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear red, green, blue and coverage in [0, 1], row by row from the top left.
    pub pixels: Vec<[f32; 4]>,
}

impl PaintedImage {
    /// Returns the picture divided by what a white diffuser is in it.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, reason = "pictures are f32")]
    pub fn balanced(mut self, white: [f64; 3]) -> Self {
        for pixel in &mut self.pixels {
            for (value, white) in pixel.iter_mut().zip(white) {
                *value = (f64::from(*value) / white) as f32;
            }
        }
        self
    }

    /// Returns whether a pixel counts as painted.
    pub fn is_painted(&self, pixel: usize) -> bool {
        self.pixels[pixel][3] >= COVERED
    }
}

/// Counts of pixels that give no sample, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Skipped {
    /// Pixels painted where the view shows nothing of the object.
    pub outside: usize,
    /// Pixels of the object that were left transparent.
    pub transparent: usize,
    /// Pixels lit too flat, or from behind: cosine below the least.
    pub grazing: usize,
    /// Pixels in the object's own shadow.
    pub shadowed: usize,
    /// Pixels with a value that is not a number, or infinite.
    pub not_finite: usize,
    /// Pixels of negative colours, set to 0; they do give samples.
    pub clamped: usize,
}

impl AddAssign for Skipped {
    fn add_assign(&mut self, other: Self) {
        self.outside += other.outside;
        self.transparent += other.transparent;
        self.grazing += other.grazing;
        self.shadowed += other.shadowed;
        self.not_finite += other.not_finite;
        self.clamped += other.clamped;
    }
}

impl fmt::Display for Skipped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = [
            (self.outside, "beside the object"),
            (self.transparent, "transparent"),
            (self.grazing, "lit too flat or from behind"),
            (self.shadowed, "in shadow"),
            (self.not_finite, "not finite"),
            (self.clamped, "negative, set to 0"),
        ];
        let some: Vec<String> = counts
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{count} pixels {what}"))
            .collect();
        f.write_str(if some.is_empty() { "no pixels" } else { "" })?;
        f.write_str(&some.join(", "))
    }
}

/// Pixels below this coverage are not painted.
const COVERED: f32 = 0.5;

/// Samples of reflectance from the pixels of all views. Values are f π, so that a white diffuser is 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PaintSamples {
    /// Directions to light and camera in the frame of the surface.
    pub pairs: Vec<DirectionPair>,
    /// Texture coordinates of each sample.
    pub places: Vec<DVec2>,
    /// Linear RGB, f π.
    pub values: Vec<[f32; 3]>,
    /// View and pixel that each comes from.
    pub origins: Vec<(usize, usize)>,
    /// Counts of pixels that gave no sample.
    pub skipped: Skipped,
}

/// Differences from samples over all pixels and channels, in f π.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PaintErrors {
    /// Root mean square difference.
    pub rms: f64,
    /// Largest difference.
    pub max: f64,
}

impl PaintSamples {
    /// Returns a set without samples.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds the painted pixels of a view, which `name` calls in messages.
    ///
    /// A picture shows f π cosθi times the irradiance of each pixel; pixels whose cosine is below `least_cosine` are
    /// left out.
    ///
    /// # Errors
    ///
    /// [`PaintError::Size`].
    pub fn add(
        &mut self,
        view: usize,
        name: &str,
        buffers: &ViewBuffers,
        image: &PaintedImage,
        least_cosine: f64,
    ) -> Result<(), PaintError> {
        let (width, height) = (buffers.width, buffers.height);
        if (image.width, image.height) != (width, height) {
            let (found_width, found_height) = (image.width, image.height);
            let view = name.to_owned();
            return Err(PaintError::Size { view, found_width, found_height, width, height });
        }
        for (pixel, (surface, painted)) in buffers.pixels.iter().zip(&image.pixels).enumerate() {
            let is_covered = image.is_painted(pixel);
            let Some(surface) = surface else {
                self.skipped.outside += usize::from(is_covered);
                continue;
            };
            #[expect(clippy::cast_possible_truncation, reason = "pictures are f32")]
            let value = {
                let [r, g, b, _] = *painted;
                let white = (surface.wi.z * surface.irradiance) as f32;
                [r, g, b].map(|v| v.max(0.0) / white)
            };
            let is_finite = painted.iter().chain(&value).all(|v| v.is_finite());
            let reason = if !is_covered {
                &mut self.skipped.transparent
            } else if surface.wi.z < least_cosine || surface.wo.z <= 0.0 {
                &mut self.skipped.grazing
            } else if surface.irradiance <= 0.0 {
                &mut self.skipped.shadowed
            } else if !is_finite {
                &mut self.skipped.not_finite
            } else {
                self.skipped.clamped += usize::from(painted[..3].iter().any(|v| *v < 0.0));
                self.values.push(value);
                self.pairs.push(DirectionPair::new(surface.wi, surface.wo));
                self.places.push(surface.uv);
                self.origins.push((view, pixel));
                continue;
            };
            *reason += 1;
        }
        Ok(())
    }

    /// Adds other samples behind these.
    pub fn append(&mut self, mut other: Self) {
        self.pairs.append(&mut other.pairs);
        self.places.append(&mut other.places);
        self.values.append(&mut other.values);
        self.origins.append(&mut other.origins);
        self.skipped += other.skipped;
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// Returns whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Returns about `count` of the samples, evenly from all; fewer if there are fewer.
    #[must_use]
    pub fn subset(&self, count: usize) -> Self {
        let count = count.min(self.len());
        self.chosen((0..count).map(|at| at * self.len() / count))
    }

    fn chosen(&self, order: impl Iterator<Item = usize>) -> Self {
        let mut chosen = Self { skipped: self.skipped, ..Self::new() };
        for at in order {
            chosen.pairs.push(self.pairs[at]);
            chosen.places.push(self.places[at]);
            chosen.values.push(self.values[at]);
            chosen.origins.push(self.origins[at]);
        }
        chosen
    }

    /// The same in an order whose leading parts are spread over all of them.
    pub(crate) fn shuffled(&self) -> Self {
        // Steps of the golden ratio visit all, where they share no factor with their number.
        let count = self.len().max(1);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of a count"
        )]
        let mut step = ((count as f64 * 0.618_034) as usize).max(1);
        while greatest_common_divisor(step, count) != 1 {
            step += 1;
        }
        self.chosen((0..self.len()).map(|at| at * step % count))
    }

    /// As a set of three channels, in the same order.
    pub(crate) fn as_set(&self) -> SampleSet {
        let mut set = SampleSet::new(Channels::Rgb);
        for (pair, value) in self.pairs.iter().zip(&self.values) {
            set.push_rgb(pair, Rgb::from(value.map(f64::from)));
        }
        set
    }

    /// Returns how far predicted values are from the samples.
    pub fn errors_of(&self, predicted: &[[f32; 3]]) -> PaintErrors {
        let (mut squares, mut max) = (0.0, 0.0_f64);
        for (found, wanted) in predicted.iter().flatten().zip(self.values.iter().flatten()) {
            let apart = f64::from(found - wanted).abs();
            squares += apart * apart;
            max = max.max(apart);
        }
        PaintErrors { rms: (squares / (3 * self.len()).max(1) as f64).sqrt(), max }
    }
}

fn greatest_common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}
