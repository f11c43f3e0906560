//! Arguments that several commands share, and the choices behind them.

use std::ops::Bound::{Excluded, Included};
use std::ops::RangeBounds;
use std::path::{Path, PathBuf};

use brdf_container::MaterialFile;
use brdf_files::{FileError, MappedFile};
use brdf_io::{ColumnMap, ReadOptions, RowChoice, TableOptions};
use brdf_model::{Channels, MerlLookup, MerlNodes};
use brdf_render::{DirectionalLight, Environment, Light};

/// How measured files are read.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Reading measured files")]
pub(crate) struct ReadArgs {
    /// Where in its cell a MERL value stands; the literature disagrees
    #[arg(long, value_enum, default_value_t = MerlNodesArg::Centre)]
    merl_nodes: MerlNodesArg,

    /// What the columns of a table mean, as meaning=name pairs separated by commas. Meanings:
    /// theta_i_deg phi_i_deg theta_o_deg phi_o_deg (or _rad), r g b, value or value_cos (times the cosine of the
    /// viewer), wavelength_um or wavelength_nm. #3 is the third column; a number is the same angle in all rows.
    /// Example: --columns theta_i_deg=zenith_in,phi_i_deg=az_in,theta_o_deg=zenith_out,phi_o_deg=az_out,value=brdf
    #[arg(long, value_name = "MEANING=NAME,…")]
    columns: Option<ColumnMap>,

    /// Of a table, take the rows with this in a column; `any` takes all of them. May be given several times
    #[arg(long = "where", value_name = "COLUMN=VALUE")]
    rows: Vec<RowChoice>,

    /// Of a table with wavelengths, take the one nearest to this, in micrometres [default: 0.55 where each row has its
    /// own, else all of them as a colour]
    #[arg(long, value_name = "UM")]
    wavelength_um: Option<f64>,
}

impl ReadArgs {
    /// Where in its cell a MERL value stands.
    pub(crate) fn nodes(&self) -> MerlNodes {
        self.merl_nodes.into()
    }

    /// Opens a material.
    pub(crate) fn open(&self, name: &str) -> anyhow::Result<MaterialFile> {
        Ok(MaterialFile::open(name, &self.options())?)
    }

    pub(crate) fn options(&self) -> ReadOptions {
        ReadOptions {
            merl_lookup: MerlLookup::Trilinear(self.merl_nodes.into()),
            table: TableOptions {
                columns: self.columns.clone(),
                rows: self.rows.clone(),
                wavelength_um: self.wavelength_um,
            },
            material: None,
        }
    }
}

choices! {
    pub(crate) enum MerlNodesArg for MerlNodes {
        /// At the cell's centre (ALTA)
        Centre => Centre,
        /// At the cell's lower edge (libbsdf)
        Edge => Edge,
    }
}

/// Which pairs are drawn.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct PairArgs {
    /// Largest angle between a direction and the normal, degrees, above 0 and at most 90
    /// [default: 80; where `factor` makes sums of products, 90]
    #[arg(long, value_name = "DEG", value_parser = within((Excluded(0.0), Included(90.0)), "degrees above 0 and at most 90"))]
    max_theta_deg: Option<f64>,

    /// One channel: Rec. 709 luminance, weights .2126 .7152 .0722
    #[arg(long)]
    pub(crate) luminance: bool,
}

impl PairArgs {
    /// Largest polar angle in radians, 80° unless another was given.
    pub(crate) fn theta_max(&self) -> f64 {
        self.given_theta_max().unwrap_or(80_f64.to_radians())
    }

    pub(crate) fn given_theta_max(&self) -> Option<f64> {
        self.max_theta_deg.map(f64::to_radians)
    }

    /// The channels that were asked for, if any were.
    pub(crate) fn channels(&self) -> Option<Channels> {
        self.luminance.then_some(Channels::Luminance)
    }
}

/// Takes a number within a range.
pub(crate) fn within<R>(
    range: R,
    expected: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync
where
    R: RangeBounds<f64> + Clone + Send + Sync + 'static,
{
    move |text| {
        let number = text.parse().ok().filter(|value| range.contains(value));
        number.ok_or_else(|| format!("expected {expected}"))
    }
}

/// Takes so many finite numbers, separated by commas.
pub(crate) fn numbers<const N: usize>(
    expected: &'static str,
) -> impl Fn(&str) -> Result<[f64; N], String> + Clone + Send + Sync {
    move |text| {
        let numbers = text.split(',').map(|number| number.trim().parse().ok());
        let numbers: Option<Vec<f64>> = numbers.collect();
        let numbers = numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
        let finite = numbers.filter(|numbers| numbers.iter().all(|number| number.is_finite()));
        finite.ok_or_else(|| format!("expected {expected}"))
    }
}

/// A number that is finite and at least 0.
pub(crate) fn not_negative(text: &str) -> Result<f64, String> {
    within(0.0..f64::INFINITY, "a number of 0 or more")(text)
}

/// A share that leaves something over.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    within(0.0..=0.9, "a number from 0 to 0.9")(text)
}

/// A number that is finite and above 0.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    within((Excluded(0.0), Excluded(f64::INFINITY)), "a number above 0")(text)
}

/// What lights a picture.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Lighting")]
pub(crate) struct LightArgs {
    /// Light the sphere with a lat-long Radiance HDR environment instead of one light
    #[arg(long, value_name = "FILE", conflicts_with = "light_deg")]
    pub(crate) env: Option<PathBuf>,

    /// Where the light stands: degrees from the direction to the camera, and degrees around it (0
    /// right, 90 above) [default: 30,135]
    #[arg(long, value_name = "THETA,PHI", value_parser = numbers::<2>("two numbers, such as 30,0"), allow_hyphen_values = true)]
    pub(crate) light_deg: Option<[f64; 2]>,
}

impl LightArgs {
    /// The light that was asked for.
    pub(crate) fn open(&self) -> anyhow::Result<Light> {
        if let Some(path) = &self.env {
            return Ok(Light::Environment(environment(path)?));
        }
        let light = self.light_deg.map_or_else(DirectionalLight::default, |[theta, phi]| {
            DirectionalLight { theta: theta.to_radians(), phi: phi.to_radians() }
        });
        Ok(Light::Directional(light))
    }
}

/// A lat-long Radiance HDR environment.
pub(crate) fn environment(path: &Path) -> Result<Environment, FileError> {
    let bytes = MappedFile::open(path)?;
    Environment::from_hdr(&bytes).map_err(FileError::content(path))
}

/// Bytes from a number with an optional unit: 500M, 1.5G.
pub(crate) fn memory(text: &str) -> Result<usize, String> {
    let plain = text.trim_end_matches('B').trim_end_matches('i');
    let (digits, unit) = match plain.char_indices().last() {
        Some((at, 'K' | 'k')) => (&plain[..at], 10),
        Some((at, 'M')) => (&plain[..at], 20),
        Some((at, 'G')) => (&plain[..at], 30),
        _ => (plain, 0),
    };
    match digits.parse::<f64>() {
        Ok(count) if count >= 0.0 && count * f64::from(1_u32 << unit) < 1e15 => {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in range")]
            let bytes = (count * f64::from(1_u32 << unit)) as usize;
            Ok(bytes)
        }
        _ => Err("expected bytes below a petabyte, such as 500M or 4G".to_owned()),
    }
}

/// Columns and rows of a picture; one number for a square.
pub(crate) fn resolution(text: &str) -> Result<[usize; 2], String> {
    let sides: Option<Vec<usize>> = text.split('x').map(|side| side.parse().ok()).collect();
    let [width, height] = match sides.as_deref() {
        Some([side]) => [*side; 2],
        Some([width, height]) => [*width, *height],
        _ => return Err("expected pixels such as 512, or 768x512".to_owned()),
    };
    match [width, height].iter().all(|side| (16..=4096).contains(side)) {
        true => Ok([width, height]),
        false => Err("expected 16 to 4096 pixels along each side".to_owned()),
    }
}

/// The first option that was given, if any.
pub(crate) fn first_given(options: &[(bool, &'static str)]) -> Option<&'static str> {
    options.iter().find_map(|(given, name)| given.then_some(*name))
}

/// The name of a file without folders.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// The name of a file without folders and ending.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Arguments that do not go together.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(crate) struct Usage(String);

/// The error of arguments that do not go together.
pub(crate) fn usage(message: impl Into<String>) -> anyhow::Error {
    Usage(message.into()).into()
}
