//! Where there is data.

use std::f64::consts::FRAC_PI_2;

use brdf_model::{Brdf, SampleSet};
use brdf_param::{DirectionPair, HalfDifference, polar_angle};

use crate::error::PlotError;
use crate::heat::{Field, Heat, HeatScale, plot_heat};
use crate::plot::Plot;

/// Bins along each side.
const BINS: usize = 30;
/// Azimuths at which a bin of angles is probed, and places along each side of it.
const AZIMUTHS: u32 = 24;
const PLACES: u32 = 3;

/// Plots where a material has data, in bins of (theta_i, theta_o) and (theta_h, theta_d).
///
/// For a material that can be evaluated a bin shows the share of pairs with data: holes and invalid cells are dark.
/// For scattered `rows` it shows how many of them fall into it.
///
/// # Errors
///
/// [`PlotError::Drawing`].
pub fn plot_coverage(
    name: &str,
    brdf: &dyn Brdf,
    rows: Option<&SampleSet>,
) -> Result<Plot, PlotError> {
    let mut counts = [Counts::default(), Counts::default()];
    if let Some(rows) = rows {
        for pair in rows.pairs() {
            let angles = HalfDifference::from_pair(&pair);
            counts[0].add([polar_angle(pair.wi), polar_angle(pair.wo)], true);
            counts[1].add([angles.theta_h, angles.theta_d], true);
        }
    } else {
        for (first, second, azimuth) in probes() {
            let plain = DirectionPair::from_angles(first, 0.0, second, azimuth);
            counts[0].add([first, second], brdf.has_data(&plain));
            let angles =
                HalfDifference { theta_h: first, phi_h: 0.0, theta_d: second, phi_d: azimuth };
            let pair = angles.to_pair();
            if pair.wi.z > 0.0 && pair.wo.z > 0.0 {
                counts[1].add([first, second], brdf.has_data(&pair));
            }
        }
    }
    let fields = counts.map(|c| if rows.is_some() { c.totals() } else { c.shares() });
    let scale = if rows.is_some() {
        let most =
            fields.iter().flat_map(|f| f.values.iter().flatten()).copied().fold(1.0, f64::max);
        HeatScale {
            label: "rows a bin".to_owned(),
            range: [0.0, most],
            log: false,
            clipped_below: false,
        }
    } else {
        HeatScale {
            label: "share with data".to_owned(),
            range: [0.0, 1.0],
            log: false,
            clipped_below: false,
        }
    };
    let axes = [["theta_i (°)", "theta_o (°)"], ["theta_h (°)", "theta_d (°)"]];
    let panels: Vec<Heat> = fields
        .into_iter()
        .zip(axes)
        .map(|(field, [x, y])| Heat {
            title: format!(
                "{name} (grey: no {})",
                if rows.is_some() { "rows" } else { "such pair" }
            ),
            x: x.to_owned(),
            y: y.to_owned(),
            extent: [90.0; 2],
            image: Some(field),
            contours: Vec::new(),
        })
        .collect();
    plot_heat(&panels, 2, Some(&scale))
}

/// Two polar angles and an azimuth, evenly over all bins.
fn probes() -> impl Iterator<Item = (f64, f64, f64)> {
    let steps = u32::try_from(BINS).unwrap_or(1) * PLACES;
    let angle = move |step: u32| FRAC_PI_2 * (f64::from(step) + 0.5) / f64::from(steps);
    (0..steps).flat_map(move |first| {
        (0..steps).flat_map(move |second| {
            (0..AZIMUTHS).map(move |turn| {
                let azimuth = std::f64::consts::TAU * (f64::from(turn) + 0.5) / f64::from(AZIMUTHS);
                (angle(first), angle(second), azimuth)
            })
        })
    })
}

/// Pairs in each bin, and those with data.
struct Counts(Vec<(f64, f64)>);

impl Default for Counts {
    fn default() -> Self {
        Self(vec![(0.0, 0.0); BINS * BINS])
    }
}

impl Counts {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "angles lie between 0 and a right one"
    )]
    fn add(&mut self, angles: [f64; 2], known: bool) {
        let [column, row] = angles.map(|a| ((a / FRAC_PI_2 * BINS as f64) as usize).min(BINS - 1));
        let bin = &mut self.0[row * BINS + column];
        bin.0 += 1.0;
        bin.1 += f64::from(u8::from(known));
    }

    /// Share with data; none where no pair can fall.
    fn shares(self) -> Field {
        let share = |(all, known): (f64, f64)| (all > 0.0).then(|| known / all);
        Field { columns: BINS, values: self.0.into_iter().map(share).collect() }
    }

    fn totals(self) -> Field {
        let count = |(all, _): (f64, f64)| (all > 0.0).then_some(all);
        Field { columns: BINS, values: self.0.into_iter().map(count).collect() }
    }
}
