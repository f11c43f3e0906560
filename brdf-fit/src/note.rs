//! What a reader of a fit should know beside its numbers.

use brdf_job::StopCause;

use crate::isotropic::TriedPairs;
use crate::record::TriedModel;
use crate::tried::FamilyRecord;

/// Something about a fit that its errors alone do not show. What could be done about it is for front ends to say,
/// who know what their options are called.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FitNote {
    /// Samples had a negative channel, a colour outside the gamut, which was set to 0.
    Clamped {
        /// How many.
        samples: usize,
        /// Whether a fit of luminance would avoid most of it.
        in_colour: bool,
    },
    /// Rows were taken to be isotropic and fitted several times, turned about the normal.
    Rotated {
        /// How many times.
        copies: u32,
        /// Drawn pairs, not measured rows.
        drawn: bool,
    },
    /// Rows lit from one azimuth were fitted as measured.
    AsMeasured,
    /// Rows lit from several azimuths were fitted as measured: the material may be anisotropic.
    NotTakenIsotropic,
    /// Light and viewer share textures, so that every row stands for its reciprocal too.
    SharedTextures,
    /// Held-out errors are of ten folds.
    Folds,
    /// The data has few directions of light.
    FewIncidences {
        /// How many.
        incidences: usize,
    },
    /// Most direction pairs have no row nearby.
    Sparse {
        /// Share of pairs that have one, [0, 1].
        coverage: f64,
    },
    /// A search was stopped.
    SearchStopped {
        /// Why.
        cause: StopCause,
        /// Largest number of projections found.
        found: usize,
        /// Number asked for.
        asked: usize,
    },
    /// For each number of terms, the best of several families of projections was kept.
    Chosen {
        /// Every family, and its mean square log error for each number of terms.
        tried: Vec<(FamilyRecord, Vec<f64>)>,
        /// Whether on a tenth of measured rows instead of drawn pairs.
        on_rows: bool,
    },
    /// Pairs of angles and their spacing were chosen among several.
    ChosenAngles {
        /// All that were tried, in order.
        tried: Vec<TriedPairs>,
        /// Whether on a tenth of measured rows instead of drawn pairs.
        on_rows: bool,
    },
    /// Projections were searched with all rows, so that held-out errors are those of textures alone.
    SearchedWithAllRows,
    /// Fewer rows than texels.
    FewRows {
        /// Rows.
        rows: usize,
        /// Texels.
        texels: usize,
    },
    /// Too few rows to hold any out.
    NothingHeldOut,
    /// The model reflects more light than arrives.
    GainsEnergy {
        /// Largest albedo of the model.
        model: f64,
        /// Of the reference, where it is known.
        reference: Option<f64>,
    },
    /// The model's largest albedo is far from the reference's.
    AlbedoOff {
        /// Of the model.
        model: f64,
        /// Of the reference.
        reference: f64,
        /// Whether weights of a factored fit could mend it.
        factored: bool,
    },
    /// An anisotropic material was given an isotropic model.
    TakenIsotropic {
        /// Mean change when turned by a quarter, over the mean value.
        change: f64,
    },
    /// Channels of the material are exactly 0 in places; there a model is right anywhere below.
    Zeros {
        /// How many values.
        values: usize,
    },
    /// The method was chosen among several.
    ChosenMethod {
        /// All that were tried, in order.
        tried: Vec<TriedModel>,
        /// Whether by [`FidelityErrors::score`](brdf_model::FidelityErrors::score) over folds of rows, in place of
        /// [`Fidelity::score`](brdf_model::Fidelity::score) over validation pairs.
        on_rows: bool,
    },
    /// An anisotropic material was searched for projections, in place of choosing among isotropic models.
    SearchedAsAnisotropic {
        /// Mean change when turned by a quarter, over the mean value.
        change: f64,
    },
    /// No model that was tried is as good as was asked for.
    ErrorNotReached {
        /// Error asked for.
        asked: f64,
        /// Least error found.
        found: f64,
    },
    /// Scattered rows were interpolated to fill a matrix.
    Interpolated,
    /// A material that is not isotropic was given textures of the polar angle alone.
    Anisotropic {
        /// Mean change when turned by a quarter, over the mean value.
        change: f64,
    },
    /// Held-out values came out negative and have no logarithm.
    WithoutLogarithm {
        /// How many.
        values: usize,
    },
    /// Cells took the value of the nearest pair with data.
    CellsFilled {
        /// How many.
        cells: usize,
        /// Of how many.
        of: usize,
    },
    /// Cells without data are 0.
    CellsZero {
        /// How many.
        cells: usize,
        /// Of how many.
        of: usize,
    },
    /// Whole rows or columns of the matrix have no data of their own.
    UnknownLines {
        /// How many.
        lines: usize,
    },
    /// Cells had a negative channel, set to 0.
    CellsClamped {
        /// How many.
        cells: usize,
    },
    /// A material that is not reciprocal: the mean of M and Mᵀ was factored.
    NotReciprocal {
        /// ‖M − Mᵀ‖ / ‖M‖.
        asymmetry: f64,
    },
    /// Terms beyond the rank complete groups of equal magnitude.
    GroupsCompleted {
        /// Terms added.
        added: usize,
        /// Rank asked for.
        rank: usize,
    },
    /// More terms of the same magnitude as the last follow.
    GroupCut,
    /// The matrix has fewer terms above rounding than asked for.
    FewTerms {
        /// In the channel with the fewest.
        found: usize,
        /// Rank asked for.
        rank: usize,
    },
    /// Power iteration as printed leaves residuals.
    PowerIteration {
        /// Largest ‖Mv − λv‖ / |λ|.
        residual: f64,
    },
    /// An iteration stopped before it met its tolerance.
    NotConverged {
        /// Largest residual.
        residual: f64,
    },
}
