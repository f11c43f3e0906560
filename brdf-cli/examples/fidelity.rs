//! Error against bytes of every small model of isotropic materials: `cargo run --release -p brdf-cli --example
//! fidelity`. Words after it name materials, or `--no-search` to leave out the search, which takes most of the time.
//!
//! Materials are the RGL files, derived MERL tables and networks of `BRDF_DATA` (default `../shared/data`; those that
//! are missing are named) and isotropic presets. Errors are taken on pairs that no fit and no choice saw: half of those
//! of the second kind are around the mirror direction. J is the geometric mean of the eight errors of
//! `brdf_model::Fidelity`.

#![expect(clippy::print_stdout, reason = "an example prints")]

use std::path::Path;
use std::time::Instant;

use brdf_container::MaterialFile;
use brdf_fit::{
    Candidate, CompactMethod, CompactSettings, CompareSettings, FactoredMethod, FactoredSettings,
    Fit, FitSettings, LogChoice, SearchSettings, SeparableMethod, SeparableSettings, compare, fit,
    metric_lights,
};
use brdf_io::ReadOptions;
use brdf_job::Job;
use brdf_model::{Fidelity, FidelityPairs};
use brdf_param::Parametrization;

/// Sources within the data folder, archives with all that they hold; then presets.
const FILES: [&str; 10] = [
    "rgl/aurora_white_rgb.bsdf",
    "rgl/cc_iris_purple_gem_rgb.bsdf",
    "rgl/cc_nothern_aurora_rgb.bsdf",
    "rgl/chm_light_blue_rgb.bsdf",
    "rgl/cm_military_green_rgb.bsdf",
    "rgl/vch_silk_blue_rgb.bsdf",
    "merl_layout_derived/aurora_white.binary",
    "merl_layout_derived/vch_silk_blue.binary",
    "nbrdf/merl_dev.npz",
    "nbrdf/nielsen_dev.npz",
];
const PRESETS: [&str; 5] =
    ["lafortune-blue-paint", "cook-torrance", "red-plastic", "lafortune-clay", "ggx"];
/// Which scramble the pairs of errors come from: no fit uses it.
const SEED: u64 = 4711;

/// A model of one material.
struct Row {
    model: &'static str,
    bytes: usize,
    seconds: f64,
    fidelity: Fidelity,
    /// ΔE_ITP of a sphere under the studio.
    studio: f64,
}

fn main() -> anyhow::Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let with_search = !words.iter().any(|word| word == "--no-search");
    let names: Vec<&String> = words.iter().filter(|word| !word.starts_with("--")).collect();
    let root = std::env::var_os("BRDF_DATA").unwrap_or_else(|| "../shared/data".into());
    let mut materials = Vec::new();
    for file in FILES {
        let path = Path::new(&root).join(file);
        match MaterialFile::open_all(&path.to_string_lossy(), &ReadOptions::default()) {
            Ok(found) => materials.extend(found),
            Err(error) => println!("left out: {error}"),
        }
    }
    for preset in PRESETS {
        materials.push(MaterialFile::open(&format!("preset:{preset}"), &ReadOptions::default())?);
    }
    materials.retain(|m| names.is_empty() || names.iter().any(|name| m.source.contains(*name)));

    println!(
        "{:34} {:14} {:>6} {:>6}  {:>7}  {:>7} {:>7}  {:>7} {:>7}  {:>6}",
        "material", "model", "bytes", "s", "J", "lc", "rel", "lc hl", "rel hl", "ΔE_ITP"
    );
    let mut all: Vec<Vec<Row>> = Vec::new();
    for material in &materials {
        let rows = measure(material, with_search)?;
        for row in &rows {
            print(&material.short_name(), row);
        }
        all.push(rows);
    }
    let rgl: Vec<&Vec<Row>> = all
        .iter()
        .zip(&materials)
        .filter(|(_, m)| m.source.ends_with(".bsdf"))
        .map(|(rows, _)| rows)
        .collect();
    summarize(&format!("the {} RGL files", rgl.len()), &rgl);
    summarize(&format!("all {} materials", all.len()), &all.iter().collect::<Vec<_>>());
    Ok(())
}

/// Every method at its sizes.
fn methods(with_search: bool) -> Vec<(&'static str, FitSettings)> {
    let compact = |method| FitSettings::Compact(CompactSettings::of(method));
    let splines = [("splines 1k", 1_000), ("splines 2.7k", 2_700), ("splines 8k", 8_192)];
    let splines = splines.into_iter().chain([("splines 33k", 33_000)]);
    let mut methods: Vec<(&'static str, FitSettings)> =
        splines.map(|(name, bytes)| (name, compact(CompactMethod::Spline { bytes }))).collect();
    for (name, lobes) in [("GGX, 1 lobe", 1), ("GGX, 2 lobes", 2)] {
        methods.push((name, compact(CompactMethod::Ggx { lobes })));
    }
    for (name, size) in [("McCool 10²", 10), ("McCool 18²", 18), ("McCool 38²", 38)] {
        let mccool = FactoredSettings::of(FactoredMethod::McCool);
        let texture_size = Some(size);
        methods.push((name, FitSettings::Factored(FactoredSettings { texture_size, ..mccool })));
    }
    for (name, resolution, rank) in [("log-SVD 16", 16, 3), ("log-SVD 32", 32, 3)] {
        let settings = SeparableSettings {
            parametrization: Parametrization::HalfDifference,
            isotropic: true,
            resolution,
            rank: Some(rank),
            ..SeparableSettings::of(SeparableMethod::LogSvd(LogChoice::Offset))
        };
        methods.push((name, FitSettings::Separable(settings)));
    }
    if with_search {
        let search = FactoredSettings::of(FactoredMethod::Search(SearchSettings::default()));
        methods.push(("search 5 × 24²", FitSettings::Factored(search)));
    }
    methods
}

fn measure(file: &MaterialFile, with_search: bool) -> anyhow::Result<Vec<Row>> {
    let material = file.material();
    let judge = FidelityPairs::new(SEED, 80_f64.to_radians());
    let mut rows = Vec::new();
    for (model, settings) in methods(with_search) {
        let start = Instant::now();
        let found: Fit = fit(&material, &settings, &Job::new())?;
        let seconds = start.elapsed().as_secs_f64();
        let fidelity = judge.measure(material.brdf(), found.brdf());
        let studio = metric_lights(None)?.into_iter().filter(|(name, _)| name == "studio");
        let settings = CompareSettings {
            samples: 1000,
            lights: studio.collect(),
            ..CompareSettings::default()
        };
        let bytes = found.bytes();
        let candidate = Candidate { label: model.to_owned(), brdf: found.brdf(), bytes };
        let compared = compare(&material, &[candidate], &settings, &Job::new())?;
        let studio = compared.results[0].pictures.first().map_or(0.0, |p| p.errors.delta_e_itp);
        rows.push(Row { model, bytes, seconds, fidelity, studio });
    }
    Ok(rows)
}

fn print(name: &str, row: &Row) {
    let Fidelity { uniform, highlight } = row.fidelity;
    println!(
        "{name:34} {:14} {:6} {:6.2}  {:.5}  {:.5} {:7.4}  {:.5} {:7.4}  {:6.2}",
        row.model,
        row.bytes,
        row.seconds,
        row.fidelity.score(),
        uniform.log_cosine,
        uniform.cosine_relative,
        highlight.log_cosine,
        highlight.cosine_relative,
        row.studio
    );
}

/// Prints the median and the worst of each model over some materials.
fn summarize(title: &str, materials: &[&Vec<Row>]) {
    let Some(first) = materials.first() else { return };
    println!("\n{title}: median (worst)\n");
    println!(
        "| model | bytes | J | log-cosine | at the highlight | relative | at the highlight | ΔE_ITP | fit, s |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for index in 0..first.len() {
        let figure = |digits: usize, of: &dyn Fn(&Row) -> f64| {
            let mut values: Vec<f64> = materials.iter().map(|rows| of(&rows[index])).collect();
            values.sort_by(f64::total_cmp);
            let (low, high) = (values[(values.len() - 1) / 2], values[values.len() / 2]);
            let worst = values[values.len() - 1];
            format!("{:.digits$} ({worst:.digits$})", 0.5 * (low + high))
        };
        println!(
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            first[index].model,
            figure(0, &|row| row.bytes as f64),
            figure(4, &|row| row.fidelity.score()),
            figure(4, &|row| row.fidelity.uniform.log_cosine),
            figure(4, &|row| row.fidelity.highlight.log_cosine),
            figure(3, &|row| row.fidelity.uniform.cosine_relative),
            figure(3, &|row| row.fidelity.highlight.cosine_relative),
            figure(1, &|row| row.studio),
            figure(2, &|row| row.seconds),
        );
    }
}
