//! Linear images as OpenEXR.

use std::io::Cursor;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    ReadChannels as _, ReadLayers as _, SmallVec, WritableImage,
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
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        // One thread: the bytes must not depend on how many there are.
        .non_parallel()
        .to_buffered(&mut bytes)
        .map_err(exr_error)?;
    Ok(bytes.into_inner())
}

/// The channels of the first flat layer. A caller has held the size against the file.
pub(crate) fn read_exr_layer(bytes: &[u8]) -> Result<Layer<AnyChannels<FlatSamples>>, FormatError> {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        // Callers that read many images read them in parallel already.
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(exr_error)?;
    Ok(image.layer_data)
}

pub(crate) fn exr_error(problem: impl ToString) -> FormatError {
    FormatError::Library { what: "EXR", problem: problem.to_string().replace('\n', " ") }
}
