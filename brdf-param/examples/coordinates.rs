//! Prints the coordinates of one pair of directions in every parametrization.
//!
//! ```sh
//! cargo run -p brdf-param --example coordinates            # a pair that is built in
//! cargo run -p brdf-param --example coordinates 30 0 45 90 # theta_i, phi_i, theta_o, phi_o in degrees
//! ```

#![allow(clippy::print_stdout, reason = "an example")]

use std::error::Error;

use brdf_param::{DirectionPair, Parametrization};

fn main() -> Result<(), Box<dyn Error>> {
    let given: Vec<f64> = std::env::args().skip(1).map(|a| a.parse()).collect::<Result<_, _>>()?;
    let degrees = match given[..] {
        [] => [30.0, 0.0, 45.0, 90.0],
        [theta_i, phi_i, theta_o, phi_o] => [theta_i, phi_i, theta_o, phi_o],
        _ => return Err("expected four angles in degrees: theta_i phi_i theta_o phi_o".into()),
    };
    let [theta_i, phi_i, theta_o, phi_o] = degrees.map(f64::to_radians);
    let pair = DirectionPair::from_angles(theta_i, phi_i, theta_o, phi_o);
    if !pair.is_above_horizon() {
        return Err("one of the directions lies below the horizon".into());
    }

    println!("wi = {:.4}, wo = {:.4}, half vector = {:.4}\n", pair.wi, pair.wo, pair.half());
    for parametrization in Parametrization::ALL {
        let coordinates = parametrization.forward(&pair);
        let axes = parametrization.axes();
        let listed: Vec<String> = axes
            .iter()
            .zip(coordinates.0.to_array())
            .map(|(axis, value)| format!("{axis} = {value:8.4}"))
            .collect();
        println!("{:16} {}", parametrization.name(), listed.join("  "));
        let back = parametrization.inverse(coordinates).ok_or("a pair has coordinates")?;
        let off = back.wi.distance(pair.wi).max(back.wo.distance(pair.wo));
        println!("{:16} the pair comes back to {off:.1e}", "");
    }
    Ok(())
}
