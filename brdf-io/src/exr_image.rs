//! Linear images as OpenEXR.

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec,
    WritableImage,
};

use crate::FormatError;

/// The bytes of an EXR image of named f32 channels, each row-major with `width` × `height` values.
///
/// # Errors
///
/// [`FormatError::Library`] if the encoder refuses.
pub fn write_exr(
    width: usize,
    height: usize,
    channels: &[(&str, Vec<f32>)],
) -> Result<Vec<u8>, FormatError> {
    let list: SmallVec<[AnyChannel<FlatSamples>; 4]> = channels
        .iter()
        .map(|(name, values)| AnyChannel::new(*name, FlatSamples::F32(values.clone())))
        .collect();
    let layer = Layer::new(
        (width, height),
        LayerAttributes::named("texture"),
        Encoding::FAST_LOSSLESS,
        AnyChannels::sort(list),
    );
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        // One thread: the bytes must not depend on how many there are.
        .non_parallel()
        .to_buffered(&mut bytes)
        .map_err(|error| FormatError::Library { what: "EXR", problem: error.to_string() })?;
    Ok(bytes.into_inner())
}
