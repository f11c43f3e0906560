//! Parametrizations on the hemisphere of lights over one viewer: how round their isolines are there, and where a
//! highlight lies in them.

use std::f64::consts::{PI, TAU};

use brdf_model::Brdf;
use brdf_param::{DirectionPair, Parametrization, spherical_direction};
use glam::{DVec2, DVec3};

use crate::slice::share_of;

/// A direction about which isolines close on the hemisphere of lights, for a viewer at azimuth 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Centre {
    /// The mirror direction, where the first coordinate of parametrizations by half vectors is 0.
    Mirror,
    /// The viewer's own direction, where their second coordinate is 0.
    Back,
}

impl Centre {
    /// Both, the mirror direction first.
    pub const ALL: [Self; 2] = [Self::Mirror, Self::Back];

    /// Returns the name, "mirror" or "back".
    pub fn name(self) -> &'static str {
        match self {
            Self::Mirror => "mirror",
            Self::Back => "back",
        }
    }

    /// Returns the azimuth of the direction, radians.
    pub fn azimuth(self) -> f64 {
        match self {
            Self::Mirror => PI,
            Self::Back => 0.0,
        }
    }

    /// Returns the direction for a viewer at `theta_o` radians from the normal.
    pub fn direction(self, theta_o: f64) -> DVec3 {
        spherical_direction(theta_o, self.azimuth())
    }

    /// The coordinate that is 0 there.
    fn coordinate(self) -> usize {
        match self {
            Self::Mirror => 0,
            Self::Back => 1,
        }
    }
}

/// What is a circle on the hemisphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Circle {
    /// Directions at one angle from the centre.
    ByAngle,
    /// Directions that lie on a circle when the hemisphere is seen from above.
    FromAbove,
}

/// Returns the two radial coordinates of a pair as shares of their ranges, [0, 1].
///
/// ```
/// use brdf_param::{DirectionPair, Parametrization};
///
/// let pair = DirectionPair::from_angles(0.5, 0.0, 0.5, std::f64::consts::PI);
/// let [half, back] = brdf_study::radial_shares(Parametrization::Hybrid, &pair);
/// assert!(half < 1e-12 && (back - 0.5_f64.sin()).abs() < 1e-12);
/// ```
pub fn radial_shares(parametrization: Parametrization, pair: &DirectionPair) -> [f64; 2] {
    parametrization.isotropic_hemispheres(pair).map(|point| share_of(parametrization, point))
}

/// Directions that are tried along a circle.
const STEPS: u32 = 720;

/// Returns how many times larger the coordinate that is 0 at a centre gets than its smallest value, along a circle
/// about that centre: 1 where its isolines are such circles. `None` where no direction of the circle lies above
/// the horizon.
///
/// The viewer stands at `theta_o` radians. `radius` is in radians, seen from above a length. Directions below the
/// horizon are left out.
///
/// ```
/// use brdf_param::Parametrization;
/// use brdf_study::{Centre, Circle, ring_spread};
///
/// let spread = |p| ring_spread(p, Centre::Mirror, 1.3, Circle::FromAbove, 0.1);
/// assert!(spread(Parametrization::Orthographic).is_some_and(|times| times < 1.0 + 1e-9));
/// assert!(spread(Parametrization::HalfDifference).is_some_and(|times| times > 2.0));
/// ```
pub fn ring_spread(
    parametrization: Parametrization,
    centre: Centre,
    theta_o: f64,
    circle: Circle,
    radius: f64,
) -> Option<f64> {
    let wo = Centre::Back.direction(theta_o);
    let middle = centre.direction(theta_o);
    let (tangent, bitangent) = middle.any_orthonormal_pair();
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for step in 0..STEPS {
        let around = TAU * f64::from(step) / f64::from(STEPS);
        let light = match circle {
            Circle::ByAngle => {
                let sideways = around.cos() * tangent + around.sin() * bitangent;
                Some(radius.cos() * middle + radius.sin() * sideways)
            }
            Circle::FromAbove => above(middle.truncate() + radius * DVec2::from_angle(around)),
        };
        let Some(wi) = light.filter(|wi| wi.z > 0.0) else { continue };
        let value =
            radial_shares(parametrization, &DirectionPair::new(wi, wo))[centre.coordinate()];
        (low, high) = (low.min(value), high.max(value));
    }
    (high > 0.0).then(|| high / low)
}

/// The direction over a point of the disc, where there is one.
fn above(point: DVec2) -> Option<DVec3> {
    let height_sq = 1.0 - point.length_squared();
    (height_sq > 0.0).then(|| point.extend(height_sq.sqrt()))
}

/// Lights along the polar angle and around, over which a highlight is gathered.
const POLAR: u32 = 240;
const AROUND: u32 = 720;
/// Lights nearer to the horizon are left out: measurements are worst there.
const THETA_MAX: f64 = 80.0 * PI / 180.0;

/// Returns the centre of a material's highlight for a viewer at `theta_o` radians: both radial coordinates as shares
/// of their ranges, or `None` where nothing is reflected.
///
/// The highlight is the lights within 80° of the normal that are at least half as bright as the brightest. The
/// centre is their mean, weighted by luminance and solid angle. Where the first coordinate is 0 at the mirror
/// direction, the first number is the size of the highlight.
///
/// ```
/// use brdf_param::Parametrization;
///
/// let gold = brdf_model::Preset::find("ggx").expect("a preset").brdf();
/// let centre = |p| brdf_study::highlight_centre(&gold, p, 0.5).expect("gold reflects");
/// assert!(centre(Parametrization::Standard)[0] > 0.2, "near 0.5 rad of a quarter turn");
/// assert!(centre(Parametrization::HalfDifference)[0] < 0.2, "around the normal");
/// ```
pub fn highlight_centre(
    brdf: &dyn Brdf,
    parametrization: Parametrization,
    theta_o: f64,
) -> Option<[f64; 2]> {
    let wo = Centre::Back.direction(theta_o);
    let mut lights = Vec::new();
    for polar in 0..POLAR {
        let theta_i = THETA_MAX * (f64::from(polar) + 0.5) / f64::from(POLAR);
        for around in 0..AROUND {
            let phi = TAU * (f64::from(around) + 0.5) / f64::from(AROUND);
            let pair = DirectionPair::new(spherical_direction(theta_i, phi), wo);
            if brdf.has_data(&pair) {
                lights.push((pair, brdf.eval(&pair).luminance()));
            }
        }
    }
    let brightest = lights.iter().map(|light| light.1).fold(0.0_f64, f64::max);
    if !(brightest > 0.0 && brightest.is_finite()) {
        return None;
    }
    let (mut sum, mut whole) = (DVec2::ZERO, 0.0);
    for (pair, luminance) in lights.iter().filter(|light| light.1 >= 0.5 * brightest) {
        // Cells of equal angles cover less near the normal.
        let weight = luminance * (1.0 - pair.wi.z * pair.wi.z).max(0.0).sqrt();
        sum += weight * DVec2::from_array(radial_shares(parametrization, pair));
        whole += weight;
    }
    (whole > 0.0).then(|| (sum / whole).to_array())
}

#[cfg(test)]
mod tests {
    use brdf_model::Rgb;

    use super::*;
    use crate::TestFunction;

    const GRAZING: f64 = 75.0 * PI / 180.0;

    fn spread(parametrization: Parametrization, centre: Centre, circle: Circle) -> f64 {
        ring_spread(parametrization, centre, GRAZING, circle, 0.1).expect("a circle above")
    }

    #[test]
    fn isolines_about_the_viewer_are_circles_by_angle_or_from_above() {
        for round in [Parametrization::HalfDifference, Parametrization::Hybrid] {
            assert!((spread(round, Centre::Back, Circle::ByAngle) - 1.0).abs() < 1e-9);
            assert!(spread(round, Centre::Back, Circle::FromAbove) > 2.0);
        }
        let flat = Parametrization::Orthographic;
        assert!((spread(flat, Centre::Back, Circle::FromAbove) - 1.0).abs() < 1e-9);
        assert!(spread(flat, Centre::Back, Circle::ByAngle) > 2.0);
    }

    #[test]
    fn lengths_of_half_vectors_are_round_from_above_and_angles_nowhere() {
        for flat in [Parametrization::Orthographic, Parametrization::Hybrid] {
            assert!((spread(flat, Centre::Mirror, Circle::FromAbove) - 1.0).abs() < 1e-9);
        }
        for circle in [Circle::ByAngle, Circle::FromAbove] {
            assert!(spread(Parametrization::HalfDifference, Centre::Mirror, circle) > 2.0);
        }
    }

    #[test]
    fn a_circle_beyond_the_horizon_has_no_spread() {
        let far = ring_spread(Parametrization::Hybrid, Centre::Mirror, 0.2, Circle::FromAbove, 1.5);
        assert_eq!(far, None);
    }

    #[test]
    fn a_highlight_over_lengths_keeps_its_size_over_lengths_alone() {
        // Bright where the half vector's part in the plane is shorter than 0.1.
        struct Disc;
        impl Brdf for Disc {
            fn eval(&self, pair: &DirectionPair) -> Rgb {
                let bright = TestFunction::Specular.value(pair) > 0.9;
                Rgb::splat(if bright { 1.0 } else { 0.1 })
            }
        }
        let size = |parametrization, theta_o: f64| {
            highlight_centre(&Disc, parametrization, theta_o).expect("it reflects")[0]
        };
        let [steep, low] = [0.3, 1.1].map(|theta_o| size(Parametrization::Hybrid, theta_o));
        assert!((low - steep).abs() < 0.01, "{steep} and {low}");
        let [steep, low] = [0.3, 1.1].map(|theta_o| size(Parametrization::HalfDifference, theta_o));
        assert!(low > 1.5 * steep, "{steep} and {low}");
    }

    #[test]
    fn a_black_material_has_no_highlight() {
        struct Black;
        impl Brdf for Black {
            fn eval(&self, _: &DirectionPair) -> Rgb {
                Rgb::BLACK
            }
        }
        assert_eq!(highlight_centre(&Black, Parametrization::Standard, 0.8), None);
    }
}
