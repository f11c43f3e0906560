//! The `brdf` command from outside: what it prints and writes, how it fails.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test that cannot go on has failed"
)]

mod btf;
mod compact;
mod end_to_end;
mod model_file;
mod paint;
mod relight;
mod schema;
mod support;
