//! `brdf factor --method auto | spline | ggx | isotropic`: the best model of a size, and models of isotropic materials.

use brdf_factor::Spacing;
use brdf_fit::{
    Aim, AutoSettings, CompactMethod, CompactSettings, FactoredSettings, IsotropicSettings,
};

use super::Factor;
use crate::args::{first_given, memory, positive, usage};
use crate::choices::{AnglesArg, LogMapArg, MethodArg};

/// How compact models are made.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Size (--method auto, spline, ggx, isotropic)")]
pub(super) struct CompactArgs {
    /// Most bytes of the model, such as 2.7k, 8k or 32k [default: 8k; 33.75k for --method isotropic]
    #[arg(long, value_name = "BYTES", value_parser = memory)]
    pub(super) bytes: Option<usize>,

    /// For --method auto: the smallest model with this error, in place of the best of so many bytes. The error is the
    /// geometric mean of eight, away from the highlight and in it; .02 is hard to see
    #[arg(long, value_name = "E", conflicts_with = "bytes", value_parser = positive)]
    error: Option<f64>,

    /// GGX lobes [default: 2]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=3))]
    pub(super) lobes: Option<u8>,

    /// For --method isotropic: pairs of angles [default: those that suit best]
    #[arg(long, value_enum)]
    angles: Option<AnglesArg>,

    /// For --method isotropic: texels along θh at (θh/θmax)^P; 1 is even, less crowds at the highlight [default: 1,
    /// .75 or .5, what suits best]
    #[arg(long, value_name = "P", value_parser = positive)]
    spacing: Option<f64>,
}

impl CompactArgs {
    /// The first option that was given, if any.
    pub(super) fn given(&self) -> Option<&'static str> {
        first_given(&[
            (self.bytes.is_some(), "--bytes"),
            (self.error.is_some(), "--error"),
            (self.lobes.is_some(), "--lobes"),
        ])
        .or_else(|| self.angle_option_given())
    }

    /// The first option of textures over angles that was given, if any.
    pub(super) fn angle_option_given(&self) -> Option<&'static str> {
        first_given(&[(self.angles.is_some(), "--angles"), (self.spacing.is_some(), "--spacing")])
    }

    /// How textures over angles are made.
    pub(super) fn isotropic_settings(&self) -> anyhow::Result<IsotropicSettings> {
        if self.error.is_some() || self.lobes.is_some() {
            return Err(usage("--error is for --method auto, --lobes for --method ggx"));
        }
        Ok(IsotropicSettings {
            pairs: self.angles.map(Into::into),
            spacing: self.spacing.map(|exponent| Spacing::Power { exponent }),
            bytes: self.bytes.unwrap_or(IsotropicSettings::default().bytes),
        })
    }
}

impl Factor {
    /// What the best small model may cost or has to reach.
    pub(super) fn auto_settings(&self) -> anyhow::Result<AutoSettings> {
        self.refuse_others()?;
        if self.compact.lobes.is_some() {
            return Err(usage("--lobes is for --method ggx"));
        }
        let aim = match (self.compact.bytes, self.compact.error) {
            (_, Some(error)) => Aim::Error(error),
            (bytes, None) => bytes.map_or(Aim::default(), Aim::Bytes),
        };
        let search = FactoredSettings {
            theta_max: self.pairs.theta_max(),
            seed: self.seed,
            channels: self.pairs.channels(),
            ..FactoredSettings::default()
        };
        Ok(AutoSettings { aim, search })
    }

    /// Refuses the options of textures and of their sums.
    fn refuse_others(&self) -> anyhow::Result<()> {
        let others = [
            (self.space.is_some(), "--space"),
            (self.log_map != LogMapArg::Offset, "--log-map"),
            (self.texture_size.is_some(), "--texture-size"),
        ];
        let given = first_given(&others)
            .or_else(|| self.compact.angle_option_given())
            .or_else(|| self.texture_option_given())
            .or_else(|| self.separable.given())
            .or_else(|| self.search.given());
        given.map_or(Ok(()), |option| {
            Err(usage(format!("{option} does not apply to --method {}", self.method().name())))
        })
    }

    /// How the compact model is made.
    pub(super) fn compact_settings(&self) -> anyhow::Result<CompactSettings> {
        self.refuse_others()?;
        let args = &self.compact;
        if args.error.is_some() {
            return Err(usage("--error is for --method auto"));
        }
        let method = match (self.method(), args.bytes, args.lobes) {
            (MethodArg::Ggx, None, lobes) => {
                CompactMethod::Ggx { lobes: lobes.map_or(2, usize::from) }
            }
            (MethodArg::Spline, bytes, None) => {
                CompactMethod::Spline { bytes: bytes.unwrap_or(8 << 10) }
            }
            (MethodArg::Ggx, ..) => {
                return Err(usage("--bytes is for --method spline; lobes have --lobes"));
            }
            _ => return Err(usage("--lobes is for --method ggx; splines have --bytes")),
        };
        Ok(CompactSettings {
            theta_max: self.pairs.theta_max(),
            seed: self.seed,
            channels: self.pairs.channels(),
            ..CompactSettings::of(method)
        })
    }
}
