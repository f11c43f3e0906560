//! What paintings, materials and their differences look like.

use brdf_image::{DIFFERENCE_GAIN, DisplayImage, Film, Panel, Pixel, ToneMap, difference, strip};
use brdf_model::Rgb;
use brdf_param::DirectionPair;

use crate::contradictions::Contradictions;
use crate::{CoefficientMap, PaintedImage, PaintedMaterial, ViewBuffers};

/// Paintings are in [0, 1], and shown as they are.
const TONE: ToneMap = ToneMap { exposure: 1.0 };

/// Returns a grey, matt picture of the object under the view's light, to paint over.
pub fn guide(buffers: &ViewBuffers) -> DisplayImage {
    const GREY: f64 = 0.6;
    let pixels = buffers.pixels.iter().map(|surface| match surface {
        None => Pixel::Background,
        // A little light from everywhere, so that the dark side can be seen.
        Some(s) => {
            let light = s.wi.z.max(0.0) * s.irradiance;
            Pixel::Radiance(Rgb::splat(GREY * (0.1 + 0.9 * light)), 1.0)
        }
    });
    TONE.apply(&Film::new(buffers.width, pixels.collect()))
}

/// Returns the painting as far as it counts: pixels that are painted and show the object.
pub fn painted(buffers: &ViewBuffers, image: &PaintedImage) -> Film {
    let pixels = buffers.pixels.iter().enumerate().map(|(at, surface)| {
        if surface.is_none() || !image.is_painted(at) {
            return Pixel::Background;
        }
        let [r, g, b, _] = image.pixels[at].map(f64::from);
        Pixel::Radiance(Rgb::new(r, g, b), 1.0)
    });
    Film::new(buffers.width, pixels.collect())
}

/// Returns a material in a view, as it would be painted.
pub fn reconstructed(buffers: &ViewBuffers, material: &PaintedMaterial) -> Film {
    let pixels = buffers.pixels.iter().map(|surface| match surface {
        None => Pixel::Background,
        Some(s) if !s.is_seen_and_lit() => Pixel::Radiance(Rgb::BLACK, 1.0),
        Some(s) => {
            let pair = DirectionPair::new(s.wi, s.wo);
            Pixel::Radiance(material.value(&pair, s.uv) * (s.wi.z * s.irradiance), 1.0)
        }
    });
    Film::new(buffers.width, pixels.collect())
}

/// Returns a painting, and its difference from a material where it is painted.
pub fn compared(
    buffers: &ViewBuffers,
    image: &PaintedImage,
    material: &PaintedMaterial,
) -> [DisplayImage; 2] {
    let painted = painted(buffers, image);
    let made = reconstructed(buffers, material);
    let pixels = made.pixels().iter().zip(painted.pixels());
    let pixels = pixels.map(|(made, painted)| match painted {
        Pixel::Background => Pixel::Background,
        _ => *made,
    });
    let made = Film::new(buffers.width, pixels.collect());
    [TONE.apply(&painted), difference(&painted, &made, &TONE, DIFFERENCE_GAIN)]
}

/// Returns painting, reconstruction and their difference, side by side.
pub fn view_strip(
    name: &str,
    buffers: &ViewBuffers,
    image: &PaintedImage,
    material: &PaintedMaterial,
) -> DisplayImage {
    let [painted, difference] = compared(buffers, image, material);
    let panel = |picture, caption: String| Panel { picture, caption };
    strip(&[
        panel(painted, format!("{name}, painted")),
        panel(TONE.apply(&reconstructed(buffers, material)), "reconstructed".to_owned()),
        panel(difference, format!("difference ×{DIFFERENCE_GAIN}")),
    ])
}

/// Returns a map in grey, v upwards; 1 is white.
pub fn map_view(map: &CoefficientMap) -> DisplayImage {
    grid(map.size, |at| {
        let value = f64::from(map.values[at]);
        Pixel::Radiance(Rgb::splat(value), 1.0)
    })
}

/// Returns a picture of which texels no sample touches: those in violet.
pub fn coverage_view(size: usize, unconstrained: &[bool]) -> DisplayImage {
    grid(size, |at| {
        let colour = if unconstrained[at] { Rgb::new(0.3, 0.03, 0.4) } else { Rgb::splat(0.8) };
        Pixel::Radiance(colour, 1.0)
    })
}

/// Returns a picture of where views contradict each other, in the red of how much; what lies beneath the threshold
/// is grey.
pub fn contradictions_view(contradictions: &Contradictions) -> DisplayImage {
    grid(contradictions.size, |at| {
        let apart = f64::from(contradictions.apart[at]);
        let is_one = apart > Contradictions::THRESHOLD;
        let colour = if is_one { Rgb::new(apart, 0.02, 0.0) } else { Rgb::splat(0.5 * apart) };
        Pixel::Radiance(colour, 1.0)
    })
}

fn grid(size: usize, pixel: impl Fn(usize) -> Pixel) -> DisplayImage {
    let rows = (0..size).rev();
    let pixels = rows.flat_map(|row| (0..size).map(move |column| row * size + column)).map(pixel);
    TONE.apply(&Film::new(size, pixels.collect()))
}
