//! Error against bytes of every small model of isotropic materials: `cargo run --release -p brdf-cli --example
//! fidelity`. Words after it name materials; `merl_dev` means sixty more networks. Options:
//!
//! - `--no-search` leaves out the search, and `--networks` trains the networks: both take long.
//! - `--only TEXT` leaves out the models whose names do not have the text in them.
//! - `--plot FILE.svg` draws medians over the RGL files, and a panel for each into `FILE-materials.svg`.
//! - `--spheres DIR` shows the five worst materials as spheres, the reference beside models of about 8 kB.
//!
//! Materials are the RGL files, derived MERL tables and networks of `BRDF_DATA` (default `../shared/data`; those that
//! are missing are named) and isotropic presets. Errors are taken on pairs that no fit and no choice saw: half of those
//! of the second kind are around the mirror direction. J is the geometric mean of the eight errors of
//! `brdf_model::Fidelity`. Scattered measurements have too few rows for that: ten folds judge them, as `brdf factor`
//! does.

#![expect(clippy::print_stdout, reason = "an example prints")]

mod folds;
mod methods;
mod spheres;
mod table;
mod trade_off;

use std::path::{Path, PathBuf};

use anyhow::bail;
use brdf_container::MaterialFile;
use brdf_io::ReadOptions;

use crate::folds::print_folds;
use crate::methods::methods;
use crate::spheres::write_spheres;
use crate::table::{Row, measure, print_header, print_row, summarize};
use crate::trade_off::write_plots;

/// Sources within the data folder, archives with all that they hold; then presets.
const FILES: [&str; 12] = [
    "rgl/aurora_white_rgb.bsdf",
    "rgl/cc_iris_purple_gem_rgb.bsdf",
    "rgl/cc_nothern_aurora_rgb.bsdf",
    "rgl/chm_light_blue_rgb.bsdf",
    "rgl/cm_military_green_rgb.bsdf",
    "rgl/vch_silk_blue_rgb.bsdf",
    "merl_layout_derived/aurora_white.binary",
    "merl_layout_derived/vch_silk_blue.binary",
    "nbrdf/nielsen_dev.npz",
    "cornell/garnet_red.brdf",
    "cornell/krylon_blue.brdf",
    "ptfe/PTFE.data.csv",
];
/// Sixty networks, which are opened only if a word names the archive: they take an hour.
const MANY: &str = "nbrdf/merl_dev.npz";
const PRESETS: [&str; 5] =
    ["lafortune-blue-paint", "cook-torrance", "red-plastic", "lafortune-clay", "ggx"];

/// What the command line asks for.
#[derive(Default)]
struct Options {
    with_search: bool,
    with_networks: bool,
    only: Option<String>,
    plot: Option<PathBuf>,
    spheres: Option<PathBuf>,
    names: Vec<String>,
}

impl Options {
    fn parse(mut words: impl Iterator<Item = String>) -> anyhow::Result<Self> {
        let mut options = Self { with_search: true, ..Self::default() };
        while let Some(word) = words.next() {
            match word.as_str() {
                "--no-search" => options.with_search = false,
                "--networks" => options.with_networks = true,
                "--only" => options.only = words.next(),
                "--plot" => options.plot = words.next().map(PathBuf::from),
                "--spheres" => options.spheres = words.next().map(PathBuf::from),
                other if other.starts_with("--") => bail!(
                    "unknown option {other}; expected --no-search, --networks, --only TEXT, --plot FILE or --spheres DIR"
                ),
                _ => options.names.push(word),
            }
        }
        Ok(options)
    }
}

fn main() -> anyhow::Result<()> {
    let options = Options::parse(std::env::args().skip(1))?;
    let materials = materials(&options.names)?;
    let (scattered, dense): (Vec<_>, Vec<_>) =
        materials.into_iter().partition(|material| material.samples().is_some());
    let mut methods = methods(options.with_search, options.with_networks);
    methods.retain(|method| options.only.as_ref().is_none_or(|text| method.name.contains(text)));

    print_header();
    let mut all: Vec<Vec<Row>> = Vec::new();
    for file in &dense {
        let rows = measure(file, &methods)?;
        for row in &rows {
            print_row(&file.short_name(), row);
        }
        all.push(rows);
    }
    let is_rgl = |file: &MaterialFile| file.source.ends_with(".bsdf");
    let of = |wanted: bool| -> Vec<&Vec<Row>> {
        let files = all.iter().zip(&dense).filter(|(_, file)| is_rgl(file) == wanted);
        files.map(|(rows, _)| rows).collect()
    };
    summarize("RGL files", &of(true));
    summarize("other materials", &of(false));
    summarize("materials in all", &all.iter().collect::<Vec<_>>());
    if !scattered.is_empty() {
        print_folds(&scattered, &methods)?;
    }
    if let Some(path) = &options.plot {
        let named: Vec<(String, &Vec<Row>)> = all
            .iter()
            .zip(&dense)
            .filter(|(_, file)| is_rgl(file))
            .map(|(rows, file)| (file.short_name(), rows))
            .collect();
        write_plots(path, &named)?;
    }
    if let Some(folder) = &options.spheres {
        write_spheres(folder, &dense, &all)?;
    }
    Ok(())
}

/// Opens all materials, or those whose source has one of some words in it.
fn materials(names: &[String]) -> anyhow::Result<Vec<MaterialFile>> {
    let root = std::env::var_os("BRDF_DATA").unwrap_or_else(|| "../shared/data".into());
    let mut materials = Vec::new();
    let is_asked = |file: &str| names.iter().any(|name| file.contains(name));
    for file in FILES.into_iter().chain(is_asked(MANY).then_some(MANY)) {
        let path = Path::new(&root).join(file);
        match MaterialFile::open_all(&path.to_string_lossy(), &ReadOptions::default()) {
            Ok(found) => materials.extend(found),
            Err(error) => println!("left out: {error}"),
        }
    }
    for preset in PRESETS {
        materials.push(MaterialFile::open(&format!("preset:{preset}"), &ReadOptions::default())?);
    }
    materials.retain(|m| names.is_empty() || names.iter().any(|name| m.source.contains(name)));
    Ok(materials)
}
