//! Values between the cells of the MERL grid, one pair at a time.

use std::f64::consts::{FRAC_PI_2, PI};

use brdf_param::DirectionPair;

use crate::brdf::is_lit;
use crate::merl::{MerlLookup, MerlNodes, MerlTable};
use crate::{Brdf, DirectionSlices, Rgb, RgbBatch, merl_batch};

impl MerlTable {
    fn cell(&self, theta_h: usize, theta_d: usize, phi_d: usize) -> &[f32; 3] {
        &self.cells()[phi_d + Self::PHI_D * (theta_d + Self::THETA_D * theta_h)]
    }

    fn nearest(&self, at: GridPoint) -> Option<Rgb> {
        let theta_h = below(at.theta_h, Self::THETA_H);
        let theta_d = below(at.theta_d, Self::THETA_D);
        let phi_d = below(at.phi_d, Self::PHI_D);
        let cell = self.cell(theta_h, theta_d, phi_d);
        (cell[0] >= 0.0).then(|| Rgb::from(cell.map(f64::from)))
    }

    fn trilinear(&self, at: GridPoint, nodes: MerlNodes) -> Option<Rgb> {
        let shift = nodes.shift();
        let theta_h = Span::clamped(at.theta_h - shift, Self::THETA_H);
        let theta_d = Span::clamped(at.theta_d - shift, Self::THETA_D);
        let phi_d = Span::wrapped(at.phi_d - shift, Self::PHI_D);
        let mut sum = [0.0_f32; 3];
        let mut valid = 0.0_f32;
        for (h, weight_h) in theta_h.ends() {
            for (d, weight_d) in theta_d.ends() {
                for (p, weight_p) in phi_d.ends() {
                    let cell = self.cell(h, d, p);
                    // Invalid cells weigh nothing; no branch, for the memory to keep pace.
                    let known = f32::from(u8::from(cell[0] >= 0.0));
                    let weight = known * (weight_h * weight_d * weight_p);
                    valid += weight;
                    for (total, &value) in sum.iter_mut().zip(cell) {
                        *total += weight * value;
                    }
                }
            }
        }
        (valid > 0.0).then(|| Rgb::from(sum.map(|total| f64::from(total / valid))))
    }

    fn at(&self, at: GridPoint) -> Option<Rgb> {
        match self.lookup {
            MerlLookup::Nearest => self.nearest(at),
            MerlLookup::Trilinear(nodes) => self.trilinear(at, nodes),
        }
    }

    fn lookup(&self, pair: &DirectionPair) -> Option<Rgb> {
        if !is_lit(pair) {
            return None;
        }
        self.at(GridPoint::of(pair))
    }
}

impl Brdf for MerlTable {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        self.lookup(pair).unwrap_or(Rgb::BLACK)
    }

    fn has_data(&self, pair: &DirectionPair) -> bool {
        self.lookup(pair).is_some()
    }

    fn eval_batch(&self, pairs: DirectionSlices<'_>, out: &mut RgbBatch) {
        match self.lookup {
            MerlLookup::Trilinear(nodes) => merl_batch::evaluate(self.cells(), nodes, pairs, out),
            MerlLookup::Nearest => {
                out.resize(pairs.len());
                for index in 0..pairs.len() {
                    out.set(index, self.eval(&pairs.get(index)));
                }
            }
        }
    }
}

/// A place in the grid, each axis in cells: [0, 90] × [0, 90] × [0, 180).
#[derive(Clone, Copy)]
struct GridPoint {
    theta_h: f32,
    theta_d: f32,
    phi_d: f32,
}

impl GridPoint {
    /// Half/difference angles as in [`HalfDifference::from_pair`], rearranged to spend two
    /// arctangents less: for isotropic tables phi_h itself is not needed.
    fn of(pair: &DirectionPair) -> Self {
        let (wi, wo) = (pair.wi, pair.wo);
        let sum = wi + wo;
        let back = wi - wo;
        let planar = sum.truncate().length();
        let theta_h = planar.atan2(sum.z);
        let theta_d = back.length().atan2(sum.length());
        // Twice the difference vector's x and y in the frame of the half vector, up to a common
        // positive factor; see the test against the plain form.
        let across = sum.x * back.y - sum.y * back.x;
        let along = -back.z * sum.length();
        let phi_d = if planar > 0.0 { across.atan2(along) } else { back.y.atan2(back.x) };
        let phi_d = if phi_d < 0.0 { phi_d + PI } else { phi_d };
        #[expect(clippy::cast_possible_truncation, reason = "an f32 tells 1e-5 of a cell apart")]
        let narrow = |cells: f64| cells as f32;
        Self {
            theta_h: narrow((theta_h / FRAC_PI_2).sqrt() * 90.0),
            theta_d: narrow(theta_d / FRAC_PI_2 * 90.0),
            phi_d: narrow(phi_d / PI * 180.0),
        }
    }
}

/// Two neighbouring nodes and how far a point has gone from the first to the second.
struct Span {
    nodes: [usize; 2],
    fraction: f32,
}

impl Span {
    fn clamped(position: f32, count: usize) -> Self {
        let low = below(position, count);
        let fraction = (position - low as f32).clamp(0.0, 1.0);
        Self { nodes: [low, (low + 1).min(count - 1)], fraction }
    }

    fn wrapped(position: f32, count: usize) -> Self {
        let position = if position < 0.0 { position + count as f32 } else { position };
        let low = below(position, count);
        let next = if low + 1 == count { 0 } else { low + 1 };
        let fraction = (position - low as f32).clamp(0.0, 1.0);
        Self { nodes: [low, next], fraction }
    }

    fn ends(&self) -> [(usize, f32); 2] {
        [(self.nodes[0], 1.0 - self.fraction), (self.nodes[1], self.fraction)]
    }
}

/// The cell of a position: the first one below 0, the last one at or past the end.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "`as` saturates on both sides"
)]
fn below(position: f32, count: usize) -> usize {
    (position as usize).min(count - 1)
}

#[cfg(test)]
mod tests {
    use brdf_param::HalfDifference;

    use super::*;
    use crate::{DirectionBatch, PairSampling, Preset};

    #[test]
    fn the_short_form_of_the_angles_equals_the_plain_one() {
        let sampling = PairSampling { count: 20_000, seed: 5, theta_max: FRAC_PI_2 };
        for pair in sampling.pairs() {
            let angles = HalfDifference::from_pair(&pair);
            let at = GridPoint::of(&pair);
            let phi_d = if angles.phi_d < 0.0 { angles.phi_d + PI } else { angles.phi_d };
            assert!(
                (f64::from(at.theta_h) - (angles.theta_h / FRAC_PI_2).sqrt() * 90.0).abs() < 1e-5
            );
            assert!((f64::from(at.theta_d) - angles.theta_d.to_degrees()).abs() < 1e-5);
            let turn = (f64::from(at.phi_d) - phi_d.to_degrees()).abs();
            assert!(turn.min(180.0 - turn) < 2e-5, "{turn} at {pair:?}");
        }
    }

    #[test]
    fn a_batch_equals_single_lookups() {
        let table = MerlTable::tabulate(&Preset::find("plastic").unwrap().brdf());
        let sampling = PairSampling { count: 5_000, seed: 5, theta_max: FRAC_PI_2 };
        let pairs: Vec<DirectionPair> = sampling.pairs().collect();
        let mut out = RgbBatch::default();
        let batch: DirectionBatch = pairs.iter().collect();
        table.eval_batch(batch.as_slices(), &mut out);
        for (index, pair) in pairs.iter().enumerate() {
            let (single, batch) = (table.eval(pair).r, out.get(index).r);
            assert!(
                (single - batch).abs() < 1e-3 * single + 1e-6,
                "{batch} for {single}: {pair:?}"
            );
        }
    }

    #[test]
    fn cell_centres_find_their_own_cell() {
        let mut cells = vec![[0.25; 3]; MerlTable::CELLS];
        for (index, cell) in cells.iter_mut().enumerate() {
            let value = index as f32;
            *cell = [value; 3];
        }
        let table = MerlTable::new(cells.into_iter(), MerlLookup::Nearest).unwrap();
        let trilinear = table.clone().with_lookup(MerlLookup::Trilinear(MerlNodes::Centre));
        for index in (0..MerlTable::CELLS).step_by(997) {
            let pair = MerlTable::cell_pair(index);
            if !is_lit(&pair) {
                continue;
            }
            let expected = index as f64;
            assert!((table.eval(&pair).r - expected).abs() < 0.5, "nearest at {index}");
            // Where the trilinear weights put everything on one node up to rounding.
            assert!((trilinear.eval(&pair).r - expected).abs() < 0.01, "trilinear at {index}");
        }
    }

    #[test]
    fn a_tabulated_model_comes_back() {
        let plastic = Preset::find("plastic").unwrap().brdf();
        let table = MerlTable::tabulate(&plastic);
        let sampling = PairSampling { count: 5_000, seed: 9, theta_max: 75_f64.to_radians() };
        for pair in sampling.pairs() {
            let (exact, read) = (plastic.eval(&pair).r, table.eval(&pair).r);
            assert!((exact - read).abs() < 0.01 * exact, "{read} for {exact} at {pair:?}");
        }
    }

    #[test]
    fn invalid_cells_have_no_data_and_no_influence() {
        let mut cells = vec![[1.0; 3]; MerlTable::CELLS];
        cells[0] = [-1.0, 0.5, f32::NAN];
        let table = MerlTable::new(cells.into_iter(), MerlLookup::Nearest).unwrap();
        let pair = MerlTable::cell_pair(0);
        assert_eq!(table.invalid_cells(), 1);
        assert!(!table.has_data(&pair));
        assert_eq!(table.eval(&pair), Rgb::BLACK);
        let trilinear = table.with_lookup(MerlLookup::Trilinear(MerlNodes::Edge));
        let shifted = HalfDifference { theta_h: 0.001, phi_h: 0.0, theta_d: 0.012, phi_d: 0.004 };
        assert!((trilinear.eval(&shifted.to_pair()).g - 1.0).abs() < 1e-6);
    }
}
