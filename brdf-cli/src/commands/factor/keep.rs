//! `brdf factor --from MODEL --keep N`: a smaller model out of a larger one, without fitting again.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::bail;
use brdf_container::{read_factored, write_factored};
use brdf_files::{FileError, MappedFile, OutputFolder};
use brdf_fit::{FactoredModel, KeptReport};
use brdf_report::{kept_files, kept_text};

use crate::args::usage;
use crate::outputs::write_all;

#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "A smaller model of an earlier search")]
pub(super) struct KeepArgs {
    /// Take the model from this file instead of fitting one
    #[arg(long, value_name = "MODEL", requires = "keep", conflicts_with_all = ["input", "method", "texels"])]
    from: Option<PathBuf>,

    /// Number of textures to keep: the best model of that many
    #[arg(long, value_name = "N", requires = "from")]
    keep: Option<u32>,
}

impl KeepArgs {
    /// The model asked for, if one was.
    pub(super) fn open(&self) -> anyhow::Result<Option<FactoredModel>> {
        if self.keep.is_some() && self.from.is_none() {
            return Err(usage("--keep takes a model out of a file: give it with --from"));
        }
        let (Some(path), Some(keep)) = (&self.from, self.keep) else { return Ok(None) };
        let file = read_factored(&MappedFile::open(path)?).map_err(FileError::content(path))?;
        let sizes: Vec<String> = file
            .smaller
            .iter()
            .chain([&file.model])
            .map(|model| model.factors().len().to_string())
            .collect();
        match file.keep(keep as usize) {
            Some(kept) => Ok(Some(kept)),
            None => bail!(
                "{}: no model of {keep} textures; expected one of {}",
                path.display(),
                sizes.join(", ")
            ),
        }
    }
}

/// Writes the folder of a kept model. There is no reference to compare with: errors are those of its
/// record.
pub(super) fn run(
    kept: &FactoredModel,
    output: &Path,
    force: bool,
    json: bool,
    out: &mut impl Write,
) -> anyhow::Result<()> {
    let mut folder = OutputFolder::new(output, force)?;
    folder.write("model.safetensors", &write_factored(kept)?)?;
    write_all(&mut folder, &kept_files(kept)?)?;
    let report = serde_json::to_string_pretty(&KeptReport::new(kept, env!("CARGO_PKG_VERSION")))?;
    folder.write("report.json", report.as_bytes())?;
    let place = folder.finish()?;
    match json {
        true => writeln!(out, "{report}")?,
        false => {
            write!(out, "{}", kept_text(kept))?;
            writeln!(out, "{}", place.join("model.safetensors").display())?;
        }
    }
    Ok(())
}
