//! Spheres side by side.

use brdf_image::{
    DIFFERENCE_GAIN, DisplayImage, Film, Panel, ToneMap, difference, encode_png, strip,
};
use brdf_model::Brdf;
use brdf_render::{DirectionalLight, Light, SphereView, render_sphere};
use maud::{Markup, html};

use crate::error::ReportError;
use crate::numbers::{percent, significant};
use crate::page::picture;

/// Side of the spheres in reports, pixels.
pub(crate) const SPHERE_SIZE: usize = 256;
pub(crate) const SMALL_SPHERE: usize = 128;

/// A reference and its approximation: side by side with their difference, at the reference's
/// exposure.
pub(crate) struct SpherePair {
    pub(crate) png: Vec<u8>,
    pub(crate) exposure: f64,
    clipped_share: f64,
}

impl SpherePair {
    /// Renders reference | approximation | difference with the same camera and light.
    pub(crate) fn new(
        name: &str,
        reference: &dyn Brdf,
        model: &dyn Brdf,
    ) -> Result<Self, ReportError> {
        let light = Light::Directional(DirectionalLight::default());
        let view = SphereView { size: SPHERE_SIZE, ..SphereView::default() };
        let films = [reference, model].map(|brdf| render_sphere(brdf, &light, &view));
        let tone = ToneMap::exposed_for(&films[0]);
        let [left, right] = [&films[0], &films[1]].map(|film| tone.apply(film));
        let differs = difference(&films[0], &films[1], &tone, DIFFERENCE_GAIN);
        let panel = |picture, caption: String| Panel { picture, caption };
        let exposure = significant(tone.exposure);
        let sheet = strip(&[
            panel(left, name.to_owned()),
            panel(right, "approximation".to_owned()),
            panel(differs, format!("difference ×{DIFFERENCE_GAIN}, exposure {exposure}")),
        ]);
        Ok(Self {
            png: encode_png(&sheet)?,
            exposure: tone.exposure,
            clipped_share: tone.clipped_share(&films[0]),
        })
    }

    pub(crate) fn section(&self) -> Markup {
        html! {
            h2 { "Spheres" }
            (picture(&self.png, "reference, approximation, difference"))
            p {
                "Reference, approximation, and their difference brightened four times, under one "
                "directional light 30° from the camera, with irradiance π. Exposure "
                (significant(self.exposure)) ", sRGB; "
                (percent(self.clipped_share))
                " of the reference's pixels are clipped. Chequered violet: no data."
            }
        }
    }
}

/// Returns materials rendered side by side at the exposure of the first; every further one is followed by
/// its difference from the first.
pub fn line_up(
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

/// Returns the PNG of a material on a sphere, at its own exposure.
pub(crate) fn sphere_png(brdf: &dyn Brdf, size: usize) -> Result<Vec<u8>, ReportError> {
    let light = Light::Directional(DirectionalLight::default());
    let view = SphereView { size, ..SphereView::default() };
    let film = render_sphere(brdf, &light, &view);
    Ok(encode_png(&ToneMap::exposed_for(&film).apply(&film))?)
}

/// Returns the PNG of small spheres side by side, without differences.
pub(crate) fn small_spheres(
    materials: &[(String, &dyn Brdf)],
    exposure: f64,
) -> Result<Vec<u8>, ReportError> {
    let light = Light::Directional(DirectionalLight::default());
    let view = SphereView { size: SMALL_SPHERE, ..SphereView::default() };
    let panels: Vec<Panel> = materials
        .iter()
        .map(|(caption, brdf)| Panel {
            picture: ToneMap { exposure }.apply(&render_sphere(*brdf, &light, &view)),
            caption: caption.clone(),
        })
        .collect();
    Ok(encode_png(&strip(&panels))?)
}
