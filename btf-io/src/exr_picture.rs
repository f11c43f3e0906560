//! OpenEXR images: red, green and blue, or CIE XYZ as UTIA stores them.

use brdf_image::{ExrLayer, read_exr_layer};
use exr::prelude::FlatSamples;

use crate::error::image_error;
use crate::linear::xyz_to_rgb;
use brdf_io::FormatError;

/// Width and height of the first flat layer.
pub(crate) fn exr_size(bytes: &[u8]) -> Result<[usize; 2], FormatError> {
    brdf_image::exr_size(bytes).map_err(image_error("EXR"))
}

fn exr_error(problem: impl ToString) -> FormatError {
    FormatError::Library { what: "EXR", problem: problem.to_string() }
}

/// Decodes linear Rec. 709 values row by row. A caller has held the size against the file.
pub(crate) fn read_exr(bytes: &[u8]) -> Result<Vec<f32>, FormatError> {
    let layer = read_exr_layer(bytes).map_err(image_error("EXR"))?;
    let texels = layer.size.area();
    if let Some(alpha) = channel(&layer, "A")
        && let Some(at) = (0..texels).find(|&at| value(alpha, at) < 1.0)
    {
        // What lies behind such a texel nobody knows.
        return Err(exr_error(format!("texel {at} is transparent")));
    }
    let channels = |names: [&str; 3]| {
        let [Some(a), Some(b), Some(c)] = names.map(|name| channel(&layer, name)) else {
            return None;
        };
        Some((0..texels).map(move |at| [value(a, at), value(b, at), value(c, at)]))
    };
    if let Some(rgb) = channels(["R", "G", "B"]) {
        Ok(rgb.flatten().collect())
    } else if let Some(xyz) = channels(["X", "Y", "Z"]) {
        Ok(xyz.flat_map(xyz_to_rgb).collect())
    } else {
        let names = layer.channel_data.list.iter().map(|c| c.name.to_string());
        Err(FormatError::Missing {
            what: format!("colour: the channels are {}", names.collect::<Vec<_>>().join(", ")),
            expected: "R, G and B, or X, Y and Z".to_owned(),
        })
    }
}

fn channel<'a>(layer: &'a ExrLayer, name: &str) -> Option<&'a FlatSamples> {
    let mut channels = layer.channel_data.list.iter();
    channels.find(|channel| channel.name.eq(name)).map(|channel| &channel.sample_data)
}

fn value(samples: &FlatSamples, at: usize) -> f32 {
    samples.value_by_flat_index(at).to_f32()
}
