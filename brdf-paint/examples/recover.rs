//! Paints a torus with a blend of three materials, fits materials of two kinds, and judges them by other views.
//!
//! `cargo run --release -p brdf-paint --example recover`
#![allow(clippy::print_stdout, reason = "an example")]

use brdf_job::Job;
use brdf_mesh::{Mesh, Soup};
use brdf_model::Preset;
use brdf_paint::{
    GroundTruth, Mode, PaintError, PaintParams, PaintSamples, PaintView, ViewBuffers, extract,
    face_views, vertex_views,
};

const SIZE: usize = 48;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (torus, _) = Mesh::new(Soup::torus())?;
    let preset = |name: &str| Preset::find(name).map(|preset| preset.brdf()).ok_or("a preset");
    let [paint, plastic, gold] =
        [preset("lafortune-blue-paint")?, preset("red-plastic")?, preset("ggx")?];
    let truth = GroundTruth { brdfs: [&paint, &plastic, &gold], scale: 1.0 };
    let painted: Vec<ViewBuffers> =
        vertex_views(&torus).iter().map(|view| ViewBuffers::of(&torus, view, SIZE, SIZE)).collect();
    let truth = truth.scaled_for(&painted);

    let training = samples(&truth, &torus, &vertex_views(&torus))?;
    let held_out = samples(&truth, &torus, &face_views(&torus))?;
    println!("{} painted pixels, {} to judge by", training.len(), held_out.len());
    println!("{:<12} {:>8} {:>9} {:>8}", "kind", "painted", "held out", "bytes");
    for (name, mode) in [("one BRDF", Mode::Brdf), ("material map", Mode::MaterialMap)] {
        let params = PaintParams {
            mode,
            products: 3,
            texels: 24,
            map_size: 48,
            wraps: true,
            ..PaintParams::default()
        };
        let extraction = extract(&training, &params, &Job::new())?;
        let (own, other) = (extraction.errors.rms, extraction.material.errors(&held_out).rms);
        let bytes = extraction.material.payload_bytes();
        println!("{name:<12} {own:>8.4} {other:>9.4} {bytes:>8}");
    }
    Ok(())
}

fn samples(
    truth: &GroundTruth<'_>,
    mesh: &Mesh,
    views: &[PaintView],
) -> Result<PaintSamples, PaintError> {
    let mut samples = PaintSamples::new();
    for (number, view) in views.iter().enumerate() {
        let buffers = ViewBuffers::of(mesh, view, SIZE, SIZE);
        samples.add(number, &view.name, &buffers, &truth.paint(&buffers), 0.1)?;
    }
    Ok(samples)
}
