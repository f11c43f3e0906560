//! Materials of the RGL database in their adaptive parametrization.
//!
//! Source: Dupuy and Jakob 2018. The stored values lie over a warped half vector. A lookup first maps
//! the half vector by the cumulative distribution of visible normals, then reads the value there, and
//! then multiplies it by D(h) / (4 σ(wi)). The product is f · cosθo, so it is divided by the cosine here.

use std::f64::consts::{FRAC_PI_2, TAU};

use brdf_param::{DirectionPair, azimuth, polar_angle};
use glam::DVec2;

use crate::brdf::is_lit;
use crate::{Brdf, InterpolatedWarp, ModelError, Rgb, WarpShape};

/// The tables of a material file, as stored: row-major (C order), f32.
#[derive(Clone, Debug, PartialEq)]
pub struct RglTables {
    /// Nodes of the azimuth of `wi`, radians; one node for an isotropic material.
    pub phi_i: Vec<f32>,
    /// Nodes of the polar angle of `wi`, radians.
    pub theta_i: Vec<f32>,
    /// Distribution of normals D and its shape `[phi, theta]`.
    pub ndf: (Vec<f32>, [usize; 2]),
    /// Projected microfacet area σ and its shape `[phi, theta]`.
    pub sigma: (Vec<f32>, [usize; 2]),
    /// Distribution of visible normals and the sides of a slice `[height, width]`; slices by `phi_i`, `theta_i`.
    pub vndf: (Vec<f32>, [usize; 2]),
    /// Values and the sides of a slice `[height, width]`; slices by `phi_i`, `theta_i`, channel.
    pub rgb: (Vec<f32>, [usize; 2]),
}

/// A material of the RGL database, isotropic or anisotropic.
#[derive(Clone, Debug, PartialEq)]
pub struct RglBrdf {
    ndf: InterpolatedWarp,
    sigma: InterpolatedWarp,
    vndf: InterpolatedWarp,
    rgb: [InterpolatedWarp; 3],
    azimuthal: Azimuthal,
}

/// How much of a turn of `wi` was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Azimuthal {
    /// None: isotropic.
    Isotropic,
    /// A whole turn.
    Full,
    /// Half a turn; the rest by a half-turn symmetry.
    Half,
    /// A quarter of a turn; the rest by mirror symmetry about both axes.
    Quarter,
}

impl RglBrdf {
    /// Returns the material of these tables.
    ///
    /// # Errors
    ///
    /// As [`InterpolatedWarp::lookup`] and [`InterpolatedWarp::pdf`] say of each table.
    pub fn new(tables: RglTables) -> Result<Self, ModelError> {
        let RglTables { phi_i, theta_i, ndf, sigma, vndf, rgb } = tables;
        let azimuthal = match phi_i[..] {
            [first, .., last] => match (TAU / f64::from(last - first)).round() {
                r if r >= 4.0 => Azimuthal::Quarter,
                r if r >= 2.0 => Azimuthal::Half,
                _ => Azimuthal::Full,
            },
            _ => Azimuthal::Isotropic,
        };
        let plain = |[height, width]: [usize; 2]| WarpShape {
            width,
            height,
            phi: vec![0.0],
            theta: vec![0.0],
        };
        let by_incidence = |[height, width]: [usize; 2]| WarpShape {
            width,
            height,
            phi: phi_i.clone(),
            theta: theta_i.clone(),
        };
        let channel = |index: usize| {
            let slice = rgb.1[0].saturating_mul(rgb.1[1]).max(1);
            let values = rgb.0.chunks(slice).skip(index).step_by(3).flatten().copied().collect();
            InterpolatedWarp::lookup("rgb", by_incidence(rgb.1), values)
        };
        Ok(Self {
            ndf: InterpolatedWarp::lookup("ndf", plain(ndf.1), ndf.0)?,
            sigma: InterpolatedWarp::lookup("sigma", plain(sigma.1), sigma.0)?,
            vndf: InterpolatedWarp::pdf("vndf", by_incidence(vndf.1), vndf.0)?,
            rgb: [channel(0)?, channel(1)?, channel(2)?],
            azimuthal,
        })
    }

    /// Returns whether the material is isotropic: measured at one azimuth of `wi` alone.
    pub fn is_isotropic(&self) -> bool {
        self.azimuthal == Azimuthal::Isotropic
    }

    /// Brings `wi` to the azimuths that were measured.
    fn reduced(&self, pair: &DirectionPair) -> DirectionPair {
        let (flip_x, flip_y) = match self.azimuthal {
            Azimuthal::Isotropic | Azimuthal::Full => return *pair,
            Azimuthal::Half => (pair.wi.y > 0.0, pair.wi.y > 0.0),
            Azimuthal::Quarter => (pair.wi.x > 0.0, pair.wi.y > 0.0),
        };
        let sign = |flip: bool| if flip { -1.0 } else { 1.0 };
        let mirror = glam::DVec3::new(sign(flip_x), sign(flip_y), 1.0);
        DirectionPair::new(pair.wi * mirror, pair.wo * mirror)
    }
}

impl Brdf for RglBrdf {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        // Out-of-gamut colours have negative channels; the database's own evaluator clips them.
        self.eval_unclamped(pair).map(|v| v.max(0.0))
    }

    fn eval_unclamped(&self, pair: &DirectionPair) -> Rgb {
        if !is_lit(pair) {
            return Rgb::BLACK;
        }
        let pair = self.reduced(pair);
        let half = pair.half();
        let (theta_i, phi_i) = (polar_angle(pair.wi), azimuth(pair.wi));
        let phi_m = match self.azimuthal {
            Azimuthal::Isotropic => azimuth(half) - phi_i,
            _ => azimuth(half),
        };
        let at = |theta: f64, phi: f64| {
            let turn = phi / TAU + 0.5;
            DVec2::new((theta / FRAC_PI_2).sqrt(), turn - turn.floor())
        };
        let facet = at(polar_angle(half), phi_m);
        let sample = self.vndf.invert(facet, phi_i, theta_i);
        let sigma = self.sigma.eval(at(theta_i, phi_i), 0.0, 0.0);
        let scale = self.ndf.eval(facet, 0.0, 0.0) / (4.0 * sigma * pair.wo.z);
        let [r, g, b] = [0, 1, 2].map(|c| self.rgb[c].eval(sample, phi_i, theta_i));
        let value = Rgb::new(r, g, b) * scale;
        if value.is_finite() { value } else { Rgb::BLACK }
    }
}
