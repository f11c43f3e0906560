//! Pictures: radiance and what a screen shows of it, side by side with captions, compared as the eye compares
//! them, and as files.
//!
//! A [`Film`] holds linear radiance, a [`ToneMap`] makes a [`DisplayImage`] of it (stated exposure, sRGB, no
//! curve), [`strip`] sets several side by side, [`image_errors`] measures how far two films are apart.
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
mod hdr;
mod image_error;
mod picture;
mod png;
mod strip;

pub use claim::{LONGEST_SIDE, check_claim};
pub use display::{DisplayImage, ToneMap, srgb_bytes};
pub use error::ImageError;
pub use exr::{ExrLayer, encode_exr, exr_size, read_exr_layer};
pub use film::{Film, Pixel};
pub use hdr::{LinearImage, decode_hdr};
pub use image_error::{
    ImageErrors, PIXELS_PER_DEGREE, Planes, SsimWorkspace, delta_e_itp_map, flip_map, image_errors,
    psnr_db, ssim_map,
};
pub use picture::{ExrPlanes, RgbaPicture, decode_picture, exr_planes};
pub use png::encode_png;
pub use strip::{DIFFERENCE_GAIN, Panel, difference, strip};
