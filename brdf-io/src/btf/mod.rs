//! Bidirectional texture functions: images of a surface for pairs of view and light, and the maps
//! that they are made from.

mod maps;
mod srgb;
mod ubo_writer;

pub use maps::{read_albedo, read_map};
pub use ubo_writer::{UboWriter, WrittenImages};
