//! Bidirectional texture functions: sets of images named by their directions, and binary files.

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
mod names;
mod rgbe;
mod store;

pub use bonn_file::BtfFile;
pub use decode::read_btf_image;
pub use error::BtfError;
pub use image_set::{BtfImages, BtfNotes};
pub use input::{Btf, BtfInput, open_btf};
pub use loaded::LoadedBtf;
pub use names::{ImageAngles, NamedDirection, parse_image_name};
