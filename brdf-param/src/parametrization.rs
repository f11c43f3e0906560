//! All parametrizations behind one name, for code that chooses among them at run time.

use std::str::FromStr;

use glam::{DVec2, DVec4};
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

use crate::{
    DirectionPair, HalfDifference, Hybrid, KautzMcCool, OnionSlice, Orthographic, ParamError,
    Standard,
};

/// Four coordinates of a direction pair, in the order of [`Parametrization::axes`]; angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinates(pub DVec4);

/// A change of variables of the BRDF domain: a bijection between direction pairs and four
/// coordinates, up to the degenerate pairs named on each type.
///
/// ```
/// use brdf_param::{DirectionPair, Parametrization};
///
/// let pair = DirectionPair::from_angles(0.3, 0.1, 0.9, 2.0);
/// for parametrization in Parametrization::ALL {
///     let coordinates = parametrization.forward(&pair);
///     let back = parametrization.inverse(coordinates).expect("it comes from a pair");
///     assert!(back.wi.distance(pair.wi) < 1e-12 && back.wo.distance(pair.wo) < 1e-12);
/// }
/// let parsed: Parametrization = "half-difference".parse()?;
/// assert_eq!(parsed.axes(), ["theta_h", "phi_h", "theta_d", "phi_d"]);
/// # Ok::<(), brdf_param::ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Parametrization {
    /// Spherical angles of `wi` and `wo`: [`Standard`].
    Standard,
    /// Spherical angles of the half and the difference vector (Rusinkiewicz): [`HalfDifference`].
    HalfDifference,
    /// Parabolic coordinates of half and difference vector in the frame of the tangent:
    /// [`KautzMcCool`].
    #[cfg_attr(feature = "serde", serde(rename = "kautz-mccool"))]
    KautzMcCool,
    /// Tangent-plane parts of half and back vector: [`Orthographic`].
    Orthographic,
    /// Tangent-plane part of the half vector, full length of the back vector: [`Hybrid`].
    Hybrid,
    /// The light in slices across the view azimuth, and the view: [`OnionSlice`].
    OnionSlice,
}

impl Parametrization {
    /// All six parametrizations.
    pub const ALL: [Self; 6] = [
        Self::Standard,
        Self::HalfDifference,
        Self::KautzMcCool,
        Self::Orthographic,
        Self::Hybrid,
        Self::OnionSlice,
    ];

    /// Returns the name used in files and on the command line, such as "half-difference".
    pub fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::HalfDifference => "half-difference",
            Self::KautzMcCool => "kautz-mccool",
            Self::Orthographic => "orthographic",
            Self::Hybrid => "hybrid",
            Self::OnionSlice => "onion-slice",
        }
    }

    /// Returns the names of the four coordinates.
    pub fn axes(self) -> [&'static str; 4] {
        match self {
            Self::Standard => ["theta_i", "phi_i", "theta_o", "phi_o"],
            Self::HalfDifference => ["theta_h", "phi_h", "theta_d", "phi_d"],
            Self::KautzMcCool => ["h_x", "h_y", "d_x", "d_y"],
            Self::Orthographic | Self::Hybrid => ["h_length", "phi_h", "k_length", "phi_k"],
            Self::OnionSlice => ["alpha", "sin_beta", "theta_v", "phi_v"],
        }
    }

    /// Returns the coordinates of a pair whose directions are above the horizon.
    pub fn forward(self, pair: &DirectionPair) -> Coordinates {
        Point::from_pair(self, pair).coordinates()
    }

    /// Returns the pair at these coordinates, or `None` outside the domain.
    pub fn inverse(self, coordinates: Coordinates) -> Option<DirectionPair> {
        let point = Point::new(self, coordinates);
        if !point.is_in_domain() {
            return None;
        }
        point.to_pair()
    }

    /// Returns whether the coordinates belong to two directions above the horizon.
    pub fn contains(self, coordinates: Coordinates) -> bool {
        coordinates.0.is_finite() && Point::new(self, coordinates).is_in_domain()
    }

    /// Returns the coordinates of a pair with light and viewer exchanged, from those of the pair.
    pub fn reciprocal(self, coordinates: Coordinates) -> Coordinates {
        match Point::new(self, coordinates) {
            Point::Standard(p) => Point::Standard(p.reciprocal()),
            Point::HalfDifference(p) => Point::HalfDifference(p.reciprocal()),
            Point::KautzMcCool(p) => Point::KautzMcCool(p.reciprocal()),
            Point::Orthographic(p) => Point::Orthographic(p.reciprocal()),
            Point::Hybrid(p) => Point::Hybrid(p.reciprocal()),
            Point::OnionSlice(p) => Point::OnionSlice(p.reciprocal()),
        }
        .coordinates()
    }

    /// Returns the coordinates of a pair turned about the normal to a canonical azimuth, from those of
    /// the pair. Pairs that an isotropic BRDF cannot tell apart get the same coordinates.
    pub fn isotropic(self, coordinates: Coordinates) -> Coordinates {
        match Point::new(self, coordinates) {
            Point::Standard(p) => Point::Standard(p.isotropic()),
            Point::HalfDifference(p) => Point::HalfDifference(p.isotropic()),
            Point::KautzMcCool(p) => Point::KautzMcCool(p.isotropic()),
            Point::Orthographic(p) => Point::Orthographic(p.isotropic()),
            Point::Hybrid(p) => Point::Hybrid(p.isotropic()),
            Point::OnionSlice(p) => Point::OnionSlice(p.isotropic()),
        }
        .coordinates()
    }
}

impl FromStr for Parametrization {
    type Err = ParamError;

    fn from_str(name: &str) -> Result<Self, ParamError> {
        Self::ALL.into_iter().find(|p| p.name() == name).ok_or_else(|| ParamError::UnknownName {
            name: name.to_owned(),
            expected: Self::ALL.map(Self::name).join(", "),
        })
    }
}

/// One point in whichever parametrization.
enum Point {
    Standard(Standard),
    HalfDifference(HalfDifference),
    KautzMcCool(KautzMcCool),
    Orthographic(Orthographic),
    Hybrid(Hybrid),
    OnionSlice(OnionSlice),
}

impl Point {
    fn from_pair(parametrization: Parametrization, pair: &DirectionPair) -> Self {
        match parametrization {
            Parametrization::Standard => Self::Standard(Standard::from_pair(pair)),
            Parametrization::HalfDifference => {
                Self::HalfDifference(HalfDifference::from_pair(pair))
            }
            Parametrization::KautzMcCool => Self::KautzMcCool(KautzMcCool::from_pair(pair)),
            Parametrization::Orthographic => Self::Orthographic(Orthographic::from_pair(pair)),
            Parametrization::Hybrid => Self::Hybrid(Hybrid::from_pair(pair)),
            Parametrization::OnionSlice => Self::OnionSlice(OnionSlice::from_pair(pair)),
        }
    }

    fn new(parametrization: Parametrization, Coordinates(c): Coordinates) -> Self {
        match parametrization {
            Parametrization::Standard => {
                Self::Standard(Standard { theta_i: c.x, phi_i: c.y, theta_o: c.z, phi_o: c.w })
            }
            Parametrization::HalfDifference => Self::HalfDifference(HalfDifference {
                theta_h: c.x,
                phi_h: c.y,
                theta_d: c.z,
                phi_d: c.w,
            }),
            Parametrization::KautzMcCool => {
                Self::KautzMcCool(KautzMcCool { h: DVec2::new(c.x, c.y), d: DVec2::new(c.z, c.w) })
            }
            Parametrization::Orthographic => Self::Orthographic(Orthographic {
                h_length: c.x,
                phi_h: c.y,
                k_length: c.z,
                phi_k: c.w,
            }),
            Parametrization::Hybrid => {
                Self::Hybrid(Hybrid { h_length: c.x, phi_h: c.y, k_length: c.z, phi_k: c.w })
            }
            Parametrization::OnionSlice => {
                Self::OnionSlice(OnionSlice { alpha: c.x, sin_beta: c.y, theta_v: c.z, phi_v: c.w })
            }
        }
    }

    fn coordinates(&self) -> Coordinates {
        Coordinates(match self {
            Self::Standard(p) => DVec4::new(p.theta_i, p.phi_i, p.theta_o, p.phi_o),
            Self::HalfDifference(p) => DVec4::new(p.theta_h, p.phi_h, p.theta_d, p.phi_d),
            Self::KautzMcCool(p) => DVec4::new(p.h.x, p.h.y, p.d.x, p.d.y),
            Self::Orthographic(p) => DVec4::new(p.h_length, p.phi_h, p.k_length, p.phi_k),
            Self::Hybrid(p) => DVec4::new(p.h_length, p.phi_h, p.k_length, p.phi_k),
            Self::OnionSlice(p) => DVec4::new(p.alpha, p.sin_beta, p.theta_v, p.phi_v),
        })
    }

    fn to_pair(&self) -> Option<DirectionPair> {
        match self {
            Self::Standard(p) => Some(p.to_pair()),
            Self::HalfDifference(p) => Some(p.to_pair()),
            Self::KautzMcCool(p) => p.to_pair(),
            Self::Orthographic(p) => p.to_pair(),
            Self::Hybrid(p) => Some(p.to_pair()),
            Self::OnionSlice(p) => Some(p.to_pair()),
        }
    }

    fn is_in_domain(&self) -> bool {
        match self {
            Self::Standard(p) => p.is_in_domain(),
            Self::HalfDifference(p) => p.is_in_domain(),
            Self::KautzMcCool(p) => p.is_in_domain(),
            Self::Orthographic(p) => p.is_in_domain(),
            Self::Hybrid(p) => p.is_in_domain(),
            Self::OnionSlice(p) => p.is_in_domain(),
        }
    }
}
