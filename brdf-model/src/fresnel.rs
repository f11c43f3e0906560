//! Unpolarized Fresnel reflectance.

use serde::{Deserialize, Serialize};

use crate::Rgb;

/// A smooth interface with air, whose Fresnel reflectance is known.
///
/// ```
/// use brdf_model::Fresnel;
///
/// let glass = Fresnel::Dielectric { ior: 1.5 };
/// assert!((glass.reflectance(1.0).g - 0.04).abs() < 1e-12);
/// assert!((glass.reflectance(0.0).g - 1.0).abs() < 1e-12, "everything is reflected at grazing");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Fresnel {
    /// A dielectric of this index of refraction against air.
    Dielectric {
        /// Index of refraction, > 0.
        ior: f64,
    },
    /// A conductor of complex index of refraction η + ik, for each channel.
    Conductor {
        /// Real part η of the index.
        eta: Rgb,
        /// Imaginary part k of the index.
        k: Rgb,
    },
}

impl Fresnel {
    /// Returns the reflectance at an angle of incidence with this cosine, [0, 1] for each channel.
    pub fn reflectance(&self, cos_theta: f64) -> Rgb {
        match *self {
            Self::Dielectric { ior } => Rgb::splat(dielectric_reflectance(cos_theta, ior)),
            Self::Conductor { eta, k } => {
                eta.zip(k, |eta, k| conductor_reflectance(cos_theta, eta, k))
            }
        }
    }
}

/// Returns the exact unpolarized reflectance of a dielectric entered from air; 1 under total reflection.
pub fn dielectric_reflectance(cos_theta: f64, ior: f64) -> f64 {
    let sin_sq = 1.0 - cos_theta * cos_theta;
    let refracted_sq = 1.0 - sin_sq / (ior * ior);
    if refracted_sq <= 0.0 {
        return 1.0;
    }
    let cos_refracted = refracted_sq.sqrt();
    let parallel = (ior * cos_theta - cos_refracted) / (ior * cos_theta + cos_refracted);
    let perpendicular = (cos_theta - ior * cos_refracted) / (cos_theta + ior * cos_refracted);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// Returns the exact unpolarized reflectance of a conductor with complex index `eta` + i `k` in air.
pub fn conductor_reflectance(cos_theta: f64, eta: f64, k: f64) -> f64 {
    let cos_sq = cos_theta * cos_theta;
    let sin_sq = 1.0 - cos_sq;
    let difference = eta * eta - k * k - sin_sq;
    let a_sq_plus_b_sq = difference.hypot(2.0 * eta * k);
    let a = (0.5 * (a_sq_plus_b_sq + difference)).max(0.0).sqrt();
    let perpendicular = (a_sq_plus_b_sq + cos_sq - 2.0 * a * cos_theta)
        / (a_sq_plus_b_sq + cos_sq + 2.0 * a * cos_theta);
    let across = a_sq_plus_b_sq * cos_sq + sin_sq * sin_sq;
    let along = 2.0 * a * cos_theta * sin_sq;
    let parallel = perpendicular * (across - along) / (across + along);
    0.5 * (perpendicular + parallel)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        for step in 0..=20 {
            let cos_theta = f64::from(step) / 20.0;
            let exact = dielectric_reflectance(cos_theta, 1.5);
            let conductor = conductor_reflectance(cos_theta, 1.5, 0.0);
            assert!((exact - conductor).abs() < 1e-12, "{cos_theta}: {exact} against {conductor}");
        }
    }

    #[test]
    fn normal_incidence_on_glass_reflects_four_percent() {
        assert!((dielectric_reflectance(1.0, 1.5) - 0.04).abs() < 1e-15);
        assert!((dielectric_reflectance(0.0, 1.5) - 1.0).abs() < 1e-15);
    }
}
