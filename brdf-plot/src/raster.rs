//! A plot in pixels.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use crate::PlotError;
use crate::error::drawing;

/// Pixels for one unit of the SVG.
const SCALE: f32 = 2.0;

/// The typeface: SVG leaves the choice to whoever shows it.
static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let family = fonts.faces().next().and_then(|face| face.families.first().map(|f| f.0.clone()));
    if let Some(family) = family {
        fonts.set_sans_serif_family(family);
    }
    Arc::new(fonts)
});

pub(crate) fn png(svg: &str) -> Result<Vec<u8>, PlotError> {
    let options = Options { fontdb: FONTS.clone(), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(|e| drawing(&e))?;
    let size = tree.size().to_int_size();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "sheets are a few thousand units wide"
    )]
    let pixels = |units: u32| (units as f32 * SCALE) as u32;
    let mut picture = Pixmap::new(pixels(size.width()), pixels(size.height()))
        .ok_or_else(|| drawing(&"a sheet without area"))?;
    let scale = Transform::from_scale(SCALE, SCALE);
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
