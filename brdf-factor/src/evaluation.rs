//! A product of textures as a BRDF.

use brdf_model::{Brdf, DirectionSlices, Rgb, RgbBatch};
use brdf_param::DirectionPair;

use crate::FactoredBrdf;
use crate::batch;

impl Brdf for FactoredBrdf {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        let channels = self.eval_unclamped(pair).channels();
        // One ceiling serves all channels of a model of luminance.
        let ceilings = self.ceilings();
        let held = |c: usize| channels[c].min(ceilings[c.min(ceilings.len() - 1)]).max(0.0);
        Rgb::new(held(0), held(1), held(2))
    }

    fn eval_unclamped(&self, pair: &DirectionPair) -> Rgb {
        // Written so that NaN directions are not lit either.
        if !(pair.wi.z > 0.0 && pair.wo.z > 0.0) {
            return Rgb::BLACK;
        }
        let logs = self.log_values(pair);
        match self.maps() {
            [map] => Rgb::splat(map.inverse(logs[0])),
            [r, g, b] => Rgb::new(r.inverse(logs[0]), g.inverse(logs[1]), b.inverse(logs[2])),
            _ => Rgb::BLACK,
        }
    }

    fn eval_batch(&self, pairs: DirectionSlices<'_>, out: &mut RgbBatch) {
        batch::evaluate(self, pairs, out);
    }
}
