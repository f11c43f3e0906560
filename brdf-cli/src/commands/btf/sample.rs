//! `brdf btf sample`.

use std::io::Write;
use std::process::ExitCode;

use anyhow::bail;
use brdf_model::ScrambledSobol;
use brdf_param::spherical_direction;

use super::loading::{ModelArgs, texel_at};
use crate::args::TableArgs;

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
    #[arg(long, value_name = "THETA,PHI", value_parser = pair, allow_hyphen_values = true)]
    view_deg: [f64; 2],

    /// Number of directions
    #[arg(short = 'n', long = "samples", default_value_t = 10_000)]
    samples: u32,

    /// One place of the tile instead of all
    #[arg(long, value_name = "U,V", value_parser = pair, allow_hyphen_values = true)]
    at: Option<[f64; 2]>,

    /// Which scramble of the sequence
    #[arg(long, default_value_t = 1)]
    seed: u64,

    #[command(flatten)]
    table: TableArgs,
}

fn pair(text: &str) -> Result<[f64; 2], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|t| t.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([a, b]) if a.is_finite() && b.is_finite() => Ok([*a, *b]),
        _ => Err("expected two numbers, such as 45,0".to_owned()),
    }
}

impl Sample {
    pub(in crate::commands) fn run(self, out: &mut impl Write) -> anyhow::Result<ExitCode> {
        let [theta, phi] = self.view_deg;
        if !(0.0..90.0).contains(&theta) {
            bail!("--view-deg {theta},{phi}: expected a polar angle from 0 to below 90");
        }
        let model = self.model.open()?;
        let reader = model.reader()?;
        let wo = spherical_direction(theta.to_radians(), phi.to_radians());
        let (places, draws) = (ScrambledSobol::new(self.seed), ScrambledSobol::new(!self.seed));
        let mut table = String::from("theta_i_deg,phi_i_deg,pdf,r,g,b\n");
        let mut albedo = [0.0; 3];
        for index in 0..self.samples {
            let [u, v] = self.at.unwrap_or_else(|| places.planar_point(index));
            let texel = texel_at(reader.size(0), u, v);
            let sampler = reader.light_sampler(0, texel, wo);
            let [u1, u2] = draws.planar_point(index);
            let (wi, pdf) = sampler.sample(u1, u2);
            let value = reader.linear(0, texel, &reader.taps(wi, wo));
            let cosine = if model.cosine_included() { 1.0 } else { wi.z };
            for (sum, v) in albedo.iter_mut().zip(value) {
                let share = f64::from(v) * cosine / (pdf.max(1e-12) * std::f64::consts::PI);
                *sum += share / f64::from(self.samples);
            }
            let azimuth = wi.y.atan2(wi.x).to_degrees();
            let polar = wi.z.clamp(-1.0, 1.0).acos().to_degrees();
            let [r, g, b] = value;
            table.push_str(&format!("{polar},{azimuth},{pdf},{r},{g},{b}\n"));
        }
        self.table.write(&table, out)?;
        let [r, g, b] = albedo;
        writeln!(std::io::stderr(), "albedo {r:.4} {g:.4} {b:.4}")?;
        Ok(ExitCode::SUCCESS)
    }
}
