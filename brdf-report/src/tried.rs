//! The models that were tried before one was chosen, as a picture.

use brdf_fit::{FitNote, TriedModel};
use brdf_plot::{Curves, Series, plot_log_log};
use maud::{Markup, PreEscaped, html};

use crate::error::ReportError;
use crate::numbers::{bytes, significant};

/// Error against bytes of all models that were tried; nothing where none was chosen among several.
pub(crate) fn tried_section(notes: &[FitNote]) -> Result<Markup, ReportError> {
    let chosen = notes.iter().find_map(|note| match note {
        FitNote::ChosenMethod { tried, on_rows } if tried.len() > 1 => Some((tried, *on_rows)),
        _ => None,
    });
    let Some((tried, on_rows)) = chosen else { return Ok(html! {}) };
    let mut series: Vec<Series> = Vec::new();
    for model in tried {
        let point = (model.bytes as f64, model.error);
        match series.iter_mut().find(|series| series.label == model.method.name()) {
            Some(series) => series.points.push(point),
            None => series.push(Series::new(model.method.name(), vec![point])),
        }
    }
    let panel =
        Curves { x: "bytes".to_owned(), y: "error".to_owned(), series, ..Curves::default() };
    let plot = plot_log_log(&[panel], 1)?;
    let by = if on_rows {
        "geometric mean of four errors over folds"
    } else {
        "geometric mean of eight errors over validation pairs"
    };
    Ok(html! {
        h2 { "What else was tried" }
        (PreEscaped(plot.svg()))
        table {
            tr { th { "model" } th { "bytes" } th { (by) } }
            @for model in tried {
                tr {
                    td { (model.method.name()) @if !is_beaten(model, tried) { " *" } }
                    td { (bytes(model.bytes)) }
                    td { (significant(model.error)) }
                }
            }
        }
        p { "* no model that was tried is both smaller and better." }
    })
}

/// Another model is no larger and no worse, and one of the two it is not equally.
fn is_beaten(model: &TriedModel, all: &[TriedModel]) -> bool {
    all.iter().any(|other| {
        let is_no_worse = other.bytes <= model.bytes && other.error <= model.error;
        is_no_worse && (other.bytes < model.bytes || other.error < model.error)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use brdf_fit::Method;

    #[test]
    fn models_that_others_beat_carry_no_mark() {
        let model = |method, bytes, error| TriedModel { method, bytes, error };
        let tried = vec![
            model(Method::Spline, 8_000, 0.01),
            model(Method::Ggx, 44, 0.2),
            model(Method::McCool, 8_000, 0.3),
        ];
        let notes = [FitNote::ChosenMethod { tried, on_rows: false }];
        let page = tried_section(&notes).unwrap().into_string();
        assert!(page.contains("spline *") && page.contains("ggx *"), "{page}");
        assert!(page.contains("mccool") && !page.contains("mccool *"));
        assert!(page.contains("<svg"));
        assert!(tried_section(&[]).unwrap().into_string().is_empty());
    }
}
