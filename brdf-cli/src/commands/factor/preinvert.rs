//! Matrices that are inverted once and used for other values at the same places.

use std::path::PathBuf;

use brdf_factor::{Damping, Inverse, Inversion, Preinverted};
use brdf_io::{
    BasisFile, BasisRecord, FitSettings, MappedFile, Overwrite, basis_to_bytes, parse_basis,
    write_atomically,
};
use clap::ValueEnum;

use crate::args::usage;
use crate::fitting::Method;

#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Preinversion (--method mccool, radial, projections)")]
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
    #[arg(long, value_name = "FILE", conflicts_with_all = ["preinvert", "method", "texture_size", "smoothing", "samples", "seed", "replicate", "bound", "log_map", "weight", "reciprocal", "projections", "space"])]
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
    pub(super) fn open(&self) -> anyhow::Result<Option<BasisFile>> {
        let Some(path) = &self.with else { return Ok(None) };
        let bytes = MappedFile::open(path)?;
        let basis = parse_basis(&bytes);
        basis.map(Some).map_err(|error| anyhow::anyhow!("{}: {error}", path.display()))
    }

    /// How the matrix is to be inverted, if it is.
    pub(super) fn inversion(&self, method: &Method) -> anyhow::Result<Option<Inversion>> {
        if self.preinvert.is_none() {
            return Ok(None);
        }
        if !matches!(method, Method::Together(_)) {
            return Err(usage("--preinvert is for --method mccool, radial or projections"));
        }
        let Some(components) = self.components else { return Ok(Some(Inversion::Cholesky)) };
        let damping = match self.damping {
            None | Some(DampingArg::Truncated) => Damping::Truncated,
            Some(DampingArg::Linear) => Damping::Linear,
            Some(DampingArg::Alpha) => Damping::Alpha(1e-3),
        };
        Ok(Some(Inversion::Svd { components: components as usize, damping }))
    }

    pub(super) fn write(
        &self,
        inverted: &Preinverted,
        method: &str,
        settings: &FitSettings,
        force: bool,
    ) -> anyhow::Result<()> {
        let Some(path) = &self.preinvert else { return Ok(()) };
        let record = BasisRecord {
            method: method.to_owned(),
            plan: inverted.plan().clone(),
            settings: settings.clone(),
            key: inverted.key().to_owned(),
            unknowns: inverted.unknowns(),
            components: match inverted.inverse() {
                Inverse::Cholesky(_) => None,
                Inverse::Svd(basis) => Some(basis.components()),
            },
        };
        let file = BasisFile { inverse: inverted.inverse().clone(), record };
        let overwrite = if force { Overwrite::Anything } else { Overwrite::Ours };
        Ok(write_atomically(path, &basis_to_bytes(&file)?, overwrite)?)
    }
}
