//! Texels resampled from measured directions to the grid, as fixed matrices applied to blocks.
//!
//! Views are interpolated first, then the lights of each view of the grid: matrices that do not
//! depend on the texel, so that a block of texels is a few matrix products.

use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::TEXEL_BLOCK;
use crate::colour::{to_ycbcr, to_yuv};
use crate::rbf::DirectionRbf;
use crate::{AngularGrid, BtfLayout, BtfSource, Encoding, Taps, VqError};

/// Directions closer than this, as a distance of unit vectors, are one: 0.01°, since file names give
/// whole or tenths of degrees.
const SAME_DIRECTION: f64 = 1.8e-4;

/// What a view has for one of the common lights.
enum Slot {
    /// An image.
    Image(usize),
    /// No image: weights of the view's own images, which start at `first`.
    Interpolated { first: usize, weights: Vec<f32> },
}

/// Fixed matrices that take the images of a layout to the nodes of a grid.
pub struct Resampler {
    grid: AngularGrid,
    encoding: Encoding,
    image_count: usize,
    light_count: usize,
    /// `[view][common light]`.
    slots: Vec<Vec<Slot>>,
    /// `[grid view][view]`, row-major.
    views: Vec<f32>,
    /// For each φv of the grid, `[light node][common light]`, row-major.
    lights: Vec<Vec<f32>>,
    filled: usize,
}

impl std::fmt::Debug for Resampler {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Resampler").field("grid", &self.grid).field("filled", &self.filled).finish()
    }
}

impl Resampler {
    /// Returns the matrices for a layout, from the real directions of its images. Lights that most views have in
    /// common carry the interpolation; where a view lacks one, its own lights give the value.
    ///
    /// # Errors
    ///
    /// [`VqError::Grid`]; [`VqError::Size`]; [`VqError::Directions`] where fewer than three views, or
    /// lights of a view, differ.
    pub fn new(layout: &BtfLayout, grid: AngularGrid) -> Result<Self, VqError> {
        grid.check()?;
        let BtfLayout { width, height, .. } = *layout;
        if width.checked_mul(height).is_none_or(|n| n == 0 || n > 1 << 28) {
            return Err(VqError::Size { width, height });
        }
        let common = common_lights(layout);
        let mut first = 0;
        let mut slots = Vec::with_capacity(layout.views.len());
        for view in &layout.views {
            slots.push(view_slots(&view.lights, &common, first)?);
            first += view.lights.len();
        }
        let filled =
            slots.iter().flatten().filter(|s| matches!(s, Slot::Interpolated { .. })).count();
        let sites: Vec<DVec3> = layout.views.iter().map(|view| view.wo).collect();
        let targets: Vec<DVec3> = (0..grid.view_count())
            .map(|view| {
                let (theta, phi) = grid.view_angles(view);
                brdf_param::spherical_direction(theta, phi)
            })
            .collect();
        let views = row_major(&DirectionRbf::new("views", &sites)?.weights(&targets));
        let rbf = DirectionRbf::new("lights of a view", &common)?;
        let lights = (0..grid.phis).map(|phi| light_matrix(&grid, &rbf, phi)).collect();
        Ok(Self {
            grid,
            encoding: layout.encoding,
            image_count: first,
            light_count: common.len(),
            slots,
            views,
            lights,
            filled,
        })
    }

    /// Returns the grid of directions.
    pub fn grid(&self) -> &AngularGrid {
        &self.grid
    }

    /// Returns the number of pairs of view and common light without an image, whose values are interpolated.
    pub fn filled(&self) -> usize {
        self.filled
    }

    /// Resamples consecutive texels of a source block by block, in parallel, and calls `f` with each block.
    ///
    /// `f` gets the texels of a block and their values `[texel][channel][node]`, luma and two chrominances of
    /// [`crate::colour`]. Luma that interpolation made negative becomes 0. Returns what `f` made of each block, in
    /// order, and how many nodes were made 0.
    ///
    /// # Errors
    ///
    /// [`VqError::Source`]; [`VqError::NotFinite`].
    pub fn map_blocks<T: Send>(
        &self,
        source: &dyn BtfSource,
        texels: Range<usize>,
        f: impl Fn(Range<usize>, &mut [f32]) -> T + Sync,
    ) -> Result<(Vec<T>, u64), VqError> {
        let starts: Vec<usize> = texels.clone().step_by(TEXEL_BLOCK).collect();
        let blocks: Result<Vec<(T, u64)>, VqError> = starts
            .into_par_iter()
            .map_init(Workspace::default, |workspace, start| {
                let block = start..texels.end.min(start + TEXEL_BLOCK);
                workspace.images.resize(self.image_count * 3 * block.len(), 0.0);
                source
                    .read_texels(block.clone(), &mut workspace.images)
                    .map_err(VqError::Source)?;
                let clamped = self.resample_block(start, block.len(), workspace)?;
                let made = f(block, &mut workspace.out);
                Ok((made, clamped))
            })
            .collect();
        let (made, clamped): (Vec<T>, Vec<u64>) = blocks?.into_iter().unzip();
        Ok((made, clamped.iter().sum()))
    }

    /// Returns chosen texels from all over a source, resampled: `[texel][channel][node]`.
    ///
    /// # Errors
    ///
    /// [`VqError::Source`]; [`VqError::NotFinite`].
    pub fn gather(&self, source: &dyn BtfSource, texels: &[usize]) -> Result<Vec<f32>, VqError> {
        let blocks: Result<Vec<Vec<f32>>, VqError> = texels
            .par_chunks(TEXEL_BLOCK)
            .map_init(Workspace::default, |workspace, block| {
                let columns = 3 * block.len();
                workspace.images.resize(self.image_count * columns, 0.0);
                let mut one = vec![0.0; self.image_count * 3];
                for (at, texel) in block.iter().enumerate() {
                    source.read_texels(*texel..texel + 1, &mut one).map_err(VqError::Source)?;
                    let images = workspace.images.chunks_exact_mut(columns);
                    for (image, rgb) in images.zip(one.chunks_exact(3)) {
                        image[3 * at..][..3].copy_from_slice(rgb);
                    }
                }
                self.resample_block(block[0], block.len(), workspace)?;
                Ok(workspace.out.clone())
            })
            .collect();
        Ok(blocks?.concat())
    }

    /// From the images to `workspace.out`; returns the nodes made 0.
    fn resample_block(
        &self,
        start: usize,
        count: usize,
        workspace: &mut Workspace,
    ) -> Result<u64, VqError> {
        let columns = 3 * count;
        let Workspace { images, measured, viewed, out } = workspace;
        out.resize(columns * self.grid.node_count(), 0.0);
        if let Some(bad) = images.iter().position(|v| !v.is_finite()) {
            return Err(VqError::NotFinite { texel: start + bad % columns / 3 });
        }
        if self.encoding == Encoding::Srgb {
            for rgb in images.as_chunks_mut::<3>().0 {
                *rgb = to_ycbcr(*rgb);
            }
        }
        self.fill_slots(images, columns, measured);
        self.interpolate_views(measured, columns, viewed);
        self.interpolate_lights(viewed, columns, out);
        Ok(self.finish(out))
    }

    /// `measured[view][common light][column]`.
    fn fill_slots(&self, images: &[f32], columns: usize, measured: &mut Vec<f32>) {
        measured.resize(self.slots.len() * self.light_count * columns, 0.0);
        for (slot, target) in self.slots.iter().flatten().zip(measured.chunks_exact_mut(columns)) {
            match slot {
                Slot::Image(image) => {
                    target.copy_from_slice(&images[image * columns..][..columns]);
                }
                Slot::Interpolated { first, weights } => {
                    target.fill(0.0);
                    for (offset, weight) in weights.iter().enumerate() {
                        let image = &images[(first + offset) * columns..][..columns];
                        target.iter_mut().zip(image).for_each(|(sum, v)| *sum += weight * v);
                    }
                }
            }
        }
    }

    /// `viewed[grid view][common light][column]`.
    fn interpolate_views(&self, measured: &[f32], columns: usize, viewed: &mut Vec<f32>) {
        let (views, row) = (self.grid.view_count(), self.light_count * columns);
        viewed.resize(views * row, 0.0);
        let sources = self.slots.len();
        matmul(
            MatMut::from_row_major_slice_mut(viewed, views, row),
            Accum::Replace,
            MatRef::from_row_major_slice(&self.views, views, sources),
            MatRef::from_row_major_slice(measured, sources, row),
            1.0,
            Par::Seq,
        );
    }

    /// `out[column][grid view][light node]`.
    fn interpolate_lights(&self, viewed: &[f32], columns: usize, out: &mut [f32]) {
        let (nodes, slice) = (self.grid.node_count(), self.grid.slice_len());
        for (view, lit) in viewed.chunks_exact(self.light_count * columns).enumerate() {
            let matrix = &self.lights[view / self.grid.thetas];
            let last = (columns - 1) * nodes + (view + 1) * slice;
            let target = &mut out[view * slice..last];
            matmul(
                // The transpose of columns, since faer 0.24 swaps the strides of strided rows.
                MatMut::from_column_major_slice_with_stride_mut(target, slice, columns, nodes)
                    .transpose_mut(),
                Accum::Replace,
                MatRef::from_row_major_slice(lit, self.light_count, columns).transpose(),
                MatRef::from_row_major_slice(matrix, slice, self.light_count).transpose(),
                1.0,
                Par::Seq,
            );
        }
    }

    /// Takes colours of linear sources apart and removes negative luma.
    fn finish(&self, out: &mut [f32]) -> u64 {
        let nodes = self.grid.node_count();
        let mut clamped = 0;
        for texel in out.chunks_exact_mut(3 * nodes) {
            let (first, rest) = texel.split_at_mut(nodes);
            let (second, third) = rest.split_at_mut(nodes);
            if self.encoding == Encoding::Linear {
                for ((a, b), c) in first.iter_mut().zip(&mut *second).zip(&mut *third) {
                    clamped += u64::from(a.min(*b).min(*c) < 0.0);
                    [*a, *b, *c] = to_yuv([a.max(0.0), b.max(0.0), c.max(0.0)]);
                }
            } else {
                for luma in first {
                    clamped += u64::from(*luma < 0.0);
                    *luma = luma.max(0.0);
                }
            }
        }
        clamped
    }

    /// Returns how much each node counts, on average 1: the weights with which the directions of a layout read it,
    /// and a floor for directions that no image shows.
    pub fn node_weights(&self, layout: &BtfLayout) -> Vec<f32> {
        const FLOOR: f32 = 0.05;
        let mut weights = vec![0.0_f32; self.grid.node_count()];
        let mut images = 0.0;
        for view in &layout.views {
            for light in &view.lights {
                images += 1.0;
                for (node, weight) in Taps::new(&self.grid, *light, view.wo).nodes(&self.grid) {
                    weights[node] += weight;
                }
            }
        }
        let scale = weights.len() as f32 / images;
        weights.iter_mut().for_each(|w| *w = FLOOR + (1.0 - FLOOR) * scale * *w);
        weights
    }
}

/// Buffers of one thread.
#[derive(Default)]
struct Workspace {
    images: Vec<f32>,
    measured: Vec<f32>,
    viewed: Vec<f32>,
    out: Vec<f32>,
}

/// The lights that at least half of the views have; all of the best-lit view where that leaves too
/// few to interpolate.
fn common_lights(layout: &BtfLayout) -> Vec<DVec3> {
    let mut lights: Vec<(DVec3, usize)> = Vec::new();
    for light in layout.views.iter().flat_map(|view| &view.lights) {
        match lights.iter_mut().find(|(other, _)| other.distance(*light) < SAME_DIRECTION) {
            Some((_, count)) => *count += 1,
            None => lights.push((*light, 1)),
        }
    }
    let shared: Vec<DVec3> = lights
        .iter()
        .filter(|(_, count)| 2 * count >= layout.views.len())
        .map(|(light, _)| *light)
        .collect();
    let most = layout.views.iter().map(|v| v.lights.as_slice()).max_by_key(|l| l.len());
    match most {
        Some(all) if 2 * shared.len() < all.len() => all.to_vec(),
        _ => shared,
    }
}

fn view_slots(lights: &[DVec3], common: &[DVec3], first: usize) -> Result<Vec<Slot>, VqError> {
    let image = |light: &DVec3| lights.iter().position(|l| l.distance(*light) < SAME_DIRECTION);
    let missing: Vec<DVec3> = common.iter().filter(|l| image(l).is_none()).copied().collect();
    let mut fills = Vec::new();
    if !missing.is_empty() {
        let weights = DirectionRbf::new("lights of a view", lights)?.weights(&missing);
        fills = row_major(&weights).chunks_exact(lights.len()).map(<[f32]>::to_vec).collect();
    }
    let mut fills = fills.into_iter();
    Ok(common
        .iter()
        .map(|light| match image(light) {
            Some(index) => Slot::Image(first + index),
            None => Slot::Interpolated { first, weights: fills.next().unwrap_or_default() },
        })
        .collect())
}

/// `[light node][common light]` for an azimuth of the grid.
fn light_matrix(grid: &AngularGrid, rbf: &DirectionRbf, phi: usize) -> Vec<f32> {
    let azimuth = DVec2::from_angle(grid.view_angles(phi * grid.thetas).1);
    let nodes = (0..grid.alphas).flat_map(|a| (0..grid.betas).map(move |b| (a, b)));
    let (one, other): (Vec<DVec3>, Vec<DVec3>) =
        nodes.map(|(a, b)| grid.node_directions(a, b, azimuth).into()).unzip();
    let mean = (rbf.weights(&one) + rbf.weights(&other)) * faer::Scale(0.5);
    row_major(&mean)
}

/// Narrows to f32, row by row.
#[expect(clippy::cast_possible_truncation, reason = "stored matrices are f32")]
fn row_major(matrix: &Mat<f64>) -> Vec<f32> {
    (0..matrix.nrows())
        .flat_map(|row| (0..matrix.ncols()).map(move |column| matrix[(row, column)] as f32))
        .collect()
}
