//! Spheres and strips for reports and for `render`.

use brdf_io::{IoError, png_bytes, read_environment};
use brdf_model::Brdf;
use brdf_render::{
    DirectionalLight, DisplayImage, Film, Light, Panel, SphereView, ToneMap, difference,
    render_sphere, strip,
};

use crate::args::LightArgs;
use crate::numbers::significant;

/// How much differences are brightened.
pub(crate) const GAIN: u8 = 4;

/// The light that the arguments ask for.
pub(crate) fn light(args: &LightArgs) -> Result<Light, IoError> {
    if let Some(path) = &args.env {
        return Ok(Light::Environment(read_environment(path)?));
    }
    Ok(Light::Directional(args.light_deg.map_or_else(DirectionalLight::default, |[theta, phi]| {
        DirectionalLight { theta: theta.to_radians(), phi: phi.to_radians() }
    })))
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
    let differs = difference(&films[0], &films[1], &tone, GAIN);
    let panel = |picture, caption: String| Panel { picture, caption };
    Comparison {
        picture: strip(&[
            panel(left, reference.0.to_owned()),
            panel(right, model.0.to_owned()),
            panel(differs, format!("difference ×{GAIN}, exposure {}", significant(tone.exposure))),
        ]),
        exposure: tone.exposure,
        clipped_share: tone.clipped_share(&films[0]),
    }
}

/// Renders materials side by side at the exposure of the first; every further one is followed by
/// its difference from the first.
pub(crate) fn line_up(
    materials: &[(String, &dyn Brdf)],
    light: &Light,
    view: &SphereView,
    exposure: Option<f64>,
) -> DisplayImage {
    let films: Vec<Film> =
        materials.iter().map(|(_, brdf)| render_sphere(*brdf, light, view)).collect();
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
            let picture = difference(&films[0], &films[index], &tone, GAIN);
            panels.push(Panel { picture, caption: format!("difference ×{GAIN}") });
        }
    }
    strip(&panels)
}

/// The bytes of a picture, ready to be written.
pub(crate) fn png(picture: &DisplayImage) -> anyhow::Result<Vec<u8>> {
    Ok(png_bytes(picture)?)
}
