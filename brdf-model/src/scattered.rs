//! Scattered measurements interpolated to a function, for pictures only.
//!
//! Fits do not use this interpolation; they take the samples as they are.

use brdf_param::{DirectionPair, polar_angle};
use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::brdf::is_lit;
use crate::{Brdf, Rgb, SampleSet};

/// An isotropic, reciprocal material given by scattered samples, interpolated between the nearest ones
/// with weights of inverse distance.
///
/// Distance is taken between the products sinθi sinθo cosΔφ, sinθi sinθo |sinΔφ| and cosθi cosθo,
/// which rotation, mirroring and reciprocity do not change (the idea is pbrt-v2's). Where no sample
/// lies within [`ScatteredBrdf::REACH`], and more than a degree beyond the measured directions,
/// there is no data.
///
/// ```
/// use brdf_model::{Brdf, Channels, Rgb, SampleSet, ScatteredBrdf};
/// use brdf_param::DirectionPair;
///
/// let pair = DirectionPair::from_angles(0.4, 0.0, 0.4, 2.0);
/// let mut samples = SampleSet::new(Channels::Rgb);
/// samples.push_rgb(&pair, Rgb::splat(0.2));
/// let material = ScatteredBrdf::new(samples);
/// let turned = pair.rotated_about_normal(1.0).swapped();
/// assert!((material.eval(&turned).g - 0.2).abs() < 1e-12);
/// ```
#[derive(Debug)]
pub struct ScatteredBrdf {
    tree: RTree<GeomWithData<[f64; 3], usize>>,
    samples: SampleSet,
    /// Heights of the lowest measured direction, less a degree.
    lowest: f64,
}

impl ScatteredBrdf {
    /// Largest distance of a sample that is used: about 6° for a direction halfway to the horizon.
    pub const REACH: f64 = 0.1;
    /// Samples that are averaged.
    const NEIGHBOURS: usize = 8;

    /// Returns the interpolation of a set of samples.
    pub fn new(samples: SampleSet) -> Self {
        let points = samples
            .pairs()
            .enumerate()
            .map(|(index, pair)| GeomWithData::new(invariants(&pair), index))
            .collect();
        let farthest = samples
            .pairs()
            .map(|pair| polar_angle(pair.wi).max(polar_angle(pair.wo)))
            .fold(0.0, f64::max);
        let lowest = (farthest + 1_f64.to_radians()).cos();
        Self { tree: RTree::bulk_load(points), samples, lowest }
    }

    /// Returns the samples that are interpolated.
    pub fn samples(&self) -> &SampleSet {
        &self.samples
    }

    fn interpolate(&self, pair: &DirectionPair) -> Option<Rgb> {
        if !is_lit(pair) || pair.wi.z.min(pair.wo.z) < self.lowest {
            return None;
        }
        let mut sum = Rgb::BLACK;
        let mut total = 0.0;
        let nearest = self.tree.nearest_neighbor_iter_with_distance_2(invariants(pair));
        for (point, distance_sq) in nearest.take(Self::NEIGHBOURS) {
            if distance_sq > Self::REACH * Self::REACH {
                break;
            }
            // The floor keeps a sample that is hit exactly from dividing by zero.
            let weight = 1.0 / (distance_sq + 1e-12);
            sum = sum + self.samples.rgb(point.data) * weight;
            total += weight;
        }
        (total > 0.0).then(|| sum / total)
    }
}

impl Brdf for ScatteredBrdf {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        self.interpolate(pair).unwrap_or(Rgb::BLACK)
    }

    fn has_data(&self, pair: &DirectionPair) -> bool {
        self.interpolate(pair).is_some()
    }
}

fn invariants(pair: &DirectionPair) -> [f64; 3] {
    let (a, b) = (pair.wi.truncate(), pair.wo.truncate());
    [a.dot(b), a.perp_dot(b).abs(), pair.wi.z * pair.wo.z]
}
