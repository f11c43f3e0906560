//! Anisotropic BRDFs on the UTIA grid.
//!
//! Source: Filip and Vávra 2014. The grid has, for each of both directions, the polar angles 0° to 75° in
//! steps of 15° and the azimuths 0° to 352.5° in steps of 7.5°.

use std::f64::consts::TAU;

use brdf_param::{DirectionPair, azimuth, polar_angle};

use crate::brdf::is_lit;
use crate::{Brdf, ModelError, Rgb};

/// An anisotropic BRDF as a table of 288 × 288 values, one row for each direction to the light and one
/// column for each direction to the viewer.
///
/// Values are interpolated linearly in all four angles. Beyond 75° there is no data:
/// [`Brdf::has_data`] is false there, and evaluation returns the value at 75°.
///
/// ```
/// use brdf_model::{Brdf, UtiaTable};
/// use brdf_param::DirectionPair;
///
/// let table = UtiaTable::new(vec![[0.1, 0.2, 0.3]; UtiaTable::SIDE * UtiaTable::SIDE])?;
/// let pair = DirectionPair::from_angles(0.3, 1.0, 0.6, 2.0);
/// assert!(table.has_data(&pair) && (table.eval(&pair).g - 0.2).abs() < 1e-6);
/// assert!(!table.has_data(&DirectionPair::from_angles(1.4, 1.0, 0.6, 2.0)));
/// # Ok::<(), brdf_model::ModelError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct UtiaTable {
    /// RGB in sr⁻¹ at index `(theta_i · 48 + phi_i) · 288 + theta_o · 48 + phi_o`.
    values: Vec<[f32; 3]>,
}

impl UtiaTable {
    /// Number of polar angles of each direction: 0°, 15°, … 75°.
    pub const THETAS: usize = 6;
    /// Number of azimuths of each direction: 0°, 7.5°, … 352.5°.
    pub const PHIS: usize = 48;
    /// Number of rows, and of columns, of the table: one for each polar angle and azimuth.
    pub const SIDE: usize = Self::THETAS * Self::PHIS;
    const THETA_STEP: f64 = 15.0;

    /// Returns the table of these values, in sr⁻¹.
    ///
    /// A row holds the values of one direction to the light, for all directions to the viewer. Both rows
    /// and columns are ordered by polar angle, then by azimuth: the index of a direction is
    /// `theta · 48 + phi`, and that of a value `light · 288 + viewer`.
    ///
    /// # Errors
    ///
    /// [`ModelError::TableSize`] for another number of values than 288²; [`ModelError::TableValue`]
    /// for a value that is not finite.
    pub fn new(values: Vec<[f32; 3]>) -> Result<Self, ModelError> {
        let expected = Self::SIDE * Self::SIDE;
        if values.len() != expected {
            return Err(ModelError::TableSize { table: "utia", expected, found: values.len() });
        }
        for (index, value) in values.iter().enumerate() {
            if let Some(&bad) = value.iter().find(|v| !v.is_finite()) {
                return Err(ModelError::TableValue {
                    table: "utia",
                    index,
                    value: bad.into(),
                    expected: "finite values",
                });
            }
        }
        Ok(Self { values })
    }

    fn nodes(direction: glam::DVec3) -> [(usize, f64); 4] {
        let (t0, t1, t) =
            span(polar_angle(direction).to_degrees() / Self::THETA_STEP, Self::THETAS);
        let turn = azimuth(direction).rem_euclid(TAU) / TAU * Self::PHIS as f64;
        let (p0, _, p) = span(turn, Self::PHIS + 1);
        let p1 = (p0 + 1) % Self::PHIS;
        let at = |theta: usize, phi: usize| theta * Self::PHIS + phi % Self::PHIS;
        [
            (at(t0, p0), (1.0 - t) * (1.0 - p)),
            (at(t0, p1), (1.0 - t) * p),
            (at(t1, p0), t * (1.0 - p)),
            (at(t1, p1), t * p),
        ]
    }
}

impl Brdf for UtiaTable {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        self.eval_unclamped(pair).map(|v| v.max(0.0))
    }

    fn eval_unclamped(&self, pair: &DirectionPair) -> Rgb {
        if !is_lit(pair) {
            return Rgb::BLACK;
        }
        let (incident, outgoing) = (Self::nodes(pair.wi), Self::nodes(pair.wo));
        let mut sum = Rgb::BLACK;
        for (row, weight_i) in incident {
            for (column, weight_o) in outgoing {
                let value = self.values[row * Self::SIDE + column].map(f64::from);
                sum = sum + Rgb::from(value) * (weight_i * weight_o);
            }
        }
        sum
    }

    fn has_data(&self, pair: &DirectionPair) -> bool {
        let limit = (75_f64 + 1e-9).to_radians().cos();
        is_lit(pair) && pair.wi.z.min(pair.wo.z) >= limit
    }
}

/// The nodes below and above a position ≥ 0 and the way between them; clamped to the last node.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positions are small and not negative"
)]
fn span(position: f64, count: usize) -> (usize, usize, f64) {
    let low = (position as usize).min(count - 1);
    let high = (low + 1).min(count - 1);
    (low, high, (position - low as f64).clamp(0.0, 1.0))
}
