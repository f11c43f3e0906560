//! Lambert's ideal diffuser.

use std::f64::consts::PI;

use crate::Rgb;

/// An ideal diffuser, f = albedo / π.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambert {
    /// Share of the light that is reflected, [0, 1].
    pub albedo: Rgb,
}

impl Lambert {
    pub(super) fn value(&self) -> Rgb {
        self.albedo / PI
    }
}
