//! Notes as sentences. What could be done about them is for front ends to add, who know what their options are called.

use brdf_container::Evaluated;
use brdf_factor::{EvalCounts, Spacing};
use brdf_fit::{FitNote, TriedPairs};
use brdf_paint::PaintNote;

use crate::numbers::{bytes, percent, significant};

/// Returns a note on a fit as a sentence without a full stop, so that a front end may go on.
pub fn fit_note(note: &FitNote) -> String {
    match note {
        FitNote::Clamped { samples, .. } => format!(
            "{samples} samples had a negative channel, a colour outside the gamut; it was set to 0, which log errors \
             count heavily"
        ),
        FitNote::Rotated { copies, drawn: true } => {
            format!("each pair was fitted {copies} times, turned")
        }
        FitNote::Rotated { copies, drawn: false } => format!(
            "the material was taken to be isotropic: every row was fitted {copies} times, turned about the normal"
        ),
        FitNote::AsMeasured => "rows were fitted as measured, without turned copies".to_owned(),
        FitNote::NotTakenIsotropic => {
            "light comes from several azimuths, so the material was not taken to be isotropic: rows were fitted as \
             measured"
                .to_owned()
        }
        FitNote::SharedTextures => {
            "light and viewer share textures, so every row stands for its reciprocal too".to_owned()
        }
        FitNote::Folds => {
            "held-out errors are 10-fold: rows are split before they are copied, twins together".to_owned()
        }
        FitNote::FewIncidences { incidences } => format!(
            "the data has only {incidences} directions of light: between them the fit is smoothing, not measurement"
        ),
        FitNote::Sparse { coverage } => format!(
            "only {} of direction pairs have a row nearby: elsewhere the fit is smoothing, not measurement, and the \
             reference sphere has holes",
            percent(*coverage)
        ),
        FitNote::SearchStopped { cause, found, asked } => format!(
            "the search was stopped ({cause}): it found models of up to {found} of {asked} projections, the best so far"
        ),
        FitNote::Chosen { tried, on_rows } => {
            let tried: Vec<String> = tried
                .iter()
                .map(|(family, errors)| {
                    let errors: Vec<String> = errors.iter().copied().map(significant).collect();
                    format!("{family}: {}", errors.join(", "))
                })
                .collect();
            let on = if *on_rows { "a tenth of the rows, set aside" } else { "validation pairs" };
            format!("for each number of textures the best by the log error on {on} ({})", tried.join("; "))
        }
        FitNote::ChosenAngles { tried, on_rows } => {
            let tried: Vec<String> = tried
                .iter()
                .map(|TriedPairs { pairs, spacing, reciprocal, error }| {
                    let spacing = match spacing {
                        Spacing::Linear => "evenly spaced".to_owned(),
                        Spacing::Power { exponent } => format!("spaced by the power {exponent}"),
                        Spacing::Asinh { alpha } => format!("even up to {:.2}°", alpha.to_degrees()),
                    };
                    let kind = if *reciprocal { "" } else { ", not reciprocal" };
                    format!("{} {spacing}{kind} {}", pairs.name(), significant(*error))
                })
                .collect();
            let on = if *on_rows {
                "log and linear error on a tenth of the rows, set aside"
            } else {
                "the errors away from the highlight and in it, on validation pairs"
            };
            format!("angles and spacing of θh chosen by {on}: {}", tried.join(", "))
        }
        FitNote::SearchedWithAllRows => {
            "projections were searched with all rows, so the held-out errors are those of textures alone: a little too \
             low"
                .to_owned()
        }
        FitNote::FewRows { rows, texels } => {
            format!("{rows} rows for {texels} texels: between the rows textures are only smoothed")
        }
        FitNote::NothingHeldOut => {
            "too few rows to hold any out: nothing is known about unseen directions".to_owned()
        }
        FitNote::GainsEnergy { model, reference } => format!(
            "the model reflects up to {} times the light that arrives{}",
            significant(*model),
            reference.map_or_else(String::new, |r| format!(" (the reference {})", significant(r)))
        ),
        FitNote::AlbedoOff { model, reference, factored } => format!(
            "the model's largest albedo is {}, the reference's {}{}",
            significant(*model),
            significant(*reference),
            if *factored { ": its highlights are off" } else { "" }
        ),
        FitNote::TakenIsotropic { change } => format!(
            "the material is anisotropic: it differs by {} when turned by a quarter; the model is isotropic and follows \
             it at one azimuth of the half vector",
            percent(*change)
        ),
        FitNote::Zeros { values } => format!(
            "{values} values of channels are exactly 0 where the model was fitted: clipped or not measured; there it \
             may be anything that ends at 0"
        ),
        FitNote::ChosenMethod { tried, on_rows } => {
            let tried: Vec<String> = tried
                .iter()
                .map(|m| format!("{} of {} {}", m.method, bytes(m.bytes), significant(m.error)))
                .collect();
            let by = if *on_rows {
                "geometric mean of four errors over ten folds of the rows"
            } else {
                "geometric mean of eight errors, away from the highlight and in it, over validation pairs"
            };
            format!("chosen by the {by}: {}", tried.join(", "))
        }
        FitNote::SearchedAsAnisotropic { change } => format!(
            "the material is anisotropic: it differs by {} when turned by a quarter; projections were searched",
            percent(*change)
        ),
        FitNote::ErrorNotReached { asked, found } => format!(
            "no model that was tried has an error of {} or less; the best has {}",
            significant(*asked),
            significant(*found)
        ),
        FitNote::Interpolated => {
            "the rows were interpolated to fill the matrix: between them nothing was measured, and no rows were held out"
                .to_owned()
        }
        FitNote::Anisotropic { change } => format!(
            "the material is anisotropic: it differs by {} when turned by a quarter, which textures of the polar angle \
             alone cannot hold",
            percent(*change)
        ),
        FitNote::WithoutLogarithm { values } => format!(
            "{values} held-out values came out negative and have no logarithm; log errors take them as 0"
        ),
        FitNote::CellsFilled { cells, of } => format!(
            "{} of {of} cells have no data of their own and took that of the nearest pair",
            share(*cells, *of)
        ),
        FitNote::CellsZero { cells, of } => {
            format!("{} of {of} cells have no data and are 0", share(*cells, *of))
        }
        FitNote::UnknownLines { lines } => {
            format!("{lines} whole rows or columns have no data of their own")
        }
        FitNote::CellsClamped { cells } => format!("{cells} cells had a negative channel, set to 0"),
        FitNote::NotReciprocal { asymmetry } => format!(
            "the material is not reciprocal: ‖M − Mᵀ‖ / ‖M‖ is {}; the mean of M and Mᵀ was factored",
            significant(*asymmetry)
        ),
        FitNote::GroupsCompleted { added, rank } => format!(
            "{added} terms beyond {rank} complete groups of equal magnitude: cut in between, the result would depend on \
             the azimuth of the frame"
        ),
        FitNote::GroupCut => {
            "more terms of the same magnitude as the last follow: which of them were taken is chance".to_owned()
        }
        FitNote::FewTerms { found, rank } => {
            format!("the matrix has only {found} terms above rounding in a channel, not {rank}")
        }
        FitNote::PowerIteration { residual } => format!(
            "power iteration as printed: the largest residual ‖Mv − λv‖ / |λ| is {}",
            significant(*residual)
        ),
        FitNote::NotConverged { residual } => format!(
            "the iteration stopped before it met its tolerance; largest residual {}",
            significant(*residual)
        ),
        // Notes that this crate does not know yet are better shown raw than lost.
        other => format!("{other:?}"),
    }
}

/// Returns a note on a painted material as a sentence without a full stop.
pub fn paint_note(note: &PaintNote) -> String {
    match note {
        PaintNote::Saturated { pixels, .. } => format!(
            "{pixels} pixels are as bright as their file can hold, and may have been brighter"
        ),
        PaintNote::PassedOver { pixels } => {
            format!("{pixels} pixels are more than the most to learn from and were not used")
        }
        PaintNote::Skipped { held_out: false, skipped } => format!("skipped: {skipped}"),
        PaintNote::Skipped { held_out: true, skipped } => {
            format!("skipped of held-out views: {skipped}")
        }
        PaintNote::Clamped { clamped } => format!(
            "{} painted pixels have a product below 0, set to 0; {} are above the brightest painted, cut to it",
            clamped.below_zero, clamped.above_limit
        ),
        PaintNote::Unconstrained { texels, of } => format!(
            "{texels} of {of} texels of the maps are in no painted pixel; filled from around them"
        ),
        PaintNote::Contradictions { cells, of } => format!(
            "views contradict each other in {cells} of {of} cells of the surface; see contradictions.png"
        ),
        // Notes that this crate does not know yet are better shown raw than lost.
        other => format!("{other:?}"),
    }
}

fn share(part: usize, whole: usize) -> String {
    percent(part as f64 / whole.max(1) as f64)
}

/// Returns what was not as asked in an evaluation, as sentences.
pub fn evaluation_notes(found: &Evaluated) -> Vec<String> {
    let mut notes = Vec::new();
    let Evaluated { below_horizon, without_data, negative, .. } = found;
    if below_horizon + without_data > 0 {
        notes.push(format!(
            "{below_horizon} rows below the horizon (0), {without_data} without data (NaN)"
        ));
    }
    if *negative > 0 {
        notes.push(format!("{negative} rows with a negative value, set to 0"));
    }
    if let Some((counts, theta_max)) = found.factored
        && counts != EvalCounts::default()
    {
        let EvalCounts { pulled_back, outside_texture, clamped_below_zero, clamped_at_ceiling } =
            counts;
        notes.push(format!(
            "{pulled_back} rows beyond the model's grazing limit of {:.4}°, pulled back to it; \
             {outside_texture} moved to the rim of a texture; {clamped_below_zero} negative values set \
             to 0; {clamped_at_ceiling} set to the largest fitted value",
            theta_max.to_degrees()
        ));
    }
    notes
}
