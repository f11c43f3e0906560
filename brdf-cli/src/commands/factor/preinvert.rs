//! Matrices that are inverted once and used for other values at the same places.

use std::path::PathBuf;

use brdf_container::{read_basis, write_basis};
use brdf_factor::{Damping, Inversion};
use brdf_files::{FileError, MappedFile, Overwrite, write_atomically};
use brdf_fit::{Basis, FactoredMethod, FitSettings};
use clap::ValueEnum;

use crate::args::usage;

#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Preinversion (--method mccool, radial)")]
pub(super) struct PreinvertArgs {
    /// Also write the inverted matrix, for --with
    #[arg(long, value_name = "FILE")]
    preinvert: Option<PathBuf>,

    /// Invert by this many singular vectors instead of a Cholesky factor
    #[arg(long, value_name = "K", requires = "preinvert", value_parser = clap::value_parser!(u32).range(1..))]
    components: Option<u32>,

    /// What becomes of small singular values [default: truncated]
    #[arg(long, value_enum, requires = "components")]
    damping: Option<DampingArg>,

    /// Solve with a matrix that --preinvert wrote, for samples at the same places; its options hold
    #[arg(long, value_name = "FILE", conflicts_with_all = ["preinvert", "method", "texture_size", "smoothing", "samples", "seed", "replicate", "bound", "log_map", "weight", "zeros", "reciprocal", "projections", "space"])]
    with: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum DampingArg {
    /// Those beyond the first K count for nothing
    Truncated,
    /// The i-th of K counts 1 − i/K
    Linear,
    /// Damped by a thousandth of the largest
    Alpha,
}

impl PreinvertArgs {
    /// The matrix to solve with, if one is given.
    pub(super) fn open(&self) -> anyhow::Result<Option<Basis>> {
        let Some(path) = &self.with else { return Ok(None) };
        let basis = read_basis(&MappedFile::open(path)?).map_err(FileError::content(path))?;
        Ok(Some(basis))
    }

    /// A matrix is to be kept or used.
    pub(super) fn is_given(&self) -> bool {
        self.preinvert.is_some() || self.with.is_some()
    }

    /// How the matrix is to be inverted, if it is.
    pub(super) fn inversion(&self, settings: &FitSettings) -> anyhow::Result<Option<Inversion>> {
        if self.preinvert.is_none() {
            return Ok(None);
        }
        let method = match settings {
            FitSettings::Factored(settings) => Some(&settings.method),
            _ => None,
        };
        if !matches!(method, Some(FactoredMethod::McCool | FactoredMethod::Radial)) {
            return Err(usage("--preinvert is for --method mccool or radial"));
        }
        let Some(components) = self.components else { return Ok(Some(Inversion::Cholesky)) };
        let damping = match self.damping {
            None | Some(DampingArg::Truncated) => Damping::Truncated,
            Some(DampingArg::Linear) => Damping::Linear,
            Some(DampingArg::Alpha) => Damping::Alpha(1e-3),
        };
        Ok(Some(Inversion::Svd { components: components as usize, damping }))
    }

    pub(super) fn write(&self, basis: &Basis, force: bool) -> anyhow::Result<()> {
        let Some(path) = &self.preinvert else { return Ok(()) };
        let overwrite = if force { Overwrite::Anything } else { Overwrite::Ours };
        Ok(write_atomically(path, &write_basis(basis)?, overwrite)?)
    }
}
