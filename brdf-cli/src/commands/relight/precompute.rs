//! `brdf relight precompute`.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use brdf_io::{
    ChunkLog, ReadOptions, RelightRecord, check_overwrite, relight_to_bytes, vectors_from_bytes,
    vectors_to_bytes, write_atomically,
};
use brdf_relight::{
    BrdfMaps, LightMaps, MapParams, Occluder, Part, PrecomputeParams, Quality, SparseVectors,
    Surface, factor_for_relighting, precompute,
};
use clap::ValueEnum;
use serde_json::json;
use sha2::{Digest, Sha256};

use crate::args::{ForceArgs, not_negative};
use crate::meshes::open_mesh;
use crate::numbers::bytes as shown_bytes;
use crate::progress::Progress;
use crate::subject::Subject;

/// Find how an object answers light from everywhere
///
/// For each vertex and term of the factored BRDF: what of the sky reaches it, in wavelets, cut to the largest
/// coefficients. An interrupted run leaves NAME.part beside the output, from which --resume goes on.
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

    /// Most wavelet coefficients of each vertex and term
    #[arg(long, default_value_t = 96, value_parser = clap::value_parser!(u64).range(1..=24_576))]
    coefficients: u64,

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

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum LightMapsArg {
    /// Red, green and blue, by eigenpairs (the paper's)
    Rgb,
    /// One number, by singular vectors of all channels; only view maps have colour
    Joint,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum QualityArg {
    /// One ray a texel
    #[value(name = "1")]
    One,
    /// Sixteen where neighbours differ
    Adaptive,
    /// Sixteen rays a texel
    #[value(name = "16")]
    Sixteen,
}

/// What the ground reflects.
const GROUND_ALBEDO: f32 = 0.35;
/// Vertices of a chunk of work.
const CHUNK: usize = 2048;

impl Precompute {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let start = Instant::now();
        check_overwrite(&self.output, self.force.overwrite())?;
        let mesh = open_mesh(&self.mesh, None)?;
        let subject = Subject::open(&self.brdf, &ReadOptions::default())?;
        let (map_params, params) = (self.map_params(), self.params());
        let fit = factor_for_relighting(subject.brdf(), &map_params)?;
        let maps = BrdfMaps::of(&fit.model)?;
        let mut work = vec![(Surface::of(&mesh), maps)];
        if self.ground {
            work.push((Surface::ground(&mesh), BrdfMaps::diffuse(GROUND_ALBEDO)));
        }
        let vertices: usize = work.iter().map(|(surface, _)| surface.positions.len()).sum();
        let log_path = beside(&self.output);
        let was_interrupted = log_path.exists();
        let (mut log, chunks) = if self.resume {
            ChunkLog::resume(&log_path, &key(&work, &params))?
        } else {
            (ChunkLog::create(&log_path, &key(&work, &params))?, Vec::new())
        };
        let shown = log_path.display();
        if self.resume && chunks.is_empty() {
            let found = if was_interrupted { "of other work" } else { "not there" };
            writeln!(std::io::stderr(), "{shown}: {found}; begun anew")?;
        } else if was_interrupted && !self.resume {
            writeln!(
                std::io::stderr(),
                "{shown}: left by an interrupted run; begun anew without --resume"
            )?;
        }
        let mut made: Vec<SparseVectors> = Vec::with_capacity(vertices);
        for chunk in &chunks {
            made.extend(vectors_from_bytes(chunk)?);
        }
        let resumed = made.len();
        let progress = Progress::new(vertices as u64);
        progress.step("light at vertices");
        progress.done(resumed as u64);
        let occluder = Occluder::of(&mesh);
        let mut first = 0;
        for (surface, maps) in &work {
            let count = surface.positions.len();
            while made.len() < first + count {
                let from = made.len() - first;
                let range = from..(from + CHUNK).min(count);
                let done = || progress.done(1);
                let chunk = precompute(&mesh, &occluder, surface, range, maps, &params, &done);
                log.append(&vectors_to_bytes(&chunk))?;
                made.extend(chunk);
            }
            first += count;
        }
        progress.step("ordering");
        let mut rest = &made[..];
        let parts: Vec<Part<'_>> = work
            .into_iter()
            .map(|(surface, maps)| {
                let (own, others) = rest.split_at(surface.positions.len());
                rest = others;
                Part::new(surface, &maps, own)
            })
            .collect();
        let record = RelightRecord {
            mesh: file_name(&self.mesh),
            brdf: subject.short_name(),
            maps: map_params,
            precompute: params,
        };
        let bytes = relight_to_bytes(&parts, &record)?;
        write_atomically(&self.output, &bytes, self.force.overwrite())?;
        log.remove()?;
        drop(progress);
        let transport: usize = parts.iter().map(|part| part.transport.bytes()).sum();
        let entries: usize = parts.iter().map(|part| part.transport.entries()).sum();
        let seconds = start.elapsed().as_secs_f64();
        if self.json {
            let report = json!({
                "output": self.output, "vertices": vertices, "resumed": resumed,
                "terms": parts[0].maps.terms, "entries": entries, "transport_bytes": transport,
                "bytes": bytes.len(), "seconds": seconds, "made": record,
            });
            writeln!(out, "{}", serde_json::to_string_pretty(&report)?)?;
        } else {
            writeln!(
                out,
                "{}: {}, {vertices} vertices, {} terms, {seconds:.1} s",
                self.output.display(),
                shown_bytes(bytes.len()),
                parts[0].maps.terms
            )?;
        }
        Ok(ExitCode::SUCCESS)
    }

    #[expect(clippy::cast_possible_truncation, reason = "in range")]
    fn map_params(&self) -> MapParams {
        let light_maps = match self.light_maps {
            Some(LightMapsArg::Rgb) => LightMaps::Rgb,
            Some(LightMapsArg::Joint) => LightMaps::Joint,
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
    fn params(&self) -> PrecomputeParams {
        let quality = match self.quality {
            QualityArg::One => Quality::One,
            QualityArg::Adaptive => Quality::Adaptive,
            QualityArg::Sixteen => Quality::Sixteen,
        };
        PrecomputeParams { coefficients: self.coefficients as usize, quality }
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

/// A hash of all that chunks depend on.
fn key(work: &[(Surface, BrdfMaps)], params: &PrecomputeParams) -> [u8; 32] {
    let mut hash = Sha256::new();
    for (surface, maps) in work {
        for vector in surface.positions.iter().chain(&surface.normals) {
            vector.to_array().iter().for_each(|v| hash.update(v.to_le_bytes()));
        }
        surface.triangles.as_flattened().iter().for_each(|at| hash.update(at.to_le_bytes()));
        maps.light.texels().iter().for_each(|v| hash.update(v.to_le_bytes()));
        hash.update((maps.terms as u64).to_le_bytes());
    }
    hash.update(format!("{params:?}"));
    hash.finalize().into()
}
