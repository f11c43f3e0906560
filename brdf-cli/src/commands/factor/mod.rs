//! `brdf factor`.

mod compact;
mod keep;
mod plan;
mod preinvert;
mod separable;

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::Context as _;
use brdf_container::{write_compact, write_factored, write_separable};
use brdf_fit::{FactoredSettings, Fit, FitSettings, fit, preinvert};
use brdf_report::{
    ResultFile, compact_files, compact_text, factored_files, factored_text, separable_files,
    separable_text,
};

use self::compact::CompactArgs;
use self::keep::KeepArgs;
use self::plan::SearchArgs;
use self::preinvert::PreinvertArgs;
use self::separable::SeparableArgs;
use crate::advice::fit_notes;
use crate::args::{PairArgs, ReadArgs, not_negative, positive, share};
use crate::choices::{
    BoundArg, LogMapArg, MethodArg, ReciprocityArg, SpaceArg, TexelsArg, WeightArg, ZerosArg,
};
use crate::outputs::{FolderArgs, command_line, write_all};
use crate::progress::Watch;

/// Make a small model of a BRDF, say how good it is, and show it
///
/// Without --method an isotropic material becomes the best model of 8 kB (--bytes): splines, GGX lobes, or
/// textures over pairs of angles or McCool's. An anisotropic one is searched for the projections π_j under which
/// log f(wi, wo) = Σ log p_j(π_j(wi, wo)) fits best, with textures p_j by least squares. What is written is one
/// folder: model.safetensors, spheres.png (reference, approximation, difference ×4), report.html and
/// report.json; of textures also each as EXR (log values, exact) and PNG (to look at). Ctrl-C ends a search
/// with the best found so far.
///
/// Examples:
///   brdf factor                                    the built-in blue paint, into ./brdf-out
///   brdf factor silk.binary -o silk                the best model of 8 kB of a measured file
///   brdf factor silk.binary --bytes 2.7k           smaller, or --error .02: as small as is good enough
///   brdf factor garnet_red.brdf --terms 5 -o garnet           a search, by its options
///   brdf factor silk.binary --terms 3 --space half-difference --texture-size 32
///   brdf factor --from garnet/model.safetensors --keep 2 -o small
///   brdf factor preset:ggx --method mccool         two textures over fixed coordinates, at once
///   brdf factor silk.binary --method isotropic     textures over pairs of angles: exactly isotropic, for shaders
///   brdf factor preset:ggx --method projections --projections planes.toml --space half-difference
///   brdf factor preset:plastic --method eigen --rank 16       sums of products, for relighting
///   brdf factor silk.binary --method mccool --preinvert basis.safetensors     keep the inverse
///   brdf factor gold.binary --with basis.safetensors -o gold                  and use it again
///   brdf factor silk.binary --method log-svd --space half-difference --isotropic --rank 8
#[derive(clap::Args)]
#[command(mut_arg("output", |arg| arg.default_value("brdf-out")))]
#[command(verbatim_doc_comment)]
pub(super) struct Factor {
    /// Material to factor
    #[arg(default_value = "preset:lafortune-blue-paint")]
    input: String,

    /// What the model is made of [default: auto, or the method whose options are given]
    #[arg(long, value_enum)]
    method: Option<MethodArg>,

    /// For --method projections: JSON or TOML with `projections`, one pair of rows for each texture.
    /// A row's four numbers multiply the parabolic coordinates of wi and wo (or of h and d); for
    /// textures of wi + wo and of wi:
    /// `projections = [[[1,0,1,0],[0,1,0,1]], [[1,0,0,0],[0,1,0,0]]]`
    #[arg(long, value_name = "FILE")]
    projections: Option<PathBuf>,

    /// For --method coordinates: JSON or TOML with `factors`, each with the `coordinates` that read its texture and, if
    /// it likes, the `grid` of it; docs/model-file.md names them
    #[arg(long, value_name = "FILE")]
    coordinates: Option<PathBuf>,

    /// Space that projections act on [default: auto for --method search, else standard]
    #[arg(long, value_enum)]
    space: Option<SpaceArg>,

    /// Texels along each side of a texture; projections are searched at 16 and used for all sizes
    /// [default: 24 for --method search, else 32]
    #[arg(long, value_name = "TEXELS", value_parser = clap::value_parser!(u32).range(2..=1024))]
    texture_size: Option<u32>,

    /// How texels, which are logarithms, are stored, of all methods that make textures of them. What --bytes says counts as
    /// stored: f16 has twice the texels, u8 four times, up to 8192 in all [default: f32]
    #[arg(long, value_enum)]
    texels: Option<TexelsArg>,

    /// Direction pairs to draw and fit; scattered measurements give their own rows. For --method isotropic 20000 to 90000,
    /// by its size [default: 45000]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    samples: Option<u32>,

    /// Smoothing μ: weight of each texel's Laplacian, relative to the samples
    #[arg(long, value_name = "MU", default_value_t = 1e-4, value_parser = not_negative, allow_hyphen_values = true)]
    smoothing: f64,

    /// What is fitted into the square of a texture
    #[arg(long, value_enum, default_value_t = BoundArg::Disc)]
    bound: BoundArg,

    /// Which logarithm is fitted
    #[arg(long, value_enum, default_value_t = LogMapArg::Offset)]
    log_map: LogMapArg,

    /// a of ln(a + f) over the mean of each channel [default: 1e-3 for --method isotropic, else 1e-5]
    #[arg(long, value_name = "SHARE", value_parser = positive)]
    offset: Option<f64>,

    /// How a sample's squared log error is weighted [default: fidelity for --method isotropic, else log]
    #[arg(long, value_enum)]
    weight: Option<WeightArg>,

    /// Share of the pairs drawn around the mirror direction, 0 to .9 [default: .28 for --method isotropic, else 0]
    #[arg(long, value_name = "SHARE", value_parser = share)]
    highlight: Option<f64>,

    /// Let models be brighter than the largest fitted value
    #[arg(long)]
    no_ceiling: bool,

    /// What values of 0 ask for [default: below for --method isotropic, else exact]
    #[arg(long, value_enum)]
    zeros: Option<ZerosArg>,

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

    #[command(flatten)]
    folder: FolderArgs,

    /// Print report.json on standard output
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    search: SearchArgs,

    #[command(flatten)]
    separable: SeparableArgs,

    #[command(flatten)]
    compact: CompactArgs,

    #[command(flatten)]
    keep: KeepArgs,

    #[command(flatten)]
    preinvert: PreinvertArgs,

    #[command(flatten)]
    read: ReadArgs,
}

impl Factor {
    pub(super) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        if let Some(kept) = self.keep.open()? {
            return keep::run(&kept, &self.folder.output, self.folder.force, self.json, out);
        }
        let settings = match self.method() {
            MethodArg::Auto => FitSettings::Auto(self.auto_settings()?),
            method if method.is_separable() => FitSettings::Separable(self.separable_settings()?),
            method if method.is_compact() => FitSettings::Compact(self.compact_settings()?),
            _ => FitSettings::Factored(self.factored_settings()?),
        };
        let inversion = self.preinvert.inversion(&settings)?;
        let file = self.read.open(&self.input)?;
        // Opened first, so that an output that cannot be written is known before the work.
        let mut folder = self.folder.create()?;
        let material = file.material();
        let watch = Watch::start();
        let deadline = self.search.time_limit().map(|limit| Instant::now() + limit);
        let fitted = watch.run_until(deadline, |job| fit(&material, &settings, job));
        let fitted = fitted.with_context(|| self.input.clone())?;
        if let (Some(inversion), FitSettings::Factored(settings)) = (inversion, &settings) {
            let basis = watch.run(|job| preinvert(&material, settings, inversion, job));
            self.preinvert.write(&basis.with_context(|| self.input.clone())?, self.folder.force)?;
        }

        watch.step("drawing pictures");
        let version = env!("CARGO_PKG_VERSION");
        let notes = fit_notes(&file.notes, fitted.notes());
        let command = command_line();
        let (model, files, said) = match &fitted {
            Fit::Factored(fit) => {
                let report = fit.report(&self.input, version, notes);
                let files = factored_files(&material, fit, &report, &command)?;
                (write_factored(&fit.model())?, files, factored_text(material.name(), &report))
            }
            Fit::Compact(fit) => {
                let report = fit.report(&self.input, version, notes);
                let files = compact_files(&material, fit, &report, &command)?;
                (write_compact(&fit.model)?, files, compact_text(material.name(), &report))
            }
            Fit::Separable(fit) => {
                let report = fit.report(&self.input, version, notes);
                let files = separable_files(&material, fit, &report, &command)?;
                (write_separable(&fit.model)?, files, separable_text(material.name(), &report))
            }
        };
        folder.write("model.safetensors", &model)?;
        write_all(&mut folder, &files)?;
        let place = folder.finish()?;
        drop(watch);
        match files.last() {
            Some(ResultFile { bytes: json, .. }) if self.json => {
                out.write_all(json)?;
                writeln!(out)?;
            }
            _ => writeln!(out, "{said}{}", place.join("report.html").display())?,
        }
        Ok(())
    }

    /// The method that was asked for, or that has the options that were given.
    fn method(&self) -> MethodArg {
        let is_of_textures = self.search.given().or_else(|| self.texture_option_given()).is_some()
            || self.texture_size.is_some()
            || self.space.is_some()
            || self.log_map != LogMapArg::Offset
            || self.preinvert.is_given();
        match self.method {
            Some(method) => method,
            None if self.coordinates.is_some() => MethodArg::Coordinates,
            None if self.compact.angle_option_given().is_some() => MethodArg::Isotropic,
            // No other method has textures of a size in bytes.
            None if self.texels.is_some() && self.compact.bytes.is_some() => MethodArg::Isotropic,
            None if is_of_textures => MethodArg::Search,
            None if self.compact.lobes.is_some() => MethodArg::Ggx,
            None => MethodArg::Auto,
        }
    }

    fn factored_settings(&self) -> anyhow::Result<FactoredSettings> {
        self.check_homomorphic()?;
        let method = match self.preinvert.open()? {
            Some(basis) => brdf_fit::FactoredMethod::Preinverted(Box::new(basis)),
            None => self.plan()?,
        };
        let texels = self.texels.unwrap_or(TexelsArg::F32).into();
        let usual = FactoredSettings::of(method).storing(texels);
        Ok(FactoredSettings {
            texture_size: self.texture_size.map(|size| size as usize),
            bound: self.bound.into(),
            smoothing: self.smoothing,
            log_transform: self.log_map.homomorphic().unwrap_or_default(),
            offset: self.offset.unwrap_or(usual.offset),
            weight: self.weight.map_or(usual.weight, Into::into),
            highlight: self.highlight.unwrap_or(usual.highlight),
            clamp: !self.no_ceiling,
            zeros: self.zeros.map_or(usual.zeros, Into::into),
            reciprocity: self.reciprocal.into(),
            samples: self.samples.unwrap_or(usual.samples),
            seed: self.seed,
            replicate: self.replicate,
            theta_max: self.pairs.theta_max(),
            channels: self.pairs.channels(),
            ..usual
        })
    }
}
