//! Where a place on a mesh lies on its texture.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use crate::error::MeshError;

/// Texture coordinates of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum TextureCoordinates {
    /// Longitude and latitude about a centre: computed, not interpolated, so that the seam is sharp.
    Sphere { centre: DVec3 },
    /// Of each vertex, from the file.
    OfFile(Vec<DVec2>),
    /// Of each vertex, by unwrapping.
    Atlas(Vec<DVec2>),
}

impl TextureCoordinates {
    /// At a place of a triangle.
    pub(crate) fn at(&self, position: DVec3, corners: [usize; 3], weights: [f64; 3]) -> DVec2 {
        match self {
            Self::Sphere { centre } => on_sphere(position - *centre),
            Self::OfFile(uv) | Self::Atlas(uv) => {
                corners.iter().zip(weights).map(|(at, w)| w * uv[*at]).sum()
            }
        }
    }

    pub(crate) fn lie_on_one_tile(&self) -> bool {
        match self {
            Self::Sphere { .. } => true,
            Self::OfFile(uv) | Self::Atlas(uv) => {
                uv.iter().all(|at| at.min_element() >= 0.0 && at.max_element() <= 1.0)
            }
        }
    }

    /// Units of texture coordinates along a unit of length, of a triangle with twice this area.
    pub(crate) fn density(&self, corners: [usize; 3], area: f64, position: DVec3) -> f64 {
        match self {
            // Along a meridian, and about that across it away from the poles.
            Self::Sphere { centre } => (PI * position.distance(*centre)).recip(),
            Self::OfFile(uv) | Self::Atlas(uv) => {
                let [a, b, c] = corners.map(|at| uv[at]);
                ((b - a).perp_dot(c - a).abs() / area).sqrt()
            }
        }
    }

    /// The direction in which u grows on a triangle, where the file says it; charts of an atlas lie any
    /// way around.
    pub(crate) fn along_u(&self, positions: [DVec3; 3], corners: [usize; 3]) -> Option<DVec3> {
        let Self::OfFile(uv) = self else { return None };
        let [a, b, c] = positions;
        let [ua, ub, uc] = corners.map(|at| uv[at]);
        let (first, second) = (ub - ua, uc - ua);
        let area = first.perp_dot(second);
        (area != 0.0).then(|| ((b - a) * second.y - (c - a) * first.y) / area)
    }
}

fn on_sphere(offset: DVec3) -> DVec2 {
    let planar = offset.x.hypot(offset.z);
    let longitude = offset.x.atan2(offset.z);
    DVec2::new(longitude / TAU + 0.5, offset.y.atan2(planar) / PI + 0.5)
}

/// For each vertex of charts that do not overlap the vertex it comes from and its texture coordinates;
/// and the triangles, in their order.
#[expect(clippy::type_complexity, reason = "three lists that belong together")]
pub(crate) fn unwrap(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    size: usize,
) -> Result<(Vec<usize>, Vec<DVec2>, Vec<[u32; 3]>), MeshError> {
    let refuse = |problem: String| MeshError::Unwrap { problem };
    let places: Vec<[f32; 3]> = positions.iter().map(|p| p.as_vec3().to_array()).collect();
    let page_size = u32::try_from(size).map_err(|e| refuse(e.to_string()))?;
    let options = uvunwrap::Options {
        density: uvunwrap::Density::Auto { page_size },
        packing: uvunwrap::Packing::Fast,
        ..uvunwrap::Options::default()
    };
    let input = uvunwrap::MeshInput::new(&places, triangles.as_flattened());
    let mut atlas =
        uvunwrap::generate(&[input], &options).map_err(|error| refuse(error.to_string()))?;
    if atlas.page_count != 1 {
        let pages = atlas.page_count;
        return Err(refuse(format!("{pages} pages of {size} texels; ask for a larger map")));
    }
    let chart = atlas.meshes.swap_remove(0);
    // The page may be cropped to the rows in use; coordinates are of a square one.
    let shrink = DVec2::new(f64::from(atlas.width), f64::from(atlas.height)) / f64::from(page_size);
    let uv = chart.vertices.iter().map(|v| DVec2::from(v.uv.map(f64::from)) * shrink);
    let uv = uv.collect();
    let source = chart.vertices.iter().map(|v| v.xref as usize).collect();
    Ok((source, uv, chart.indices.as_chunks().0.to_vec()))
}
