//! How many functions a model has.

use crate::basis::CubicBasis;
use crate::harmonics::Symmetry;
use crate::nodes::NodeGrid;
use crate::products::Shape;
use crate::warp::HalfAxis;

/// How many functions a model has, and how many nodes they are fitted to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Size {
    pub(crate) terms: usize,
    pub(crate) half: usize,
    pub(crate) difference: usize,
    pub(crate) order: usize,
    pub(crate) grid: NodeGrid,
}

impl Size {
    /// Sizes that were the best at their bytes, for mirror symmetry and RGB: bytes, terms, splines over θh and θd, order
    /// of harmonics, nodes over θh, θd and half a turn of φd.
    const MEASURED: [[f64; 8]; 5] = [
        [300.0, 3.0, 16.0, 5.0, 2.0, 96.0, 20.0, 12.0],
        [1_000.0, 5.0, 28.0, 8.0, 4.0, 112.0, 26.0, 16.0],
        [2_700.0, 8.0, 40.0, 12.0, 7.0, 128.0, 32.0, 20.0],
        [8_192.0, 13.0, 56.0, 18.0, 8.0, 136.0, 40.0, 22.0],
        [33_000.0, 22.0, 80.0, 28.0, 13.0, 192.0, 56.0, 28.0],
    ];

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between numbers of the table"
    )]
    pub(crate) fn for_bytes(bytes: usize, symmetry: Symmetry, channels: usize) -> Self {
        // What symmetry and grey save is spent on more functions.
        let count = |symmetry: Symmetry| symmetry.harmonics(8).len() as f64;
        let saved =
            count(Symmetry::Mirror) / count(symmetry) * if channels == 1 { 2.0 } else { 1.0 };
        let bytes = bytes as f64 * saved.sqrt();
        let table = &Self::MEASURED;
        let above = (1..table.len() - 1).find(|&i| table[i][0] > bytes).unwrap_or(table.len() - 1);
        let [low, high] = [table[above - 1], table[above]];
        let t = ((bytes / low[0]).ln() / (high[0] / low[0]).ln()).max(0.0);
        let at = |i: usize| (low[i] + t * (high[i] - low[i])).round() as usize;
        let order = at(4) + usize::from(symmetry.is_reciprocal() && at(4) % 2 == 1);
        Self {
            terms: at(1),
            half: at(2),
            difference: at(3),
            order,
            grid: NodeGrid { theta_h: at(5), theta_d: at(6), phi_d: at(7) },
        }
    }

    /// A smaller size on fewer nodes, which ranks axes and offsets as the whole one does.
    pub(crate) fn trial(size: Self) -> Self {
        Self {
            terms: size.terms.min(8),
            half: size.half.min(40),
            difference: size.difference.min(10),
            order: size.order.min(4),
            grid: NodeGrid { theta_h: 80, theta_d: 16, phi_d: 8 },
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "what stands in a stream is f32")]
    pub(crate) fn shape(self, alpha: f64, symmetry: Symmetry, channels: usize) -> Shape {
        Shape {
            terms: self.terms,
            half: CubicBasis { count: self.half, is_even: true },
            axis: HalfAxis { alpha: f64::from(alpha as f32) },
            difference: CubicBasis { count: self.difference, is_even: false },
            symmetry,
            order: self.order,
            channels,
        }
    }
}
