//! What `brdf factor` reports: the JSON, and the page around it.

mod chart;
pub(crate) mod html;
pub(crate) mod notes;
pub(crate) mod separable;
pub(crate) mod study;

use brdf_factor::{Coordinate, EvalCounts, FactoredBrdf, Solver};
use brdf_io::{FitSettings, TermRecord};
use brdf_model::{Channels, Dropped, PairSampling};
use brdf_param::Space;
use serde::Serialize;

use self::notes::stop_cause;
use crate::fitting::{Albedo, Outcome};
use crate::searching::{Found, SearchPlan, Tried};
use crate::subject::Subject;

/// `report.json`. The first key marks the folder as ours.
#[derive(Serialize)]
pub(crate) struct Report {
    /// Version of the program.
    brdf: &'static str,
    pub(crate) input: String,
    /// File name of the model, within the folder.
    model: &'static str,
    pub(crate) method: &'static str,
    pub(crate) space: &'static str,
    pub(crate) samples: Samples,
    pub(crate) terms: Vec<TermRecord>,
    pub(crate) baseline: Baseline,
    pub(crate) evaluations: usize,
    pub(crate) seconds: f64,
    /// How projections were searched, if they were.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) search: Option<SearchReport>,
    pub(crate) bytes: usize,
    /// Largest directional albedos within the model's grazing limit.
    pub(crate) albedo: Albedo,
    pub(crate) channels: Channels,
    pub(crate) solve: Solve,
    /// What evaluating the model on the pairs of a whole hemisphere does.
    pub(crate) evaluation: Evaluation,
    pub(crate) settings: FitSettings,
    pub(crate) notes: Vec<String>,
    #[serde(skip)]
    pub(crate) name: String,
}

/// How projections were searched.
#[derive(Serialize)]
pub(crate) struct SearchReport {
    /// Projections asked for.
    terms: usize,
    /// Why the search ended early, if it did.
    pub(crate) stopped: Option<&'static str>,
    /// Every family that was searched, in order; the last of several may be the winner, searched
    /// again with all rows.
    pub(crate) tried: Vec<Tried>,
}

impl SearchReport {
    pub(crate) fn new(plan: &SearchPlan, found: &Found) -> Self {
        Self { terms: plan.terms, stopped: stop_cause(found), tried: found.tried.clone() }
    }
}

#[derive(Serialize)]
pub(crate) struct Samples {
    /// Rows or drawn pairs that were fitted.
    pub(crate) used: usize,
    /// The same with their turned copies.
    pub(crate) fitted: usize,
    pub(crate) dropped: Dropped,
    /// Samples with a negative channel that was set to 0.
    pub(crate) clamped: usize,
}

#[derive(Serialize)]
pub(crate) struct Baseline {
    pub(crate) mccool: TermRecord,
}

#[derive(Serialize)]
pub(crate) struct Solve {
    pub(crate) solver: Solver,
    pub(crate) unknowns: usize,
    /// Texels that no sample touches.
    pub(crate) smoothed_texels: usize,
    pub(crate) iterations: usize,
    pub(crate) converged: bool,
}

#[derive(Serialize)]
pub(crate) struct Evaluation {
    pub(crate) pairs: u32,
    /// The model's grazing limit, degrees.
    pub(crate) max_theta_deg: f64,
    #[serde(flatten)]
    pub(crate) counts: EvalCounts,
}

/// Pairs over whole hemispheres whose treatment is counted.
const COUNTED_PAIRS: u32 = 20_000;

impl Report {
    pub(crate) fn new(
        subject: &Subject,
        outcome: &Outcome,
        settings: FitSettings,
        method: &'static str,
        search: Option<SearchReport>,
        channels: Channels,
        notes: Vec<String>,
    ) -> Self {
        let fit = outcome.last();
        let sampling =
            PairSampling { count: COUNTED_PAIRS, seed: 1, theta_max: std::f64::consts::FRAC_PI_2 };
        Self {
            brdf: env!("CARGO_PKG_VERSION"),
            input: subject.argument.clone(),
            model: "model.safetensors",
            method,
            space: space_of(&fit.model).name(),
            samples: Samples {
                used: outcome.rows,
                fitted: fit.samples_used,
                dropped: fit.dropped,
                clamped: fit.clamped,
            },
            terms: outcome.terms.clone(),
            baseline: Baseline { mccool: outcome.baseline.clone() },
            evaluations: outcome.evaluations,
            seconds: outcome.seconds,
            search,
            bytes: fit.model.payload_bytes(),
            albedo: outcome.albedo,
            channels,
            solve: Solve {
                solver: fit.solver,
                unknowns: fit.unknowns,
                smoothed_texels: fit.smoothed_texels,
                iterations: fit.iterations,
                converged: fit.converged,
            },
            evaluation: Evaluation {
                pairs: COUNTED_PAIRS,
                max_theta_deg: fit.model.theta_max().to_degrees(),
                counts: fit.model.count(sampling.pairs()),
            },
            settings,
            notes,
            name: subject.short_name(),
        }
    }
}

/// The space of a model's projections; standard where it has none.
fn space_of(model: &FactoredBrdf) -> Space {
    let coordinates = model.factors().iter().flat_map(|factor| factor.coordinates());
    coordinates
        .filter_map(|coordinate| match coordinate {
            Coordinate::Projected { space, .. } => Some(*space),
            _ => None,
        })
        .next()
        .unwrap_or(Space::Standard)
}
