//! The error against the number of textures.

use brdf_io::TermRecord;
use brdf_plot::{Curves, Plot, Scale, Series, plot_curves};

/// Mean square log errors over the number of textures, on a logarithmic scale: training, held out,
/// and McCool's model as a level; none where there are fewer than two models or an error is 0.
pub(crate) fn error_chart(terms: &[TermRecord], mccool: &TermRecord) -> Option<Plot> {
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
