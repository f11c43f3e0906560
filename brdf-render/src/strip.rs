//! Pictures side by side, with captions.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use crate::display::DisplayImage;

/// A picture and the line beneath it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Panel {
    /// The picture.
    pub picture: DisplayImage,
    /// Its caption; what does not fit is cut.
    pub caption: String,
}

const PAPER: [u8; 3] = [24, 24, 27];
const INK: [u8; 3] = [228, 228, 231];
const GAP: usize = 8;
const FONT: RasterHeight = RasterHeight::Size16;

/// Panels from left to right, aligned at the top, each with its caption.
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

/// `gain` times the absolute difference of two pictures of the same size, as shown (sRGB bytes):
/// black where they agree.
pub fn difference(a: &DisplayImage, b: &DisplayImage, gain: u8) -> DisplayImage {
    let mut out = DisplayImage::filled(a.width(), a.height(), [0; 3]);
    for row in 0..a.height().min(b.height()) {
        for column in 0..a.width().min(b.width()) {
            let (p, q) = (a.pixel(column, row), b.pixel(column, row));
            out.set(column, row, std::array::from_fn(|c| p[c].abs_diff(q[c]).saturating_mul(gain)));
        }
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
    use super::*;

    #[test]
    fn equal_pictures_differ_by_black() {
        let picture = DisplayImage::filled(3, 2, [9, 80, 200]);
        assert!(difference(&picture, &picture, 4).bytes().iter().all(|b| *b == 0));
        let other = DisplayImage::filled(3, 2, [10, 80, 100]);
        assert_eq!(difference(&picture, &other, 4).pixel(0, 0), [4, 0, 255]);
    }
}
