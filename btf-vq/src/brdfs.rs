//! BRDFs as textures of one texel: linear radiance under irradiance π, with the light's cosine.

use std::f64::consts::PI;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

use brdf_model::{Brdf, Rgb};
use brdf_param::DirectionPair;
use glam::DVec3;

use crate::error::VqError;
use crate::texels::NodeTable;

/// Bytes of a raw BRDF: 90 × 90 × 180 × 3 numbers of four bytes, as the paper counts.
pub const RAW_BRDF_BYTES: u64 = 90 * 90 * 180 * 3 * 4;
/// Least height of a direction at which a BRDF is asked for: on the horizon itself there are no data.
const HORIZON: f64 = 1e-3;

/// Counts of what was changed while a BRDF was tabulated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tabulated {
    /// Pairs of directions that the BRDF has no data for.
    pub without_data: u64,
    /// Nodes that came out negative and were set to 0.
    pub clamped: u64,
}

impl fmt::Display for Tabulated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.without_data > 0 {
            write!(f, "{} pairs without data, ", self.without_data)?;
        }
        write!(f, "{} negative nodes set to 0", self.clamped)
    }
}

/// Adds a BRDF to a table as one texel, and returns what was changed.
///
/// ```
/// use btf_vq::{AngularGrid, NodeTable, tabulate};
///
/// let grey = brdf_model::Preset::find("lambert").expect("a built-in material").brdf();
/// let mut table = NodeTable::new(AngularGrid { phis: 1, ..AngularGrid::default() })?;
/// let changed = tabulate(&mut table, &grey)?;
/// assert_eq!((table.len(), changed.without_data, changed.clamped), (1, 0, 0));
/// # Ok::<(), btf_vq::VqError>(())
/// ```
///
/// # Errors
///
/// [`VqError::NotFinite`].
pub fn tabulate(table: &mut NodeTable, brdf: &dyn Brdf) -> Result<Tabulated, VqError> {
    let without_data = AtomicU64::new(0);
    let clamped = table.push(|wi, wo| {
        let pair = DirectionPair::new(above_horizon(wi), above_horizon(wo));
        without_data.fetch_add(u64::from(!brdf.has_data(&pair)), Ordering::Relaxed);
        brdf.eval_unclamped(&pair).channels().map(|f| narrow(f * PI * wi.z))
    })?;
    Ok(Tabulated { without_data: without_data.into_inner(), clamped })
}

#[expect(clippy::cast_possible_truncation, reason = "tables are f32")]
fn narrow(value: f64) -> f32 {
    value as f32
}

fn above_horizon(direction: DVec3) -> DVec3 {
    DVec3::new(direction.x, direction.y, direction.z.max(HORIZON)).normalize()
}

/// A [`Brdf`] made from a function that returns radiance under irradiance π, such as a texel of a BTF.
///
/// ```
/// use brdf_model::Brdf as _;
/// use brdf_param::DirectionPair;
///
/// let white = btf_vq::RadianceBrdf { radiance: |_, _| [1.0; 3], cosine_included: false };
/// let value = white.eval(&DirectionPair::from_angles(0.3, 0.0, 0.5, 1.0));
/// assert!((value.g - std::f64::consts::FRAC_1_PI).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct RadianceBrdf<F> {
    /// Linear RGB for unit directions to the light and to the viewer, in this order.
    pub radiance: F,
    /// Whether it contains the cosine of the light's polar angle.
    pub cosine_included: bool,
}

impl<F: Fn(DVec3, DVec3) -> [f32; 3] + Send + Sync> Brdf for RadianceBrdf<F> {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        if pair.wi.z <= 0.0 || pair.wo.z <= 0.0 {
            return Rgb::BLACK;
        }
        let cosine = if self.cosine_included { pair.wi.z } else { 1.0 };
        let radiance = (self.radiance)(pair.wi, pair.wo);
        Rgb::from(radiance.map(|v| f64::from(v.max(0.0)) / (PI * cosine)))
    }
}
