//! What a point of the surface sends to the viewer under all lights at once.

use std::fmt;

use brdf_model::{Brdf, DirectionBatch, RgbBatch};
use brdf_param::DirectionPair;
use glam::DVec3;

use crate::bounce::Frame;
use crate::height_field::Place;
use crate::horizon::normal;
use crate::lights::{LANES, Lanes, Lights};

/// The reflectance of each point of the surface.
#[derive(Clone, Copy)]
pub enum Reflectance<'a> {
    /// A diffuser: albedo / π.
    Lambertian,
    /// A diffuser with a gloss: albedo / π plus a GGX microfacet lobe (alpha = roughness²; Smith's shadowing, height
    /// correlated; Schlick's Fresnel term). Roughness below .1 is shaded as .1: a sharper lobe would fall between
    /// the directions of the table.
    Ggx {
        /// Reflectance at normal incidence, in [0, 1].
        f0: f32,
    },
    /// A BRDF, in the local frame of the smooth normal with its x axis along the image's, times the
    /// albedo map channel by channel. Much slower. Light that bounces takes the albedo map alone.
    Material(&'a dyn Brdf),
}

impl fmt::Debug for Reflectance<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lambertian => write!(f, "Lambertian"),
            Self::Ggx { f0 } => f.debug_struct("Ggx").field("f0", f0).finish(),
            Self::Material(_) => write!(f, "Material"),
        }
    }
}

/// Least roughness of the microfacet lobe.
const MIN_ROUGHNESS: f32 = 0.1;

/// Least cosine between a point's smooth normal and the viewer: at silhouettes the normal can point
/// away although the point is seen.
const MIN_COS_O: f32 = 1e-3;

/// What a texel's centre contributes to points around it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Surfel {
    pub(crate) gradient: [f32; 2],
    pub(crate) albedo: [f32; 3],
    pub(crate) roughness: f32,
}

impl Surfel {
    /// The weighted sum of four.
    pub(crate) fn mixed(parts: [(&Self, f32); 4]) -> Self {
        let mut sum = Self::default();
        for (part, weight) in parts {
            for axis in 0..2 {
                sum.gradient[axis] += weight * part.gradient[axis];
            }
            for channel in 0..3 {
                sum.albedo[channel] += weight * part.albedo[channel];
            }
            sum.roughness += weight * part.roughness;
        }
        sum
    }
}

/// A point that the viewer sees.
#[derive(Debug)]
pub(crate) struct Point<'a> {
    pub(crate) surfel: Surfel,
    /// Horizons of the four texels around it, and their weights.
    pub(crate) horizons: [(&'a Lanes, f32); 4],
}

/// One view: what depends on viewer and light alone.
#[derive(Debug)]
pub(crate) struct ViewLights<'a> {
    lights: &'a Lights,
    wo: Place,
    /// 1 / (2 + 2 wi·wo): the squared length of wi + wo, inverted.
    inverse_length_sq: Lanes,
    /// Schlick's weight (1 − wi·h)⁵, in which F = F0 + (1 − F0) · weight.
    schlick: Lanes,
}

impl<'a> ViewLights<'a> {
    pub(crate) fn new(lights: &'a Lights, wo: Place) -> Self {
        let cosines: Lanes = std::array::from_fn(|lane| {
            wo[0] * lights.wi[0][lane] + wo[1] * lights.wi[1][lane] + wo[2] * lights.wi[2][lane]
        });
        Self {
            lights,
            wo,
            inverse_length_sq: cosines.map(|cos| 1.0 / (2.0 + 2.0 * cos)),
            schlick: cosines.map(|cos| (1.0 - (0.5 + 0.5 * cos).sqrt()).max(0.0).powi(5)),
        }
    }

    /// Cosines at the point between its normal and each light that reaches it, else 0.
    #[inline(always)]
    fn lit(&self, point: &Point<'_>, normal: Place) -> Lanes {
        let [(h0, w0), (h1, w1), (h2, w2), (h3, w3)] = point.horizons;
        let Lights { wi: [x, y, z], slope, .. } = self.lights;
        let mut lit = [0.0; LANES];
        for lane in 0..LANES {
            let horizon = w0 * h0[lane] + w1 * h1[lane] + w2 * h2[lane] + w3 * h3[lane];
            let cos = normal[0] * x[lane] + normal[1] * y[lane] + normal[2] * z[lane];
            let facing = if cos > 0.0 { cos } else { 0.0 };
            lit[lane] = if slope[lane] > horizon { facing } else { 0.0 };
        }
        lit
    }
}

/// The reflected radiance of `points`, added up, under each light: channels of π L for lights of
/// unit irradiance, so that a white diffuser gives the cosine.
pub(crate) fn shade(
    reflectance: Reflectance<'_>,
    view: &ViewLights<'_>,
    points: &[Point<'_>],
    sums: &mut [Lanes; 3],
) {
    match reflectance {
        Reflectance::Material(brdf) => {
            for point in points {
                add_material(brdf, view, point, sums);
            }
        }
        Reflectance::Lambertian => dispatch(None, view, points, sums),
        Reflectance::Ggx { f0 } => dispatch(Some(f0), view, points, sums),
    }
}

fn dispatch(f0: Option<f32>, view: &ViewLights<'_>, points: &[Point<'_>], sums: &mut [Lanes; 3]) {
    pulp::Arch::new().dispatch(Shade { f0, view, points, sums });
}

/// The call that [`pulp`] compiles once for each instruction set; the widest is taken at run time.
/// Without fused multiply–add all of them give the same bits.
struct Shade<'a> {
    f0: Option<f32>,
    view: &'a ViewLights<'a>,
    points: &'a [Point<'a>],
    sums: &'a mut [Lanes; 3],
}

impl pulp::NullaryFnOnce for Shade<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for point in self.points {
            let normal = normal(point.surfel.gradient);
            let lit = self.view.lit(point, normal);
            if let Some(f0) = self.f0 {
                let lobe = Lobe::new(f0, point.surfel.roughness, normal, self.view);
                add(self.sums, point.surfel.albedo, &lit, &lobe.specular(self.view, normal, &lit));
            } else {
                add(self.sums, point.surfel.albedo, &lit, &[0.0; LANES]);
            }
        }
    }
}

#[inline(always)]
fn add(sums: &mut [Lanes; 3], albedo: [f32; 3], lit: &Lanes, specular: &Lanes) {
    let [red, green, blue] = sums;
    for lane in 0..LANES {
        red[lane] += albedo[0] * lit[lane] + specular[lane];
        green[lane] += albedo[1] * lit[lane] + specular[lane];
        blue[lane] += albedo[2] * lit[lane] + specular[lane];
    }
}

/// The microfacet lobe at a point, as far as it does not depend on the light.
///
/// Sources: B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007;
/// E. Heitz, "Understanding the Masking-Shadowing Function", JCGT 3(2), 2014.
struct Lobe {
    f0: f32,
    alpha_sq: f32,
    /// Cosine between normal and viewer, not clamped: the half vector is made of it.
    raw_cos_o: f32,
    cos_o: f32,
    /// sqrt(alpha² + (1 − alpha²) cos²θo).
    masking_o: f32,
}

impl Lobe {
    #[inline(always)]
    fn new(f0: f32, roughness: f32, normal: Place, view: &ViewLights<'_>) -> Self {
        let alpha_sq = roughness.max(MIN_ROUGHNESS).powi(4);
        let wo = view.wo;
        let raw_cos_o = normal[0] * wo[0] + normal[1] * wo[1] + normal[2] * wo[2];
        let cos_o = raw_cos_o.max(MIN_COS_O);
        let masking_o = (alpha_sq + (1.0 - alpha_sq) * cos_o * cos_o).sqrt();
        Self { f0, alpha_sq, raw_cos_o, cos_o, masking_o }
    }

    /// π times the BRDF's lobe times the cosine, for each light; `lit` are the cosines.
    #[inline(always)]
    fn specular(&self, view: &ViewLights<'_>, normal: Place, lit: &Lanes) -> Lanes {
        let Self { f0, alpha_sq, raw_cos_o, cos_o, masking_o } = *self;
        let [x, y, z] = &view.lights.wi;
        let mut specular = [0.0; LANES];
        for lane in 0..LANES {
            let cos_i = lit[lane];
            // The unclamped cosine: h is needed only where lit, and there both are the same.
            let raw = normal[0] * x[lane] + normal[1] * y[lane] + normal[2] * z[lane];
            let along_h = raw + raw_cos_o;
            let squared = along_h * along_h * view.inverse_length_sq[lane];
            let cos_h_sq = if squared < 1.0 { squared } else { 1.0 };
            let spread = cos_h_sq * (alpha_sq - 1.0) + 1.0;
            let masking_i = (alpha_sq + (1.0 - alpha_sq) * cos_i * cos_i).sqrt();
            let fresnel = f0 + (1.0 - f0) * view.schlick[lane];
            // D = alpha² / (π spread²); G / (4 cosθi cosθo) = 1 / (2 (cosθi mo + cosθo mi)).
            let denominator = spread * spread * (cos_i * masking_o + cos_o * masking_i);
            specular[lane] = 0.5 * cos_i * fresnel * alpha_sq / denominator;
        }
        specular
    }
}

/// Adds a point that reflects as a BRDF does.
fn add_material(brdf: &dyn Brdf, view: &ViewLights<'_>, point: &Point<'_>, sums: &mut [Lanes; 3]) {
    let normal = normal(point.surfel.gradient);
    let frame = Frame::around(normal);
    // The height field's y axis runs down the image; the BRDF's frame is right-handed with y up.
    let local = |direction: Place| {
        let [x, y, z] = frame.to_local(direction).map(f64::from);
        DVec3::new(x, -y, z).normalize()
    };
    let lit = view.lit(point, normal);
    let wo = local(view.wo);
    let lights = &view.lights.wi;
    let pairs: DirectionBatch = (0..LANES)
        .map(|lane| {
            DirectionPair::new(local([lights[0][lane], lights[1][lane], lights[2][lane]]), wo)
        })
        .collect::<Vec<_>>()
        .iter()
        .collect();
    let mut values = RgbBatch::default();
    brdf.eval_batch(pairs.as_slices(), &mut values);
    let albedo = point.surfel.albedo;
    let channels = [&values.r, &values.g, &values.b];
    for (channel, sum) in sums.iter_mut().enumerate() {
        for lane in 0..LANES {
            let scale = std::f32::consts::PI * albedo[channel] * lit[lane];
            sum[lane] += scale * channels[channel][lane];
        }
    }
}
