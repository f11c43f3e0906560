//! Makes the BTF of a bumpy surface for one view and prints the mean radiance for each polar angle of the light, with
//! and without bounces.
//!
//! `cargo run --release -p btf-synth --example bumps`
#![allow(clippy::print_stdout, reason = "an example")]

use std::collections::BTreeMap;
use std::f32::consts::TAU;

use btf_synth::{
    LIGHT_COUNT, Reflectance, SurfaceMaps, SurfaceScene, SynthError, SynthOptions, ubo_directions,
};

const SIDE: usize = 32;

fn main() -> Result<(), SynthError> {
    let wave = |at: usize| (3.0 * TAU * at as f32 / SIDE as f32).sin();
    let heights = (0..SIDE * SIDE).map(|i| 0.08 * wave(i % SIDE) * wave(i / SIDE)).collect();
    let texels = SIDE * SIDE;
    let maps = SurfaceMaps::new(SIDE, SIDE, heights, vec![[0.7; 3]; texels], vec![0.6; texels])?;
    let direct = mean_by_angle(&maps, 0)?;
    let bounced = mean_by_angle(&maps, 64)?;
    println!("light    direct  with bounces  plane");
    for ((theta, direct), bounced) in direct.iter().zip(bounced.values()) {
        let plane = 0.7 * f64::from(*theta).to_radians().cos();
        println!("{theta:>4}°  {direct:>8.3}  {bounced:>12.3}  {plane:>5.3}");
    }
    Ok(())
}

/// π times the mean radiance of the view along the normal, by the light's polar angle in degrees.
fn mean_by_angle(maps: &SurfaceMaps, bounce_rays: u32) -> Result<BTreeMap<u32, f64>, SynthError> {
    let options = SynthOptions { samples: 4, bounce_rays };
    let scene = SurfaceScene::new(maps, Reflectance::Lambertian, &options)?;
    let len = 3 * scene.width() * scene.height();
    let mut images = vec![0.0; LIGHT_COUNT * len];
    scene.synthesize_view(0, &mut images);
    let mut sums = BTreeMap::<u32, (f64, f64)>::new();
    for (image, (theta, _)) in images.chunks_exact(len).zip(ubo_directions()) {
        let (sum, count) = sums.entry(theta).or_default();
        *sum += image.iter().map(|v| f64::from(*v)).sum::<f64>() / len as f64;
        *count += 1.0;
    }
    Ok(sums.into_iter().map(|(theta, (sum, count))| (theta, sum / count)).collect())
}
