//! `brdf plot`.

use std::io::Write;
use std::path::PathBuf;

use anyhow::{Context as _, bail};
use brdf_container::{Content, MaterialFile};
use brdf_files::write_atomically;
use brdf_fit::{light_view_spectrum, rank_errors};
use brdf_io::Measured;
use brdf_model::{Brdf, MerlLookup};
use brdf_plot::{
    Plot, plot_coverage, plot_lobes, plot_parametrizations, plot_polar, plot_slices,
    plot_test_functions,
};
use brdf_report::{
    factored_textures_plot, rank_error_plot, separable_textures_plot, spectrum_plot,
};
use brdf_study::TestFunction;
use clap::ValueEnum;

use crate::args::{ReadArgs, usage, within};
use crate::choices::SpaceArg;
use crate::outputs::ForceArgs;
use crate::progress::Watch;

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
    #[arg(long, value_name = "DEG,…", value_delimiter = ',', default_values_t = [0.0, 45.0, 90.0, 135.0, 180.0], value_parser = within(-360.0..=360.0, "degrees from -360 to 360"), allow_hyphen_values = true)]
    azimuth_deg: Vec<f64>,

    /// Incidences of lobes, degrees
    #[arg(long, value_name = "DEG,…", value_delimiter = ',', default_values_t = [0.0, 30.0, 60.0, 75.0], value_parser = within(0.0..90.0, "degrees from 0 to below 90"))]
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

/// A material, or a test function of the parametrization study.
enum Plotted {
    Material(Box<MaterialFile>),
    Function(TestFunction),
}

impl Plotted {
    fn brdf(&self) -> &dyn Brdf {
        match self {
            Self::Material(file) => file.brdf(),
            Self::Function(function) => function,
        }
    }

    fn name(&self) -> String {
        match self {
            Self::Material(file) => file.short_name(),
            Self::Function(function) => function.name().to_owned(),
        }
    }

    fn material(&self) -> anyhow::Result<&MaterialFile> {
        match self {
            Self::Material(file) => Ok(file),
            Self::Function(function) => {
                bail!("function:{}: expected a material for this kind of plot", function.name())
            }
        }
    }
}

const FUNCTION: &str = "function:";

impl PlotArgs {
    pub(super) fn run(self, _out: &mut impl Write) -> anyhow::Result<()> {
        let extension = self.output.extension().map(|e| e.to_string_lossy().to_lowercase());
        let as_png = match extension.as_deref() {
            Some("svg") => false,
            Some("png") => true,
            _ => bail!("{}: unknown extension; expected .svg or .png", self.output.display()),
        };
        if as_png && !Plot::HAS_PNG {
            bail!(
                "{}: this build draws plots as SVG alone; expected .svg, or a build with --features png-plots",
                self.output.display()
            );
        }
        let watch = Watch::start();
        watch.step("plotting");
        let plot = self.plot(&watch)?;
        let bytes = if as_png { plot.png()? } else { plot.svg().as_bytes().to_vec() };
        drop(watch);
        write_atomically(&self.output, &bytes, self.force.overwrite())?;
        writeln!(std::io::stderr(), "{}", self.output.display())?;
        Ok(())
    }

    fn plot(&self, watch: &Watch) -> anyhow::Result<Plot> {
        if self.kind == Kind::Parametrizations && self.models == ["function:all"] {
            return Ok(plot_test_functions()?);
        }
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
                None => Ok(Plotted::Material(Box::new(self.read.open(argument)?))),
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
            Kind::Spectrum => spectrum(only()?.material()?, watch),
            Kind::Coverage => {
                let file = only()?.material()?;
                let name = file.short_name();
                if let Content::Measured(Measured::Merl(table)) = &file.content {
                    // Interpolation would close the holes.
                    let cells = table.clone().with_lookup(MerlLookup::Nearest);
                    return Ok(plot_coverage(&name, &cells, None)?);
                }
                Ok(plot_coverage(&name, file.brdf(), file.samples())?)
            }
            Kind::RankError => {
                let files: Vec<&MaterialFile> =
                    models.iter().map(Plotted::material).collect::<anyhow::Result<_>>()?;
                let errors = watch.run(|job| {
                    let jobs = job.split_into(&vec![1.0; files.len()]);
                    let named = |(file, job): (&&MaterialFile, _)| {
                        Ok((file.short_name(), rank_errors(file.brdf(), &job)?))
                    };
                    files.iter().zip(jobs).map(named).collect::<anyhow::Result<Vec<_>>>()
                })?;
                Ok(rank_error_plot(&errors)?)
            }
        }
    }
}

/// The textures of a fitted model.
fn factors(file: &MaterialFile) -> anyhow::Result<Plot> {
    match &file.content {
        Content::Factored(file) => Ok(factored_textures_plot(&file.model)?),
        Content::Separable(file) => Ok(separable_textures_plot(&file.model)?),
        _ => bail!("{}: not a fitted model; expected one of `brdf factor`", file.source),
    }
}

/// Texels along each side of the matrix whose spectrum is made for a material.
const SPECTRUM_RESOLUTION: usize = 32;

/// The spectrum that a model's file holds, or that of a material's light × view matrix.
fn spectrum(file: &MaterialFile, watch: &Watch) -> anyhow::Result<Plot> {
    let name = file.short_name();
    if let Content::Separable(file) = &file.content {
        return Ok(spectrum_plot(&name, &file.record.spectra)?);
    }
    let spectra =
        watch.run(|job| light_view_spectrum(&file.material(), SPECTRUM_RESOLUTION, job))?;
    Ok(spectrum_plot(&format!("{name}, wi × wo, 32²"), &spectra)?)
}
