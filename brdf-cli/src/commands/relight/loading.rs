//! What the commands that use transport share: the file, the light, the camera.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use brdf_container::{RelightFile, read_relight};
use brdf_files::{FileError, MappedFile};
use brdf_mesh::Mesh;
use brdf_relight::{CubeLight, CubeLightSampler, LightRule, Orbit};
use brdf_render::Environment;

use crate::args::{environment, file_name, numbers};

/// A file of transport.
pub(super) struct Loaded {
    path: PathBuf,
    bytes: MappedFile,
}

impl Loaded {
    pub(super) fn open(path: &Path) -> Result<Self, FileError> {
        Ok(Self { path: path.to_owned(), bytes: MappedFile::open(path)? })
    }

    pub(super) fn parse(&self) -> Result<RelightFile<'_>, FileError> {
        read_relight(&self.bytes).map_err(FileError::content(&self.path))
    }

    pub(super) fn len(&self) -> usize {
        self.bytes.len()
    }
}

/// The object of a file, for rays.
pub(super) fn mesh_of(file: &RelightFile<'_>) -> anyhow::Result<Mesh> {
    Ok(file.parts.first().context("no parts")?.mesh()?)
}

/// What lights the object.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Lighting")]
pub(super) struct LightArgs {
    /// Lat-long Radiance HDR environment, or light:sky or light:studio, which need no file
    #[arg(long, value_name = "FILE", default_value = "light:sky")]
    env: PathBuf,

    /// Turn the environment about the vertical
    #[arg(long, value_name = "DEG", default_value_t = 0.0, allow_hyphen_values = true)]
    rotate_deg: f64,

    /// Which of the light's coefficients are used
    #[arg(long, value_enum, default_value_t = RuleArg::Energy)]
    light_rule: RuleArg,
}

choices! {
    enum RuleArg for LightRule {
        /// 99.5 % of the energy beyond the brightest, 200 to 1,000 of them
        Energy => Energy,
        /// Those of at least 1/32 of the largest
        Paper => Paper,
        /// All
        All => All,
    }
}

impl LightArgs {
    pub(super) fn environment(&self) -> anyhow::Result<Environment> {
        Ok(match self.env.to_str() {
            Some("light:sky") => Environment::sky()?,
            Some("light:studio") => Environment::studio()?,
            _ => environment(&self.env)?,
        })
    }

    /// What it is called, without folders.
    pub(super) fn name(&self) -> String {
        file_name(&self.env)
    }

    /// The turn of the environment, in radians.
    pub(super) fn rotation(&self) -> f64 {
        self.rotate_deg.to_radians()
    }

    pub(super) fn light(&self) -> anyhow::Result<CubeLight> {
        Ok(CubeLightSampler::default().light(&self.environment()?, self.rotation()))
    }

    pub(super) fn rule(&self) -> LightRule {
        self.light_rule.into()
    }
}

/// How a picture is taken.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct ShotArgs {
    /// Where the camera stands about the object: azimuth in degrees from +z towards +x, elevation, and distance in
    /// radii of the object
    #[arg(
        long,
        value_name = "AZIMUTH,ELEVATION,RADII",
        default_value = "20,15,3.5",
        value_parser = view,
        allow_hyphen_values = true
    )]
    view: [f64; 3],

    /// Pixels along each side
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=4096))]
    size: u32,

    /// Points along each side of a pixel
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=8))]
    points: u32,
}

fn view(text: &str) -> Result<[f64; 3], String> {
    let expected = "azimuth, elevation and a distance above 1, such as 20,15,3.5";
    let [azimuth, elevation, radii] = numbers::<3>(expected)(text)?;
    match elevation.abs() <= 90.0 && radii > 1.0 {
        true => Ok([azimuth, elevation, radii]),
        false => Err(format!("expected {expected}")),
    }
}

impl ShotArgs {
    /// Where the camera goes around the object.
    pub(super) fn orbit(&self) -> Orbit {
        let [azimuth, elevation, radii] = self.view;
        Orbit {
            azimuth: azimuth.to_radians(),
            elevation: elevation.to_radians(),
            radii,
            size: self.size as usize,
            points: self.points as usize,
        }
    }
}
