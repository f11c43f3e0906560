//! What fewer terms, or fewer coefficients, do to a picture.

use brdf_image::{Film, Pixel};
use brdf_job::Job;
use brdf_mesh::Mesh;
use brdf_model::Brdf;
use serde::Serialize;

use crate::error::RelightError;
use crate::exact::{ExactParams, exact_part};
use crate::light::{CubeLight, LightRule};
use crate::raster::{RenderParams, render};
use crate::ray_packet::Occluder;
use crate::scene::{Part, RelitScene};
use crate::stored::Transport;

/// The quantity that [`sweep`] varies. Terms and coefficients are taken from the object's own, largest first.
#[derive(Clone, Copy)]
pub enum Vary<'a> {
    /// The number of terms; brute force takes the exact BRDF.
    Terms(&'a dyn Brdf),
    /// The number of wavelet coefficients of each vertex and term; brute force takes the object's terms.
    Coefficients,
}

impl std::fmt::Debug for Vary<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Terms(_) => "Terms",
            Self::Coefficients => "Coefficients",
        })
    }
}

/// Pictures of an object with several numbers of terms or coefficients, and by brute force.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Pictures, one for each number.
    pub films: Vec<Film>,
    /// Picture by brute force at each vertex: all light, adaptive rays.
    pub exact: Film,
    /// Root mean square error of the pixels that show the object, over the root mean square of the exact picture; one
    /// for each number.
    pub relative_rms: Vec<f64>,
}

/// The numbers of terms or coefficients of a sweep.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SweptNumbers {
    /// Numbers of terms.
    Terms(Vec<usize>),
    /// Numbers of wavelet coefficients of each vertex and term.
    Coefficients(Vec<usize>),
}

impl SweptNumbers {
    /// Returns what is counted.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Terms(_) => "terms",
            Self::Coefficients(_) => "coefficients",
        }
    }

    /// Returns the numbers.
    pub fn values(&self) -> &[usize] {
        match self {
            Self::Terms(values) | Self::Coefficients(values) => values,
        }
    }
}

/// `report.json` of a sweep. The first key marks the folder as ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SweepReport {
    /// Version of the program.
    pub brdf: String,
    /// The object's file, as it was given.
    pub object: String,
    /// The material, without folders.
    pub material: String,
    /// The environment, without folders.
    pub env: String,
    /// Factor from linear values to what the pictures show as white.
    pub exposure: f64,
    /// The numbers, under the name of what is counted.
    #[serde(flatten)]
    pub numbers: SweptNumbers,
    /// Errors of the pictures, relative to brute force.
    pub relative_rms: Vec<f64>,
}

/// What [`sweep`] shows, and how.
#[derive(Clone, Copy, Debug)]
pub struct SweepParams<'a> {
    /// The object, for rays.
    pub mesh: &'a Mesh,
    /// What varies.
    pub vary: Vary<'a>,
    /// Its numbers.
    pub values: &'a [usize],
    /// The light; brute force takes all of it.
    pub light: &'a CubeLight,
    /// Which of its coefficients are used.
    pub rule: LightRule,
    /// The picture that is taken.
    pub picture: RenderParams,
}

/// Renders pictures with each of several numbers of terms or coefficients, and one by brute force.
///
/// # Errors
///
/// [`RelightError::Terms`] for a number of terms that the object does not have; [`RelightError::NotWavelets`] for
/// coefficients of an object that has components of clusters; [`RelightError::Stopped`].
pub fn sweep(
    parts: &[Part<'_>],
    params: &SweepParams<'_>,
    job: &Job<'_>,
) -> Result<Sweep, RelightError> {
    let SweepParams { vary, values, .. } = *params;
    let [pictures, brute_force] = job.split([0.1, 1.0]);
    pictures.begin("pictures", values.len() as u64);
    let lit = params.light.coefficients(params.rule);
    let films = values.iter().map(|value| {
        pictures.check()?;
        let (mut relit, parts) = (RelitScene::default(), cut(parts, vary, *value)?);
        relit.relight(&parts, &lit);
        if matches!(vary, Vary::Terms(_)) {
            keep_terms(&parts[0], &mut relit.parts[0], *value);
        }
        pictures.advance(1);
        Ok(render(&parts, &relit, &params.picture).0)
    });
    let films = films.collect::<Result<Vec<Film>, RelightError>>()?;
    let brdf = match vary {
        Vary::Terms(brdf) => Some(brdf),
        Vary::Coefficients => None,
    };
    let exact = by_brute_force(parts, brdf, params, &brute_force)?;
    let relative_rms = films.iter().map(|film| relative_rms(film, &exact)).collect();
    Ok(Sweep { films, exact, relative_rms })
}

/// The parts with so many coefficients, if that is what varies.
fn cut<'a>(
    parts: &[Part<'a>],
    vary: Vary<'_>,
    value: usize,
) -> Result<Vec<Part<'a>>, RelightError> {
    if matches!(vary, Vary::Terms(_)) {
        let most = parts.first().map_or(0, |part| part.maps.terms);
        return match (1..=most).contains(&value) {
            true => Ok(parts.to_vec()),
            false => Err(RelightError::Terms { asked: value, most }),
        };
    }
    let cut = parts.iter().map(|part| match &part.transport {
        Transport::Wavelets(sparse) => {
            let mut part = part.clone();
            part.transport = Transport::Wavelets(sparse.largest(value));
            Ok(part)
        }
        Transport::Clusters(_) => Err(RelightError::NotWavelets),
    });
    cut.collect()
}

/// The picture of the exact BRDF, or of the object's own terms where there is none, at vertices.
fn by_brute_force(
    parts: &[Part<'_>],
    brdf: Option<&dyn Brdf>,
    params: &SweepParams<'_>,
    job: &Job<'_>,
) -> Result<Film, RelightError> {
    let SweepParams { mesh, light, picture, .. } = params;
    let occluder = Occluder::of(mesh);
    let mut relit = RelitScene::default();
    let weights: Vec<f64> = parts.iter().map(|part| part.surface.positions.len() as f64).collect();
    let jobs = job.split_into(&weights);
    let parts = parts.iter().zip(&jobs).enumerate().map(|(index, (part, job))| {
        // The ground's own map is exact.
        let brdf = brdf.filter(|_| index == 0);
        let eye = picture.camera.eye;
        let exact = ExactParams { mesh, occluder: &occluder, brdf, light, eye };
        let (part, colours) = exact_part(part, &exact, job)?;
        relit.parts.push(colours);
        Ok(part)
    });
    let parts = parts.collect::<Result<Vec<Part<'_>>, RelightError>>()?;
    Ok(render(&parts, &relit, picture).0)
}

/// Sets what arrives for further terms to 0.
fn keep_terms(part: &Part<'_>, arriving: &mut [[f32; 3]], terms: usize) {
    for vertex in arriving.chunks_exact_mut(part.maps.terms) {
        vertex[terms..].fill([0.0; 3]);
    }
}

/// Root mean square error of the pixels that show the object, over the root mean square of the exact picture; one
/// for each number.
fn relative_rms(found: &Film, wanted: &Film) -> f64 {
    let pairs = found.pixels().iter().zip(wanted.pixels());
    let shown = pairs.filter_map(|pair| match pair {
        (Pixel::Radiance(found, _), Pixel::Radiance(wanted, _)) => {
            Some((found.channels(), wanted.channels()))
        }
        _ => None,
    });
    let (apart, whole) = shown.fold((0.0, 0.0), |(apart, whole), (found, wanted)| {
        let differs = found.iter().zip(wanted).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        (apart + differs, whole + wanted.iter().map(|v| v * v).sum::<f64>())
    });
    if whole > 0.0 { (apart / whole).sqrt() } else { 0.0 }
}
