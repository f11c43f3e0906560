//! Views of an object, ready to be painted.

use brdf_image::DisplayImage;
use brdf_job::Job;
use brdf_mesh::{Mesh, UvSource};
use serde::{Deserialize, Serialize};

use crate::buffers::ViewBuffers;
use crate::error::PaintError;
use crate::pictures::guide;
use crate::samples::PaintedImage;
use crate::truth::{GroundTruth, JUDGED_SIZE, TruthRecord};
use crate::view::PaintView;

/// A view, its buffers, and the picture that is painted on.
#[derive(Clone, Debug)]
pub struct PreparedView {
    /// Name of the view.
    pub name: String,
    /// Surfaces that the pixels show.
    pub buffers: ViewBuffers,
    /// A grey picture to paint over.
    pub guide: DisplayImage,
    /// Picture of the truth, where there is one.
    pub painting: Option<PaintedImage>,
}

/// Counts of what was prepared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Prepared {
    /// Pixels of the object in all views.
    pub pixels: usize,
    /// Pixels of the object that are seen and lit.
    pub lit_pixels: usize,
    /// Factor by which the truth's f π was multiplied.
    pub scale: Option<f64>,
}

/// `report.json` of a scene that is ready to be painted. The first key marks the folder as ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SetupReport {
    /// Version of the program.
    pub brdf: String,
    /// The folder.
    pub scene: String,
    /// Number of views.
    pub views: usize,
    /// Columns and rows of the pictures.
    pub size: [usize; 2],
    /// Pixels of the object in all views.
    pub pixels: usize,
    /// Pixels of the object that are seen and lit.
    pub lit_pixels: usize,
    /// Origin of the texture coordinates.
    pub uv: UvSource,
    /// The truth that paintings were rendered with, if there is one.
    pub truth: Option<TruthRecord>,
}

/// Prepares views for painting, in pictures of `size` columns and rows, and passes them to `take` one after another.
///
/// With a truth, paintings are rendered, at the scale at which nearly all of it is within [0, 1].
///
/// # Errors
///
/// [`PaintError::NotInView`] for a view that does not show the object; [`PaintError::Stopped`]; what `take` says.
pub fn prepare<E: From<PaintError>>(
    mesh: &Mesh,
    views: &[PaintView],
    size: [usize; 2],
    truth: Option<GroundTruth<'_>>,
    job: &Job<'_>,
    take: &mut dyn FnMut(PreparedView) -> Result<(), E>,
) -> Result<Prepared, E> {
    job.begin("scale of the truth", views.len() as u64);
    let truth = truth.map(|truth| {
        let [width, height] = size.map(|side| side.min(JUDGED_SIZE));
        let small = views.iter().map(|view| ViewBuffers::of(mesh, view, width, height));
        truth.scaled_for(&small.collect::<Vec<_>>())
    });
    let scale = truth.as_ref().map(|truth| truth.scale);
    let mut prepared = Prepared { pixels: 0, lit_pixels: 0, scale };
    for view in views {
        job.check().map_err(PaintError::from)?;
        job.rename(view.name.clone());
        let buffers = ViewBuffers::of(mesh, view, size[0], size[1]);
        let seen = buffers.pixels.iter().flatten().count();
        if seen == 0 {
            return Err(PaintError::NotInView { view: view.name.clone() }.into());
        }
        prepared.pixels += seen;
        prepared.lit_pixels +=
            buffers.pixels.iter().flatten().filter(|s| s.is_seen_and_lit()).count();
        let painting = truth.as_ref().map(|truth| truth.paint(&buffers));
        let guide = guide(&buffers);
        take(PreparedView { name: view.name.clone(), buffers, guide, painting })?;
        job.advance(1);
    }
    Ok(prepared)
}
