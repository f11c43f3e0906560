//! The folder layout of the UBO2003 measurements: a folder for each view, in it a JPEG for each
//! light, with the directions in the names.

use std::fs;
use std::path::{Path, PathBuf};

use btf_synth::{LIGHT_COUNT, ubo_directions};
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use rayon::prelude::*;

use crate::srgb::srgb_bytes_clipped;
use brdf_files::{FileError, OutputFolder};
use brdf_io::FormatError;
use brdf_job::Job;

use crate::error::BtfError;

/// Of 100. Artefacts then stay below a grey level or two.
const JPEG_QUALITY: u8 = 95;

/// Bytes of disk to ask for, per texel of an image: rough surfaces take .5 to 1 at this quality.
const BYTES_PER_TEXEL: u64 = 1;

/// Counts of the images that were written, and of what 8 bits could not hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WrittenImages {
    /// Number of images.
    pub images: usize,
    /// Values, three for each texel of each image.
    pub values: u64,
    /// Values above 1, which were clipped.
    pub clipped: u64,
    /// The largest value.
    pub peak: f32,
    /// Bytes of all images.
    pub bytes: u64,
}

impl WrittenImages {
    /// Returns the share of values that were clipped, in [0, 1].
    pub fn clipped_share(&self) -> f64 {
        self.clipped as f64 / self.values.max(1) as f64
    }

    fn add(mut self, other: Self) -> Self {
        self.images += other.images;
        self.values += other.values;
        self.clipped += other.clipped;
        self.peak = self.peak.max(other.peak);
        self.bytes += other.bytes;
        self
    }
}

/// A writer of a BTF as a folder of images, in the layout of the UBO2003 measurements. The folder appears only when
/// complete.
#[derive(Debug)]
pub struct UboWriter {
    folder: OutputFolder,
    size: [u16; 2],
    written: WrittenImages,
}

impl UboWriter {
    /// Starts a folder for images of `width` × `height` texels. Nothing changes at `place` until
    /// [`UboWriter::finish`].
    ///
    /// # Errors
    ///
    /// As [`OutputFolder::new`]; [`FileError::DiskFull`] if the disk has too little room;
    /// [`FileError::Content`] for a size that JPEG does not know.
    pub fn new(place: &Path, width: usize, height: usize, force: bool) -> Result<Self, FileError> {
        let (Ok(columns), Ok(rows)) = (u16::try_from(width), u16::try_from(height)) else {
            let problem = format!("{width} × {height} texels are too many");
            return Err(FileError::content(place)(FormatError::Library { what: "JPEG", problem }));
        };
        let folder = OutputFolder::new(place, force)?;
        let images = (LIGHT_COUNT * LIGHT_COUNT) as u64;
        let needed = images * u64::from(columns) * u64::from(rows) * BYTES_PER_TEXEL;
        folder.check_space(needed)?;
        Ok(Self { folder, size: [columns, rows], written: WrittenImages::default() })
    }

    /// Writes the images of a view of [`ubo_directions`] under all lights, from linear `values[light][texel][rgb]`.
    /// They are encoded as sRGB, and values above 1 are clipped and counted.
    ///
    /// # Errors
    ///
    /// [`FileError::File`]; [`FileError::Content`] if the encoder refuses.
    ///
    /// # Panics
    ///
    /// If `view` is not below 81 or `values` has another size.
    pub fn write_view(&mut self, view: usize, values: &[f32]) -> Result<(), FileError> {
        let image_len = 3 * usize::from(self.size[0]) * usize::from(self.size[1]);
        assert_eq!(
            values.len(),
            LIGHT_COUNT * image_len,
            "one value for each light, texel, channel"
        );
        let table = ubo_directions();
        let folder = self.folder.create_folder(&view_folder(table[view]))?;
        let size = self.size;
        let written: Result<Vec<WrittenImages>, FileError> = values
            .par_chunks_exact(image_len)
            .zip(&table)
            .enumerate()
            .map(|(light, (image, &direction))| {
                let path = folder.join(image_name(light, direction, table[view]));
                write_image(&path, image, size)
            })
            .collect();
        self.written = written?.into_iter().fold(self.written, WrittenImages::add);
        Ok(())
    }

    /// Writes the images of all views, which `fill` puts into `[light][texel][rgb]` for the number of a view. Work is
    /// counted in views.
    ///
    /// # Errors
    ///
    /// As [`UboWriter::write_view`]; [`BtfError::Stopped`] as the content of a [`FileError::Content`].
    pub fn write_views(
        &mut self,
        mut fill: impl FnMut(usize, &mut [f32]),
        job: &Job<'_>,
    ) -> Result<WrittenImages, FileError> {
        let [width, height] = self.size.map(usize::from);
        let mut values = vec![0.0; LIGHT_COUNT * 3 * width * height];
        job.begin("writing views", LIGHT_COUNT as u64);
        for view in 0..LIGHT_COUNT {
            let stopped =
                |stopped| FileError::content(self.folder.place())(BtfError::from(stopped));
            job.check().map_err(stopped)?;
            job.rename(format!("view {} of {LIGHT_COUNT}", view + 1));
            fill(view, &mut values);
            self.write_view(view, &values)?;
            job.advance(1);
        }
        Ok(self.written)
    }

    /// Returns what was written so far.
    pub fn written(&self) -> WrittenImages {
        self.written
    }

    /// Adds `report`, by which the folder is known to be ours, moves the folder to its place, and returns that
    /// place.
    ///
    /// # Errors
    ///
    /// [`FileError::File`].
    pub fn finish(mut self, report: &str) -> Result<PathBuf, FileError> {
        self.folder.write("report.json", report.as_bytes())?;
        self.folder.finish()
    }
}

/// The folder of a view; degrees.
fn view_folder((theta, phi): (u32, u32)) -> String {
    format!("tv{theta:03}_pv{phi:03}")
}

/// The file of an image; degrees. The number counts the images of a folder.
fn image_name(index: usize, light: (u32, u32), view: (u32, u32)) -> String {
    let ((tl, pl), (tv, pv)) = (light, view);
    format!("{index:05} tl{tl:03} pl{pl:03} tv{tv:03} pv{pv:03}.jpg")
}

fn write_image(path: &Path, image: &[f32], size: [u16; 2]) -> Result<WrittenImages, FileError> {
    let bytes = jpeg_bytes(&srgb_bytes_clipped(image), size).map_err(FileError::content(path))?;
    fs::write(path, &bytes).map_err(FileError::file(path, "writing"))?;
    Ok(WrittenImages {
        images: 1,
        values: image.len() as u64,
        clipped: image.iter().map(|&value| u64::from(value > 1.0)).sum(),
        peak: image.iter().copied().fold(0.0, f32::max),
        bytes: bytes.len() as u64,
    })
}

fn jpeg_bytes(rgb: &[u8], [width, height]: [u16; 2]) -> Result<Vec<u8>, FormatError> {
    let mut bytes = Vec::with_capacity(rgb.len() / 3);
    let mut encoder = Encoder::new(&mut bytes, JPEG_QUALITY);
    encoder.set_sampling_factor(SamplingFactor::R_4_4_4);
    encoder
        .encode(rgb, width, height, ColorType::Rgb)
        .map_err(|error| FormatError::Library { what: "JPEG", problem: error.to_string() })?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(place: &Path, force: bool) -> Result<WrittenImages, FileError> {
        let mut writer = UboWriter::new(place, 8, 4, force)?;
        let table = ubo_directions();
        let images: Vec<f32> = (0..LIGHT_COUNT)
            .flat_map(|light| [if light == 0 { 1.5 } else { 0.25 }; 8 * 4 * 3])
            .collect();
        for view in [0, table.len() - 1] {
            writer.write_view(view, &images)?;
        }
        let counts = writer.written();
        writer.finish("{\n  \"brdf\": \"0\"\n}")?;
        Ok(counts)
    }

    #[test]
    fn names_and_values_are_those_of_the_layout() {
        let root = tempfile::tempdir().unwrap();
        let place = root.path().join("wool");
        let counts = written(&place, false).unwrap();
        assert_eq!((counts.images, counts.clipped), (162, 2 * 8 * 4 * 3));
        assert!((counts.clipped_share() - 1.0 / 81.0).abs() < 1e-12);
        let path = place.join("tv075_pv345").join("00019 tl045 pl000 tv075 pv345.jpg");
        let image = brdf_image::decode_stored(&fs::read(path).unwrap()).unwrap();
        assert_eq!((image.width, image.height), (8, 4));
        // .25 encodes to 137.
        assert!(image.samples.into_bytes().iter().all(|v| v.abs_diff(137) < 2));
    }

    #[test]
    fn a_folder_with_other_files_in_a_view_is_left_alone() {
        let root = tempfile::tempdir().unwrap();
        let place = root.path().join("wool");
        written(&place, false).unwrap();
        written(&place, false).unwrap();
        let mine = place.join("tv000_pv000").join("mine.jpg");
        fs::write(&mine, "mine").unwrap();
        let refused = written(&place, false).unwrap_err();
        assert!(matches!(refused, FileError::InTheWay { .. }), "{refused}");
        assert_eq!(fs::read_to_string(&mine).unwrap(), "mine");
        let left = fs::read_dir(root.path()).unwrap().count();
        assert_eq!(left, 1, "nothing temporary is left behind");
    }
}
