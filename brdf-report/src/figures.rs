//! Figures of fits, models and materials.

use brdf_factor::FactoredBrdf;
use brdf_fit::{Material, RankErrors, TermRecord};
use brdf_image::DisplayImage;
use brdf_model::Brdf;
use brdf_param::Parametrization;
use brdf_plot::{Curves, Plot, PlotError, Scale, Series, plot_curves, plot_slices, plot_textures};
use brdf_separable::{ChannelSpectrum, SeparableBrdf};

use crate::separable_view::{Side, term_view};
use crate::texture_view::texture_view;

/// Returns mean square log errors over the number of textures, on a logarithmic scale: training, held out,
/// and McCool's model as a level; none where there are fewer than two models or an error is 0.
pub fn error_chart(terms: &[TermRecord], mccool: &TermRecord) -> Option<Plot> {
    if terms.len() < 2 {
        return None;
    }
    let textures = |term: &TermRecord| term.textures as f64;
    let training = terms.iter().map(|t| (textures(t), t.training.log.mean_square)).collect();
    let held_out = terms
        .iter()
        .filter_map(|t| Some((textures(t), t.held_out.as_ref()?.log.mean_square)))
        .collect();
    let ends = [&terms[0], &terms[terms.len() - 1]];
    let level = ends.map(|t| (textures(t), mccool.training.log.mean_square)).to_vec();
    let curves = Curves {
        title: String::new(),
        x: "textures".to_owned(),
        y: "mean square log error".to_owned(),
        y_scale: Scale::Log,
        series: vec![
            Series::new("training", training),
            Series::new("held out", held_out),
            Series::new("McCool, training", level),
        ],
    };
    plot_curves(&[curves], 1).ok()
}

/// Returns the magnitudes of all terms, one series a channel.
///
/// # Errors
///
/// [`PlotError`] of the plot.
pub fn spectrum_plot(name: &str, spectra: &[ChannelSpectrum]) -> Result<Plot, PlotError> {
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

/// Azimuths of the slices in reports, degrees.
const SLICE_AZIMUTHS: [f64; 3] = [0.0, 90.0, 180.0];

/// Returns slices of a reference above those of its approximation; none of scattered rows, which have nothing between
/// them to show.
pub(crate) fn slices(material: &Material<'_>, model: &dyn Brdf) -> Result<Option<Plot>, PlotError> {
    if material.samples().is_some() {
        return Ok(None);
    }
    let both = [(material.name().to_owned(), material.brdf()), ("approximation".to_owned(), model)];
    plot_slices(&both, Parametrization::HalfDifference, &SLICE_AZIMUTHS).map(Some)
}

/// Textures side by side in one row.
const ROW: usize = 8;

/// Returns the textures of a product.
///
/// # Errors
///
/// [`PlotError`] of the plot.
pub fn factored_textures_plot(model: &FactoredBrdf) -> Result<Plot, PlotError> {
    let factors = model.factors().iter().enumerate();
    let view =
        |(index, factor)| (format!("factor {index}"), texture_view(factor, model.channels()));
    plot_textures(&factors.map(view).collect::<Vec<_>>(), ROW)
}

/// Returns the textures of a sum of products: those of the first side, then those of the second where it has its own.
///
/// # Errors
///
/// [`PlotError`] of the plot.
pub fn separable_textures_plot(model: &SeparableBrdf) -> Result<Plot, PlotError> {
    let [first, second] = model.layout().parametrization.hemisphere_names();
    let side = |side, name: &str| -> Vec<(String, DisplayImage)> {
        let view = |term| (format!("{name}, term {}", term + 1), term_view(model, side, term));
        (0..model.rank()).map(view).collect()
    };
    let mut all = side(Side::First, first);
    if model.second().is_some() {
        all.extend(side(Side::Second, second));
    }
    plot_textures(&all, ROW)
}

/// Returns the errors of eigenpairs against their number, for each material over all pairs and over those within 80°.
///
/// # Errors
///
/// [`PlotError`] of the plot.
pub fn rank_error_plot(materials: &[(String, Vec<RankErrors>)]) -> Result<Plot, PlotError> {
    let mut panels = Vec::new();
    for (name, errors) in materials {
        let panel = |which: &str, pick: fn(&RankErrors) -> &Vec<f64>| Curves {
            title: format!("{name}, {which}"),
            x: "terms".to_owned(),
            y: "cosine-weighted RMS (1/sr)".to_owned(),
            y_scale: Scale::Linear,
            series: errors
                .iter()
                .map(|errors| {
                    let points = pick(errors).iter().enumerate();
                    let points =
                        points.map(|(index, error)| ((index + 1) as f64, *error)).collect();
                    Series::new(format!("{}²", errors.resolution), points)
                })
                .collect(),
        };
        panels.push(panel("all pairs", |e| &e.absolute));
        panels.push(panel("within 80°", |e| &e.within_80));
    }
    plot_curves(&panels, 2)
}
