//! Eigenpairs of the relighting paper's matrix, and what its power iteration makes of them.
//!
//! `cargo run --release -p brdf-separable --example eigenpairs`

#![expect(clippy::print_stdout, reason = "an example shows its result")]

use std::time::Instant;

use brdf_model::{Channels, Preset};
use brdf_param::{HemisphereMap, Parametrization};
use brdf_separable::{
    BrdfMatrix, HemisphereGrid, KrylovParams, Layout, MatrixParams, SeparableError,
    power_iteration, top_eigenpairs,
};

fn main() -> Result<(), SeparableError> {
    let brdf = Preset::find("ashikhmin-shirley").expect("a preset").brdf();
    let chart = HemisphereGrid::Plane { map: HemisphereMap::OrthographicDisc, resolution: 48 };
    let layout = Layout::new(Parametrization::Standard, chart, chart);
    let params = MatrixParams { channels: Channels::Luminance, ..MatrixParams::default() };
    let matrix = BrdfMatrix::sample(&brdf, &layout, &params)?;
    let values = matrix.channel(0);
    for rank in [4, 8] {
        let start = Instant::now();
        let pairs =
            top_eigenpairs(values.as_ref(), &KrylovParams { rank, ..KrylovParams::default() })?;
        println!(
            "{rank} wanted, {} found, {} products, {:.1} ms",
            pairs.values.len(),
            pairs.products,
            1e3 * start.elapsed().as_secs_f64()
        );
        for (value, residual) in pairs.values.iter().zip(&pairs.residuals) {
            println!("  {value:9.3}  residual {residual:.1e}");
        }
    }
    println!("power iteration, as printed");
    for pair in power_iteration(values.as_ref(), 8, 1) {
        println!("  {:9.3}  residual {:.1e}, {} steps", pair.value, pair.residual, pair.iterations);
    }
    Ok(())
}
