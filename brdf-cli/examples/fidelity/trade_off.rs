//! Error against bytes, drawn.

use std::path::Path;

use brdf_plot::{Curves, Series, plot_log_log};

use crate::table::{Row, median_and_worst};

/// Panels beside each other of the plot of single materials.
const COLUMNS: usize = 3;

/// Writes a plot of the medians over some materials, and beside it, as `NAME-materials.svg`, one panel for each.
pub(crate) fn write_plots(path: &Path, materials: &[(String, &Vec<Row>)]) -> anyhow::Result<()> {
    let Some((_, first)) = materials.first() else { return Ok(()) };
    let median = |index: usize, of: fn(&Row) -> f64| {
        let values = materials.iter().map(|(_, rows)| of(&rows[index])).collect();
        median_and_worst(values).map_or(0.0, |(median, _)| median)
    };
    let medians = (0..first.len()).map(|index| {
        (first[index].family, (median(index, bytes), median(index, |row| row.fidelity.score())))
    });
    let title = format!("Median of {} RGL files", materials.len());
    std::fs::write(path, plot_log_log(&[panel(title, medians)], 1)?.svg())?;

    let panels: Vec<Curves> = materials
        .iter()
        .map(|(name, rows)| {
            let points = rows.iter().map(|row| (row.family, (bytes(row), row.fidelity.score())));
            panel(name.clone(), points)
        })
        .collect();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let beside = path.with_file_name(format!("{stem}-materials.svg"));
    std::fs::write(beside, plot_log_log(&panels, COLUMNS)?.svg())?;
    Ok(())
}

fn bytes(row: &Row) -> f64 {
    row.model.bytes() as f64
}

/// A panel with one line for each family, in the order in which they come.
fn panel<'a>(title: String, points: impl Iterator<Item = (&'a str, (f64, f64))>) -> Curves {
    let mut series: Vec<Series> = Vec::new();
    for (family, point) in points {
        match series.iter_mut().find(|series| series.label == family) {
            Some(series) => series.points.push(point),
            None => series.push(Series::new(family, vec![point])),
        }
    }
    Curves { title, x: "bytes".to_owned(), y: "J".to_owned(), series, ..Curves::default() }
}
