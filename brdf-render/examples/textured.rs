//! A bumpy chequer of a metal and a paint on every shape, as PNG files:
//! `cargo run --release -p brdf-render --example textured -- FOLDER`

use std::error::Error;
use std::f64::consts::TAU;
use std::path::PathBuf;

use brdf_image::{ToneMap, encode_png};
use brdf_model::{Brdf, Preset, Rgb};
use brdf_param::DirectionPair;
use brdf_render::{
    DirectionalLight, Environment, Light, Shape, SpatiallyVarying, TexturePoint, TexturedView,
    render_textured,
};
use glam::DVec3;

/// A metal and a paint in two by two squares, both with a round bump in each square. A red square in
/// the corner where u and v begin shows which way they run.
struct BumpyChequer {
    metal: Box<dyn Brdf>,
    paint: Box<dyn Brdf>,
}

/// Steepest slope of the bumps.
const STEEPNESS: f64 = 0.3;
/// Side of the red corner, tiles.
const CORNER: f64 = 0.12;

impl BumpyChequer {
    /// Share of the metal within the footprint about a place: a box filter along each axis.
    fn metal_share(at: &TexturePoint) -> f64 {
        let wave = |x: f64| {
            let half = 0.5 * at.footprint.max(1e-6);
            // The integral of a wave that is 1 in the first half of a tile and −1 in the second.
            let integral = |x: f64| 0.5 - ((x - x.floor()) - 0.5).abs();
            (integral(x + half) - integral(x - half)) / (2.0 * half)
        };
        0.5 + 0.5 * wave(at.u) * wave(at.v)
    }

    /// The bump's normal; flatter where the footprint hides it.
    fn normal(at: &TexturePoint) -> DVec3 {
        let steepness = STEEPNESS * (1.0 - at.footprint).max(0.0);
        // Downhill is left of the middle of a square, and right of it.
        let slope = |x: f64| -steepness * (2.0 * TAU * x).sin();
        DVec3::new(slope(at.u), slope(at.v), 1.0).normalize()
    }
}

impl SpatiallyVarying for BumpyChequer {
    fn reflect(&self, at: &TexturePoint, wo: DVec3, lights: &[DVec3], out: &mut [Rgb]) {
        let normal = Self::normal(at);
        let tangent = (DVec3::X - normal.x * normal).normalize();
        let bitangent = normal.cross(tangent);
        let turn = |w: DVec3| DVec3::new(w.dot(tangent), w.dot(bitangent), w.dot(normal));
        let share = Self::metal_share(at);
        let corner = at.u < CORNER && at.v < CORNER;
        for (value, &wi) in out.iter_mut().zip(lights) {
            let pair = DirectionPair::new(turn(wi), turn(wo));
            let mixed = self.metal.eval(&pair) * share + self.paint.eval(&pair) * (1.0 - share);
            let f = if corner { Rgb::new(0.25, 0.02, 0.02) } else { mixed };
            *value = f * pair.wi.z.max(0.0);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("."), PathBuf::from);
    let preset = |name: &str| Preset::find(name).map(|p| p.brdf()).ok_or("no such preset");
    let material = BumpyChequer {
        metal: Box::new(preset("cook-torrance")?),
        paint: Box::new(preset("lafortune-blue-paint")?),
    };
    let lights = [
        ("lamp", Light::Directional(DirectionalLight::default())),
        ("studio", Light::Environment(Environment::studio()?)),
    ];
    for (shape, name) in
        [(Shape::Plane, "plane"), (Shape::Sphere, "sphere"), (Shape::Cylinder, "cylinder")]
    {
        for (light_name, light) in &lights {
            let view = TexturedView { tiles: 6.0, ..TexturedView::default() };
            let film = render_textured(&material, shape, light, &view);
            let picture = ToneMap::exposed_for(&film).apply(&film);
            std::fs::write(folder.join(format!("{name}-{light_name}.png")), encode_png(&picture)?)?;
        }
    }
    Ok(())
}
