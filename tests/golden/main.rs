//! Results computed elsewhere, with their origin in each module.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test that cannot go on has failed"
)]

mod image_metrics;
mod merl_layout;
mod microfacet;
mod relight;
mod rgl;
