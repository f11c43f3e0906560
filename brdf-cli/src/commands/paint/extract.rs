//! `brdf paint extract`.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context as _, bail};
use brdf_image::ToneMap;
use brdf_io::{
    OutputFolder, PaintRecord, PaintScene, PaintedFile, ReadOptions, painted_to_bytes,
    read_buffers, read_painting, read_scene, write_exr,
};
use brdf_mesh::UvSource;
use brdf_paint::pictures::{contradictions_view, coverage_view, map_view, view_strip};
use brdf_paint::{
    Extraction, Mode, PaintErrors, PaintLogTransform, PaintParams, PaintSamples, PaintedImage,
    SolverChoice, ViewBuffers, extract, face_views,
};
use brdf_render::{DirectionalLight, Light, SphereView, render_sphere};
use clap::ValueEnum;
use maud::html;
use serde_json::{Value, json};

use super::setup::{JUDGED_SIZE, blended};
use crate::args::{positive, usage};
use crate::meshes::open_mesh;
use crate::numbers::{bytes as shown_bytes, significant};
use crate::pictures::png;
use crate::progress::Progress;
use crate::report::html::{document, picture};
use crate::subject::Subject;

/// Make a material of a painted scene
///
/// Writes material.safetensors, each map as map-N.png and .exr, coverage.png (violet texels were filled from
/// around them), contradictions.png (where views show what cannot be the same material, in red), view-N.png
/// (painted, reconstructed, difference ×4), report.html and report.json.
///
/// Paintings are sRGB PNG or JPEG, 8 or 16 bits, or linear EXR, in painted/; transparent pixels do not count.
/// They show reflectance times π times the cosine to the light, and views without a painting are passed over.
///
/// Example: brdf paint extract scene/ -o material/
#[derive(clap::Args)]
pub(in crate::commands) struct Extract {
    /// Scene that `brdf paint setup` wrote, with its paintings
    scene: PathBuf,

    /// Folder to write
    #[arg(short, long, value_name = "FOLDER", default_value = "material")]
    output: PathBuf,

    /// What is made
    #[arg(long, value_enum, default_value_t = ModeArg::MaterialMap)]
    mode: ModeArg,

    /// How material maps are found
    #[arg(long, value_enum, default_value_t = SolverArg::Alternating)]
    solver: SolverArg,

    /// Summands of a material map
    #[arg(long, default_value_t = 5)]
    products: usize,

    /// Texels of each radial factor
    #[arg(long, default_value_t = 64)]
    texels: usize,

    /// Texels along each side of a factor over the surface
    #[arg(long, default_value_t = 32)]
    surface_size: usize,

    /// Texels along each side of the maps
    #[arg(long, default_value_t = 256)]
    map_size: usize,

    /// Weight μ of smoothing
    #[arg(long, default_value_t = 1e-4)]
    smoothing: f64,

    /// What products are fitted through
    #[arg(long, value_enum, default_value_t = LogMapArg::Offset)]
    log_map: LogMapArg,

    /// a of log(a + f), as a share of the mean; more tames dark colours [default: 0.05]
    #[arg(long, value_name = "SHARE", value_parser = positive)]
    offset: Option<f64>,

    /// Leave out pixels whose cosine to the light is below this
    #[arg(long, default_value_t = 0.1, value_parser = positive)]
    least_cosine: f64,

    /// Most pixels to learn from, evenly from all views
    #[arg(long, value_name = "COUNT", default_value_t = 4_000_000, value_parser = clap::value_parser!(u64).range(100..=100_000_000))]
    pixels: u64,

    /// Views to judge by instead of learning from them
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    hold_out: Vec<String>,

    /// Write into a folder that holds other files
    #[arg(long)]
    force: bool,

    /// Print report.json on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ModeArg {
    /// One BRDF everywhere
    Brdf,
    /// A BRDF times a factor over the surface
    FourFactor,
    /// BRDFs weighted by maps
    MaterialMap,
    /// Four-factor products weighted by maps
    Hybrid,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SolverArg {
    /// One product after another, as published
    Paper,
    /// Maps and products in turns
    Alternating,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum LogMapArg {
    /// log(a + f): dark colours as they are
    Offset,
    /// log(a − f), a above the brightest: highlights
    Highlight,
}

/// A view that has a painting.
struct Painted {
    name: String,
    white: [f64; 3],
    is_photograph: bool,
    buffers: PathBuf,
    picture: PathBuf,
}

impl Painted {
    fn read(&self, scene: &PaintScene) -> anyhow::Result<(ViewBuffers, PaintedImage)> {
        let buffers = read_buffers(&self.buffers, scene.size)?;
        Ok((buffers, read_painting(&self.picture)?.balanced(self.white)))
    }

    /// Pixels that are as bright as a file of whole numbers can hold: in a photograph, they may have been brighter.
    fn saturated(&self, image: &PaintedImage) -> usize {
        if self.picture.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
            return 0;
        }
        let is_full = |pixel: &&[f32; 4]| {
            pixel[..3].iter().zip(self.white).any(|(v, white)| f64::from(*v) * white >= 1.0 - 1e-6)
        };
        image.pixels.iter().filter(is_full).count()
    }
}

impl Extract {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let start = Instant::now();
        let path = self.scene.join("scene.toml");
        let text = std::fs::read_to_string(&path)
            .with_context(|| format!("{}: reading", path.display()))?;
        let scene = read_scene(&text).with_context(|| path.display().to_string())?;
        if let Some(name) =
            self.hold_out.iter().find(|name| !scene.views.iter().any(|v| v.name == **name))
        {
            let names: Vec<&str> = scene.views.iter().map(|view| view.name.as_str()).collect();
            bail!("--hold-out {name}: no such view; the scene has {}", names.join(", "));
        }
        if self.offset.is_some() && self.log_map != LogMapArg::Offset {
            return Err(usage("--offset is of --log-map offset"));
        }
        let mut folder = OutputFolder::new(&self.output, self.force)?;
        let progress = Progress::new(1);
        let (painted, mut notes) = self.find_views(&scene)?;
        let (mut training, mut held_out) = (PaintSamples::new(), PaintSamples::new());
        #[expect(clippy::cast_possible_truncation, reason = "at most 1e8")]
        let most = self.pixels as usize / painted.len();
        let mut passed_over = 0;
        for (view, of_view) in painted.iter().enumerate() {
            progress.step(format!("reading {}", of_view.name));
            let (buffers, image) = of_view.read(&scene)?;
            let mut samples = PaintSamples::new();
            samples.add(view, &of_view.name, &buffers, &image, self.least_cosine)?;
            let saturated = of_view.saturated(&image);
            if of_view.is_photograph && saturated > 0 {
                notes.push(format!(
                    "{}: {saturated} pixels are as bright as their file can hold, and may have been brighter",
                    of_view.picture.display()
                ));
            }
            passed_over += samples.len().saturating_sub(most);
            let is_held_out = self.hold_out.contains(&of_view.name);
            let into = if is_held_out { &mut held_out } else { &mut training };
            into.append(samples.subset(most));
        }
        if passed_over > 0 {
            notes.push(format!("{passed_over} pixels are more than --pixels and were not used"));
        }
        for (what, samples) in [("skipped", &training), ("skipped of held-out views", &held_out)] {
            if samples.skipped != brdf_paint::Skipped::default() {
                notes.push(format!("{what}: {}", samples.skipped));
            }
        }
        let params = self.params(scene.uv == UvSource::Sphere);
        let made = extract(&training, &params, &|step| progress.step(step.to_owned()))?;
        progress.step("judging");
        let held_out_errors = if held_out.is_empty() {
            self.truth_errors(&scene, &made).unwrap_or_else(|error| {
                // What was made is worth keeping without being judged.
                notes.push(format!("no held-out views: {error:#}"));
                None
            })
        } else {
            Some(held_out.errors(&made.material))
        };
        let clamped = made.material.clamped(&training);
        if clamped.below_zero + clamped.above_limit > 0 {
            notes.push(format!(
                "{} painted pixels have a product below 0, set to 0; {} are above the brightest painted, cut to it",
                clamped.below_zero, clamped.above_limit
            ));
        }
        let unconstrained = made.unconstrained.iter().filter(|u| **u).count();
        if unconstrained > 0 {
            notes.push(format!(
                "{unconstrained} of {} texels of the maps are in no painted pixel; filled from around them",
                made.unconstrained.len()
            ));
        }
        let contradictions = made.contradictions.count();
        if contradictions > 0 {
            notes.push(format!(
                "views contradict each other in {contradictions} of {} cells of the surface; see contradictions.png",
                made.contradictions.apart.len()
            ));
        }
        let record = PaintRecord { settings: params, uv: scene.uv };
        let file = PaintedFile { material: made.material.clone(), record };
        let bytes = painted_to_bytes(&file)?;
        folder.write("material.safetensors", &bytes)?;
        let strips = self.write_pictures(&mut folder, &scene, &made, &painted)?;
        // `brdf`, by which the folder is known as ours, comes first of all keys.
        let report = json!({
            "brdf": env!("CARGO_PKG_VERSION"), "scene": self.scene, "output": self.output,
            "rms": { "train": made.errors.rms, "held_out": held_out_errors.map(|e| e.rms) },
            "max": { "train": made.errors.max, "held_out": held_out_errors.map(|e| e.max) },
            "products": made.material.components.len(), "samples": training.len(),
            "unconstrained_texels": unconstrained, "smoothed_texels": made.smoothed_texels,
            "contradicted_cells": contradictions, "passed_over": passed_over,
            "skipped": training.skipped, "clamped": clamped, "bytes": bytes.len(),
            "seconds": start.elapsed().as_secs_f64(), "settings": params, "notes": notes,
        });
        folder.write("report.html", page(&report, &strips, &notes).as_bytes())?;
        let report = serde_json::to_string_pretty(&report)? + "\n";
        folder.write("report.json", report.as_bytes())?;
        folder.finish()?;
        drop(progress);
        if self.json {
            out.write_all(report.as_bytes())?;
            return Ok(ExitCode::SUCCESS);
        }
        writeln!(out, "{}: {}", self.output.display(), shown_bytes(bytes.len()))?;
        writeln!(
            out,
            "  RMS {} of {} painted pixels",
            significant(made.errors.rms),
            training.len()
        )?;
        if let Some(errors) = held_out_errors {
            writeln!(out, "  RMS {} of pixels that were not used", significant(errors.rms))?;
        }
        notes.iter().try_for_each(|note| writeln!(out, "  {note}"))?;
        Ok(ExitCode::SUCCESS)
    }

    fn params(&self, wraps: bool) -> PaintParams {
        PaintParams {
            mode: match self.mode {
                ModeArg::Brdf => Mode::Brdf,
                ModeArg::FourFactor => Mode::FourFactor,
                ModeArg::MaterialMap => Mode::MaterialMap,
                ModeArg::Hybrid => Mode::Hybrid,
            },
            solver: match self.solver {
                SolverArg::Paper => SolverChoice::Paper,
                SolverArg::Alternating => SolverChoice::Alternating,
            },
            products: self.products,
            texels: self.texels,
            surface_size: self.surface_size,
            map_size: self.map_size,
            smoothing: self.smoothing,
            log_map: match self.log_map {
                LogMapArg::Offset => PaintLogTransform::Offset(self.offset.unwrap_or(0.05)),
                LogMapArg::Highlight => PaintLogTransform::Highlight,
            },
            wraps,
        }
    }

    /// Views that were painted, and what should be said about the others.
    fn find_views(&self, scene: &PaintScene) -> anyhow::Result<(Vec<Painted>, Vec<String>)> {
        let folder = self.scene.join("painted");
        let pictures = pictures_in(&folder)?;
        let (mut painted, mut missing) = (Vec::new(), Vec::new());
        for view in &scene.views {
            let found: Vec<&PathBuf> =
                pictures.iter().filter(|path| is_of(path, &view.name)).collect();
            match &found[..] {
                [] => missing.push(view.name.as_str()),
                [picture] => {
                    let (name, picture) = (view.name.clone(), (*picture).clone());
                    let buffers = self.scene.join("buffers").join(format!("{name}.exr"));
                    let (white, is_photograph) = (view.white, view.has_shadows);
                    painted.push(Painted { name, white, is_photograph, buffers, picture });
                }
                [first, second, ..] => bail!(
                    "{} and {}: two paintings of one view; remove one",
                    first.display(),
                    second.display()
                ),
            }
        }
        if painted.is_empty() {
            bail!(
                "{}: no painting; save them as {}.png and so on, over the guides beside it",
                folder.display(),
                missing.first().unwrap_or(&"view00")
            );
        }
        let mut notes = Vec::new();
        if !missing.is_empty() {
            notes.push(format!("not painted: {}", missing.join(", ")));
        }
        let is_strange = |path: &&PathBuf| !scene.views.iter().any(|view| is_of(path, &view.name));
        let strange = pictures.iter().filter(is_strange);
        notes.extend(strange.map(|path| format!("{}: of no view, not used", path.display())));
        Ok((painted, notes))
    }

    /// Errors of views and lights between the painted ones, where what was painted is known.
    fn truth_errors(
        &self,
        scene: &PaintScene,
        made: &Extraction,
    ) -> anyhow::Result<Option<PaintErrors>> {
        let Some(record) = &scene.truth else { return Ok(None) };
        let mesh = open_mesh(Path::new(&scene.mesh), Some(scene.uv))?;
        let subjects: Vec<Subject> = record
            .materials
            .iter()
            .map(|name| Subject::open(name, &ReadOptions::default()))
            .collect::<anyhow::Result<_>>()?;
        let Some(mut truth) = blended(&subjects) else { return Ok(None) };
        truth.scale = record.scale;
        let mut samples = PaintSamples::new();
        for (at, view) in face_views(&mesh).iter().enumerate() {
            let [width, height] = scene.size.map(|side| side.min(JUDGED_SIZE));
            let buffers = ViewBuffers::of(&mesh, view, width, height);
            samples.add(at, &view.name, &buffers, &truth.paint(&buffers), self.least_cosine)?;
        }
        Ok(Some(samples.errors(&made.material)))
    }

    /// Pictures of views, maps and products, with captions, as PNG.
    fn write_pictures(
        &self,
        folder: &mut OutputFolder,
        scene: &PaintScene,
        made: &Extraction,
        painted: &[Painted],
    ) -> anyhow::Result<Vec<(String, Vec<u8>)>> {
        let mut pictures = Vec::new();
        for (at, of_view) in painted.iter().enumerate() {
            let (name, (buffers, image)) = (&of_view.name, of_view.read(scene)?);
            let strip = png(&view_strip(name, &buffers, &image, &made.material))?;
            folder.write(&format!("view-{}.png", at + 1), &strip)?;
            let held = if self.hold_out.contains(name) { ", held out" } else { "" };
            pictures.push((format!("{name}{held}"), strip));
        }
        let light = Light::Directional(DirectionalLight::default());
        for (at, component) in made.material.components.iter().enumerate() {
            let film = render_sphere(component.product.angular(), &light, &SphereView::default());
            let sphere = png(&ToneMap::exposed_for(&film).apply(&film))?;
            pictures.push((format!("product {}, factors of directions", at + 1), sphere));
            let Some(map) = &component.coefficients else { continue };
            let picture = png(&map_view(map))?;
            folder.write(&format!("map-{}.png", at + 1), &picture)?;
            let exr = write_exr(map.size, map.size, &[("Y", map.values.clone())])?;
            folder.write(&format!("map-{}.exr", at + 1), &exr)?;
            pictures.push((format!("map {}", at + 1), picture));
        }
        if !made.unconstrained.is_empty() {
            let coverage = png(&coverage_view(self.map_size, &made.unconstrained))?;
            folder.write("coverage.png", &coverage)?;
            pictures.push(("coverage: violet was filled".to_owned(), coverage));
        }
        let contradictions = png(&contradictions_view(&made.contradictions))?;
        folder.write("contradictions.png", &contradictions)?;
        pictures.push(("red: views contradict each other".to_owned(), contradictions));
        Ok(pictures)
    }
}

/// Files of a folder, in order.
fn pictures_in(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut paths: Vec<PathBuf> =
        entries.map(|entry| entry.map(|e| e.path())).collect::<Result<_, _>>()?;
    paths.retain(|path| path.is_file());
    paths.sort();
    Ok(paths)
}

/// Whether a file is the painting of a view.
fn is_of(path: &Path, view: &str) -> bool {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let is_picture = ending.is_some_and(|e| ["png", "jpg", "jpeg", "exr"].contains(&e.as_str()));
    is_picture && path.file_stem().is_some_and(|stem| stem == view)
}

fn page(report: &Value, pictures: &[(String, Vec<u8>)], notes: &[String]) -> String {
    document(
        "painted material",
        &html! {
            p {
                "RMS " (report["rms"]["train"]) " over " (report["samples"]) " painted pixels; of views and lights "
                "that were not used: " (report["rms"]["held_out"]) "."
            }
            ul { @for note in notes { li { (note) } } }
            @for (caption, bytes) in pictures {
                figure { (picture(bytes, caption)) figcaption { (caption) } }
            }
            h2 { "Settings" }
            pre { (serde_json::to_string_pretty(&report["settings"]).unwrap_or_default()) }
        },
    )
}
