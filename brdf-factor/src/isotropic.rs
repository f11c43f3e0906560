//! Coordinates that do not change when both directions turn about the normal.

use std::f64::consts::{FRAC_PI_2, PI};

use brdf_param::DirectionPair;
use serde::{Deserialize, Serialize};

use crate::Grid;

/// A number, in radians, that is the same for all pairs which differ by a turn about the normal.
///
/// Half and difference angles are those of [`HalfDifference`](brdf_param::HalfDifference); φd is 0 where wi is the
/// direction farther from the normal. Mirroring a pair changes the sign of φd, exchanging light and viewer adds π.
///
/// ```
/// use brdf_factor::Angle;
///
/// assert!(Angle::ThetaD.is_reciprocal() && Angle::PhiDFolded.is_reciprocal());
/// assert!(!Angle::PhiD.is_reciprocal());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Angle {
    /// θh, between half vector and normal, [0, π/2].
    ThetaH,
    /// θd, between half vector and either direction, [0, π/2].
    ThetaD,
    /// |φd|, [0, π]: the same for mirrored pairs.
    PhiD,
    /// φd mod π, [0, π]: the same for swapped pairs. Both ends are one.
    PhiDModPi,
    /// The smaller of |φd| and π − |φd|, [0, π/2]: the same for mirrored and for swapped pairs.
    PhiDFolded,
    /// θd cos φd, [−π/2, π/2].
    DifferenceX,
    /// θd |cos φd|, [0, π/2].
    DifferenceXFolded,
    /// θd sin φd, [−π/2, π/2].
    DifferenceY,
    /// θd |sin φd|, [0, π/2].
    DifferenceYFolded,
    /// θi, between the direction to the light and the normal, [0, π/2].
    ThetaI,
    /// θo, between the direction to the viewer and the normal, [0, π/2].
    ThetaO,
    /// |φi − φo|, the angle between both azimuths, [0, π].
    DeltaPhi,
}

/// The way in which texels are spaced along an axis, of an angle q with largest value M.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Spacing {
    /// At q/M.
    #[default]
    Linear,
    /// At (q/M)^exponent; below 1, texels crowd at 0.
    Power {
        /// The exponent, (0, 4].
        exponent: f64,
    },
    /// At asinh(q/α)/asinh(M/α): even up to about α, then by equal ratios.
    Asinh {
        /// α in radians, above 0.
        alpha: f64,
    },
}

/// One axis of an isotropic texture: an angle and the way in which texels are spaced along it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Axis {
    /// The angle.
    pub angle: Angle,
    /// The spacing of texels.
    #[serde(default, skip_serializing_if = "Spacing::is_linear")]
    pub spacing: Spacing,
}

/// The angles of a pair from which all of [`Angle`] follow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Angles {
    theta_h: f64,
    theta_d: f64,
    /// (−π, π].
    phi_d: f64,
    /// φd is more than a convention.
    has_azimuth: bool,
    theta_i: f64,
    theta_o: f64,
    delta_phi: f64,
}

/// Nearer than this to what an azimuth goes round, in radians, there is none: half vectors along the normal and equal
/// directions have φd = 0, directions along the normal Δφ = 0. Evaluation in f32 needs that much room.
pub(crate) const NO_AZIMUTH: f64 = 1e-4;

/// Rounding moves a half vector from the normal by less than this, relative to its length.
const ON_NORMAL: f64 = 1e-12;

impl Angle {
    /// Returns whether exchanging light and viewer leaves the angle as it is.
    pub fn is_reciprocal(self) -> bool {
        !matches!(
            self,
            Self::PhiD | Self::DifferenceX | Self::DifferenceY | Self::ThetaI | Self::ThetaO
        )
    }

    /// Returns the formula: `θh`, `θd cos φd`.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::ThetaH => "θh",
            Self::ThetaD => "θd",
            Self::PhiD => "|φd|",
            Self::PhiDModPi => "φd mod π",
            Self::PhiDFolded => "φd folded",
            Self::DifferenceX => "θd cos φd",
            Self::DifferenceXFolded => "θd |cos φd|",
            Self::DifferenceY => "θd sin φd",
            Self::DifferenceYFolded => "θd |sin φd|",
            Self::ThetaI => "θi",
            Self::ThetaO => "θo",
            Self::DeltaPhi => "|φi − φo|",
        }
    }

    /// Negative values occur.
    pub(crate) fn is_signed(self) -> bool {
        matches!(self, Self::DifferenceX | Self::DifferenceY)
    }

    /// The largest value of one whose ends mean something, whatever the samples are.
    pub(crate) fn range(self) -> Option<f64> {
        match self {
            Self::PhiD | Self::PhiDModPi | Self::DeltaPhi => Some(PI),
            Self::PhiDFolded => Some(FRAC_PI_2),
            _ => None,
        }
    }

    /// Where `other` is 0, this angle is what rounding says.
    fn is_undefined_at(self, other: Self) -> bool {
        let is_azimuth = matches!(self, Self::PhiD | Self::PhiDModPi | Self::PhiDFolded);
        match other {
            // The azimuth of a half vector along the normal.
            Self::ThetaH => {
                is_azimuth
                    || matches!(
                        self,
                        Self::DifferenceX
                            | Self::DifferenceXFolded
                            | Self::DifferenceY
                            | Self::DifferenceYFolded
                    )
            }
            // The azimuth of a direction along the half vector.
            Self::ThetaD => is_azimuth,
            Self::ThetaI | Self::ThetaO => self == Self::DeltaPhi,
            _ => false,
        }
    }
}

impl Spacing {
    fn is_linear(&self) -> bool {
        *self == Self::Linear
    }

    /// The place, [0, 1], of an angle of at most `largest`.
    fn place(self, angle: f64, largest: f64) -> f64 {
        match self {
            Self::Linear => angle / largest,
            Self::Power { exponent } => (angle / largest).powf(exponent),
            Self::Asinh { alpha } => (angle / alpha).asinh() / (largest / alpha).asinh(),
        }
    }
}

impl Axis {
    /// Returns an axis of evenly spaced texels.
    pub fn linear(angle: Angle) -> Self {
        Self { angle, spacing: Spacing::Linear }
    }

    /// The texture coordinate, [−1, 1].
    pub(crate) fn locate(self, angles: &Angles, largest: f64) -> f64 {
        let angle = angles.get(self.angle);
        if self.angle.is_signed() {
            angle / largest
        } else {
            -1.0 + 2.0 * self.spacing.place(angle, largest)
        }
    }

    /// What is wrong with the axis, if anything is.
    pub(crate) fn fault(&self) -> Option<&'static str> {
        match self.spacing {
            Spacing::Linear => None,
            _ if self.angle.is_signed() => Some("an even spacing of an angle that may be negative"),
            Spacing::Power { exponent } if !(exponent > 0.0 && exponent <= 4.0) => {
                Some("an exponent above 0 and at most 4")
            }
            Spacing::Asinh { alpha } if !(alpha > 0.0 && alpha.is_finite()) => {
                Some("an angle α above 0")
            }
            _ => None,
        }
    }
}

/// The texels of a grid over two angles that stand for one place, group by group: where one angle is 0 and leaves the
/// other undefined, and where an angle goes round.
pub(crate) fn joined_texels([x, y]: &[Axis; 2], grid: Grid) -> Vec<Vec<usize>> {
    let Grid { columns, rows } = grid;
    let (column, row) = (
        |at: usize| (0..rows).map(move |row| row * columns + at),
        |at: usize| (0..columns).map(move |column| at * columns + column),
    );
    let mut groups: Vec<Vec<usize>> = Vec::new();
    if x.angle == Angle::PhiDModPi {
        groups.extend(column(0).zip(column(columns - 1)).map(|(first, last)| vec![first, last]));
    }
    if y.angle == Angle::PhiDModPi {
        groups.extend(row(0).zip(row(rows - 1)).map(|(first, last)| vec![first, last]));
    }
    // Poles last: what they say holds.
    if y.angle.is_undefined_at(x.angle) {
        groups.push(column(0).collect());
    }
    if x.angle.is_undefined_at(y.angle) {
        groups.push(row(0).collect());
    }
    groups
}

impl Angles {
    pub(crate) fn from_pair(pair: &DirectionPair) -> Self {
        let (h, d) = (pair.wi + pair.wo, pair.wi - pair.wo);
        let (across, length) = (h.truncate().length(), h.length());
        // Spacings by a power below 1 would make a distance of what rounding leaves.
        let across = if across > ON_NORMAL * length { across } else { 0.0 };
        // |h| = 2 cos θd and |d| = 2 sin θd; h and d are perpendicular.
        let (theta_h, theta_d) = (across.atan2(h.z), d.length().atan2(length));
        let has_azimuth = across > NO_AZIMUTH * length && d.length() > NO_AZIMUTH * length;
        let phi_d = if has_azimuth {
            let along = h.truncate().dot(d.truncate()) / across * h.z - d.z * across;
            let beside = h.truncate().perp_dot(d.truncate()) / across * length;
            beside.atan2(along)
        } else {
            0.0
        };
        let (i, o) = (pair.wi.truncate(), pair.wo.truncate());
        let delta_phi = if i.length().min(o.length()) > NO_AZIMUTH {
            i.perp_dot(o).abs().atan2(i.dot(o))
        } else {
            0.0
        };
        Self {
            theta_h,
            theta_d,
            phi_d,
            has_azimuth,
            theta_i: i.length().atan2(pair.wi.z),
            theta_o: o.length().atan2(pair.wo.z),
            delta_phi,
        }
    }

    /// The angles of the swapped pair.
    pub(crate) fn swapped(self) -> Self {
        let phi_d = if self.phi_d > 0.0 { self.phi_d - PI } else { self.phi_d + PI };
        // Where φd is undefined it is 0 for both.
        let phi_d = if self.has_azimuth { phi_d } else { 0.0 };
        Self { phi_d, theta_i: self.theta_o, theta_o: self.theta_i, ..self }
    }

    pub(crate) fn get(&self, angle: Angle) -> f64 {
        let (theta_d, phi_d) = (self.theta_d, self.phi_d);
        match angle {
            Angle::ThetaH => self.theta_h,
            Angle::ThetaD => theta_d,
            Angle::PhiD => phi_d.abs(),
            Angle::PhiDModPi => phi_d.rem_euclid(PI),
            Angle::PhiDFolded => phi_d.abs().min(PI - phi_d.abs()),
            Angle::DifferenceX => theta_d * phi_d.cos(),
            Angle::DifferenceXFolded => (theta_d * phi_d.cos()).abs(),
            Angle::DifferenceY => theta_d * phi_d.sin(),
            Angle::DifferenceYFolded => (theta_d * phi_d.sin()).abs(),
            Angle::ThetaI => self.theta_i,
            Angle::ThetaO => self.theta_o,
            Angle::DeltaPhi => self.delta_phi,
        }
    }
}
