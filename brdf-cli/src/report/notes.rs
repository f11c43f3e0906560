//! What a reader of a report should know beside its numbers.

use brdf_io::FitSettings;
use brdf_model::SampleSet;

use crate::fitting::{Albedo, Outcome};
use crate::numbers::{percent, significant};
use crate::searching::{Found, SearchPlan, is_interrupted};

/// Fewer directions of light than this leave most of the light's texture to smoothing.
const FEW_INCIDENCES: usize = 8;
/// Rows near less than this share of the domain leave most of the fit to smoothing.
const SPARSE: f64 = 0.5;

/// What is wrong with a fit that its errors alone do not show.
pub(crate) fn fit_notes(outcome: &Outcome) -> Vec<String> {
    let mut notes = Vec::new();
    let (rows, unknowns) = (outcome.rows, outcome.last().unknowns);
    if rows < unknowns {
        notes.push(format!(
            "{rows} rows for {unknowns} texels: between the rows textures are only smoothed; \
             --texture-size 16 --smoothing 1e-2 gives a calmer picture"
        ));
    }
    if outcome.terms.iter().any(|term| term.held_out.is_none()) {
        notes.push(
            "too few rows to hold any out: nothing is known about unseen directions".to_owned(),
        );
    }
    let Albedo { reference, model } = outcome.albedo;
    if model > 1.0 {
        notes.push(format!(
            "the model reflects up to {} times the light that arrives{}; more smoothing or \
             --weight f may mend it",
            significant(model),
            reference.map_or_else(String::new, |r| format!(" (the reference {})", significant(r)))
        ));
    } else if let Some(reference) = reference
        && !(0.8..=1.25).contains(&(model / reference))
    {
        notes.push(format!(
            "the model's largest albedo is {}, the reference's {}: its highlights are off; --weight f \
             favours them",
            significant(model),
            significant(reference)
        ));
    }
    notes
}

/// What scattered rows were turned into, and what they cannot tell.
pub(crate) fn scattered_notes(
    rows: &SampleSet,
    outcome: &Outcome,
    settings: &FitSettings,
) -> Vec<String> {
    let mut notes = vec![if settings.replicate > 1 {
        format!(
            "the material was taken to be isotropic: every row was fitted {} times, turned about \
             the normal",
            settings.replicate
        )
    } else if rows.has_one_light_azimuth() {
        "rows were fitted as measured, without turned copies".to_owned()
    } else {
        "light comes from several azimuths, so the material was not taken to be isotropic: rows were \
         fitted as measured (--replicate 32 adds turned copies)"
            .to_owned()
    }];
    if settings.reciprocal {
        notes.push(
            "light and viewer share textures, so every row stands for its reciprocal too"
                .to_owned(),
        );
    }
    if outcome.terms.iter().all(|term| term.held_out.is_some()) {
        notes.push(
            "held-out errors are 10-fold: rows are split before they are copied, twins together"
                .to_owned(),
        );
    }
    let incidences = brdf_model::summarize(rows).incidences;
    if incidences < FEW_INCIDENCES {
        notes.push(format!(
            "the data has only {incidences} directions of light: between them the fit is smoothing, \
             not measurement"
        ));
    }
    if let Some(share) = outcome.scattered_coverage
        && share < SPARSE
    {
        notes.push(format!(
            "only {} of direction pairs have a row nearby: elsewhere the fit is smoothing, not \
             measurement, and the reference sphere has holes",
            percent(share)
        ));
    }
    notes
}

/// How the projections came about, where that bears on the figures.
pub(crate) fn search_notes(plan: &SearchPlan, found: &Found, scattered: bool) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(cause) = stop_cause(found) {
        notes.push(format!(
            "the search was stopped ({cause}): it found models of up to {} of {} projections, the best so \
             far",
            found.outcome.terms.len(),
            plan.terms
        ));
    }
    if plan.families.len() > 1 {
        let tried: Vec<String> = found
            .tried
            .iter()
            .filter_map(|t| {
                let error = significant(t.validation?);
                let kind = if t.reciprocal { "reciprocal" } else { "not reciprocal" };
                Some(format!("{} {kind} {error}", t.space))
            })
            .collect();
        notes.push(format!(
            "chosen by the log error on {}: {}",
            if scattered { "a tenth of the rows, set aside" } else { "validation pairs" },
            tried.join(", ")
        ));
    }
    if scattered {
        notes.push(
            "projections were searched with all rows, so the held-out errors are those of textures \
             alone: a little too low"
                .to_owned(),
        );
    }
    notes
}

/// Why a search ended early, if it did.
pub(crate) fn stop_cause(found: &Found) -> Option<&'static str> {
    found.outcome.stopped.then(|| if is_interrupted() { "interrupted" } else { "time limit" })
}
