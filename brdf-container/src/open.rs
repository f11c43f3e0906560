//! Materials by what people call them: a preset, a file of any format, a material of an archive.

use std::path::Path;

use brdf_files::{FileError, MappedFile};
use brdf_fit::{CompactModel, FactoredModel, Material, SeparableModel};
use brdf_io::{FormatError, Measured, ReadNote, ReadOptions, nbrdf_names, read};
use brdf_model::{Analytic, Brdf, Channels, Nbrdf, Preset, SampleSet, ScatteredBrdf};

use crate::contained::{Contained, read_container};
use crate::head::looks_like_container;

/// How names of built-in materials begin.
pub const PRESET: &str = "preset:";

/// What can be wrong with the name of a material, or with its file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OpenError {
    /// No preset is called so.
    #[error("{name}: no such preset; expected one of {}", known.join(", "))]
    NoPreset {
        /// What was asked for.
        name: String,
        /// The presets.
        known: Vec<&'static str>,
    },
    /// There is no such file, but a preset of that name.
    #[error("did you mean {PRESET}{name}?: {problem}")]
    PresetMeant {
        /// What was asked for.
        name: String,
        /// What the file system said.
        problem: FileError,
    },
    /// A file that cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
}

/// What a material is made of.
#[derive(Debug)]
pub enum Content {
    /// A formula.
    Preset(Analytic),
    /// A measurement.
    Measured(Measured),
    /// A product of textures.
    Factored(Box<FactoredModel>),
    /// A sum of products.
    Separable(Box<SeparableModel>),
    /// A compact model.
    Compact(Box<CompactModel>),
}

/// A material that was opened by name.
#[derive(Debug)]
pub struct MaterialFile {
    /// As it was asked for.
    pub source: String,
    /// What it is made of.
    pub content: Content,
    /// What the reader assumed or changed.
    pub notes: Vec<ReadNote>,
    kind: &'static str,
    file_bytes: usize,
}

/// FILE.npz:NAME as file and material; anything else as it is.
fn archive_member(source: &str) -> (&Path, Option<String>) {
    match source.rsplit_once(".npz:") {
        Some((stem, material)) => (Path::new(&source[..stem.len() + 4]), Some(material.to_owned())),
        None => (Path::new(source), None),
    }
}

impl MaterialFile {
    /// Opens `preset:NAME`, a file of any format that the project reads, or `FILE.npz:NAME`, a material of an archive.
    ///
    /// # Errors
    ///
    /// [`OpenError`], in one line: the file, the place in it, what was found and what was expected.
    pub fn open(source: &str, options: &ReadOptions) -> Result<Self, OpenError> {
        if let Some(name) = source.strip_prefix(PRESET) {
            let preset = Preset::find(name).ok_or_else(|| OpenError::NoPreset {
                name: source.to_owned(),
                known: Preset::ALL.map(|p| p.name()).to_vec(),
            })?;
            return Ok(Self {
                source: source.to_owned(),
                content: Content::Preset(preset.brdf()),
                notes: Vec::new(),
                kind: "preset",
                file_bytes: 0,
            });
        }
        let (path, material) = archive_member(source);
        let bytes = MappedFile::open(path).map_err(|problem| {
            // A preset's bare name is the likeliest slip.
            match !path.exists() && Preset::find(source).is_some() {
                true => OpenError::PresetMeant { name: source.to_owned(), problem },
                false => problem.into(),
            }
        })?;
        let (content, notes, kind) = if looks_like_container(&bytes) {
            let contained = read_container(&bytes, options.merl_lookup);
            let content = content_of(contained.map_err(FileError::content(path))?)
                .map_err(FileError::content(path))?;
            (content, Vec::new(), "brdf container")
        } else {
            let options = ReadOptions { material, ..options.clone() };
            let measurement = read(&bytes, &options).map_err(FileError::content(path))?;
            let kind = measurement.format.name();
            (Content::Measured(measurement.measured), measurement.notes, kind)
        };
        Ok(Self { source: source.to_owned(), content, notes, kind, file_bytes: bytes.len() })
    }

    /// Opens every material of an archive, or the one material that a name means.
    ///
    /// # Errors
    ///
    /// As [`MaterialFile::open`].
    pub fn open_all(source: &str, options: &ReadOptions) -> Result<Vec<Self>, OpenError> {
        let path = Path::new(source);
        let is_archive = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("npz"));
        if !(is_archive && path.is_file()) {
            return Ok(vec![Self::open(source, options)?]);
        }
        let names = nbrdf_names(&MappedFile::open(path)?).map_err(FileError::content(path))?;
        names.iter().map(|name| Self::open(&format!("{source}:{name}"), options)).collect()
    }

    /// Returns a name without folders, for captions and records. Every folder of results holds a model of one name;
    /// the folder's says which.
    pub fn short_name(&self) -> String {
        if let (_, Some(material)) = archive_member(&self.source) {
            return material;
        }
        let path = Path::new(&self.source);
        let folder = path.parent().and_then(Path::file_name);
        let name = if path.ends_with("model.safetensors") { folder } else { None };
        name.or(path.file_name())
            .map_or_else(|| self.source.clone(), |name| name.to_string_lossy().into_owned())
    }

    /// Returns the material, called by its short name.
    pub fn material(&self) -> Material<'_> {
        self.named(self.short_name())
    }

    /// Returns the material under another name.
    pub fn named(&self, name: String) -> Material<'_> {
        match self.scattered() {
            Some(scattered) => Material::from_scattered(name, scattered),
            None => Material::new(name, self.brdf()).with_channels(self.channels()),
        }
    }

    /// Returns the material as a function. Scattered samples are interpolated: for pictures only.
    pub fn brdf(&self) -> &dyn Brdf {
        match &self.content {
            Content::Preset(model) => model,
            Content::Measured(measured) => measured.brdf(),
            Content::Factored(model) => &model.model,
            Content::Separable(model) => &model.model,
            Content::Compact(model) => model.model.brdf(),
        }
    }

    fn scattered(&self) -> Option<&ScatteredBrdf> {
        match &self.content {
            Content::Measured(Measured::Samples(scattered)) => Some(scattered),
            _ => None,
        }
    }

    /// Returns the rows of a scattered measurement.
    pub fn samples(&self) -> Option<&SampleSet> {
        self.scattered().map(ScatteredBrdf::samples)
    }

    /// Returns the channels that the material has of its own.
    pub fn channels(&self) -> Channels {
        match &self.content {
            Content::Preset(_) => Channels::Rgb,
            Content::Measured(measured) => measured.channels(),
            Content::Factored(model) => model.model.channels(),
            Content::Separable(model) => model.model.channels(),
            Content::Compact(model) => model.model.channels(),
        }
    }

    /// Returns the bytes that the material takes: the textures of a model, the whole file of a measurement, nothing
    /// for a formula.
    pub fn bytes(&self) -> usize {
        match &self.content {
            Content::Preset(_) => 0,
            Content::Measured(Measured::Nbrdf(_)) => 4 * Nbrdf::WEIGHTS,
            Content::Measured(_) => self.file_bytes,
            Content::Factored(model) => model.model.payload_bytes(),
            Content::Separable(model) => model.model.payload_bytes(),
            Content::Compact(model) => model.model.payload_bytes(),
        }
    }

    /// Returns what people call the kind of file.
    pub fn kind(&self) -> &'static str {
        self.kind
    }
}

fn content_of(contained: Contained) -> Result<Content, FormatError> {
    Ok(match contained {
        Contained::Factored(model) => Content::Factored(model),
        Contained::Separable(model) => Content::Separable(model),
        Contained::Compact(model) => Content::Compact(model),
        Contained::Table(table) => Content::Measured(Measured::Merl(table)),
        Contained::Samples(samples) if samples.is_empty() => {
            return Err(FormatError::Missing {
                what: format!("usable samples ({})", samples.dropped()),
                expected: "at least one row above the horizon with values of 0 or more".to_owned(),
            });
        }
        Contained::Samples(samples) => {
            Content::Measured(Measured::Samples(Box::new(ScatteredBrdf::new(samples))))
        }
    })
}
