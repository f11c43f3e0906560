//! Every parametrization as two points of the unit hemisphere.
//!
//! A BRDF as a sum of products is a sum of functions of the first point times functions of the second.

use glam::{DVec2, DVec3, DVec4};

use crate::direction::{azimuth, spherical_direction};
use crate::{
    Coordinates, DirectionPair, HalfDifference, HemisphereMap, KautzMcCool, OnionSlice,
    Parametrization,
};

impl Parametrization {
    /// Returns the names of the two points that [`Parametrization::hemispheres`] returns.
    pub fn hemisphere_names(self) -> [&'static str; 2] {
        match self {
            Self::Standard => ["wi", "wo"],
            Self::HalfDifference | Self::KautzMcCool => ["h", "d"],
            Self::Orthographic | Self::Hybrid => ["h", "k"],
            Self::OnionSlice => ["wo", "wi"],
        }
    }

    /// Returns the names of the three coordinates that an isotropic BRDF depends on: the radii of both
    /// points, and the azimuth between them.
    pub fn isotropic_names(self) -> [&'static str; 3] {
        match self {
            Self::Standard => ["theta_i", "theta_o", "phi_o - phi_i"],
            Self::HalfDifference => ["theta_h", "theta_d", "phi_d"],
            Self::KautzMcCool => ["h_radius", "d_radius", "phi_d"],
            Self::Orthographic | Self::Hybrid => ["h_length", "k_length", "phi_k - phi_h"],
            Self::OnionSlice => ["theta_v", "theta_i", "phi_i - phi_v"],
        }
    }

    /// Returns a pair as two points of the unit hemisphere, which carry two coordinates each.
    ///
    /// Standard: wi, wo. Half/difference and Kautz–McCool: half and difference vector.
    /// Orthographic and hybrid: h̄ and k, whose lengths are the sines of polar angles. Onion slices:
    /// the view, then the light in the frame of the view's azimuth.
    ///
    /// ```
    /// use brdf_param::{DirectionPair, Parametrization};
    ///
    /// let pair = DirectionPair::from_angles(0.3, 0.1, 0.9, 2.0);
    /// let [half, difference] = Parametrization::HalfDifference.hemispheres(&pair);
    /// assert!(half.distance(pair.half()) < 1e-15);
    /// let back = Parametrization::HalfDifference.from_hemispheres([half, difference]);
    /// assert!(back.is_some_and(|back| back.wi.distance(pair.wi) < 1e-12));
    /// ```
    pub fn hemispheres(self, pair: &DirectionPair) -> [DVec3; 2] {
        match self {
            Self::Standard => [pair.wi, pair.wo],
            Self::HalfDifference => HalfDifference::vectors(pair),
            Self::KautzMcCool => KautzMcCool::vectors(pair),
            Self::Orthographic => {
                let (wi, wo) = (pair.wi.truncate(), pair.wo.truncate());
                [lifted(0.5 * (wi + wo)), lifted(0.5 * (wi - wo))]
            }
            Self::Hybrid => {
                let (h, k) = (0.5 * (pair.wi + pair.wo), 0.5 * (pair.wi - pair.wo));
                let along = k.truncate().try_normalize().unwrap_or(DVec2::X);
                [lifted(h.truncate()), lifted(k.length() * along)]
            }
            Self::OnionSlice => {
                let turned = pair.rotated_about_normal(-azimuth(pair.wo));
                [pair.wo, turned.wi]
            }
        }
    }

    /// Returns the pair at two points of the hemisphere, or `None` where one of its directions would lie
    /// below the horizon.
    pub fn from_hemispheres(self, [first, second]: [DVec3; 2]) -> Option<DirectionPair> {
        let polar = |w: DVec3| DVec2::new(crate::polar_angle(w), azimuth(w));
        let planar = |w: DVec3| DVec2::new(w.truncate().length(), azimuth(w));
        let parabolic = |w: DVec3| HemisphereMap::Parabolic.encode(w);
        let (a, b) = match self {
            Self::Standard => {
                let pair = DirectionPair::new(first, second);
                return pair.is_above_horizon().then_some(pair);
            }
            Self::HalfDifference => (polar(first), polar(second)),
            Self::KautzMcCool => (parabolic(first), parabolic(second)),
            Self::Orthographic | Self::Hybrid => (planar(first), planar(second)),
            Self::OnionSlice => {
                let (alpha, sin_beta) = OnionSlice::light(second, 0.0);
                (DVec2::new(alpha, sin_beta), polar(first))
            }
        };
        self.inverse(Coordinates(DVec4::new(a.x, a.y, b.x, b.y)))
    }

    /// Returns the two points of a pair that is first turned about the normal so that the first point
    /// has azimuth 0.
    ///
    /// Three coordinates remain, all that an isotropic BRDF depends on. Where the first point is the normal, the second
    /// has azimuth 0.
    pub fn isotropic_hemispheres(self, pair: &DirectionPair) -> [DVec3; 2] {
        let [first, second] = match self {
            // The frame of Kautz and McCool is tied to the tangent; turned, it is Rusinkiewicz's.
            Self::KautzMcCool => HalfDifference::vectors(pair),
            _ => self.hemispheres(pair),
        };
        let second = match self {
            Self::HalfDifference | Self::KautzMcCool | Self::OnionSlice => second,
            Self::Standard | Self::Orthographic | Self::Hybrid => {
                let radius = first.truncate().length();
                let (cos, sin) =
                    if radius > 0.0 { (first.x / radius, first.y / radius) } else { (1.0, 0.0) };
                let (x, y) = (second.x, second.y);
                DVec3::new(cos * x + sin * y, cos * y - sin * x, second.z)
            }
        };
        let radius = first.truncate().length();
        // What rounding leaves of a point on the normal has no azimuth, so that none is left between the two.
        let second = if radius > ON_NORMAL {
            second
        } else {
            DVec3::new(second.truncate().length(), 0.0, second.z)
        };
        [DVec3::new(radius, 0.0, first.z), second]
    }

    /// Returns the pair at two points of which the first has azimuth 0, or `None` where one of its
    /// directions would lie below the horizon; see [`Parametrization::isotropic_hemispheres`].
    pub fn from_isotropic_hemispheres(self, points: [DVec3; 2]) -> Option<DirectionPair> {
        match self {
            Self::KautzMcCool => Self::HalfDifference.from_hemispheres(points),
            _ => self.from_hemispheres(points),
        }
    }

    /// Returns the pair at polar angles `first` and `second` of both points and the `azimuth` between
    /// them, all in radians, or `None` where one of its directions would lie below the horizon.
    ///
    /// For coordinates that are lengths, the angles are the arcsines of the lengths.
    pub fn isotropic_pair(self, first: f64, second: f64, azimuth: f64) -> Option<DirectionPair> {
        let points = [spherical_direction(first, 0.0), spherical_direction(second, azimuth)];
        self.from_isotropic_hemispheres(points)
    }
}

/// Rounding moves a point from the normal by less than this.
const ON_NORMAL: f64 = 1e-12;

/// The point of the hemisphere above a point of the disc; rounding may leave it below the rim.
fn lifted(point: DVec2) -> DVec3 {
    point.extend((1.0 - point.length_squared()).max(0.0).sqrt())
}
