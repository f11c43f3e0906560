//! Bidirectional texture functions: sets of images named by their directions, binary files, and the
//! maps that images are made from.

mod bonn_factors;
mod bonn_file;
mod bonn_header;
mod bonn_texels;
mod colour_model;
mod decode;
mod error;
mod exr_picture;
mod files;
mod image_set;
mod input;
mod linear;
mod loaded;
mod maps;
mod names;
mod rgbe;
mod srgb;
mod store;
mod ubo_writer;

pub use bonn_file::BtfFile;
pub(crate) use decode::image_size;
pub use decode::read_btf_image;
pub use error::BtfError;
pub use image_set::{BtfImages, BtfNotes};
pub use input::{Btf, BtfInput, open_btf};
pub use loaded::LoadedBtf;
pub use maps::{read_albedo, read_map};
pub use names::{ImageAngles, NamedDirection, parse_image_name};
pub use ubo_writer::{UboWriter, WrittenImages};
