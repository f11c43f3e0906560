//! What every method returns.

use brdf_model::{Brdf, FitErrors};

use crate::compact::CompactFit;
use crate::factored::FactoredFit;
use crate::method::Method;
use crate::note::FitNote;
use crate::separable::SeparableFit;

/// A fitted material.
#[derive(Clone, Debug)]
pub enum Fit {
    /// A product of textures.
    Factored(Box<FactoredFit>),
    /// A sum of products.
    Separable(Box<SeparableFit>),
    /// A compact model.
    Compact(Box<CompactFit>),
}

impl Fit {
    /// Returns the model with the most terms.
    pub fn brdf(&self) -> &dyn Brdf {
        match self {
            Self::Factored(fit) => &fit.last().model,
            Self::Separable(fit) => &fit.model.model,
            Self::Compact(fit) => fit.model.model.brdf(),
        }
    }

    /// Returns how the model was made.
    pub fn method(&self) -> Method {
        match self {
            Self::Factored(fit) => fit.method,
            Self::Separable(fit) => fit.model.record.method,
            Self::Compact(fit) => fit.model.record.method,
        }
    }

    /// Returns the errors of the model on samples that were not fitted; none where there are none.
    pub fn held_out(&self) -> Option<&FitErrors> {
        match self {
            Self::Factored(fit) => fit.terms.last()?.of_model().1,
            Self::Separable(fit) => fit.model.record.terms.last()?.held_out.as_ref(),
            Self::Compact(fit) => fit.model.record.held_out.as_ref(),
        }
    }

    /// Returns the errors of the model on what was fitted; a sum of products is fitted to a matrix instead, whose
    /// errors stand in its record, and splines to nodes of their own.
    pub fn training(&self) -> Option<&FitErrors> {
        match self {
            Self::Factored(fit) => Some(fit.terms.last()?.of_model().0),
            Self::Separable(_) => None,
            Self::Compact(fit) => fit.training.as_ref(),
        }
    }

    /// Returns the bytes of the model: its textures, stream or parameters.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Factored(fit) => fit.last().model.payload_bytes(),
            Self::Separable(fit) => fit.model.model.payload_bytes(),
            Self::Compact(fit) => fit.model.model.payload_bytes(),
        }
    }

    /// Adds to what a reader of the numbers should know.
    pub(crate) fn add_note(&mut self, note: FitNote) {
        match self {
            Self::Factored(fit) => fit.notes.push(note),
            Self::Separable(fit) => fit.notes.push(note),
            Self::Compact(fit) => fit.notes.push(note),
        }
    }

    /// Returns what a reader of the numbers should know.
    pub fn notes(&self) -> &[FitNote] {
        match self {
            Self::Factored(fit) => &fit.notes,
            Self::Separable(fit) => &fit.notes,
            Self::Compact(fit) => &fit.notes,
        }
    }
}
