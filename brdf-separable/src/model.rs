//! BRDFs as sums of products of two textures.

use brdf_model::{Brdf, Channels, Rgb};
use brdf_param::DirectionPair;

use crate::hemisphere_grid::Taps;
use crate::{Layout, SeparableError, ValueTransform};

/// A BRDF as a sum of products of textures, f(wi, wo) ≈ Σ_k g_k(a) h_k(b).
///
/// Textures are in f32 and read bilinearly; the sum is brought back through the value map of each channel.
/// Sums of products with signs can be negative: [`Brdf::eval`] clamps at 0, [`Brdf::eval_unclamped`] does
/// not.
///
/// ```
/// use brdf_model::Brdf;
/// use brdf_param::{DirectionPair, HemisphereMap, Parametrization};
/// use brdf_separable::{HemisphereGrid, Layout, SecondSide, SeparableBrdf, ValueTransform};
///
/// // One term of constant textures: f = 0.5 · 0.4.
/// let grid = HemisphereGrid::Plane { map: HemisphereMap::Parabolic, resolution: 4 };
/// let layout = Layout::new(Parametrization::Standard, grid, grid);
/// let second = SecondSide::Textures(vec![0.4; 16]);
/// let model =
///     SeparableBrdf::new(layout, vec![ValueTransform::Linear], 1, vec![0.5; 16], second)?;
/// assert!((model.eval(&DirectionPair::from_angles(0.2, 0.0, 0.9, 1.0)).g - 0.2).abs() < 1e-6);
/// assert_eq!(model.payload_bytes(), 2 * 16 * 4);
/// # Ok::<(), brdf_separable::SeparableError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SeparableBrdf {
    layout: Layout,
    maps: Vec<ValueTransform>,
    rank: usize,
    /// Channels of the first textures: all of the model's, or 1 where they are scalar.
    first_channels: usize,
    /// `[texel, term, channel]`.
    first: Vec<f32>,
    /// `[texel, term, channel]`; empty where both sides share textures.
    second: Vec<f32>,
    /// `[term, channel]`: of the second side where it shares the first one's textures, and of 1
    /// otherwise.
    signs: Vec<f32>,
}

/// The second side of a model.
#[derive(Clone, Debug, PartialEq)]
pub enum SecondSide {
    /// Textures of its own, `[texel, term, channel]`.
    Textures(Vec<f32>),
    /// The textures of the first side, each times a sign, `[term, channel]`: eigenpairs of a symmetric
    /// matrix.
    Signs(Vec<f32>),
}

impl SeparableBrdf {
    /// Returns the model of these textures, `[texel, term, channel]`.
    ///
    /// The first textures have one channel (scalar) or as many as there are maps.
    ///
    /// # Errors
    ///
    /// [`SeparableError::Layout`], [`SeparableError::Resolution`] and [`SeparableError::Texels`]
    /// for parts that do not fit together.
    pub fn new(
        layout: Layout,
        maps: Vec<ValueTransform>,
        rank: usize,
        first: Vec<f32>,
        second: SecondSide,
    ) -> Result<Self, SeparableError> {
        layout.check()?;
        let channels = maps.len();
        if rank == 0 || !matches!(channels, 1 | 3) {
            return Err(SeparableError::Layout {
                found: "no terms, or a number of channels that is not one or three",
                expected: "at least one term of one or three channels",
            });
        }
        let scalar = layout.first.texels() * rank;
        let first_channels = if first.len() == scalar { 1 } else { channels };
        let check = |side, found: usize, expected: usize| {
            if found == expected {
                return Ok(());
            }
            Err(SeparableError::Texels { side, found, expected })
        };
        check("first", first.len(), scalar * first_channels)?;
        let (second, signs) = match second {
            SecondSide::Textures(textures) => {
                let expected = layout.second.texels() * rank * channels;
                check("second", textures.len(), expected)?;
                (textures, vec![1.0; rank * channels])
            }
            SecondSide::Signs(signs) => {
                if !layout.is_symmetric() || first_channels != channels {
                    return Err(SeparableError::NotSymmetric {
                        found: "one set of textures for two sides that differ",
                        expected: "the same chart and channels for light and view",
                    });
                }
                check("second", signs.len(), rank * channels)?;
                (Vec::new(), signs)
            }
        };
        Ok(Self { layout, maps, rank, first_channels, first, second, signs })
    }

    /// Returns the layout: the two sides.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Returns the value map of each channel.
    pub fn maps(&self) -> &[ValueTransform] {
        &self.maps
    }

    /// Returns the number of terms.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Returns the channels of the model: one or three.
    pub fn channels(&self) -> Channels {
        if self.maps.len() == 1 { Channels::Luminance } else { Channels::Rgb }
    }

    /// Returns the number of channels of the first textures; 1 where they are scalar.
    pub fn first_channels(&self) -> usize {
        self.first_channels
    }

    /// Returns the textures of the first side, `[texel, term, channel]`.
    pub fn first(&self) -> &[f32] {
        &self.first
    }

    /// Returns the textures of the second side, `[texel, term, channel]`, if it has its own.
    pub fn second(&self) -> Option<&[f32]> {
        (!self.second.is_empty()).then_some(&self.second)
    }

    /// Returns the signs of the second side, `[term, channel]`, where it shares the first one's textures.
    pub fn signs(&self) -> Option<&[f32]> {
        self.second.is_empty().then_some(&self.signs)
    }

    /// Returns the number of bytes of the textures as stored.
    pub fn payload_bytes(&self) -> usize {
        4 * (self.first.len() + self.second.len())
    }

    /// Returns the model of the first `rank` terms.
    ///
    /// # Errors
    ///
    /// [`SeparableError::Rank`] unless `rank` is 1 to the model's.
    pub fn truncated(&self, rank: usize) -> Result<Self, SeparableError> {
        if rank == 0 || rank > self.rank {
            let (rows, columns) = (self.layout.first.texels(), self.layout.second.texels());
            return Err(SeparableError::Rank { rank, max: self.rank, rows, columns });
        }
        let channels = self.maps.len();
        let cut = |values: &[f32], channels: usize| {
            values
                .chunks_exact(self.rank * channels)
                .flat_map(|texel| &texel[..rank * channels])
                .copied()
                .collect()
        };
        Ok(Self {
            layout: self.layout,
            maps: self.maps.clone(),
            rank,
            first_channels: self.first_channels,
            first: cut(&self.first, self.first_channels),
            second: cut(&self.second, channels),
            signs: self.signs[..rank * channels].to_vec(),
        })
    }

    /// Returns the value of a texel of a term's first texture.
    pub fn first_at(&self, texel: usize, term: usize, channel: usize) -> f64 {
        let channels = self.first_channels;
        self.first[(texel * self.rank + term) * channels + channel.min(channels - 1)].into()
    }

    /// Returns the value of a texel of a term's second texture.
    pub fn second_at(&self, texel: usize, term: usize, channel: usize) -> f64 {
        let channels = self.maps.len();
        let sign = f64::from(self.signs[term * channels + channel]);
        let textures = if self.second.is_empty() { &self.first } else { &self.second };
        sign * f64::from(textures[(texel * self.rank + term) * channels + channel])
    }

    /// What a term adds to the mapped value at two texels.
    pub(crate) fn term_at(&self, term: usize, channel: usize, first: usize, second: usize) -> f64 {
        self.first_at(first, term, channel) * self.second_at(second, term, channel)
    }

    /// Calls `visit(rank, values)` for a pair with the sum of its first 1, 2, … terms: the mapped value of
    /// every rank, for every channel.
    pub fn partial_sums(&self, pair: &DirectionPair, mut visit: impl FnMut(usize, Rgb)) {
        if !(pair.wi.z > 0.0 && pair.wo.z > 0.0) {
            (1..=self.rank).for_each(|rank| visit(rank, Rgb::BLACK));
            return;
        }
        let [a, b] = self.layout.locate(pair);
        let (first, second) = (self.layout.first.taps(a), self.layout.second.taps(b));
        let channels = self.maps.len();
        let mut sum = [0.0_f64; 3];
        for term in 0..self.rank {
            for (channel, sum) in sum[..channels].iter_mut().enumerate() {
                let g = read(&first, |texel| self.first_at(texel, term, channel));
                let h = read(&second, |texel| self.second_at(texel, term, channel));
                *sum += g * h;
            }
            visit(term + 1, self.reflectance(sum, pair.wi.z));
        }
    }

    fn reflectance(&self, sum: [f64; 3], cos_theta_i: f64) -> Rgb {
        match self.maps[..] {
            [map] => Rgb::splat(map.inverse(sum[0], cos_theta_i)),
            [r, g, b] => Rgb::new(
                r.inverse(sum[0], cos_theta_i),
                g.inverse(sum[1], cos_theta_i),
                b.inverse(sum[2], cos_theta_i),
            ),
            _ => Rgb::BLACK,
        }
    }
}

fn read(taps: &Taps, texel: impl Fn(usize) -> f64) -> f64 {
    (0..4).map(|i| f64::from(taps.weights[i]) * texel(taps.texels[i] as usize)).sum()
}

/// Adds the weighted sum of four texels' values to `out`.
fn gather(taps: &Taps, textures: &[f32], out: &mut [f32]) {
    let width = out.len();
    let [a, b, c, d] = taps.texels.map(|t| &textures[t as usize * width..][..width]);
    let [wa, wb, wc, wd] = taps.weights;
    for (i, value) in out.iter_mut().enumerate() {
        *value = wa * a[i] + wb * b[i] + wc * c[i] + wd * d[i];
    }
}

/// Terms times channels that an evaluation keeps on the stack at once.
const MOST_ON_STACK: usize = 96;

impl Brdf for SeparableBrdf {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        self.eval_unclamped(pair).map(|v| v.max(0.0))
    }

    fn eval_unclamped(&self, pair: &DirectionPair) -> Rgb {
        // Written so that NaN directions are not lit either.
        if !(pair.wi.z > 0.0 && pair.wo.z > 0.0) {
            return Rgb::BLACK;
        }
        let channels = self.maps.len();
        let (wide, narrow) = (self.rank * channels, self.rank * self.first_channels);
        if wide > MOST_ON_STACK {
            let mut last = Rgb::BLACK;
            self.partial_sums(pair, |_, value| last = value);
            return last;
        }
        let [a, b] = self.layout.locate(pair);
        let mut first = [0.0; MOST_ON_STACK];
        let mut second = [0.0; MOST_ON_STACK];
        gather(&self.layout.first.taps(a), &self.first, &mut first[..narrow]);
        let textures = if self.second.is_empty() { &self.first } else { &self.second };
        gather(&self.layout.second.taps(b), textures, &mut second[..wide]);
        let mut sum = [0.0_f64; 3];
        for term in 0..self.rank {
            for (channel, sum) in sum[..channels].iter_mut().enumerate() {
                let at = term * channels + channel;
                let g = first[if self.first_channels == 1 { term } else { at }];
                *sum += f64::from(g * second[at] * self.signs[at]);
            }
        }
        self.reflectance(sum, pair.wi.z)
    }
}
