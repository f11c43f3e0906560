//! Textures over the hemisphere, read by the thousand.

use brdf_param::{HemisphereMap, Parametrization};
use brdf_separable::{HemisphereGrid, SeparableBrdf, ValueTransform};
use glam::Vec3;

use crate::error::RelightError;

/// Textures over the orthographic disc of the hemisphere. All terms and channels of a texel stand together.
#[derive(Clone, Debug, PartialEq)]
pub struct MapStack {
    resolution: usize,
    width: usize,
    texels: Vec<f32>,
    is_constant: bool,
}

impl MapStack {
    /// Returns textures of `resolution`² texels of `width` values, `[row][column][value]`.
    ///
    /// # Errors
    ///
    /// [`RelightError::Brdf`] unless there are as many finite values.
    pub fn new(resolution: usize, width: usize, texels: Vec<f32>) -> Result<Self, RelightError> {
        let is_whole = resolution > 1 && width > 0 && texels.len() == resolution.pow(2) * width;
        if !is_whole || !texels.iter().all(|v| v.is_finite()) {
            return Err(RelightError::Brdf {
                found: format!("{} values for {resolution}² texels of {width}", texels.len()),
                expected: "as many finite values as texels have",
            });
        }
        let is_constant = texels.chunks_exact(width).all(|texel| texel == &texels[..width]);
        Ok(Self { resolution, width, texels, is_constant })
    }

    /// Returns textures that have the same values in every direction.
    pub fn constant(values: &[f32]) -> Self {
        let texels = values.repeat(4);
        Self { resolution: 2, width: values.len(), texels, is_constant: true }
    }

    /// Returns the number of texels along a side.
    pub fn resolution(&self) -> usize {
        self.resolution
    }

    /// Returns the number of values of a texel.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the values of all directions where they are the same, or `None`.
    pub fn constant_values(&self) -> Option<&[f32]> {
        self.is_constant.then(|| &self.texels[..self.width])
    }

    /// Returns all values, `[row][column][value]`.
    pub fn texels(&self) -> &[f32] {
        &self.texels
    }

    /// Writes the values in a unit direction of the surface's frame, times `share`, into `out`; linear between
    /// texels.
    ///
    /// # Panics
    ///
    /// Unless `out` is as long as a texel.
    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positions are brought into the texture first"
    )]
    pub fn read(&self, local: Vec3, share: f32, out: &mut [f32]) {
        assert_eq!(out.len(), self.width, "room for a texel");
        let size = self.resolution;
        let last = (size - 1) as f32;
        let x = (0.5 * (local.x + 1.0) * size as f32 - 0.5).clamp(0.0, last);
        let y = (0.5 * (local.y + 1.0) * size as f32 - 0.5).clamp(0.0, last);
        let (column, row) = ((x as usize).min(size - 2), (y as usize).min(size - 2));
        let (u, v) = (x - column as f32, y - row as f32);
        let first = (row * size + column) * self.width;
        let above = &self.texels[first..][..2 * self.width];
        let below = &self.texels[first + size * self.width..][..2 * self.width];
        let (a, b) = above.split_at(self.width);
        let (c, d) = below.split_at(self.width);
        let (above, below) = (share * (1.0 - v), share * v);
        let [wa, wb, wc, wd] = [(1.0 - u) * above, u * above, (1.0 - u) * below, u * below];
        // Slices of one length, side by side: no bounds are left to check.
        let rows = a.iter().zip(b).zip(c.iter().zip(d));
        for (value, ((a, b), (c, d))) in out.iter_mut().zip(rows) {
            *value = (wa * a + wb * b) + (wc * c + wd * d);
        }
    }
}

/// A separable BRDF as light maps and view maps: f(wi, wo) ≈ Σ_k g_k(wi) h_k(wo).
#[derive(Clone, Debug, PartialEq)]
pub struct BrdfMaps {
    /// g_k: one value a term, or three.
    pub light: MapStack,
    /// h_k: three values a term.
    pub view: MapStack,
    /// Number of terms.
    pub terms: usize,
}

impl BrdfMaps {
    /// Returns the maps of a sum of products over light and view.
    ///
    /// # Errors
    ///
    /// [`RelightError::Brdf`] for other coordinates or value maps than [`crate::factor_for_relighting`] makes.
    pub fn of(model: &SeparableBrdf) -> Result<Self, RelightError> {
        let layout = model.layout();
        let resolution = |chart: HemisphereGrid| match chart {
            HemisphereGrid::Plane { map: HemisphereMap::OrthographicDisc, resolution } => {
                Some(resolution)
            }
            _ => None,
        };
        let is_linear = model.maps().iter().all(|map| *map == ValueTransform::Linear);
        let is_standard = layout.parametrization == Parametrization::Standard;
        let sides = resolution(layout.first).zip(resolution(layout.second));
        let (Some((light, view)), true, true) = (sides, is_linear, is_standard) else {
            return Err(RelightError::Brdf {
                found: "other coordinates or a value map".to_owned(),
                expected: "linear values over the orthographic discs of light and view",
            });
        };
        let (terms, channels) = (model.rank(), model.maps().len());
        let narrow = model.first_channels();
        // One channel stands for three.
        let widened = |texels: &[f32], signs: Option<&[f32]>| -> Vec<f32> {
            let texel = |texel: &[f32]| {
                let mut wide = vec![0.0; 3 * terms];
                for (at, value) in wide.iter_mut().enumerate() {
                    let from = if channels == 3 { at } else { at / 3 };
                    *value = texel[from] * signs.map_or(1.0, |signs| signs[from]);
                }
                wide
            };
            texels.chunks_exact(terms * channels).flat_map(texel).collect()
        };
        let view_texels = match model.second() {
            Some(texels) => widened(texels, None),
            None => widened(model.first(), model.signs()),
        };
        let light = MapStack::new(light, terms * narrow, model.first().to_vec())?;
        Self::new(light, MapStack::new(view, 3 * terms, view_texels)?, terms)
    }

    /// Returns maps of `terms` terms.
    ///
    /// # Errors
    ///
    /// [`RelightError::Brdf`] unless light maps have one or three values a term, and view maps three.
    pub fn new(light: MapStack, view: MapStack, terms: usize) -> Result<Self, RelightError> {
        let is_light = terms > 0 && [terms, 3 * terms].contains(&light.width());
        if !is_light || view.width() != 3 * terms {
            let (light, view) = (light.width(), view.width());
            return Err(RelightError::Brdf {
                found: format!("{light} and {view} values a texel for {terms} terms"),
                expected: "one or three of light and three of view for each",
            });
        }
        Ok(Self { light, view, terms })
    }

    /// Returns the maps of a diffuse surface of this albedo: one term, one light channel.
    pub fn diffuse(albedo: f32) -> Self {
        Self {
            light: MapStack::constant(&[1.0]),
            view: MapStack::constant(&[albedo / std::f32::consts::PI; 3]),
            terms: 1,
        }
    }

    /// How much a change of what a term receives changes what is seen: the RMS of its view map over the disc.
    pub(crate) fn weighted_terms(&self) -> Terms {
        let size = self.view.resolution();
        let mut sums = vec![0.0_f64; self.terms];
        for (at, texel) in self.view.texels().chunks_exact(self.view.width()).enumerate() {
            let [x, y] = [at % size, at / size].map(|at| crate::cube::middle(at, size));
            if x * x + y * y < 1.0 {
                for (sum, values) in sums.iter_mut().zip(texel.as_chunks::<3>().0) {
                    *sum += values.iter().map(|v| f64::from(*v).powi(2)).sum::<f64>();
                }
            }
        }
        let disc = std::f64::consts::FRAC_PI_4 * (size * size) as f64;
        #[expect(clippy::cast_possible_truncation, reason = "transport is f32")]
        let weights = sums.iter().map(|sum| (sum / disc).sqrt() as f32).collect();
        Terms { weights, channels: self.light_channels() }
    }

    /// Returns the number of values of a term's light map: one or three.
    pub fn light_channels(&self) -> usize {
        self.light.width() / self.terms
    }
}

/// Terms of a BRDF as transport needs them.
#[derive(Clone, Debug)]
pub(crate) struct Terms {
    /// Of each.
    pub(crate) weights: Vec<f32>,
    /// Values of each in transport: one, or three.
    pub(crate) channels: usize,
}

impl Terms {
    /// Values of all of them.
    pub(crate) fn width(&self) -> usize {
        self.weights.len() * self.channels
    }
}
