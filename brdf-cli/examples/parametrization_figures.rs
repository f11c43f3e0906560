//! The hemispheres in figures 1 and 2 of Barla, Belcour and Pacanowski 2015, the slices of figure 2, hemispheres of
//! materials, and the figures that stand behind the paper's claims about them.
//!
//! ```sh
//! cargo run --release -p brdf-cli --example parametrization_figures -- figures
//! ```
//!
//! `figure-1.svg`: both coordinates of three parametrizations. `figure-2.svg`, `figure-2-slices.svg`: the test
//! functions. `hemispheres-NAME.svg`: the luminance of a formula, of a measured material, and of networks fitted to the
//! paper's materials. Files are read from `BRDF_DATA` (default `../shared/data`) and skipped without it.

#![expect(clippy::print_stdout, reason = "an example prints")]

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use brdf_container::MaterialFile;
use brdf_io::ReadOptions;
use brdf_model::Brdf;
use brdf_param::Parametrization;
use brdf_plot::{
    Plot, plot_coordinate_hemispheres, plot_luminance_hemispheres, plot_test_function_hemispheres,
    plot_test_functions,
};
use brdf_study::{Centre, Circle, STUDIED, TestFunction, alignment, highlight_centre, ring_spread};

/// Viewers, degrees from the normal. The paper has three and does not say which.
const THETA_O: [f64; 3] = [30.0, 60.0, 75.0];
/// Circles about the mirror and back direction, radians, from above a length.
const RADIUS: f64 = 0.1;
/// Parametrizations by half vectors: the paper's three.
const HALF_VECTORS: [Parametrization; 3] =
    [Parametrization::HalfDifference, Parametrization::Orthographic, Parametrization::Hybrid];
/// Materials: a file name, what it is, and the source; of the last three the paper shows slices, figures 3 to 5.
const MATERIALS: [(&str, &str, &str); 5] = [
    ("cook-torrance", "Cook-Torrance, a formula", "preset:cook-torrance"),
    ("silk-blue", "vch_silk_blue, measured", "rgl/vch_silk_blue_rgb.bsdf"),
    ("gold-paint", "gold-paint, a network", "nbrdf/merl_dev.npz:gold-paint"),
    ("maple", "colonial-maple-223, a network", "nbrdf/merl_dev.npz:colonial-maple-223"),
    ("pink-felt", "pink-felt, a network", "nbrdf/merl_dev.npz:pink-felt"),
];

fn main() -> anyhow::Result<()> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from).context("a folder to write to")?;
    fs::create_dir_all(&folder)?;

    write(&folder, "figure-1.svg", &plot_coordinate_hemispheres(&THETA_O)?)?;
    print_rings();
    write(&folder, "figure-2.svg", &plot_test_function_hemispheres(&THETA_O)?)?;
    write(&folder, "figure-2-slices.svg", &plot_test_functions()?)?;
    print_alignment();

    println!(
        "gold-metallic-paint3 of the paper cannot be had; gold-paint in its place. The paper's other materials are"
    );
    println!("networks fitted to MERL, smoother than measurements.\n");
    for (file, name, source) in MATERIALS {
        let Some(material) = open(source)? else { continue };
        let plot = plot_luminance_hemispheres(name, material.brdf(), &THETA_O)?;
        write(&folder, &format!("hemispheres-{file}.svg"), &plot)?;
        print_highlight(name, material.brdf());
    }
    Ok(())
}

fn write(folder: &Path, name: &str, plot: &Plot) -> anyhow::Result<()> {
    let path = folder.join(name);
    fs::write(&path, plot.svg())?;
    println!("wrote {}\n", path.display());
    Ok(())
}

/// A preset, or a file of the data folder; `None`, with the reason printed, where it is missing.
fn open(source: &str) -> anyhow::Result<Option<MaterialFile>> {
    if source.starts_with("preset:") {
        return Ok(Some(MaterialFile::open(source, &ReadOptions::default())?));
    }
    let data = std::env::var_os("BRDF_DATA")
        .map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from);
    let path = data.join(source.split(':').next().unwrap_or(source));
    if !path.exists() {
        println!("{source}: skipped, {} is missing; set BRDF_DATA\n", path.display());
        return Ok(None);
    }
    let file = MaterialFile::open(&data.join(source).to_string_lossy(), &ReadOptions::default());
    match file {
        Ok(file) => Ok(Some(file)),
        Err(problem) => {
            println!("{source}: skipped, {:#}\n", anyhow::Error::from(problem));
            Ok(None)
        }
    }
}

/// How round isolines are about the mirror direction (first coordinate) and the viewer (second).
fn print_rings() {
    println!(
        "largest / smallest value of a coordinate along a circle of radius {RADIUS}; 1: its isolines are such circles"
    );
    println!(
        "(mirror: first coordinate about the mirror direction; back: second about the viewer)"
    );
    print!("{:17}{:10}", "", "theta_o");
    for centre in Centre::ALL {
        for circle in ["by angle", "from above"] {
            print!("{:>20}", format!("{}, {circle}", centre.name()));
        }
    }
    println!();
    for parametrization in HALF_VECTORS {
        for degrees in THETA_O {
            print!("{:17}{:10}", parametrization.name(), format!("{degrees}°"));
            for centre in Centre::ALL {
                for circle in [Circle::ByAngle, Circle::FromAbove] {
                    let spread =
                        ring_spread(parametrization, centre, degrees.to_radians(), circle, RADIUS);
                    print!("{:>20}", spread.map_or("–".to_owned(), |times| format!("{times:.2}")));
                }
            }
            println!();
        }
    }
    println!();
}

/// How far isolines of the test functions leave the axes of slices.
fn print_alignment() {
    println!(
        "share of the gradient across the axes of slices; 0: every isoline runs along an axis"
    );
    print!("{:17}", "");
    for function in TestFunction::ALL {
        print!("{:>10}", function.name());
    }
    println!();
    for parametrization in STUDIED {
        print!("{:17}", parametrization.name());
        for function in TestFunction::ALL {
            print!("{:10.3}", alignment(&function, parametrization).across_axes);
        }
        println!();
    }
    println!();
}

/// Where the highlight lies for each viewer, and how far its centre moves along each axis.
fn print_highlight(name: &str, brdf: &dyn Brdf) {
    println!("{name}: centre of the highlight, shares of both axes; how far it moves along each");
    print!("{:17}", "");
    for degrees in THETA_O {
        print!("{:>14}", format!("{degrees}°"));
    }
    println!("{:>14}{:>8}", "first moves", "second");
    for parametrization in STUDIED {
        print!("{:17}", parametrization.name());
        let centres =
            THETA_O.map(|degrees| highlight_centre(brdf, parametrization, degrees.to_radians()));
        for centre in centres {
            let text = centre.map_or("–".to_owned(), |[a, b]| format!("{a:.3}, {b:.3}"));
            print!("{text:>14}");
        }
        let [first, second] = [0, 1].map(|axis| {
            let along = || centres.iter().flatten().map(|centre| centre[axis]);
            along().fold(f64::MIN, f64::max) - along().fold(f64::MAX, f64::min)
        });
        println!("{first:14.3}{second:8.3}");
    }
    println!();
}
