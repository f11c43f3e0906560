//! From samples to materials.

use brdf_job::{Job, StopCause};

use crate::layout::Layout;
use crate::params::brightest;
use crate::{
    Contradictions, PaintError, PaintErrors, PaintParams, PaintSamples, PaintedMaterial,
    SolverChoice, alternating, paper,
};

/// The result of [`extract`]: a material and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Extraction {
    /// The material.
    pub material: PaintedMaterial,
    /// Errors over the samples it was made from.
    pub errors: PaintErrors,
    /// Places where views do not agree.
    pub contradictions: Contradictions,
    /// Texels of the maps that no sample touches, row by row; they were filled from around them.
    pub unconstrained: Vec<bool>,
    /// Texels of factors that no sample touches; smoothing alone holds them.
    pub smoothed_texels: usize,
    /// Reason why turns ended early, if they did: the material is the best so far.
    pub stopped: Option<StopCause>,
}

/// Fits a material to samples.
///
/// # Errors
///
/// [`PaintError::NothingPainted`], [`PaintError::Option`]; [`PaintError::Factor`] as of [`Preinverted::new`](brdf_factor::Preinverted::new);
/// [`PaintError::Stopped`].
pub fn extract(
    samples: &PaintSamples,
    params: &PaintParams,
    job: &Job<'_>,
) -> Result<Extraction, PaintError> {
    params.check()?;
    if samples.is_empty() {
        return Err(PaintError::NothingPainted { skipped: samples.skipped.to_string() });
    }
    // Leading parts of shuffled samples are spread over all pictures.
    let shuffled = samples.shuffled();
    let [inverting, decomposing] = job.split([1.0, 4.0]);
    inverting.begin("inverting", 1);
    let layout = Layout::new(&shuffled, params)?;
    let parts = match (params.is_map(), params.solver) {
        (false, _) => vec![layout.single(&shuffled)],
        (true, SolverChoice::Paper) => paper::decompose(&layout, &shuffled, params, &decomposing)?,
        (true, SolverChoice::Alternating) => {
            alternating::decompose(&layout, &shuffled, params, &decomposing)?
        }
    };
    let limit = brightest(&samples.values);
    let material = PaintedMaterial { components: layout.components(parts, params)?, limit };
    let predicted = material.predict(samples);
    let errors = samples.errors_of(&predicted);
    let contradictions = Contradictions::of(samples, &predicted, params.wraps);
    let unconstrained = if params.is_map() {
        layout.touched(params.map_size).iter().map(|touched| !touched).collect()
    } else {
        Vec::new()
    };
    let smoothed_texels = layout.inverted.untouched_texels().iter().map(Vec::len).sum();
    Ok(Extraction {
        material,
        errors,
        contradictions,
        unconstrained,
        smoothed_texels,
        stopped: job.stop_cause(),
    })
}
