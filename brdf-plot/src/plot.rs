//! A finished plot, and the sheet it is drawn on.

use std::fmt::Write as _;
use std::sync::{Arc, LazyLock};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, IntoDrawingArea as _, SVGBackend};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

/// A finished plot: an SVG document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plot {
    svg: String,
}

/// A problem with a plot: there is nothing to show, or the drawing library refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// There is nothing to show.
    #[error("nothing to plot: {what}")]
    Nothing {
        /// Name of the missing part.
        what: &'static str,
    },
    /// The drawing library refused.
    #[error("drawing: {problem}")]
    Drawing {
        /// Message of the library.
        problem: String,
    },
}

/// Pixels of a PNG for one unit of the SVG.
const PNG_SCALE: f32 = 2.0;

/// The typeface of PNGs: SVG leaves the choice to whoever shows it.
static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let family = fonts.faces().next().and_then(|face| face.families.first().map(|f| f.0.clone()));
    if let Some(family) = family {
        fonts.set_sans_serif_family(family);
    }
    Arc::new(fonts)
});

impl Plot {
    /// Returns the SVG document.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// Returns the bytes of a PNG with two pixels for each unit of the SVG.
    ///
    /// # Errors
    ///
    /// [`PlotError::Drawing`].
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        let options = Options { fontdb: FONTS.clone(), ..Options::default() };
        let tree = Tree::from_str(&self.svg, &options).map_err(|e| drawing(&e))?;
        let size = tree.size().to_int_size();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "sheets are a few thousand units wide"
        )]
        let pixels = |units: u32| (units as f32 * PNG_SCALE) as u32;
        let mut picture = Pixmap::new(pixels(size.width()), pixels(size.height()))
            .ok_or_else(|| drawing(&"a sheet without area"))?;
        let scale = Transform::from_scale(PNG_SCALE, PNG_SCALE);
        resvg::render(&tree, scale, &mut picture.as_mut());
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, picture.width(), picture.height());
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        // The mark by which our pictures are recognized.
        encoder
            .add_text_chunk("Software".to_owned(), "brdf".to_owned())
            .and_then(|()| encoder.write_header())
            // The sheet is opaque, so premultiplied is plain.
            .and_then(|mut writer| writer.write_image_data(picture.data()))
            .map_err(|e| drawing(&e))?;
        Ok(bytes)
    }
}

pub(crate) fn drawing(problem: &dyn std::fmt::Display) -> PlotError {
    PlotError::Drawing { problem: problem.to_string() }
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
