//! What a MODEL or REFERENCE argument names: a preset, or a file.

use std::path::Path;

use anyhow::{Context as _, bail};
use brdf_io::{
    IoError, MappedFile, Measured, Measurement, ReadOptions, nbrdf_names, open_measurement,
};
use brdf_model::{Analytic, Brdf, Channels, Nbrdf, Preset, SampleSet};

/// A material to work on.
pub(crate) struct Subject {
    /// As given on the command line.
    pub(crate) argument: String,
    source: Source,
}

enum Source {
    Preset(Analytic),
    File(Box<Measurement>),
}

/// FILE.npz:NAME as file and material; anything else as it is.
fn archive_member(argument: &str) -> (&Path, Option<String>) {
    match argument.rsplit_once(".npz:") {
        Some((stem, material)) => {
            (Path::new(&argument[..stem.len() + 4]), Some(material.to_owned()))
        }
        None => (Path::new(argument), None),
    }
}

const PRESET: &str = "preset:";

impl Subject {
    pub(crate) fn open(argument: &str, options: &ReadOptions) -> anyhow::Result<Self> {
        let source = if let Some(name) = argument.strip_prefix(PRESET) {
            let Some(preset) = Preset::find(name) else {
                let names = Preset::ALL.map(|p| p.name()).join(", ");
                bail!("{argument}: no such preset; expected one of {names}");
            };
            Source::Preset(preset.brdf())
        } else {
            let (path, material) = archive_member(argument);
            let options = &ReadOptions { material, ..options.clone() };
            let measurement = open_measurement(path, options);
            // A preset's bare name is the likeliest slip.
            let hint = (!path.exists() && Preset::find(argument).is_some())
                .then(|| format!("did you mean {PRESET}{argument}?"));
            Source::File(Box::new(match hint {
                Some(hint) => measurement.context(hint)?,
                None => measurement?,
            }))
        };
        Ok(Self { argument: argument.to_owned(), source })
    }

    /// Every material of an archive, or the one material that an argument names.
    pub(crate) fn open_all(argument: &str, options: &ReadOptions) -> anyhow::Result<Vec<Self>> {
        let path = Path::new(argument);
        let is_archive = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("npz"));
        if !(is_archive && path.is_file()) {
            return Ok(vec![Self::open(argument, options)?]);
        }
        let names = nbrdf_names(&MappedFile::open(path)?).map_err(IoError::format(path))?;
        names.iter().map(|name| Self::open(&format!("{argument}:{name}"), options)).collect()
    }

    /// A name without folders, for captions and records.
    pub(crate) fn short_name(&self) -> String {
        if let (_, Some(material)) = archive_member(&self.argument) {
            return material;
        }
        let path = Path::new(&self.argument);
        // Every folder of ours holds a model of that name; the folder's says which.
        let folder = path.parent().and_then(Path::file_name);
        let name = if path.ends_with("model.safetensors") { folder } else { None };
        name.or(path.file_name())
            .map_or_else(|| self.argument.clone(), |name| name.to_string_lossy().into_owned())
    }

    /// The material as a function. Scattered samples are interpolated: for pictures only.
    pub(crate) fn brdf(&self) -> &dyn Brdf {
        match &self.source {
            Source::Preset(model) => model,
            Source::File(measurement) => measurement.measured.brdf(),
        }
    }

    /// The rows of a scattered measurement.
    pub(crate) fn samples(&self) -> Option<&SampleSet> {
        match &self.source {
            Source::File(measurement) => match &measurement.measured {
                Measured::Samples(scattered) => Some(scattered.samples()),
                _ => None,
            },
            Source::Preset(_) => None,
        }
    }

    /// The measurement, if it came from a file.
    pub(crate) fn measurement(&self) -> Option<&Measurement> {
        match &self.source {
            Source::File(measurement) => Some(measurement),
            Source::Preset(_) => None,
        }
    }

    /// What the reader assumed or changed.
    pub(crate) fn notes(&self) -> &[String] {
        self.measurement().map_or(&[], |measurement| &measurement.notes)
    }

    /// Channels that the material has of its own.
    pub(crate) fn channels(&self) -> Channels {
        match &self.source {
            Source::Preset(_) => Channels::Rgb,
            Source::File(measurement) => match &measurement.measured {
                Measured::Samples(scattered) => scattered.samples().channels(),
                Measured::Model(file) => file.model.channels(),
                Measured::Separable(file) => file.model.channels(),
                Measured::Merl(_) | Measured::Rgl(_) | Measured::Utia(_) | Measured::Nbrdf(_) => {
                    Channels::Rgb
                }
            },
        }
    }

    /// Bytes that the material takes: the textures of a model, the whole file of a measurement,
    /// nothing for a formula.
    pub(crate) fn bytes(&self) -> usize {
        match &self.source {
            Source::Preset(_) => 0,
            Source::File(measurement) => match &measurement.measured {
                Measured::Model(file) => file.model.payload_bytes(),
                Measured::Separable(file) => file.model.payload_bytes(),
                Measured::Nbrdf(_) => 4 * Nbrdf::WEIGHTS,
                _ => measurement.bytes,
            },
        }
    }

    /// What kind of thing it is.
    pub(crate) fn kind(&self) -> &'static str {
        self.measurement().map_or("preset", |measurement| measurement.format.name())
    }
}
