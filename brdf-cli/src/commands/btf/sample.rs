//! `brdf btf sample`.

use std::io::Write;

use anyhow::bail;
use brdf_param::spherical_direction;
use btf_io::drawn_table;
use btf_vq::{DrawParams, draw_lights};

use super::loading::ModelArgs;
use crate::args::numbers;
use crate::outputs::TableArgs;

/// Draw light directions for a view, distributed as the luminance that a compressed BTF stores
///
/// Output is a table theta_i_deg,phi_i_deg,pdf,r,g,b: the pdf per steradian and the linear
/// radiance, for texels all over the tile or for one. The albedo of the texel, or the mean over the
/// tile, goes to standard error.
///
/// Example: brdf btf sample wool.btfvq --view-deg 45,0 -n 100000 -o samples.csv
#[derive(clap::Args)]
pub(in crate::commands) struct Sample {
    #[command(flatten)]
    model: ModelArgs,

    /// View: polar angle and azimuth, degrees
    #[arg(long, value_name = "THETA,PHI", value_parser = numbers::<2>("two numbers, such as 45,0"), allow_hyphen_values = true)]
    view_deg: [f64; 2],

    /// Number of directions
    #[arg(short = 'n', long = "samples", default_value_t = 10_000)]
    samples: u32,

    /// One place of the tile instead of all
    #[arg(long, value_name = "U,V", value_parser = numbers::<2>("two numbers, such as 45,0"), allow_hyphen_values = true)]
    at: Option<[f64; 2]>,

    /// Which scramble of the sequence
    #[arg(long, default_value_t = 1)]
    seed: u64,

    #[command(flatten)]
    table: TableArgs,
}

impl Sample {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<()> {
        let [theta, phi] = self.view_deg;
        if !(0.0..90.0).contains(&theta) {
            bail!("--view-deg {theta},{phi}: expected a polar angle from 0 to below 90");
        }
        let model = self.model.open()?;
        let reader = model.reader()?;
        let wo = spherical_direction(theta.to_radians(), phi.to_radians());
        let params = DrawParams {
            count: self.samples,
            at: self.at,
            seed: self.seed,
            cosine_included: model.cosine_included(),
        };
        let (drawn, albedo) = draw_lights(&reader, wo, &params);
        self.table.write(&drawn_table(&drawn), out)?;
        let [r, g, b] = albedo;
        writeln!(std::io::stderr(), "albedo {r:.4} {g:.4} {b:.4}")?;
        Ok(())
    }
}
