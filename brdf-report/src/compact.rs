//! The folder of results of a compact model.

use brdf_fit::{CompactFit, CompactReport, Makeup, Material};
use maud::{Markup, html};

use crate::error::ReportError;
use crate::fidelity::fidelity_table;
use crate::figures::slices;
use crate::files::ResultFile;
use crate::numbers::{bytes, or_dash, significant};
use crate::page::{document, slices_section};
use crate::spheres::SpherePair;
use crate::tried::tried_section;

/// Returns the files beside the model in a folder of results: `spheres.png`, `report.html` and `report.json`. The page
/// quotes `command` as what made it.
///
/// # Errors
///
/// [`ReportError`] for pictures that cannot be encoded.
pub fn compact_files(
    material: &Material<'_>,
    fit: &CompactFit,
    report: &CompactReport,
    command: &str,
) -> Result<Vec<ResultFile>, ReportError> {
    let model = fit.model.model.brdf();
    let reference = report.channels.of(material.brdf());
    let spheres = SpherePair::new(material.name(), &*reference, model)?;
    let slices = slices(material, model)?;
    let page = document(
        &format!("{}, as {}", material.name(), makeup_text(&report.makeup)),
        &html! {
            p {
                (bytes(report.bytes)) ", method " (report.method) ", made in "
                (significant(report.seconds)) " s."
            }
            (spheres.section())
            (slices_section(slices.as_ref()))
            (errors(report))
            (tried_section(&fit.notes)?)
            h2 { "What the model is" }
            pre { (serde_json::to_string_pretty(&report.makeup).unwrap_or_default()) }
            ul { @for note in &report.notes { li { (note) } } }
            h2 { "Command" }
            p { code { (command) } }
            h2 { "Settings" }
            pre { (serde_json::to_string_pretty(&report.settings).unwrap_or_default()) }
        },
    );
    Ok(vec![
        ResultFile::new("spheres.png", spheres.png.clone()),
        ResultFile::new("report.html", page.into_bytes()),
        ResultFile::json("report.json", report)?,
    ])
}

/// What a compact model is, in a few words.
pub(crate) fn makeup_text(makeup: &Makeup) -> String {
    match makeup {
        Makeup::Splines { terms, base: None, .. } => format!("{terms} products of splines"),
        Makeup::Splines { terms, base: Some(base), .. } => {
            let lobes = if base.lobes.len() == 1 { "lobe" } else { "lobes" };
            format!("{terms} products of splines on {} GGX {lobes}", base.lobes.len())
        }
        Makeup::Lobes(model) => match model.lobes.len() {
            1 => "a GGX lobe on a diffuse base".to_owned(),
            count => format!("{count} GGX lobes on a diffuse base"),
        },
    }
}

fn errors(report: &CompactReport) -> Markup {
    html! {
        h2 { "Errors on pairs that were not fitted" }
        (fidelity_table(report.fidelity))
        p {
            "Mean square log error: " (or_dash(report.held_out.map(|e| e.log.mean_square)))
            " held out"
            @if let Some(training) = report.training {
                ", " (significant(training.log.mean_square)) " of what was fitted"
            }
            ". Largest directional albedo: model " (significant(report.albedo.model))
            ", reference " (or_dash(report.albedo.reference)) "."
        }
    }
}
