//! Where a model's log error lies: by the angle of the half vector, at values that are 0, by channel.
//!
//! ```sh
//! brdf factor FILE --method search -o out
//! cargo run --release -p brdf-cli --example error_shares -- FILE out/model.safetensors
//! ```
//!
//! The pairs are those that errors on held-out pairs are measured on.

#![expect(clippy::print_stdout, reason = "an example prints")]

use anyhow::Context as _;
use brdf_container::MaterialFile;
use brdf_factor::FactorParams;
use brdf_io::ReadOptions;
use brdf_model::{PairSampling, SampleSet, ScrambledSobol, log_offsets};
use brdf_param::polar_angle;

/// Upper ends of the bands of θh, degrees.
const BANDS: [f64; 5] = [5.0, 10.0, 20.0, 40.0, 90.0];
const PAIRS: u32 = 20_000;
const FITTED_PAIRS: u32 = 45_000;

/// Numbers of values, and sums over them.
#[derive(Clone, Copy, Default)]
struct Sums {
    values: usize,
    /// Values that are 0 in the reference.
    zeros: usize,
    /// Squared log errors of all, and of those.
    error: f64,
    zero_error: f64,
    /// Log errors with their signs: where the model is too bright, above 0.
    signed: f64,
}

impl Sums {
    fn add(&mut self, value: f64, residual: f64) {
        let square = residual * residual;
        self.values += 1;
        self.error += square;
        self.signed += residual;
        if value <= 0.0 {
            self.zeros += 1;
            self.zero_error += square;
        }
    }

    fn line(&self, name: &str, all: &Self) {
        let percent = |part: f64, whole: f64| 100.0 * part / whole.max(f64::MIN_POSITIVE);
        let count = self.values.max(1) as f64;
        println!(
            "{name:12} {:6.1} % {:9.1} % {:11.3} {:11.3} {:7.1} % {:9.1} %",
            percent(self.values as f64, all.values as f64),
            percent(self.error, all.error),
            self.error / count,
            self.signed / count,
            percent(self.zeros as f64, count),
            percent(self.zero_error, self.error),
        );
    }
}

fn main() -> anyhow::Result<()> {
    let mut words = std::env::args().skip(1);
    let (reference, model) = words.next().zip(words.next()).context("REFERENCE MODEL")?;
    let open = |source: &str| MaterialFile::open(source, &ReadOptions::default());
    let (reference, model) = (open(&reference)?, open(&model)?);
    let channels = model.channels();
    let theta_max = FactorParams::default().theta_max;
    let seed = ScrambledSobol::held_out_seed(1);
    let draw = |count, seed| {
        let sampling = PairSampling { count, seed, theta_max };
        SampleSet::draw(reference.brdf(), &sampling, channels)
    };
    let samples = draw(PAIRS, seed);
    // Of the fitted pairs: with a mirror-like peak the mean of others may be quite another.
    let offsets = log_offsets(&draw(FITTED_PAIRS, 1));

    let mut bands = [Sums::default(); BANDS.len()];
    let mut each = [Sums::default(); 3];
    let mut all = Sums::default();
    for (index, pair) in samples.pairs().enumerate() {
        let theta_h = polar_angle(pair.half()).to_degrees();
        let band = BANDS.iter().position(|end| theta_h < *end).unwrap_or(BANDS.len() - 1);
        let predicted = model.brdf().eval_unclamped(&pair);
        let predicted = match offsets.len() {
            1 => [predicted.luminance(), 0.0, 0.0],
            _ => predicted.channels(),
        };
        for (channel, a) in offsets.iter().enumerate() {
            let value = samples.values()[channel][index];
            let shifted = a + predicted[channel];
            let shifted = if shifted > 0.0 { shifted } else { *a };
            let residual = shifted.ln() - (a + value).ln();
            all.add(value, residual);
            each[channel].add(value, residual);
            bands[band].add(value, residual);
        }
    }
    println!("{}: {} pairs", reference.short_name(), samples.len());
    println!("               values   log error mean square  mean error   zeros  error there");
    all.line("all", &all);
    let mut begin = 0.0;
    for (end, sums) in BANDS.iter().zip(&bands) {
        sums.line(&format!("θh {begin}–{end}°"), &all);
        begin = *end;
    }
    for (name, sums) in ["red", "green", "blue"].iter().zip(&each[..offsets.len()]) {
        sums.line(if offsets.len() == 1 { "luminance" } else { name }, &all);
    }
    Ok(())
}
