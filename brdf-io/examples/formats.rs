//! Writes a built-in material as a MERL file and as a table, and reads both back by their content.
//!
//! `cargo run -p brdf-io --example formats`
#![allow(clippy::print_stdout, reason = "an example")]

use brdf_io::{FormatError, ReadOptions, read, write_merl, write_samples};
use brdf_model::{Brdf, Channels, MerlTable, PairSampling, Preset, SampleSet};
use brdf_param::DirectionPair;

fn main() -> Result<(), FormatError> {
    let paint = Preset::ALL[0].brdf();
    let sampling = PairSampling { count: 2000, seed: 1, theta_max: 80_f64.to_radians() };
    let files = [
        write_merl(&MerlTable::tabulate(&paint)),
        write_samples(&SampleSet::draw(&paint, &sampling, Channels::Rgb)).into_bytes(),
    ];
    let pair = DirectionPair::from_angles(0.5, 0.0, 0.7, 2.5);
    println!("the formula: {:.4} sr⁻¹ in green", paint.eval(&pair).g);
    for bytes in &files {
        let measurement = read(bytes, &ReadOptions::default())?;
        let value = measurement.measured.brdf().eval(&pair).g;
        println!("{}, {} bytes: {value:.4} sr⁻¹", measurement.format.name(), measurement.bytes);
        for note in &measurement.notes {
            println!("  {note}");
        }
    }
    // A damaged file is refused with its place and what was expected.
    if let Err(error) = read(&files[0][..1000], &ReadOptions::default()) {
        println!("the first 1000 bytes: {error}");
    }
    Ok(())
}
