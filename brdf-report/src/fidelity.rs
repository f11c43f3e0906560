//! Errors away from the highlight and in it, as a table and as a line.

use brdf_model::Fidelity;
use maud::{Markup, html};

use crate::numbers::significant;

/// The errors of a [`Fidelity`], in the order of [`FidelityErrors::all`](brdf_model::FidelityErrors::all).
const MEASURES: [&str; 4] =
    ["ln(1 + f cosθi), RMS", "∛(f cosθi), RMS", "f, cosine-weighted, relative", "ln(a + f), RMS"];

/// Returns the eight errors and their geometric mean; nothing where there are none.
pub(crate) fn fidelity_table(fidelity: Option<Fidelity>) -> Markup {
    let Some(fidelity) = fidelity else { return html! {} };
    let rows = MEASURES.into_iter().zip(fidelity.uniform.all()).zip(fidelity.highlight.all());
    html! {
        table {
            tr { th { "error of" } th { "uniform pairs" } th { "half at the highlight" } }
            @for ((name, uniform), highlight) in rows {
                tr {
                    td { (name) } td { (significant(uniform)) } td { (significant(highlight)) }
                }
            }
        }
        p { "Geometric mean of the eight: " (significant(fidelity.score())) "." }
    }
}

/// Returns the errors that matter most to a picture, in a line.
pub(crate) fn fidelity_line(fidelity: &Fidelity) -> String {
    format!(
        "log-cosine RMS {}, {} at the highlight; relative RMS {}, {} at the highlight; held out",
        significant(fidelity.uniform.log_cosine),
        significant(fidelity.highlight.log_cosine),
        significant(fidelity.uniform.cosine_relative),
        significant(fidelity.highlight.cosine_relative)
    )
}
