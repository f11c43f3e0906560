//! Bidirectional texture functions as files: folders and ZIP archives of images named by their directions, binary
//! `.btf` files, and the maps of height, normal and albedo that images are synthesized from.
//!
//! [`open_btf`] recognizes what it is given by content; a [`BtfInput`] knows directions and sizes before anything is
//! decoded. Directions are in the names of images:
//!
//! ```
//! use btf_io::parse_image_name;
//!
//! let angles = parse_image_name("tl015 pl000 tv030 pv090.jpg")?.expect("all four angles");
//! assert!((angles.light.theta_deg - 15.0).abs() < 1e-9 && (angles.view.phi_deg - 90.0).abs() < 1e-9);
//! # Ok::<(), btf_io::BtfError>(())
//! ```

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
pub use decode::read_btf_image;
pub use error::BtfError;
pub use image_set::{BtfImages, BtfNotes};
pub use input::{Btf, BtfInput, open_btf};
pub use loaded::LoadedBtf;
pub use maps::{read_albedo, read_map};
pub use names::{ImageAngles, NamedDirection, parse_image_name};
pub use ubo_writer::{UboWriter, WrittenImages};
