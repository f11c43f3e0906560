//! Textures of sums of products to look at.

use brdf_model::{Channels, Rgb};
use brdf_separable::{HemisphereGrid, SeparableBrdf};

use crate::texture_view::{MASKED_OUT, SIDE};
use brdf_image::{DisplayImage, srgb_bytes};

/// Which side of a sum of products.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The first point: wi, or the half vector.
    First,
    /// The second point.
    Second,
}

/// The absolute values of a term's texture on one side, each channel scaled so that its largest
/// shows as white; rows upwards. Texels that are not sampled are yellow. Grids of polar angles alone
/// become a band.
///
/// # Panics
///
/// If the model has no such term.
pub fn term_view(model: &SeparableBrdf, side: Side, term: usize) -> DisplayImage {
    assert!(term < model.rank(), "a term of the model");
    let grid: HemisphereGrid = match side {
        Side::First => model.layout().first,
        Side::Second => model.layout().second,
    };
    let is_grey = model.channels() == Channels::Luminance
        || (side == Side::First && model.first_channels() == 1);
    let value = |texel: usize| {
        let channel = |c: usize| match side {
            Side::First => model.first_at(texel, term, c).abs(),
            Side::Second => model.second_at(texel, term, c).abs(),
        };
        if is_grey { Rgb::splat(channel(0)) } else { Rgb::new(channel(0), channel(1), channel(2)) }
    };
    let [columns, rows] = grid.size();
    let mut shown: Vec<Option<Rgb>> = vec![None; columns * rows];
    for node in grid.nodes() {
        shown[node.texel] = Some(value(node.texel));
    }
    let white = shown
        .iter()
        .flatten()
        .fold(Rgb::splat(f64::MIN_POSITIVE), |best, v| best.zip(*v, f64::max));
    let zoom = (SIDE / columns.max(rows)).max(1);
    let height = if rows == 1 { 32 } else { rows * zoom };
    let mut picture = DisplayImage::filled(columns * zoom, height, MASKED_OUT);
    for row in 0..height {
        let v = if rows == 1 { 0 } else { rows - 1 - row / zoom };
        for column in 0..columns * zoom {
            if let Some(value) = shown[v * columns + column / zoom] {
                picture.set(column, row, srgb_bytes(value.zip(white, |v, w| v / w)));
            }
        }
    }
    picture
}
