//! `brdf relight sweep`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use brdf_image::{Film, Panel, Pixel, ToneMap, strip};
use brdf_io::{OutputFolder, ReadOptions};
use brdf_mesh::Mesh;
use brdf_model::Brdf;
use brdf_plot::{Curves, Scale, Series, plot_curves};
use brdf_relight::{
    CubeLight, Occluder, Part, RelitScene, RenderParams, Transport, exact_part, render,
};
use serde_json::json;

use super::loading::{LightArgs, Loaded, ShotArgs, mesh_of};
use crate::args::{positive, usage};
use crate::numbers::significant;
use crate::pictures::png;
use crate::progress::Progress;
use crate::subject::Subject;

/// Show what fewer terms, or fewer coefficients, do to a picture
///
/// Writes a folder: strip.png, a picture for each number and one by brute force, errors.svg, and report.json. Terms and
/// coefficients are taken from the file, largest first. Brute force takes all light with adaptive rays at each vertex (a
/// minute; coarse meshes show it coarsely), and the exact BRDF where terms vary, the file's terms where coefficients do.
///
/// Example: brdf relight sweep bunny.prt --env grace.hdr --brdf preset:plastic --terms 1,4,16 -o terms
#[derive(clap::Args)]
pub(in crate::commands) struct Sweep {
    /// File that `brdf relight precompute` wrote
    object: PathBuf,

    /// Numbers of terms
    #[arg(
        long,
        value_name = "K,…",
        value_delimiter = ',',
        required_unless_present = "coefficients"
    )]
    terms: Vec<usize>,

    /// Numbers of wavelet coefficients of each vertex and term; of a file of --codec wavelet
    #[arg(long, value_name = "N,…", value_delimiter = ',', conflicts_with = "terms")]
    coefficients: Vec<usize>,

    /// The material that it was made with, where terms vary
    #[arg(long, value_name = "MODEL", default_value = "preset:plastic")]
    brdf: String,

    #[command(flatten)]
    light: LightArgs,

    #[command(flatten)]
    shot: ShotArgs,

    /// Factor from linear values to what is shown as white
    #[arg(long, value_parser = positive)]
    exposure: Option<f64>,

    /// Folder to write
    #[arg(short, long, value_name = "FOLDER", default_value = "sweep")]
    output: PathBuf,

    /// Write into a folder that holds other files
    #[arg(long)]
    force: bool,
}

impl Sweep {
    pub(in crate::commands) fn run(self, _out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let loaded = Loaded::open(&self.object)?;
        let file = loaded.parse()?;
        let subject = Subject::open(&self.brdf, &ReadOptions::default())?;
        let mesh = mesh_of(&file)?;
        let (light, shot) = (self.light.light()?, self.shot.shot(&mesh, 0.0));
        let lit = self.light.coefficients(&light);
        let mut folder = OutputFolder::new(&self.output, self.force)?;
        let (what, values) = match self.terms.is_empty() {
            false => ("terms", &self.terms),
            true => ("coefficients", &self.coefficients),
        };
        let films = values.iter().map(|value| {
            let (mut relit, parts) = (RelitScene::default(), self.cut(&file.parts, *value)?);
            relit.relight(&parts, &lit);
            if what == "terms" {
                keep_terms(&parts[0], &mut relit.parts[0], *value);
            }
            Ok(render(&parts, &relit, &shot).0)
        });
        let films = films.collect::<anyhow::Result<Vec<Film>>>()?;
        let brdf = (what == "terms").then(|| subject.brdf());
        let wanted = by_brute_force(&file.parts, &mesh, brdf, &light, &shot);
        let tone = self
            .exposure
            .map_or_else(|| ToneMap::exposed_for(&wanted), |exposure| ToneMap { exposure });
        let errors: Vec<f64> = films.iter().map(|film| relative_rms(film, &wanted)).collect();
        let caption =
            |value: &usize, error: &f64| format!("{what}: {value}, RMS {}", significant(*error));
        let mut panels: Vec<Panel> = values
            .iter()
            .zip(&errors)
            .zip(&films)
            .map(|((value, error), film)| Panel {
                picture: tone.apply(film),
                caption: caption(value, error),
            })
            .collect();
        panels.push(Panel { picture: tone.apply(&wanted), caption: "brute force".to_owned() });
        folder.write("strip.png", &png(&strip(&panels))?)?;
        let points = values.iter().map(|v| *v as f64).zip(errors.iter().copied()).collect();
        let curves = Curves {
            title: format!("{} of {}", subject.short_name(), file.record.mesh),
            x: what.to_owned(),
            y: "relative RMS of the picture".to_owned(),
            y_scale: Scale::Log,
            series: vec![Series::new(self.light.name(), points)],
        };
        folder.write("errors.svg", plot_curves(&[curves], 1)?.svg().as_bytes())?;
        let report = json!({
            "brdf": env!("CARGO_PKG_VERSION"), "object": self.object, "material": subject.short_name(),
            "env": self.light.name(), "exposure": tone.exposure, what: values, "relative_rms": errors,
        });
        folder.write("report.json", (serde_json::to_string_pretty(&report)? + "\n").as_bytes())?;
        folder.finish()?;
        for (value, error) in values.iter().zip(&errors) {
            writeln!(std::io::stderr(), "{}", caption(value, error))?;
        }
        writeln!(std::io::stderr(), "{}", self.output.display())?;
        Ok(ExitCode::SUCCESS)
    }

    /// The parts with so many coefficients, if that is what varies.
    fn cut<'a>(&self, parts: &[Part<'a>], value: usize) -> anyhow::Result<Vec<Part<'a>>> {
        if self.coefficients.is_empty() {
            let most = parts.first().context("no parts")?.maps.terms;
            if !(1..=most).contains(&value) {
                return Err(usage(format!(
                    "{value} terms; {} has 1 to {most}",
                    self.object.display()
                )));
            }
            return Ok(parts.to_vec());
        }
        let cut = parts.iter().map(|part| match &part.transport {
            Transport::Wavelets(sparse) => {
                let mut part = part.clone();
                part.transport = Transport::Wavelets(sparse.largest(value));
                Ok(part)
            }
            Transport::Clusters(_) => Err(usage(format!(
                "{}: has components of clusters; expected one of `precompute --codec wavelet`",
                self.object.display()
            ))),
        });
        cut.collect()
    }
}

/// The picture of the exact BRDF, or of the object's own terms where there is none, at vertices.
fn by_brute_force(
    parts: &[Part<'_>],
    mesh: &Mesh,
    brdf: Option<&dyn Brdf>,
    light: &CubeLight,
    shot: &RenderParams,
) -> Film {
    let vertices = parts.iter().map(|part| part.surface.positions.len() as u64).sum();
    let progress = Progress::new(vertices);
    progress.step("brute force");
    let (occluder, done) = (Occluder::of(mesh), || progress.done(1));
    let mut relit = RelitScene::default();
    let parts = parts.iter().enumerate().map(|(index, part)| {
        // The ground's own map is exact.
        let brdf = brdf.filter(|_| index == 0);
        let (part, colours) =
            exact_part(part, mesh, &occluder, brdf, light, shot.camera.eye, &done);
        relit.parts.push(colours);
        part
    });
    let parts: Vec<Part<'_>> = parts.collect();
    render(&parts, &relit, shot).0
}

/// Sets what arrives for further terms to 0.
fn keep_terms(part: &Part<'_>, arriving: &mut [[f32; 3]], terms: usize) {
    for vertex in arriving.chunks_exact_mut(part.maps.terms) {
        vertex[terms..].fill([0.0; 3]);
    }
}

/// Of pixels that show an object in both, over the root of the mean square of `wanted`.
fn relative_rms(found: &Film, wanted: &Film) -> f64 {
    let pairs = found.pixels().iter().zip(wanted.pixels());
    let shown = pairs.filter_map(|pair| match pair {
        (Pixel::Radiance(found, _), Pixel::Radiance(wanted, _)) => {
            Some((found.channels(), wanted.channels()))
        }
        _ => None,
    });
    let (apart, whole) = shown.fold((0.0, 0.0), |(apart, whole), (found, wanted)| {
        let differs = found.iter().zip(wanted).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        (apart + differs, whole + wanted.iter().map(|v| v * v).sum::<f64>())
    });
    if whole > 0.0 { (apart / whole).sqrt() } else { 0.0 }
}
