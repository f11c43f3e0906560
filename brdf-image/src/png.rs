//! Pictures as PNG.

use crate::{DisplayImage, ImageError};

/// Returns the bytes of a PNG, 8 bits a channel, marked as sRGB. Its Software text is `brdf`, by which this project
/// knows its own pictures.
///
/// # Errors
///
/// [`ImageError::Coder`] if the encoder refuses.
pub fn encode_png(picture: &DisplayImage) -> Result<Vec<u8>, ImageError> {
    let refused = ImageError::coder("PNG");
    let [width, height] = [picture.width(), picture.height()].map(u32::try_from);
    let (Ok(width), Ok(height)) = (width, height) else {
        return Err(refused("too large".to_owned()));
    };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    let written = encoder
        .add_text_chunk("Software".to_owned(), "brdf".to_owned())
        .and_then(|()| encoder.write_header())
        .and_then(|mut writer| writer.write_image_data(picture.bytes()));
    written.map_err(|error| refused(error.to_string()))?;
    Ok(bytes)
}
