//! What is fitted and compared.

use brdf_model::{Brdf, Channels, PairSampling, SampleSet, ScatteredBrdf};

/// A material: a function of two directions, or scattered samples, with a name.
pub struct Material<'a> {
    name: String,
    function: Function<'a>,
    channels: Channels,
}

enum Function<'a> {
    Borrowed(&'a dyn Brdf),
    Scattered(&'a ScatteredBrdf),
    Owned(Box<ScatteredBrdf>),
}

impl std::fmt::Debug for Material<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Material")
            .field("name", &self.name)
            .field("channels", &self.channels)
            .finish_non_exhaustive()
    }
}

impl<'a> Material<'a> {
    /// Returns a function as a material of three channels.
    pub fn new(name: impl Into<String>, brdf: &'a dyn Brdf) -> Self {
        Self { name: name.into(), function: Function::Borrowed(brdf), channels: Channels::Rgb }
    }

    /// Returns samples as a material. They enter fits as they are; between them they are interpolated, for pictures
    /// and matrices alone.
    pub fn from_samples(name: impl Into<String>, samples: &SampleSet) -> Self {
        Self {
            name: name.into(),
            channels: samples.channels(),
            function: Function::Owned(Box::new(ScatteredBrdf::new(samples.clone()))),
        }
    }

    /// The same of samples that are ready for interpolation.
    pub fn from_scattered(name: impl Into<String>, samples: &'a ScatteredBrdf) -> Self {
        Self {
            name: name.into(),
            channels: samples.samples().channels(),
            function: Function::Scattered(samples),
        }
    }

    /// The same material with channels of its own: a model of luminance has one.
    #[must_use]
    pub fn with_channels(self, channels: Channels) -> Self {
        Self { channels, ..self }
    }

    /// Returns the name, for captions and records.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the channels that the material has of its own.
    pub fn channels(&self) -> Channels {
        self.channels
    }

    /// Returns the material as a function; scattered samples are interpolated.
    pub fn brdf(&self) -> &dyn Brdf {
        match &self.function {
            Function::Borrowed(brdf) => *brdf,
            Function::Scattered(scattered) => *scattered,
            Function::Owned(scattered) => scattered.as_ref(),
        }
    }

    /// Returns the rows of scattered samples.
    pub fn samples(&self) -> Option<&SampleSet> {
        match &self.function {
            Function::Borrowed(_) => None,
            Function::Scattered(scattered) => Some(scattered.samples()),
            Function::Owned(scattered) => Some(scattered.samples()),
        }
    }

    /// Returns pairs with their values: the rows of scattered samples within the grazing limit of `sampling`, and
    /// pairs drawn by it of everything else.
    pub fn draw(&self, sampling: &PairSampling, channels: Channels) -> SampleSet {
        match self.samples() {
            Some(rows) if channels == Channels::Luminance => {
                rows.to_luminance().within(sampling.theta_max)
            }
            Some(rows) => rows.within(sampling.theta_max),
            None => SampleSet::draw(self.brdf(), sampling, channels),
        }
    }
}
