//! What encoders compress: texels on a grid, resampled from images or tabulated there.

use std::ops::Range;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::colour::{from_luma_chroma, to_luma_chroma};
use crate::{AngularGrid, BtfSource, Encoding, Resampler, Taps, VqError};

/// Texels without images: BRDFs, tabulated at the nodes of a grid.
#[derive(Clone, Debug)]
pub struct NodeTable {
    grid: AngularGrid,
    /// `[texel][channel][node]`, luminance and two chrominances of linear radiance.
    values: Vec<f32>,
}

impl NodeTable {
    /// Returns a table without texels.
    ///
    /// # Errors
    ///
    /// [`VqError::Grid`].
    pub fn new(grid: AngularGrid) -> Result<Self, VqError> {
        grid.check()?;
        Ok(Self { grid, values: Vec::new() })
    }

    /// Adds a texel by its linear radiance for unit directions `(wi, wo)`, and returns the number of nodes that were
    /// negative and became 0.
    ///
    /// Radiance is averaged over lights between a node and its neighbours, so that lobes narrower than the grid keep
    /// their energy.
    ///
    /// # Errors
    ///
    /// [`VqError::NotFinite`].
    pub fn push(
        &mut self,
        radiance: impl Fn(DVec3, DVec3) -> [f32; 3] + Sync,
    ) -> Result<u64, VqError> {
        let (grid, texel) = (self.grid, self.len());
        let views: Vec<(Vec<[f32; 3]>, u64)> = (0..grid.view_count())
            .into_par_iter()
            .map(|view| {
                let (theta, phi) = grid.view_angles(view);
                let wo = brdf_param::spherical_direction(theta, phi);
                let azimuth = DVec2::from_angle(phi);
                let nodes = (0..grid.alphas).flat_map(|a| (0..grid.betas).map(move |b| (a, b)));
                let mut clamped = 0;
                let values = nodes.map(|node| {
                    let mean = node_mean(&grid, node, azimuth, &|wi| radiance(wi, wo));
                    if mean.iter().any(|v| !v.is_finite()) {
                        return Err(VqError::NotFinite { texel });
                    }
                    clamped += u64::from(mean.iter().any(|v| *v < 0.0));
                    Ok(to_luma_chroma(Encoding::Linear, mean.map(|v| v.max(0.0))))
                });
                Ok((values.collect::<Result<_, _>>()?, clamped))
            })
            .collect::<Result<_, VqError>>()?;
        let all = || views.iter().flat_map(|view| &view.0);
        for channel in 0..3 {
            self.values.extend(all().map(|value| value[channel]));
        }
        Ok(views.iter().map(|view| view.1).sum())
    }

    /// Returns the number of texels.
    pub fn len(&self) -> usize {
        self.values.len() / (3 * self.grid.node_count())
    }

    /// Returns whether there are no texels.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Returns the linear radiance of a texel between the nodes of `taps`: what compression cannot better.
    ///
    /// # Panics
    ///
    /// If there is no such texel.
    pub fn interpolate(&self, texel: usize, taps: &Taps) -> [f32; 3] {
        let (values, nodes) = (self.texel(texel), self.grid.node_count());
        let mut sum = [0.0; 3];
        for (node, weight) in taps.nodes(&self.grid) {
            let luma = weight * values[node];
            sum[0] += luma;
            sum[1] += luma * values[nodes + node];
            sum[2] += luma * values[2 * nodes + node];
        }
        let [y, a, b] = sum;
        if y > 0.0 { from_luma_chroma(Encoding::Linear, [y, a / y, b / y]) } else { [0.0; 3] }
    }

    fn texel(&self, texel: usize) -> &[f32] {
        let len = 3 * self.grid.node_count();
        &self.values[texel * len..][..len]
    }
}

/// Mean about a node of the light grid, weighted as interpolation weighs the node.
fn node_mean(
    grid: &AngularGrid,
    (alpha, beta): (usize, usize),
    azimuth: DVec2,
    radiance: &dyn Fn(DVec3) -> [f32; 3],
) -> [f32; 3] {
    const STEPS: [(f64, f32); 3] = [(-0.5, 0.25), (0.0, 0.5), (0.5, 0.25)];
    let place = |node: usize, offset: f64, count: usize| {
        (node as f64 + offset).clamp(0.0, (count - 1) as f64)
    };
    let mut sum = [0.0; 3];
    for (across, w_alpha) in STEPS {
        for (along, w_beta) in STEPS {
            let place = (place(alpha, across, grid.alphas), place(beta, along, grid.betas));
            let sides = grid.directions(place.0, place.1, azimuth);
            let count = if sides[0] == sides[1] { 1 } else { 2 };
            let weight = w_alpha * w_beta / count as f32;
            for wi in &sides[..count] {
                sum.iter_mut().zip(radiance(*wi)).for_each(|(s, v)| *s += weight * v);
            }
        }
    }
    sum
}

/// A set of texels that are compressed together.
#[derive(Clone, Copy)]
pub enum TexelSet<'a> {
    /// Texels of images.
    Images {
        /// Their values.
        source: &'a dyn BtfSource,
        /// Matrices that take them to the grid.
        resampler: &'a Resampler,
    },
    /// Texels that are on the grid already.
    Nodes(&'a NodeTable),
}

impl std::fmt::Debug for TexelSet<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TexelSet").field("grid", self.grid()).field("len", &self.len()).finish()
    }
}

impl TexelSet<'_> {
    /// Returns the number of texels.
    pub fn len(&self) -> usize {
        self.width() * self.height()
    }

    /// Returns whether there are no texels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the grid of directions.
    pub fn grid(&self) -> &AngularGrid {
        match self {
            Self::Images { resampler, .. } => resampler.grid(),
            Self::Nodes(table) => &table.grid,
        }
    }

    /// Returns what values mean.
    pub fn encoding(&self) -> Encoding {
        match self {
            Self::Images { source, .. } => source.layout().encoding,
            Self::Nodes(_) => Encoding::Linear,
        }
    }

    /// Checks that sets can share books.
    ///
    /// # Errors
    ///
    /// [`VqError::Mixed`] where grids or encodings differ.
    pub fn check_alike(sets: &[Self]) -> Result<(), VqError> {
        let (grid, encoding) = (sets[0].grid(), sets[0].encoding());
        for set in sets {
            if set.encoding() != encoding {
                return Err(VqError::Mixed {
                    what: "encodings",
                    found: format!("{:?}", set.encoding()),
                    expected: format!("{encoding:?}"),
                });
            }
            if set.grid() != grid {
                return Err(VqError::Mixed {
                    what: "grids",
                    found: format!("{:?}", set.grid()),
                    expected: format!("{grid:?}"),
                });
            }
        }
        Ok(())
    }

    /// Returns the number of pairs of view and light without an image, whose values are interpolated.
    pub fn filled(&self) -> usize {
        match self {
            Self::Images { resampler, .. } => resampler.filled(),
            Self::Nodes(_) => 0,
        }
    }

    /// Texels in a row.
    pub(crate) fn width(&self) -> usize {
        match self {
            Self::Images { source, .. } => source.layout().width,
            Self::Nodes(table) => table.len(),
        }
    }

    /// Rows.
    pub(crate) fn height(&self) -> usize {
        match self {
            Self::Images { source, .. } => source.layout().height,
            Self::Nodes(_) => 1,
        }
    }

    /// See [`Resampler::map_blocks`].
    pub(crate) fn map_blocks<T: Send>(
        &self,
        texels: Range<usize>,
        f: impl Fn(Range<usize>, &mut [f32]) -> T + Sync,
    ) -> Result<(Vec<T>, u64), VqError> {
        match self {
            Self::Images { source, resampler } => resampler.map_blocks(*source, texels, f),
            Self::Nodes(table) => {
                let one = |texel| f(texel..texel + 1, &mut table.texel(texel).to_vec());
                Ok((texels.into_par_iter().map(one).collect(), 0))
            }
        }
    }

    /// See [`Resampler::gather`].
    pub(crate) fn gather(&self, texels: &[usize]) -> Result<Vec<f32>, VqError> {
        match self {
            Self::Images { source, resampler } => resampler.gather(*source, texels),
            Self::Nodes(table) => {
                Ok(texels.iter().flat_map(|texel| table.texel(*texel)).copied().collect())
            }
        }
    }

    /// How much each node counts, on average 1.
    pub(crate) fn node_weights(&self) -> Vec<f32> {
        match self {
            Self::Images { source, resampler } => resampler.node_weights(source.layout()),
            Self::Nodes(table) => vec![1.0; table.grid.node_count()],
        }
    }
}
