//! Light that comes by way of the surface itself: one diffuse bounce.

use rayon::prelude::*;

use crate::height_field::{HeightField, Place};
use crate::horizon::normal;
use crate::lights::{LANES, Lanes};
use crate::points::cosine_direction;

/// For each texel and channel the irradiance under each light that other texels reflect, by
/// `ray_count` rays spread as the cosine over the hemisphere of the smooth normal. A texel that a
/// ray meets sends back its albedo times its `direct` irradiance. At most 1, as that is.
pub(crate) fn indirect_irradiance(
    field: &HeightField,
    albedo: &[[f32; 3]],
    direct: &[Lanes],
    ray_count: u32,
) -> Vec<[Lanes; 3]> {
    let rays: Vec<Place> = (0..ray_count).map(|ray| cosine_direction(ray, ray_count)).collect();
    let share = 1.0 / ray_count as f32;
    (0..field.width * field.height)
        .into_par_iter()
        .map(|texel| {
            let start = field.centre(texel);
            let frame = Frame::around(normal(field.gradient(texel)));
            let hits = rays.iter().filter_map(|&ray| field.hit_from(start, frame.to_world(ray)));
            let mut sums = [[0.0; LANES]; 3];
            for hit in hits {
                let source = field.taps(hit).nearest();
                let weights = albedo[source].map(|value| value * share);
                add(&mut sums, weights, &direct[source]);
            }
            sums
        })
        .collect()
}

fn add(sums: &mut [Lanes; 3], weights: [f32; 3], irradiance: &Lanes) {
    for (sum, weight) in sums.iter_mut().zip(weights) {
        for (value, from) in sum.iter_mut().zip(irradiance) {
            *value += weight * from;
        }
    }
}

/// Axes with z along a normal.
pub(crate) struct Frame {
    axes: [Place; 3],
}

impl Frame {
    /// Axes around a unit normal with z > 0.
    ///
    /// Source: T. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017, without
    /// the case of normals that point down.
    pub(crate) fn around([x, y, z]: Place) -> Self {
        let a = -1.0 / (1.0 + z);
        let b = x * y * a;
        Self { axes: [[1.0 + x * x * a, b, -x], [b, 1.0 + y * y * a, -y], [x, y, z]] }
    }

    pub(crate) fn to_world(&self, [x, y, z]: Place) -> Place {
        let [tangent, bitangent, normal] = &self.axes;
        std::array::from_fn(|i| x * tangent[i] + y * bitangent[i] + z * normal[i])
    }

    pub(crate) fn to_local(&self, direction: Place) -> Place {
        self.axes
            .map(|axis| axis[0] * direction[0] + axis[1] * direction[1] + axis[2] * direction[2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[expect(clippy::float_cmp, reason = "the third axis is the normal itself")]
    fn a_frame_turns_there_and_back() {
        let frame = Frame::around([0.48, -0.6, 0.64]);
        assert_eq!(frame.to_world([0.0, 0.0, 1.0]), [0.48, -0.6, 0.64]);
        let there = frame.to_local([0.0, 0.6, 0.8]);
        let back = frame.to_world(there);
        assert!((back[1] - 0.6).abs() < 1e-6 && (back[2] - 0.8).abs() < 1e-6, "{back:?}");
    }
}
