//! A BRDF as a product of textures.
//!
//! A value is the sum of the factors' log values, each bilinear between texels, brought back by the
//! inverse of the log map.

use brdf_model::{Brdf as _, Channels};
use brdf_param::{Bound, DirectionPair, DiscRadii};
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::coordinate::PairPlace;
use crate::gauge::balanced;
use crate::texels::{Coding, StoredTexels, TexelFormat};
use crate::{Axis, ChannelTransform, Coordinate, FactorError, Grid};

/// The description of a factor: everything but its texels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FactorDescription {
    /// The coordinates that read the texture.
    pub coordinates: Vec<Coordinate>,
    /// The grid of texels.
    pub grid: Grid,
    /// The bound by which the image of the coordinates was fitted into the texture.
    pub bound: Bound,
    /// Largest radii of the coordinates over the training samples, in parabolic units; largest angles of isotropic
    /// coordinates, in radians.
    pub radii: DiscRadii,
    /// The extent that coordinates are divided by to give texture coordinates.
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 2]"))]
    pub extent: DVec2,
}

impl FactorDescription {
    /// Returns a description with this grid, scaled to coordinates of these radii.
    ///
    /// # Errors
    ///
    /// As [`FactorDescription::check`].
    pub fn new(
        coordinates: &[Coordinate],
        grid: Grid,
        bound: Bound,
        radii: DiscRadii,
    ) -> Result<Self, FactorError> {
        let extent = coordinates
            .iter()
            .map(|coordinate| coordinate.extent(bound, radii))
            .fold(DVec2::splat(f64::MIN_POSITIVE), DVec2::max);
        let description = Self { coordinates: coordinates.to_vec(), grid, bound, radii, extent };
        description.check()?;
        Ok(description)
    }

    /// The texels that stand for one place, group by group.
    pub(crate) fn joined_texels(&self) -> Vec<Vec<usize>> {
        // Conjugates have the same.
        self.coordinates.first().map_or_else(Vec::new, |c| c.joined_texels(self.grid))
    }

    /// Checks that the parts fit together.
    ///
    /// # Errors
    ///
    /// [`FactorError::TextureSize`] for a size outside [`Grid::SIZES`]; [`FactorError::Factors`]
    /// unless there are coordinates, all of the grid's dimension, with spacings in range, and radii and extent are
    /// positive and finite.
    pub fn check(&self) -> Result<(), FactorError> {
        let Grid { columns, rows } = self.grid;
        let sides = [columns, if rows == 1 { columns } else { rows }];
        if let Some(&size) = sides.iter().find(|size| !Grid::SIZES.contains(size)) {
            let (min, max) = (*Grid::SIZES.start(), *Grid::SIZES.end());
            return Err(FactorError::TextureSize { size, min, max });
        }
        let refuse =
            |found: &str, expected| Err(FactorError::Factors { found: found.to_owned(), expected });
        if self.coordinates.is_empty() {
            return refuse("a factor without coordinates", "at least one");
        }
        if self.coordinates.iter().any(|c| c.dimensions() != self.grid.dimensions()) {
            return refuse(
                "a texture whose coordinates have other dimensions than its grid",
                "coordinates and grid of the same dimension",
            );
        }
        let axes = self.coordinates.iter().filter_map(|coordinate| match coordinate {
            Coordinate::Isotropic { axes, .. } => Some(axes),
            _ => None,
        });
        if let Some(expected) = axes.flatten().find_map(Axis::fault) {
            return refuse("an axis whose texels cannot be spaced so", expected);
        }
        let scales = [self.radii.first, self.radii.second, self.extent.x, self.extent.y];
        if !scales.iter().all(|s| s.is_finite() && *s > 0.0) {
            return refuse("a radius or extent that is not positive", "positive finite numbers");
        }
        Ok(())
    }
}

/// A factor: one texture of log values and the coordinates that read it.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    description: FactorDescription,
    /// Log values, row by row; channels beyond the model's own are 0.
    texels: Vec<[f32; 4]>,
    /// How they are stored, without loss.
    coding: Coding,
}

impl Factor {
    /// Returns a factor with these texels, or with texels that are all 0.
    ///
    /// # Errors
    ///
    /// As [`FactorDescription::check`] and [`Factor::set_texels`].
    pub fn new(
        description: FactorDescription,
        texels: Option<Vec<[f32; 4]>>,
    ) -> Result<Self, FactorError> {
        description.check()?;
        let count = description.grid.texels();
        let mut factor = Self { description, texels: Vec::new(), coding: Coding::F32 };
        factor.set_texels(texels.unwrap_or_else(|| vec![[0.0; 4]; count]))?;
        Ok(factor)
    }

    /// Returns the description: everything but the texels.
    pub fn description(&self) -> &FactorDescription {
        &self.description
    }

    /// Returns the coordinates that read the texture.
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.description.coordinates
    }

    /// Returns the grid of texels.
    pub fn grid(&self) -> Grid {
        self.description.grid
    }

    /// Returns the extent that coordinates are divided by to give texture coordinates.
    pub fn extent(&self) -> DVec2 {
        self.description.extent
    }

    /// Returns the log values row by row, one entry for each channel and the rest 0.
    ///
    /// Texels outside the mask hold the mean of their nearest neighbours inside.
    pub fn texels(&self) -> &[[f32; 4]] {
        &self.texels
    }

    /// Returns the factor of texels as a file holds them, `channels` for each place in the grid.
    ///
    /// # Errors
    ///
    /// As [`Factor::new`]; [`FactorError::Factors`] for ranges that are missing, too many, not finite or turned round.
    pub fn from_stored(
        description: FactorDescription,
        stored: &StoredTexels,
        channels: usize,
    ) -> Result<Self, FactorError> {
        let (texels, coding) = stored.read(channels).ok_or_else(|| FactorError::Factors {
            found: format!(
                "texels in {} of {channels} channels with ranges {:?}",
                stored.format.name(),
                stored.ranges
            ),
            expected: "of u8 a smallest and a largest value for each channel, of others none",
        })?;
        Ok(Self { coding, ..Self::new(description, Some(texels))? })
    }

    /// Returns the first `channels` of the texels as a file holds them: [`Factor::from_stored`] gives the same again.
    pub fn stored(&self, channels: usize) -> StoredTexels {
        StoredTexels::of(&self.texels, &self.coding, channels)
    }

    /// Returns how the texels are stored.
    pub fn format(&self) -> TexelFormat {
        self.coding.format()
    }

    /// Returns the factor with these texels, rounded to a format.
    fn with_rounded(&self, texels: &[[f64; 4]], format: TexelFormat) -> Result<Self, FactorError> {
        let coding = Coding::of(format, texels);
        let rounded = texels
            .iter()
            .map(|texel| std::array::from_fn(|channel| coding.nearest(channel, texel[channel])));
        let rounded: Vec<[f32; 4]> = rounded.collect();
        if let Some(value) = rounded.iter().flatten().find(|value| !value.is_finite()) {
            return Err(FactorError::Factors {
                found: format!("a texel that is {value} in {}", format.name()),
                expected: "log values that the format reaches",
            });
        }
        let factor = Self::new(self.description.clone(), Some(rounded))?;
        Ok(Self { coding, ..factor })
    }

    /// Replaces the texels by these log values, row by row, which are stored as f32.
    ///
    /// # Errors
    ///
    /// [`FactorError::Factors`] unless there is one for each place in the grid and all are finite.
    pub fn set_texels(&mut self, texels: Vec<[f32; 4]>) -> Result<(), FactorError> {
        if texels.len() != self.description.grid.texels() {
            return Err(FactorError::Factors {
                found: format!(
                    "{} texels for a grid of {}",
                    texels.len(),
                    self.description.grid.texels()
                ),
                expected: "one texel for each place in the grid",
            });
        }
        if texels.iter().flatten().any(|v| !v.is_finite()) {
            return Err(FactorError::Factors {
                found: "a texel that is not finite".to_owned(),
                expected: "finite log values",
            });
        }
        self.texels = texels;
        self.coding = Coding::F32;
        Ok(())
    }

    /// Returns, row by row, whether the image of the coordinates can reach each texel.
    pub fn mask(&self) -> Vec<bool> {
        let outline: Vec<DVec2> = self
            .coordinates()
            .iter()
            .flat_map(|c| {
                let FactorDescription { bound, radii, extent, .. } = self.description;
                c.image(bound, radii, extent)
            })
            .collect();
        self.description.grid.mask(&outline)
    }

    /// Calls `tap` with the texels and weights that make up this factor's log value, over all its
    /// coordinates.
    pub(crate) fn for_each_tap(&self, pair: &PairPlace<'_>, mut tap: impl FnMut(usize, f64)) {
        for coordinate in &self.description.coordinates {
            let point = coordinate.locate(pair, self.description.extent);
            self.description.grid.taps(point).iter().for_each(|(texel, weight)| tap(texel, weight));
        }
    }

    /// The coordinates of a pair all lie on the texture.
    fn holds(&self, pair: &PairPlace<'_>) -> bool {
        self.description
            .coordinates
            .iter()
            .all(|c| self.description.grid.holds(c.locate(pair, self.description.extent)))
    }

    fn add_log_value(&self, pair: &PairPlace<'_>, sum: &mut [f64; 3]) {
        self.for_each_tap(pair, |texel, weight| {
            for (total, &value) in sum.iter_mut().zip(&self.texels[texel]) {
                *total += weight * f64::from(value);
            }
        });
    }
}

/// The numbers of pairs and values that were changed while a model was evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EvalCounts {
    /// Number of pairs with a direction beyond the grazing limit, which was pulled back to it.
    pub pulled_back: usize,
    /// Number of pairs with a coordinate outside a texture, which was moved to its rim.
    pub outside_texture: usize,
    /// Number of values with a negative channel, which was set to 0.
    pub clamped_below_zero: usize,
    /// Number of values with a channel above its ceiling, which was set to that.
    pub clamped_at_ceiling: usize,
}

/// A BRDF as a product of factors, each a texture.
///
/// ```
/// use brdf_factor::{
///     ChannelTransform, Coordinate, Factor, FactorDescription, FactoredBrdf, Grid,
/// };
/// use brdf_model::Brdf;
/// use brdf_param::{Bound, DirectionPair, DiscRadii};
///
/// // One texture over the half vector whose log texels are all 0: f = exp(0) = 1 sr⁻¹.
/// let description =
///     FactorDescription::new(&[Coordinate::H], Grid::square(4), Bound::Disc, DiscRadii::UNIT)?;
/// let factor = Factor::new(description, None)?;
/// let model = FactoredBrdf::new(vec![factor], vec![ChannelTransform::Log], 1.4)?;
/// assert_eq!(model.payload_bytes(), 4 * 4 * 4);
/// assert!((model.eval(&DirectionPair::from_angles(0.2, 0.0, 0.9, 1.0)).g - 1.0).abs() < 1e-6);
/// # Ok::<(), brdf_factor::FactorError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FactoredBrdf {
    factors: Vec<Factor>,
    maps: Vec<ChannelTransform>,
    /// Largest value of each channel, sr⁻¹; infinite where there is none.
    ceilings: Vec<f64>,
    /// Grazing limit in radians: beyond it, evaluation pulls directions back along their azimuth.
    theta_max: f64,
}

impl FactoredBrdf {
    /// Returns the model of these factors, with one log map for each channel and a grazing limit
    /// `theta_max` in radians.
    ///
    /// # Errors
    ///
    /// [`FactorError::Factors`] without factors or with other than one or three channels;
    /// [`FactorError::Option`] unless 0 < `theta_max` ≤ π/2.
    pub fn new(
        factors: Vec<Factor>,
        maps: Vec<ChannelTransform>,
        theta_max: f64,
    ) -> Result<Self, FactorError> {
        if factors.is_empty() || !matches!(maps.len(), 1 | 3) {
            return Err(FactorError::Factors {
                found: format!("{} factors of {} channels", factors.len(), maps.len()),
                expected: "at least one factor, and one or three channels",
            });
        }
        if !(theta_max > 0.0 && theta_max <= std::f64::consts::FRAC_PI_2) {
            return Err(FactorError::Option {
                option: "the grazing limit",
                value: theta_max.to_degrees(),
                expected: "more than 0 and at most 90 degrees",
            });
        }
        let ceilings = vec![f64::INFINITY; maps.len()];
        Ok(Self { factors, maps, ceilings, theta_max })
    }

    /// Returns the model held at these values, one for each channel, in sr⁻¹: no highlight gets brighter than what was
    /// measured.
    ///
    /// # Errors
    ///
    /// [`FactorError::Factors`] unless there is one for each channel, and none is negative or NaN.
    pub fn with_ceilings(self, ceilings: Vec<f64>) -> Result<Self, FactorError> {
        if ceilings.len() != self.maps.len() || !ceilings.iter().all(|c| *c >= 0.0) {
            return Err(FactorError::Factors {
                found: format!("ceilings {ceilings:?} of {} channels", self.maps.len()),
                expected: "one for each channel, 0 or more",
            });
        }
        Ok(Self { ceilings, ..self })
    }

    /// Returns the largest value that the model gives in each channel, in sr⁻¹; infinite where it is not held.
    pub fn ceilings(&self) -> &[f64] {
        &self.ceilings
    }

    /// Returns the factors.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// Returns the log map of each channel.
    pub fn maps(&self) -> &[ChannelTransform] {
        &self.maps
    }

    /// Returns the grazing limit in radians, (0, π/2].
    pub fn theta_max(&self) -> f64 {
        self.theta_max
    }

    /// Returns the channels of the model: one or three.
    pub fn channels(&self) -> Channels {
        if self.maps.len() == 1 { Channels::Luminance } else { Channels::Rgb }
    }

    /// Returns the model with texels that can be stored in a format without loss: what is evaluated is what a file holds.
    ///
    /// Before texels are rounded to the nearest values, factors exchange constants, which changes no value: all ranges get
    /// the same middle, so that texels are small. Texels as f32 stay as they are.
    ///
    /// # Errors
    ///
    /// [`FactorError::Factors`] for log values that the format does not reach: of f16 those beyond 65504.
    pub fn stored_as(&self, format: TexelFormat) -> Result<Self, FactorError> {
        if format.is_f32() {
            return Ok(self.clone());
        }
        let balanced = balanced(&self.factors);
        let rounded = self.factors.iter().zip(&balanced);
        let factors: Result<_, _> =
            rounded.map(|(factor, texels)| factor.with_rounded(texels, format)).collect();
        Ok(Self { factors: factors?, ..self.clone() })
    }

    /// Returns the number of bytes of the textures as stored, ranges of channels included.
    pub fn payload_bytes(&self) -> usize {
        let channels = self.maps.len();
        self.factors.iter().map(|f| f.format().bytes(f.grid().texels(), channels)).sum()
    }

    /// Returns the log value of each channel, before the inverse log map; unused channels are 0.
    pub fn log_values(&self, pair: &DirectionPair) -> [f64; 3] {
        let pair = self.pulled_back(pair);
        let place = PairPlace::new(&pair);
        let mut sum = [0.0; 3];
        self.factors.iter().for_each(|factor| factor.add_log_value(&place, &mut sum));
        sum
    }

    /// Returns how many of these pairs, and of their values, are changed when the model is evaluated.
    ///
    /// Pairs below the horizon are passed over, since their value is 0 in any case.
    pub fn count(&self, pairs: impl IntoIterator<Item = DirectionPair>) -> EvalCounts {
        let mut counts = EvalCounts::default();
        for pair in pairs.into_iter().filter(|pair| pair.wi.z > 0.0 && pair.wo.z > 0.0) {
            let pulled = self.pulled_back(&pair);
            counts.pulled_back += usize::from(pulled != pair);
            let place = PairPlace::new(&pulled);
            counts.outside_texture += usize::from(!self.factors.iter().all(|f| f.holds(&place)));
            let value = self.eval_unclamped(&pair);
            let channels = &value.channels()[..self.maps.len()];
            counts.clamped_below_zero += usize::from(channels.iter().any(|&v| v < 0.0));
            let is_above = channels.iter().zip(&self.ceilings).any(|(v, ceiling)| v > ceiling);
            counts.clamped_at_ceiling += usize::from(is_above);
        }
        counts
    }

    fn pulled_back(&self, pair: &DirectionPair) -> DirectionPair {
        let (sin_max, cos_max) = self.theta_max.sin_cos();
        let pull = |w: DVec3| {
            if w.z >= cos_max {
                return w;
            }
            w.truncate()
                .try_normalize()
                .map_or(DVec3::Z, |azimuth| (sin_max * azimuth).extend(cos_max))
        };
        DirectionPair::new(pull(pair.wi), pull(pair.wo))
    }
}
