//! BTFs and compressed BTFs from the command line.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use brdf_container::{CompressedBtf, open_compressed_btf};
use brdf_files::FileError;
use btf_io::{Btf, BtfNotes, open_btf};
use btf_vq::BtfReader;

use crate::args::memory;
use crate::progress::Watch;

/// How much memory images may take.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct MemoryArgs {
    /// Memory for decoded images; more of them go to a temporary file
    #[arg(long, value_name = "BYTES", default_value = "2G", value_parser = memory)]
    pub(super) memory: usize,
}

/// Opens and decodes a BTF.
pub(super) fn load(path: &Path, limit: MemoryArgs, watch: &Watch) -> Result<Btf, FileError> {
    let input = open_btf(path)?;
    watch.run(|job| input.load(limit.memory, job))
}

/// What should be said about an input, one line each.
pub(super) fn notes(path: &Path) -> Result<Vec<String>, FileError> {
    Ok(open_btf(path)?.notes().map_or_else(Vec::new, BtfNotes::sentences))
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
        let file = open_compressed_btf(&self.model)?;
        let texture = file.model.texture_named(&self.texture).ok_or_else(|| {
            let textures = file.model.textures();
            let names: Vec<&str> = textures.iter().map(|t| t.name.as_str()).collect();
            let (path, names) = (self.model.display(), names.join(", "));
            anyhow!("{path}: no texture {}; it has {names}", self.texture)
        })?;
        Ok(OpenModel { file, texture })
    }
}

/// An open model and the number of a texture.
pub(super) struct OpenModel {
    pub(super) file: CompressedBtf,
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

/// Most memory that this process has had in use, bytes, where the system says.
pub(super) fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse::<u64>().ok().map(|kib| kib << 10)
}
