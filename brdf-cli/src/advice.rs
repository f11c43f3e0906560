//! What can be done about notes and errors, in terms of options.

use std::error::Error;

use brdf_container::{ContainerError, Kind, OpenError, Paintings, SceneError};
use brdf_files::FileError;
use brdf_fit::FitNote;
use brdf_io::{FormatError, ReadNote};
use brdf_paint::PaintNote;
use brdf_report::{fit_note, paint_note};

/// A failure of which the user knows.
#[derive(Debug, thiserror::Error)]
#[error("there were errors")]
pub(crate) struct AlreadySaid;

/// What the readers assumed or changed, as sentences.
pub(crate) fn read_notes(notes: &[ReadNote]) -> Vec<String> {
    let advice = |note: &ReadNote| match note {
        ReadNote::Wavelength { .. } => "; --wavelength-um chooses another",
        _ => "",
    };
    notes.iter().map(|note| format!("{note}{}", advice(note))).collect()
}

/// Notes on a fit of a material that was read with notes of its own, as sentences.
pub(crate) fn fit_notes(read: &[ReadNote], notes: &[FitNote]) -> Vec<String> {
    let advice = |note: &FitNote| match note {
        FitNote::Clamped { in_colour: true, .. } => " (--luminance avoids most of it)",
        FitNote::NotTakenIsotropic => " (--replicate 32 adds turned copies)",
        FitNote::AlbedoOff { factored: true, .. } => {
            "; --method spline keeps those of isotropic materials"
        }
        FitNote::PowerIteration { .. } => "; --eigen-solver krylov meets 1e-5",
        _ => "",
    };
    let notes = notes.iter().map(|note| format!("{}{}", fit_note(note), advice(note)));
    read_notes(read).into_iter().chain(notes).collect()
}

/// What was not painted, and notes on a material that was learned from the rest, as sentences.
pub(crate) fn paint_notes(found: &Paintings, notes: &[PaintNote]) -> Vec<String> {
    let missing =
        (!found.missing.is_empty()).then(|| format!("not painted: {}", found.missing.join(", ")));
    let strange = found.strange.iter();
    let strange = strange.map(|path| format!("{}: of no view, not used", path.display()));
    let notes = notes.iter().map(|note| match note {
        PaintNote::Saturated { picture, .. } => {
            format!("{}: {}", found.painted[*picture].picture.display(), paint_note(note))
        }
        PaintNote::PassedOver { pixels } => {
            format!("{pixels} pixels are more than --pixels and were not used")
        }
        _ => paint_note(note),
    });
    missing.into_iter().chain(strange).chain(notes).collect()
}

/// The option that helps with an error, as the end of its sentence.
pub(crate) fn on_error(error: &anyhow::Error) -> &'static str {
    let file_error = error.chain().find_map(|cause| {
        let opened = cause.downcast_ref::<OpenError>().and_then(|opened| match opened {
            OpenError::File(problem) => Some(problem),
            _ => None,
        });
        opened.or(cause.downcast_ref::<FileError>())
    });
    if let Some(SceneError::Tiled { .. }) = error.downcast_ref() {
        return "; give --uv sphere or atlas";
    }
    match file_error {
        Some(FileError::InTheWay { .. }) => " or pass --force",
        Some(FileError::Content { problem, .. }) => on_content(problem.as_ref()),
        _ => "",
    }
}

fn on_content(problem: &(dyn Error + Send + Sync + 'static)) -> &'static str {
    if let Some(FormatError::SeveralMaterials { .. }) = problem.downcast_ref() {
        return "; --where COLUMN=VALUE takes one";
    }
    if let Some(FormatError::Columns { .. }) = problem.downcast_ref() {
        return "; --columns MEANING=NAME,… says which they are, or a number for an angle that all rows have";
    }
    let Some(ContainerError::NoBrdf { found }) = problem.downcast_ref() else { return "" };
    match found {
        Kind::Transport => "; expected one of the commands of `brdf relight` for it",
        Kind::Painted => "; expected `brdf paint preview` for it",
        Kind::Basis => "; expected `brdf factor MODEL --with` for it",
        Kind::BtfVq | Kind::BtfLpca => "; expected one of the commands of `brdf btf` for it",
        _ => "",
    }
}
