//! The folder of results of a sweep of relighting.

use brdf_image::{Panel, ToneMap, encode_png, strip};
use brdf_plot::{Curves, Scale, Series, plot_curves};
use brdf_relight::{Sweep, SweepReport};

use crate::error::ReportError;
use crate::files::{ResultFile, sorted_json};
use crate::numbers::significant;

/// Returns the files of a folder of results: `strip.png`, the pictures and that of brute force; `errors.svg`, and
/// `report.json`. `mesh` is what the object is called.
///
/// # Errors
///
/// [`ReportError`] for pictures and figures that cannot be made.
pub fn sweep_files(
    report: &SweepReport,
    swept: &Sweep,
    mesh: &str,
) -> Result<Vec<ResultFile>, ReportError> {
    let tone = ToneMap { exposure: report.exposure };
    let panel = |(film, caption)| Panel { picture: tone.apply(film), caption };
    let mut panels: Vec<Panel> =
        swept.films.iter().zip(sweep_captions(report)).map(panel).collect();
    panels.push(panel((&swept.exact, "brute force".to_owned())));
    let values = report.numbers.values().iter().map(|value| *value as f64);
    let curves = Curves {
        title: format!("{} of {mesh}", report.material),
        x: report.numbers.name().to_owned(),
        y: "relative RMS of the picture".to_owned(),
        y_scale: Scale::Log,
        series: vec![Series::new(
            report.env.as_str(),
            values.zip(report.relative_rms.iter().copied()).collect(),
        )],
    };
    Ok(vec![
        ResultFile::new("strip.png", encode_png(&strip(&panels))?),
        ResultFile::new("errors.svg", plot_curves(&[curves], 1)?.svg().as_bytes().to_vec()),
        ResultFile::new("report.json", sorted_json(report)?.into_bytes()),
    ])
}

/// Returns what each picture of a sweep shows, and its error.
pub fn sweep_captions(report: &SweepReport) -> Vec<String> {
    let what = report.numbers.name();
    let each = report.numbers.values().iter().zip(&report.relative_rms);
    each.map(|(value, error)| format!("{what}: {value}, RMS {}", significant(*error))).collect()
}
