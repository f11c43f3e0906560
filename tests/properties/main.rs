//! Properties that hold across crates, over random and deliberately degenerate directions.

mod errata;
mod factors;
mod models;
mod parametrizations;
mod projections;
mod readers;
