//! Properties that hold across crates, over random and deliberately degenerate directions.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test that cannot go on has failed"
)]

mod meshes;
