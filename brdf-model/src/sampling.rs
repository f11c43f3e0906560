//! Directions and direction pairs, drawn from sequences that depend on a seed alone.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use brdf_param::{DirectionPair, HemisphereMap, spherical_direction};
use glam::{DVec2, DVec3};

/// A four-dimensional Sobol sequence with nested uniform (Owen) scrambling.
///
/// Direction numbers: Joe and Kuo 2008. The scrambling is a hash that acts on the bit-reversed
/// sample as Owen's permutation tree does (Laine and Karras 2011). Points can be asked for at any index
/// and in any order.
///
/// ```
/// use brdf_model::ScrambledSobol;
///
/// let sobol = ScrambledSobol::new(7);
/// let mean = (0..256).map(|index| sobol.point(index)[2]).sum::<f64>() / 256.0;
/// assert!((mean - 0.5).abs() < 1e-2);
/// assert_eq!(sobol.planar_point(3), [sobol.point(3)[0], sobol.point(3)[1]]);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ScrambledSobol {
    scramble: [u32; 4],
}

/// For the dimensions after the first: initial direction numbers m₁…m_s and the inner coefficients
/// of the primitive polynomial of degree s.
const JOE_KUO: [(&[u32], u32); 3] = [(&[1], 0), (&[1, 3], 1), (&[1, 3, 1], 1)];

const DIRECTIONS: [[u32; 32]; 4] = [
    van_der_corput(),
    direction_numbers(JOE_KUO[0].0, JOE_KUO[0].1),
    direction_numbers(JOE_KUO[1].0, JOE_KUO[1].1),
    direction_numbers(JOE_KUO[2].0, JOE_KUO[2].1),
];

impl ScrambledSobol {
    /// Returns the sequence scrambled by a seed.
    pub fn new(seed: u64) -> Self {
        let low = hash_u64(seed);
        let high = hash_u64(low ^ 0x9e37_79b9_7f4a_7c15);
        #[expect(clippy::cast_possible_truncation, reason = "the two halves of a u64")]
        let halves = |v: u64| [v as u32, (v >> 32) as u32];
        let ([a, b], [c, d]) = (halves(low), halves(high));
        Self { scramble: [a, b, c, d] }
    }

    /// Returns the seed of the held-out samples for a fit with `seed`.
    ///
    /// Errors on held-out samples are taken over 20,000 pairs of that scramble everywhere.
    pub fn held_out_seed(seed: u64) -> u64 {
        hash_u64(seed ^ 0x4e6f_7453_6565_6e21)
    }

    /// Returns the seed of the validation samples for a fit with `seed`.
    ///
    /// Choices between models are made by these samples, which are neither fitted nor held out.
    pub fn validation_seed(seed: u64) -> u64 {
        hash_u64(seed ^ 0x5661_6c69_6461_7465)
    }

    /// Returns the point at `index`, in (0, 1)⁴.
    pub fn point(&self, index: u32) -> [f64; 4] {
        std::array::from_fn(|dimension| self.coordinate(index, dimension))
    }

    /// Returns the first two coordinates of the point at `index`.
    pub fn planar_point(&self, index: u32) -> [f64; 2] {
        std::array::from_fn(|dimension| self.coordinate(index, dimension))
    }

    fn coordinate(&self, index: u32, dimension: usize) -> f64 {
        let scrambled = owen(sobol(index, &DIRECTIONS[dimension]), self.scramble[dimension]);
        (f64::from(scrambled) + 0.5) / 4_294_967_296.0
    }
}

const fn van_der_corput() -> [u32; 32] {
    let mut v = [0; 32];
    let mut bit = 0;
    while bit < 32 {
        v[bit] = 1 << (31 - bit);
        bit += 1;
    }
    v
}

const fn direction_numbers(m: &[u32], inner: u32) -> [u32; 32] {
    let degree = m.len();
    let mut v = [0; 32];
    let mut bit = 0;
    while bit < 32 {
        v[bit] = if bit < degree {
            m[bit] << (31 - bit)
        } else {
            let mut value = v[bit - degree] ^ (v[bit - degree] >> degree);
            let mut term = 1;
            while term < degree {
                if inner >> (degree - 1 - term) & 1 == 1 {
                    value ^= v[bit - term];
                }
                term += 1;
            }
            value
        };
        bit += 1;
    }
    v
}

fn sobol(index: u32, directions: &[u32; 32]) -> u32 {
    let (mut value, mut bits) = (0, index);
    while bits != 0 {
        value ^= directions[bits.trailing_zeros() as usize];
        bits &= bits - 1;
    }
    value
}

fn owen(value: u32, seed: u32) -> u32 {
    let mut x = value.reverse_bits();
    x = x.wrapping_add(seed);
    x ^= x.wrapping_mul(0x6c50_b47c);
    x ^= x.wrapping_mul(0xb82f_1e52);
    x ^= x.wrapping_mul(0xc7af_e638);
    x ^= x.wrapping_mul(0x8d22_f6e6);
    x.reverse_bits()
}

/// The finalizer of SplitMix64.
fn hash_u64(seed: u64) -> u64 {
    let mut z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A way to draw direction pairs, for fitting and for comparing models.
///
/// The pairs are uniform on the product of two parabolic discs. For a point (a, b, c, d) of the
/// scrambled Sobol sequence, `wi` has parabolic radius tan(θmax/2)·√a and azimuth 2πb, and `wo` likewise
/// with c and d.
///
/// ```
/// use brdf_model::PairSampling;
/// use brdf_param::polar_angle;
///
/// let sampling = PairSampling { count: 64, seed: 1, theta_max: 1.2 };
/// let pairs: Vec<_> = sampling.pairs().collect();
/// assert_eq!(pairs.len(), 64);
/// assert!(pairs.iter().all(|pair| polar_angle(pair.wi).max(polar_angle(pair.wo)) <= 1.2));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairSampling {
    /// Number of pairs.
    pub count: u32,
    /// Seed of the scramble of the sequence.
    pub seed: u64,
    /// Largest angle to the normal, radians, (0, π/2].
    pub theta_max: f64,
}

impl PairSampling {
    /// Returns the pairs, in the order of the sequence.
    pub fn pairs(&self) -> impl Iterator<Item = DirectionPair> + use<> {
        let sobol = ScrambledSobol::new(self.seed);
        let this = *self;
        (0..self.count).map(move |index| {
            let [a, b, c, d] = sobol.point(index);
            DirectionPair::new(this.direction(a, b), this.direction(c, d))
        })
    }

    /// Returns pairs that crowd around the mirror direction, where gloss is: `wi` as in
    /// [`PairSampling::pairs`], a half vector at θh = 90° c² and azimuth 2πd, and `wo` the mirror image of
    /// `wi` about it.
    ///
    /// Pairs whose `wo` lies beyond the limit are left out, so that there are fewer than `count`.
    ///
    /// ```
    /// use brdf_model::PairSampling;
    /// use brdf_param::polar_angle;
    ///
    /// let sampling = PairSampling { count: 1000, seed: 1, theta_max: 1.2 };
    /// let pairs: Vec<_> = sampling.highlight_pairs().collect();
    /// let near = pairs.iter().filter(|pair| polar_angle(pair.half()) < 0.1).count();
    /// assert!(pairs.len() > 500 && near > pairs.len() / 5);
    /// ```
    pub fn highlight_pairs(&self) -> impl Iterator<Item = DirectionPair> + use<> {
        let this = *self;
        let sobol = ScrambledSobol::new(self.seed);
        let limit = self.theta_max.min(FRAC_PI_2).cos();
        (0..self.count).filter_map(move |index| {
            let [a, b, c, d] = sobol.point(index);
            let wi = this.direction(a, b);
            let half = spherical_direction(FRAC_PI_2 * c * c, TAU * d);
            let wo = 2.0 * wi.dot(half) * half - wi;
            (wi.dot(half) > 0.0 && wo.z >= limit).then(|| DirectionPair::new(wi, wo.normalize()))
        })
    }

    /// The direction at a point of the unit square, uniform on the parabolic disc within the limit.
    fn direction(&self, a: f64, b: f64) -> DVec3 {
        let radius = (0.5 * self.theta_max.min(FRAC_PI_2)).tan();
        let disc = radius * a.sqrt() * DVec2::from_angle(TAU * b);
        HemisphereMap::Parabolic.decode(disc).unwrap_or(DVec3::Z)
    }
}

/// Returns a direction of the upper hemisphere, uniform in solid angle, for a point of the unit square.
pub fn uniform_hemisphere(u: f64, v: f64) -> DVec3 {
    let sin_theta = (1.0 - u * u).max(0.0).sqrt();
    let (sin_phi, cos_phi) = (TAU * v).sin_cos();
    DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, u)
}

/// Returns a direction with pdf cosθ/π and that pdf, per steradian, for a point of the unit square.
pub fn cosine_hemisphere(u: f64, v: f64) -> (DVec3, f64) {
    let disc = u.sqrt() * DVec2::from_angle(TAU * v);
    let direction = disc.extend((1.0 - u).max(0.0).sqrt());
    (direction, direction.z / PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every elementary interval of a (0, m, 2)-net holds one point; scrambling keeps that.
    #[test]
    fn the_first_two_dimensions_are_a_net() {
        let sobol = ScrambledSobol::new(7);
        for split in 0..=6_u32 {
            let (columns, rows) = (1_u32 << split, 1_u32 << (6 - split));
            let mut seen = std::collections::HashSet::new();
            for index in 0..64 {
                let [a, b, ..] = sobol.point(index);
                let cell = ((a * f64::from(columns)).floor(), (b * f64::from(rows)).floor());
                assert!(
                    seen.insert((cell.0.to_bits(), cell.1.to_bits())),
                    "two points in cell {cell:?} of {columns} × {rows}"
                );
            }
        }
    }

    /// Each dimension alone is stratified, and no two dimensions are the same.
    #[test]
    fn every_dimension_is_stratified_on_its_own() {
        let sobol = ScrambledSobol::new(1);
        for dimension in 0..4 {
            let mut cells: Vec<f64> =
                (0..1024).map(|i| (sobol.point(i)[dimension] * 1024.0).floor()).collect();
            cells.sort_by(f64::total_cmp);
            assert!(cells.windows(2).all(|w| w[1] - w[0] > 0.5), "dimension {dimension}");
        }
        let [a, b, c, d] = sobol.point(12_345);
        let distinct: std::collections::HashSet<u64> = [a, b, c, d].map(f64::to_bits).into();
        assert_eq!(distinct.len(), 4, "{a} {b} {c} {d}");
    }

    #[test]
    fn pairs_stay_within_the_grazing_limit() {
        let sampling = PairSampling { count: 1000, seed: 3, theta_max: 80_f64.to_radians() };
        let limit = sampling.theta_max.cos() - 1e-12;
        assert!(sampling.pairs().all(|pair| pair.wi.z >= limit && pair.wo.z >= limit));
    }
}
