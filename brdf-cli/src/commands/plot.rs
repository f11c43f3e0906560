//! `brdf plot`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context as _, bail};
use brdf_image::DisplayImage;
use brdf_io::{Measured, write_atomically};
use brdf_model::{Brdf, Channels, MerlLookup};
use brdf_param::{HemisphereMap, Parametrization};
use brdf_plot::{
    Curves, Plot, Scale, Series, plot_coverage, plot_curves, plot_lobes, plot_parametrizations,
    plot_polar, plot_slices, plot_test_functions, plot_textures,
};
use brdf_render::{Side, term_view, texture_view};
use brdf_separable::{
    BrdfMatrix, Decomposition, EigenSolver, HemisphereGrid, Layout, MatrixParams, RankCosineRms,
    SeparableParams, cosine_rms_by_rank, factorize_matrix,
};
use brdf_study::TestFunction;
use clap::ValueEnum;

use crate::args::{ForceArgs, ReadArgs, usage};
use crate::choices::SpaceArg;
use crate::progress::Progress;
use crate::report::separable::spectrum_plot;
use crate::subject::Subject;

/// Plot materials as SVG or PNG
///
/// Kinds: slice (luminance over two coordinates at chosen azimuths), polar (lobes in the plane of
/// incidence), lobe (three-dimensional), factors (textures of a fitted model), spectrum (singular
/// values), coverage (where there is data), parametrizations (slices with isolines, a row for each
/// parametrization), rank-error (cosine-weighted RMS of eigenpairs against their number, for
/// several resolutions). A MODEL may also be function:specular, function:fresnel, function:grazing
/// or, for parametrizations, function:all.
///
/// Examples:
///   brdf plot preset:ggx silk.binary -o slices.svg --kind slice
///   brdf plot preset:lafortune-blue-paint -o lobes.png --kind polar --incidence-deg 0,30,60
///   brdf plot function:all -o functions.svg --kind parametrizations
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(super) struct PlotArgs {
    /// Materials; several for slice and rank-error, one for the others
    #[arg(required = true)]
    models: Vec<String>,

    /// What to plot
    #[arg(long, value_enum)]
    kind: Kind,

    /// File to write, .svg or .png
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Coordinates of slices
    #[arg(long, value_enum, default_value_t = SpaceArg::HalfDifference)]
    space: SpaceArg,

    /// Azimuths of slices, degrees
    #[arg(long, value_name = "DEG,…", value_delimiter = ',', default_values_t = [0.0, 45.0, 90.0, 135.0, 180.0], value_parser = azimuth, allow_hyphen_values = true)]
    azimuth_deg: Vec<f64>,

    /// Incidences of lobes, degrees
    #[arg(long, value_name = "DEG,…", value_delimiter = ',', default_values_t = [0.0, 30.0, 60.0, 75.0], value_parser = incidence)]
    incidence_deg: Vec<f64>,

    #[command(flatten)]
    force: ForceArgs,

    #[command(flatten)]
    read: ReadArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    Slice,
    Polar,
    Lobe,
    Factors,
    Spectrum,
    Coverage,
    Parametrizations,
    RankError,
}

fn incidence(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(angle) if (0.0..90.0).contains(&angle) => Ok(angle),
        _ => Err("expected degrees from 0 to below 90".to_owned()),
    }
}

fn azimuth(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(angle) if (-360.0..=360.0).contains(&angle) => Ok(angle),
        _ => Err("expected degrees from -360 to 360".to_owned()),
    }
}

/// A material, or a test function of the parametrization study.
enum Plotted {
    Material(Subject),
    Function(TestFunction),
}

impl Plotted {
    fn brdf(&self) -> &dyn Brdf {
        match self {
            Self::Material(subject) => subject.brdf(),
            Self::Function(function) => function,
        }
    }

    fn name(&self) -> String {
        match self {
            Self::Material(subject) => subject.short_name(),
            Self::Function(function) => function.name().to_owned(),
        }
    }

    fn material(&self) -> anyhow::Result<&Subject> {
        match self {
            Self::Material(subject) => Ok(subject),
            Self::Function(function) => {
                bail!("function:{}: expected a material for this kind of plot", function.name())
            }
        }
    }
}

const FUNCTION: &str = "function:";

impl PlotArgs {
    pub(super) fn run(self, _out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let extension = self.output.extension().map(|e| e.to_string_lossy().to_lowercase());
        let as_png = match extension.as_deref() {
            Some("svg") => false,
            Some("png") => true,
            _ => bail!("{}: unknown extension; expected .svg or .png", self.output.display()),
        };
        let plot = self.plot()?;
        let bytes = if as_png { plot.png()? } else { plot.svg().as_bytes().to_vec() };
        write_atomically(&self.output, &bytes, self.force.overwrite())?;
        writeln!(std::io::stderr(), "{}", self.output.display())?;
        Ok(ExitCode::SUCCESS)
    }

    fn plot(&self) -> anyhow::Result<Plot> {
        if self.kind == Kind::Parametrizations && self.models == ["function:all"] {
            return Ok(plot_test_functions()?);
        }
        let options = self.read.options();
        let models: Vec<Plotted> = self
            .models
            .iter()
            .map(|argument| match argument.strip_prefix(FUNCTION) {
                Some(name) => {
                    let function = TestFunction::find(name).with_context(|| {
                        let names = TestFunction::ALL.map(TestFunction::name).join(", ");
                        format!("{argument}: no such function; expected one of {names}")
                    })?;
                    Ok(Plotted::Function(function))
                }
                None => Ok(Plotted::Material(Subject::open(argument, &options)?)),
            })
            .collect::<anyhow::Result<_>>()?;
        let only = || match &models[..] {
            [only] => Ok(only),
            _ => Err(usage("this kind of plot shows one material")),
        };
        match self.kind {
            Kind::Slice => {
                let space = self.space.parametrization().ok_or_else(|| {
                    usage("--space auto is for a search; expected the name of coordinates")
                })?;
                let named: Vec<(String, &dyn Brdf)> =
                    models.iter().map(|m| (m.name(), m.brdf())).collect();
                Ok(plot_slices(&named, space, &self.azimuth_deg)?)
            }
            Kind::Polar => {
                let model = only()?;
                Ok(plot_polar(&model.name(), model.brdf(), &self.incidence_deg)?)
            }
            Kind::Lobe => {
                let model = only()?;
                Ok(plot_lobes(&model.name(), model.brdf(), &self.incidence_deg)?)
            }
            Kind::Parametrizations => {
                let model = only()?;
                Ok(plot_parametrizations(&model.name(), model.brdf())?)
            }
            Kind::Factors => factors(only()?.material()?),
            Kind::Spectrum => spectrum(only()?.material()?),
            Kind::Coverage => {
                let subject = only()?.material()?;
                let name = subject.short_name();
                if let Some(Measured::Merl(table)) = subject.measurement().map(|m| &m.measured) {
                    // Interpolation would close the holes.
                    let cells = table.clone().with_lookup(MerlLookup::Nearest);
                    return Ok(plot_coverage(&name, &cells, None)?);
                }
                Ok(plot_coverage(&name, subject.brdf(), subject.samples())?)
            }
            Kind::RankError => {
                let subjects: Vec<&Subject> =
                    models.iter().map(Plotted::material).collect::<anyhow::Result<_>>()?;
                rank_errors(&subjects)
            }
        }
    }
}

/// The textures of a fitted model.
fn factors(subject: &Subject) -> anyhow::Result<Plot> {
    let pictures: Vec<(String, DisplayImage)> = match subject.measurement().map(|m| &m.measured) {
        Some(Measured::Model(file)) => {
            let channels = file.model.channels();
            let factors = file.model.factors().iter().enumerate();
            factors.map(|(i, f)| (format!("factor {i}"), texture_view(f, channels))).collect()
        }
        Some(Measured::Separable(file)) => {
            let model = &file.model;
            let [first, second] = model.layout().parametrization.hemisphere_names();
            let side = |side, name: &str| {
                (0..model.rank())
                    .map(|term| {
                        (format!("{name}, term {}", term + 1), term_view(model, side, term))
                    })
                    .collect::<Vec<_>>()
            };
            let mut all = side(Side::First, first);
            if model.second().is_some() {
                all.extend(side(Side::Second, second));
            }
            all
        }
        _ => bail!("{}: not a fitted model; expected one of `brdf factor`", subject.argument),
    };
    Ok(plot_textures(&pictures, 8)?)
}

/// Terms of a spectrum that is made for a material.
const SPECTRUM_TERMS: usize = 24;

/// The spectrum that a model's file holds, or that of a material's light × view matrix.
fn spectrum(subject: &Subject) -> anyhow::Result<Plot> {
    let name = subject.short_name();
    if let Some(Measured::Separable(file)) = subject.measurement().map(|m| &m.measured) {
        return Ok(spectrum_plot(&name, &file.fit.spectra)?);
    }
    let params = MatrixParams { channels: subject.channels(), ..MatrixParams::default() };
    let matrix = BrdfMatrix::sample(subject.brdf(), &light_view(32), &params)?;
    let fit = factorize_matrix(
        &matrix,
        &SeparableParams { rank: SPECTRUM_TERMS, tolerance: 1e-3, ..SeparableParams::default() },
    )?;
    Ok(spectrum_plot(&format!("{name}, wi × wo, 32²"), &fit.spectra)?)
}

fn light_view(resolution: usize) -> Layout {
    let chart = HemisphereGrid::Plane { map: HemisphereMap::OrthographicDisc, resolution };
    Layout::new(Parametrization::Standard, chart, chart)
}

/// Resolutions and ranks of figure 4 of the relighting paper.
const RESOLUTIONS: [usize; 4] = [16, 32, 48, 64];
const RANKS: usize = 16;

/// Cosine-weighted RMS of the eigenpairs of each material against their number: over whole
/// hemispheres, where a few grazing pairs may rule, and within 80°.
fn rank_errors(subjects: &[&Subject]) -> anyhow::Result<Plot> {
    let progress = Progress::new((subjects.len() * RESOLUTIONS.len()) as u64);
    let mut panels = Vec::new();
    for subject in subjects {
        let mut series = [Vec::new(), Vec::new()];
        for resolution in RESOLUTIONS {
            progress.step(format!("{}, {resolution}²", subject.short_name()));
            let errors = rank_error(subject.brdf(), resolution)?;
            for (series, points) in series.iter_mut().zip(errors) {
                series.push(Series::new(format!("{resolution}²"), points));
            }
            progress.done(1);
        }
        panels.extend(series.into_iter().zip(["all pairs", "within 80°"]).map(
            |(series, which)| Curves {
                title: format!("{}, {which}", subject.short_name()),
                x: "terms".to_owned(),
                y: "cosine-weighted RMS (1/sr)".to_owned(),
                y_scale: Scale::Linear,
                series,
            },
        ));
    }
    Ok(plot_curves(&panels, 2)?)
}

/// The errors of 1, 2, … terms: over all pairs, and over those within 80° of the normal.
fn rank_error(brdf: &dyn Brdf, resolution: usize) -> anyhow::Result<[Vec<(f64, f64)>; 2]> {
    let params = MatrixParams { channels: Channels::Rgb, ..MatrixParams::default() };
    let matrix = BrdfMatrix::sample(brdf, &light_view(resolution), &params)?.symmetrized()?;
    let fit = factorize_matrix(
        &matrix,
        &SeparableParams {
            decomposition: Decomposition::Eigen(EigenSolver::Krylov),
            rank: RANKS,
            tolerance: 1e-4,
            ..SeparableParams::default()
        },
    )?;
    let errors = cosine_rms_by_rank(brdf, &fit.model, 1);
    let points = |pick: fn(&RankCosineRms) -> f64| {
        let point = |(index, error): (usize, &RankCosineRms)| ((index + 1) as f64, pick(error));
        errors.iter().enumerate().map(point).take(RANKS).collect()
    };
    Ok([points(|e| e.absolute), points(|e| e.within_80)])
}
