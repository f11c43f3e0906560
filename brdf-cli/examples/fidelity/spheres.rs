//! The worst materials as spheres: the reference beside models of about 8 kB.

use std::path::Path;

use brdf_container::MaterialFile;
use brdf_fit::metric_lights;
use brdf_image::{DisplayImage, Panel, ToneMap, encode_png, strip};
use brdf_render::{Light, SphereView, render_sphere};

use crate::table::Row;

/// Materials that are shown.
const SHOWN: usize = 5;
const VIEW: SphereView = SphereView { size: 200, samples: 480 };
/// Lights, one beneath the other.
const LIGHTS: [&str; 2] = ["point", "studio"];

/// Writes one PNG for each of the materials whose model by the first shown method has the largest J: a strip under a
/// point light above one under the studio.
pub(crate) fn write_spheres(
    folder: &Path,
    files: &[MaterialFile],
    all: &[Vec<Row>],
) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)?;
    let score =
        |rows: &[Row]| rows.iter().find(|row| row.is_shown).map_or(0.0, |row| row.fidelity.score());
    let mut order: Vec<usize> = (0..files.len()).collect();
    order.sort_by(|&a, &b| score(&all[b]).total_cmp(&score(&all[a])));
    let lights = metric_lights(None)?;
    println!("\nspheres of the worst by J of the first column after the reference:\n");
    for &index in order.iter().take(SHOWN) {
        let name = files[index].short_name();
        let strips: Vec<DisplayImage> = LIGHTS
            .iter()
            .filter_map(|wanted| lights.iter().find(|(name, _)| name == wanted))
            .map(|(_, light)| strip(&panels(&files[index], &all[index], light)))
            .collect();
        let picture = stacked(&strips);
        let path = folder.join(format!("{}.png", name.split('.').next().unwrap_or(&name)));
        std::fs::write(&path, encode_png(&picture)?)?;
        println!("J {:.4}  {name}", score(&all[index]));
    }
    Ok(())
}

/// The reference and the models under one light, by the exposure of the reference.
fn panels(file: &MaterialFile, rows: &[Row], light: &Light) -> Vec<Panel> {
    let film = render_sphere(file.brdf(), light, &VIEW);
    let tone = ToneMap::exposed_for(&film);
    let reference = Panel { picture: tone.apply(&film), caption: "reference".to_owned() };
    let shown = rows.iter().filter(|row| row.is_shown).map(|row| {
        let film = render_sphere(row.model.brdf(), light, &VIEW);
        let caption = format!("{}, {} B", row.name, row.model.bytes());
        Panel { picture: tone.apply(&film), caption }
    });
    std::iter::once(reference).chain(shown).collect()
}

fn stacked(strips: &[DisplayImage]) -> DisplayImage {
    let width = strips.iter().map(DisplayImage::width).max().unwrap_or(1);
    let height = strips.iter().map(DisplayImage::height).sum();
    let mut sheet = DisplayImage::filled(width, height, [24, 24, 27]);
    let mut top = 0;
    for strip in strips {
        sheet.paste(strip, 0, top);
        top += strip.height();
    }
    sheet
}
