//! The folder of results of a sum of products.

use brdf_fit::{Material, SeparableFit, SeparableReport};
use brdf_image::{encode_exr, encode_png};
use brdf_plot::Plot;
use brdf_separable::SeparableBrdf;
use maud::{Markup, PreEscaped, html};

use crate::error::ReportError;
use crate::figures::{slices, spectrum_plot};
use crate::files::ResultFile;
use crate::numbers::{bytes, or_dash, significant};
use crate::page::{document, picture, slices_section};
use crate::separable_view::{Side, term_view};
use crate::spheres::SpherePair;

/// A file of each term: first side, and second where it has textures of its own.
type TermFiles = Vec<(Vec<u8>, Option<Vec<u8>>)>;

/// The pictures of a report.
struct Pictures {
    spheres: SpherePair,
    /// PNGs of each term.
    views: TermFiles,
    /// EXRs of the same.
    exact: TermFiles,
    spectrum: Plot,
    slices: Option<Plot>,
}

impl Pictures {
    fn new(material: &Material<'_>, fit: &SeparableFit) -> Result<Self, ReportError> {
        let model = &fit.model.model;
        let reference = model.channels().of(material.brdf());
        let both = |one: &dyn Fn(Side, usize) -> Result<Vec<u8>, ReportError>| {
            (0..model.rank())
                .map(|term| {
                    let second = model.second().map(|_| one(Side::Second, term)).transpose()?;
                    Ok((one(Side::First, term)?, second))
                })
                .collect::<Result<TermFiles, ReportError>>()
        };
        Ok(Self {
            spheres: SpherePair::new(material.name(), &*reference, model)?,
            views: both(&|side, term| Ok(encode_png(&term_view(model, side, term))?))?,
            exact: both(&|side, term| term_exr(model, side, term))?,
            spectrum: spectrum_plot(material.name(), &fit.model.record.spectra)?,
            slices: slices(material, model)?,
        })
    }
}

/// Returns the files beside the model in a folder of results: `spheres.png`, `spectrum.svg`, the textures of each term
/// as PNG, to look at, and as EXR (exact values), `report.html` and `report.json`. The page quotes `command` as what
/// made it.
///
/// # Errors
///
/// [`ReportError`] for pictures that cannot be encoded.
pub fn separable_files(
    material: &Material<'_>,
    fit: &SeparableFit,
    report: &SeparableReport,
    command: &str,
) -> Result<Vec<ResultFile>, ReportError> {
    let pictures = Pictures::new(material, fit)?;
    let mut files = vec![
        ResultFile::new("spheres.png", pictures.spheres.png.clone()),
        ResultFile::new("spectrum.svg", pictures.spectrum.svg().as_bytes().to_vec()),
    ];
    for (kind, terms) in [("png", &pictures.views), ("exr", &pictures.exact)] {
        for (index, (first, second)) in terms.iter().enumerate() {
            files.push(ResultFile::new(format!("first-{index}.{kind}"), first.clone()));
            if let Some(second) = second {
                files.push(ResultFile::new(format!("second-{index}.{kind}"), second.clone()));
            }
        }
    }
    let page = page(material.name(), report, &pictures, command);
    files.push(ResultFile::new("report.html", page.into_bytes()));
    files.push(ResultFile::json("report.json", report)?);
    Ok(files)
}

/// A term's texture on one side, exact.
fn term_exr(model: &SeparableBrdf, side: Side, term: usize) -> Result<Vec<u8>, ReportError> {
    let (grid, channels) = match side {
        Side::First => (model.layout().first, model.first_channels()),
        Side::Second => (model.layout().second, model.maps().len()),
    };
    let names = if channels == 3 { &["R", "G", "B"][..] } else { &["Y"] };
    let planes: Vec<(&str, Vec<f32>)> = names
        .iter()
        .enumerate()
        .map(|(channel, name)| {
            #[expect(clippy::cast_possible_truncation, reason = "textures are stored in f32")]
            let value = |texel| match side {
                Side::First => model.first_at(texel, term, channel) as f32,
                Side::Second => model.second_at(texel, term, channel) as f32,
            };
            (*name, (0..grid.texels()).map(value).collect())
        })
        .collect();
    let [columns, rows] = grid.size();
    Ok(encode_exr(columns, rows, &planes)?)
}

fn page(name: &str, report: &SeparableReport, pictures: &Pictures, command: &str) -> String {
    document(
        &format!("{name}, as a sum of products"),
        &html! {
            p {
                (report.terms.last().map_or(0, |t| t.matrix.rank)) " terms, " (bytes(report.bytes))
                ", method " (report.method) ", made in " (significant(report.seconds)) " s."
            }
            (pictures.spheres.section())
            (slices_section(pictures.slices.as_ref()))
            (errors(report, pictures))
            (textures(pictures))
            (cells(report))
            h2 { "Command" }
            p { code { (command) } }
            h2 { "Settings" }
            pre { (serde_json::to_string_pretty(&report.settings).unwrap_or_default()) }
        },
    )
}

fn errors(report: &SeparableReport, pictures: &Pictures) -> Markup {
    html! {
        h2 { "Errors" }
        table {
            tr {
                th { "terms" } th { "relative residual" } th { "log-cosine RMS" }
                th { "log square, held out" } th { "linear square, held out" }
            }
            @for term in &report.terms {
                tr {
                    td { (term.matrix.rank) }
                    td { (significant(term.matrix.relative_residual)) }
                    td { (significant(term.matrix.log_cosine_rms)) }
                    td { (or_dash(term.held_out.as_ref().map(|e| e.log.mean_square))) }
                    td { (or_dash(term.held_out.as_ref().map(|e| e.linear.mean_square))) }
                }
            }
        }
        p {
            "Relative residual: ‖M − M̂‖ / ‖M‖ of the weighted matrix. Log-cosine RMS: of ln(1 + f "
            "cosθi) over cells with data. Held out: pairs between the nodes."
        }
        (PreEscaped(pictures.spectrum.svg()))
        p {
            "Largest directional albedo: model " (significant(report.albedo.model)) ", reference "
            (or_dash(report.albedo.reference)) "."
        }
    }
}

fn textures(pictures: &Pictures) -> Markup {
    html! {
        h2 { "Textures" }
        div class="factors" {
            @for (index, (first, second)) in pictures.views.iter().enumerate() {
                figure {
                    (picture(first, &format!("term {}, first side", index + 1)))
                    @if let Some(second) = second {
                        (picture(second, &format!("term {}, second side", index + 1)))
                    }
                    figcaption { "term " (index + 1) }
                }
            }
        }
        p {
            "Absolute values, each channel scaled so that its largest shows as white. Yellow: not "
            "sampled. Where light and view share textures only one is shown. Exact values are in "
            "the EXR files."
        }
    }
}

fn cells(report: &SeparableReport) -> Markup {
    let cells = report.matrix.cells;
    html! {
        h2 { "What was sampled and changed" }
        table {
            tr { th { "cells" } th { "count" } }
            tr { td { "in all" } td { (cells.cells) } }
            tr { td { "with data of their own" } td { (cells.valid) } }
            tr { td { "given the value of the nearest pair with data" } td { (cells.filled) } }
            tr { td { "set to 0" } td { (cells.zero) } }
            tr { td { "with a negative channel, set to 0" } td { (cells.clamped) } }
        }
        p {
            "Of " (report.evaluation.pairs) " pairs over both hemispheres, "
            (report.evaluation.clamped_below_zero)
            " have a channel below 0, which evaluation sets to 0."
        }
        ul { @for note in &report.notes { li { (note) } } }
    }
}
