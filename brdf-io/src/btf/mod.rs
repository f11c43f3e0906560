//! Bidirectional texture functions: sets of images named by their directions, and the maps that
//! such images are made from.

mod decode;
mod error;
mod files;
mod image_set;
mod input;
mod loaded;
mod maps;
mod names;
mod srgb;
mod store;
mod ubo_writer;

pub use error::BtfError;
pub use image_set::{BtfImages, BtfNotes};
pub use input::{Btf, BtfInput, open_btf};
pub use loaded::LoadedBtf;
pub use maps::{read_albedo, read_map};
pub use names::{ImageAngles, NamedDirection, parse_image_name};
pub use ubo_writer::{UboWriter, WrittenImages};
