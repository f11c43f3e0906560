//! `brdf factor --method spline | ggx`: compact models of isotropic materials.

use brdf_fit::{CompactMethod, CompactSettings};

use super::Factor;
use crate::args::{first_given, memory, usage};
use crate::choices::{LogMapArg, MethodArg};

/// How compact models are made.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Compact models (--method spline, ggx)")]
pub(super) struct CompactArgs {
    /// Most bytes of the splines, such as 2.7k, 8k or 32k [default: 8k]
    #[arg(long, value_name = "BYTES", value_parser = memory)]
    bytes: Option<usize>,

    /// GGX lobes [default: 2]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=3))]
    lobes: Option<u8>,
}

impl CompactArgs {
    /// The first option that was given, if any.
    pub(super) fn given(&self) -> Option<&'static str> {
        first_given(&[(self.bytes.is_some(), "--bytes"), (self.lobes.is_some(), "--lobes")])
    }
}

impl Factor {
    /// How the compact model is made.
    pub(super) fn compact_settings(&self) -> anyhow::Result<CompactSettings> {
        let (name, args) = (self.method.name(), &self.compact);
        let others = [
            (self.space.is_some(), "--space"),
            (self.log_map != LogMapArg::Offset, "--log-map"),
            (self.texture_size.is_some(), "--texture-size"),
        ];
        let given = first_given(&others)
            .or_else(|| self.texture_option_given())
            .or_else(|| self.separable.given())
            .or_else(|| self.search.given());
        if let Some(option) = given {
            return Err(usage(format!("{option} does not apply to --method {name}")));
        }
        let method = match (self.method, args.bytes, args.lobes) {
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
