//! `brdf relight precompute`.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Context as _;
use brdf_container::{MaterialFile, read_piece, write_piece, write_relight};
use brdf_files::{ChunkLog, check_overwrite, write_atomically};
use brdf_io::ReadOptions;
use brdf_relight::{
    Codec, LightMaps, MapParams, ObjectParams, ObjectPrecomputation, PrecomputeParams,
    PrecomputeReport, Quality, RelightRecord,
};
use brdf_report::bytes as shown_bytes;
use clap::ValueEnum;

use crate::args::{ForceArgs, not_negative, show, usage};
use crate::meshes::open_mesh;
use crate::progress::Watch;

/// Find how an object answers light from everywhere
///
/// For each vertex and term of the factored BRDF: what of the sky reaches it, in wavelets; either their largest for
/// each vertex, or those of components that clusters of vertices share. An interrupted run leaves NAME.part beside the
/// output, from which --resume goes on.
///
/// Example: brdf relight precompute bunny.ply --brdf preset:plastic --ground -o bunny.prt
#[derive(clap::Args)]
pub(in crate::commands) struct Precompute {
    /// Object, PLY or OBJ, y up; or shape:torus
    mesh: PathBuf,

    /// Material: a measured file, a model, or preset:NAME
    #[arg(long, value_name = "MODEL", default_value = "preset:plastic")]
    brdf: String,

    /// File to write
    #[arg(short, long, value_name = "FILE", default_value = "object.prt")]
    output: PathBuf,

    /// Terms of the factored BRDF
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u64).range(1..=64))]
    rank: u64,

    /// What light maps hold [default: rgb up to 4 terms, joint beyond]
    #[arg(long, value_enum)]
    light_maps: Option<LightMapsArg>,

    /// How it is stored
    #[arg(long, value_enum, default_value_t = CodecArg::Clusters)]
    codec: CodecArg,

    /// Clusters: share of an open vertex's energy below which numbers are dropped [default: 1e-5]
    #[arg(long, value_name = "SHARE", value_parser = tolerance)]
    tolerance: Option<f64>,

    /// Wavelet: most coefficients of each vertex and term [default: 96]
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=24_576))]
    coefficients: Option<u64>,

    /// Power of the cosine in the weights of the factorization; .5 helps materials that are bright at grazing
    /// directions, from 8 terms on
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = not_negative)]
    weight_power: f64,

    /// Texels along a side of light and view maps
    #[arg(long, default_value_t = 48, value_parser = clap::value_parser!(u64).range(4..=128))]
    map_resolution: u64,

    /// Rays through each of the sky's 24,576 texels: 1, 16, or 16 where neighbours differ
    #[arg(long, value_enum, default_value_t = QualityArg::Adaptive)]
    quality: QualityArg,

    /// Stand the object on diffuse ground that takes its shadow
    #[arg(long)]
    ground: bool,

    /// Go on with an interrupted run
    #[arg(long)]
    resume: bool,

    /// Print what was made as JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    force: ForceArgs,
}

choices! {
    enum LightMapsArg for LightMaps {
        /// Red, green and blue, by eigenpairs (the paper's)
        Rgb => Rgb,
        /// One number, by singular vectors of all channels; only view maps have colour
        Joint => Joint,
    }
}

choices! {
    enum QualityArg for Quality {
        /// One ray a texel
        #[value(name = "1")]
        One => One,
        /// Sixteen where neighbours differ
        Adaptive => Adaptive,
        /// Sixteen rays a texel
        #[value(name = "16")]
        Sixteen => Sixteen,
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum CodecArg {
    /// The largest coefficients of each vertex (the paper's)
    Wavelet,
    /// Principal components of clusters of vertices: smaller and closer
    Clusters,
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(share) if (1e-9..=0.1).contains(&share) => Ok(share),
        _ => Err("expected a share from 1e-9 to .1, such as 1e-5".to_owned()),
    }
}

impl Precompute {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let start = Instant::now();
        check_overwrite(&self.output, self.force.overwrite())?;
        let mesh = open_mesh(&self.mesh, None)?;
        let material = MaterialFile::open(&self.brdf, &ReadOptions::default())?;
        let (maps, precompute) = (self.map_params(), self.params()?);
        let params = ObjectParams { maps, precompute, has_ground: self.ground };
        let watch = Watch::start();
        let (work, log, resumed) = watch.run(|job| -> anyhow::Result<_> {
            let [factoring, looking] = job.split([0.1, 1.0]);
            let mut work = ObjectPrecomputation::new(&mesh, material.brdf(), params, &factoring)?;
            let (mut log, resumed) = watch.aside(|| self.log(&beside(&self.output), &mut work))?;
            work.run(&looking, &mut |piece, chunk| -> anyhow::Result<()> {
                Ok(log.append(&write_piece(piece, chunk))?)
            })?;
            Ok((work, log, resumed))
        })?;
        watch.step("ordering");
        let parts = work.finish()?;
        let record = RelightRecord {
            mesh: file_name(&self.mesh),
            brdf: material.short_name(),
            maps,
            precompute,
        };
        let bytes = write_relight(&parts, &record)?;
        write_atomically(&self.output, &bytes, self.force.overwrite())?;
        log.remove()?;
        drop(watch);
        let output = self.output.to_string_lossy();
        let seconds = start.elapsed().as_secs_f64();
        let report = PrecomputeReport::new(&output, &parts, resumed, bytes.len(), seconds, record);
        show(out, self.json, &report, || {
            let (size, vertices) = (shown_bytes(report.bytes), report.vertices);
            format!(
                "{output}: {size}, {vertices} vertices, {} terms, {seconds:.1} s\n",
                report.terms
            )
        })
    }

    #[expect(clippy::cast_possible_truncation, reason = "in range")]
    fn map_params(&self) -> MapParams {
        let light_maps = match self.light_maps {
            Some(choice) => choice.into(),
            None if self.rank <= 4 => LightMaps::Rgb,
            None => LightMaps::Joint,
        };
        MapParams {
            rank: self.rank as usize,
            light_maps,
            resolution: self.map_resolution as usize,
            weight_power: self.weight_power,
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "in range")]
    fn params(&self) -> anyhow::Result<PrecomputeParams> {
        let codec = match self.codec {
            CodecArg::Wavelet if self.tolerance.is_some() => {
                return Err(usage(
                    "--tolerance is of --codec clusters; --coefficients is what wavelet has",
                ));
            }
            CodecArg::Clusters if self.coefficients.is_some() => {
                return Err(usage(
                    "--coefficients is of --codec wavelet; --tolerance is what clusters have",
                ));
            }
            CodecArg::Wavelet => {
                Codec::Wavelet { coefficients: self.coefficients.unwrap_or(96) as usize }
            }
            CodecArg::Clusters => Codec::Clusters { tolerance: self.tolerance.unwrap_or(1e-5) },
        };
        Ok(PrecomputeParams { codec, quality: self.quality.into() })
    }

    /// The log of a run, with what an interrupted one left in it; the number of vertices that are done.
    fn log(
        &self,
        path: &Path,
        work: &mut ObjectPrecomputation,
    ) -> anyhow::Result<(ChunkLog, usize)> {
        let shown = path.display();
        let key = &work.key();
        let was_interrupted = path.exists();
        if !self.resume {
            if was_interrupted {
                writeln!(
                    std::io::stderr(),
                    "{shown}: left by an interrupted run; begun anew without --resume"
                )?;
            }
            return Ok((ChunkLog::create(path, key)?, 0));
        }
        let (log, chunks) = ChunkLog::resume(path, key)?;
        if chunks.is_empty() {
            let found = if was_interrupted { "of other work" } else { "not there" };
            writeln!(std::io::stderr(), "{shown}: {found}; begun anew")?;
        }
        let mut resumed = 0;
        for bytes in &chunks {
            let (piece, chunk) = read_piece(bytes).with_context(|| shown.to_string())?;
            resumed += work.take(piece, chunk).with_context(|| shown.to_string())?;
        }
        Ok((log, resumed))
    }
}

/// Where the chunks of a run are kept until its end.
fn beside(output: &Path) -> PathBuf {
    let mut name = output.as_os_str().to_owned();
    name.push(".part");
    name.into()
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .map_or_else(|| path.display().to_string(), |n| n.to_string_lossy().into_owned())
}
