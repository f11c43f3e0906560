//! `report.html`: one page that needs no other file.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use brdf_factor::Coordinate;
use brdf_io::TermRecord;
use brdf_model::{ErrorMeasures, FitErrors};
use brdf_param::Space;
use brdf_plot::Plot;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::Report;
use super::chart::error_chart;
use crate::fitting::Outcome;
use crate::numbers::{bytes, or_dash, percent, significant};
use crate::pictures::{Comparison, Pictures};

const STYLE: &str = "
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 62rem; padding: 0 1rem;
       color: #18181b; background: #fafafa; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2rem; }
img, svg { max-width: 100%; height: auto; } .factors { display: flex; flex-wrap: wrap; gap: 1rem; }
figure { margin: 0; } figcaption { font-size: .85rem; color: #52525b; max-width: 20rem; }
.factors img { image-rendering: pixelated; width: 256px; } .factors .sphere img { width: 128px; }
.matrix { font-size: .75rem; margin: .4rem 0; }
table { border-collapse: collapse; } th, td { padding: .25rem .7rem; text-align: right;
       border-bottom: 1px solid #d4d4d8; font-variant-numeric: tabular-nums; }
th:first-child, td:first-child { text-align: left; } code { background: #eee; padding: .1rem .3rem; }
";

/// The page.
pub(crate) fn page(report: &Report, outcome: &Outcome, pictures: &Pictures) -> String {
    document(
        &format!("{}, factored", report.name),
        &html! {
            p {
                (report.terms.last().map_or(0, |t| t.textures)) " textures, "
                (bytes(report.bytes)) ", method " (report.method) ", fitted in "
                (significant(report.seconds)) " s."
            }
            (spheres(&pictures.spheres, &pictures.comparison))
            (slices(pictures.slices.as_ref()))
            (errors(report))
            (search(report, pictures))
            (textures(outcome, pictures))
            (samples(report))
            h2 { "Command" }
            p { code { (command()) } }
            h2 { "Settings" }
            pre { (serde_json::to_string_pretty(&report.settings).unwrap_or_default()) }
        },
    )
}

/// A page that needs no other file.
pub(crate) fn document(title: &str, content: &Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width";
                title { "brdf: " (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (title) }
                (content)
            }
        }
    }
    .into_string()
}

pub(crate) fn picture(png: &[u8], alt: &str) -> Markup {
    html! { img src=(format!("data:image/png;base64,{}", STANDARD.encode(png))) alt=(alt); }
}

pub(crate) fn spheres(strip: &[u8], comparison: &Comparison) -> Markup {
    html! {
        h2 { "Spheres" }
        (picture(strip, "reference, approximation, difference"))
        p {
            "Reference, approximation, and their difference brightened four times, under one "
            "directional light 30° from the camera, with irradiance π. Exposure "
            (significant(comparison.exposure)) ", sRGB; "
            (percent(comparison.clipped_share))
            " of the reference's pixels are clipped. Chequered violet: no data."
        }
    }
}

pub(crate) fn slices(plot: Option<&Plot>) -> Markup {
    let Some(plot) = plot else { return html! {} };
    html! {
        h2 { "Slices" }
        (PreEscaped(plot.svg()))
        p { "Luminance of reference and approximation, colours on a common logarithm. Grey: no data." }
    }
}

fn errors(report: &Report) -> Markup {
    let albedo = report.albedo;
    let mccool = (report.method != "mccool").then_some(&report.baseline.mccool);
    html! {
        h2 { "Errors" }
        table {
            tr {
                th { "model" } th { "log abs" } th { "log square" } th { "log max" }
                th { "linear abs" } th { "linear square" } th { "linear max" }
            }
            @for term in &report.terms {
                (error_rows(&format!("{} textures", term.textures), term))
            }
            @if let Some(mccool) = mccool {
                (error_rows(&format!("McCool, {} textures", mccool.textures), mccool))
            }
        }
        p {
            "Log errors are of ln(a + f) with a = 1e-5 of the mean; linear errors in sr⁻¹ (squares "
            "in sr⁻²). Mean absolute, mean square, maximum; over RGB, means are means over "
            "channels. Held-out samples were not fitted."
        }
        p {
            "Largest directional albedo within the grazing limit: model " (significant(albedo.model))
            ", reference " (or_dash(albedo.reference))
            ". Above 1, more light leaves than arrives."
        }
    }
}

/// The chart of errors, the models by number of textures, and what the search cost.
fn search(report: &Report, pictures: &Pictures) -> Markup {
    let Some(search) = &report.search else { return html! {} };
    html! {
        h2 { "Error against number of textures" }
        @if let Some(chart) = error_chart(&report.terms, &report.baseline.mccool) {
            (PreEscaped(chart.svg()))
        }
        (picture(&pictures.by_terms, "the models by number of textures"))
        p {
            "The best model of each number of textures, at the exposure above. All are in the model file: "
            code { "brdf factor --from model.safetensors --keep N" } " takes one out."
        }
        table {
            tr { th { "searched" } th { "validation error" } th { "evaluations" } th { "seconds" } }
            @for tried in &search.tried {
                tr {
                    td { (tried.space) @if tried.reciprocal { ", reciprocal" } }
                    td { (or_dash(tried.validation)) }
                    td { (tried.evaluations) }
                    td { (significant(tried.seconds)) }
                }
            }
        }
        @if let Some(cause) = search.stopped {
            p { "The search was stopped (" (cause) "): these are the best models found so far." }
        }
    }
}

fn error_rows(name: &str, term: &TermRecord) -> Markup {
    html! {
        (error_row(name, "training", Some(&term.training)))
        (error_row(name, "held out", term.held_out.as_ref()))
    }
}

fn error_row(name: &str, set: &str, errors: Option<&FitErrors>) -> Markup {
    let cells = |e: &ErrorMeasures| [e.mean_abs, e.mean_square, e.max].map(significant);
    html! {
        tr {
            td { (name) ", " (set) }
            @match errors {
                Some(errors) => {
                    @for cell in cells(&errors.log) { td { (cell) } }
                    @for cell in cells(&errors.linear) { td { (cell) } }
                }
                None => { td colspan="6" { "too few rows to hold any out" } }
            }
        }
    }
}

fn textures(outcome: &Outcome, pictures: &Pictures) -> Markup {
    let factors = outcome.last().model.factors();
    html! {
        h2 { "Textures" }
        div class="factors" {
            @for (index, factor) in factors.iter().enumerate() {
                figure {
                    (picture(&pictures.factors[index].0, &format!("factor {index}")))
                    span class="sphere" {
                        (picture(&pictures.factor_spheres[index], "the factor alone, on the sphere"))
                    }
                    figcaption {
                        "factor " (index)
                        @for coordinate in factor.coordinates() { (in_words(coordinate)) }
                    }
                }
            }
        }
        p {
            "Beside each texture, its values alone on the sphere, under the same light: where it "
            "brightens and darkens. A matrix multiplies the parabolic coordinates of wi and wo, or of "
            "h and d; the second, if any, is the reciprocal conjugate, which reads the same texture. "
            "Each channel scaled so that its largest value shows as white. Yellow: no direction "
            "pair reaches these texels. Exact log values are in the EXR files."
        }
    }
}

/// A coordinate as a reader would name it; projections as matrices of two rows.
fn in_words(coordinate: &Coordinate) -> Markup {
    let name = match coordinate {
        Coordinate::Wi => "wi",
        Coordinate::Wo => "wo",
        Coordinate::H => "h",
        Coordinate::D => "d",
        Coordinate::RadialWi => "|wi⊥|",
        Coordinate::RadialWo => "|wo⊥|",
        Coordinate::RadialH => "|h⊥|",
        Coordinate::Projected { space, projection } => {
            let rows =
                projection.rows().map(|row| row.to_array().map(|v| format!("{v:+.3}")).join("  "));
            let columns = match space {
                Space::Standard => "  wi.x    wi.y    wo.x    wo.y",
                Space::HalfDifference => "  h.x     h.y     d.x     d.y",
            };
            return html! { pre class="matrix" { (columns) "\n" (rows.join("\n")) } };
        }
    };
    html! { " · " (name) }
}

fn samples(report: &Report) -> Markup {
    let dropped = report.samples.dropped;
    let reasons = [
        ("below the horizon", dropped.below_horizon),
        ("beyond the grazing limit", dropped.beyond_grazing_limit),
        ("not finite", dropped.not_finite),
        ("negative", dropped.negative),
        ("without data", dropped.no_data),
        ("zero under a plain logarithm", dropped.zero),
    ];
    let counts = report.evaluation.counts;
    html! {
        h2 { "What was fitted, dropped and changed" }
        table {
            tr { th { "samples" } th { "count" } }
            tr { td { "used" } td { (report.samples.used) } }
            tr { td { "fitted, turned copies included" } td { (report.samples.fitted) } }
            @for (reason, count) in reasons {
                tr { td { "dropped: " (reason) } td { (count) } }
            }
        }
        ul {
            li {
                (report.solve.unknowns) " texels solved for (" (format!("{:?}", report.solve.solver))
                "), " (report.solve.smoothed_texels) " of them touched by no sample: smoothing "
                "alone holds those."
            }
            li {
                "Of " (report.evaluation.pairs) " pairs over both whole hemispheres, evaluation "
                "pulls " (counts.pulled_back) " back to the grazing limit of "
                (significant(report.evaluation.max_theta_deg)) "°, moves "
                (counts.outside_texture) " to the rim of a texture and sets "
                (counts.clamped_below_zero) " negative values to 0."
            }
            @if !report.solve.converged {
                li { "The solver stopped before it reached its tolerance." }
            }
            @for note in &report.notes { li { (note) } }
        }
    }
}

/// The command line, quoted where a shell would need it.
pub(crate) fn command() -> String {
    let quoted = |word: String| {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,@%+".contains(c);
        if !word.is_empty() && word.chars().all(plain) {
            word
        } else {
            format!("'{}'", word.replace('\'', "'\\''"))
        }
    };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("brdf".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}
