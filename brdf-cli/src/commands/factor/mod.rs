//! `brdf factor`.

mod keep;
mod plan;
mod preinvert;
mod separable;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use brdf_factor::{FactorParams, TermSolve};
use brdf_io::{FitRecord, FitSettings, ModelFile, OutputFolder, TermRecord, model_to_bytes};
use brdf_model::{Channels, SampleSet};

use self::keep::KeepArgs;
use self::plan::SearchArgs;
use self::preinvert::PreinvertArgs;
use self::separable::SeparableArgs;
use crate::args::{PairArgs, ReadArgs, not_negative};
use crate::choices::{BoundArg, LogMapArg, MethodArg, ReciprocityArg, SpaceArg, WeightArg};
use crate::fitting::{self, Method, Outcome};
use crate::numbers::{bytes, or_dash, significant};
use crate::pictures::Pictures;
use crate::progress::Progress;
use crate::report::notes::{fit_notes, scattered_notes, search_notes};
use crate::report::{Report, SearchReport, html};
use crate::searching::finish_on_interrupt;
use crate::subject::Subject;

/// Factor a BRDF into small textures, say how good they are, and show it
///
/// Searches for the projections π_j under which log f(wi, wo) = Σ log p_j(π_j(wi, wo)) fits best,
/// solves for the textures p_j by least squares, and writes one folder: model.safetensors with the
/// best model of every number of textures, each texture as EXR (log values, exact) and PNG (to look
/// at), spheres.png (reference, approximation, difference ×4), report.html and report.json. Ctrl-C
/// ends a search with the best found so far.
///
/// Examples:
///   brdf factor                                    the built-in blue paint, into ./brdf-out
///   brdf factor garnet_red.brdf -o garnet          a measured file
///   brdf factor silk.binary --terms 3 --space half-difference --texture-size 32
///   brdf factor --from garnet/model.safetensors --keep 2 -o small
///   brdf factor preset:ggx --method mccool         two textures over fixed coordinates, at once
///   brdf factor preset:ggx --method projections --projections planes.toml --space half-difference
///   brdf factor preset:plastic --method eigen --rank 16       sums of products, for relighting
///   brdf factor silk.binary --method mccool --preinvert basis.safetensors     keep the inverse
///   brdf factor gold.binary --with basis.safetensors -o gold                  and use it again
///   brdf factor silk.binary --method log-svd --space half-difference --isotropic --rank 8
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(super) struct Factor {
    /// Material to factor
    #[arg(default_value = "preset:lafortune-blue-paint")]
    input: String,

    /// Which coordinates the textures have
    #[arg(long, value_enum, default_value_t = MethodArg::Search)]
    method: MethodArg,

    /// For --method projections: JSON or TOML with `projections`, one pair of rows for each texture.
    /// A row's four numbers multiply the parabolic coordinates of wi and wo (or of h and d); for
    /// textures of wi + wo and of wi:
    /// `projections = [[[1,0,1,0],[0,1,0,1]], [[1,0,0,0],[0,1,0,0]]]`
    #[arg(long, value_name = "FILE")]
    projections: Option<PathBuf>,

    /// Space that projections act on [default: auto for --method search, else standard]
    #[arg(long, value_enum)]
    space: Option<SpaceArg>,

    /// Texels along each side of a texture; projections are searched at 16 and used for all sizes
    /// [default: 24 for --method search, else 32]
    #[arg(long, value_name = "TEXELS", value_parser = clap::value_parser!(u32).range(2..=1024))]
    texture_size: Option<u32>,

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
    #[arg(long, value_enum, default_value_t = ReciprocityArg::On)]
    reciprocal: ReciprocityArg,

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
    search: SearchArgs,

    #[command(flatten)]
    separable: SeparableArgs,

    #[command(flatten)]
    keep: KeepArgs,

    #[command(flatten)]
    preinvert: PreinvertArgs,

    #[command(flatten)]
    read: ReadArgs,
}

impl Factor {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        if let Some(kept) = self.keep.open()? {
            return keep::run(kept, &self.output, self.force, self.json, out);
        }
        if self.method.is_separable() {
            return self.run_separable(out);
        }
        self.check_homomorphic()?;
        let method = match self.preinvert.open()? {
            Some(basis) => Method::With(Box::new(basis)),
            None => self.plan()?,
        };
        let inversion = self.preinvert.inversion(&method)?;
        let subject = Subject::open(&self.input, &self.read.options())?;
        // Opened first, so that an output that cannot be written is known before the work.
        let mut folder = OutputFolder::new(&self.output, self.force)?;
        let channels = self.pairs.channels(subject.channels());
        let settings = self.settings(&subject, &method);
        let progress = Progress::new(12);
        finish_on_interrupt();
        let outcome = fitting::run(&subject, channels, &method, &settings, &progress)
            .with_context(|| self.input.clone())?;
        if let (Some(inversion), Method::Together(specs)) = (inversion, &method) {
            progress.step("inverting");
            let inverted = fitting::preinvert(&subject, channels, specs, &settings, inversion)
                .with_context(|| self.input.clone())?;
            self.preinvert.write(&inverted, self.method.name(), &settings, self.force)?;
        }
        let report = self.report(&subject, &outcome, settings, &method, channels);

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
            summarize(out, &report, &place)?;
        }
        Ok(ExitCode::SUCCESS)
    }

    fn settings(&self, subject: &Subject, method: &Method) -> FitSettings {
        if let Method::With(basis) = method {
            return basis.record.settings.clone();
        }
        let replicate = match (self.replicate, self.method) {
            (Some(copies), _) => copies,
            (None, MethodArg::Radial) => 1,
            (None, _) if subject.samples().is_some_and(SampleSet::has_one_light_azimuth) => 32,
            (None, _) => 1,
        };
        FitSettings {
            params: FactorParams {
                texture_size: self.texture_size() as usize,
                bound: self.bound.into(),
                smoothing: self.smoothing,
                log_map: self.log_map.homomorphic().unwrap_or_default(),
                weight: self.weight.into(),
                terms: match method {
                    Method::Search(plan) => plan.term_solve(),
                    Method::Together(_) | Method::Terms(_) | Method::With(_) => TermSolve::All,
                },
                theta_max: self.pairs.theta_max(),
                solver: None,
            },
            reciprocal: self.reciprocal != ReciprocityArg::Off,
            samples: self.samples,
            seed: self.seed,
            replicate,
            search: match method {
                Method::Search(plan) => Some(plan.settings()),
                Method::Together(_) | Method::Terms(_) | Method::With(_) => None,
            },
        }
    }

    fn texture_size(&self) -> u32 {
        self.texture_size.unwrap_or(if self.method == MethodArg::Search { 24 } else { 32 })
    }

    fn report(
        &self,
        subject: &Subject,
        outcome: &Outcome,
        mut settings: FitSettings,
        method: &Method,
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
        if let Some(found) = &outcome.found {
            settings.reciprocal = found.family.reciprocal;
        }
        if let Some(rows) = subject.samples() {
            notes.extend(scattered_notes(rows, outcome, &settings));
        } else if settings.replicate > 1 {
            notes.push(format!("each pair was fitted {} times, turned", settings.replicate));
        }
        let search = match (method, &outcome.found) {
            (Method::Search(plan), Some(found)) => {
                notes.extend(search_notes(plan, found, subject.samples().is_some()));
                Some(SearchReport::new(plan, found))
            }
            _ => None,
        };
        notes.extend(fit_notes(outcome));
        let name = match method {
            Method::With(_) => "preinverted",
            _ => self.method.name(),
        };
        Report::new(subject, outcome, settings, name, search, channels, notes)
    }
}

fn model_file(report: &Report, outcome: &Outcome) -> ModelFile {
    let fit = outcome.last();
    let smaller = &outcome.fits[..outcome.fits.len() - 1];
    ModelFile {
        model: fit.model.clone(),
        smaller: smaller.iter().map(|fit| fit.model.clone()).collect(),
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

fn summarize(
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
    if let Some(search) = &report.search {
        writeln!(
            out,
            "{} projections, {}, {} evaluations",
            report.space,
            if report.settings.reciprocal { "reciprocal" } else { "not reciprocal" },
            report.evaluations
        )?;
        if let Some(cause) = search.stopped {
            writeln!(out, "stopped early ({cause}): the best found so far")?;
        }
    }
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
