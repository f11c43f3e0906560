//! The folder of results of a painted material.

use brdf_image::{ToneMap, encode_exr, encode_png};
use brdf_paint::pictures::{contradictions_view, coverage_view, map_view, view_strip};
use brdf_paint::{Extraction, PaintReport, PaintedImage, ViewBuffers};
use brdf_render::{DirectionalLight, Light, SphereView, render_sphere};
use maud::html;

use crate::error::ReportError;
use crate::files::{ResultFile, sorted_json};
use crate::page::{document, picture};

/// A view that was painted.
#[derive(Clone, Debug)]
pub struct PaintedView {
    /// Name of the view.
    pub name: String,
    /// Whether the material was judged by it.
    pub is_held_out: bool,
    /// Surfaces that its pixels show.
    pub buffers: ViewBuffers,
    /// The painting.
    pub image: PaintedImage,
}

/// Returns the files beside the material in a folder of results: `view-N.png`, `map-N.png` and `.exr`, `coverage.png`,
/// `contradictions.png`, `report.html` and `report.json`. Views are taken one after another.
///
/// # Errors
///
/// [`ReportError`] for pictures that cannot be encoded; what a view says.
pub fn paint_files<E: From<ReportError>>(
    views: impl Iterator<Item = Result<PaintedView, E>>,
    made: &Extraction,
    report: &PaintReport,
) -> Result<Vec<ResultFile>, E> {
    let (mut files, mut shown) = (Vec::new(), Vec::new());
    for (at, view) in views.enumerate() {
        let PaintedView { name, is_held_out, buffers, image } = view?;
        let strip = encode_png(&view_strip(&name, &buffers, &image, &made.material));
        let strip = strip.map_err(ReportError::from)?;
        files.push(ResultFile::new(format!("view-{}.png", at + 1), strip.clone()));
        let held = if is_held_out { ", held out" } else { "" };
        shown.push((format!("{name}{held}"), strip));
    }
    pictures(made, report, &mut files, &mut shown)?;
    let settings = sorted_json(&report.settings).map_err(ReportError::from)?;
    let page = page(report, &shown, settings.trim_end());
    files.push(ResultFile::new("report.html", page.into_bytes()));
    let json = sorted_json(report).map_err(ReportError::from)?;
    files.push(ResultFile::new("report.json", json.into_bytes()));
    Ok(files)
}

/// Pictures of maps and products.
fn pictures(
    made: &Extraction,
    report: &PaintReport,
    files: &mut Vec<ResultFile>,
    shown: &mut Vec<(String, Vec<u8>)>,
) -> Result<(), ReportError> {
    let light = Light::Directional(DirectionalLight::default());
    for (at, component) in made.material.components.iter().enumerate() {
        let film = render_sphere(component.product.angular(), &light, &SphereView::default());
        let sphere = encode_png(&ToneMap::exposed_for(&film).apply(&film))?;
        shown.push((format!("product {}, factors of directions", at + 1), sphere));
        let Some(map) = &component.coefficients else { continue };
        let picture = encode_png(&map_view(map))?;
        files.push(ResultFile::new(format!("map-{}.png", at + 1), picture.clone()));
        let exr = encode_exr(map.size, map.size, &[("Y", map.values.clone())])?;
        files.push(ResultFile::new(format!("map-{}.exr", at + 1), exr));
        shown.push((format!("map {}", at + 1), picture));
    }
    if !made.unconstrained.is_empty() {
        let coverage = encode_png(&coverage_view(report.settings.map_size, &made.unconstrained))?;
        files.push(ResultFile::new("coverage.png", coverage.clone()));
        shown.push(("coverage: violet was filled".to_owned(), coverage));
    }
    let contradictions = encode_png(&contradictions_view(&made.contradictions))?;
    files.push(ResultFile::new("contradictions.png", contradictions.clone()));
    shown.push(("red: views contradict each other".to_owned(), contradictions));
    Ok(())
}

fn page(report: &PaintReport, pictures: &[(String, Vec<u8>)], settings: &str) -> String {
    let held_out = report.rms.held_out.map_or_else(|| "null".to_owned(), |rms| rms.to_string());
    document(
        "painted material",
        &html! {
            p {
                "RMS " (report.rms.train) " over " (report.samples) " painted pixels; of views and lights "
                "that were not used: " (held_out) "."
            }
            ul { @for note in &report.notes { li { (note) } } }
            @for (caption, bytes) in pictures {
                figure { (picture(bytes, caption)) figcaption { (caption) } }
            }
            h2 { "Settings" }
            pre { (settings) }
        },
    )
}
