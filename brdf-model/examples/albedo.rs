//! Prints how much light each built-in material reflects, and whether it obeys reciprocity.
//!
//! ```sh
//! cargo run --release -p brdf-model --example albedo
//! ```

#![allow(clippy::print_stdout, reason = "an example")]

use brdf_model::{Preset, anisotropy, check, directional_albedo};

fn main() {
    println!("directional albedo (luminance) for light at 0, 45 and 75 degrees from the normal\n");
    println!("{:22} {:>6} {:>6} {:>6}  notes", "material", "0", "45", "75");
    for preset in Preset::ALL {
        let brdf = preset.brdf();
        let albedos = [0.0, 45.0, 75.0_f64]
            .map(|degrees| directional_albedo(&brdf, degrees.to_radians()).luminance());
        let checks = check(&brdf, 80_f64.to_radians());
        let mut notes = vec![preset.description().to_owned()];
        if anisotropy(&brdf) > 1e-3 {
            notes.push("anisotropic".to_owned());
        }
        if checks.largest_albedo > 1.0 {
            notes.push(format!(
                "reflects more than arrives at {:.0} degrees",
                checks.largest_albedo_theta_deg
            ));
        }
        if checks.reciprocity_error > 1e-6 {
            notes.push(format!("reciprocity error {:.1e}", checks.reciprocity_error));
        }
        let [zero, half, grazing] = albedos;
        println!("{:22} {zero:6.3} {half:6.3} {grazing:6.3}  {}", preset.name(), notes.join("; "));
    }
}
