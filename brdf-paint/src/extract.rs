//! From samples to materials.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use brdf_factor::{
    ChannelTransform, Columns, FactorParams, FactorSpec, Inversion, Plan, Preinverted, Problem,
};
use brdf_job::{Job, StopCause};
use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::coefficient_map::{MapTaps, taps};
use crate::least_squares::CHUNKS;
use crate::{
    CoefficientMap, Component, Contradictions, PaintError, PaintErrors, PaintSamples,
    PaintedMaterial, alternating, paper,
};

/// The kind of material that is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// One BRDF of three radial factors, the same everywhere.
    Brdf,
    /// One BRDF of three radial factors, times a factor over the surface.
    FourFactor,
    /// A sum of BRDFs of three factors, weighted by maps.
    #[default]
    MaterialMap,
    /// A sum of products of four factors, weighted by maps.
    Hybrid,
}

/// The method by which a material map is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SolverChoice {
    /// One product after another, each scaled under what is left (the paper's).
    Paper,
    /// Maps and products in turns, from the paper's result or from clusters of texels, never worse than
    /// either.
    #[default]
    Alternating,
}

/// The logarithm through which products are fitted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum PaintLogTransform {
    /// log(a + f), a a share of the mean value: the more, the less dark samples weigh (Eq. 12).
    Offset(f64),
    /// log(a − f), a a little above the brightest value of each channel: favours highlights (Eq. 13).
    Highlight,
}

impl PaintLogTransform {
    /// The maps of the three channels.
    fn of(self, values: &[[f32; 3]]) -> [ChannelTransform; 3] {
        match self {
            Self::Offset(share) => [ChannelTransform::Offset { a: share * mean(values) }; 3],
            Self::Highlight => brightest(values).map(ChannelTransform::highlight),
        }
    }
}

/// Options of [`extract`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PaintParams {
    /// Kind of material.
    pub mode: Mode,
    /// Method by which a material map is found; not used by the other kinds.
    pub solver: SolverChoice,
    /// Number of summands of a material map, 1 to 20.
    pub products: usize,
    /// Number of texels of each radial factor.
    pub texels: usize,
    /// Number of texels along a side of a factor over the surface.
    pub surface_size: usize,
    /// Number of texels along a side of the maps, 4 to 4096.
    pub map_size: usize,
    /// μ ≥ 0, as of [`FactorParams::smoothing`].
    pub smoothing: f64,
    /// Logarithm through which products are fitted.
    pub log_map: PaintLogTransform,
    /// Whether u = 0 and u = 1 are one place of the surface.
    pub wraps: bool,
}

impl Default for PaintParams {
    fn default() -> Self {
        Self {
            mode: Mode::default(),
            solver: SolverChoice::default(),
            products: 5,
            texels: 64,
            surface_size: 32,
            map_size: 256,
            smoothing: 1e-4,
            log_map: PaintLogTransform::Offset(0.05),
            wraps: false,
        }
    }
}

/// Most memory for what maps are solved with.
const MOST_BYTES: usize = 4 << 30;

impl PaintParams {
    fn check(&self) -> Result<(), PaintError> {
        let sizes = [
            ("the number of products", self.products, 1..=20, "1 to 20"),
            ("the size of maps", self.map_size, 4..=4096, "4 to 4096"),
        ];
        for (option, value, range, expected) in sizes {
            if !range.contains(&value) {
                return Err(PaintError::Option { option, value: value as f64, expected });
            }
        }
        // Sums of each texel and pair of products, for each part of the samples.
        let sums = self.map_size.pow(2) * self.products.pow(2) * CHUNKS * size_of::<f32>();
        if self.is_map() && sums > MOST_BYTES {
            let (option, expected) =
                ("the size of maps", "fewer texels or products: 4 GiB of sums");
            return Err(PaintError::Option { option, value: self.map_size as f64, expected });
        }
        if let PaintLogTransform::Offset(value) = self.log_map
            && !(value > 0.0 && value.is_finite())
        {
            let (option, expected) = ("the offset", "a share of the mean above 0, such as 0.05");
            return Err(PaintError::Option { option, value, expected });
        }
        Ok(())
    }

    fn is_map(&self) -> bool {
        matches!(self.mode, Mode::MaterialMap | Mode::Hybrid)
    }

    fn plan(&self) -> Plan {
        let plan = Plan::of(&FactorSpec::radial(false), self.texels);
        match self.mode {
            Mode::Brdf | Mode::MaterialMap => plan,
            Mode::FourFactor | Mode::Hybrid => plan.with_surface(self.surface_size, self.wraps),
        }
    }
}

/// The result of [`extract`]: a material and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Extraction {
    /// The material.
    pub material: PaintedMaterial,
    /// Errors over the samples it was made from.
    pub errors: PaintErrors,
    /// Places where views do not agree.
    pub contradictions: Contradictions,
    /// Texels of the maps that no sample touches, row by row; they were filled from around them.
    pub unconstrained: Vec<bool>,
    /// Texels of factors that no sample touches; smoothing alone holds them.
    pub smoothed_texels: usize,
    /// Reason why turns ended early, if they did: the material is the best so far.
    pub stopped: Option<StopCause>,
}

/// Fits a material to samples.
///
/// # Errors
///
/// [`PaintError::NothingPainted`], [`PaintError::Option`]; [`PaintError::Factor`] as of [`Preinverted::new`];
/// [`PaintError::Stopped`].
pub fn extract(
    samples: &PaintSamples,
    params: &PaintParams,
    job: &Job<'_>,
) -> Result<Extraction, PaintError> {
    params.check()?;
    if samples.is_empty() {
        return Err(PaintError::NothingPainted { skipped: samples.skipped.to_string() });
    }
    // Leading parts of shuffled samples are spread over all pictures.
    let shuffled = samples.shuffled();
    let [inverting, decomposing] = job.split([1.0, 4.0]);
    inverting.begin("inverting", 1);
    let layout = Layout::new(&shuffled, params)?;
    let parts = match (params.is_map(), params.solver) {
        (false, _) => vec![layout.single(&shuffled)],
        (true, SolverChoice::Paper) => paper::decompose(&layout, &shuffled, params, &decomposing)?,
        (true, SolverChoice::Alternating) => {
            alternating::decompose(&layout, &shuffled, params, &decomposing)?
        }
    };
    let limit = brightest(&samples.values);
    let material = PaintedMaterial { components: layout.components(parts, params)?, limit };
    let predicted = material.predict(samples);
    let errors = samples.errors_of(&predicted);
    let contradictions = Contradictions::of(samples, &predicted, params.wraps);
    let unconstrained = if params.is_map() {
        layout.touched(params.map_size).iter().map(|touched| !touched).collect()
    } else {
        Vec::new()
    };
    let smoothed_texels = layout.inverted.untouched_texels().iter().map(Vec::len).sum();
    Ok(Extraction {
        material,
        errors,
        contradictions,
        unconstrained,
        smoothed_texels,
        stopped: job.stop_cause(),
    })
}

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
    fn new(samples: &PaintSamples, params: &PaintParams) -> Result<Self, PaintError> {
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
    fn single(&self, samples: &PaintSamples) -> Part {
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

    fn components(
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

/// The largest value of each channel.
fn brightest(values: &[[f32; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|channel| values.iter().map(|v| f64::from(v[channel])).fold(0.0, f64::max))
}

fn mean(values: &[[f32; 3]]) -> f64 {
    let sum: f64 = values.iter().flatten().map(|v| f64::from(*v)).sum();
    let mean = sum / (3 * values.len()).max(1) as f64;
    // A black picture.
    if mean > 0.0 { mean } else { 1.0 }
}
