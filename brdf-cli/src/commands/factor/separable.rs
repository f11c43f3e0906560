//! `brdf factor --method svd | log-svd | eigen | nmf | normalized`: sums of products.

use std::f64::consts::FRAC_PI_2;
use std::io::Write;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Context as _;
use brdf_io::{
    OutputFolder, RankRecord, SeparableFile, SeparableRecord, SeparableSettings, separable_to_bytes,
};
use brdf_model::{
    Channels, PairSampling, SampleSet, ScrambledSobol, largest_albedo, log_offsets, measure,
};
use brdf_param::Parametrization;
use brdf_separable::{
    BrdfMatrix, Decomposition, EigenSolver, Fill, HemisphereGrid, Layout, MatrixParams,
    SeparableParams, ValueTransform, factorize_matrix,
};

use super::Factor;
use crate::args::{memory, usage};
use crate::choices::{
    BoundArg, EigenSolverArg, FillArg, LogMapArg, MapArg, MethodArg, ReciprocityArg, WeightArg,
};
use crate::fitting::{Albedo, HELD_OUT_PAIRS};
use crate::numbers::{bytes, or_dash, significant};
use crate::pictures::{Grey, SeparablePictures};
use crate::progress::Progress;
use crate::report::separable::{SeparableReport, separable_notes};
use crate::subject::Subject;

/// How sums of products are made.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Sums of products (--method svd, log-svd, eigen, nmf, normalized)")]
pub(super) struct SeparableArgs {
    /// Number of terms; pairs of equal magnitude are completed beyond it [default: 4; 1 for
    /// normalized]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..=4096))]
    rank: Option<u32>,

    /// How the hemisphere is laid out in the textures [default: orthographic]
    #[arg(long, value_enum)]
    map: Option<MapArg>,

    /// Texels along each side of a texture [default: 48]
    #[arg(long, value_name = "TEXELS", value_parser = clap::value_parser!(u32).range(2..=1024))]
    resolution: Option<u32>,

    /// Decompose all channels together: scalar textures on the first side, RGB on the second
    #[arg(long)]
    joint_rgb: bool,

    /// Take the material to be isotropic: textures over the polar angle alone on the first side
    #[arg(long)]
    isotropic: bool,

    /// What stands in cells without data [default: edge]
    #[arg(long, value_enum)]
    fill: Option<FillArg>,

    /// p of the weights cosᵖθ of both sides; .5 pays for many terms of grazing-heavy materials
    #[arg(long, value_name = "P", value_parser = weight_power, allow_hyphen_values = true)]
    weight_power: Option<f64>,

    /// How eigenpairs are found [default: krylov]
    #[arg(long, value_enum)]
    eigen_solver: Option<EigenSolverArg>,

    /// Most memory for the matrix and the work on it, such as 500M [default: 4G]
    #[arg(long, value_name = "BYTES", value_parser = memory)]
    memory_limit: Option<usize>,
}

fn weight_power(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(power) if (0.0..=8.0).contains(&power) => Ok(power),
        _ => Err("expected a number from 0 to 8".to_owned()),
    }
}

impl SeparableArgs {
    /// The first option that was given, if any.
    pub(super) fn given(&self) -> Option<&'static str> {
        [
            (self.rank.is_some(), "--rank"),
            (self.map.is_some(), "--map"),
            (self.resolution.is_some(), "--resolution"),
            (self.joint_rgb, "--joint-rgb"),
            (self.isotropic, "--isotropic"),
            (self.fill.is_some(), "--fill"),
            (self.weight_power.is_some(), "--weight-power"),
            (self.eigen_solver.is_some(), "--eigen-solver"),
            (self.memory_limit.is_some(), "--memory-limit"),
        ]
        .into_iter()
        .find_map(|(given, name)| given.then_some(name))
    }
}

impl Factor {
    pub(super) fn run_separable(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let layout = self.layout()?;
        self.check_separable()?;
        let subject = Subject::open(&self.input, &self.read.options())?;
        let mut folder = OutputFolder::new(&self.output, self.force)?;
        let channels = self.pairs.channels(subject.channels());
        let progress = Progress::new(12);
        let (file, report) = self
            .fit_separable(&subject, &layout, channels, &progress)
            .with_context(|| self.input.clone())?;

        progress.step("rendering");
        let pictures = SeparablePictures::new(&subject, &file, channels)?;
        progress.done(3);
        progress.step("writing");
        let json = serde_json::to_string_pretty(&report)?;
        folder.write("model.safetensors", &separable_to_bytes(&file)?)?;
        pictures.write(&mut folder)?;
        folder.write("report.html", report.page(&pictures).as_bytes())?;
        folder.write("report.json", json.as_bytes())?;
        let place = folder.finish()?;
        drop(progress);

        if self.json {
            writeln!(out, "{json}")?;
        } else {
            summarize(out, &file, &report)?;
            writeln!(out, "{}", place.join("report.html").display())?;
        }
        Ok(ExitCode::SUCCESS)
    }

    fn layout(&self) -> anyhow::Result<Layout> {
        let args = &self.separable;
        let map = args.map.unwrap_or(MapArg::Orthographic);
        let default = if map == MapArg::Merl {
            Parametrization::HalfDifference
        } else {
            Parametrization::Standard
        };
        let parametrization = match self.space {
            None => default,
            Some(space) => space.parametrization().ok_or_else(|| {
                usage(format!("--space auto is for --method search, not {}", self.method.name()))
            })?,
        };
        let Some(hemisphere) = map.hemisphere() else {
            if parametrization != Parametrization::HalfDifference || args.resolution.is_some() {
                return Err(usage(
                    "--map merl is a grid of its own: it takes --space half-difference and no \
                     --resolution",
                ));
            }
            let nodes = self.read.nodes();
            return Ok(Layout::new(
                parametrization,
                HemisphereGrid::MerlThetaH { nodes },
                HemisphereGrid::MerlThetaDPhiD { nodes },
            ));
        };
        let resolution = args.resolution.unwrap_or(48) as usize;
        let plane = HemisphereGrid::Plane { map: hemisphere, resolution };
        let first = if args.isotropic {
            HemisphereGrid::Radius { map: hemisphere, resolution }
        } else {
            plane
        };
        Ok(Layout::new(parametrization, first, plane))
    }

    /// Refuses what sums of products do not have.
    fn check_separable(&self) -> anyhow::Result<()> {
        let name = self.method.name();
        let given = [
            (self.texture_size.is_some(), "--texture-size (--resolution is the one)"),
            (self.projections.is_some(), "--projections"),
            (self.samples != 45_000, "--samples"),
            (self.smoothing.to_bits() != 1e-4_f64.to_bits(), "--smoothing"),
            (self.bound != BoundArg::Disc, "--bound"),
            (self.weight != WeightArg::Log, "--weight"),
            (self.reciprocal != ReciprocityArg::On, "--reciprocal"),
            (self.replicate.is_some(), "--replicate"),
        ];
        if let Some((_, option)) = given.into_iter().find(|(given, _)| *given) {
            return Err(usage(format!("{option} does not apply to --method {name}")));
        }
        if let Some(option) = self.search.given() {
            return Err(usage(format!("{option} is for --method search, not {name}")));
        }
        let takes_log = self.method == MethodArg::LogSvd;
        match self.log_map {
            LogMapArg::Offset => {}
            LogMapArg::Cosine if takes_log => {}
            _ if takes_log => {
                return Err(usage("--method log-svd takes --log-map offset or cosine"));
            }
            _ => return Err(usage(format!("--log-map does not apply to --method {name}"))),
        }
        let args = &self.separable;
        if self.method == MethodArg::Eigen && (args.joint_rgb || !self.layout()?.is_symmetric()) {
            return Err(usage(
                "--method eigen needs one symmetric matrix a channel: --space standard, no --isotropic, \
                 no --joint-rgb",
            ));
        }
        if self.method == MethodArg::Normalized && args.rank.is_some_and(|rank| rank != 1) {
            return Err(usage("--method normalized has one term: no --rank above 1"));
        }
        if self.separable.eigen_solver.is_some() && self.method != MethodArg::Eigen {
            return Err(usage(format!("--eigen-solver is for --method eigen, not {name}")));
        }
        Ok(())
    }

    fn decomposition(&self) -> Decomposition {
        match self.method {
            MethodArg::Eigen => Decomposition::Eigen(match self.separable.eigen_solver {
                Some(EigenSolverArg::Power) => EigenSolver::Power,
                _ => EigenSolver::Krylov,
            }),
            MethodArg::Nmf => Decomposition::Nmf,
            MethodArg::Normalized => Decomposition::Normalized,
            _ => Decomposition::Svd,
        }
    }

    fn fit_separable(
        &self,
        subject: &Subject,
        layout: &Layout,
        channels: Channels,
        progress: &Progress,
    ) -> anyhow::Result<(SeparableFile, SeparableReport)> {
        let args = &self.separable;
        let reference = Grey::unless(channels == Channels::Rgb, subject.brdf());
        let reference = reference.as_brdf();
        progress.step("drawing held-out pairs");
        let held_out_theta_max = self.pairs.theta_max().min(80_f64.to_radians());
        let unseen = subject.samples().is_none().then(|| {
            let sampling = PairSampling {
                count: HELD_OUT_PAIRS,
                seed: ScrambledSobol::held_out_seed(self.seed),
                theta_max: held_out_theta_max,
            };
            SampleSet::draw(reference, &sampling, channels)
        });
        progress.done(1);

        progress.step("filling the matrix");
        let decomposition = self.decomposition();
        let params = SeparableParams {
            decomposition,
            rank: match (args.rank, decomposition) {
                (Some(rank), _) => rank as usize,
                (None, Decomposition::Normalized) => 1,
                (None, _) => smaller_side(layout).min(4),
            },
            joint_rgb: args.joint_rgb,
            ..SeparableParams::default()
        };
        let sampling = MatrixParams {
            channels,
            theta_max: self.pairs.given_theta_max().unwrap_or(FRAC_PI_2),
            fill: match args.fill {
                Some(FillArg::Zero) => Fill::Zero,
                _ => Fill::Edge,
            },
            maps: self.value_maps(unseen.as_ref().or(subject.samples()), channels),
            weight_power: args.weight_power.unwrap_or(0.0),
            memory_limit: args.memory_limit.unwrap_or(4 << 30),
        };
        let start = Instant::now();
        let mut matrix = BrdfMatrix::sample(reference, layout, &sampling)?;
        let filled_in = start.elapsed().as_secs_f64();
        progress.done(2);
        progress.step("decomposing");
        let mut asymmetry = None;
        if matches!(decomposition, Decomposition::Eigen(_)) {
            asymmetry = matrix.asymmetry();
            matrix = matrix.symmetrized()?;
        }
        let fit = factorize_matrix(&matrix, &params)?;
        let seconds = start.elapsed().as_secs_f64();
        progress.done(3);

        progress.step("measuring");
        let terms: anyhow::Result<Vec<RankRecord>> = fit
            .errors
            .iter()
            .map(|errors| {
                let held_out = match &unseen {
                    Some(unseen) if !unseen.is_empty() => {
                        let model = fit.model.truncated(errors.rank)?;
                        Some(measure(unseen, &model, &log_offsets(unseen)))
                    }
                    _ => None,
                };
                Ok(RankRecord { matrix: *errors, held_out })
            })
            .collect();
        let file = SeparableFile {
            fit: SeparableRecord {
                method: self.method.name().to_owned(),
                input: subject.short_name(),
                settings: SeparableSettings {
                    decomposition,
                    rank: params.rank,
                    joint_rgb: params.joint_rgb,
                    theta_max: sampling.theta_max,
                    fill: sampling.fill,
                    weight_power: sampling.weight_power,
                    held_out_theta_max,
                    seed: self.seed,
                },
                cells: matrix.counts(),
                asymmetry,
                spectra: fit.spectra,
                terms: terms?,
            },
            model: fit.model,
        };
        let theta_max = held_out_theta_max;
        let albedo = Albedo {
            reference: subject.samples().is_none().then(|| largest_albedo(reference, theta_max).0),
            model: largest_albedo(&file.model, theta_max).0,
        };
        progress.done(3);
        let notes = separable_notes(subject, &file, albedo);
        let report = SeparableReport::new(
            subject,
            &file,
            [matrix.rows().len(), matrix.columns().len()],
            args.map.unwrap_or(MapArg::Orthographic).name(),
            albedo,
            [filled_in, seconds],
            notes,
        );
        Ok((file, report))
    }

    /// What of each channel is factored; offsets of logarithms from the mean of what was drawn.
    fn value_maps(&self, samples: Option<&SampleSet>, channels: Channels) -> [ValueTransform; 3] {
        if self.method != MethodArg::LogSvd {
            return [ValueTransform::Linear; 3];
        }
        if self.log_map == LogMapArg::Cosine {
            return [ValueTransform::Cosine; 3];
        }
        let offsets = samples.map_or_else(Vec::new, log_offsets);
        let offset = |channel: usize| {
            let channel = if channels == Channels::Luminance { 0 } else { channel };
            offsets.get(channel).copied().unwrap_or(1e-5)
        };
        std::array::from_fn(|channel| ValueTransform::Offset { a: offset(channel) })
    }
}

fn smaller_side(layout: &Layout) -> usize {
    layout.first.nodes().len().min(layout.second.nodes().len())
}

fn summarize(
    out: &mut impl Write,
    file: &SeparableFile,
    report: &SeparableReport,
) -> std::io::Result<()> {
    let fit = &file.fit;
    writeln!(
        out,
        "{}: {} of {} terms, {}, {} × {} matrix, {} s",
        fit.input,
        fit.method,
        file.model.rank(),
        bytes(report.bytes),
        report.matrix.rows,
        report.matrix.columns,
        significant(report.seconds)
    )?;
    for term in &fit.terms {
        writeln!(
            out,
            "{:>2} terms: relative residual {}, log-cosine RMS {} over the matrix; mean square log \
             error {} held out",
            term.matrix.rank,
            significant(term.matrix.relative_residual),
            significant(term.matrix.log_cosine_rms),
            or_dash(term.held_out.as_ref().map(|e| e.log.mean_square))
        )?;
    }
    for note in &report.notes {
        writeln!(out, "{note}")?;
    }
    Ok(())
}
