//! The head that all binary BTFs of the University of Bonn share: signature, how it was measured,
//! directions and size.
//!
//! Layout after the file readers of btflib, the university's own library.

use std::f64::consts::FRAC_PI_2;

use btf_vq::BtfView;
use glam::DVec3;

use brdf_io::Cursor;
use brdf_io::FormatError;
use brdf_io::quoted;

/// Texels in a row or column.
const LONGEST_SIDE: u32 = 16_384;
/// Directions that interpolation needs at least.
const LEAST_DIRECTIONS: usize = 3;
/// Bytes of the three texts on how the material was measured.
const TEXTS: usize = 3 * 80;
/// By how much the polar angles of a file, in f32, may pass the horizon, in radians.
const ROUNDING: f64 = 1e-4;

/// How values are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Packing {
    /// Products of factors, each channel with its own.
    Decorrelated,
    /// Products of factors for all channels; with a head of its own.
    Factored { head: bool },
    /// All values, texel by texel.
    Texels,
}

/// What all files say.
#[derive(Debug)]
pub(crate) struct BonnHeader {
    pub(crate) packing: Packing,
    pub(crate) cosine_included: bool,
    pub(crate) views: Vec<BtfView>,
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Whether frames of texels are stored.
    pub(crate) rotations: bool,
}

impl BonnHeader {
    pub(crate) fn images(&self) -> usize {
        self.views.iter().map(|view| view.lights.len()).sum()
    }

    pub(crate) fn texels(&self) -> usize {
        self.width * self.height
    }
}

/// Whether a file starts like one of these.
pub(crate) fn is_bonn(bytes: &[u8]) -> bool {
    [&b"!DFMF"[..], b"!FMF", b"!PVF", b"!BDIF"].iter().any(|start| bytes.starts_with(start))
}

/// Reads up to the size in texels, and leaves the cursor behind it.
pub(crate) fn read_header(bytes: &[u8]) -> Result<(BonnHeader, Cursor<'_>), FormatError> {
    let (length, packing, rotations) = signature(bytes)?;
    let mut cursor = Cursor::new(bytes, length);
    let cosine_included = read_measurement(&mut cursor)?;
    let views = read_views(&mut cursor)?;
    let [width, height] = [side(&mut cursor, "width")?, side(&mut cursor, "height")?];
    Ok((BonnHeader { packing, cosine_included, views, width, height, rotations }, cursor))
}

/// Length of the signature, what it stands for, and whether frames of texels follow.
fn signature(bytes: &[u8]) -> Result<(usize, Packing, bool), FormatError> {
    let known: [(&[u8], Packing, bool); 5] = [
        (b"!DFMF08FCR", Packing::Decorrelated, true),
        (b"!FMF12FCER", Packing::Factored { head: true }, true),
        (b"!FMF06FCR", Packing::Factored { head: false }, true),
        (b"!FMF06FC", Packing::Factored { head: false }, false),
        (b"!BDIF06R2!", Packing::Texels, true),
    ];
    match known.iter().find(|(magic, ..)| bytes.starts_with(magic)) {
        Some((magic, packing, rotations)) => Ok((magic.len(), *packing, *rotations)),
        None => Err(FormatError::Missing {
            what: format!(
                "readable BTF: it starts with {}",
                quoted(&String::from_utf8_lossy(&bytes[..bytes.len().min(10)]))
            ),
            expected: "!DFMF08FCR, !FMF12FCER, !FMF06FC(R) or !BDIF06R2!; factors of each view \
                       (!PVF) and older files of texels are not read"
                .to_owned(),
        }),
    }
}

/// Reads what is said about the measurement; returns whether values contain the cosine of the
/// light's angle.
fn read_measurement(cursor: &mut Cursor<'_>) -> Result<bool, FormatError> {
    let start = cursor.offset();
    let claimed = cursor.u32("the size of the head")?;
    let version = cursor.u32("the version of the head")?;
    cursor.take(TEXTS, "the texts on the measurement")?;
    cursor.take(4, "texels per millimetre")?;
    cursor.take(3 * 4, "the scales of the channels")?;
    let cosine = if version > 1 { cursor.u32("the cosine flag")? != 0 } else { false };
    if version > 2 {
        skip_text(cursor, "the XML of the measurement")?;
    }
    if version > 3 {
        read_channels(cursor)?;
    }
    let length = cursor.offset() - start;
    if length != claimed as usize {
        return Err(FormatError::Field {
            offset: start,
            what: "the size of the head",
            found: claimed.to_string(),
            expected: format!("{length}, which its fields take"),
        });
    }
    Ok(cosine)
}

fn read_channels(cursor: &mut Cursor<'_>) -> Result<(), FormatError> {
    let offset = cursor.offset();
    let channels = cursor.u32("the number of channels")?;
    if channels != 3 {
        return Err(FormatError::Field {
            offset,
            what: "the number of channels",
            found: channels.to_string(),
            expected: "3; spectral BTFs are not read".to_owned(),
        });
    }
    (0..channels).try_for_each(|_| skip_text(cursor, "the name of a channel"))
}

fn skip_text(cursor: &mut Cursor<'_>, what: &str) -> Result<(), FormatError> {
    let length = cursor.u32(what)?;
    cursor.take(length as usize, what).map(|_| ())
}

/// Reads views with their lights, which must be the same for all: what follows has as many values
/// for each.
fn read_views(cursor: &mut Cursor<'_>) -> Result<Vec<BtfView>, FormatError> {
    let offset = cursor.offset();
    let count = cursor.u32("the number of views")?;
    let mut views: Vec<BtfView> = Vec::new();
    for _ in 0..count {
        let wo = direction(cursor, "a view")?;
        let at = cursor.offset();
        let lights = read_lights(cursor)?;
        if let Some(first) = views.first()
            && first.lights != lights
        {
            return Err(FormatError::Field {
                offset: at,
                what: "a list of lights",
                found: "another one than that of the first view".to_owned(),
                expected: "the same lights for all views".to_owned(),
            });
        }
        views.push(BtfView { wo, lights });
    }
    let lights = views.first().map_or(0, |view| view.lights.len());
    if views.len() < LEAST_DIRECTIONS || lights < LEAST_DIRECTIONS {
        return Err(FormatError::Field {
            offset,
            what: "the number of directions",
            found: format!("{} views with {lights} lights", views.len()),
            expected: format!("at least {LEAST_DIRECTIONS} of each"),
        });
    }
    Ok(views)
}

fn read_lights(cursor: &mut Cursor<'_>) -> Result<Vec<DVec3>, FormatError> {
    let count = cursor.u32("the number of lights")?;
    (0..count).map(|_| direction(cursor, "a light")).collect()
}

/// A direction from its polar angle and azimuth in radians.
fn direction(cursor: &mut Cursor<'_>, what: &'static str) -> Result<DVec3, FormatError> {
    let offset = cursor.offset();
    let theta = f64::from(read_f32(cursor, what)?);
    let phi = f64::from(read_f32(cursor, what)?);
    if !(-ROUNDING..=FRAC_PI_2 + ROUNDING).contains(&theta) || !phi.is_finite() {
        return Err(FormatError::Field {
            offset,
            what,
            found: format!("at polar angle {theta}, azimuth {phi}"),
            expected: "radians, the polar angle from 0 to π/2".to_owned(),
        });
    }
    let (sin_theta, cos_theta) = theta.clamp(0.0, FRAC_PI_2).sin_cos();
    Ok(DVec3::new(sin_theta * phi.cos(), sin_theta * phi.sin(), cos_theta))
}

fn side(cursor: &mut Cursor<'_>, what: &'static str) -> Result<usize, FormatError> {
    let offset = cursor.offset();
    let side = cursor.u32(what)?;
    if side == 0 || side > LONGEST_SIDE {
        return Err(FormatError::Field {
            offset,
            what,
            found: side.to_string(),
            expected: format!("1 to {LONGEST_SIDE} texels"),
        });
    }
    Ok(side as usize)
}

/// Skips the frames of texels.
pub(crate) fn skip_rotations(cursor: &mut Cursor<'_>) -> Result<(), FormatError> {
    let count = cursor.u32("the number of frames of texels")? as usize;
    cursor.take(count.saturating_mul(9 * 4), "frames of texels").map(|_| ())
}

pub(crate) fn read_f32(cursor: &mut Cursor<'_>, what: &str) -> Result<f32, FormatError> {
    cursor.array(what).map(f32::from_le_bytes)
}

/// That nothing follows.
pub(crate) fn check_end(bytes: &[u8], cursor: &Cursor<'_>) -> Result<(), FormatError> {
    if cursor.offset() == bytes.len() {
        return Ok(());
    }
    Err(FormatError::Size { found: bytes.len(), expected: cursor.offset(), hint: "" })
}
