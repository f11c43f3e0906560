//! Bidirectional texture functions: sets of images named by their directions.

mod decode;
mod error;
mod files;
mod image_set;
mod input;
mod loaded;
mod names;
mod store;

pub use error::BtfError;
pub use image_set::{BtfImages, BtfNotes};
pub use input::{Btf, BtfInput, open_btf};
pub use loaded::LoadedBtf;
pub use names::{ImageAngles, NamedDirection, parse_image_name};
