//! `brdf paint extract`.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use brdf_container::{PaintedFile, SceneFolder, write_painted};
use brdf_mesh::UvSource;
use brdf_paint::{
    LearnParams, Mode, PaintLogTransform, PaintParams, PaintRecord, PaintReport, SolverChoice,
    learn,
};
use brdf_report::{PaintedView, ResultFile, paint_files, painted_text};
use clap::ValueEnum;

use crate::advice::paint_notes;
use crate::args::{positive, usage};
use crate::outputs::{FolderArgs, write_all};
use crate::progress::Watch;

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
#[command(mut_arg("output", |arg| arg.default_value("material")))]
pub(in crate::commands) struct Extract {
    /// Scene that `brdf paint setup` wrote, with its paintings
    scene: PathBuf,

    #[command(flatten)]
    folder: FolderArgs,

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

    /// Print report.json on standard output
    #[arg(long)]
    json: bool,
}

choices! {
    enum ModeArg for Mode {
        /// One BRDF everywhere
        Brdf => Brdf,
        /// A BRDF times a factor over the surface
        FourFactor => FourFactor,
        /// BRDFs weighted by maps
        MaterialMap => MaterialMap,
        /// Four-factor products weighted by maps
        Hybrid => Hybrid,
    }
}

choices! {
    enum SolverArg for SolverChoice {
        /// One product after another, as published
        Paper => Paper,
        /// Maps and products in turns
        Alternating => Alternating,
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum LogMapArg {
    /// log(a + f): dark colours as they are
    Offset,
    /// log(a − f), a above the brightest: highlights
    Highlight,
}

impl Extract {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let start = Instant::now();
        let scene = SceneFolder::open(&self.scene)?;
        if self.offset.is_some() && self.log_map != LogMapArg::Offset {
            return Err(usage("--offset is of --log-map offset"));
        }
        let mut folder = self.folder.create()?;
        let found = scene.paintings()?;
        let pictures = scene.infos(&found.painted, &self.hold_out)?;
        let settings = self.params(scene.scene.uv == UvSource::Sphere);
        #[expect(clippy::cast_possible_truncation, reason = "at most 1e8")]
        let params = LearnParams {
            paint: settings,
            least_cosine: self.least_cosine,
            most_pixels: self.pixels as usize,
        };
        let load = |index: usize| -> anyhow::Result<_> { Ok(scene.load(&found.painted[index])?) };
        let watch = Watch::start();
        let mut learned = watch.run(|job| learn(&pictures, &load, &params, job))?;
        let mut notes = paint_notes(&found, &learned.notes);
        if learned.held_out.is_none() {
            watch.step("judging");
            let material = &learned.extraction.material;
            match scene.truth_errors(material, self.least_cosine) {
                Ok(errors) => learned.held_out = errors,
                // What was made is worth keeping without being judged.
                Err(error) => notes.push(format!("no held-out views: {error}")),
            }
        }
        watch.step("drawing pictures");
        let made = &learned.extraction;
        let record = PaintRecord { settings, uv: scene.scene.uv };
        let bytes = write_painted(&PaintedFile { material: made.material.clone(), record })?;
        let [from, to] = [&self.scene, &self.folder.output].map(|path| path.to_string_lossy());
        let report = PaintReport::new(
            env!("CARGO_PKG_VERSION"),
            [&from, &to],
            &learned,
            bytes.len(),
            start.elapsed().as_secs_f64(),
            notes,
        );
        let views = pictures.iter().enumerate().map(|(index, info)| {
            let (buffers, image) = load(index)?;
            let (name, is_held_out) = (info.name.clone(), info.is_held_out);
            Ok::<_, anyhow::Error>(PaintedView { name, is_held_out, buffers, image })
        });
        let files = paint_files(views, made, &report)?;
        folder.write("material.safetensors", &bytes)?;
        write_all(&mut folder, &files)?;
        folder.finish()?;
        drop(watch);
        match files.last() {
            Some(ResultFile { bytes: json, .. }) if self.json => out.write_all(json)?,
            _ => write!(out, "{}", painted_text(&to, bytes.len(), &report))?,
        }
        Ok(())
    }

    fn params(&self, wraps: bool) -> PaintParams {
        PaintParams {
            mode: self.mode.into(),
            solver: self.solver.into(),
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
}
