//! What a painting, its material and their difference look like.

use brdf_model::Rgb;
use brdf_paint::{CoefficientMap, PaintedImage, PaintedMaterial, ViewBuffers};
use brdf_param::DirectionPair;
use brdf_render::{DisplayImage, Film, Panel, Pixel, ToneMap, difference, strip};

use crate::pictures::GAIN;

/// A grey, matt object under the view's light, to paint over.
pub(super) fn guide(buffers: &ViewBuffers) -> DisplayImage {
    const GREY: f64 = 0.6;
    let pixels = buffers.pixels.iter().map(|surface| match surface {
        None => Pixel::Background,
        // A little light from everywhere, so that the dark side can be seen.
        Some(s) => Pixel::Radiance(Rgb::splat(GREY * (0.1 + 0.9 * s.wi.z.max(0.0))), 1.0),
    });
    ToneMap { exposure: 1.0 }.apply(&Film::new(buffers.width, pixels.collect()))
}

/// The painting as far as it counts.
fn painted(buffers: &ViewBuffers, image: &PaintedImage) -> Film {
    let pixels = buffers.pixels.iter().enumerate().map(|(at, surface)| {
        if surface.is_none() || !image.is_painted(at) {
            return Pixel::Background;
        }
        let [r, g, b, _] = image.pixels[at].map(f64::from);
        Pixel::Radiance(Rgb::new(r, g, b), 1.0)
    });
    Film::new(buffers.width, pixels.collect())
}

/// A material in a view, unshadowed.
pub(super) fn reconstructed(buffers: &ViewBuffers, material: &PaintedMaterial) -> Film {
    let pixels = buffers.pixels.iter().map(|surface| match surface {
        None => Pixel::Background,
        Some(s) if !s.is_seen_and_lit() => Pixel::Radiance(Rgb::BLACK, 1.0),
        Some(s) => {
            let pair = DirectionPair::new(s.wi, s.wo);
            Pixel::Radiance(material.value(&pair, s.uv) * s.wi.z, 1.0)
        }
    });
    Film::new(buffers.width, pixels.collect())
}

/// Painted, reconstructed and their difference, side by side.
pub(super) fn view_strip(
    name: &str,
    buffers: &ViewBuffers,
    image: &PaintedImage,
    material: &PaintedMaterial,
) -> DisplayImage {
    let films = [painted(buffers, image), reconstructed(buffers, material)];
    let tone = ToneMap { exposure: 1.0 };
    let panel = |picture, caption: String| Panel { picture, caption };
    strip(&[
        panel(tone.apply(&films[0]), format!("{name}, painted")),
        panel(tone.apply(&films[1]), "reconstructed".to_owned()),
        panel(difference(&films[0], &films[1], &tone, GAIN), format!("difference ×{GAIN}")),
    ])
}

/// A map in grey, v upwards; 1 is white.
pub(super) fn map_view(map: &CoefficientMap) -> DisplayImage {
    grid(map.size, |at| {
        let value = f64::from(map.values[at]);
        Pixel::Radiance(Rgb::splat(value), 1.0)
    })
}

/// Which texels no sample touches: those in violet.
pub(super) fn coverage_view(size: usize, unconstrained: &[bool]) -> DisplayImage {
    grid(size, |at| {
        let colour = if unconstrained[at] { Rgb::new(0.3, 0.03, 0.4) } else { Rgb::splat(0.8) };
        Pixel::Radiance(colour, 1.0)
    })
}

fn grid(size: usize, pixel: impl Fn(usize) -> Pixel) -> DisplayImage {
    let rows = (0..size).rev();
    let pixels = rows.flat_map(|row| (0..size).map(move |column| row * size + column)).map(pixel);
    ToneMap { exposure: 1.0 }.apply(&Film::new(size, pixels.collect()))
}
