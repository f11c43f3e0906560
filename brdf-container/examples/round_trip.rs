//! Opens a material, fits it, and writes and reads the model back in memory.
//!
//! `cargo run --release -p brdf-container --example round_trip -- gold.binary`

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use brdf_container::{MaterialFile, kind_of, read_factored, write_factored};
use brdf_fit::{FactoredMethod, FactoredSettings, fit_factored};
use brdf_io::ReadOptions;
use brdf_job::Job;
use brdf_model::Brdf;
use brdf_param::DirectionPair;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let source = std::env::args().nth(1).unwrap_or_else(|| "preset:red-plastic".to_owned());
    let file = MaterialFile::open(&source, &ReadOptions::default())?;
    println!("{}: {}", file.short_name(), file.kind());

    let settings = FactoredSettings::of(FactoredMethod::McCool);
    let model = fit_factored(&file.material(), &settings, &Job::new())?.model();
    let bytes = write_factored(&model)?;
    println!("{} bytes hold {}", bytes.len(), kind_of(&bytes)?.name());

    let read = read_factored(&bytes)?;
    println!("read back, equal: {}", read == model);
    let pair = DirectionPair::from_angles(0.4, 0.0, 0.5, 2.8);
    println!("fitted {:?}", read.model.eval(&pair));
    println!("opened {:?}", file.brdf().eval(&pair));
    Ok(())
}
