//! How far relighting is from what it stands for, and which step loses what.

use brdf_job::Job;
use brdf_model::Brdf;
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::RelightError;
use crate::exact::{brute_force, received, seen};
use crate::frame::tangent_frame;
use crate::light::{CubeLight, LightRule};
use crate::ray_packet::Occluder;
use crate::scene::{Part, RelitScene};
use crate::surface::diagonal;
use crate::transport::{CubeDirections, TransportWorkspace};
use crate::visibility::Quality;

/// Options of [`compare`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompareParams {
    /// Number of vertices that are compared, taken evenly from all.
    pub vertices: usize,
    /// Number of rays that transport was made with.
    pub quality: Quality,
    /// Rule by which coefficients of the light are used.
    pub rule: LightRule,
}

/// Relative errors of relighting, by cause: the root of the sum of squared differences over that of squares, all
/// channels, vertices and views together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ErrorBreakdown {
    /// Error of everything together, from the exact BRDF under all light with sixteen rays a texel.
    pub total: f64,
    /// Error of the number of terms alone.
    pub rank: f64,
    /// Error of cutting and rounding coefficients, from the same terms with all.
    pub coefficients: f64,
    /// Error of the light's coefficients, from all of them with the same transport.
    pub light: f64,
    /// Error of fewer rays, from sixteen with the exact BRDF.
    pub visibility: f64,
    /// Number of colours compared: vertices times views that see them.
    pub colours: usize,
    /// Number of these colours with a channel below 0.
    pub negative: usize,
}

/// Sums of squares of a comparison.
#[derive(Clone, Copy, Default)]
struct Sums {
    apart: f64,
    wanted: f64,
}

impl Sums {
    fn add(&mut self, found: [f64; 3], wanted: [f64; 3]) {
        for (found, wanted) in found.into_iter().zip(wanted) {
            self.apart += (found - wanted).powi(2);
            self.wanted += wanted.powi(2);
        }
    }

    fn ratio(&self) -> f64 {
        if self.wanted > 0.0 { (self.apart / self.wanted).sqrt() } else { 0.0 }
    }
}

/// Colours of one vertex from one view, by what is left out.
struct Colours {
    /// Exact BRDF, sixteen rays a texel, all light.
    exact: [f64; 3],
    /// The same with the rays of the precomputation.
    fewer_rays: [f64; 3],
    /// The terms of the BRDF, sixteen rays, all coefficients, all light.
    terms: [f64; 3],
    /// The same with the rays of the precomputation.
    uncut: [f64; 3],
    /// The same with the coefficients that are stored.
    all_light: [f64; 3],
    /// The same with the light's coefficients that are used.
    stored: [f64; 3],
}

/// Views are from the six axes; what they see at less than this cosine does not count.
const LEAST_COSINE: f64 = 0.1;
const VIEWS: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];

/// Compares the colours of an object's vertices, seen from the six axes, with brute force. Work is counted in
/// vertices.
///
/// # Errors
///
/// [`RelightError::Stopped`].
pub fn compare(
    part: &Part<'_>,
    occluder: &Occluder,
    brdf: &dyn Brdf,
    light: &CubeLight,
    params: &CompareParams,
    job: &Job<'_>,
) -> Result<ErrorBreakdown, RelightError> {
    let (surface, maps) = (&part.surface, &part.maps);
    let shading_points = surface.shading_points(diagonal(&surface.positions));
    let count = params.vertices.clamp(1, shading_points.len());
    let sky = CubeDirections::default();
    let [all_light, stored] = [LightRule::All, params.rule].map(|rule| {
        let mut relit = RelitScene::default();
        relit.relight(std::slice::from_ref(part), &light.coefficients(rule));
        relit.parts.swap_remove(0)
    });
    job.begin("brute force", count as u64);
    let colours: Vec<Vec<Colours>> = (0..count)
        .into_par_iter()
        .map_init(
            || TransportWorkspace::new(maps.light.width()),
            |workspace, at| {
                job.check()?;
                let vertex = at * shading_points.len() / count;
                let site = shading_points[vertex];
                let views: Vec<DVec3> =
                    VIEWS.into_iter().filter(|view| view.dot(site.normal) > LEAST_COSINE).collect();
                let frame = tangent_frame(site.normal);
                let locals: Vec<DVec3> = views.iter().map(|v| frame.transpose() * *v).collect();
                let look = |workspace: &mut TransportWorkspace, quality| {
                    workspace.visibility.look(occluder, site.position, site.normal, quality);
                    let shares = workspace.visibility.shares().to_vec();
                    brute_force(brdf, &sky, light, &frame.as_mat3(), &shares, &locals)
                };
                let exact = look(workspace, Quality::Sixteen);
                let fewer_rays = look(workspace, params.quality);
                let dense = |workspace: &mut TransportWorkspace, quality| {
                    let values = workspace.transport(&sky, occluder, &site, &maps.light, quality);
                    received(values, maps, &light.radiance)
                };
                let full = dense(workspace, Quality::Sixteen);
                let own = dense(workspace, params.quality);
                let kept = [&all_light, &stored].map(|relit| {
                    let own = &relit[vertex * maps.terms..][..maps.terms];
                    own.iter().map(|value| value.map(f64::from)).collect::<Vec<_>>()
                });
                let view = |arriving: &[[f64; 3]], local: DVec3| seen(maps, arriving, local);
                job.advance(1);
                let each = locals.iter().zip(exact).zip(fewer_rays);
                let each = each.map(|((local, exact), fewer_rays)| Colours {
                    exact,
                    fewer_rays,
                    terms: view(&full, *local),
                    uncut: view(&own, *local),
                    all_light: view(&kept[0], *local),
                    stored: view(&kept[1], *local),
                });
                Ok(each.collect())
            },
        )
        .collect::<Result<_, RelightError>>()?;
    let mut sums = [Sums::default(); 5];
    let (mut count, mut negative) = (0, 0);
    for colours in colours.iter().flatten() {
        let pairs = [
            (colours.stored, colours.exact),
            (colours.terms, colours.exact),
            (colours.all_light, colours.uncut),
            (colours.stored, colours.all_light),
            (colours.fewer_rays, colours.exact),
        ];
        sums.iter_mut().zip(pairs).for_each(|(sums, (found, wanted))| sums.add(found, wanted));
        count += 1;
        negative += usize::from(colours.stored.iter().any(|v| *v < 0.0));
    }
    let [total, rank, coefficients, light, visibility] = sums.map(|sums| sums.ratio());
    Ok(ErrorBreakdown { total, rank, coefficients, light, visibility, colours: count, negative })
}
