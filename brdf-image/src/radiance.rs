//! Radiance pictures (`.hdr`), RGBE, in any of the eight orders that a resolution line can name.
//!
//! Source: G. Ward, "Real Pixels", Graphics Gems II, 1991; file format of the Radiance reference
//! manual. Pictures of BTFs exist whose lines are columns, which common readers refuse.

use crate::{ImageError, check_claim};

/// A picture of linear RGB values, without opacity.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearImage {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear red, green and blue, row by row from the top.
    pub pixels: Vec<[f32; 3]>,
}

/// Returns the width and height that the header of a Radiance picture claims, and that the file may hold.
///
/// # Errors
///
/// [`ImageError`] for content that is no such picture.
pub fn hdr_size(bytes: &[u8]) -> Result<[usize; 2], ImageError> {
    let size = read_header(bytes)?.size;
    check_claim(bytes.len(), size)?;
    Ok(size)
}

/// Returns the picture of a Radiance HDR file, its radiance as before the exposures that the header lists.
///
/// # Errors
///
/// [`ImageError`] for content that is no such picture, ends early, or has runs that do not end with their line.
pub fn decode_hdr(bytes: &[u8]) -> Result<LinearImage, ImageError> {
    let header = read_header(bytes)?;
    let [width, height] = header.size;
    check_claim(bytes.len(), header.size)?;
    Ok(LinearImage { width, height, pixels: read_pixels(bytes, &header)? })
}

/// Pixels of lines that can be run-length coded channel by channel.
const CODED_WIDTHS: std::ops::Range<usize> = 8..0x8000;
/// Longest header that is read.
const LONGEST_HEADER: usize = 64 << 10;
/// How the header must name the coding of pixels.
const FORMAT: &str = "32-bit_rle_rgbe";

/// What a header says.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Header {
    /// Width and height.
    size: [usize; 2],
    order: Order,
    /// By what stored values were multiplied.
    exposure: f32,
    /// Where pixels start.
    data: usize,
}

/// In which order pixels are stored.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Order {
    /// A stored line is a column.
    columns: bool,
    /// From the right to the left.
    right_to_left: bool,
    /// From the bottom to the top.
    bottom_up: bool,
}

/// Reads the header.
///
/// # Errors
///
/// [`ImageError`] for another format and a resolution that is none.
fn read_header(bytes: &[u8]) -> Result<Header, ImageError> {
    let mut at = 0;
    let mut exposure = 1.0;
    let mut is_radiance = bytes.starts_with(b"#?");
    loop {
        let line = match line(bytes, &mut at) {
            Err(_) if !is_radiance => return Err(no_radiance()),
            line => line?,
        };
        if line.is_empty() {
            break;
        }
        if let Some(format) = line.strip_prefix("FORMAT=").map(str::trim) {
            if format != FORMAT {
                return Err(unusable(format!("format {format:?}"), FORMAT));
            }
            is_radiance = true;
        }
        if let Some(factor) = line.strip_prefix("EXPOSURE=") {
            // Each program that scaled the picture left a line.
            exposure *= factor.trim().parse::<f32>().unwrap_or(f32::NAN);
        }
    }
    if !is_radiance {
        return Err(no_radiance());
    }
    if !(exposure > 0.0 && exposure.is_finite()) {
        return Err(unusable(format!("exposure {exposure}"), "a number above 0"));
    }
    let resolution = line(bytes, &mut at)?;
    let (size, order) = parse_resolution(&resolution)
        .ok_or_else(|| unusable(format!("resolution {resolution:?}"), "-Y ROWS +X COLUMNS"))?;
    Ok(Header { size, order, exposure, data: at })
}

fn no_radiance() -> ImageError {
    unusable("first line".to_owned(), "#?RADIANCE, or a line FORMAT")
}

fn unusable(found: String, expected: &'static str) -> ImageError {
    ImageError::Header { what: "Radiance HDR", found, expected }
}

/// The line at an offset, which moves behind it.
fn line(bytes: &[u8], at: &mut usize) -> Result<String, ImageError> {
    let rest = &bytes[*at..bytes.len().min(LONGEST_HEADER).max(*at)];
    let length = rest.iter().position(|&byte| byte == b'\n').ok_or(ImageError::PastEnd {
        offset: *at,
        what: "the Radiance header",
        length: bytes.len(),
    })?;
    *at += length + 1;
    Ok(String::from_utf8_lossy(&rest[..length]).trim_end().to_owned())
}

/// Size and order of a line such as `-Y 256 +X 256`, whose first half counts lines.
fn parse_resolution(line: &str) -> Option<([usize; 2], Order)> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [slow, lines, fast, length] = words[..] else { return None };
    let (lines, length) = (lines.parse().ok()?, length.parse().ok()?);
    let columns = slow.ends_with('X');
    let (x, y) = if columns { (slow, fast) } else { (fast, slow) };
    // Y grows upwards: counting down goes from the top to the bottom.
    let right_to_left = sign(x, "+X", "-X")?;
    let bottom_up = sign(y, "-Y", "+Y")?;
    let size = if columns { [lines, length] } else { [length, lines] };
    Some((size, Order { columns, right_to_left, bottom_up }))
}

/// Whether a word is the second of two.
fn sign(word: &str, first: &str, second: &str) -> Option<bool> {
    [first, second].iter().position(|known| *known == word).map(|index| index == 1)
}

impl Header {
    /// Number of stored lines and of pixels in one.
    fn lines(&self) -> (usize, usize) {
        let [width, height] = self.size;
        if self.order.columns { (width, height) } else { (height, width) }
    }

    /// Where a pixel of a stored line belongs, counted row by row from the top.
    fn place(&self, line: usize, pixel: usize) -> usize {
        let [width, height] = self.size;
        let (column, row) = if self.order.columns { (line, pixel) } else { (pixel, line) };
        let column = if self.order.right_to_left { width - 1 - column } else { column };
        let row = if self.order.bottom_up { height - 1 - row } else { row };
        row * width + column
    }
}

/// Decodes pixels row by row from the top. A caller has held the size against the file.
///
/// # Errors
///
/// [`ImageError`] if the file ends early or runs do not end with their line.
fn read_pixels(bytes: &[u8], header: &Header) -> Result<Vec<[f32; 3]>, ImageError> {
    let (lines, length) = header.lines();
    let mut pixels = vec![[0.0; 3]; lines * length];
    let mut line = vec![[0; 4]; length];
    let mut source = Source { bytes, at: header.data };
    for number in 0..lines {
        source.read_line(&mut line)?;
        for (pixel, rgbe) in line.iter().enumerate() {
            let rgb = to_rgb(*rgbe).map(|value| value / header.exposure);
            pixels[header.place(number, pixel)] = rgb;
        }
    }
    Ok(pixels)
}

/// Mantissas of 8 bits below a common exponent.
fn to_rgb([r, g, b, e]: [u8; 4]) -> [f32; 3] {
    if e == 0 {
        return [0.0; 3];
    }
    let scale = (f32::from(e) - 136.0).exp2();
    [r, g, b].map(|mantissa| f32::from(mantissa) * scale)
}

/// Stored bytes and how far they are read.
struct Source<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Source<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], ImageError> {
        let taken = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<N>());
        let taken = taken.ok_or(ImageError::PastEnd {
            offset: self.at,
            what: "a line of pixels",
            length: self.bytes.len(),
        })?;
        self.at += N;
        Ok(*taken)
    }

    fn read_line(&mut self, line: &mut [[u8; 4]]) -> Result<(), ImageError> {
        let start = self.at;
        if CODED_WIDTHS.contains(&line.len()) {
            let [a, b, high, low] = self.take()?;
            if a == 2 && b == 2 && usize::from(u16::from_be_bytes([high, low])) == line.len() {
                return (0..4).try_for_each(|channel| self.read_channel(line, channel));
            }
            self.at = start;
        }
        self.read_pixels(line)
    }

    /// A channel of a line: runs and literal stretches.
    fn read_channel(&mut self, line: &mut [[u8; 4]], channel: usize) -> Result<(), ImageError> {
        let mut filled = 0;
        while filled < line.len() {
            let offset = self.at;
            let [count] = self.take()?;
            let run = count > 128;
            let count = usize::from(if run { count - 128 } else { count });
            if count == 0 || count > line.len() - filled {
                return Err(wrong_run(offset, count, line.len() - filled));
            }
            let repeated = if run { self.take::<1>()?[0] } else { 0 };
            for pixel in &mut line[filled..filled + count] {
                pixel[channel] = if run { repeated } else { self.take::<1>()?[0] };
            }
            filled += count;
        }
        Ok(())
    }

    /// Pixels one by one; `1 1 1 n` repeats the one before n times, and further such pixels count in
    /// steps of 256, 65,536 and so on.
    fn read_pixels(&mut self, line: &mut [[u8; 4]]) -> Result<(), ImageError> {
        let mut filled = 0;
        let mut shift = 0;
        while filled < line.len() {
            let offset = self.at;
            let pixel: [u8; 4] = self.take()?;
            let [1, 1, 1, count] = pixel else {
                line[filled] = pixel;
                (filled, shift) = (filled + 1, 0);
                continue;
            };
            let count = usize::from(count).checked_shl(shift).unwrap_or(usize::MAX);
            if filled == 0 || shift > 24 || count > line.len() - filled {
                return Err(wrong_run(offset, count, line.len() - filled));
            }
            let repeated = line[filled - 1];
            line[filled..filled + count].fill(repeated);
            (filled, shift) = (filled + count, shift + 8);
        }
        Ok(())
    }
}

fn wrong_run(offset: usize, count: usize, most: usize) -> ImageError {
    ImageError::Run { offset, found: count, most }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture whose pixel in column x, row y is (x + 1, y + 1, 5), in any order, uncoded.
    fn stored(resolution: &str, [width, height]: [usize; 2]) -> Vec<u8> {
        let mut bytes = format!("#?RADIANCE\nFORMAT={FORMAT}\n\n{resolution}\n").into_bytes();
        let header = read_header(&bytes).unwrap();
        assert_eq!(header.size, [width, height], "{resolution}");
        let (lines, length) = header.lines();
        for line in 0..lines {
            for pixel in 0..length {
                let place = header.place(line, pixel);
                let [x, y] = [place % width, place / width].map(|v| u8::try_from(v).unwrap());
                bytes.extend([x + 1, y + 1, 5, 136]);
            }
        }
        bytes
    }

    #[test]
    fn the_order_of_a_resolution_line_is_kept_to() {
        // The first stored pixel is at the corner where both counts start.
        for (resolution, first, second) in [
            ("-Y 2 +X 3", [0, 0], [1, 0]),
            ("-Y 2 -X 3", [2, 0], [1, 0]),
            ("+Y 2 +X 3", [0, 1], [1, 1]),
            ("+Y 2 -X 3", [2, 1], [1, 1]),
            ("+X 3 -Y 2", [0, 0], [0, 1]),
            ("+X 3 +Y 2", [0, 1], [0, 0]),
            ("-X 3 -Y 2", [2, 0], [2, 1]),
            ("-X 3 +Y 2", [2, 1], [2, 0]),
        ] {
            let bytes = stored(resolution, [3, 2]);
            let header = read_header(&bytes).unwrap();
            assert_eq!(header.place(0, 0), first[0] + 3 * first[1], "{resolution}");
            assert_eq!(header.place(0, 1), second[0] + 3 * second[1], "{resolution}");
            let values = read_pixels(&bytes, &header).unwrap();
            let expected: Vec<[f32; 3]> = (0..6_u8)
                .map(|pixel| [f32::from(pixel % 3 + 1), f32::from(pixel / 3 + 1), 5.0])
                .collect();
            assert!(values == expected, "{resolution}: {values:?}");
        }
    }

    #[test]
    fn both_codings_of_runs_give_the_pixels() {
        let head = format!("#?RGBE\nEXPOSURE=2\nFORMAT={FORMAT}\n\n-Y 1 +X 10\n");
        let old = [[9, 8, 7, 130], [1, 1, 1, 9]].concat();
        let new =
            [[2, 2, 0, 10].as_slice(), &[138, 9], &[138, 8], &[4, 7, 7, 7, 7, 134, 7], &[138, 130]]
                .concat();
        for data in [old, new] {
            let bytes = [head.as_bytes(), &data].concat();
            let values = read_pixels(&bytes, &read_header(&bytes).unwrap()).unwrap();
            let pixel = [9.0, 8.0, 7.0].map(|mantissa: f32| mantissa / 128.0);
            assert_eq!(values, [pixel; 10]);
        }
    }

    #[test]
    fn broken_headers_and_runs_are_refused() {
        for (text, word) in [
            ("FORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", "xyze"),
            ("#?RGBE\nEXPOSURE=-1\n\n-Y 1 +X 1\n", "exposure -1"),
            ("#?RGBE\n\n-Y 1 +Y 1\n", "resolution"),
            ("#?RGBE\n\n-Y 1 +X 1", "past the end"),
            ("\n-Y 1 +X 1\n", "first line"),
        ] {
            let message = read_header(text.as_bytes()).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
        for data in [&[2, 2, 0, 8, 137, 1][..], &[2, 2, 0, 8, 0, 0], &[1, 1, 1, 1], &[5, 5]] {
            let bytes = [b"#?RGBE\n\n-Y 1 +X 8\n", data].concat();
            assert!(read_pixels(&bytes, &read_header(&bytes).unwrap()).is_err(), "{data:?}");
        }
    }
}
