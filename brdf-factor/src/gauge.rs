//! What a product of textures leaves open: numbers that one factor can have more of if another has less.
//!
//! Constants always can be moved. Where two textures have the same texels along the same angle, so can functions of
//! that angle. Neither changes a value; both change how far the texels of a texture lie apart, and with that how well
//! few bits tell them apart.

use crate::texels::ends;
use crate::{Axis, Coordinate, Factor};

/// Log texels of a factor, row by row.
type Texels = Vec<[f64; 4]>;

/// Rounds over all pairs of textures. Two textures need one; among more, later pairs undo little of earlier ones.
const ROUNDS: usize = 3;

/// Returns the texels of every factor, such that they lie as near to each other as can be: functions of a shared angle
/// are split so that ranges are small, and constants so that all ranges have the same middle.
pub(crate) fn balanced(factors: &[Factor]) -> Vec<Texels> {
    let mut texels: Vec<Texels> = factors
        .iter()
        .map(|factor| factor.texels().iter().map(|texel| texel.map(f64::from)).collect())
        .collect();
    let mut pairs = Vec::new();
    for second in 1..factors.len() {
        for first in 0..second {
            let lines = shared_lines(&factors[first], &factors[second]);
            pairs.extend(lines.map(|lines| ([first, second], lines)));
        }
    }
    for _ in 0..ROUNDS {
        for ([first, second], [lines, other_lines]) in &pairs {
            let (before, after) = texels.split_at_mut(*second);
            for channel in 0..4 {
                let one = Side { texels: &mut before[*first], lines, uses: uses(&factors[*first]) };
                let other = Side {
                    texels: &mut after[0],
                    lines: other_lines,
                    uses: uses(&factors[*second]),
                };
                share(one, other, channel);
            }
        }
    }
    centre(factors, &mut texels);
    texels
}

/// A texture that shares an angle with another.
struct Side<'a> {
    texels: &'a mut Texels,
    /// The line of each texel along that angle.
    lines: &'a [usize],
    uses: f64,
}

impl Side<'_> {
    /// What each line adds to a value at least and at most.
    fn ends(&self, channel: usize) -> Vec<[f64; 2]> {
        let count = self.lines.iter().max().map_or(0, |last| last + 1);
        let mut all = vec![[f64::INFINITY, f64::NEG_INFINITY]; count];
        for (texel, &line) in self.texels.iter().zip(self.lines) {
            let value = self.uses * texel[channel];
            let [low, high] = all[line];
            all[line] = [low.min(value), high.max(value)];
        }
        all
    }

    fn add(&mut self, channel: usize, moved: &[f64]) {
        for (texel, &line) in self.texels.iter_mut().zip(self.lines) {
            texel[channel] += moved[line] / self.uses;
        }
    }
}

/// Moves a function of the shared angle from one texture to the other, so that the sum of both ranges is as small as
/// it can be.
///
/// Let a line of the first texture reach from a to A, that of the second from b to B, and be g moved. Ranges [α, α + R]
/// and [β, β + Q] hold all lines for some g just if R ≥ A − a, Q ≥ B − b, α + β ≤ a + b and A + B ≤ α + β + R + Q for
/// all of them, which leaves for g what lies between max(α − a, B − β − Q) and min(α + R − A, b − β).
fn share(mut first: Side<'_>, mut second: Side<'_>, channel: usize) {
    let (ones, others) = (first.ends(channel), second.ends(channel));
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::NEG_INFINITY, f64::max);
    let pairs = || ones.iter().zip(&others);
    let low = -most(&mut pairs().map(|(one, other)| -(one[0] + other[0])));
    let high = most(&mut pairs().map(|(one, other)| one[1] + other[1]));
    let width = |ends: &[[f64; 2]]| most(&mut ends.iter().map(|[low, high]| high - low));
    let (one_width, other_width) = (width(&ones), width(&others));
    let both = (high - low).max(one_width + other_width);
    // What rounding adds to a value has a mean square of the range², in eight bits, over the uses.
    let one_range = both * first.uses / (first.uses + second.uses);
    let one_range = one_range.min(both - other_width).max(one_width);
    let other_range = both - one_range;
    let one_low = 0.0;
    let other_low = 0.5 * (low + high - both);
    let moved: Vec<f64> = pairs()
        .map(|([a, a_most], [b, b_most])| {
            let least = (one_low - a).max(b_most - other_low - other_range);
            let most = (one_low + one_range - a_most).min(b - other_low);
            0.5 * (least + most)
        })
        .collect();
    first.add(channel, &moved);
    second.add(channel, &moved.iter().map(|moved| -moved).collect::<Vec<_>>());
}

/// The number of times that a value reads a texture.
fn uses(factor: &Factor) -> f64 {
    factor.coordinates().len() as f64
}

/// Moves constants so that the ranges of all factors have one middle in each channel.
fn centre(factors: &[Factor], texels: &mut [Texels]) {
    let all_uses: f64 = factors.iter().map(uses).sum();
    for channel in 0..4 {
        let middle = |texels: &Texels| {
            let [low, high] = ends(texels.iter().map(|texel| texel[channel]));
            0.5 * (low + high)
        };
        let middles: Vec<f64> = texels.iter().map(middle).collect();
        let total: f64 = middles.iter().zip(factors).map(|(m, factor)| m * uses(factor)).sum();
        for (texels, middle) in texels.iter_mut().zip(middles) {
            texels.iter_mut().for_each(|texel| texel[channel] += total / all_uses - middle);
        }
    }
}

/// The line of each texel along an angle.
type Lines = Vec<usize>;

/// The lines of texels along an angle that both factors have, with equal texels; none where there is no such angle.
fn shared_lines(first: &Factor, second: &Factor) -> Option<[Lines; 2]> {
    let shared = |a: usize| {
        let axis = movable(first, a)?;
        let b = (0..2).find(|&b| movable(second, b) == Some(axis))?;
        let same = side(first, a) == side(second, b)
            && first.extent()[a].to_bits() == second.extent()[b].to_bits();
        same.then(|| [lines(first, a), lines(second, b)])
    };
    (0..2).find_map(shared)
}

/// The axis along which a function may be added to a texture: one that all coordinates read at the same place, and
/// whose lines stay whole where texels stand for one place.
fn movable(factor: &Factor, at: usize) -> Option<Axis> {
    let axis_of = |coordinate: &Coordinate| match coordinate {
        Coordinate::Isotropic { axes, swapped } => Some((axes[at], *swapped)),
        _ => None,
    };
    let (axis, _) = axis_of(factor.coordinates().first()?)?;
    let stays = |coordinate| {
        axis_of(coordinate).is_some_and(|(other, swapped)| {
            other == axis && (!swapped || axis.angle.is_reciprocal())
        })
    };
    let lines = lines(factor, at);
    let is_on_a_line = |group: &Vec<usize>| group.iter().all(|&t| lines[t] == lines[group[0]]);
    let is_whole = factor.description().joined_texels().iter().all(is_on_a_line);
    (factor.coordinates().iter().all(stays) && is_whole).then_some(axis)
}

fn side(factor: &Factor, at: usize) -> usize {
    [factor.grid().columns, factor.grid().rows][at]
}

fn lines(factor: &Factor, at: usize) -> Lines {
    let columns = factor.grid().columns;
    let line = |texel| if at == 0 { texel % columns } else { texel / columns };
    (0..factor.grid().texels()).map(line).collect()
}

#[cfg(test)]
mod tests {
    use brdf_param::{Bound, DirectionPair, DiscRadii};
    use proptest::prelude::*;

    use super::*;
    use crate::coordinate::PairPlace;
    use crate::{FactorDescription, FactorSpec, IsotropicPairs, Spacing};

    /// Factors of these specs with texels from a list, those that stand for one place alike.
    fn factors(specs: &[FactorSpec], values: &[f32]) -> Vec<Factor> {
        let mut values = values.iter().copied().cycle();
        let radii = DiscRadii { first: 1.4, second: 1.3 };
        let factor = |spec: &FactorSpec| {
            let grid = spec.grid(5);
            let description =
                FactorDescription::new(&spec.coordinates, grid, Bound::Disc, radii).unwrap();
            let mut texels: Vec<[f32; 4]> = (0..grid.texels())
                .map(|_| std::array::from_fn(|_| values.next().unwrap()))
                .collect();
            for group in description.joined_texels() {
                group.iter().for_each(|&texel| texels[texel] = texels[group[0]]);
            }
            Factor::new(description, Some(texels)).unwrap()
        };
        specs.iter().map(factor).collect()
    }

    fn all_specs() -> Vec<Vec<FactorSpec>> {
        let mut all = vec![FactorSpec::mccool(true), FactorSpec::radial(false)];
        for pairs in IsotropicPairs::ALL {
            for reciprocal in [true, false] {
                all.push(pairs.specs(Spacing::Power { exponent: 0.5 }, 200, reciprocal));
            }
        }
        all
    }

    fn value(factors: &[Factor], texels: &[Texels], pair: &DirectionPair) -> f64 {
        let place = PairPlace::new(pair);
        let mut sum = 0.0;
        for (factor, texels) in factors.iter().zip(texels) {
            factor.for_each_tap(&place, |texel, weight| sum += weight * texels[texel][1]);
        }
        sum
    }

    fn width(texels: &Texels) -> f64 {
        let [low, high] = ends(texels.iter().map(|texel| texel[1]));
        high - low
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn balancing_changes_no_value_and_widens_no_sum_of_ranges(
            which in 0..8_usize,
            values in prop::collection::vec(-20.0..20.0_f32, 97),
            angles in prop::collection::vec((0.0..1.5_f64, -3.2..3.2_f64, 0.0..1.5_f64), 20),
        ) {
            let factors = factors(&all_specs()[which], &values);
            let before: Vec<Texels> = factors
                .iter()
                .map(|factor| factor.texels().iter().map(|texel| texel.map(f64::from)).collect())
                .collect();
            let after = balanced(&factors);
            for (theta_i, phi, theta_o) in angles {
                let pair = DirectionPair::from_angles(theta_i, 0.0, theta_o, phi);
                let [old, new] = [&before, &after].map(|texels| value(&factors, texels, &pair));
                // Values of 20 from each of up to eight reads are added up on the way.
                prop_assert!((new - old).abs() <= 1e-12 * 160.0, "{old} became {new}");
            }
            let sum = |texels: &[Texels]| -> f64 {
                texels.iter().zip(&factors).map(|(texels, f)| uses(f) * width(texels)).sum()
            };
            prop_assert!(sum(&after) <= sum(&before) + 1e-9);
            for (factor, texels) in factors.iter().zip(&after) {
                for group in factor.description().joined_texels() {
                    for &texel in &group {
                        prop_assert_eq!(texels[texel], texels[group[0]], "one place, one value");
                    }
                }
            }
        }
    }

    #[test]
    fn a_function_of_a_shared_angle_goes_where_it_widens_nothing() {
        let specs = IsotropicPairs::Polar.specs(Spacing::Linear, 300, true);
        let mut factors = factors(&specs, &[0.0]);
        // The same steep function of θh, added to one texture and taken from the other.
        for (index, sign) in [(0, 1.0), (1, -1.0)] {
            let columns = factors[index].grid().columns;
            let texels = (0..factors[index].grid().texels()).map(|texel| {
                let column = f32::from(u8::try_from(texel % columns).unwrap());
                [sign * column * column; 4]
            });
            let texels: Vec<[f32; 4]> = texels.collect();
            factors[index].set_texels(texels).unwrap();
        }
        for texels in balanced(&factors) {
            assert!(width(&texels) < 1e-12, "nothing is left of it");
        }
    }

    #[test]
    fn constants_meet_in_the_middle() {
        let factors = factors(&FactorSpec::mccool(true), &[-3.0, 9.0, 2.0]);
        let level = |texels: &Texels| {
            let [low, high] = ends(texels.iter().map(|texel| texel[0]));
            0.5 * (low + high)
        };
        let after = balanced(&factors);
        assert!((level(&after[0]) - level(&after[1])).abs() < 1e-12);
    }
}
