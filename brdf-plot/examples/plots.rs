//! Plots the built-in gold in several ways and prints how large each SVG is. Given a folder, writes them there.
//!
//! `cargo run --release -p brdf-plot --example plots [-- FOLDER]`
#![allow(clippy::print_stdout, reason = "an example")]

use std::path::PathBuf;

use brdf_model::{Brdf, Preset};
use brdf_param::Parametrization;
use brdf_plot::{
    Curves, Scale, Series, plot_coverage, plot_curves, plot_lobes, plot_polar, plot_slices,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from);
    let gold = Preset::find("ggx").ok_or("a built-in material")?.brdf();
    let paint = Preset::ALL[0].brdf();
    let materials: [(String, &dyn Brdf); 2] = [("gold".into(), &gold), ("paint".into(), &paint)];
    let albedo = |brdf: &dyn Brdf| {
        let degrees = (0..85).step_by(5).map(f64::from);
        let points = degrees.map(|theta| {
            (theta, brdf_model::directional_albedo(brdf, theta.to_radians()).luminance())
        });
        points.collect()
    };
    let albedos = Curves {
        title: "albedo".to_owned(),
        x: "theta_i (°)".to_owned(),
        y: "share of the light".to_owned(),
        y_scale: Scale::Linear,
        series: vec![Series::new("gold", albedo(&gold)), Series::new("paint", albedo(&paint))],
    };
    let plots = [
        ("polar", plot_polar("gold", &gold, &[0.0, 30.0, 60.0])?),
        ("lobes", plot_lobes("gold", &gold, &[30.0, 60.0])?),
        ("slices", plot_slices(&materials, Parametrization::HalfDifference, &[0.0, 90.0])?),
        ("coverage", plot_coverage("gold", &gold, None)?),
        ("albedo", plot_curves(&[albedos], 1)?),
    ];
    for (name, plot) in &plots {
        println!("{name}: {} bytes", plot.svg().len());
        if let Some(folder) = &folder {
            std::fs::write(folder.join(format!("{name}.svg")), plot.svg())?;
            std::fs::write(folder.join(format!("{name}.png")), plot.png()?)?;
        }
    }
    Ok(())
}
