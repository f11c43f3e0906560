//! Polar lobes in the plane of incidence.

use std::f64::consts::{FRAC_PI_2, PI};

use brdf_model::Brdf;
use brdf_param::DirectionPair;
use plotters::prelude::*;

use crate::colours::{FAINT, INK, series};
use crate::curves::short;
use crate::error::{PlotError, drawing};
use crate::plot::{Plot, on_sheet};

const SIZE: (u32, u32) = (1120, 600);
/// Half the range of x, so that a unit is as long as one of y.
const HALF_WIDTH: f64 = 1.236;
/// Steps from one horizon to the other.
const STEPS: u32 = 360;

/// Plots luminance over the direction to the viewer, in the plane of incidence, for each incidence in degrees.
///
/// The light comes from the left. The radius is the cube root of the value, so that gloss does not hide what is
/// matt. Gaps: no data.
///
/// ```
/// let plastic = brdf_model::Preset::find("plastic").expect("a built-in material").brdf();
/// let plot = brdf_plot::plot_polar("plastic", &plastic, &[30.0, 60.0])?;
/// assert!(plot.svg().contains("theta_i = 60°"));
/// # Ok::<(), brdf_plot::PlotError>(())
/// ```
///
/// # Errors
///
/// [`PlotError::Nothing`] where nothing is reflected; [`PlotError::Drawing`].
pub fn plot_polar(name: &str, brdf: &dyn Brdf, incidences_deg: &[f64]) -> Result<Plot, PlotError> {
    let lobes: Vec<Vec<Option<(f64, f64)>>> =
        incidences_deg.iter().map(|theta| lobe(brdf, theta.to_radians())).collect();
    let largest =
        lobes.iter().flatten().flatten().map(|(_, radius)| *radius).fold(0.0_f64, f64::max);
    if largest <= 0.0 {
        return Err(PlotError::Nothing { what: "nothing is reflected in this plane" });
    }
    on_sheet(SIZE, |sheet, _| {
        let mut chart = ChartBuilder::on(sheet)
            .margin(16)
            .caption(
                format!("{name}: luminance (1/sr), cube-root radius"),
                ("sans-serif", 24).into_font().color(&INK),
            )
            .build_cartesian_2d(-HALF_WIDTH..HALF_WIDTH, -0.1..1.12)
            .map_err(|e| drawing(&e))?;
        let text = ("sans-serif", 18).into_font().color(&INK);
        for ring in 1..=3 {
            let radius = f64::from(ring) / 3.0;
            let arc = (0..=90).map(|step| at(FRAC_PI_2 * (f64::from(step) / 45.0 - 1.0), radius));
            chart
                .draw_series(LineSeries::new(arc, FAINT.stroke_width(2)))
                .map_err(|e| drawing(&e))?;
            let label = short((radius * largest).powi(3));
            let place = (radius - 0.02, -0.03);
            chart.draw_series([Text::new(label, place, text.clone())]).map_err(|e| drawing(&e))?;
        }
        for degrees in (-90..=90).step_by(30) {
            let theta = f64::from(degrees).to_radians();
            let ray = [(0.0, 0.0), at(theta, 1.0)];
            chart
                .draw_series(LineSeries::new(ray, FAINT.stroke_width(2)))
                .map_err(|e| drawing(&e))?;
            let label = Text::new(format!("{degrees}°"), at(theta, 1.06), text.clone());
            chart.draw_series([label]).map_err(|e| drawing(&e))?;
        }
        for (index, (lobe, incidence)) in lobes.iter().zip(incidences_deg).enumerate() {
            let style = series(index).stroke_width(3);
            let pieces = lobe.split(Option::is_none).filter(|piece| !piece.is_empty());
            let mut labelled = false;
            for piece in pieces {
                let line = piece.iter().flatten().map(|&(theta, r)| at(theta, r / largest));
                let drawn =
                    chart.draw_series(LineSeries::new(line, style)).map_err(|e| drawing(&e))?;
                if !labelled {
                    labelled = true;
                    drawn
                        .label(format!("theta_i = {incidence}°"))
                        .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 24, y)], style));
                }
            }
            // Where the light comes from.
            let light = [at(-incidence.to_radians(), 1.0), at(-incidence.to_radians(), 0.9)];
            chart.draw_series(LineSeries::new(light, style)).map_err(|e| drawing(&e))?;
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE.mix(0.85))
            .label_font(("sans-serif", 20).into_font().color(&INK))
            .draw()
            .map_err(|e| drawing(&e))
    })
}

/// The point at an angle from the normal, mirror directions to the right.
fn at(theta: f64, radius: f64) -> (f64, f64) {
    (radius * theta.sin(), radius * theta.cos())
}

/// Angles and cube-root radii, from the light's side to the mirror's.
fn lobe(brdf: &dyn Brdf, theta_i: f64) -> Vec<Option<(f64, f64)>> {
    (1..STEPS)
        .map(|step| {
            let theta = PI * (f64::from(step) / f64::from(STEPS) - 0.5);
            // The light stands at azimuth π, negative angles with it.
            let pair = DirectionPair::from_angles(theta_i, PI, theta, 0.0);
            brdf.has_data(&pair).then(|| (theta, brdf.eval(&pair).luminance().cbrt()))
        })
        .collect()
}
