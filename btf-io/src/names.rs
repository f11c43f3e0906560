//! Angles in the names of images: `tl`, `pl` of the light, `tv`, `pv` of the view, in degrees.
//!
//! Names are read by key, wherever a key stands: counters, order and separators differ between
//! databases, and a counter in a name says nothing about the light.

use glam::DVec3;

use crate::error::BtfError;
use crate::files::base_name;

/// Names give at most six decimals; angles in millionths of a degree compare exactly.
const UNITS: f64 = 1e6;
/// Polar angle of a direction along the surface.
const HORIZON: u32 = 90_000_000;
/// Units of a whole turn.
const TURN: u32 = 360_000_000;
/// The keys in the order of [`Fields`]: polar angle and azimuth of the light, then of the view.
const KEYS: [&str; 4] = ["tl", "pl", "tv", "pv"];

/// A direction as the name of an image gives it. Ordered by polar angle, then azimuth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NamedDirection {
    /// Angle from the normal in millionths of a degree, 0 to 90°.
    theta: u32,
    /// Azimuth in millionths of a degree, 0 or more and below 360°; 0 at the pole.
    phi: u32,
}

impl NamedDirection {
    /// Polar angle and azimuth in degrees, if the direction does not point below the surface.
    fn new(theta_deg: f64, phi_deg: f64) -> Option<Self> {
        let theta = units(theta_deg);
        let phi = if theta == 0 { 0 } else { units(phi_deg.rem_euclid(360.0)) % TURN };
        (theta_deg >= 0.0 && theta <= HORIZON).then_some(Self { theta, phi })
    }

    /// Returns the angle from the normal in degrees.
    pub fn theta_deg(self) -> f64 {
        f64::from(self.theta) / UNITS
    }

    /// Returns the azimuth in degrees, 0 or more and below 360.
    pub fn phi_deg(self) -> f64 {
        f64::from(self.phi) / UNITS
    }

    /// Returns the unit vector, z along the normal.
    pub fn direction(self) -> DVec3 {
        let (sin_theta, cos_theta) = self.theta_deg().to_radians().sin_cos();
        let (sin_phi, cos_phi) = self.phi_deg().to_radians().sin_cos();
        DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
    }
}

impl std::fmt::Display for NamedDirection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "({}°, {}°)", self.theta_deg(), self.phi_deg())
    }
}

/// The directions to viewer and light of an image. Ordered by view, then light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ImageAngles {
    /// To the viewer.
    pub view: NamedDirection,
    /// To the light.
    pub light: NamedDirection,
}

/// Degrees in units; a caller keeps to ±360.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "rounded, and at most 3.6e8; below zero it saturates, which the caller checks"
)]
fn units(degrees: f64) -> u32 {
    (degrees * UNITS).round() as u32
}

/// What follows the four keys in a name.
type Fields = [Option<f64>; 4];

/// Returns the angles in the name of a file, its folders left aside, or `None` if no key is in it.
///
/// ```
/// use btf_io::parse_image_name;
///
/// assert!(parse_image_name("readme.txt")?.is_none());
/// let angles = parse_image_name("tv015_pv000/00000 tl030 pl060 tv015 pv000.jpg")?.expect("keys");
/// assert_eq!((angles.light.theta_deg(), angles.view.theta_deg()), (30.0, 15.0));
/// assert!(parse_image_name("tl030 pl060.jpg").is_err(), "the view is missing");
/// # Ok::<(), btf_io::BtfError>(())
/// ```
///
/// # Errors
///
/// [`BtfError::PartialName`] if some keys are missing, repeated or followed by no angle;
/// [`BtfError::BelowHorizon`] for polar angles beyond 90°.
pub fn parse_image_name(name: &str) -> Result<Option<ImageAngles>, BtfError> {
    let partial = |found: String| BtfError::PartialName { name: name.to_owned(), found };
    let Some(fields) = fields(base_name(name)).map_err(partial)? else { return Ok(None) };
    let [Some(tl), Some(pl), Some(tv), Some(pv)] = fields else {
        return Err(partial(format!("only {}", present(&fields))));
    };
    let direction = |what, theta, phi| {
        NamedDirection::new(theta, phi).ok_or_else(|| BtfError::BelowHorizon {
            name: name.to_owned(),
            what,
            theta_deg: theta,
        })
    };
    Ok(Some(ImageAngles { view: direction("view", tv, pv)?, light: direction("light", tl, pl)? }))
}

/// The keys that a name has, for a message.
fn present(fields: &Fields) -> String {
    let found = KEYS.iter().zip(fields).filter(|(_, value)| value.is_some());
    found.map(|(key, _)| *key).collect::<Vec<_>>().join(", ")
}

/// The number behind each key; none if no key is there. An error says what is wrong.
fn fields(name: &str) -> Result<Option<Fields>, String> {
    let mut fields = [None; 4];
    let mut rest = name;
    let mut before = None;
    while let Some(letter) = rest.chars().next() {
        // A key within a word is none: `subtl3`.
        let starts = !before.is_some_and(char::is_alphabetic);
        if let Some((key, number)) = key_at(rest).filter(|_| starts) {
            let (value, after) = angle_at(number)
                .ok_or_else(|| format!("{} without an angle of at most 360°", KEYS[key]))?;
            if fields[key].replace(value).is_some() {
                return Err(format!("{} twice", KEYS[key]));
            }
            before = Some('0');
            rest = after;
        } else {
            before = Some(letter);
            rest = &rest[letter.len_utf8()..];
        }
    }
    Ok(fields.iter().any(Option::is_some).then_some(fields))
}

/// Which key a text starts with, and what follows it, if that starts like a number.
fn key_at(text: &str) -> Option<(usize, &str)> {
    let (head, after) = text.split_at_checked(2)?;
    let key = KEYS.iter().position(|key| head.eq_ignore_ascii_case(key))?;
    let digits = after.strip_prefix('-').unwrap_or(after);
    digits.starts_with(|c: char| c.is_ascii_digit()).then_some((key, after))
}

/// The number that a text starts with, in degrees within ±360, and what follows.
fn angle_at(text: &str) -> Option<(f64, &str)> {
    let whole = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let sign = usize::from(text.starts_with('-'));
    let mut end = sign + whole(&text[sign..]);
    if let Some(decimals) = text[end..].strip_prefix('.') {
        // The dot before `jpg` is none of the number.
        let count = whole(decimals);
        end += if count > 0 { 1 + count } else { 0 };
    }
    let (number, after) = text.split_at(end);
    let ends = after.chars().next().is_none_or(|c| !c.is_alphanumeric()) || key_at(after).is_some();
    let value: f64 = number.parse().ok()?;
    (ends && value.abs() <= 360.0).then_some((value, after))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angles(name: &str) -> [f64; 4] {
        let read = parse_image_name(name).unwrap().unwrap();
        let (light, view) = (read.light, read.view);
        [light.theta_deg(), light.phi_deg(), view.theta_deg(), view.phi_deg()]
    }

    #[test]
    fn names_are_read_by_key_with_any_separator_and_order() {
        for (name, expected) in [
            ("00008 tl010 pl020 tv030 pv040.jpg", [10.0, 20.0, 30.0, 40.0]),
            ("tl010_pl020_tv030_pv040.png", [10.0, 20.0, 30.0, 40.0]),
            ("tv67.5_pv187.5_tl23.5_pl-15.exr", [23.5, 345.0, 67.5, 187.5]),
            ("TL75PL345TV15PV60", [75.0, 345.0, 15.0, 60.0]),
            ("x_tl0_pl360_tv15_pv360.hdr", [0.0, 0.0, 15.0, 0.0]),
        ] {
            let found = angles(name);
            assert!(
                found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9),
                "{name}: {found:?}"
            );
        }
    }

    #[test]
    fn the_azimuth_of_a_pole_says_nothing() {
        let named = |name| parse_image_name(name).unwrap();
        assert_eq!(named("tl000 pl030 tv000 pv090"), named("tl0 pl0 tv0 pv0"));
    }

    #[test]
    fn names_without_keys_are_no_images() {
        for name in ["readme.txt", "subtl3 pixel.jpg", "tlpl.jpg", "", "tl", "été.png", "pv_.x"] {
            assert_eq!(parse_image_name(name).unwrap(), None, "{name}");
        }
    }

    #[test]
    fn names_that_match_in_part_are_refused() {
        for (name, word) in [
            ("tl000 pl000 tv000.jpg", "only tl, pl, tv"),
            ("tl000 pl000 tv000 pv000 tl015.jpg", "tl twice"),
            ("tl00x pl000 tv000 pv000.jpg", "tl without"),
            ("tl000 pl999 tv000 pv000.jpg", "pl without"),
        ] {
            let message = parse_image_name(name).unwrap_err().to_string();
            assert!(message.contains(word) && message.contains(name), "{message}");
        }
    }

    #[test]
    fn directions_below_the_surface_are_refused() {
        for name in ["tl091 pl0 tv0 pv0", "tl0 pl0 tv95.5 pv0", "tl-5 pl0 tv0 pv0"] {
            let error = parse_image_name(name).unwrap_err();
            assert!(matches!(error, BtfError::BelowHorizon { .. }), "{error}");
        }
        assert!(parse_image_name("tl90 pl0 tv90 pv0").unwrap().is_some());
    }
}
