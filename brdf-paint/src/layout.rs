//! Where samples read factors and maps, and what they read there.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use brdf_factor::{ChannelTransform, Columns, FactorParams, Inversion, Preinverted, Problem};
use glam::DVec2;

use crate::coefficient_map::{MapTaps, taps};
use crate::{CoefficientMap, Component, PaintError, PaintParams, PaintSamples};

/// A product and its map, as they are solved for.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    /// Log texels, `[channel][unknown]`.
    pub(crate) solution: Vec<f64>,
    /// Values of the map; empty for 1 everywhere.
    pub(crate) coefficients: Vec<f32>,
}

/// Where samples read factors and maps.
pub(crate) struct Layout {
    pub(crate) problem: Problem,
    pub(crate) inverted: Preinverted,
    pub(crate) maps: [ChannelTransform; 3],
    /// Of each sample.
    pub(crate) taps: Vec<MapTaps>,
    places: Vec<DVec2>,
}

impl Layout {
    pub(crate) fn new(samples: &PaintSamples, params: &PaintParams) -> Result<Self, PaintError> {
        let factor_params = FactorParams {
            smoothing: params.smoothing,
            theta_max: FRAC_PI_2,
            ..FactorParams::default()
        };
        let problem = Problem::new(&samples.as_set(), &factor_params)?;
        let inverted =
            Preinverted::new(&problem, &samples.places, params.plan(), Inversion::Cholesky)?;
        let of = |place: &DVec2| taps(params.map_size, params.wraps, *place);
        let taps = samples.places.iter().map(of).collect();
        let maps = params.log_map.of(&samples.values);
        Ok(Self { problem, inverted, maps, taps, places: samples.places.clone() })
    }

    /// The problem of the first samples, and their columns.
    pub(crate) fn subset(&self, count: usize) -> (Problem, Vec<Arc<Columns>>) {
        let problem = self.problem.subset(count);
        let columns = self.inverted.columns_of(&problem, &self.places);
        (problem, columns)
    }

    /// One product fitted to all samples.
    pub(crate) fn single(&self, samples: &PaintSamples) -> Part {
        let mut workspace = self.inverted.workspace(3);
        self.inverted.solve(&by_channel(&samples.values), &self.maps, &mut workspace);
        Part { solution: workspace.solution().to_vec(), coefficients: Vec::new() }
    }

    /// Values of a product for all samples, 0 and above.
    #[expect(clippy::cast_possible_truncation, reason = "pictures are f32")]
    pub(crate) fn values(&self, solution: &[f64]) -> Vec<[f32; 3]> {
        let mut values = vec![[0.0; 3]; self.taps.len()];
        let unknowns = self.inverted.unknowns();
        for (channel, x) in solution.chunks_exact(unknowns).enumerate() {
            let logs = predicted(self.inverted.columns(), x);
            for (log, place) in logs.iter().zip(self.inverted.order()) {
                values[*place][channel] = self.maps[channel].inverse(*log).max(0.0) as f32;
            }
        }
        values
    }

    /// Whether a sample reads a texel of a map, for all of them.
    pub(crate) fn touched(&self, map_size: usize) -> Vec<bool> {
        let mut touched = vec![false; map_size * map_size];
        for (texel, share) in self.taps.iter().flatten() {
            touched[*texel] |= *share > 0.0;
        }
        touched
    }

    pub(crate) fn components(
        &self,
        parts: Vec<Part>,
        params: &PaintParams,
    ) -> Result<Vec<Component>, PaintError> {
        let (size, wraps) = (params.map_size, params.wraps);
        let components = parts.into_iter().map(|Part { solution, coefficients }| {
            let product = self.inverted.model_of(&solution, &self.maps)?;
            let coefficients = (!coefficients.is_empty()).then_some(CoefficientMap {
                size,
                wraps,
                values: coefficients,
            });
            Ok(Component { coefficients, product })
        });
        components.collect()
    }
}

/// What columns give samples, in their order.
pub(crate) fn predicted(columns: &[Arc<Columns>], x: &[f64]) -> Vec<f64> {
    let samples = columns.first().map_or(0, |columns| columns.samples());
    let (mut values, mut start) = (vec![0.0; samples], 0);
    for columns in columns {
        columns.add_values(&x[start..][..columns.unknowns()], &mut values);
        start += columns.unknowns();
    }
    values
}

pub(crate) fn by_channel(values: &[[f32; 3]]) -> Vec<Vec<f64>> {
    (0..3).map(|channel| values.iter().map(|v| f64::from(v[channel])).collect()).collect()
}
