//! What is compressed: BTFs, or BRDFs as textures of one texel.

use std::io::{Write, stderr};
use std::path::{Path, PathBuf};

use anyhow::bail;
use brdf_container::MaterialFile;
use brdf_io::ReadOptions;
use brdf_model::Brdf;
use btf_io::Btf;
use btf_vq::{BtfSource, GridChoice, Tabulated, TextureInputs};

use super::loading::{MemoryArgs, load, notes};
use crate::args::stem;
use crate::progress::Watch;

/// Whether an input names a BRDF, or an archive of them, rather than images.
pub(super) fn is_brdf(path: &Path) -> bool {
    let is = |name: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(name));
    let is_preset = path.to_string_lossy().starts_with("preset:");
    is_preset
        || path.to_string_lossy().contains(".npz:")
        || (path.is_file() && !is("zip") && !is("btf"))
}

/// All materials that an input names.
pub(super) fn open_brdfs(path: &Path) -> anyhow::Result<Vec<MaterialFile>> {
    Ok(MaterialFile::open_all(&path.to_string_lossy(), &ReadOptions::default())?)
}

/// BRDFs and what their textures are called: files or materials, without folders and ending.
pub(super) fn named(files: &[MaterialFile]) -> Vec<(String, &dyn Brdf)> {
    files.iter().map(|file| (stem(Path::new(&file.short_name())), file.brdf())).collect()
}

/// Opened inputs.
pub(super) enum Inputs {
    Images(Vec<(String, Btf)>),
    Brdfs(Vec<MaterialFile>),
}

impl Inputs {
    pub(super) fn open(
        paths: &[PathBuf],
        memory: MemoryArgs,
        watch: &Watch,
    ) -> anyhow::Result<Self> {
        let brdf = paths.iter().find(|path| is_brdf(path));
        let other = paths.iter().find(|path| !is_brdf(path));
        if let (Some(brdf), Some(other)) = (brdf, other) {
            bail!(
                "{} is a BRDF and {} is not; compress one kind at a time",
                brdf.display(),
                other.display()
            );
        }
        if brdf.is_some() {
            let files: anyhow::Result<Vec<_>> = paths.iter().map(|path| open_brdfs(path)).collect();
            return Ok(Self::Brdfs(files?.into_iter().flatten().collect()));
        }
        let each = MemoryArgs { memory: memory.memory / paths.len().max(1) };
        let mut sources = Vec::new();
        for path in paths {
            for note in notes(path)? {
                writeln!(stderr(), "{}: {note}", path.display())?;
            }
            sources.push((stem(path), load(path, each, watch)?));
        }
        Ok(Self::Images(sources))
    }

    /// The textures, on a grid of directions.
    pub(super) fn textures(
        &self,
        grid: GridChoice,
        with_mipmaps: bool,
        watch: &Watch,
    ) -> anyhow::Result<TextureInputs<'_>> {
        match self {
            Self::Images(sources) => {
                let sources = sources
                    .iter()
                    .map(|(name, btf)| (name.clone(), btf as &dyn BtfSource))
                    .collect();
                Ok(TextureInputs::images(sources, grid, with_mipmaps))
            }
            Self::Brdfs(files) => {
                let brdfs = named(files);
                let (inputs, changes) = watch.run(|job| TextureInputs::brdfs(&brdfs, grid, job))?;
                for (file, changed) in files.iter().zip(changes) {
                    if changed != Tabulated::default() {
                        writeln!(stderr(), "{}: {changed}", file.source)?;
                    }
                }
                Ok(inputs)
            }
        }
    }
}
