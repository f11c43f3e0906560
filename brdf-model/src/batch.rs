//! Structure-of-arrays buffers for evaluating many direction pairs at once.

use brdf_param::DirectionPair;
use glam::DVec3;

use crate::Rgb;

/// Direction pairs as six borrowed arrays of f32, one for each component, all of the same length.
#[derive(Clone, Copy, Debug)]
pub struct DirectionSlices<'a> {
    wi: [&'a [f32]; 3],
    wo: [&'a [f32]; 3],
}

impl<'a> DirectionSlices<'a> {
    /// Returns the pairs whose directions to the light and to the viewer have these x, y and z, or `None`
    /// unless all six slices have the same length.
    pub fn new(wi: [&'a [f32]; 3], wo: [&'a [f32]; 3]) -> Option<Self> {
        let len = wi[0].len();
        wi.iter().chain(&wo).all(|slice| slice.len() == len).then_some(Self { wi, wo })
    }

    /// Returns the number of pairs.
    pub fn len(&self) -> usize {
        self.wi[0].len()
    }

    /// Returns whether there are no pairs.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns x, y and z of the directions to the light.
    pub fn wi(&self) -> [&'a [f32]; 3] {
        self.wi
    }

    /// Returns x, y and z of the directions to the viewer.
    pub fn wo(&self) -> [&'a [f32]; 3] {
        self.wo
    }

    /// Returns the pair at `index`.
    ///
    /// # Panics
    ///
    /// If `index` is not below [`DirectionSlices::len`].
    pub fn get(&self, index: usize) -> DirectionPair {
        let widen = |a: &[&[f32]; 3]| {
            DVec3::new(a[0][index].into(), a[1][index].into(), a[2][index].into())
        };
        DirectionPair::new(widen(&self.wi), widen(&self.wo))
    }
}

/// Direction pairs as six arrays of f32, one for each component.
///
/// ```
/// use brdf_model::DirectionBatch;
/// use brdf_param::DirectionPair;
///
/// let mut batch = DirectionBatch::default();
/// batch.push(&DirectionPair::from_angles(0.0, 0.0, 0.5, 0.0));
/// assert_eq!(batch.len(), 1);
/// assert_eq!(batch.as_slices().wi()[2], [1.0]);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DirectionBatch {
    wi: [Vec<f32>; 3],
    wo: [Vec<f32>; 3],
}

impl DirectionBatch {
    /// Returns the number of pairs.
    pub fn len(&self) -> usize {
        self.wi[0].len()
    }

    /// Returns whether there are no pairs.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the pairs, borrowed.
    pub fn as_slices(&self) -> DirectionSlices<'_> {
        DirectionSlices {
            wi: self.wi.each_ref().map(Vec::as_slice),
            wo: self.wo.each_ref().map(Vec::as_slice),
        }
    }

    /// Removes all pairs and keeps the memory.
    pub fn clear(&mut self) {
        self.wi.iter_mut().chain(&mut self.wo).for_each(Vec::clear);
    }

    /// Adds a pair, narrowed to f32.
    pub fn push(&mut self, pair: &DirectionPair) {
        let narrow = |arrays: &mut [Vec<f32>; 3], direction: DVec3| {
            for (array, component) in arrays.iter_mut().zip(direction.as_vec3().to_array()) {
                array.push(component);
            }
        };
        narrow(&mut self.wi, pair.wi);
        narrow(&mut self.wo, pair.wo);
    }
}

impl<'a> FromIterator<&'a DirectionPair> for DirectionBatch {
    fn from_iter<I: IntoIterator<Item = &'a DirectionPair>>(pairs: I) -> Self {
        let mut batch = Self::default();
        pairs.into_iter().for_each(|pair| batch.push(pair));
        batch
    }
}

/// BRDF values as three arrays of f32, one for each channel, in sr⁻¹.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RgbBatch {
    /// Red values.
    pub r: Vec<f32>,
    /// Green values.
    pub g: Vec<f32>,
    /// Blue values.
    pub b: Vec<f32>,
}

impl RgbBatch {
    /// Resizes the arrays to `len` values; what the values are is not specified.
    pub fn resize(&mut self, len: usize) {
        for channel in [&mut self.r, &mut self.g, &mut self.b] {
            channel.resize(len, 0.0);
        }
    }

    /// Returns the value at `index`.
    ///
    /// # Panics
    ///
    /// If `index` is out of range.
    pub fn get(&self, index: usize) -> Rgb {
        Rgb::new(self.r[index].into(), self.g[index].into(), self.b[index].into())
    }

    /// Writes the value at `index`, narrowed to f32.
    ///
    /// # Panics
    ///
    /// If `index` is out of range.
    #[expect(clippy::cast_possible_truncation, reason = "the narrowing this buffer is for")]
    pub fn set(&mut self, index: usize, value: Rgb) {
        self.r[index] = value.r as f32;
        self.g[index] = value.g as f32;
        self.b[index] = value.b as f32;
    }
}
