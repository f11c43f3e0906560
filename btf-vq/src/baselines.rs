//! What the codebooks are compared with, in f32 and for measurements only: nothing here is stored.
//!
//! Sources: of local principal components see [`LocalPca`]; principal components of each view as in
//! M. Sattler, R. Sarlette and R. Klein, "Efficient and Realistic Visualization of Cloth", Eurographics
//! Symposium on Rendering 2003; one level of vector quantization as Havran et al. 2010 mention it.

use faer::{Mat, MatRef, Side};
use rayon::prelude::*;

use crate::bits::index_bits;
use crate::cluster::cluster_shapes;
use crate::colour::from_luma_chroma;
use crate::subspace::products;
use crate::{
    AngularGrid, BtfLayout, BtfSource, Encoding, LocalPca, ProjectedTexels, Taps, VqError,
};

/// Texels as linear combinations of a few vectors of their group, in `f32`: local principal components or one level
/// of vector quantization.
#[derive(Clone, Debug)]
pub struct Combinations {
    grid: AngularGrid,
    encoding: Encoding,
    /// Vectors of a group.
    vectors: usize,
    /// `[group][vector][channel][node]`.
    values: Vec<f32>,
    group: Vec<u32>,
    /// `[texel][vector]`.
    factors: Vec<f32>,
}

impl Combinations {
    /// Returns the combinations of a fit of local principal components, without any rounding.
    pub fn of_lpca(survey: &ProjectedTexels, fit: &LocalPca) -> Self {
        let components = fit.components();
        let factors = match components {
            0 => vec![1.0; survey.texels()],
            n => fit.coefficients.chunks_exact(n).flat_map(with_mean).collect(),
        };
        Self {
            grid: survey.grid,
            encoding: survey.encoding,
            vectors: components + 1,
            values: plain(survey, &fit.spaces),
            group: fit.cluster.clone(),
            factors,
        }
    }

    /// Returns one level of vector quantization in at most `bytes`: codes of whole texels, a byte a value, and for
    /// each texel an index and a scale of eight bits.
    ///
    /// # Errors
    ///
    /// [`VqError::Budget`] where not even two codes fit.
    pub fn one_level(survey: &ProjectedTexels, bytes: usize) -> Result<Self, VqError> {
        let (texels, len) = (survey.texels(), 3 * survey.grid.node_count());
        let size = |codes| codes * len + texels * (index_bits(codes) as usize + 8) / 8;
        let Some(codes) = (2..=texels).take_while(|codes| size(*codes) <= bytes).last() else {
            let what = "two codes of whole texels".to_owned();
            return Err(VqError::Budget { bytes: bytes as u64, what, least: size(2) as u64 });
        };
        let weights = survey.texel_weights();
        let found =
            cluster_shapes(&survey.coefficients, survey.space.dims, &weights, &[], codes, 8);
        Ok(Self {
            grid: survey.grid,
            encoding: survey.encoding,
            vectors: 1,
            values: plain(survey, &found.codes),
            group: found.assignment,
            factors: found.gains,
        })
    }

    /// Writes the RGB of all texels for one pair of directions into `out`.
    ///
    /// # Panics
    ///
    /// If `out` is of another size.
    pub fn image(&self, taps: &Taps, out: &mut [[f32; 3]]) {
        assert_eq!(out.len(), self.group.len(), "a value for each texel");
        let nodes = taps.nodes(&self.grid);
        let between = |channel: &[f32]| nodes.iter().map(|(node, w)| w * channel[*node]).sum();
        let rows: Vec<f32> =
            self.values.chunks_exact(self.grid.node_count()).map(between).collect();
        let texels = self.group.iter().zip(self.factors.chunks_exact(self.vectors));
        for ((group, factors), value) in texels.zip(out) {
            let rows = &rows[3 * *group as usize * self.vectors..][..3 * self.vectors];
            let mut sum = [0.0; 3];
            for (row, factor) in rows.as_chunks::<3>().0.iter().zip(factors) {
                sum.iter_mut().zip(row).for_each(|(s, v)| *s += factor * v);
            }
            let [y, a, b] = sum;
            *value = match self.encoding {
                Encoding::Srgb => from_luma_chroma(Encoding::Srgb, [y.max(0.0), a, b]),
                Encoding::Linear if y > 0.0 => {
                    from_luma_chroma(Encoding::Linear, [y, a / y, b / y])
                }
                Encoding::Linear => [0.0; 3],
            };
        }
    }
}

fn with_mean(coefficients: &[f32]) -> impl Iterator<Item = f32> + '_ {
    std::iter::once(1.0).chain(coefficients.iter().copied())
}

/// Vectors of a survey's subspace as values `[vector][channel][node]`.
fn plain(survey: &ProjectedTexels, vectors: &[f32]) -> Vec<f32> {
    let mut values = survey.space.lift(vectors);
    let roots = survey.root_weights.iter().cycle();
    values.iter_mut().zip(roots).for_each(|(v, root)| *v /= root);
    values
}

/// Principal components of the images of each view: each component has a weight a light and a picture (Sattler,
/// Sarlette and Klein 2003).
#[derive(Clone, Debug)]
pub struct ViewPca {
    /// Of each view, `[image][image]`: the projection onto its components, row-major.
    projections: Vec<Vec<f32>>,
}

impl ViewPca {
    /// Returns the bytes that `components` components of every view take, a byte a value.
    pub fn bytes(layout: &BtfLayout, components: usize) -> usize {
        let lights = layout.views.iter().map(|view| view.lights.len());
        lights.map(|lights| components * (lights + 3 * layout.texel_count())).sum()
    }

    /// Fits `components` principal components to the images of every view of a source.
    ///
    /// # Errors
    ///
    /// [`VqError::Source`].
    pub fn fit(source: &dyn BtfSource, components: usize) -> Result<Self, VqError> {
        let mut projections = Vec::new();
        let mut first = 0;
        for view in &source.layout().views {
            let images = view_images(source, first, view.lights.len())?;
            first += view.lights.len();
            projections.push(leading_projection(&images, view.lights.len(), components));
        }
        Ok(Self { projections })
    }

    /// Returns all images of a view as its components give them, `[image][texel][rgb]`.
    ///
    /// # Errors
    ///
    /// [`VqError::Source`].
    ///
    /// # Panics
    ///
    /// If there is no such view.
    pub fn view(&self, source: &dyn BtfSource, view: usize) -> Result<Vec<f32>, VqError> {
        let views = &source.layout().views;
        let (first, count) =
            (views[..view].iter().map(|v| v.lights.len()).sum(), views[view].lights.len());
        let images = view_images(source, first, count)?;
        let len = images.len() / count.max(1);
        let matrix = MatRef::from_row_major_slice(&images, count, len);
        Ok(products(&self.projections[view], count, matrix))
    }
}

/// Consecutive images, `[image][texel][rgb]`.
fn view_images(source: &dyn BtfSource, first: usize, count: usize) -> Result<Vec<f32>, VqError> {
    let len = 3 * source.layout().texel_count();
    let mut images = vec![0.0; count * len];
    let read = images.par_chunks_exact_mut(len).enumerate();
    read.try_for_each(|(at, image)| source.read_image(first + at, image))
        .map_err(VqError::Source)?;
    Ok(images)
}

/// The projection onto the leading directions of the rows of a matrix.
#[expect(clippy::cast_possible_truncation, reason = "applied in f32")]
fn leading_projection(rows: &[f32], count: usize, components: usize) -> Vec<f32> {
    let len = rows.len() / count.max(1);
    let matrix = MatRef::from_row_major_slice(rows, count, len);
    let gram = products(rows, len, matrix.transpose());
    let wide = Mat::from_fn(count, count, |i, j| f64::from(gram[i * count + j]));
    let Ok(eigen) = wide.self_adjoint_eigen(Side::Lower) else {
        return vec![0.0; count * count];
    };
    let vectors = eigen.U();
    let kept = count - components.min(count)..count;
    let entry = |at: usize| {
        let (i, j) = (at / count, at % count);
        kept.clone().map(|c| vectors[(i, c)] * vectors[(j, c)]).sum::<f64>() as f32
    };
    (0..count * count).map(entry).collect()
}
