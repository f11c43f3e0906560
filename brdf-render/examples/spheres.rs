//! Renders every built-in material as a sphere and prints how bright it is and how far from grey.
//!
//! `cargo run --release -p brdf-render --example spheres`
#![allow(clippy::print_stdout, reason = "an example")]

use brdf_image::{Pixel, ToneMap};
use brdf_model::{Preset, Rgb};
use brdf_render::{Environment, EnvironmentError, Light, SphereView, render_sphere};

fn main() -> Result<(), EnvironmentError> {
    let light = Light::Environment(Environment::sky()?);
    let view = SphereView { size: 48, samples: 64 };
    println!("{:<22} {:>23}  exposure", "material", "mean red, green, blue");
    for preset in Preset::ALL {
        let film = render_sphere(&preset.brdf(), &light, &view);
        let shown: Vec<Rgb> = film
            .pixels()
            .iter()
            .filter_map(|pixel| match pixel {
                Pixel::Radiance(rgb, _) => Some(*rgb),
                _ => None,
            })
            .collect();
        let sum = shown.iter().fold(Rgb::BLACK, |sum, rgb| sum + *rgb);
        let mean = sum / shown.len().max(1) as f64;
        let exposure = ToneMap::exposed_for(&film).exposure;
        println!(
            "{:<22} {:>7.3} {:>7.3} {:>7.3}  {exposure:.2}",
            preset.name(),
            mean.r,
            mean.g,
            mean.b
        );
    }
    Ok(())
}
