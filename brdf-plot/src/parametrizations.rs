//! Slices of one material under every parametrization, with isolines: figures 2 to 5 of Barla,
//! Belcour and Pacanowski 2015.

use brdf_model::Brdf;
use brdf_param::Parametrization;
use brdf_study::{STUDIED, Slice};

use crate::colours::TEST_FUNCTIONS;
use crate::error::PlotError;
use crate::heat::{Contours, Field, Heat, HeatScale, plot_heat};
use crate::plot::Plot;

/// Azimuths of the slices, degrees.
const AZIMUTHS: [f64; 7] = [0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0];
const SIZE: usize = 72;
const DECADES: f64 = 3.0;
/// Isolines of a material, evenly spread over the logarithm of its range.
const LEVELS: usize = 10;
/// Isolines of a test function, tenths of its range.
const TENTHS: usize = 9;

/// Plots slices of a material under every parametrization, with isolines: figures 2 to 5 of Barla, Belcour and
/// Pacanowski 2015.
///
/// Rows are parametrizations, columns azimuths from 0 to 180°; luminance is on a logarithm. Grey: no data.
///
/// # Errors
///
/// [`PlotError::Nothing`] for a material that is dark or unknown everywhere;
/// [`PlotError::Drawing`].
pub fn plot_parametrizations(name: &str, brdf: &dyn Brdf) -> Result<Plot, PlotError> {
    let mut panels = panels(|parametrization, azimuth| {
        let slice = Slice::sample(brdf, parametrization, azimuth, SIZE);
        (Some(Field { columns: SIZE, values: slice.values }), Vec::new())
    });
    panels[0].title = format!("{name} · {}", panels[0].title);
    let fields = || panels.iter().filter_map(|panel| panel.image.as_ref());
    if !fields().flat_map(|f| f.values.iter().flatten()).any(|v| *v > 0.0) {
        return Err(PlotError::Nothing { what: "the material is dark or unknown everywhere" });
    }
    let scale = HeatScale::log_over("luminance (1/sr)", fields(), DECADES);
    let [low, high] = scale.range.map(f64::log10);
    let levels = steps(LEVELS).map(|share| low + share * (high - low)).collect::<Vec<_>>();
    for panel in &mut panels {
        let Some(field) = &panel.image else { continue };
        let logs = field.values.iter().map(|v| v.map(|f| f.max(1e-30).log10())).collect();
        panel.contours.push(Contours {
            field: Field { columns: SIZE, values: logs },
            levels: levels.clone(),
            colour: [255, 255, 255],
        });
    }
    plot_heat(&panels, AZIMUTHS.len(), Some(&scale))
}

/// Plots the three test functions of Barla, Belcour and Pacanowski 2015 under every parametrization, each as
/// isolines in tenths of its range: specular red, Fresnel black, grazing blue.
///
/// # Errors
///
/// [`PlotError::Drawing`].
pub fn plot_test_functions() -> Result<Plot, PlotError> {
    let mut panels = panels(|parametrization, azimuth| {
        let lines = TEST_FUNCTIONS.map(|(function, colour)| {
            let slice = Slice::sample(&function, parametrization, azimuth, SIZE);
            let field = Field { columns: SIZE, values: slice.values };
            Contours { field, levels: steps(TENTHS).collect(), colour }
        });
        (None, lines.into())
    });
    panels[0].title = format!("S red, F black, G blue · {}", panels[0].title);
    plot_heat(&panels, AZIMUTHS.len(), None)
}

/// `count` shares strictly between 0 and 1.
fn steps(count: usize) -> impl Iterator<Item = f64> {
    (1..=count).map(move |step| step as f64 / (count + 1) as f64)
}

/// A panel for each parametrization and azimuth.
fn panels(content: impl Fn(Parametrization, f64) -> (Option<Field>, Vec<Contours>)) -> Vec<Heat> {
    STUDIED
        .into_iter()
        .flat_map(|parametrization| AZIMUTHS.map(|azimuth| (parametrization, azimuth)))
        .map(|(parametrization, azimuth)| {
            let ([x, y], extent) = Slice::axes(parametrization);
            let (image, contours) = content(parametrization, azimuth.to_radians());
            Heat {
                title: format!("{}, {azimuth}°", parametrization.name()),
                x: x.to_owned(),
                y: y.to_owned(),
                extent: [extent; 2],
                image,
                contours,
            }
        })
        .collect()
}
