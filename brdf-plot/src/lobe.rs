//! Three-dimensional lobes.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use brdf_model::Brdf;
use brdf_param::{DirectionPair, spherical_direction};
use glam::DVec3;
use plotters::prelude::*;

use crate::colours::{INK, heat};
use crate::curves::short;
use crate::error::{PlotError, drawing};
use crate::plot::{Plot, Sheet, on_sheet};

const PANEL: i32 = 560;
/// Patches of the surface along the polar angle and around.
const POLAR: u32 = 60;
const AROUND: u32 = 120;
/// Where the viewer of the plot stands: degrees around the normal and above the surface.
const VIEW_DEG: (f64, f64) = (60.0, 25.0);

/// Plots lobes in three dimensions, one for each incidence in degrees.
///
/// A lobe is the surface whose distance from the centre is the cube root of the luminance, shaded by it. The light,
/// an arrow, stands at azimuth 180°. Gaps: no data.
///
/// # Errors
///
/// [`PlotError::Nothing`] where nothing is reflected; [`PlotError::Drawing`].
pub fn plot_lobes(name: &str, brdf: &dyn Brdf, incidences_deg: &[f64]) -> Result<Plot, PlotError> {
    let surfaces: Vec<Vec<Patch>> =
        incidences_deg.iter().map(|theta| surface(brdf, theta.to_radians())).collect();
    let corners = surfaces.iter().flatten().flat_map(|patch| patch.corners);
    let largest = corners.map(|corner| corner.length()).fold(0.0_f64, f64::max);
    if largest <= 0.0 {
        return Err(PlotError::Nothing { what: "nothing is reflected" });
    }
    let count = i32::try_from(incidences_deg.len()).unwrap_or(1);
    let size = ((PANEL * count).unsigned_abs(), PANEL.unsigned_abs());
    on_sheet(size, |sheet, _| {
        for (index, (patches, incidence)) in surfaces.into_iter().zip(incidences_deg).enumerate() {
            let left = PANEL * i32::try_from(index).unwrap_or(0);
            draw(sheet, left, patches, largest, incidence.to_radians())?;
            let title = format!(
                "{name}, theta_i = {incidence}°, radius: cube root, rim {} 1/sr",
                short(largest.powi(3))
            );
            let style = ("sans-serif", 18).into_font().color(&INK);
            sheet.draw(&Text::new(title, (left + 10, 8), style)).map_err(|e| drawing(&e))?;
        }
        Ok(())
    })
}

struct Patch {
    corners: [DVec3; 4],
    radius: f64,
}

impl Patch {
    /// Brighter where the surface faces the viewer.
    fn shade(&self, towards: DVec3) -> f64 {
        let [a, b, c, d] = self.corners;
        let normal = (c - a).cross(d - b).normalize_or_zero();
        0.55 + 0.45 * normal.dot(towards).abs()
    }
}

fn surface(brdf: &dyn Brdf, theta_i: f64) -> Vec<Patch> {
    let at = |polar: u32, around: u32| {
        // The horizon itself reflects nothing.
        let theta = (FRAC_PI_2 - 1e-4) * f64::from(polar) / f64::from(POLAR);
        let phi = TAU * f64::from(around) / f64::from(AROUND);
        let pair = DirectionPair::from_angles(theta_i, PI, theta, phi);
        brdf.has_data(&pair)
            .then(|| brdf.eval(&pair).luminance().cbrt() * spherical_direction(theta, phi))
    };
    let patches = (0..POLAR).flat_map(|polar| (0..AROUND).map(move |around| (polar, around)));
    patches
        .filter_map(|(polar, around)| {
            let corners = [
                at(polar, around)?,
                at(polar + 1, around)?,
                at(polar + 1, around + 1)?,
                at(polar, around + 1)?,
            ];
            let radius = corners.iter().map(|c| c.length()).sum::<f64>() / 4.0;
            Some(Patch { corners, radius })
        })
        .collect()
}

fn draw(
    sheet: &Sheet<'_>,
    left: i32,
    mut patches: Vec<Patch>,
    largest: f64,
    theta_i: f64,
) -> Result<(), PlotError> {
    let (around, above) = (VIEW_DEG.0.to_radians(), VIEW_DEG.1.to_radians());
    let towards = DVec3::new(-around.sin() * above.cos(), -around.cos() * above.cos(), above.sin());
    let right = DVec3::Z.cross(towards).normalize();
    let up = towards.cross(right);
    #[expect(clippy::cast_possible_truncation, reason = "units of a small panel")]
    let project = |p: DVec3| {
        let scale = 0.44 * f64::from(PANEL);
        let x = 0.5 * f64::from(PANEL) + scale * p.dot(right);
        let y = 0.72 * f64::from(PANEL) - scale * p.dot(up);
        (left + x as i32, y as i32)
    };
    // The unit circle of the surface, then patches from the far side to the near one.
    let circle: Vec<(i32, i32)> = (0..=72)
        .map(|step| project(spherical_direction(FRAC_PI_2, TAU * f64::from(step) / 72.0)))
        .collect();
    sheet.draw(&PathElement::new(circle, INK.mix(0.5))).map_err(|e| drawing(&e))?;
    let depth = |patch: &Patch| patch.corners.iter().sum::<DVec3>().dot(towards);
    patches.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
    for patch in &patches {
        let corners: Vec<(i32, i32)> =
            patch.corners.iter().map(|&corner| project(corner / largest)).collect();
        let shade = patch.shade(towards);
        let [r, g, b, _] = heat(patch.radius / largest);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a byte")]
        let [r, g, b] = [r, g, b].map(|v| (f64::from(v) * shade) as u8);
        let colour = RGBColor(r, g, b);
        // The outline closes the seams that smoothed edges leave.
        let outline: Vec<(i32, i32)> = corners.iter().chain(&corners[..1]).copied().collect();
        sheet.draw(&Polygon::new(corners, colour.filled())).map_err(|e| drawing(&e))?;
        sheet.draw(&PathElement::new(outline, colour.stroke_width(1))).map_err(|e| drawing(&e))?;
    }
    let light = spherical_direction(theta_i, PI);
    let ray = vec![project(light), project(0.75 * light)];
    sheet.draw(&PathElement::new(ray, INK.stroke_width(3))).map_err(|e| drawing(&e))
}
