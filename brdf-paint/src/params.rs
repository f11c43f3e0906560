//! Options of an extraction.

use brdf_factor::{ChannelTransform, FactorSpec, Plan};
use serde::{Deserialize, Serialize};

use crate::PaintError;
use crate::least_squares::CHUNKS;

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
    pub(crate) fn of(self, values: &[[f32; 3]]) -> [ChannelTransform; 3] {
        match self {
            Self::Offset(share) => [ChannelTransform::Offset { a: share * mean(values) }; 3],
            Self::Highlight => brightest(values).map(ChannelTransform::highlight),
        }
    }
}

/// Options of [`extract`](crate::extract()).
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
    /// μ ≥ 0, as of [`FactorParams::smoothing`](brdf_factor::FactorParams::smoothing).
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
    pub(crate) fn check(&self) -> Result<(), PaintError> {
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

    pub(crate) fn is_map(&self) -> bool {
        matches!(self.mode, Mode::MaterialMap | Mode::Hybrid)
    }

    pub(crate) fn plan(&self) -> Plan {
        let plan = Plan::of(&FactorSpec::radial(false), self.texels);
        match self.mode {
            Mode::Brdf | Mode::MaterialMap => plan,
            Mode::FourFactor | Mode::Hybrid => plan.with_surface(self.surface_size, self.wraps),
        }
    }
}

/// The largest value of each channel.
pub(crate) fn brightest(values: &[[f32; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|channel| values.iter().map(|v| f64::from(v[channel])).fold(0.0, f64::max))
}

fn mean(values: &[[f32; 3]]) -> f64 {
    let sum: f64 = values.iter().flatten().map(|v| f64::from(*v)).sum();
    let mean = sum / (3 * values.len()).max(1) as f64;
    // A black picture.
    if mean > 0.0 { mean } else { 1.0 }
}
