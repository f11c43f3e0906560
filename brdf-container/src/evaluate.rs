//! Values of a material at given pairs, with counts of what was not as asked.

use brdf_factor::EvalCounts;
use brdf_model::Rgb;
use brdf_param::DirectionPair;

use crate::open::{Content, MaterialFile};

/// Values of a material, sr⁻¹.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluated {
    /// One for each pair: NaN where a measured table has no data, 0 below the horizon.
    pub values: Vec<Rgb>,
    /// Pairs below the horizon.
    pub below_horizon: usize,
    /// Pairs above it without data.
    pub without_data: usize,
    /// Pairs for which a sum of products has a negative channel, set to 0.
    pub negative: usize,
    /// What evaluating a product of textures did, and its grazing limit in radians; none of everything else.
    pub factored: Option<(EvalCounts, f64)>,
}

impl MaterialFile {
    /// Returns the values at some pairs.
    pub fn evaluate(&self, pairs: &[DirectionPair]) -> Evaluated {
        let brdf = self.brdf();
        let mut found = Evaluated {
            values: Vec::with_capacity(pairs.len()),
            below_horizon: 0,
            without_data: 0,
            negative: 0,
            factored: None,
        };
        for pair in pairs {
            let is_lit = pair.wi.z > 0.0 && pair.wo.z > 0.0;
            let is_known = !is_lit || brdf.has_data(pair);
            found.below_horizon += usize::from(!is_lit);
            found.without_data += usize::from(!is_known);
            found.values.push(if is_known { brdf.eval(pair) } else { Rgb::splat(f64::NAN) });
        }
        match &self.content {
            Content::Separable(_) => {
                let is_negative = |pair: &&DirectionPair| {
                    brdf.eval_unclamped(pair).channels().iter().any(|v| *v < 0.0)
                };
                found.negative = pairs.iter().filter(is_negative).count();
            }
            Content::Factored(file) => {
                let counts = file.model.count(pairs.iter().copied());
                found.factored = Some((counts, file.model.theta_max()));
            }
            Content::Preset(_) | Content::Measured(_) | Content::Compact(_) => {}
        }
        found
    }
}
