//! Pictures side by side, with captions.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use crate::display::{DisplayImage, ToneMap};
use crate::film::{Film, Pixel};

/// A picture of a [`strip()`] and the line beneath it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Panel {
    /// The picture.
    pub picture: DisplayImage,
    /// Line beneath the picture; what does not fit is cut.
    pub caption: String,
}

/// Factor by which differences are brightened in pictures for people.
pub const DIFFERENCE_GAIN: u8 = 4;

const PAPER: [u8; 3] = [24, 24, 27];
const INK: [u8; 3] = [228, 228, 231];
const GAP: usize = 8;
const FONT: RasterHeight = RasterHeight::Size16;

/// Returns panels side by side, from left to right, aligned at the top, each with its caption.
///
/// ```
/// use brdf_image::{DisplayImage, Panel, strip};
///
/// let panel = |caption: &str| Panel {
///     picture: DisplayImage::filled(64, 64, [90; 3]),
///     caption: caption.to_owned(),
/// };
/// let sheet = strip(&[panel("left"), panel("right")]);
/// assert!(sheet.width() > 128 && sheet.height() > 64);
/// ```
pub fn strip(panels: &[Panel]) -> DisplayImage {
    let line = FONT.val() + GAP;
    let height = panels.iter().map(|p| p.picture.height()).max().unwrap_or(0);
    let width = GAP + panels.iter().map(|p| p.picture.width() + GAP).sum::<usize>();
    let mut sheet = DisplayImage::filled(width, GAP + height + line, PAPER);
    let mut left = GAP;
    for panel in panels {
        sheet.paste(&panel.picture, left, GAP);
        write_line(&mut sheet, &panel.caption, left, GAP + height + GAP / 2, panel.picture.width());
        left += panel.picture.width() + GAP;
    }
    sheet
}

/// Returns `gain` times the absolute difference of two films as shown by `tone` (sRGB bytes): black where they
/// agree, chequered where one of them has no data.
///
/// # Panics
///
/// Unless both have the same size.
pub fn difference(a: &Film, b: &Film, tone: &ToneMap, gain: u8) -> DisplayImage {
    assert_eq!((a.width(), a.height()), (b.width(), b.height()), "films of the same size");
    let pictures = [tone.apply(a), tone.apply(b)];
    let mut out = DisplayImage::filled(a.width(), a.height(), [0; 3]);
    for (index, pixels) in a.pixels().iter().zip(b.pixels()).enumerate() {
        let (column, row) = (index % a.width(), index / a.width());
        let [p, q] = [0, 1].map(|side| pictures[side].pixel(column, row));
        let unknown =
            [(pixels.0, p), (pixels.1, q)].into_iter().find(|(x, _)| **x == Pixel::NoData);
        let colour = match unknown {
            Some((_, chequer)) => chequer,
            None => std::array::from_fn(|c| p[c].abs_diff(q[c]).saturating_mul(gain)),
        };
        out.set(column, row, colour);
    }
    out
}

fn write_line(sheet: &mut DisplayImage, text: &str, left: usize, top: usize, room: usize) {
    let advance = get_raster_width(FontWeight::Regular, FONT);
    for (index, character) in text.chars().take(room / advance).enumerate() {
        let Some(glyph) = get_raster(character, FontWeight::Regular, FONT)
            .or_else(|| get_raster('?', FontWeight::Regular, FONT))
        else {
            continue;
        };
        for (y, row) in glyph.rows().enumerate() {
            for (x, &ink) in row.iter().enumerate() {
                let blend = |c: usize| {
                    let (paper, pen) = (u16::from(PAPER[c]), u16::from(INK[c]));
                    let mixed = (paper * (255 - u16::from(ink)) + pen * u16::from(ink)) / 255;
                    u8::try_from(mixed).unwrap_or(u8::MAX)
                };
                if ink > 0 {
                    let colour = std::array::from_fn(blend);
                    sheet.set(left + index * advance + x, top + y, colour);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use brdf_model::Rgb;

    use super::*;

    #[test]
    fn equal_films_differ_by_black_and_unknown_pixels_say_so() {
        let film = |blue: f64| {
            let pixel = Pixel::Radiance(Rgb::new(0.1, 0.2, blue), 1.0);
            Film::new(2, vec![pixel, Pixel::NoData])
        };
        let tone = ToneMap { exposure: 1.0 };
        let same = difference(&film(0.3), &film(0.3), &tone, 4);
        assert_eq!(same.pixel(0, 0), [0; 3]);
        assert_ne!(same.pixel(1, 0), [0; 3]);
        assert_eq!(difference(&film(0.3), &film(0.9), &tone, 4).pixel(0, 0), [0, 0, 255]);
    }
}
