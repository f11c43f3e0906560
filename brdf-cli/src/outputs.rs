//! Where results go, and how they are shown.

use std::io::{Write, stderr};
use std::path::{Path, PathBuf};

use anyhow::bail;
use brdf_files::{FileError, OutputFolder, Overwrite, write_atomically};
use brdf_image::{DisplayImage, Film, ToneMap, encode_png};
use brdf_report::ResultFile;

use crate::args::positive;

/// What may be overwritten.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct ForceArgs {
    /// Overwrite a file that brdf did not write
    #[arg(long)]
    force: bool,
}

impl ForceArgs {
    pub(crate) fn overwrite(self) -> Overwrite {
        if self.force { Overwrite::Anything } else { Overwrite::Ours }
    }
}

/// A folder of results. The command gives its default name.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct FolderArgs {
    /// Folder to write; one that brdf wrote is replaced
    #[arg(short, long, value_name = "FOLDER", required = false)]
    pub(crate) output: PathBuf,

    /// Write into a folder that holds other files
    #[arg(long)]
    pub(crate) force: bool,
}

impl FolderArgs {
    /// Starts the folder.
    pub(crate) fn create(&self) -> Result<OutputFolder, FileError> {
        OutputFolder::new(&self.output, self.force)
    }
}

/// A picture. The command gives its default name.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct PictureArgs {
    /// Picture to write, PNG
    #[arg(short, long, value_name = "FILE", required = false)]
    output: PathBuf,

    /// Factor from linear values to what is shown as white
    #[arg(long, value_parser = positive, allow_hyphen_values = true)]
    pub(crate) exposure: Option<f64>,

    #[command(flatten)]
    force: ForceArgs,
}

impl PictureArgs {
    /// Refuses a name of another format before there is a picture.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        if self.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
            return Ok(());
        }
        bail!("{}: unknown extension; expected .png", self.output.display())
    }

    /// Writes a film, exposed as asked for or as `usual` has it.
    pub(crate) fn write_film(
        &self,
        film: &Film,
        usual: impl FnOnce(&Film) -> ToneMap,
    ) -> anyhow::Result<()> {
        let tone = self.exposure.map_or_else(|| usual(film), |exposure| ToneMap { exposure });
        self.write(&tone.apply(film))
    }

    /// Writes a picture.
    pub(crate) fn write(&self, picture: &DisplayImage) -> anyhow::Result<()> {
        write_atomically(&self.output, &encode_png(picture)?, self.force.overwrite())?;
        Ok(writeln!(stderr(), "{}", self.output.display())?)
    }
}

/// Where a table goes.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct TableArgs {
    /// Output file; - or nothing for standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    #[command(flatten)]
    force: ForceArgs,
}

impl TableArgs {
    /// Writes a table to where it goes.
    pub(crate) fn write(&self, table: &str, out: &mut impl Write) -> anyhow::Result<()> {
        match self.output.as_deref() {
            Some(path) if path != Path::new("-") => {
                write_atomically(path, table.as_bytes(), self.force.overwrite())?;
            }
            _ => out.write_all(table.as_bytes())?,
        }
        Ok(())
    }
}

/// Prints a record as JSON, or what `text` makes of it.
pub(crate) fn show(
    out: &mut impl Write,
    is_json: bool,
    record: &impl serde::Serialize,
    text: impl FnOnce() -> String,
) -> anyhow::Result<()> {
    if is_json {
        writeln!(out, "{}", serde_json::to_string_pretty(record)?)?;
    } else {
        out.write_all(text().as_bytes())?;
    }
    Ok(())
}

/// Writes the files of a folder of results.
pub(crate) fn write_all(folder: &mut OutputFolder, files: &[ResultFile]) -> Result<(), FileError> {
    files.iter().try_for_each(|file| folder.write(&file.name, &file.bytes))
}

/// The command line, quoted where a shell would need it.
pub(crate) fn command_line() -> String {
    let quoted = |word: String| {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,@%+".contains(c);
        if !word.is_empty() && word.chars().all(plain) {
            word
        } else {
            format!("'{}'", word.replace('\'', "'\\''"))
        }
    };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("brdf".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
