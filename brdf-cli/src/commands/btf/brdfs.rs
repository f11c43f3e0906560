//! BRDFs as textures of one texel.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use brdf_io::ReadOptions;
use brdf_model::{Brdf, Rgb};
use brdf_param::DirectionPair;
use btf_vq::NodeTable;
use glam::DVec3;

use crate::subject::Subject;

/// Bytes of a raw BRDF: 90 × 90 × 180 × 3 numbers of four, as the paper counts.
pub(super) const RAW_BYTES: u64 = 90 * 90 * 180 * 3 * 4;
/// Least height of a direction at which a BRDF is asked for: on the horizon itself there are no data.
const HORIZON: f64 = 1e-3;

/// Whether an input names a BRDF, or an archive of them, rather than images.
pub(super) fn is_brdf(path: &Path) -> bool {
    let is = |name: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(name));
    let is_preset = path.to_string_lossy().starts_with("preset:");
    is_preset
        || path.to_string_lossy().contains(".npz:")
        || (path.is_file() && !is("zip") && !is("btf"))
}

/// All materials that an input names.
pub(super) fn open_brdfs(path: &Path) -> anyhow::Result<Vec<Subject>> {
    Subject::open_all(&path.to_string_lossy(), &ReadOptions::default())
}

/// What the texture of a BRDF is called: its file or material, without folders and ending.
pub(super) fn texture_name(subject: &Subject) -> String {
    let name = subject.short_name();
    Path::new(&name).file_stem().map_or(name.clone(), |stem| stem.to_string_lossy().into_owned())
}

/// Adds the cosine-weighted radiance of a BRDF under irradiance π to a table. Returns a note where
/// there was something to say.
pub(super) fn tabulate(table: &mut NodeTable, brdf: &dyn Brdf) -> anyhow::Result<Option<String>> {
    let without_data = AtomicU64::new(0);
    let clamped = table.push(|wi, wo| {
        let pair = DirectionPair::new(above_horizon(wi), above_horizon(wo));
        without_data.fetch_add(u64::from(!brdf.has_data(&pair)), Ordering::Relaxed);
        brdf.eval_unclamped(&pair).channels().map(|f| narrow(f * PI * wi.z))
    })?;
    let note = match (clamped, without_data.into_inner()) {
        (0, 0) => None,
        (clamped, 0) => Some(format!("{clamped} negative nodes set to 0")),
        (clamped, holes) => {
            Some(format!("{holes} pairs without data, {clamped} negative nodes set to 0"))
        }
    };
    Ok(note)
}

#[expect(clippy::cast_possible_truncation, reason = "tables are f32")]
fn narrow(value: f64) -> f32 {
    value as f32
}

fn above_horizon(direction: DVec3) -> DVec3 {
    DVec3::new(direction.x, direction.y, direction.z.max(HORIZON)).normalize()
}

/// A BRDF by its radiance under irradiance π.
pub(super) struct RadianceBrdf<F> {
    /// Of unit directions to the light and to the viewer.
    pub(super) radiance: F,
    /// Whether it contains the cosine of the light's polar angle.
    pub(super) cosine_included: bool,
}

impl<F: Fn(DVec3, DVec3) -> [f32; 3] + Sync> Brdf for RadianceBrdf<F> {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        if pair.wi.z <= 0.0 || pair.wo.z <= 0.0 {
            return Rgb::BLACK;
        }
        let cosine = if self.cosine_included { pair.wi.z } else { 1.0 };
        let radiance = (self.radiance)(pair.wi, pair.wo);
        Rgb::from(radiance.map(|v| f64::from(v.max(0.0)) / (PI * cosine)))
    }
}
