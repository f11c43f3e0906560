//! From the pictures of a scene to a material that is judged.

use brdf_job::Job;
use brdf_mesh::{Mesh, UvSource};
use serde::{Deserialize, Serialize};

use crate::buffers::ViewBuffers;
use crate::error::PaintError;
use crate::extract::{Extraction, extract};
use crate::material::{Clamped, PaintedMaterial};
use crate::params::PaintParams;
use crate::samples::{PaintErrors, PaintSamples, PaintedImage, Skipped};
use crate::truth::{GroundTruth, JUDGED_SIZE};
use crate::view::face_views;

/// A picture to learn from, or to judge by.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureInfo {
    /// Name of the view.
    pub name: String,
    /// Linear RGB of a white diffuser in it.
    pub white: [f64; 3],
    /// Whether bright pixels may have been brighter than the file can hold: a photograph in whole numbers.
    pub may_be_saturated: bool,
    /// Whether it is judged by instead of learned from.
    pub is_held_out: bool,
}

/// Options of [`learn`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnParams {
    /// Options of the extraction.
    pub paint: PaintParams,
    /// Pixels whose cosine to the light is below this are left out.
    pub least_cosine: f64,
    /// Most pixels to learn from, evenly from all views.
    pub most_pixels: usize,
}

/// A fact that a reader of the result should know.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PaintNote {
    /// Pixels of a photograph are as bright as its file can hold.
    Saturated {
        /// Number of the picture.
        picture: usize,
        /// Number of pixels.
        pixels: usize,
    },
    /// Pixels beyond the most that are used.
    PassedOver {
        /// Number of them.
        pixels: usize,
    },
    /// Pixels that gave no sample.
    Skipped {
        /// Whether they are of held-out views.
        held_out: bool,
        /// Counts of them, by reason.
        skipped: Skipped,
    },
    /// Values of the material that were cut.
    Clamped {
        /// Counts of them, by side.
        clamped: Clamped,
    },
    /// Texels of the maps that are in no painted pixel.
    Unconstrained {
        /// Number of them.
        texels: usize,
        /// Number of all.
        of: usize,
    },
    /// Views contradict each other.
    Contradictions {
        /// Number of cells of the surface.
        cells: usize,
        /// Number of all.
        of: usize,
    },
}

/// The result of [`learn`]: a material, its errors, and what was left out on the way.
#[derive(Clone, Debug)]
pub struct Learned {
    /// Options of the extraction.
    pub settings: PaintParams,
    /// The material.
    pub extraction: Extraction,
    /// Number of samples that were learned from.
    pub samples: usize,
    /// Counts of pixels that gave no sample.
    pub skipped: Skipped,
    /// Errors over pixels of held-out views; `None` without such views.
    pub held_out: Option<PaintErrors>,
    /// Pixels beyond the most that are used.
    pub passed_over: usize,
    /// Values of the material that were cut.
    pub clamped: Clamped,
    /// Facts that a reader should know.
    pub notes: Vec<PaintNote>,
}

/// A record of how a painted material was made, as files keep it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PaintRecord {
    /// Options.
    pub settings: PaintParams,
    /// Origin of the texture coordinates.
    pub uv: UvSource,
}

/// Learns a material from pictures and judges it by those that are held out.
///
/// `load` returns a picture by its number, with the buffers of its view.
///
/// # Errors
///
/// As [`extract`]; [`PaintError::Size`]; what `load` says.
pub fn learn<E: From<PaintError>>(
    pictures: &[PictureInfo],
    load: &dyn Fn(usize) -> Result<(ViewBuffers, PaintedImage), E>,
    params: &LearnParams,
    job: &Job<'_>,
) -> Result<Learned, E> {
    let [reading, extracting, judging] = job.split([1.0, 8.0, 0.5]);
    reading.begin("reading", pictures.len() as u64);
    let (mut training, mut held_out) = (PaintSamples::new(), PaintSamples::new());
    let (mut notes, mut passed_over) = (Vec::new(), 0);
    let most = params.most_pixels / pictures.len().max(1);
    for (index, info) in pictures.iter().enumerate() {
        reading.check().map_err(PaintError::from)?;
        reading.rename(format!("reading {}", info.name));
        let (buffers, image) = load(index)?;
        let mut samples = PaintSamples::new();
        samples.add(index, &info.name, &buffers, &image, params.least_cosine)?;
        let pixels = if info.may_be_saturated { saturated(&image, info.white) } else { 0 };
        if pixels > 0 {
            notes.push(PaintNote::Saturated { picture: index, pixels });
        }
        passed_over += samples.len().saturating_sub(most);
        let into = if info.is_held_out { &mut held_out } else { &mut training };
        into.append(samples.subset(most));
        reading.advance(1);
    }
    if passed_over > 0 {
        notes.push(PaintNote::PassedOver { pixels: passed_over });
    }
    for (samples, is_held_out) in [(&training, false), (&held_out, true)] {
        if samples.skipped != Skipped::default() {
            notes.push(PaintNote::Skipped { held_out: is_held_out, skipped: samples.skipped });
        }
    }
    let extraction = extract(&training, &params.paint, &extracting)?;
    judging.begin("judging", 1);
    let material = &extraction.material;
    let held_out = (!held_out.is_empty()).then(|| material.errors(&held_out));
    let clamped = material.clamped(&training);
    if clamped.below_zero + clamped.above_limit > 0 {
        notes.push(PaintNote::Clamped { clamped });
    }
    let texels = extraction.unconstrained.iter().filter(|u| **u).count();
    if texels > 0 {
        notes.push(PaintNote::Unconstrained { texels, of: extraction.unconstrained.len() });
    }
    let cells = extraction.contradictions.count();
    if cells > 0 {
        let of = extraction.contradictions.apart.len();
        notes.push(PaintNote::Contradictions { cells, of });
    }
    Ok(Learned {
        settings: params.paint,
        samples: training.len(),
        skipped: training.skipped,
        extraction,
        held_out,
        passed_over,
        clamped,
        notes,
    })
}

/// Pixels that are as bright as a file of whole numbers can hold.
fn saturated(image: &PaintedImage, white: [f64; 3]) -> usize {
    let is_full = |pixel: &&[f32; 4]| {
        pixel[..3].iter().zip(white).any(|(v, white)| f64::from(*v) * white >= 1.0 - 1e-6)
    };
    image.pixels.iter().filter(is_full).count()
}

/// Returns the errors of a material over views and lights between the usual ones, where what was painted is known.
///
/// # Errors
///
/// [`PaintError`].
pub fn truth_errors(
    truth: &GroundTruth<'_>,
    mesh: &Mesh,
    size: [usize; 2],
    least_cosine: f64,
    material: &PaintedMaterial,
) -> Result<PaintErrors, PaintError> {
    let mut samples = PaintSamples::new();
    for (at, view) in face_views(mesh).iter().enumerate() {
        let [width, height] = size.map(|side| side.min(JUDGED_SIZE));
        let buffers = ViewBuffers::of(mesh, view, width, height);
        samples.add(at, &view.name, &buffers, &truth.paint(&buffers), least_cosine)?;
    }
    Ok(material.errors(&samples))
}

/// Errors on the pixels that were learned from, and on those that were not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrainAndHeldOut {
    /// Error of f π over the samples that were learned from.
    pub train: f64,
    /// Error of f π over other samples; null without held-out views or a truth.
    pub held_out: Option<f64>,
}

/// `report.json` of an extraction. The first key marks the folder as ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PaintReport {
    /// Version of the program.
    pub brdf: String,
    /// The scene, as it was given.
    pub scene: String,
    /// The folder of the material.
    pub output: String,
    /// Root mean squares.
    pub rms: TrainAndHeldOut,
    /// Largest differences.
    pub max: TrainAndHeldOut,
    /// Summands of the material.
    pub products: usize,
    /// Pixels that were learned from.
    pub samples: usize,
    /// Texels of the maps that are in no painted pixel.
    pub unconstrained_texels: usize,
    /// Texels of the factors that smoothing alone holds.
    pub smoothed_texels: usize,
    /// Cells of the surface in which views contradict each other, of 64².
    pub contradicted_cells: usize,
    /// Pixels beyond the most that are used.
    pub passed_over: usize,
    /// Pixels that gave no sample, by reason.
    pub skipped: Skipped,
    /// Values of the material that were cut.
    pub clamped: Clamped,
    /// Bytes of the material's file.
    pub bytes: usize,
    /// Time that the extraction took, seconds.
    pub seconds: f64,
    /// Options.
    pub settings: PaintParams,
    /// Facts that a reader should know, in sentences.
    pub notes: Vec<String>,
}

impl PaintReport {
    /// Returns the report of a material whose file has so many bytes. Notes are those of `learned`, in sentences, and
    /// what there is to say about the scene.
    pub fn new(
        version: &str,
        [scene, output]: [&str; 2],
        learned: &Learned,
        bytes: usize,
        seconds: f64,
        notes: Vec<String>,
    ) -> Self {
        let (made, held_out) = (&learned.extraction, learned.held_out);
        let errors = made.errors;
        Self {
            brdf: version.to_owned(),
            scene: scene.to_owned(),
            output: output.to_owned(),
            rms: TrainAndHeldOut { train: errors.rms, held_out: held_out.map(|e| e.rms) },
            max: TrainAndHeldOut { train: errors.max, held_out: held_out.map(|e| e.max) },
            products: made.material.components.len(),
            samples: learned.samples,
            unconstrained_texels: made.unconstrained.iter().filter(|u| **u).count(),
            smoothed_texels: made.smoothed_texels,
            contradicted_cells: made.contradictions.count(),
            passed_over: learned.passed_over,
            skipped: learned.skipped,
            clamped: learned.clamped,
            bytes,
            seconds,
            settings: learned.settings,
            notes,
        }
    }
}
