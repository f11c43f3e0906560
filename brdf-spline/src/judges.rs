//! What trials are judged by: pairs that are neither nodes nor what models are held out on.

use brdf_model::{
    Brdf, Channels, Fidelity, FidelityErrors, GgxLobes, PairSampling, Rgb, ScrambledSobol,
};
use brdf_param::{DirectionPair, HalfDifference};

use crate::base::value_of;
use crate::channel::Channel;
use crate::fit::SplineSettings;
use crate::products::Products;

/// Pairs of each set.
const JUDGED_PAIRS: u32 = 1500;
/// Their largest angle to the normal, radians.
const JUDGED_THETA: f64 = 80.0 * std::f64::consts::PI / 180.0;

/// Returns the values of products that are not rounded.
pub(crate) fn evaluate(
    products: &Products,
    channels: &[Channel],
    base: Option<&GgxLobes>,
    pairs: &[DirectionPair],
) -> Vec<Rgb> {
    let harmonics = products.shape.harmonics();
    let values = pairs.iter().map(|pair| {
        let angles = HalfDifference::from_pair(pair);
        let base = value_of(base, pair);
        let y = products.eval_with(&harmonics, angles.theta_h, angles.theta_d, angles.phi_d);
        match channels {
            [grey] => Rgb::splat(grey.value(y[0], base.map(|base| base[0]))),
            _ => Rgb::from(std::array::from_fn(|c| {
                channels[c].value(y[c], base.map(|base| base[c]))
            })),
        }
    });
    values.collect()
}

/// Pairs away from the highlight and in it, and the material there.
pub(crate) struct Judges {
    sets: [Vec<DirectionPair>; 2],
    values: [Vec<Rgb>; 2],
    is_grey: bool,
}

impl Judges {
    pub(crate) fn new(brdf: &dyn Brdf, settings: &SplineSettings) -> Self {
        let seed = ScrambledSobol::validation_seed(settings.seed);
        let sampling = PairSampling { count: JUDGED_PAIRS, seed, theta_max: JUDGED_THETA };
        let known = |pairs: Vec<DirectionPair>| -> Vec<DirectionPair> {
            pairs.into_iter().filter(|p| brdf.has_data(p) && brdf.has_data(&p.swapped())).collect()
        };
        let uniform = known(sampling.pairs().collect());
        let half = PairSampling { count: JUDGED_PAIRS / 2, ..sampling };
        let highlight = known(half.highlight_pairs().collect());
        let is_grey = settings.channels == Channels::Luminance;
        let sets = [uniform, highlight];
        let values = sets.each_ref().map(|pairs| values_at(brdf, pairs, is_grey));
        Self { sets, values, is_grey }
    }

    /// Errors of the material against its mirror image, and against itself with directions exchanged.
    pub(crate) fn asymmetry(&self, brdf: &dyn Brdf) -> [f64; 2] {
        let mirrored = |pair: &DirectionPair| {
            let flip = |mut w: glam::DVec3| {
                w.y = -w.y;
                w
            };
            DirectionPair::new(flip(pair.wi), flip(pair.wo))
        };
        [mirrored, DirectionPair::swapped].map(|change: fn(&DirectionPair) -> DirectionPair| {
            self.judge(|pairs| {
                let changed: Vec<DirectionPair> = pairs.iter().map(change).collect();
                values_at(brdf, &changed, self.is_grey)
            })
        })
    }

    pub(crate) fn score(&self, products: &Products, channels: &[Channel]) -> f64 {
        self.judge(|pairs| evaluate(products, channels, None, pairs))
    }

    fn judge(&self, values: impl Fn(&[DirectionPair]) -> Vec<Rgb>) -> f64 {
        let [uniform, highlight] = [0, 1].map(|set| {
            let pairs = &self.sets[set];
            FidelityErrors::of(pairs, &self.values[set], &values(pairs))
        });
        Fidelity { uniform, highlight }.score()
    }
}

fn values_at(brdf: &dyn Brdf, pairs: &[DirectionPair], is_grey: bool) -> Vec<Rgb> {
    let mut values = Vec::new();
    brdf.eval_pairs(pairs, &mut values);
    if is_grey {
        values.iter_mut().for_each(|value| *value = Rgb::splat(value.luminance()));
    }
    values
}
