//! Compresses a BTF that is a formula, reads a texel of it and draws lights for it.
//!
//! `cargo run --release -p btf-vq --example compress`
#![allow(clippy::print_stdout, reason = "an example")]

use std::ops::Range;

use brdf_job::Job;
use brdf_model::DirectionSampler as _;
use brdf_param::spherical_direction;
use btf_vq::{
    BtfLayout, BtfModel, BtfRecord, BtfSource, BtfView, CompressSettings, Encoding, GridChoice,
    SourceError, TextureInputs, compare_texture, compress,
};
use glam::DVec3;

/// Stripes of two colours with a gloss, linear radiance under irradiance π.
struct Stripes(BtfLayout);

impl Stripes {
    #[expect(clippy::cast_possible_truncation, reason = "images are f32")]
    fn radiance(texel: usize, wi: DVec3, wo: DVec3) -> [f32; 3] {
        let gloss = 0.3 * (wi + wo).normalize_or(DVec3::Z).z.powi(20);
        let albedo = if (texel / 2).is_multiple_of(2) { [0.7, 0.3, 0.2] } else { [0.2, 0.4, 0.6] };
        albedo.map(|a| (wi.z * (a + gloss)) as f32)
    }

    /// Directions to light and viewer of all images.
    fn pairs(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        self.0.views.iter().flat_map(|view| view.lights.iter().map(|wi| (*wi, view.wo)))
    }
}

impl BtfSource for Stripes {
    fn layout(&self) -> &BtfLayout {
        &self.0
    }

    fn read_texels(&self, texels: Range<usize>, out: &mut [f32]) -> Result<(), SourceError> {
        for ((wi, wo), image) in self.pairs().zip(out.chunks_exact_mut(3 * texels.len())) {
            for (texel, rgb) in texels.clone().zip(image.as_chunks_mut::<3>().0) {
                *rgb = Self::radiance(texel, wi, wo);
            }
        }
        Ok(())
    }

    // Without this, an image would be read block by block, with all other images.
    fn read_image(&self, image: usize, out: &mut [f32]) -> Result<(), SourceError> {
        let (wi, wo) = self.pairs().nth(image).ok_or("no such image")?;
        for (texel, rgb) in out.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            *rgb = Self::radiance(texel, wi, wo);
        }
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let degrees = |(theta, phi): (u32, u32)| [theta, phi].map(|d| f64::from(d).to_radians());
    let directions: Vec<DVec3> = btf_synth::ubo_directions()
        .into_iter()
        .map(|angles| {
            let [theta, phi] = degrees(angles);
            spherical_direction(theta, phi)
        })
        .collect();
    let views = directions.iter().map(|wo| BtfView { wo: *wo, lights: directions.clone() });
    let stripes = Stripes(BtfLayout {
        width: 16,
        height: 16,
        views: views.collect(),
        encoding: Encoding::Linear,
        cosine_included: true,
    });
    let inputs =
        TextureInputs::images(vec![("stripes".to_owned(), &stripes)], GridChoice::default(), false);
    let settings = CompressSettings { ratio: 100.0, ..CompressSettings::default() };
    let bytes = |model: &BtfModel, _: &BtfRecord| model.stream_bytes().iter().map(|s| s.1).sum();
    let model = compress(&inputs, &settings, None, &bytes, &Job::new())?.model;
    for (name, bytes) in model.stream_bytes() {
        println!("{name}: {bytes} bytes");
    }
    let reader = model.reader(0).ok_or("one texture")?;
    let fidelity = compare_texture(&stripes, &reader, &Job::new())?;
    println!("of {} raw bytes; PSNR {:.1} dB", inputs.raw_bytes, fidelity.psnr);

    let (wo, texel) = (spherical_direction(0.6, 0.3), 5);
    let (wi, pdf) = reader.light_sampler(0, texel, wo).sample([0.3, 0.7]);
    let radiance = reader.linear(0, texel, &reader.taps(wi, wo));
    println!("light drawn at {wi:.2}, {pdf:.2} per sr: radiance {radiance:.3?}");
    Ok(())
}
