//! The error against the number of textures, as SVG.

use brdf_io::TermRecord;
use plotters::prelude::*;

const SIZE: (u32, u32) = (560, 320);
const TRAINING: RGBColor = RGBColor(29, 78, 216);
const HELD_OUT: RGBColor = RGBColor(217, 119, 6);
const MCCOOL: RGBColor = RGBColor(82, 82, 91);

/// Mean square log errors over the number of textures, on a logarithmic scale: training, held out,
/// and McCool's model as a line; none where there are fewer than two models or an error is 0.
pub(crate) fn error_chart(terms: &[TermRecord], mccool: &TermRecord) -> Option<String> {
    let training: Vec<(f64, f64)> = terms
        .iter()
        .map(|term| at(term, Some(term.training.log.mean_square)))
        .collect::<Option<_>>()?;
    let held_out: Vec<(f64, f64)> = terms
        .iter()
        .filter_map(|term| at(term, term.held_out.as_ref().map(|e| e.log.mean_square)))
        .collect();
    let (_, baseline) = at(mccool, Some(mccool.training.log.mean_square))?;
    if training.len() < 2 {
        return None;
    }
    let errors = || training.iter().chain(&held_out).map(|p| p.1).chain([baseline]);
    let (low, high) = (errors().fold(f64::MAX, f64::min), errors().fold(0.0, f64::max));
    let (first, last) = (training[0].0, training[training.len() - 1].0);
    let mut svg = String::new();
    draw(&mut svg, (first, last), (low / 1.5, high * 1.5), &training, &held_out, baseline).ok()?;
    Some(svg)
}

/// The point of a term, if it has a place on a logarithmic scale.
fn at(term: &TermRecord, error: Option<f64>) -> Option<(f64, f64)> {
    #[expect(clippy::cast_precision_loss, reason = "a handful of textures")]
    let textures = term.textures as f64;
    error.filter(|e| *e > 0.0 && e.is_finite()).map(|error| (textures, error))
}

fn draw(
    svg: &mut String,
    (first, last): (f64, f64),
    (low, high): (f64, f64),
    training: &[(f64, f64)],
    held_out: &[(f64, f64)],
    mccool: f64,
) -> Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .x_label_area_size(36)
        .y_label_area_size(64)
        .build_cartesian_2d(first - 0.2..last + 0.2, low.log10()..high.log10())?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .x_labels(training.len() + 1)
        .x_label_formatter(&|x| {
            if (x - x.round()).abs() < 1e-6 { format!("{x:.0}") } else { String::new() }
        })
        .y_label_formatter(&|y| format!("{:.1e}", 10_f64.powf(*y)))
        .x_desc("textures")
        .y_desc("mean square log error")
        .draw()?;
    let line = |points: &[(f64, f64)], colour: RGBColor| {
        let logs = points.iter().map(|&(x, y)| (x, y.log10())).collect::<Vec<_>>();
        LineSeries::new(logs, colour.stroke_width(2)).point_size(4)
    };
    let key = |colour: RGBColor| {
        move |(x, y)| PathElement::new(vec![(x, y), (x + 18, y)], colour.stroke_width(2))
    };
    chart.draw_series(line(training, TRAINING))?.label("training").legend(key(TRAINING));
    chart.draw_series(line(held_out, HELD_OUT))?.label("held out").legend(key(HELD_OUT));
    let level = [first - 0.2, last + 0.2].map(|x| (x, mccool.log10()));
    chart
        .draw_series(LineSeries::new(level, MCCOOL.stroke_width(1)))?
        .label("McCool, training")
        .legend(key(MCCOOL));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.8))
        .draw()?;
    root.present()?;
    drop(chart);
    drop(root);
    Ok(())
}
