//! Pictures of materials: exposure and sRGB, captioned strips, measures of difference, and image files.
//!
//! - A [`Film`] holds linear radiance. A [`ToneMap`] makes a [`DisplayImage`] of it: a stated exposure, then sRGB, with no
//!   curve.
//! - [`strip()`] puts pictures side by side with captions; [`difference`] shows where two films differ.
//! - [`image_errors`] measures how far two films are apart, by PSNR, SSIM, ꟻLIP and ΔE ITP.
//! - [`encode_png`] and [`encode_exr`] write, [`decode_picture`], [`decode_stored`], [`decode_hdr`] and [`exr_planes`] read. They work on
//!   bytes, and a header's size is checked against the length of the file before memory is reserved.
//!
//! ```
//! use brdf_image::{Film, Pixel, ToneMap, encode_png, image_errors};
//! use brdf_model::Rgb;
//!
//! let film = |grey| Film::new(8, vec![Pixel::Radiance(Rgb::splat(grey), 1.0); 64]);
//! let (reference, model) = (film(0.2), film(0.21));
//! let tone = ToneMap::exposed_for(&reference);
//! let errors = image_errors(&reference, &model, tone.exposure);
//! assert!(errors.flip < 0.1 && errors.delta_e_itp > 0.0);
//! assert!(encode_png(&tone.apply(&model))?.starts_with(b"\x89PNG"));
//! # Ok::<(), brdf_image::ImageError>(())
//! ```

mod claim;
mod display;
mod error;
mod exr;
mod film;
mod image_error;
mod picture;
mod png;
mod radiance;
mod stored;
mod strip;

pub use claim::{LONGEST_SIDE, check_claim};
pub use display::{DisplayImage, ToneMap, srgb_bytes};
pub use error::ImageError;
pub use exr::{ExrLayer, encode_exr, exr_size, read_exr_layer};
pub use film::{Film, Pixel};
pub use image_error::{
    ImageErrors, PIXELS_PER_DEGREE, Planes, SsimWorkspace, delta_e_itp_map, flip_map, image_errors,
    psnr_db, ssim_map,
};
pub use picture::{ExrPlanes, RgbaPicture, decode_picture, exr_planes};
pub use png::encode_png;
pub use radiance::{LinearImage, decode_hdr, hdr_size};
pub use stored::{Samples, StoredImage, decode_stored, stored_size};
pub use strip::{DIFFERENCE_GAIN, Panel, difference, strip};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
