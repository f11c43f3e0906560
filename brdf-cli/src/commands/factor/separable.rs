//! `brdf factor --method svd | log-svd | eigen | nmf | normalized`: sums of products.

use std::f64::consts::FRAC_PI_2;

use brdf_fit::{LogChoice, SeparableMethod, SeparableSettings};
use brdf_param::Parametrization;

use super::Factor;
use crate::args::{first_given, memory, usage, within};
use crate::choices::{
    BoundArg, EigenSolverArg, FillArg, LogMapArg, MapArg, MethodArg, ReciprocityArg,
};

/// How sums of products are made.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Sums of products (--method svd, log-svd, eigen, nmf, normalized)")]
pub(super) struct SeparableArgs {
    /// Number of terms; pairs of equal magnitude are completed beyond it [default: 4; 1 for
    /// normalized]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..=4096))]
    rank: Option<u32>,

    /// How the hemisphere is laid out in the textures [default: orthographic]
    #[arg(long, value_enum)]
    map: Option<MapArg>,

    /// Texels along each side of a texture [default: 48]
    #[arg(long, value_name = "TEXELS", value_parser = clap::value_parser!(u32).range(2..=1024))]
    resolution: Option<u32>,

    /// Decompose all channels together: scalar textures on the first side, RGB on the second
    #[arg(long)]
    joint_rgb: bool,

    /// Take the material to be isotropic: textures over the polar angle alone on the first side
    #[arg(long)]
    isotropic: bool,

    /// What stands in cells without data [default: edge]
    #[arg(long, value_enum)]
    fill: Option<FillArg>,

    /// p of the weights cosᵖθ of both sides; .5 pays for many terms of grazing-heavy materials
    #[arg(long, value_name = "P", value_parser = within(0.0..=8.0, "a number from 0 to 8"), allow_hyphen_values = true)]
    weight_power: Option<f64>,

    /// How eigenpairs are found [default: krylov]
    #[arg(long, value_enum)]
    eigen_solver: Option<EigenSolverArg>,

    /// Most memory for the matrix and the work on it, such as 500M [default: 4G]
    #[arg(long, value_name = "BYTES", value_parser = memory)]
    memory_limit: Option<usize>,
}

impl SeparableArgs {
    /// The first option that was given, if any.
    pub(super) fn given(&self) -> Option<&'static str> {
        first_given(&[
            (self.rank.is_some(), "--rank"),
            (self.map.is_some(), "--map"),
            (self.resolution.is_some(), "--resolution"),
            (self.joint_rgb, "--joint-rgb"),
            (self.isotropic, "--isotropic"),
            (self.fill.is_some(), "--fill"),
            (self.weight_power.is_some(), "--weight-power"),
            (self.eigen_solver.is_some(), "--eigen-solver"),
            (self.memory_limit.is_some(), "--memory-limit"),
        ])
    }
}

impl Factor {
    /// How the sum of products is made.
    pub(super) fn separable_settings(&self) -> anyhow::Result<SeparableSettings> {
        let args = &self.separable;
        let settings = SeparableSettings {
            parametrization: self.parametrization()?,
            map: args.map.unwrap_or(MapArg::Orthographic).into(),
            merl_nodes: self.read.nodes(),
            resolution: args.resolution.unwrap_or(48) as usize,
            isotropic: args.isotropic,
            rank: args.rank.map(|rank| rank as usize),
            joint_rgb: args.joint_rgb,
            fill: args.fill.unwrap_or(FillArg::Edge).into(),
            weight_power: args.weight_power.unwrap_or(0.0),
            memory_limit: args.memory_limit.unwrap_or(4 << 30),
            theta_max: self.pairs.given_theta_max().unwrap_or(FRAC_PI_2),
            seed: self.seed,
            channels: self.pairs.channels(),
            ..SeparableSettings::of(self.separable_method())
        };
        self.check_separable(&settings)?;
        Ok(settings)
    }

    fn separable_method(&self) -> SeparableMethod {
        match self.method() {
            MethodArg::LogSvd if self.log_map == LogMapArg::Cosine => {
                SeparableMethod::LogSvd(LogChoice::Cosine)
            }
            MethodArg::LogSvd => SeparableMethod::LogSvd(LogChoice::Offset),
            MethodArg::Eigen => {
                let solver = self.separable.eigen_solver.unwrap_or(EigenSolverArg::Krylov);
                SeparableMethod::Eigen(solver.into())
            }
            MethodArg::Nmf => SeparableMethod::Nmf,
            MethodArg::Normalized => SeparableMethod::Normalized,
            _ => SeparableMethod::Svd,
        }
    }

    fn parametrization(&self) -> anyhow::Result<Parametrization> {
        let args = &self.separable;
        let is_merl = args.map == Some(MapArg::Merl);
        let parametrization = match self.space {
            None if is_merl => Parametrization::HalfDifference,
            None => Parametrization::Standard,
            Some(space) => space.parametrization().ok_or_else(|| {
                usage(format!("--space auto is for --method search, not {}", self.method().name()))
            })?,
        };
        let is_half_difference = parametrization == Parametrization::HalfDifference;
        if is_merl && (!is_half_difference || args.resolution.is_some()) {
            return Err(usage(
                "--map merl is a grid of its own: it takes --space half-difference and no \
                 --resolution",
            ));
        }
        Ok(parametrization)
    }

    /// The first option that only products of textures have, if one was given.
    pub(super) fn texture_option_given(&self) -> Option<&'static str> {
        first_given(&[
            (self.projections.is_some(), "--projections"),
            (self.texels.is_some(), "--texels"),
            (self.samples.is_some(), "--samples"),
            (self.smoothing.to_bits() != 1e-4_f64.to_bits(), "--smoothing"),
            (self.bound != BoundArg::Disc, "--bound"),
            (self.offset.is_some(), "--offset"),
            (self.weight.is_some(), "--weight"),
            (self.highlight.is_some(), "--highlight"),
            (self.no_ceiling, "--no-ceiling"),
            (self.zeros.is_some(), "--zeros"),
            (self.reciprocal != ReciprocityArg::On, "--reciprocal"),
            (self.replicate.is_some(), "--replicate"),
        ])
    }

    /// Refuses what sums of products do not have.
    fn check_separable(&self, settings: &SeparableSettings) -> anyhow::Result<()> {
        let name = self.method().name();
        let size = (self.texture_size.is_some(), "--texture-size (--resolution is the one)");
        let given = first_given(&[size]).or_else(|| self.texture_option_given());
        if let Some(option) = given.or_else(|| self.compact.given()) {
            return Err(usage(format!("{option} does not apply to --method {name}")));
        }
        if let Some(option) = self.search.given() {
            return Err(usage(format!("{option} is for --method search, not {name}")));
        }
        let takes_log = self.method() == MethodArg::LogSvd;
        match self.log_map {
            LogMapArg::Offset => {}
            LogMapArg::Cosine if takes_log => {}
            _ if takes_log => {
                return Err(usage("--method log-svd takes --log-map offset or cosine"));
            }
            _ => return Err(usage(format!("--log-map does not apply to --method {name}"))),
        }
        let args = &self.separable;
        if self.method() == MethodArg::Eigen
            && (args.joint_rgb || !settings.layout().is_symmetric())
        {
            return Err(usage(
                "--method eigen needs one symmetric matrix a channel: --space standard, no --isotropic, \
                 no --joint-rgb",
            ));
        }
        if self.method() == MethodArg::Normalized && args.rank.is_some_and(|rank| rank != 1) {
            return Err(usage("--method normalized has one term: no --rank above 1"));
        }
        if self.separable.eigen_solver.is_some() && self.method() != MethodArg::Eigen {
            return Err(usage(format!("--eigen-solver is for --method eigen, not {name}")));
        }
        Ok(())
    }
}
