//! Figures 4.1, 4.2 and 4.4 of Cole's thesis, drawn from the searches here.
//!
//! ```sh
//! cargo run --release -p brdf-cli --example thesis_figures -- figures          # the joint search, some minutes
//! cargo run --release -p brdf-cli --example thesis_figures -- figures powell   # the thesis' own, much longer
//! ```
//!
//! `figure-4-1.png`: a material, and five textures of 24² in standard and in half/difference space. The thesis
//! shows CURET velvet, which is not at hand; this is the Ashikhmin–Shirley preset. `figure-4-1-fabric.png`: the same of
//! red-fabric, a network fitted to MERL, from `BRDF_DATA` (default `../shared/data`); left out without it.
//! `figure-4-2.svg`: errors by number of textures, in both spaces, with and without reciprocity, textures of 24².
//! `figure-4-4.png`: the blue paint, two textures of 32² that were searched, and McCool's two.

#![expect(clippy::print_stdout, reason = "an example prints")]

use std::fs;
use std::path::PathBuf;

use anyhow::Context as _;
use brdf_container::MaterialFile;
use brdf_fit::{
    FactoredFit, FactoredMethod, FactoredSettings, Material, Reciprocity, SearchSettings, Strategy,
    fit_factored,
};
use brdf_image::{Panel, ToneMap, encode_png, strip};
use brdf_io::ReadOptions;
use brdf_job::Job;
use brdf_model::{Brdf, Channels, Preset};
use brdf_param::Space;
use brdf_plot::{Curves, Scale, Series, plot_curves};
use brdf_render::{DirectionalLight, Light, SphereView, render_sphere};
use brdf_search::Objective;

const SPACES: [Space; 2] = [Space::Standard, Space::HalfDifference];

fn main() -> anyhow::Result<()> {
    let mut words = std::env::args().skip(1);
    let folder = PathBuf::from(words.next().context("a folder to write to")?);
    let strategy = match words.next().as_deref() {
        Some("powell") => Strategy::Powell(Objective::Relative),
        _ => Strategy::Joint,
    };
    fs::create_dir_all(&folder)?;
    let searched = |terms: usize, spaces: &[Space]| {
        let spaces = spaces.to_vec();
        FactoredSettings::of(FactoredMethod::Search(SearchSettings {
            strategy,
            terms,
            spaces,
            ..SearchSettings::default()
        }))
    };

    println!(
        "figure 4.1: CURET velvet cannot be had; in its place the Ashikhmin-Shirley formula and red-fabric"
    );
    let formula = preset("ashikhmin-shirley")?;
    let fabric = red_fabric()?;
    let mut figures = vec![("figure-4-1.png", "Ashikhmin-Shirley", formula.as_ref())];
    if let Some(fabric) = &fabric {
        figures.push(("figure-4-1-fabric.png", "red-fabric (network)", fabric.brdf()));
    }
    for (file, name, material) in figures {
        let [standard, half] = SPACES.map(|space| fitted(material, &searched(5, &[space])));
        let (standard, half) = (standard?, half?);
        for (space, fit) in SPACES.iter().zip([&standard, &half]) {
            if let Some(term) = fit.terms.last() {
                let error = term.training.log.mean_square;
                println!("{name}, {}: mean square log error {error:.4}", space.name());
            }
        }
        let picture = spheres(&[
            (name, material),
            ("standard", &standard.last().model),
            ("half/difference", &half.last().model),
        ])?;
        fs::write(folder.join(file), picture)?;
        println!("wrote {}", folder.join(file).display());
    }

    let paint = preset("lafortune-blue-paint")?;
    let size = Some(32);
    let two = FactoredSettings { texture_size: size, ..searched(2, &SPACES) };
    let ours = fitted(paint.as_ref(), &two)?;
    let mccool =
        FactoredSettings { texture_size: size, ..FactoredSettings::of(FactoredMethod::McCool) };
    let mccool = fitted(paint.as_ref(), &mccool)?;
    let picture = spheres(&[
        ("blue paint", paint.as_ref()),
        ("searched, 2 textures", &ours.last().model),
        ("McCool, 2 textures", &mccool.last().model),
    ])?;
    fs::write(folder.join("figure-4-4.png"), picture)?;
    println!("wrote {}", folder.join("figure-4-4.png").display());

    let mut panels = Vec::new();
    for name in ["lafortune-blue-paint", "cook-torrance"] {
        let material = preset(name)?;
        let mut series = Vec::new();
        for space in SPACES {
            for (reciprocity, kind) in [(Reciprocity::On, "reciprocal"), (Reciprocity::Off, "free")]
            {
                let settings = FactoredSettings {
                    reciprocity,
                    channels: Some(Channels::Luminance),
                    ..searched(5, &[space])
                };
                let found = fitted(material.as_ref(), &settings)?;
                let points: Vec<(f64, f64)> = found
                    .terms
                    .iter()
                    .map(|term| (term.textures as f64, term.training.log.mean_square))
                    .collect();
                let label = format!("{}, {kind}", space.name());
                let errors: Vec<String> = points.iter().map(|p| format!("{:.5}", p.1)).collect();
                println!("{name}, {label}: {}", errors.join(" "));
                series.push(Series::new(label, points));
            }
        }
        panels.push(Curves {
            title: name.to_owned(),
            x: "textures".to_owned(),
            y: "mean square log error".to_owned(),
            y_scale: Scale::Log,
            series,
        });
    }
    fs::write(folder.join("figure-4-2.svg"), plot_curves(&panels, 2)?.svg())?;
    println!("wrote {}", folder.join("figure-4-2.svg").display());
    Ok(())
}

fn preset(name: &str) -> anyhow::Result<Box<dyn Brdf>> {
    Ok(Box::new(Preset::find(name).context("a preset of this name")?.brdf()))
}

/// The material nearest to velvet that is at hand, or `None`, with the reason printed.
fn red_fabric() -> anyhow::Result<Option<MaterialFile>> {
    let folder = std::env::var_os("BRDF_DATA")
        .map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from);
    let archive = folder.join("nbrdf").join("merl_dev.npz");
    if !archive.exists() {
        println!("red-fabric: skipped, {} is missing; set BRDF_DATA", archive.display());
        return Ok(None);
    }
    let source = format!("{}:red-fabric", archive.display());
    Ok(Some(MaterialFile::open(&source, &ReadOptions::default())?))
}

fn fitted(brdf: &dyn Brdf, settings: &FactoredSettings) -> anyhow::Result<FactoredFit> {
    Ok(fit_factored(&Material::new("material", brdf), settings, &Job::new())?)
}

/// Spheres side by side at the exposure of the first, as a PNG.
fn spheres(materials: &[(&str, &dyn Brdf)]) -> anyhow::Result<Vec<u8>> {
    let light = Light::Directional(DirectionalLight::default());
    let view = SphereView::default();
    let films: Vec<_> =
        materials.iter().map(|(_, brdf)| render_sphere(*brdf, &light, &view)).collect();
    let tone = ToneMap::exposed_for(&films[0]);
    let panels: Vec<Panel> = materials
        .iter()
        .zip(&films)
        .map(|((name, _), film)| Panel { picture: tone.apply(film), caption: (*name).to_owned() })
        .collect();
    Ok(encode_png(&strip(&panels))?)
}
