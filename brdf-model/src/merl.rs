//! Isotropic BRDFs tabulated on the MERL grid.
//!
//! Source: Matusik, Pfister, Brand and McMillan 2003. The axes are half/difference angles. The theta_h
//! axis is quadratic, cell i spans i²/90 … (i + 1)²/90 degrees; theta_d and phi_d have cells of one degree.

use brdf_param::{DirectionPair, HalfDifference};
use serde::{Deserialize, Serialize};

use crate::large_table::LargeTable;
use crate::{Brdf, ModelError};

/// The place in a cell at which its value is taken to hold.
///
/// Other software disagrees: libbsdf takes the lower edge, ALTA the centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum MerlNodes {
    /// The centre of the cell: i + ½ on each axis, in cells.
    Centre,
    /// The lower edge of the cell: i on each axis, in cells.
    Edge,
}

impl MerlNodes {
    /// Returns the place of the first node, in cells: ½ or 0.
    pub fn shift(self) -> f32 {
        match self {
            Self::Centre => 0.5,
            Self::Edge => 0.0,
        }
    }
}

/// The way in which a table is read between its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MerlLookup {
    /// The value of the cell that the pair falls into, as the database's own reader does.
    Nearest,
    /// Trilinear between valid nodes. Beyond the outermost node its value is kept; phi_d wraps.
    Trilinear(MerlNodes),
}

/// An isotropic BRDF as a table of 90 × 90 × 180 values over theta_h, theta_d and phi_d.
///
/// ```
/// use brdf_model::{Brdf, MerlTable, Preset};
/// use brdf_param::DirectionPair;
///
/// let paint = Preset::find("lafortune-blue-paint").expect("a preset of this crate").brdf();
/// let table = MerlTable::tabulate(&paint);
/// let pair = DirectionPair::from_angles(0.4, 0.0, 0.7, 2.0);
/// let (tabulated, exact) = (table.eval(&pair).b, paint.eval(&pair).b);
/// assert!((tabulated / exact - 1.0).abs() < 1e-2);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MerlTable {
    /// RGB in sr⁻¹ at index phi_d + 180 (theta_d + 90 theta_h); negative where invalid.
    cells: LargeTable,
    pub(crate) lookup: MerlLookup,
}

impl MerlTable {
    /// Number of cells along theta_h, which covers [0, π/2].
    pub const THETA_H: usize = 90;
    /// Number of cells along theta_d, which covers [0, π/2].
    pub const THETA_D: usize = 90;
    /// Number of cells along phi_d, which covers [0, π).
    pub const PHI_D: usize = 180;
    /// Number of cells in all.
    pub const CELLS: usize = Self::THETA_H * Self::THETA_D * Self::PHI_D;
    /// The value of an invalid cell, one without data.
    pub const INVALID: [f32; 3] = [-1.0; 3];

    /// Returns a table of [`MerlTable::CELLS`] values in sr⁻¹, phi_d fastest, then theta_d, then theta_h.
    ///
    /// A cell with a negative or NaN channel has no data.
    ///
    /// # Errors
    ///
    /// [`ModelError::TableSize`] for another number of values; [`ModelError::TableValue`] for an infinite value.
    pub fn new(
        values: impl ExactSizeIterator<Item = [f32; 3]>,
        lookup: MerlLookup,
    ) -> Result<Self, ModelError> {
        let found = values.len();
        if found != Self::CELLS {
            return Err(ModelError::TableSize { table: "merl", expected: Self::CELLS, found });
        }
        let mut cells = LargeTable::zeros(Self::CELLS);
        for (index, (cell, value)) in cells.iter_mut().zip(values).enumerate() {
            if let Some(&infinite) = value.iter().find(|v| v.is_infinite()) {
                return Err(ModelError::TableValue {
                    table: "merl",
                    index,
                    value: infinite.into(),
                    expected: "finite values",
                });
            }
            // Written so that NaN counts as invalid.
            let valid = value.iter().all(|&v| v >= 0.0);
            *cell = if valid { value } else { Self::INVALID };
        }
        Ok(Self { cells, lookup })
    }

    /// Returns the table of a model's values at the cell centres, with phi_h = 0.
    ///
    /// Values are made reciprocal by averaging each pair with its swap, since the grid holds only one
    /// value for both. Cells with a direction below the horizon, or where the model has no data, are
    /// invalid.
    pub fn tabulate(brdf: &dyn Brdf) -> Self {
        let mut cells = LargeTable::zeros(Self::CELLS);
        for (index, cell) in cells.iter_mut().enumerate() {
            let pair = Self::cell_pair(index);
            let swapped = pair.swapped();
            *cell = if brdf.has_data(&pair) && brdf.has_data(&swapped) {
                let mean = (brdf.eval(&pair) + brdf.eval(&swapped)) * 0.5;
                #[expect(clippy::cast_possible_truncation, reason = "the table stores f32")]
                mean.channels().map(|v| v as f32)
            } else {
                Self::INVALID
            };
        }
        Self { cells, lookup: MerlLookup::Trilinear(MerlNodes::Centre) }
    }

    /// Returns the table, to be read in the given way from now on.
    pub fn with_lookup(self, lookup: MerlLookup) -> Self {
        Self { lookup, ..self }
    }

    /// Returns the values of all cells, in sr⁻¹, phi_d fastest.
    pub fn cells(&self) -> &[[f32; 3]] {
        &self.cells
    }

    /// Returns the number of cells without data.
    pub fn invalid_cells(&self) -> usize {
        self.cells.iter().filter(|cell| cell[0] < 0.0).count()
    }

    /// Returns the pair at the centre of a cell, with phi_h = 0; one direction may be below the horizon.
    pub fn cell_pair(index: usize) -> DirectionPair {
        let centre = |i: usize| i as f64 + 0.5;
        let phi_d = centre(index % Self::PHI_D).to_radians();
        let theta_d = centre(index / Self::PHI_D % Self::THETA_D).to_radians();
        let theta_h = (centre(index / (Self::PHI_D * Self::THETA_D)).powi(2) / 90.0).to_radians();
        HalfDifference { theta_h, phi_h: 0.0, theta_d, phi_d }.to_pair()
    }
}
