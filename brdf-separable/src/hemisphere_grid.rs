//! Grids of texels over the unit hemisphere: their nodes, and interpolation between texels.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use brdf_model::{MerlNodes, MerlTable};
use brdf_param::{HemisphereMap, azimuth, polar_angle, spherical_direction};
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::SeparableError;

/// A grid of texels over the hemisphere, or over polar angles alone.
///
/// ```
/// use brdf_param::HemisphereMap;
/// use brdf_separable::HemisphereGrid;
///
/// let grid = HemisphereGrid::Plane { map: HemisphereMap::Parabolic, resolution: 32 };
/// assert_eq!(grid.texels(), 32 * 32);
/// // The weights of the nodes integrate the cosine over the hemisphere, to π.
/// let sum: f64 = grid.nodes().iter().map(|node| node.weight).sum();
/// assert!((sum / std::f64::consts::PI - 1.0).abs() < 0.02);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "chart", rename_all = "kebab-case")]
pub enum HemisphereGrid {
    /// `resolution`² texels over the square of a map, at (i + ½) / resolution. Where the domain of
    /// the map is a disc, only texels whose centre lies inside it are sampled. The first axis of
    /// polar and spherical maps is the azimuth and wraps around.
    Plane {
        /// The map from the hemisphere to the plane.
        map: HemisphereMap,
        /// Number of texels along each side.
        resolution: usize,
    },
    /// `resolution` texels along the radius of a map, for the polar angle alone.
    Radius {
        /// The map from the hemisphere to the plane.
        map: HemisphereMap,
        /// Number of texels.
        resolution: usize,
    },
    /// The theta_h axis of the MERL grid: 90 nodes with quadratic spacing.
    MerlThetaH {
        /// The place of a node in its cell.
        nodes: MerlNodes,
    },
    /// The theta_d and phi_d axes of the MERL grid: 90 × 180 nodes one degree apart, phi_d in [0, π).
    MerlThetaDPhiD {
        /// The place of a node in its cell.
        nodes: MerlNodes,
    },
}

/// A node of a grid: a texel that is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Index of the texel, row by row.
    pub texel: usize,
    /// Unit direction of the texel.
    pub direction: DVec3,
    /// Weight of the node in the integral of cosθ dω; 1 on the MERL grid, which the literature does not
    /// weight.
    pub weight: f64,
}

/// The texels around a direction and their bilinear weights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taps {
    pub(crate) texels: [u32; 4],
    pub(crate) weights: [f32; 4],
}

/// Texels along a side that a grid may have.
const RESOLUTIONS: std::ops::RangeInclusive<usize> = 2..=1024;

impl HemisphereGrid {
    /// Checks that the resolution can be used.
    ///
    /// # Errors
    ///
    /// [`SeparableError::Resolution`] outside 2 to 1024.
    pub fn check(&self) -> Result<(), SeparableError> {
        match *self {
            Self::Plane { resolution, .. } | Self::Radius { resolution, .. }
                if !RESOLUTIONS.contains(&resolution) =>
            {
                let (min, max) = (*RESOLUTIONS.start(), *RESOLUTIONS.end());
                Err(SeparableError::Resolution { resolution, min, max })
            }
            _ => Ok(()),
        }
    }

    /// Returns the numbers of columns and of rows of texels.
    pub fn size(&self) -> [usize; 2] {
        match *self {
            Self::Plane { resolution, .. } => [resolution, resolution],
            Self::Radius { resolution, .. } => [resolution, 1],
            Self::MerlThetaH { .. } => [MerlTable::THETA_H, 1],
            Self::MerlThetaDPhiD { .. } => [MerlTable::PHI_D, MerlTable::THETA_D],
        }
    }

    /// Returns the number of texels.
    pub fn texels(&self) -> usize {
        let [columns, rows] = self.size();
        columns * rows
    }

    /// Returns whether the grid holds polar angles alone.
    pub fn is_radial(&self) -> bool {
        matches!(self, Self::Radius { .. } | Self::MerlThetaH { .. })
    }

    /// Returns the texels that are sampled, in order of their index.
    pub fn nodes(&self) -> Vec<Node> {
        let [columns, rows] = self.size();
        (0..rows)
            .flat_map(|row| (0..columns).map(move |column| (column, row)))
            .filter_map(|(column, row)| {
                let (direction, weight) = self.node(column, row)?;
                Some(Node { texel: row * columns + column, direction, weight })
            })
            .collect()
    }

    fn node(&self, column: usize, row: usize) -> Option<(DVec3, f64)> {
        match *self {
            Self::Plane { map, resolution } => {
                let unit = DVec2::new(column as f64 + 0.5, row as f64 + 0.5) / resolution as f64;
                let (point, area) = match map {
                    HemisphereMap::Parabolic | HemisphereMap::OrthographicDisc => {
                        (2.0 * unit - 1.0, 4.0)
                    }
                    HemisphereMap::Polar => (unit, 1.0),
                    HemisphereMap::Spherical => {
                        (DVec2::new(FRAC_PI_2 * unit.y, TAU * (unit.x - 0.5)), PI * PI)
                    }
                };
                let is_disc =
                    matches!(map, HemisphereMap::Parabolic | HemisphereMap::OrthographicDisc);
                if is_disc && point.length_squared() >= 1.0 {
                    return None;
                }
                let direction = map.decode(point)?;
                let cell = area / (resolution * resolution) as f64;
                Some((direction, direction.z * map.solid_angle_density(point) * cell))
            }
            Self::Radius { map, resolution } => {
                let radius = (column as f64 + 0.5) / resolution as f64;
                let theta = match map {
                    HemisphereMap::Parabolic => 2.0 * radius.atan(),
                    HemisphereMap::OrthographicDisc => radius.asin(),
                    HemisphereMap::Polar => (1.0 - radius * radius).acos(),
                    HemisphereMap::Spherical => FRAC_PI_2 * radius,
                };
                let direction = spherical_direction(theta, 0.0);
                let density = map.solid_angle_density(map.encode(direction));
                // The length of the circle, or of its image.
                let circle = match map {
                    HemisphereMap::Parabolic | HemisphereMap::OrthographicDisc => TAU * radius,
                    HemisphereMap::Polar => 1.0,
                    HemisphereMap::Spherical => PI * PI,
                };
                Some((direction, direction.z * density * circle / resolution as f64))
            }
            Self::MerlThetaH { nodes } => {
                let at = column as f64 + f64::from(nodes.shift());
                Some((spherical_direction((at * at / 90.0).to_radians(), 0.0), 1.0))
            }
            Self::MerlThetaDPhiD { nodes } => {
                let shift = f64::from(nodes.shift());
                let [phi, theta] = [column, row].map(|i| (i as f64 + shift).to_radians());
                Some((spherical_direction(theta, phi), 1.0))
            }
        }
    }

    /// Where a direction of the hemisphere is read.
    pub(crate) fn taps(&self, direction: DVec3) -> Taps {
        let [columns, rows] = self.size();
        let (across, along) = match *self {
            Self::Plane { map, .. } => {
                let point = map.encode(direction);
                let (x, y, wraps) = match map {
                    HemisphereMap::Parabolic | HemisphereMap::OrthographicDisc => {
                        (0.5 * (point.x + 1.0), 0.5 * (point.y + 1.0), false)
                    }
                    HemisphereMap::Polar => (point.x, point.y, true),
                    HemisphereMap::Spherical => (point.y / TAU + 0.5, point.x / FRAC_PI_2, true),
                };
                (Span::new(x, columns, 0.5, wraps), Span::new(y, rows, 0.5, false))
            }
            Self::Radius { map, .. } => {
                let point = map.encode(direction);
                let radius = match map {
                    HemisphereMap::Parabolic | HemisphereMap::OrthographicDisc => point.length(),
                    HemisphereMap::Polar => point.y,
                    HemisphereMap::Spherical => point.x / FRAC_PI_2,
                };
                (Span::new(radius, columns, 0.5, false), Span::ONE)
            }
            Self::MerlThetaH { nodes } => {
                let at = (polar_angle(direction) / FRAC_PI_2).sqrt();
                (Span::new(at, columns, nodes.shift().into(), false), Span::ONE)
            }
            Self::MerlThetaDPhiD { nodes } => {
                let shift = f64::from(nodes.shift());
                let turn = azimuth(direction) / PI;
                let half_turn = if turn < 0.0 { turn + 1.0 } else { turn };
                let theta = polar_angle(direction) / FRAC_PI_2;
                (Span::new(half_turn, columns, shift, true), Span::new(theta, rows, shift, false))
            }
        };
        across.taps(along, columns)
    }

    /// Extends values from the texels that have some to all others, ring by ring: each becomes the
    /// mean of its known neighbours, diagonal ones included. `values` has `width` entries a texel.
    pub(crate) fn fill_unknown(&self, known: &mut [bool], values: &mut [f32], width: usize) {
        let [columns, rows] = self.size();
        if known.iter().all(|k| !k) {
            return;
        }
        while known.contains(&false) {
            let mut ring = Vec::new();
            for texel in (0..known.len()).filter(|&t| !known[t]) {
                let (column, row) = (texel % columns, texel / columns);
                let around: Vec<usize> = (row.saturating_sub(1)..(row + 2).min(rows))
                    .flat_map(|r| {
                        (column.saturating_sub(1)..(column + 2).min(columns))
                            .map(move |c| r * columns + c)
                    })
                    .filter(|&t| known[t])
                    .collect();
                if around.is_empty() {
                    continue;
                }
                let share = 1.0 / f32::from(u8::try_from(around.len()).unwrap_or(8));
                let mean: Vec<f32> = (0..width)
                    .map(|i| around.iter().map(|t| values[t * width + i]).sum::<f32>() * share)
                    .collect();
                ring.push((texel, mean));
            }
            for (texel, mean) in ring {
                values[texel * width..][..width].copy_from_slice(&mean);
                known[texel] = true;
            }
        }
    }
}

/// Two neighbouring texels along an axis and the share of the second.
struct Span {
    first: usize,
    second: usize,
    share: f32,
}

impl Span {
    /// The only texel of an axis.
    const ONE: Self = Self { first: 0, second: 0, share: 0.0 };

    /// Around `at` in [0, 1], where texel i stands at (i + shift) / count.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positions are brought into the grid first"
    )]
    fn new(at: f64, count: usize, shift: f64, wraps: bool) -> Self {
        let position = at * count as f64 - shift;
        if wraps {
            let low = position.floor();
            let first = (low + count as f64) as usize % count;
            return Self { first, second: (first + 1) % count, share: (position - low) as f32 };
        }
        let position = position.clamp(0.0, (count - 1) as f64);
        let first = (position as usize).min(count.saturating_sub(2));
        let second = (first + 1).min(count - 1);
        Self { first, second, share: (position - first as f64) as f32 }
    }

    fn taps(&self, rows: Self, columns: usize) -> Taps {
        let (x, y) = (self.share, rows.share);
        let texel = |row: usize, column: usize| {
            // Charts have at most 1024² texels.
            u32::try_from(row * columns + column).unwrap_or(u32::MAX)
        };
        Taps {
            texels: [
                texel(rows.first, self.first),
                texel(rows.first, self.second),
                texel(rows.second, self.first),
                texel(rows.second, self.second),
            ],
            weights: [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn charts() -> Vec<HemisphereGrid> {
        HemisphereMap::ALL
            .into_iter()
            .flat_map(|map| {
                [
                    HemisphereGrid::Plane { map, resolution: 48 },
                    HemisphereGrid::Radius { map, resolution: 48 },
                ]
            })
            .collect()
    }

    #[test]
    fn weights_integrate_the_cosine_to_pi() {
        for chart in charts() {
            let total: f64 = chart.nodes().iter().map(|node| node.weight).sum();
            assert!((total / PI - 1.0).abs() < 0.01, "{chart:?}: {total}");
        }
    }

    #[test]
    fn the_orthographic_disc_of_48_texels_has_1804_equal_ones() {
        let chart = HemisphereGrid::Plane { map: HemisphereMap::OrthographicDisc, resolution: 48 };
        let nodes = chart.nodes();
        assert_eq!(nodes.len(), 1804);
        assert!(nodes.iter().all(|n| (n.weight / nodes[0].weight - 1.0).abs() < 1e-9));
    }

    #[test]
    fn a_node_is_read_from_its_own_texel() {
        let merl = [MerlNodes::Centre, MerlNodes::Edge].into_iter().flat_map(|nodes| {
            [HemisphereGrid::MerlThetaH { nodes }, HemisphereGrid::MerlThetaDPhiD { nodes }]
        });
        for chart in charts().into_iter().chain(merl) {
            for node in chart.nodes() {
                let taps = chart.taps(node.direction);
                let own: f32 = (0..4)
                    .filter(|&i| taps.texels[i] as usize == node.texel)
                    .map(|i| taps.weights[i])
                    .sum();
                // At the pole phi_d is undefined, and any of its texels may answer.
                let at_pole = node.direction.z > 1.0 - 1e-12;
                assert!(own > 0.999 || at_pole, "{chart:?}: {own} of {node:?}");
            }
        }
    }

    #[test]
    fn rims_continue_what_is_known() {
        let chart = HemisphereGrid::Plane { map: HemisphereMap::OrthographicDisc, resolution: 8 };
        let mut known = vec![false; 64];
        let mut values = vec![0.0; 128];
        for node in chart.nodes() {
            known[node.texel] = true;
            values[2 * node.texel] = 3.0;
            values[2 * node.texel + 1] = -1.0;
        }
        chart.fill_unknown(&mut known, &mut values, 2);
        assert!(values.chunks(2).all(|v| (v[0] - 3.0).abs() < 1e-5 && (v[1] + 1.0).abs() < 1e-5));
    }
}
