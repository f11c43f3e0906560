//! Linear images as OpenEXR.

use std::io::Cursor;

use exr::meta::MetaData;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    ReadChannels as _, ReadLayers as _, SmallVec, WritableImage,
};

use crate::ImageError;

/// One flat layer of an EXR file with all of its channels.
pub type ExrLayer = Layer<AnyChannels<FlatSamples>>;

/// Returns the bytes of an EXR image of named `f32` channels, each row-major with `width` × `height` values. The
/// same values give the same bytes on any number of threads.
///
/// ```
/// let bytes = brdf_image::encode_exr(2, 1, &[("Y", vec![0.5, 7.0])])?;
/// let planes = brdf_image::exr_planes(&bytes)?;
/// assert_eq!(planes.channel("Y"), Some(&[0.5, 7.0][..]));
/// # Ok::<(), brdf_image::ImageError>(())
/// ```
///
/// # Errors
///
/// [`ImageError::Coder`] if the encoder refuses.
pub fn encode_exr(
    width: usize,
    height: usize,
    channels: &[(&str, Vec<f32>)],
) -> Result<Vec<u8>, ImageError> {
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

/// Returns width and height of the first flat layer of an EXR file.
///
/// # Errors
///
/// [`ImageError::Coder`] for what is no EXR file, or holds deep data only.
pub fn exr_size(bytes: &[u8]) -> Result<[usize; 2], ImageError> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(exr_error)?;
    let header = meta.headers.iter().find(|header| !header.deep);
    let size = header.ok_or_else(|| exr_error("deep data only"))?.layer_size;
    Ok([size.width(), size.height()])
}

/// Returns the channels of the first flat layer of an EXR file. Check its size first, see
/// [`check_claim`](crate::check_claim): the decoder makes room for what the header claims.
///
/// # Errors
///
/// [`ImageError::Coder`] if the decoder refuses.
pub fn read_exr_layer(bytes: &[u8]) -> Result<ExrLayer, ImageError> {
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

pub(crate) fn exr_error(problem: impl ToString) -> ImageError {
    ImageError::coder("EXR")(problem.to_string())
}
