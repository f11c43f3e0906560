//! What compression of a BTF loses at which size.

use brdf_plot::{Curves, Plot, PlotError, Scale, Series, plot_curves};
use btf_vq::{Fidelity, RateMethod, RateRow};

/// Returns a table with a line for each point, for spreadsheets.
pub fn rate_csv(rows: &[RateRow]) -> String {
    let mut text = String::from("method,bytes,ratio,psnr_db,mssim\n");
    for RateRow { method, bytes, ratio, fidelity: Fidelity { psnr, mssim } } in rows {
        let method = method.label();
        text.push_str(&format!("\"{method}\",{bytes},{ratio:.1},{psnr:.3},{mssim:.4}\n"));
    }
    text
}

/// Returns both measures over bytes.
///
/// # Errors
///
/// [`PlotError`] of the plot.
pub fn rate_plot(rows: &[RateRow]) -> Result<Plot, PlotError> {
    let panel = |title: &str, y: &str, of: fn(&Fidelity) -> f64| Curves {
        title: title.to_owned(),
        x: "log10 of bytes".to_owned(),
        y: y.to_owned(),
        y_scale: Scale::Linear,
        series: RateMethod::ALL
            .map(|method| {
                let points = rows.iter().filter(|row| row.method == method);
                #[expect(clippy::cast_precision_loss, reason = "a place on an axis")]
                let points = points.map(|r| ((r.bytes as f64).log10(), of(&r.fidelity)));
                let mut points: Vec<(f64, f64)> = points.collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                Series::new(method.label(), points)
            })
            .into_iter()
            .filter(|series| !series.points.is_empty())
            .collect(),
    };
    let panels = [panel("PSNR", "dB", |f| f.psnr), panel("Mean SSIM", "MSSIM", |f| f.mssim)];
    plot_curves(&panels, 2)
}
