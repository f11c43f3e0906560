//! Light at vertices by brute force: slow, and what everything else is measured by.

use brdf_job::Job;
use brdf_mesh::Mesh;
use brdf_model::Brdf;
use brdf_param::DirectionPair;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::chunk::SparseVectors;
use crate::coefficients::Coding;
use crate::cube::TEXELS;
use crate::error::RelightError;
use crate::frame::tangent_frame;
use crate::light::CubeLight;
use crate::maps::BrdfMaps;
use crate::ray_packet::Occluder;
use crate::scene::Part;
use crate::store::SparseTransport;
use crate::stored::Transport;
use crate::surface::diagonal;
use crate::transport::{CubeDirections, TransportWorkspace};
use crate::visibility::Quality;

/// Cosines that vertices are seen at: those that look away are clamped here, where view maps end.
const LEAST_COSINE: f64 = 0.02;

/// What [`exact_part`] computes: the object, its material, the light and the viewer.
#[derive(Clone, Copy)]
pub struct ExactParams<'a> {
    /// The object, for the size of its details.
    pub mesh: &'a Mesh,
    /// What blocks light.
    pub occluder: &'a Occluder,
    /// The exact BRDF, or `None` for the maps of the part.
    pub brdf: Option<&'a dyn Brdf>,
    /// The light, all of it.
    pub light: &'a CubeLight,
    /// Where the viewer stands.
    pub eye: DVec3,
}

impl std::fmt::Debug for ExactParams<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ExactParams").field("eye", &self.eye).finish_non_exhaustive()
    }
}

/// Computes by brute force the light that each vertex of a part reflects to a viewer, as a part that can be
/// rendered.
///
/// At each vertex the BRDF times the cosine is summed over all texels of `light` that `occluder` leaves visible,
/// with sixteen rays a texel where neighbours differ, for the direction to `eye`. With `brdf` the exact BRDF is
/// evaluated; without, the maps of `part`. Nothing is cut or rounded, so the result is the reference for what
/// relighting loses.
///
/// Returns a part with the vertices of `part`, a single term, and a constant view map, together with the radiance of
/// that term at each vertex (linear RGB). Pushed to [`RelitScene::parts`](crate::RelitScene), these colours make
/// [`render`](crate::render) draw the reference picture. Work is counted in vertices.
///
/// # Errors
///
/// [`RelightError::Stopped`].
pub fn exact_part(
    part: &Part<'_>,
    params: &ExactParams<'_>,
    job: &Job<'_>,
) -> Result<(Part<'static>, Vec<[f32; 3]>), RelightError> {
    let ExactParams { mesh, occluder, brdf, light, eye } = *params;
    let sky = CubeDirections::default();
    let maps = &part.maps;
    let shading_points = part.surface.shading_points(diagonal(mesh.positions()));
    job.begin("brute force", shading_points.len() as u64);
    let colours = shading_points.par_iter().map_init(
        || TransportWorkspace::new(maps.light.width()),
        |workspace, site| {
            job.check()?;
            let frame = tangent_frame(site.normal);
            let mut wo = frame.transpose() * (eye - site.position).normalize_or(DVec3::Y);
            wo.z = wo.z.max(LEAST_COSINE);
            let wo = wo.normalize();
            let colour = match brdf {
                Some(brdf) => {
                    let visibility = &mut workspace.visibility;
                    visibility.look(occluder, site.position, site.normal, Quality::Adaptive);
                    let shares = visibility.shares();
                    brute_force(brdf, &sky, light, &frame.as_mat3(), shares, &[wo])[0]
                }
                None => {
                    let quality = Quality::Adaptive;
                    let values = workspace.transport(&sky, occluder, site, &maps.light, quality);
                    seen(maps, &received(values, maps, &light.radiance), wo)
                }
            };
            job.advance(1);
            #[expect(clippy::cast_possible_truncation, reason = "light at vertices is f32")]
            let narrow = colour.map(|v| v as f32);
            Ok(narrow)
        },
    );
    let colours: Vec<[f32; 3]> = colours.collect::<Result<_, RelightError>>()?;
    let none = SparseVectors { largest: vec![0.0], counts: vec![0], ..Default::default() };
    let transport = SparseTransport::of(Coding::Scalar, &vec![&none; colours.len()]);
    let one = BrdfMaps::diffuse(std::f32::consts::PI);
    Ok((Part::assemble(part.surface.clone(), one, Transport::Wavelets(transport)), colours))
}

/// Radiance towards each view of the exact BRDF.
pub(crate) fn brute_force(
    brdf: &dyn Brdf,
    sky: &CubeDirections,
    light: &CubeLight,
    frame: &glam::Mat3,
    shares: &[u8],
    views: &[DVec3],
) -> Vec<[f64; 3]> {
    let to_local = frame.transpose();
    let mut sums = vec![[0.0; 3]; views.len()];
    for texel in (0..TEXELS).filter(|texel| shares[*texel] > 0) {
        let wi = (to_local * sky.directions()[texel]).as_dvec3().normalize();
        let weight =
            f64::from(sky.solid_angles()[texel]) * wi.z.max(0.0) * f64::from(shares[texel]) / 16.0;
        if weight <= 0.0 {
            continue;
        }
        for (sum, wo) in sums.iter_mut().zip(views) {
            let value = brdf.eval(&DirectionPair::new(wi, *wo)).channels();
            let radiance = light.radiance[texel];
            for channel in 0..3 {
                sum[channel] += weight * value[channel] * f64::from(radiance[channel]);
            }
        }
    }
    sums
}

/// What each term receives of all light: dense transport times radiance.
pub(crate) fn received(values: &[f32], maps: &BrdfMaps, radiance: &[[f32; 3]]) -> Vec<[f64; 3]> {
    let (width, channels) = (maps.light.width(), maps.light_channels());
    let mut sums = vec![[0.0; 3]; maps.terms];
    for (values, radiance) in values.chunks_exact(width).zip(radiance) {
        for (sum, value) in sums.iter_mut().zip(values.chunks_exact(channels)) {
            for channel in 0..3 {
                let value = value[channel.min(channels - 1)];
                sum[channel] += f64::from(value) * f64::from(radiance[channel]);
            }
        }
    }
    sums
}

/// Σ_k h_k(wo) times what arrives for k.
#[expect(clippy::cast_possible_truncation, reason = "maps are f32")]
pub(crate) fn seen(maps: &BrdfMaps, arriving: &[[f64; 3]], wo: DVec3) -> [f64; 3] {
    let mut values = vec![0.0; maps.view.width()];
    maps.view.read(Vec3::new(wo.x as f32, wo.y as f32, wo.z as f32), 1.0, &mut values);
    let mut sum = [0.0; 3];
    for (value, h) in arriving.iter().zip(values.as_chunks::<3>().0) {
        for channel in 0..3 {
            sum[channel] += value[channel] * f64::from(h[channel]);
        }
    }
    sum
}
