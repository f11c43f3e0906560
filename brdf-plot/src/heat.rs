//! Images over two axes, with isolines and a colour scale.

use contour::ContourBuilder;
use plotters::prelude::*;

use crate::axis::{Ticked, draw_axes};
use crate::colours::{INK, NO_DATA, heat};
use crate::curves::short;
use crate::error::{PlotError, drawing};
use crate::plot::{Bitmap, Plot, Sheet, on_sheet};

/// Values on a grid, row by row from the smallest y; `None` where there is no data.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Values in a row.
    pub columns: usize,
    /// The values.
    pub values: Vec<Option<f64>>,
}

impl Field {
    fn rows(&self) -> usize {
        self.values.len() / self.columns.max(1)
    }
}

/// Isolines of a field.
#[derive(Clone, Debug, PartialEq)]
pub struct Contours {
    /// The field, over the same axes as the image; its cells without data are left out.
    pub field: Field,
    /// Values of the lines.
    pub levels: Vec<f64>,
    /// Red, green and blue of the lines.
    pub colour: [u8; 3],
}

/// A panel of an image over two axes, with isolines.
#[derive(Clone, Debug, PartialEq)]
pub struct Heat {
    /// Title above the panel.
    pub title: String,
    /// Label of the x axis, with the unit.
    pub x: String,
    /// Label of the y axis, with the unit.
    pub y: String,
    /// Largest value of x and y; both begin at 0.
    pub extent: [f64; 2],
    /// Values shown as colours; `None` for isolines on white.
    pub image: Option<Field>,
    /// Isolines over the image.
    pub contours: Vec<Contours>,
}

/// The colour scale that all panels share.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatScale {
    /// Meaning of the colours, with the unit.
    pub label: String,
    /// Values of both ends.
    pub range: [f64; 2],
    /// Whether colours follow the logarithm.
    pub log: bool,
    /// Whether there are values below the range, which look like its lower end.
    pub clipped_below: bool,
}

impl HeatScale {
    /// Returns the scale over the values of fields, on a logarithm of at most `decades` below the largest.
    pub fn log_over<'a>(
        label: impl Into<String>,
        fields: impl IntoIterator<Item = &'a Field>,
        decades: f64,
    ) -> Self {
        let (mut low, mut high) = (f64::MAX, 0.0_f64);
        for value in fields.into_iter().flat_map(|f| f.values.iter().flatten()) {
            if *value > 0.0 {
                low = low.min(*value);
                high = high.max(*value);
            }
        }
        let high = if high > 0.0 { high } else { 1.0 };
        let shown = low.max(high * 10_f64.powf(-decades)).min(0.5 * high);
        let clipped_below = low < shown;
        Self { label: label.into(), range: [shown, high], log: true, clipped_below }
    }

    fn share(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        if self.log {
            (value.max(f64::MIN_POSITIVE) / low).ln() / (high / low).ln()
        } else {
            (value - low) / (high - low)
        }
    }

    /// Red, green and blue of a value.
    pub(crate) fn colour(&self, value: f64) -> [u8; 3] {
        let [r, g, b, _] = heat(self.share(value));
        [r, g, b]
    }

    fn value(&self, share: f64) -> f64 {
        let [low, high] = self.range;
        if self.log { low * (high / low).powf(share) } else { low + share * (high - low) }
    }
}

/// Units of a panel's image, and of the room around it.
const SIDE: i32 = 180;
const LEFT: i32 = 64;
const TOP: i32 = 28;
const BOTTOM: i32 = 46;
const RIGHT: i32 = 12;
/// Between axis labels and the next panel.
const EDGE: i32 = 6;
const BAR: i32 = 90;

/// Plots panels of images with a common colour scale, `columns` side by side.
///
/// ```
/// use brdf_plot::{Field, Heat, HeatScale, plot_heat};
///
/// let field = Field { columns: 2, values: vec![Some(0.1), Some(1.0), None, Some(10.0)] };
/// let scale = HeatScale::log_over("luminance (1/sr)", [&field], 4.0);
/// let panel = Heat {
///     title: "four cells".to_owned(),
///     x: "theta_h (°)".to_owned(),
///     y: "theta_d (°)".to_owned(),
///     extent: [90.0, 90.0],
///     image: Some(field),
///     contours: Vec::new(),
/// };
/// assert!(plot_heat(&[panel], 1, Some(&scale))?.svg().contains("four cells"));
/// # Ok::<(), brdf_plot::PlotError>(())
/// ```
///
/// # Errors
///
/// [`PlotError::Nothing`] without a panel; [`PlotError::Drawing`].
pub fn plot_heat(
    panels: &[Heat],
    columns: usize,
    scale: Option<&HeatScale>,
) -> Result<Plot, PlotError> {
    if panels.is_empty() {
        return Err(PlotError::Nothing { what: "no panels" });
    }
    let columns = columns.clamp(1, panels.len());
    let rows = panels.len().div_ceil(columns);
    let int = |count: usize| i32::try_from(count).unwrap_or(1);
    let (step_x, step_y) = (LEFT + SIDE + RIGHT, TOP + SIDE + BOTTOM);
    let width = int(columns) * step_x + if scale.is_some() { BAR } else { 0 };
    let height = int(rows) * step_y;
    let size = (width.unsigned_abs(), height.unsigned_abs());
    on_sheet(size, |sheet, bitmaps| {
        for (index, panel) in panels.iter().enumerate() {
            let corner = (int(index % columns) * step_x, int(index / columns) * step_y);
            panel.draw(sheet, bitmaps, corner, scale)?;
        }
        if let Some(scale) = scale {
            draw_bar(sheet, bitmaps, (int(columns) * step_x, TOP), scale)?;
        }
        Ok(())
    })
}

impl Heat {
    fn draw(
        &self,
        sheet: &Sheet<'_>,
        bitmaps: &mut Vec<Bitmap>,
        (left, top): (i32, i32),
        scale: Option<&HeatScale>,
    ) -> Result<(), PlotError> {
        let area = sheet.clone().shrink(
            (left, top),
            ((LEFT + SIDE + RIGHT).unsigned_abs(), (TOP + SIDE + BOTTOM).unsigned_abs()),
        );
        let mut chart = ChartBuilder::on(&area)
            .margin_top(TOP)
            .margin_left(EDGE)
            .margin_right(RIGHT)
            .margin_bottom(EDGE)
            .x_label_area_size(BOTTOM - EDGE)
            .y_label_area_size(LEFT - EDGE)
            .build_cartesian_2d(Ticked::up_to(self.extent[0]), Ticked::up_to(self.extent[1]))
            .map_err(|e| drawing(&e))?;
        area.draw(&Text::new(
            self.title.clone(),
            (LEFT, TOP / 2 - 4),
            ("sans-serif", 13).into_font().color(&INK),
        ))
        .map_err(|e| drawing(&e))?;
        if let (Some(field), Some(scale)) = (&self.image, scale) {
            let place = [left + LEFT, top + TOP, SIDE, SIDE];
            bitmaps.push(coloured(field, scale, place));
        }
        for contours in &self.contours {
            let [r, g, b] = contours.colour;
            let style = RGBColor(r, g, b).stroke_width(1);
            for line in contours.lines(self.extent)? {
                chart.draw_series(LineSeries::new(line, style)).map_err(|e| drawing(&e))?;
            }
        }
        draw_axes(&mut chart, &self.x, &self.y)
    }
}

impl Contours {
    /// Pieces of lines, each within cells that have data, in the units of the axes.
    pub(crate) fn lines(&self, extent: [f64; 2]) -> Result<Vec<Vec<(f64, f64)>>, PlotError> {
        let (columns, rows) = (self.field.columns, self.field.rows());
        let outside = self.levels.iter().copied().fold(f64::MAX, f64::min) - 1.0;
        let values: Vec<f64> = self.field.values.iter().map(|v| v.unwrap_or(outside)).collect();
        let lines = ContourBuilder::new(columns, rows, true)
            .lines(&values, &self.levels)
            .map_err(|e| drawing(&e))?;
        let (wide, high) = (columns as f64, rows as f64);
        let mut out = Vec::new();
        for line in lines.iter().flat_map(|contour| contour.geometry().0.iter()) {
            let mut piece = Vec::new();
            for point in &line.0 {
                if self.is_known(point.x, point.y) {
                    piece.push((point.x / wide * extent[0], point.y / high * extent[1]));
                } else if !piece.is_empty() {
                    out.push(std::mem::take(&mut piece));
                }
            }
            out.push(piece);
        }
        out.retain(|piece| piece.len() > 1);
        Ok(out)
    }

    /// The four cells around a point have data: lines along the rim of the data are not isolines.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "negative positions saturate at 0"
    )]
    fn is_known(&self, x: f64, y: f64) -> bool {
        let (columns, rows) = (self.field.columns, self.field.rows());
        // The library closes its lines along the rim of the grid.
        let on_rim = |at: f64, count: usize| at < 0.51 || at > count as f64 - 0.51;
        if on_rim(x, columns) || on_rim(y, rows) {
            return false;
        }
        let around = |at: f64, count: usize| {
            let low = (at - 0.501).floor().max(0.0) as usize;
            let high = (at - 0.499).ceil().max(0.0) as usize;
            (low.min(count - 1), high.min(count - 1))
        };
        let (left, right) = around(x, columns);
        let (below, above) = around(y, rows);
        [below, above]
            .iter()
            .all(|row| [left, right].iter().all(|c| self.field.values[row * columns + c].is_some()))
    }
}

fn coloured(field: &Field, scale: &HeatScale, place: [i32; 4]) -> Bitmap {
    let rows = field.rows();
    let pixels = (0..rows)
        .rev()
        .flat_map(|row| &field.values[row * field.columns..][..field.columns])
        .flat_map(|value| value.map_or(NO_DATA, |v| heat(scale.share(v))))
        .collect();
    Bitmap { place, columns: field.columns, rows, pixels }
}

const BAR_STEPS: usize = 128;

pub(crate) fn draw_bar(
    sheet: &Sheet<'_>,
    bitmaps: &mut Vec<Bitmap>,
    (left, top): (i32, i32),
    scale: &HeatScale,
) -> Result<(), PlotError> {
    let share = |step: usize| 1.0 - step as f64 / (BAR_STEPS - 1) as f64;
    let pixels = (0..BAR_STEPS).flat_map(|step| heat(share(step))).collect();
    let place = [left + 8, top, 14, SIDE];
    bitmaps.push(Bitmap { place, columns: 1, rows: BAR_STEPS, pixels });
    let text = ("sans-serif", 11).into_font().color(&INK);
    for tick in 0..=4 {
        let share = f64::from(tick) / 4.0;
        let at = top + SIDE - SIDE * tick / 4;
        let below = if tick == 0 && scale.clipped_below { "≤ " } else { "" };
        let value = format!("{below}{}", short(scale.value(share)));
        let label = Text::new(value, (left + 28, at - 6), text.clone());
        sheet.draw(&label).map_err(|e| drawing(&e))?;
    }
    let label = Text::new(scale.label.clone(), (left + 4, top - 20), text);
    sheet.draw(&label).map_err(|e| drawing(&e))
}
