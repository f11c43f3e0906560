//! What `brdf factor` reports of a sum of products.

use brdf_io::{RankRecord, SeparableFile, SeparableSettings};
use brdf_model::{Channels, PairSampling, anisotropy};
use brdf_plot::{Curves, Plot, PlotError, Scale, Series, plot_curves};
use brdf_separable::{CellCounts, ChannelSpectrum, Decomposition, EigenSolver, SeparableBrdf};
use maud::{Markup, PreEscaped, html};
use serde::Serialize;

use super::html::{command, document, picture, slices, spheres};
use crate::fitting::Albedo;
use crate::numbers::{bytes, or_dash, percent, significant};
use crate::pictures::SeparablePictures;
use crate::subject::Subject;

/// `report.json`. The first key marks the folder as ours.
#[derive(Serialize)]
pub(crate) struct SeparableReport {
    /// Version of the program.
    brdf: &'static str,
    input: String,
    /// File name of the model, within the folder.
    model: &'static str,
    method: String,
    space: &'static str,
    map: &'static str,
    pub(crate) matrix: MatrixFacts,
    terms: Vec<RankRecord>,
    spectra: Vec<ChannelSpectrum>,
    /// Of filling the matrix alone.
    fill_seconds: f64,
    /// Of filling and decomposing it.
    pub(crate) seconds: f64,
    pub(crate) bytes: usize,
    albedo: Albedo,
    channels: Channels,
    /// What evaluating the model on pairs of whole hemispheres does.
    evaluation: Evaluation,
    settings: SeparableSettings,
    pub(crate) notes: Vec<String>,
    #[serde(skip)]
    name: String,
}

#[derive(Serialize)]
pub(crate) struct MatrixFacts {
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    cells: CellCounts,
    asymmetry: Option<f64>,
}

#[derive(Serialize)]
struct Evaluation {
    pairs: usize,
    clamped_below_zero: usize,
}

/// Pairs over whole hemispheres whose treatment is counted.
const COUNTED_PAIRS: u32 = 20_000;

impl SeparableReport {
    pub(crate) fn new(
        subject: &Subject,
        file: &SeparableFile,
        [rows, columns]: [usize; 2],
        map: &'static str,
        albedo: Albedo,
        [fill_seconds, seconds]: [f64; 2],
        notes: Vec<String>,
    ) -> Self {
        let fit = &file.fit;
        Self {
            brdf: env!("CARGO_PKG_VERSION"),
            input: subject.argument.clone(),
            model: "model.safetensors",
            method: fit.method.clone(),
            space: file.model.layout().parametrization.name(),
            map,
            matrix: MatrixFacts { rows, columns, cells: fit.cells, asymmetry: fit.asymmetry },
            terms: fit.terms.clone(),
            spectra: fit.spectra.clone(),
            fill_seconds,
            seconds,
            bytes: file.model.payload_bytes(),
            albedo,
            channels: file.model.channels(),
            evaluation: Evaluation {
                pairs: COUNTED_PAIRS as usize,
                clamped_below_zero: negative_pairs(&file.model),
            },
            settings: fit.settings.clone(),
            notes,
            name: fit.input.clone(),
        }
    }

    /// `report.html`.
    pub(crate) fn page(&self, pictures: &SeparablePictures) -> String {
        document(
            &format!("{}, as a sum of products", self.name),
            &html! {
                p {
                    (self.terms.last().map_or(0, |t| t.matrix.rank)) " terms, " (bytes(self.bytes))
                    ", method " (self.method) ", made in " (significant(self.seconds)) " s."
                }
                (spheres(&pictures.spheres, &pictures.comparison))
                (slices(pictures.slices.as_ref()))
                (self.errors(pictures))
                (self.textures(pictures))
                (self.cells())
                h2 { "Command" }
                p { code { (command()) } }
                h2 { "Settings" }
                pre { (serde_json::to_string_pretty(&self.settings).unwrap_or_default()) }
            },
        )
    }

    fn errors(&self, pictures: &SeparablePictures) -> Markup {
        html! {
            h2 { "Errors" }
            table {
                tr {
                    th { "terms" } th { "relative residual" } th { "log-cosine RMS" }
                    th { "log square, held out" } th { "linear square, held out" }
                }
                @for term in &self.terms {
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
                "Largest directional albedo: model " (significant(self.albedo.model)) ", reference "
                (or_dash(self.albedo.reference)) "."
            }
        }
    }

    fn textures(&self, pictures: &SeparablePictures) -> Markup {
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

    fn cells(&self) -> Markup {
        let cells = self.matrix.cells;
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
                "Of " (self.evaluation.pairs) " pairs over both hemispheres, "
                (self.evaluation.clamped_below_zero)
                " have a channel below 0, which evaluation sets to 0."
            }
            ul { @for note in &self.notes { li { (note) } } }
        }
    }
}

/// Pairs over whole hemispheres for which a channel comes out negative.
fn negative_pairs(model: &SeparableBrdf) -> usize {
    use brdf_model::Brdf as _;
    let sampling =
        PairSampling { count: COUNTED_PAIRS, seed: 1, theta_max: std::f64::consts::FRAC_PI_2 };
    let is_negative = |pair| {
        model.eval_unclamped(&pair).channels()[..model.maps().len()].iter().any(|v| *v < 0.0)
    };
    sampling.pairs().filter(|pair| is_negative(*pair)).count()
}

/// The magnitudes of all terms, one series a channel.
pub(crate) fn spectrum_plot(name: &str, spectra: &[ChannelSpectrum]) -> Result<Plot, PlotError> {
    let labels: &[&str] = match spectra {
        [_] => &["all channels"],
        _ => &["red", "green", "blue"],
    };
    let series = spectra
        .iter()
        .zip(labels)
        .map(|(spectrum, label)| {
            let point = |(index, value): (usize, &f64)| ((index + 1) as f64, value.abs());
            Series::new(*label, spectrum.values.iter().enumerate().map(point).collect())
        })
        .collect();
    let curves = Curves {
        title: name.to_owned(),
        x: "term".to_owned(),
        y: "magnitude, weighted".to_owned(),
        y_scale: Scale::Log,
        series,
    };
    plot_curves(&[curves], 1)
}

/// What turning a material may change before it is called anisotropic: tables interpolate.
pub(crate) const ANISOTROPIC: f64 = 0.01;
/// Asymmetry above this is more than rounding.
const ROUNDING: f64 = 1e-6;

/// What is wrong with a sum of products that its errors alone do not show.
pub(crate) fn separable_notes(
    subject: &Subject,
    file: &SeparableFile,
    albedo: Albedo,
) -> Vec<String> {
    let mut notes = subject.notes().to_vec();
    let fit = &file.fit;
    if subject.samples().is_some() {
        notes.push(
            "the rows were interpolated to fill the matrix: between them nothing was measured, and no \
             rows were held out"
                .to_owned(),
        );
    }
    let turned = anisotropy(subject.brdf());
    if file.model.layout().is_isotropic() && turned > ANISOTROPIC {
        notes.push(format!(
            "the material is anisotropic: it differs by {} when turned by a quarter, which textures of \
             the polar angle alone cannot hold",
            percent(turned)
        ));
    }
    let without = fit.terms.last().and_then(|term| Some(term.held_out.as_ref()?.without_logarithm));
    if let Some(count) = without.filter(|count| *count > 0) {
        notes.push(format!(
            "{count} held-out values came out negative and have no logarithm; log errors take them as 0"
        ));
    }
    let cells = fit.cells;
    let share = |count: usize| {
        let share = count as f64 / cells.cells.max(1) as f64;
        percent(share)
    };
    if cells.filled > 0 {
        notes.push(format!(
            "{} of {} cells have no data of their own and took that of the nearest pair",
            share(cells.filled),
            cells.cells
        ));
    }
    if cells.zero > 0 {
        notes.push(format!(
            "{} of {} cells have no data and are 0",
            share(cells.zero),
            cells.cells
        ));
    }
    if cells.unknown_lines > 0 {
        notes.push(format!(
            "{} whole rows or columns have no data of their own",
            cells.unknown_lines
        ));
    }
    if cells.clamped > 0 {
        notes.push(format!("{} cells had a negative channel, set to 0", cells.clamped));
    }
    if let Some(asymmetry) = fit.asymmetry.filter(|a| *a > ROUNDING) {
        notes.push(format!(
            "the material is not reciprocal: ‖M − Mᵀ‖ / ‖M‖ is {}; the mean of M and Mᵀ was factored",
            significant(asymmetry)
        ));
    }
    spectrum_notes(file, &mut notes);
    if let Some(reference) = albedo.reference
        && !(0.8..=1.25).contains(&(albedo.model / reference))
    {
        notes.push(format!(
            "the model's largest albedo is {}, the reference's {}",
            significant(albedo.model),
            significant(reference)
        ));
    }
    notes
}

fn spectrum_notes(file: &SeparableFile, notes: &mut Vec<String>) {
    let fit = &file.fit;
    let added = fit.spectra.iter().map(|s| s.added).max().unwrap_or(0);
    if added > 0 {
        notes.push(format!(
            "{added} terms beyond {} complete groups of equal magnitude: cut in between, the result \
             would depend on the azimuth of the frame",
            fit.settings.rank
        ));
    }
    if fit.spectra.iter().any(|s| s.cuts_a_group) {
        notes.push(
            "more terms of the same magnitude as the last follow: which of them were taken is chance"
                .to_owned(),
        );
    }
    let fewest = fit.spectra.iter().map(|s| s.values.len()).min().unwrap_or(0);
    if fewest < fit.settings.rank {
        notes.push(format!(
            "the matrix has only {fewest} terms above rounding in a channel, not {}",
            fit.settings.rank
        ));
    }
    let worst = fit.spectra.iter().flat_map(|s| &s.residuals).copied().fold(0.0, f64::max);
    if fit.settings.decomposition == Decomposition::Eigen(EigenSolver::Power) {
        notes.push(format!(
            "power iteration as printed: the largest residual ‖Mv − λv‖ / |λ| is {}; --eigen-solver \
             krylov meets 1e-5",
            significant(worst)
        ));
    } else if fit.spectra.iter().any(|s| !s.converged) {
        notes.push(format!(
            "the iteration stopped before it met its tolerance; largest residual {}",
            significant(worst)
        ));
    }
}
