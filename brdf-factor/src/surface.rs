//! A factor over a surface, and products that vary over it.
//!
//! Source: Jaroszkiewicz and McCool 2003, section 4.2.

use brdf_model::{Brdf as _, Rgb};
use brdf_param::DirectionPair;
use glam::DVec2;

use crate::{ChannelTransform, FactorError, FactoredBrdf, Grid};

/// A texture of log values over the coordinates (u, v) of a surface, [0, 1]².
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceTexture {
    /// Number of texels along a side; texel (i, j) lies at (i, j) / (size − 1).
    pub size: usize,
    /// Whether the first and the last column are the same place.
    pub wraps: bool,
    /// Log values row by row from v = 0, one entry for each channel and the rest 0.
    pub texels: Vec<[f32; 4]>,
}

impl SurfaceTexture {
    /// Adds the log values at a place, which is moved to the rim if it lies outside.
    fn add_log_values(&self, uv: DVec2, sum: &mut [f64; 3]) {
        let grid = Grid::square(self.size);
        for (texel, weight) in grid.taps(2.0 * uv - DVec2::ONE).iter() {
            for (total, &value) in sum.iter_mut().zip(&self.texels[texel]) {
                *total += weight * f64::from(value);
            }
        }
    }
}

/// A product of factors over directions and, optionally, one factor over a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceProduct {
    angular: FactoredBrdf,
    surface: Option<SurfaceTexture>,
}

impl SurfaceProduct {
    /// Returns the product of these factors.
    ///
    /// # Errors
    ///
    /// [`FactorError::TextureSize`] for a size that a texture cannot have; [`FactorError::Factors`]
    /// for a surface with other than size² texels.
    pub fn new(
        angular: FactoredBrdf,
        surface: Option<SurfaceTexture>,
    ) -> Result<Self, FactorError> {
        if let Some(SurfaceTexture { size, texels, .. }) = &surface {
            let (min, max) = (*Grid::SIZES.start(), *Grid::SIZES.end());
            if !Grid::SIZES.contains(size) {
                return Err(FactorError::TextureSize { size: *size, min, max });
            }
            if texels.len() != size * size {
                return Err(FactorError::Factors {
                    found: format!("{} texels of a surface of {size}²", texels.len()),
                    expected: "size² texels",
                });
            }
            if texels.iter().flatten().any(|v| !v.is_finite()) {
                return Err(FactorError::Factors {
                    found: "a texel of a surface that is not finite".to_owned(),
                    expected: "finite log values",
                });
            }
        }
        Ok(Self { angular, surface })
    }

    /// Returns the factors over directions.
    pub fn angular(&self) -> &FactoredBrdf {
        &self.angular
    }

    /// Returns the factors over directions and drops that of the surface.
    pub fn into_angular(self) -> FactoredBrdf {
        self.angular
    }

    /// Returns the factor over the surface.
    pub fn surface(&self) -> Option<&SurfaceTexture> {
        self.surface.as_ref()
    }

    /// Returns the number of bytes of the textures as stored.
    pub fn payload_bytes(&self) -> usize {
        let surface = self.surface.as_ref().map_or(0, |surface| surface.texels.len());
        self.angular.payload_bytes() + surface * self.angular.maps().len() * 4
    }

    /// Returns f in sr⁻¹ for a pair at a place of the surface, never negative; 0 where a direction is
    /// not above the surface.
    pub fn eval(&self, pair: &DirectionPair, uv: DVec2) -> Rgb {
        self.eval_unclamped(pair, uv).map(|v| v.max(0.0))
    }

    /// Returns f in sr⁻¹ for a pair at a place of the surface, before negative results are clamped to 0.
    pub fn eval_unclamped(&self, pair: &DirectionPair, uv: DVec2) -> Rgb {
        let Some(surface) = &self.surface else { return self.angular.eval_unclamped(pair) };
        if !(pair.wi.z > 0.0 && pair.wo.z > 0.0) {
            return Rgb::BLACK;
        }
        let mut logs = self.angular.log_values(pair);
        surface.add_log_values(uv, &mut logs);
        let value = ChannelTransform::inverse;
        match self.angular.maps() {
            [map] => Rgb::splat(value(map, logs[0])),
            [r, g, b] => Rgb::new(value(r, logs[0]), value(g, logs[1]), value(b, logs[2])),
            _ => Rgb::BLACK,
        }
    }
}
