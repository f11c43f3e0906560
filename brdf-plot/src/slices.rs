//! θh × θd slices at chosen azimuths: the picture that measured BRDFs are judged by.

use brdf_model::Brdf;
use brdf_param::Parametrization;
use brdf_study::Slice;

use crate::error::PlotError;
use crate::heat::{Field, Heat, HeatScale, plot_heat};
use crate::plot::Plot;

/// Cells of a slice along a side.
const SIZE: usize = 90;
/// Decades of luminance that colours span at most.
const DECADES: f64 = 4.0;

/// Plots luminance over two coordinates of a parametrization: a row of panels for each material, a panel for each
/// azimuth in degrees.
///
/// Colours are on a logarithm. Grey: no data.
///
/// ```
/// use brdf_model::{Brdf, Preset};
/// use brdf_param::Parametrization;
///
/// let plastic = Preset::find("plastic").expect("a built-in material").brdf();
/// let materials = [("plastic".to_owned(), &plastic as &dyn Brdf)];
/// let plot = brdf_plot::plot_slices(&materials, Parametrization::HalfDifference, &[90.0])?;
/// assert!(plot.svg().contains("plastic, 90°"));
/// # Ok::<(), brdf_plot::PlotError>(())
/// ```
///
/// # Errors
///
/// [`PlotError::Nothing`] without a material or azimuth; [`PlotError::Drawing`].
pub fn plot_slices(
    materials: &[(String, &dyn Brdf)],
    parametrization: Parametrization,
    azimuths_deg: &[f64],
) -> Result<Plot, PlotError> {
    let ([x, y], extent) = Slice::axes(parametrization);
    let panels: Vec<Heat> = materials
        .iter()
        .flat_map(|(name, brdf)| {
            azimuths_deg.iter().enumerate().map(move |(column, &azimuth)| {
                let slice = Slice::sample(*brdf, parametrization, azimuth.to_radians(), SIZE);
                let [_, _, angle] = parametrization.isotropic_names();
                Heat {
                    title: if column == 0 {
                        format!("{}, {azimuth}°", shortened(name))
                    } else {
                        format!("{angle} = {azimuth}°")
                    },
                    x: x.to_owned(),
                    y: y.to_owned(),
                    extent: [extent; 2],
                    image: Some(Field { columns: SIZE, values: slice.values }),
                    contours: Vec::new(),
                }
            })
        })
        .collect();
    let fields = panels.iter().filter_map(|panel| panel.image.as_ref());
    let scale = HeatScale::log_over("luminance (1/sr)", fields, DECADES);
    plot_heat(&panels, azimuths_deg.len(), Some(&scale))
}

/// Names longer than a panel would run into the next.
const LONGEST_NAME: usize = 24;

fn shortened(name: &str) -> String {
    if name.chars().count() <= LONGEST_NAME {
        return name.to_owned();
    }
    name.chars().take(LONGEST_NAME - 1).chain(['…']).collect()
}
