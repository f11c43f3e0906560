//! Textures beside each other.

use brdf_image::DisplayImage;
use plotters::prelude::*;

use crate::colours::INK;
use crate::error::{PlotError, drawing};
use crate::plot::{Bitmap, Plot, on_sheet};

const SIDE: i32 = 160;
const GAP: i32 = 14;
const CAPTION: i32 = 22;

/// Plots pictures with a caption above each, `columns` side by side.
///
/// ```
/// let picture = brdf_image::DisplayImage::filled(8, 8, [200, 90, 60]);
/// let plot = brdf_plot::plot_textures(&[("factor 0".to_owned(), picture)], 1)?;
/// assert!(plot.svg().contains("factor 0"));
/// # Ok::<(), brdf_plot::PlotError>(())
/// ```
///
/// # Errors
///
/// [`PlotError::Nothing`] without a picture; [`PlotError::Drawing`].
pub fn plot_textures(
    pictures: &[(String, DisplayImage)],
    columns: usize,
) -> Result<Plot, PlotError> {
    if pictures.is_empty() {
        return Err(PlotError::Nothing { what: "no textures" });
    }
    let int = |count: usize| i32::try_from(count).unwrap_or(1);
    let columns = columns.clamp(1, pictures.len());
    let rows = pictures.len().div_ceil(columns);
    let (step_x, step_y) = (SIDE + GAP, SIDE + CAPTION + GAP);
    let size =
        ((int(columns) * step_x + GAP).unsigned_abs(), (int(rows) * step_y + GAP).unsigned_abs());
    on_sheet(size, |sheet, bitmaps| {
        for (index, (caption, picture)) in pictures.iter().enumerate() {
            let left = GAP + int(index % columns) * step_x;
            let top = GAP + int(index / columns) * step_y;
            let style = ("sans-serif", 12).into_font().color(&INK);
            sheet.draw(&Text::new(caption.clone(), (left, top), style)).map_err(|e| drawing(&e))?;
            let rgb = picture.bytes().as_chunks::<3>().0;
            let height = if picture.height() < picture.width() / 2 { SIDE / 4 } else { SIDE };
            bitmaps.push(Bitmap {
                place: [left, top + CAPTION, SIDE, height],
                columns: picture.width(),
                rows: picture.height(),
                pixels: rgb.iter().flat_map(|[r, g, b]| [*r, *g, *b, 255]).collect(),
            });
        }
        Ok(())
    })
}
