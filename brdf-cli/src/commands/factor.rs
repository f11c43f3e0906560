//! `brdf factor`.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use brdf_factor::{FactorParams, FactorSpec, TermSolve};
use brdf_io::{
    FitRecord, FitSettings, IoError, MappedFile, ModelFile, OutputFolder, ProjectionFile,
    TermRecord, model_to_bytes, read_projections,
};
use brdf_model::{Channels, SampleSet};
use brdf_param::Space;

use crate::args::{PairArgs, ReadArgs, not_negative, usage};
use crate::choices::{BoundArg, LogMapArg, MethodArg, SpaceArg, Switch, WeightArg};
use crate::fitting::{self, Albedo, Method, Outcome};
use crate::numbers::{bytes, or_dash, percent, significant};
use crate::pictures::Pictures;
use crate::progress::Progress;
use crate::report::{Report, html};
use crate::subject::Subject;

/// Factor a BRDF into small textures, say how good they are, and show it
///
/// Fits log f(wi, wo) = Σ log p_j(π_j(wi, wo)) by least squares and writes one folder:
/// model.safetensors, each texture as EXR (log values, exact) and PNG (to look at), spheres.png
/// (reference, approximation, difference ×4), report.html and report.json.
///
/// Examples:
///   brdf factor                                    the built-in blue paint, into ./brdf-out
///   brdf factor garnet_red.brdf -o garnet          a measured file
///   brdf factor preset:ggx --method projections --projections planes.toml --space half-difference
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(super) struct Factor {
    /// Material to factor
    #[arg(default_value = "preset:lafortune-blue-paint")]
    input: String,

    /// Which coordinates the textures have
    #[arg(long, value_enum, default_value_t = MethodArg::Mccool)]
    method: MethodArg,

    /// For --method projections: JSON or TOML with `projections`, one pair of rows for each texture.
    /// A row's four numbers multiply the parabolic coordinates of wi and wo (or of h and d); for
    /// textures of wi + wo and of wi:
    /// `projections = [[[1,0,1,0],[0,1,0,1]], [[1,0,0,0],[0,1,0,0]]]`
    #[arg(long, value_name = "FILE")]
    projections: Option<PathBuf>,

    /// Space that projections act on [default: standard]
    #[arg(long, value_enum)]
    space: Option<SpaceArg>,

    /// Texels along each side of a texture
    #[arg(long, value_name = "TEXELS", default_value_t = 32, value_parser = clap::value_parser!(u32).range(2..=1024))]
    texture_size: u32,

    /// Direction pairs to draw and fit; scattered measurements give their own rows
    #[arg(long, default_value_t = 45_000, value_parser = clap::value_parser!(u32).range(1..))]
    samples: u32,

    /// Smoothing μ: weight of each texel's Laplacian, relative to the samples
    #[arg(long, value_name = "MU", default_value_t = 1e-4, value_parser = not_negative, allow_hyphen_values = true)]
    smoothing: f64,

    /// What is fitted into the square of a texture
    #[arg(long, value_enum, default_value_t = BoundArg::Disc)]
    bound: BoundArg,

    /// Which logarithm is fitted
    #[arg(long, value_enum, default_value_t = LogMapArg::Offset)]
    log_map: LogMapArg,

    /// How a sample's squared log error is weighted
    #[arg(long, value_enum, default_value_t = WeightArg::Log)]
    weight: WeightArg,

    /// Whether light and viewer share textures, so that exchanging them changes nothing
    #[arg(long, value_enum, default_value_t = Switch::On)]
    reciprocal: Switch,

    /// Copies of each sample, turned about the normal in equal steps: what isotropic materials are
    /// known to do [default: 32 for scattered rows lit from one azimuth, else 1; 1 for --method
    /// radial]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=360))]
    replicate: Option<u32>,

    #[command(flatten)]
    pairs: PairArgs,

    /// Which scramble of the sample sequence
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Folder to write; one that brdf wrote is replaced
    #[arg(short, long, value_name = "FOLDER", default_value = "brdf-out")]
    output: PathBuf,

    /// Write into a folder that holds other files
    #[arg(long)]
    force: bool,

    /// Print report.json on standard output
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    read: ReadArgs,
}

/// Fewer directions of light than this leave most of the light's texture to smoothing.
const FEW_INCIDENCES: usize = 8;
/// Rows near less than this share of the domain leave most of the fit to smoothing.
const SPARSE: f64 = 0.5;

impl Factor {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let (method, space) = self.method()?;
        let subject = Subject::open(&self.input, &self.read.options())?;
        // Opened first, so that an output that cannot be written is known before the work.
        let mut folder = OutputFolder::new(&self.output, self.force)?;
        let channels = self.pairs.channels(subject.channels());
        let settings = self.settings(&subject);
        let progress = Progress::new(12);
        let outcome = fitting::run(&subject, channels, &method, &settings, &progress)
            .with_context(|| self.input.clone())?;
        let report = self.report(&subject, &outcome, settings, space, channels);

        progress.step("rendering");
        let pictures = Pictures::new(&subject, &outcome, channels)?;
        progress.done(3);
        progress.step("writing");
        let json = serde_json::to_string_pretty(&report)?;
        folder.write("model.safetensors", &model_to_bytes(&model_file(&report, &outcome))?)?;
        pictures.write(&mut folder)?;
        folder.write("report.html", html::page(&report, &outcome, &pictures).as_bytes())?;
        folder.write("report.json", json.as_bytes())?;
        let place = folder.finish()?;
        drop(progress);

        if self.json {
            writeln!(out, "{json}")?;
        } else {
            summarise(out, &report, &place)?;
        }
        Ok(ExitCode::SUCCESS)
    }

    /// The factors to fit, and the space they are in.
    fn method(&self) -> anyhow::Result<(Method, Space)> {
        let reciprocal = self.reciprocal == Switch::On;
        if self.method != MethodArg::Projections {
            if self.space.is_some_and(|space| space != SpaceArg::Standard) {
                return Err(usage(format!(
                    "--method {} has coordinates of its own: --space half-difference does not \
                     apply to it",
                    self.method.name()
                )));
            }
            if self.projections.is_some() {
                return Err(usage("--projections is for --method projections"));
            }
        }
        Ok(match self.method {
            MethodArg::Mccool => {
                (Method::Together(FactorSpec::mccool(reciprocal)), Space::Standard)
            }
            MethodArg::Radial => {
                (Method::Together(FactorSpec::radial(reciprocal)), Space::Standard)
            }
            MethodArg::Projections => {
                let Some(path) = &self.projections else {
                    return Err(usage("--method projections needs --projections FILE"));
                };
                let bytes = MappedFile::open(path)?;
                let text = String::from_utf8_lossy(&bytes);
                let ProjectionFile { space, projections } =
                    read_projections(&text).map_err(IoError::format(path))?;
                let asked = self.space.map(Space::from);
                if let (Some(asked), Some(found)) = (asked, space)
                    && asked != found
                {
                    return Err(usage(format!(
                        "--space {} contradicts {}, whose projections are in {} space",
                        asked.name(),
                        path.display(),
                        found.name()
                    )));
                }
                let space = asked.or(space).unwrap_or(Space::Standard);
                let specs = FactorSpec::projections(space, &projections, reciprocal);
                (Method::Terms(specs), space)
            }
        })
    }

    fn settings(&self, subject: &Subject) -> FitSettings {
        let replicate = match (self.replicate, self.method) {
            (Some(copies), _) => copies,
            (None, MethodArg::Radial) => 1,
            (None, _) if subject.samples().is_some_and(SampleSet::has_one_light_azimuth) => 32,
            (None, _) => 1,
        };
        FitSettings {
            params: FactorParams {
                texture_size: self.texture_size as usize,
                bound: self.bound.into(),
                smoothing: self.smoothing,
                log_map: self.log_map.into(),
                weight: self.weight.into(),
                terms: TermSolve::All,
                theta_max: self.pairs.theta_max(),
                solver: None,
            },
            reciprocal: self.reciprocal == Switch::On,
            samples: self.samples,
            seed: self.seed,
            replicate,
        }
    }

    fn report(
        &self,
        subject: &Subject,
        outcome: &Outcome,
        settings: FitSettings,
        space: Space,
        channels: Channels,
    ) -> Report {
        let mut notes = subject.notes().to_vec();
        let clamped = outcome.last().clamped;
        if clamped > 0 {
            notes.push(format!(
                "{clamped} samples had a negative channel, a colour outside the gamut; it was set \
                 to 0, which log errors count heavily{}",
                if channels == Channels::Rgb { " (--luminance avoids most of it)" } else { "" }
            ));
        }
        if let Some(rows) = subject.samples() {
            notes.extend(scattered_notes(rows, outcome, &settings));
        } else if settings.replicate > 1 {
            notes.push(format!("each pair was fitted {} times, turned", settings.replicate));
        }
        notes.extend(fit_notes(outcome));
        Report::new(subject, outcome, settings, self.method.name(), space, channels, notes)
    }
}

/// What is wrong with a fit that its errors alone do not show.
fn fit_notes(outcome: &Outcome) -> Vec<String> {
    let mut notes = Vec::new();
    let (rows, unknowns) = (outcome.rows, outcome.last().unknowns);
    if rows < unknowns {
        notes.push(format!(
            "{rows} rows for {unknowns} texels: between the rows textures are only smoothed; \
             --texture-size 16 --smoothing 1e-2 gives a calmer picture"
        ));
    }
    if outcome.terms.iter().any(|term| term.held_out.is_none()) {
        notes.push(
            "too few rows to hold any out: nothing is known about unseen directions".to_owned(),
        );
    }
    let Albedo { reference, model } = outcome.albedo;
    if model > 1.0 {
        notes.push(format!(
            "the model reflects up to {} times the light that arrives{}; more smoothing or \
             --weight f may mend it",
            significant(model),
            reference.map_or_else(String::new, |r| format!(" (the reference {})", significant(r)))
        ));
    } else if let Some(reference) = reference
        && !(0.8..=1.25).contains(&(model / reference))
    {
        notes.push(format!(
            "the model's largest albedo is {}, the reference's {}: its highlights are off; --weight f \
             favours them",
            significant(model),
            significant(reference)
        ));
    }
    notes
}

/// What scattered rows were turned into, and what they cannot tell.
fn scattered_notes(rows: &SampleSet, outcome: &Outcome, settings: &FitSettings) -> Vec<String> {
    let mut notes = vec![if settings.replicate > 1 {
        format!(
            "the material was taken to be isotropic: every row was fitted {} times, turned about \
             the normal",
            settings.replicate
        )
    } else if rows.has_one_light_azimuth() {
        "rows were fitted as measured, without turned copies".to_owned()
    } else {
        "light comes from several azimuths, so the material was not taken to be isotropic: rows were \
         fitted as measured (--replicate 32 adds turned copies)"
            .to_owned()
    }];
    if settings.reciprocal {
        notes.push(
            "light and viewer share textures, so every row stands for its reciprocal too"
                .to_owned(),
        );
    }
    if outcome.terms.iter().all(|term| term.held_out.is_some()) {
        notes.push(
            "held-out errors are 10-fold: rows are split before they are copied, twins together"
                .to_owned(),
        );
    }
    let incidences = brdf_model::summarize(rows).incidences;
    if incidences < FEW_INCIDENCES {
        notes.push(format!(
            "the data has only {incidences} directions of light: between them the fit is smoothing, \
             not measurement"
        ));
    }
    if let Some(share) = outcome.scattered_coverage
        && share < SPARSE
    {
        notes.push(format!(
            "only {} of direction pairs have a row nearby: elsewhere the fit is smoothing, not \
             measurement, and the reference sphere has holes",
            percent(share)
        ));
    }
    notes
}

fn model_file(report: &Report, outcome: &Outcome) -> ModelFile {
    let fit = outcome.last();
    ModelFile {
        model: fit.model.clone(),
        fit: FitRecord {
            method: report.method.to_owned(),
            input: report.name.clone(),
            space: report.space.to_owned(),
            settings: report.settings.clone(),
            terms: outcome.terms.clone(),
            samples_used: report.samples.fitted,
            dropped: report.samples.dropped,
        },
    }
}

fn summarise(
    out: &mut impl Write,
    report: &Report,
    place: &std::path::Path,
) -> std::io::Result<()> {
    writeln!(
        out,
        "{}: {} in {} textures, {}, fitted in {} s",
        report.name,
        report.method,
        report.terms.last().map_or(0, |term| term.textures),
        bytes(report.bytes),
        significant(report.seconds)
    )?;
    let held_out = |term: &TermRecord| or_dash(term.held_out.as_ref().map(|e| e.log.mean_square));
    for term in &report.terms {
        writeln!(
            out,
            "{:>2} textures: mean square log error {}, held out {}",
            term.textures,
            significant(term.training.log.mean_square),
            held_out(term)
        )?;
    }
    if report.method != "mccool" {
        let mccool = &report.baseline.mccool;
        writeln!(
            out,
            "McCool, {} textures: mean square log error {}, held out {}",
            mccool.textures,
            significant(mccool.training.log.mean_square),
            held_out(mccool)
        )?;
    }
    writeln!(
        out,
        "largest albedo {}, reference {}",
        significant(report.albedo.model),
        or_dash(report.albedo.reference)
    )?;
    writeln!(out, "samples: {} used", report.samples.used)?;
    if report.samples.dropped.total() > 0 {
        writeln!(out, "dropped: {}", report.samples.dropped)?;
    }
    for note in &report.notes {
        writeln!(out, "note: {note}")?;
    }
    writeln!(out, "{}", place.join("report.html").display())
}
