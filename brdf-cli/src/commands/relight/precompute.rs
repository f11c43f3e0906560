//! `brdf relight precompute`.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use brdf_container::{MaterialFile, PieceError, PieceLog, write_relight};
use brdf_files::{check_overwrite, write_atomically};
use brdf_io::ReadOptions;
use brdf_relight::{
    Codec, LightMaps, MapParams, ObjectParams, ObjectPrecomputation, PrecomputeParams,
    PrecomputeReport, PrecomputeRun, Quality, RelightRecord,
};
use brdf_report::bytes as shown_bytes;
use clap::ValueEnum;

use crate::args::{file_name, not_negative, usage, within};
use crate::meshes::open_mesh;
use crate::outputs::{ForceArgs, show};
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
    #[arg(long, value_name = "SHARE", value_parser = within(1e-9..=0.1, "a share from 1e-9 to .1, such as 1e-5"))]
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

impl Precompute {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let start = Instant::now();
        check_overwrite(&self.output, self.force.overwrite())?;
        let mesh = open_mesh(&self.mesh, None)?;
        let material = MaterialFile::open(&self.brdf, &ReadOptions::default())?;
        let (maps, precompute) = (self.map_params(), self.params()?);
        let params = ObjectParams { maps, precompute, has_ground: self.ground };
        let watch = Watch::start();
        let (work, log) = watch.run(|job| -> anyhow::Result<_> {
            let [factoring, looking] = job.split([0.1, 1.0]);
            let mut work = ObjectPrecomputation::new(&mesh, material.brdf(), params, &factoring)?;
            let mut log = PieceLog::open(&self.output, self.resume, &mut work)?;
            if let Some(note) = log.note(self.resume) {
                let advice = if self.resume { "" } else { " without --resume" };
                watch.aside(|| writeln!(std::io::stderr(), "{note}{advice}"))?;
            }
            work.run(&looking, &mut |piece, chunk| Ok::<_, PieceError>(log.append(piece, chunk)?))?;
            Ok((work, log))
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
        drop(watch);
        let output = self.output.to_string_lossy();
        let seconds = start.elapsed().as_secs_f64();
        let run = PrecomputeRun { resumed: log.resumed(), bytes: bytes.len(), seconds };
        let report = PrecomputeReport::new(&output, &parts, record, run);
        log.remove()?;
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
}
