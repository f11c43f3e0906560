//! Sets of images, one for each view and light: directions and size, before any is decoded.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use btf_vq::{BtfLayout, BtfView, Encoding};

use super::{BtfError, ImageAngles, NamedDirection};
use crate::decode::{ImageKind, image_size};
use crate::files::Files;
use crate::names::parse_image_name;
use brdf_files::{FileError, MappedFile};

/// Views, and lights of a view, that interpolation needs at least.
const LEAST_DIRECTIONS: usize = 3;

/// A set of images whose names give their directions. It is sorted by view, then light; both by polar angle, then
/// azimuth.
#[derive(Debug)]
pub struct BtfImages {
    path: PathBuf,
    files: Files,
    images: Vec<Image>,
    layout: BtfLayout,
    notes: BtfNotes,
}

/// Unusual facts about a set of images that are no errors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BtfNotes {
    /// Images that views have less than there are common lights.
    pub missing: usize,
    /// Images whose light at most half of the views have: lights that were moved out of the way of
    /// the camera.
    pub off_table_lights: Vec<String>,
    /// Files whose names have no angles.
    pub foreign_files: Vec<String>,
}

impl BtfNotes {
    /// Returns one sentence, without a full stop, for each note.
    pub fn sentences(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if self.missing > 0 {
            lines.push(format!(
                "{} images are missing; their values are interpolated from those of the same view",
                self.missing
            ));
        }
        let list = |names: &[String]| {
            let shown: Vec<&str> = names.iter().take(3).map(String::as_str).collect();
            let rest = if names.len() > 3 { " …" } else { "" };
            format!("{}{rest}", shown.join(", "))
        };
        if !self.off_table_lights.is_empty() {
            let (count, names) = (self.off_table_lights.len(), list(&self.off_table_lights));
            lines.push(format!("{count} lights stand where most views have none: {names}"));
        }
        // Our own report is no surprise.
        let is_foreign = |name: &&String| name.rsplit('/').next() != Some("report.json");
        let foreign: Vec<String> = self.foreign_files.iter().filter(is_foreign).cloned().collect();
        if !foreign.is_empty() {
            let (count, names) = (foreign.len(), list(&foreign));
            lines.push(format!("{count} files are not named by angles and were not read: {names}"));
        }
        lines
    }
}

/// An image of the set and its file.
#[derive(Clone, Copy, Debug)]
struct Image {
    angles: ImageAngles,
    file: usize,
}

impl BtfImages {
    /// Opens a folder of images, and the folders below it. Only the names, and the size of the first image, are
    /// read.
    ///
    /// # Errors
    ///
    /// [`FileError::Content`] for names that contradict each other or make no set, and an unreadable first
    /// image.
    pub fn in_folder(path: &Path) -> Result<Self, FileError> {
        Self::of(path, Files::in_folder(path)?)
    }

    /// Opens a ZIP archive of images in any folders. Messages name it by its path.
    ///
    /// # Errors
    ///
    /// [`FileError::Content`] as for folders, and for what is no archive.
    pub fn in_archive(path: &Path, bytes: MappedFile) -> Result<Self, FileError> {
        Self::of(path, Files::in_archive(path, bytes)?)
    }

    fn of(path: &Path, files: Files) -> Result<Self, FileError> {
        Self::find(path, files).map_err(FileError::content(path))
    }

    fn find(path: &Path, files: Files) -> Result<Self, BtfError> {
        let (images, foreign_files) = named_images(files.names())?;
        check_unique(&images, files.names())?;
        let views = views(&images)?;
        let (missing, off_table) = compare_lights(&images, &views);
        let notes = BtfNotes {
            missing,
            off_table_lights: off_table.iter().map(|i| files.names()[i.file].clone()).collect(),
            foreign_files,
        };
        let (size, linear) = look_at_kinds(&files, &images)?;
        let layout = layout(size, linear, &views);
        Ok(Self { path: path.to_owned(), files, images, layout, notes })
    }

    /// Returns size and directions.
    pub fn layout(&self) -> &BtfLayout {
        &self.layout
    }

    /// Returns what is unusual about the set.
    pub fn notes(&self) -> &BtfNotes {
        &self.notes
    }

    /// Returns the directions of the images, in their order.
    pub fn angles(&self) -> impl ExactSizeIterator<Item = ImageAngles> + '_ {
        self.images.iter().map(|image| image.angles)
    }

    /// The folder or archive.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Path of an image within the folder or archive.
    pub(super) fn name(&self, image: usize) -> &str {
        &self.files.names()[self.images[image].file]
    }

    /// The bytes of an image.
    pub(super) fn read(&self, image: usize) -> Result<Vec<u8>, BtfError> {
        self.files.read(self.images[image].file)
    }
}

/// Images among named files, sorted, and the names of other files.
fn named_images(names: &[String]) -> Result<(Vec<Image>, Vec<String>), BtfError> {
    let mut images = Vec::new();
    let mut foreign = Vec::new();
    for (file, name) in names.iter().enumerate() {
        match parse_image_name(name)? {
            Some(angles) => images.push(Image { angles, file }),
            None => foreign.push(name.clone()),
        }
    }
    if images.is_empty() {
        return Err(BtfError::NoImages { files: names.len() });
    }
    images.sort_by_key(|image| (image.angles, image.file));
    Ok((images, foreign))
}

fn check_unique(images: &[Image], names: &[String]) -> Result<(), BtfError> {
    match images.windows(2).find(|pair| pair[0].angles == pair[1].angles) {
        Some(pair) => Err(BtfError::Duplicate {
            name: names[pair[1].file].clone(),
            other: names[pair[0].file].clone(),
        }),
        None => Ok(()),
    }
}

/// The images of each view.
fn views(images: &[Image]) -> Result<Vec<&[Image]>, BtfError> {
    let views: Vec<&[Image]> = images.chunk_by(|a, b| a.angles.view == b.angles.view).collect();
    let few = |what, found| BtfError::TooFew { what, found, least: LEAST_DIRECTIONS };
    if views.len() < LEAST_DIRECTIONS {
        return Err(few("views".to_owned(), views.len()));
    }
    match views.iter().find(|lights| lights.len() < LEAST_DIRECTIONS) {
        Some(few_lights) => {
            let what = format!("lights of the view at {}", few_lights[0].angles.view);
            Err(few(what, few_lights.len()))
        }
        None => Ok(views),
    }
}

/// How many images are missing, and those with a light that at most half of the views have.
fn compare_lights<'a>(images: &'a [Image], views: &[&[Image]]) -> (usize, Vec<&'a Image>) {
    let mut uses: HashMap<NamedDirection, usize> = HashMap::new();
    for image in images {
        *uses.entry(image.angles.light).or_default() += 1;
    }
    let is_common = |light| 2 * uses[light] > views.len();
    let common = uses.keys().filter(|light| is_common(light)).count();
    let missing = views.iter().map(|lights| common.saturating_sub(lights.len())).sum();
    (missing, images.iter().filter(|image| !is_common(&image.angles.light)).collect())
}

/// Size of the first image, and whether images are linear. One file of each extension is looked at;
/// the others when they are decoded.
fn look_at_kinds(files: &Files, images: &[Image]) -> Result<([usize; 2], bool), BtfError> {
    let extension = |image: &Image| {
        let name = &files.names()[image.file];
        name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase()
    };
    let first = &images[0];
    let (size, linear) = look_at(files, first)?;
    let mut seen = vec![extension(first)];
    for image in images {
        let extension = extension(image);
        if seen.contains(&extension) {
            continue;
        }
        seen.push(extension);
        if look_at(files, image)?.1 != linear {
            let (name, other) = (&files.names()[image.file], &files.names()[first.file]);
            return Err(BtfError::MixedRanges {
                name: name.clone(),
                linear: !linear,
                other: other.clone(),
            });
        }
        // Names without extension end in anything.
        if seen.len() > 8 {
            break;
        }
    }
    Ok((size, linear))
}

fn look_at(files: &Files, image: &Image) -> Result<([usize; 2], bool), BtfError> {
    let bytes = files.read(image.file)?;
    let size = image_size(&bytes).and_then(|size| Ok((size, ImageKind::of(&bytes)?.is_linear())));
    size.map_err(|problem| BtfError::Image { name: files.names()[image.file].clone(), problem })
}

fn layout([width, height]: [usize; 2], linear: bool, views: &[&[Image]]) -> BtfLayout {
    let view = |images: &&[Image]| BtfView {
        wo: images[0].angles.view.direction(),
        lights: images.iter().map(|image| image.angles.light.direction()).collect(),
    };
    BtfLayout {
        width,
        height,
        views: views.iter().map(view).collect(),
        encoding: if linear { Encoding::Linear } else { Encoding::Srgb },
        // Photographs of a sample under a lamp.
        cosine_included: true,
    }
}
