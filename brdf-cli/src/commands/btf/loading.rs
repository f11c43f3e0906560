//! BTFs and compressed BTFs from the command line.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use brdf_io::{Btf, BtfInput, BtfModelFile, open_btf, open_btf_model};
use btf_vq::BtfReader;

use crate::args::memory;
use crate::progress::Progress;

/// How much memory images may take.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct MemoryArgs {
    /// Memory for decoded images; more of them go to a temporary file
    #[arg(long, value_name = "BYTES", default_value = "2G", value_parser = memory)]
    pub(super) memory: usize,
}

/// Opens and decodes a BTF, with progress.
pub(super) fn load(path: &Path, limit: MemoryArgs) -> anyhow::Result<Btf> {
    let input = open_btf(path)?;
    let progress = Progress::new(input.layout().image_count() as u64);
    progress.step(format!("reading {}", path.display()));
    Ok(input.load(limit.memory, &|images| progress.done(images))?)
}

/// What should be said about an input, one line each.
pub(super) fn notes(input: &BtfInput) -> Vec<String> {
    let Some(notes) = input.notes() else { return Vec::new() };
    let mut lines = Vec::new();
    if notes.missing > 0 {
        lines.push(format!(
            "{} images are missing; their values are interpolated from those of the same view",
            notes.missing
        ));
    }
    let list = |names: &[String]| {
        let shown: Vec<&str> = names.iter().take(3).map(String::as_str).collect();
        let rest = if names.len() > 3 { " …" } else { "" };
        format!("{}{rest}", shown.join(", "))
    };
    if !notes.off_table_lights.is_empty() {
        let (count, names) = (notes.off_table_lights.len(), list(&notes.off_table_lights));
        lines.push(format!("{count} lights stand where most views have none: {names}"));
    }
    // Our own report is no surprise.
    let is_foreign = |name: &&String| name.rsplit('/').next() != Some("report.json");
    let foreign: Vec<String> = notes.foreign_files.iter().filter(is_foreign).cloned().collect();
    if !foreign.is_empty() {
        let (count, names) = (foreign.len(), list(&foreign));
        lines.push(format!("{count} files are not named by angles and were not read: {names}"));
    }
    lines
}

/// A compressed BTF and which of its textures is meant.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct ModelArgs {
    /// Compressed BTF
    pub(super) model: PathBuf,

    /// Which of several textures, by name or number from 1
    #[arg(long, value_name = "NAME|NUMBER", default_value = "1")]
    pub(super) texture: String,
}

impl ModelArgs {
    pub(super) fn open(&self) -> anyhow::Result<OpenModel> {
        let file = open_btf_model(&self.model)?;
        let textures = file.model.textures();
        let number = self.texture.parse::<usize>().ok().and_then(|n| n.checked_sub(1));
        let named = textures.iter().position(|t| t.name == self.texture);
        let texture = named.or(number).filter(|at| *at < textures.len()).ok_or_else(|| {
            let names: Vec<&str> = textures.iter().map(|t| t.name.as_str()).collect();
            anyhow!(
                "{}: no texture {}; it has {}",
                self.model.display(),
                self.texture,
                names.join(", ")
            )
        })?;
        Ok(OpenModel { file, texture })
    }
}

/// An open model and the number of a texture.
pub(super) struct OpenModel {
    pub(super) file: BtfModelFile,
    pub(super) texture: usize,
}

impl OpenModel {
    pub(super) fn reader(&self) -> anyhow::Result<BtfReader<'_>> {
        self.file.model.reader(self.texture).ok_or_else(|| anyhow!("the texture is gone"))
    }

    pub(super) fn cosine_included(&self) -> bool {
        self.file.model.textures()[self.texture].cosine_included
    }
}

/// Texel, row-major, of tile coordinates; u to the right, v upwards.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "reduced to the tile")]
pub(super) fn texel_at((width, height): (usize, usize), u: f64, v: f64) -> usize {
    let x = (u.rem_euclid(1.0) * width as f64) as usize;
    let y = ((1.0 - v.rem_euclid(1.0)) * height as f64) as usize;
    y.min(height - 1) * width + x.min(width - 1)
}

/// Most memory that this process has had in use, bytes, where the system says.
pub(super) fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse::<u64>().ok().map(|kib| kib << 10)
}
