//! Spheres and strips for reports and for `render`.

use std::path::PathBuf;

use brdf_factor::{ChannelTransform, Factor, FactoredBrdf};
use brdf_image::{DIFFERENCE_GAIN, DisplayImage, Film, Panel, ToneMap, difference, strip};
use brdf_io::{IoError, OutputFolder, SeparableFile, png_bytes, read_environment, write_exr};
use brdf_model::{Brdf, Channels, Rgb};
use brdf_param::{DirectionPair, Parametrization};
use brdf_plot::{Plot, plot_slices};
use brdf_render::{
    DirectionalLight, Environment, Light, Side, SphereView, render_sphere, term_view, texture_view,
};
use brdf_separable::SeparableBrdf;

use crate::args::LightArgs;
use crate::fitting::Outcome;
use crate::numbers::significant;
use crate::report::separable::spectrum_plot;
use crate::subject::Subject;

/// Side of the spheres in reports.
const SPHERE_SIZE: usize = 256;
const SMALL_SPHERE: usize = 128;

/// The light that the arguments ask for.
pub(crate) fn light(args: &LightArgs) -> Result<Light, IoError> {
    if let Some(path) = &args.env {
        return Ok(Light::Environment(read_environment(path)?));
    }
    Ok(Light::Directional(args.light_deg.map_or_else(DirectionalLight::default, |[theta, phi]| {
        DirectionalLight { theta: theta.to_radians(), phi: phi.to_radians() }
    })))
}

/// The lights that measures on spheres are taken under: environments, the built-in ones unless
/// others are given, and one directional light.
pub(crate) fn metric_lights(files: &[PathBuf]) -> anyhow::Result<Vec<(String, Light)>> {
    let mut lights = if files.is_empty() {
        vec![
            ("sky".to_owned(), Light::Environment(Environment::sky()?)),
            ("studio".to_owned(), Light::Environment(Environment::studio()?)),
        ]
    } else {
        files
            .iter()
            .map(|path| {
                let name = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy();
                Ok((name.into_owned(), Light::Environment(read_environment(path)?)))
            })
            .collect::<Result<Vec<_>, IoError>>()?
    };
    lights.push(("point".to_owned(), Light::Directional(DirectionalLight::default())));
    Ok(lights)
}

/// A reference and its approximation: side by side with their difference, at the reference's
/// exposure.
pub(crate) struct Comparison {
    pub(crate) picture: DisplayImage,
    pub(crate) exposure: f64,
    pub(crate) clipped_share: f64,
}

/// Renders reference | approximation | difference with the same camera and light.
pub(crate) fn comparison(
    reference: (&str, &dyn Brdf),
    model: (&str, &dyn Brdf),
    light: &Light,
    view: &SphereView,
) -> Comparison {
    let films = [reference.1, model.1].map(|brdf| render_sphere(brdf, light, view));
    let tone = ToneMap::exposed_for(&films[0]);
    let [left, right] = [&films[0], &films[1]].map(|film| tone.apply(film));
    let differs = difference(&films[0], &films[1], &tone, DIFFERENCE_GAIN);
    let panel = |picture, caption: String| Panel { picture, caption };
    Comparison {
        picture: strip(&[
            panel(left, reference.0.to_owned()),
            panel(right, model.0.to_owned()),
            panel(
                differs,
                format!("difference ×{DIFFERENCE_GAIN}, exposure {}", significant(tone.exposure)),
            ),
        ]),
        exposure: tone.exposure,
        clipped_share: tone.clipped_share(&films[0]),
    }
}

/// Renders materials side by side at the exposure of the first; every further one is followed by
/// its difference from the first.
pub(crate) fn line_up(
    materials: &[(String, &dyn Brdf)],
    render: &dyn Fn(&dyn Brdf) -> Film,
    exposure: Option<f64>,
) -> DisplayImage {
    let films: Vec<Film> = materials.iter().map(|(_, brdf)| render(*brdf)).collect();
    let tone = match (exposure, films.first()) {
        (Some(exposure), _) => ToneMap { exposure },
        (None, Some(film)) => ToneMap::exposed_for(film),
        (None, None) => ToneMap { exposure: 1.0 },
    };
    let pictures: Vec<DisplayImage> = films.iter().map(|film| tone.apply(film)).collect();
    let mut panels = Vec::new();
    for (index, ((name, _), picture)) in materials.iter().zip(&pictures).enumerate() {
        let caption = if index == 0 {
            format!("{name}, exposure {}", significant(tone.exposure))
        } else {
            name.clone()
        };
        panels.push(Panel { picture: picture.clone(), caption });
        if index > 0 {
            let picture = difference(&films[0], &films[index], &tone, DIFFERENCE_GAIN);
            panels.push(Panel { picture, caption: format!("difference ×{DIFFERENCE_GAIN}") });
        }
    }
    strip(&panels)
}

/// The bytes of a picture, ready to be written.
pub(crate) fn png(picture: &DisplayImage) -> anyhow::Result<Vec<u8>> {
    Ok(png_bytes(picture)?)
}

/// The pictures of a report, as PNG bytes.
pub(crate) struct Pictures {
    pub(crate) spheres: Vec<u8>,
    pub(crate) comparison: Comparison,
    /// One for each factor: PNG and EXR.
    pub(crate) factors: Vec<(Vec<u8>, Vec<u8>)>,
    /// One for each factor: its values alone, on a sphere.
    pub(crate) factor_spheres: Vec<Vec<u8>>,
    /// Spheres of the models of all numbers of textures.
    pub(crate) by_terms: Vec<u8>,
    pub(crate) slices: Option<Plot>,
}

impl Pictures {
    pub(crate) fn new(
        subject: &Subject,
        outcome: &Outcome,
        channels: Channels,
    ) -> anyhow::Result<Self> {
        let model = &outcome.last().model;
        let light = Light::Directional(DirectionalLight::default());
        let view = SphereView { size: SPHERE_SIZE, ..SphereView::default() };
        let name = subject.short_name();
        let reference = Grey::unless(channels == Channels::Rgb, subject.brdf());
        let comparison =
            comparison((&name, reference.as_brdf()), ("approximation", model), &light, &view);
        let factors = factor_files(model)?;
        let sizes = outcome.fits.iter().map(|fit| fit.model.factors().len().to_string());
        let materials: Vec<(String, &dyn Brdf)> =
            sizes.zip(&outcome.fits).map(|(size, fit)| (size, &fit.model as &dyn Brdf)).collect();
        let small = SphereView { size: SMALL_SPHERE, ..SphereView::default() };
        let by_terms = line_up_plainly(&materials, &light, &small, comparison.exposure);
        let factor_spheres: anyhow::Result<Vec<Vec<u8>>> =
            model.factors().iter().map(|factor| factor_sphere(factor, channels)).collect();
        Ok(Self {
            spheres: png(&comparison.picture)?,
            comparison,
            factors,
            factor_spheres: factor_spheres?,
            by_terms: png(&by_terms)?,
            slices: slices(subject, model)?,
        })
    }

    pub(crate) fn write(&self, folder: &mut OutputFolder) -> anyhow::Result<()> {
        folder.write("spheres.png", &self.spheres)?;
        for (index, (png, exr)) in self.factors.iter().enumerate() {
            folder.write(&format!("factor-{index}.png"), png)?;
            folder.write(&format!("factor-{index}.exr"), exr)?;
        }
        Ok(())
    }
}

/// The pictures of a report on a sum of products.
pub(crate) struct SeparablePictures {
    pub(crate) spheres: Vec<u8>,
    pub(crate) comparison: Comparison,
    /// PNGs of each term: first side, and second where it has textures of its own.
    pub(crate) views: Vec<(Vec<u8>, Option<Vec<u8>>)>,
    /// EXRs of the same.
    exact: Vec<(Vec<u8>, Option<Vec<u8>>)>,
    pub(crate) spectrum: Plot,
    pub(crate) slices: Option<Plot>,
}

impl SeparablePictures {
    pub(crate) fn new(
        subject: &Subject,
        file: &SeparableFile,
        channels: Channels,
    ) -> anyhow::Result<Self> {
        let model = &file.model;
        let light = Light::Directional(DirectionalLight::default());
        let view = SphereView { size: SPHERE_SIZE, ..SphereView::default() };
        let name = subject.short_name();
        let reference = Grey::unless(channels == Channels::Rgb, subject.brdf());
        let comparison =
            comparison((&name, reference.as_brdf()), ("approximation", model), &light, &view);
        let both = |one: &dyn Fn(Side, usize) -> anyhow::Result<Vec<u8>>| {
            (0..model.rank())
                .map(|term| {
                    let second = model.second().map(|_| one(Side::Second, term)).transpose()?;
                    Ok((one(Side::First, term)?, second))
                })
                .collect::<anyhow::Result<Vec<_>>>()
        };
        Ok(Self {
            spheres: png(&comparison.picture)?,
            comparison,
            views: both(&|side, term| png(&term_view(model, side, term)))?,
            exact: both(&|side, term| term_exr(model, side, term))?,
            spectrum: spectrum_plot(&name, &file.fit.spectra)?,
            slices: slices(subject, model)?,
        })
    }

    pub(crate) fn write(&self, folder: &mut OutputFolder) -> anyhow::Result<()> {
        folder.write("spheres.png", &self.spheres)?;
        folder.write("spectrum.svg", self.spectrum.svg().as_bytes())?;
        for (kind, files) in [("png", &self.views), ("exr", &self.exact)] {
            for (index, (first, second)) in files.iter().enumerate() {
                folder.write(&format!("first-{index}.{kind}"), first)?;
                if let Some(second) = second {
                    folder.write(&format!("second-{index}.{kind}"), second)?;
                }
            }
        }
        Ok(())
    }
}

/// A term's texture on one side, exact.
fn term_exr(model: &SeparableBrdf, side: Side, term: usize) -> anyhow::Result<Vec<u8>> {
    let (chart, channels) = match side {
        Side::First => (model.layout().first, model.first_channels()),
        Side::Second => (model.layout().second, model.maps().len()),
    };
    let names = if channels == 3 { &["R", "G", "B"][..] } else { &["Y"] };
    let planes: Vec<(&str, Vec<f32>)> = names
        .iter()
        .enumerate()
        .map(|(channel, name)| {
            #[expect(clippy::cast_possible_truncation, reason = "textures are stored in f32")]
            let value = |texel| match side {
                Side::First => model.first_at(texel, term, channel) as f32,
                Side::Second => model.second_at(texel, term, channel) as f32,
            };
            (*name, (0..chart.texels()).map(value).collect())
        })
        .collect();
    let [columns, rows] = chart.size();
    Ok(write_exr(columns, rows, &planes)?)
}

/// Azimuths of the slices in reports, degrees.
const SLICE_AZIMUTHS: [f64; 3] = [0.0, 90.0, 180.0];

/// Slices of a reference above those of its approximation; none of scattered rows, which have
/// nothing between them to show.
fn slices(subject: &Subject, model: &dyn Brdf) -> anyhow::Result<Option<Plot>> {
    if subject.samples().is_some() {
        return Ok(None);
    }
    let both = [(subject.short_name(), subject.brdf()), ("approximation".to_owned(), model)];
    Ok(Some(plot_slices(&both, Parametrization::HalfDifference, &SLICE_AZIMUTHS)?))
}

/// Each texture of a model as PNG, to look at, and as EXR: exact log values.
pub(crate) fn factor_files(model: &FactoredBrdf) -> anyhow::Result<Vec<(Vec<u8>, Vec<u8>)>> {
    let channels = model.channels();
    let names = if channels == Channels::Rgb { &["R", "G", "B"][..] } else { &["Y"] };
    let file = |factor: &Factor| {
        let planes: Vec<(&str, Vec<f32>)> = names
            .iter()
            .enumerate()
            .map(|(c, name)| (*name, factor.texels().iter().map(|t| t[c]).collect()))
            .collect();
        let exr = write_exr(factor.grid().size, factor.grid().rows(), &planes)?;
        Ok((png(&texture_view(factor, channels))?, exr))
    };
    model.factors().iter().map(file).collect()
}

/// A model on a sphere, at its own exposure.
pub(crate) fn model_sphere(model: &dyn Brdf) -> anyhow::Result<Vec<u8>> {
    let light = Light::Directional(DirectionalLight::default());
    let view = SphereView { size: SPHERE_SIZE, ..SphereView::default() };
    let film = render_sphere(model, &light, &view);
    png(&ToneMap::exposed_for(&film).apply(&film))
}

/// The values of one factor on a small sphere: where on it the factor brightens and darkens.
fn factor_sphere(factor: &Factor, channels: Channels) -> anyhow::Result<Vec<u8>> {
    let maps = vec![ChannelTransform::Log; channels.count()];
    let alone = FactoredBrdf::new(vec![factor.clone()], maps, std::f64::consts::FRAC_PI_2)?;
    let light = Light::Directional(DirectionalLight::default());
    let view = SphereView { size: SMALL_SPHERE, ..SphereView::default() };
    let film = render_sphere(&alone, &light, &view);
    png(&ToneMap::exposed_for(&film).apply(&film))
}

/// Spheres side by side, without differences.
fn line_up_plainly(
    materials: &[(String, &dyn Brdf)],
    light: &Light,
    view: &SphereView,
    exposure: f64,
) -> DisplayImage {
    let panels: Vec<Panel> = materials
        .iter()
        .map(|(caption, brdf)| Panel {
            picture: ToneMap { exposure }.apply(&render_sphere(*brdf, light, view)),
            caption: caption.clone(),
        })
        .collect();
    strip(&panels)
}

/// A material, or its luminance as grey to stand beside a model of one channel.
pub(crate) enum Grey<'a> {
    Colour(&'a dyn Brdf),
    Luminance(&'a dyn Brdf),
}

impl<'a> Grey<'a> {
    pub(crate) fn unless(in_colour: bool, brdf: &'a dyn Brdf) -> Self {
        if in_colour { Self::Colour(brdf) } else { Self::Luminance(brdf) }
    }

    pub(crate) fn as_brdf(&self) -> &dyn Brdf {
        match self {
            Self::Colour(brdf) => *brdf,
            Self::Luminance(_) => self,
        }
    }
}

impl Brdf for Grey<'_> {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        match self {
            Self::Colour(brdf) => brdf.eval(pair),
            Self::Luminance(brdf) => Rgb::splat(brdf.eval(pair).luminance()),
        }
    }

    fn has_data(&self, pair: &DirectionPair) -> bool {
        match self {
            Self::Colour(brdf) | Self::Luminance(brdf) => brdf.has_data(pair),
        }
    }
}
