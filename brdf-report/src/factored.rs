//! The folder of results of a product of textures.

use brdf_factor::{Axis, ChannelTransform, Coordinate, Factor, FactoredBrdf, Spacing};
use brdf_fit::{FactoredFit, FactoredModel, FactoredReport, Material, Method, TermRecord};
use brdf_image::{encode_exr, encode_png};
use brdf_model::{Brdf, Channels, ErrorMeasures, FitErrors};
use brdf_param::Space;
use brdf_plot::Plot;
use maud::{Markup, PreEscaped, html};

use crate::error::ReportError;
use crate::fidelity::fidelity_table;
use crate::figures::{error_chart, slices};
use crate::files::ResultFile;
use crate::numbers::{bytes, or_dash, significant};
use crate::page::{document, picture, slices_section};
use crate::spheres::{SMALL_SPHERE, SPHERE_SIZE, SpherePair, small_spheres, sphere_png};
use crate::texture_view::texture_view;
use crate::tried::tried_section;

/// The pictures of a report, as PNG bytes.
struct Pictures {
    spheres: SpherePair,
    /// One for each factor: PNG and EXR.
    factors: Vec<[Vec<u8>; 2]>,
    /// One for each factor: its values alone, on a sphere.
    factor_spheres: Vec<Vec<u8>>,
    /// Spheres of the models of all numbers of textures.
    by_terms: Vec<u8>,
    slices: Option<Plot>,
}

impl Pictures {
    fn new(material: &Material<'_>, fit: &FactoredFit) -> Result<Self, ReportError> {
        let model = &fit.last().model;
        let reference = fit.channels.of(material.brdf());
        let spheres = SpherePair::new(material.name(), &*reference, model)?;
        let size = |model: &FactoredBrdf| model.factors().len().to_string();
        let by_terms: Vec<(String, &dyn Brdf)> =
            fit.fits.iter().map(|fit| (size(&fit.model), &fit.model as &dyn Brdf)).collect();
        let factors = model.factors().iter();
        Ok(Self {
            by_terms: small_spheres(&by_terms, spheres.exposure)?,
            spheres,
            factors: factor_files(model)?,
            factor_spheres: factors
                .map(|factor| factor_sphere(factor, fit.channels))
                .collect::<Result<_, _>>()?,
            slices: slices(material, model)?,
        })
    }
}

/// Returns the files beside the model in a folder of results: `spheres.png`, each texture as PNG, to look at, and as
/// EXR (log values, exact), `report.html` and `report.json`. The page quotes `command` as what made it.
///
/// # Errors
///
/// [`ReportError`] for pictures that cannot be encoded.
pub fn factored_files(
    material: &Material<'_>,
    fit: &FactoredFit,
    report: &FactoredReport,
    command: &str,
) -> Result<Vec<ResultFile>, ReportError> {
    let pictures = Pictures::new(material, fit)?;
    let mut files = vec![ResultFile::new("spheres.png", pictures.spheres.png.clone())];
    files.extend(texture_files(&pictures.factors));
    let page = page(material.name(), report, fit, &pictures, command)?;
    files.push(ResultFile::new("report.html", page.into_bytes()));
    files.push(ResultFile::json("report.json", report)?);
    Ok(files)
}

/// Returns the files beside a model that was taken out of a larger one: `sphere.png` and its textures. There is no
/// reference to compare with.
///
/// # Errors
///
/// [`ReportError`] for pictures that cannot be encoded.
pub fn kept_files(kept: &FactoredModel) -> Result<Vec<ResultFile>, ReportError> {
    let mut files = vec![ResultFile::new("sphere.png", sphere_png(&kept.model, SPHERE_SIZE)?)];
    files.extend(texture_files(&factor_files(&kept.model)?));
    Ok(files)
}

fn texture_files(factors: &[[Vec<u8>; 2]]) -> Vec<ResultFile> {
    let file = |index: usize, kind: usize, name: &str| {
        ResultFile::new(format!("factor-{index}.{name}"), factors[index][kind].clone())
    };
    (0..factors.len()).flat_map(|index| [file(index, 0, "png"), file(index, 1, "exr")]).collect()
}

/// Each texture of a model as PNG, to look at, and as EXR: exact log values.
fn factor_files(model: &FactoredBrdf) -> Result<Vec<[Vec<u8>; 2]>, ReportError> {
    let channels = model.channels();
    let names = if channels == Channels::Rgb { &["R", "G", "B"][..] } else { &["Y"] };
    let file = |factor: &Factor| {
        let planes: Vec<(&str, Vec<f32>)> = names
            .iter()
            .enumerate()
            .map(|(c, name)| (*name, factor.texels().iter().map(|t| t[c]).collect()))
            .collect();
        let exr = encode_exr(factor.grid().columns, factor.grid().rows, &planes)?;
        Ok([encode_png(&texture_view(factor, channels))?, exr])
    };
    model.factors().iter().map(file).collect()
}

/// The values of one factor on a small sphere: where on it the factor brightens and darkens.
fn factor_sphere(factor: &Factor, channels: Channels) -> Result<Vec<u8>, ReportError> {
    let maps = vec![ChannelTransform::Log; channels.count()];
    let alone = FactoredBrdf::new(vec![factor.clone()], maps, std::f64::consts::FRAC_PI_2)?;
    sphere_png(&alone, SMALL_SPHERE)
}

fn page(
    name: &str,
    report: &FactoredReport,
    fit: &FactoredFit,
    pictures: &Pictures,
    command: &str,
) -> Result<String, ReportError> {
    Ok(document(
        &format!("{name}, factored"),
        &html! {
            p {
                (report.terms.last().map_or(0, |t| t.textures)) " textures, "
                (bytes(report.bytes)) ", method " (report.method) ", fitted in "
                (significant(report.seconds)) " s."
            }
            (pictures.spheres.section())
            (slices_section(pictures.slices.as_ref()))
            (errors(report))
            (tried_section(&fit.notes)?)
            (search(report, pictures))
            (textures(fit, pictures))
            (samples(report))
            h2 { "Command" }
            p { code { (command) } }
            h2 { "Settings" }
            pre { (serde_json::to_string_pretty(&report.settings).unwrap_or_default()) }
        },
    ))
}

fn errors(report: &FactoredReport) -> Markup {
    let albedo = report.albedo;
    let mccool = (report.method != Method::McCool).then_some(&report.baseline.mccool);
    html! {
        h2 { "Errors" }
        table {
            tr {
                th { "model" } th { "log abs" } th { "log square" } th { "log max" }
                th { "linear abs" } th { "linear square" } th { "linear max" }
            }
            @for term in &report.terms {
                (error_rows(&model_name(term), term))
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
        (fidelity_table(report.fidelity))
        @if let Some(fitted) = report.fitted_fidelity {
            p {
                "Texels are stored in " (report.settings.texels.name()) ", which these errors are of. As fitted in "
                "f32 their geometric mean is " (significant(fitted.score())) "."
            }
        }
        p {
            "Largest directional albedo within the grazing limit: model " (significant(albedo.model))
            ", reference " (or_dash(albedo.reference))
            ". Above 1, more light leaves than arrives."
        }
    }
}

/// The chart of errors, the models by number of textures, and what the search cost.
fn search(report: &FactoredReport, pictures: &Pictures) -> Markup {
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
            tr {
                th { "searched" } th { "validation errors, by number of textures" }
                th { "evaluations" } th { "seconds" }
            }
            @for tried in &search.tried {
                tr {
                    td { (tried.family) }
                    td {
                        @if tried.validation.is_empty() { "–" }
                        @for error in &tried.validation { (significant(*error)) " " }
                    }
                    td { (tried.evaluations) }
                    td { (significant(tried.seconds)) }
                }
            }
        }
        @if let Some(cause) = &search.stopped {
            p { "The search was stopped (" (cause) "): these are the best models found so far." }
        }
    }
}

fn model_name(term: &TermRecord) -> String {
    let family = term.family.map_or(String::new(), |family| format!(" ({family})"));
    format!("{} textures{family}", term.textures)
}

fn error_rows(name: &str, term: &TermRecord) -> Markup {
    html! {
        (error_row(name, "training", Some(&term.training)))
        (error_row(name, "held out", term.held_out.as_ref()))
        @if let Some(stored) = &term.stored {
            (error_row(name, "training, as stored", Some(&stored.training)))
            (error_row(name, "held out, as stored", stored.held_out.as_ref()))
        }
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

fn textures(fit: &FactoredFit, pictures: &Pictures) -> Markup {
    let factors = fit.last().model.factors();
    html! {
        h2 { "Textures" }
        div class="factors" {
            @for (index, factor) in factors.iter().enumerate() {
                figure {
                    (picture(&pictures.factors[index][0], &format!("factor {index}")))
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
        Coordinate::Isotropic { axes, swapped } => return angles_in_words(axes, *swapped),
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

/// Two angles, and how texels are spaced along them unless evenly.
fn angles_in_words(axes: &[Axis; 2], swapped: bool) -> Markup {
    let words = axes.map(|Axis { angle, spacing }| {
        let symbol = angle.symbol();
        match spacing {
            Spacing::Linear => symbol.to_owned(),
            Spacing::Power { exponent } => format!("{symbol}, spaced by the power {exponent}"),
            Spacing::Asinh { alpha } => format!("{symbol}, even up to {:.2}°", alpha.to_degrees()),
        }
    });
    let of = if swapped { " of the swapped pair" } else { "" };
    html! { " · " (words[0]) " × " (words[1]) (of) }
}

fn samples(report: &FactoredReport) -> Markup {
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
                (counts.outside_texture) " to the rim of a texture, and sets "
                (counts.clamped_below_zero) " negative values to 0 and "
                (counts.clamped_at_ceiling) " to the largest fitted value."
            }
            @if !report.solve.converged {
                li { "The solver stopped before it reached its tolerance." }
            }
            @for note in &report.notes { li { (note) } }
        }
    }
}
