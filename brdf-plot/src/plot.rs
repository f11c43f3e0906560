//! A finished plot, and the sheet it is drawn on.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, IntoDrawingArea as _, SVGBackend};

use crate::error::{PlotError, drawing};

/// A finished plot: an SVG document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plot {
    svg: String,
}

impl Plot {
    /// Returns the SVG document.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// Whether [`Plot::png`] can draw: whether the feature `raster` is there.
    pub const HAS_PNG: bool = cfg!(feature = "raster");

    /// Returns the bytes of a PNG with two pixels for each unit of the SVG.
    ///
    /// # Errors
    ///
    /// [`PlotError::NoRaster`] without the feature `raster`; [`PlotError::Drawing`].
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        #[cfg(feature = "raster")]
        return crate::raster::png(&self.svg);
        #[cfg(not(feature = "raster"))]
        Err(PlotError::NoRaster)
    }
}

/// A bitmap under the drawing: pixels become sharp squares.
pub(crate) struct Bitmap {
    /// Left, top, width, height in units of the sheet.
    pub(crate) place: [i32; 4],
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    /// RGBA, row by row from the top.
    pub(crate) pixels: Vec<u8>,
}

pub(crate) type Sheet<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Draws on a white sheet. Bitmaps, which the drawing may ask for, lie beneath its lines.
pub(crate) fn on_sheet(
    size: (u32, u32),
    draw: impl FnOnce(&Sheet<'_>, &mut Vec<Bitmap>) -> Result<(), PlotError>,
) -> Result<Plot, PlotError> {
    let mut svg = String::new();
    let mut bitmaps = Vec::new();
    {
        let sheet = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        draw(&sheet, &mut bitmaps)?;
        sheet.present().map_err(|e| drawing(&e))?;
    }
    // The comment is the mark by which our plots are recognized.
    let mut under =
        String::from("\n<!-- brdf plot -->\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>");
    for bitmap in &bitmaps {
        let [left, top, width, height] = bitmap.place;
        let encoded = STANDARD.encode(encode(bitmap)?);
        // Writing to a String does not fail.
        let _ = write!(
            under,
            "\n<image x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" \
             preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" \
             href=\"data:image/png;base64,{encoded}\"/>"
        );
    }
    let head = svg.find('>').map_or(0, |at| at + 1);
    svg.insert_str(head, &under);
    Ok(Plot { svg })
}

fn encode(bitmap: &Bitmap) -> Result<Vec<u8>, PlotError> {
    let [columns, rows] = [bitmap.columns, bitmap.rows].map(u32::try_from);
    let (Ok(columns), Ok(rows)) = (columns, rows) else {
        return Err(drawing(&"a bitmap with more than 2³² columns"));
    };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, columns, rows);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&bitmap.pixels))
        .map_err(|e| drawing(&e))?;
    Ok(bytes)
}
