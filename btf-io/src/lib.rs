//! Bidirectional texture functions as files.
//!
//! - [`open_btf`] opens a folder or ZIP archive of images named by their directions, or a binary `.btf` file of the
//!   University of Bonn, whichever the content is. The [`BtfInput`] that it returns knows directions and sizes before
//!   anything is decoded; [`BtfInput::load`] decodes.
//! - [`read_map`] and [`read_albedo`] read the maps of height, normal and albedo that images are synthesized from.
//!   [`read_surface`] makes a surface of them.
//! - [`UboWriter`] writes images in the layout of the UBO2003 measurements: synthesized ones with [`write_synthesized`],
//!   those of a compressed BTF with [`write_decompressed`].
//!
//! What is loaded is a [`btf_vq::BtfSource`], which `btf-vq` compresses.
//!
//! ```
//! use btf_io::parse_image_name;
//!
//! let angles = parse_image_name("tl015 pl000 tv030 pv090.jpg")?.expect("all four angles");
//! assert!((angles.light.theta_deg() - 15.0).abs() < 1e-9);
//! assert!((angles.view.phi_deg() - 90.0).abs() < 1e-9);
//! # Ok::<(), btf_io::BtfError>(())
//! ```

mod bonn_factors;
mod bonn_file;
mod bonn_header;
mod bonn_texels;
mod colour_model;
mod decode;
mod decompress;
mod error;
mod exr_picture;
mod files;
mod image_set;
mod info;
mod input;
mod linear;
mod loaded;
mod maps;
mod names;
mod queries;
mod srgb;
mod store;
mod synthesis;
mod ubo_writer;

pub use bonn_file::BtfFile;
pub use decode::read_btf_image;
pub use decompress::{DecompressReport, write_decompressed};
pub use error::BtfError;
pub use image_set::{BtfImages, BtfNotes};
pub use info::BtfInfo;
pub use input::{Btf, BtfInput, open_btf};
pub use loaded::LoadedBtf;
pub use maps::{read_albedo, read_map};
pub use names::{ImageAngles, NamedDirection, parse_image_name};
pub use queries::{answer_table, drawn_table, read_queries};
pub use synthesis::{
    Relief, Roughness, SurfaceFiles, SynthReport, SynthesisError, read_surface, write_synthesized,
};
pub use ubo_writer::{UboWriter, WrittenImages};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
