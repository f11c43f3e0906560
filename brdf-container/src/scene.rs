//! What a scene to paint consists of: `scene.toml`, the buffers of its views, and the pictures that come back.

use brdf_image::{decode_picture, encode_exr, exr_planes, exr_size};
use brdf_mesh::{Camera, UvSource};
use brdf_paint::{LightSource, PaintView, PaintedImage, PixelSurface, TruthRecord, ViewBuffers};
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::error::ContainerError;
use crate::head::library;

/// What `scene.toml` says.
#[derive(Clone, Debug, PartialEq)]
pub struct PaintScene {
    /// The mesh, as it was given.
    pub mesh: String,
    /// Where its texture coordinates are from.
    pub uv: UvSource,
    /// Columns and rows of the pictures.
    pub size: [usize; 2],
    /// Cameras and lights.
    pub views: Vec<PaintView>,
    /// What the pictures show, where they were rendered.
    pub truth: Option<TruthRecord>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawScene {
    mesh: String,
    uv: UvSource,
    size: [usize; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    truth: Option<TruthRecord>,
    view: Vec<RawView>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawViews {
    view: Vec<RawView>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawView {
    name: String,
    eye: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    /// Across the picture.
    fov_deg: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    light_direction: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    light_position: Option<[f64; 3]>,
    #[serde(default = "plain_white")]
    white: [f64; 3],
    /// Photographs have them.
    #[serde(default = "has_shadows")]
    shadows: bool,
}

fn plain_white() -> [f64; 3] {
    [1.0; 3]
}

fn has_shadows() -> bool {
    true
}

/// Most views of a scene.
const MAX_VIEWS: usize = 1000;
/// Largest picture.
const MAX_SIDE: usize = 16_384;

impl RawView {
    fn of(view: &PaintView) -> Self {
        let (light_direction, light_position) = match view.light {
            LightSource::Direction(direction) => (Some(direction.to_array()), None),
            LightSource::Position(place) => (None, Some(place.to_array())),
        };
        let camera = &view.camera;
        Self {
            name: view.name.clone(),
            eye: camera.eye.to_array(),
            target: (camera.eye + camera.forward()).to_array(),
            up: camera.up().to_array(),
            fov_deg: camera.fov().to_degrees(),
            light_direction,
            light_position,
            white: view.white,
            shadows: view.has_shadows,
        }
    }

    fn view(self) -> Result<PaintView, ContainerError> {
        let refuse = |what: &str, expected: &str| ContainerError::Missing {
            what: format!("{what} of view {:?}", self.name),
            expected: expected.to_owned(),
        };
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_+.".contains(c);
        if self.name.is_empty() || self.name.starts_with('.') || !self.name.chars().all(is_plain) {
            return Err(refuse("usable name", "letters, digits, `-`, `_`, `+` and `.`"));
        }
        let [eye, target, up] = [self.eye, self.target, self.up].map(DVec3::from);
        let camera = Camera::looking_at(eye, target, up, self.fov_deg.to_radians());
        let camera = camera.ok_or_else(|| {
            refuse(
                "camera",
                "an eye apart from its target, up not along the view, 0 < fov_deg < 180",
            )
        })?;
        let light = match (self.light_direction, self.light_position) {
            (Some(direction), None) => {
                DVec3::from(direction).try_normalize().map(LightSource::Direction)
            }
            (None, Some(place)) => {
                let place = DVec3::from(place);
                place.is_finite().then_some(LightSource::Position(place))
            }
            _ => None,
        };
        let light = light.ok_or_else(|| {
            refuse("light", "either light_direction or light_position, three numbers")
        })?;
        if !self.white.iter().all(|v| *v > 0.0 && v.is_finite()) {
            return Err(refuse("white", "three numbers above 0: what a white diffuser is in it"));
        }
        Ok(PaintView {
            name: self.name,
            camera,
            light,
            white: self.white,
            has_shadows: self.shadows,
        })
    }
}

fn views(raw: Vec<RawView>) -> Result<Vec<PaintView>, ContainerError> {
    if raw.is_empty() || raw.len() > MAX_VIEWS {
        return Err(ContainerError::Missing {
            what: format!("usable list of views ({} of them)", raw.len()),
            expected: format!("1 to {MAX_VIEWS} entries [[view]]"),
        });
    }
    let views: Vec<PaintView> = raw.into_iter().map(RawView::view).collect::<Result<_, _>>()?;
    let mut names: Vec<&str> = views.iter().map(|view| view.name.as_str()).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(ContainerError::Missing {
            what: format!("name for each view: {} occurs twice", pair[0]),
            expected: "different names".to_owned(),
        }),
        None => Ok(views),
    }
}

/// Returns what the text of `scene.toml` says.
///
/// # Errors
///
/// [`ContainerError::Library`] for wrong syntax, [`ContainerError::Missing`] for cameras or lights that cannot be.
pub fn read_scene(text: &str) -> Result<PaintScene, ContainerError> {
    let raw: RawScene = toml::from_str(text).map_err(|e| library("scene", &e.message()))?;
    let [width, height] = raw.size;
    if ![width, height].iter().all(|side| (1..=MAX_SIDE).contains(side)) {
        return Err(ContainerError::Missing {
            what: format!("usable size ({width} × {height})"),
            expected: format!("1 to {MAX_SIDE} pixels along each side"),
        });
    }
    let RawScene { mesh, uv, size, truth, view } = raw;
    Ok(PaintScene { mesh, uv, size, views: views(view)?, truth })
}

/// Returns a list of views: entries `[[view]]` with `name`, `eye`, `target`, `up`, `fov_deg` across the picture, and
/// `light_direction` or `light_position`, in axes of the mesh; perhaps `white`, linear RGB (default 1), and `shadows`
/// (default true).
///
/// # Errors
///
/// As [`read_scene`].
pub fn read_views(text: &str) -> Result<Vec<PaintView>, ContainerError> {
    let raw: RawViews = toml::from_str(text).map_err(|e| library("views", &e.message()))?;
    views(raw.view)
}

/// Returns the text of `scene.toml`.
///
/// # Errors
///
/// [`ContainerError::Library`] if it cannot be written.
pub fn write_scene(scene: &PaintScene) -> Result<String, ContainerError> {
    let raw = RawScene {
        mesh: scene.mesh.clone(),
        uv: scene.uv,
        size: scene.size,
        truth: scene.truth.clone(),
        view: scene.views.iter().map(RawView::of).collect(),
    };
    toml::to_string(&raw).map_err(|e| library("scene", &e))
}

/// Channels of a view's buffers: what they hold of a surface.
const BUFFERS: [&str; 13] = [
    "irradiance",
    "mask",
    "normal.X",
    "normal.Y",
    "normal.Z",
    "u",
    "v",
    "wi.X",
    "wi.Y",
    "wi.Z",
    "wo.X",
    "wo.Y",
    "wo.Z",
];

/// Returns the buffers of a view as an EXR image of f32 channels: `mask`, `normal.X` … in axes of the mesh, `wi.X` …
/// and `wo.X` … in the frame of the surface, `u`, `v`, and `irradiance`, 0 in shadow.
///
/// # Errors
///
/// [`ContainerError::Image`] if the encoder refuses.
pub fn write_buffers(buffers: &ViewBuffers) -> Result<Vec<u8>, ContainerError> {
    let values = |surface: &PixelSurface| -> [f64; 13] {
        let PixelSurface { normal: n, wi, wo, uv, irradiance } = surface;
        [*irradiance, 1.0, n.x, n.y, n.z, uv.x, uv.y, wi.x, wi.y, wi.z, wo.x, wo.y, wo.z]
    };
    #[expect(clippy::cast_possible_truncation, reason = "buffers are stored as f32")]
    let channels: Vec<(&str, Vec<f32>)> = BUFFERS
        .iter()
        .enumerate()
        .map(|(at, name)| {
            let of = |pixel: &Option<PixelSurface>| pixel.as_ref().map_or(0.0, |s| values(s)[at]);
            (*name, buffers.pixels.iter().map(|pixel| of(pixel) as f32).collect())
        })
        .collect();
    Ok(encode_exr(buffers.width, buffers.height, &channels)?)
}

/// Returns the buffers of a view whose pictures have `size` columns and rows.
///
/// # Errors
///
/// [`ContainerError`] for an image of another size or without these channels.
pub fn read_buffers(bytes: &[u8], size: [usize; 2]) -> Result<ViewBuffers, ContainerError> {
    let [width, height] = exr_size(bytes)?;
    if [width, height] != size {
        return Err(ContainerError::Missing {
            what: format!("buffers of the scene's size: {width} × {height} pixels"),
            expected: format!("{} × {}", size[0], size[1]),
        });
    }
    let image = exr_planes(bytes)?;
    let planes: Vec<&[f32]> = BUFFERS
        .iter()
        .map(|wanted| {
            image.channel(wanted).ok_or_else(|| ContainerError::Missing {
                what: format!("channel `{wanted}`"),
                expected: "buffers as a scene has them".to_owned(),
            })
        })
        .collect::<Result<_, _>>()?;
    let pixels = (0..width * height).map(|at| {
        let value = |plane: usize| f64::from(planes[plane][at]);
        let vector = |plane: usize| DVec3::new(value(plane), value(plane + 1), value(plane + 2));
        let surface = PixelSurface {
            normal: vector(2),
            wi: vector(7).normalize_or_zero(),
            wo: vector(10).normalize_or_zero(),
            uv: DVec2::new(value(5), value(6)).clamp(DVec2::ZERO, DVec2::ONE),
            irradiance: value(0),
        };
        let is_sound = surface.uv.is_finite() && surface.irradiance.is_finite();
        (value(1) > 0.5 && is_sound).then_some(surface)
    });
    Ok(ViewBuffers { width, height, pixels: pixels.collect() })
}

/// Returns a picture in linear RGB with coverage as an EXR image.
///
/// # Errors
///
/// [`ContainerError::Image`] if the encoder refuses.
pub fn write_painting(image: &PaintedImage) -> Result<Vec<u8>, ContainerError> {
    let channel = |at: usize| image.pixels.iter().map(|pixel| pixel[at]).collect();
    let channels = [("A", channel(3)), ("B", channel(2)), ("G", channel(1)), ("R", channel(0))];
    Ok(encode_exr(image.width, image.height, &channels)?)
}

/// Returns a picture: PNG or JPEG of 8 or 16 bits, taken as sRGB, or linear EXR. Without opacity all of it counts as
/// painted.
///
/// # Errors
///
/// [`ContainerError::Image`] for anything else.
pub fn read_painting(bytes: &[u8]) -> Result<PaintedImage, ContainerError> {
    let picture = decode_picture(bytes)?;
    Ok(PaintedImage { width: picture.width, height: picture.height, pixels: picture.pixels })
}

#[cfg(test)]
mod tests {
    use brdf_mesh::{Mesh, Soup};
    use brdf_paint::vertex_views;

    use super::*;

    fn triangle() -> Mesh {
        let soup = Soup {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            triangles: vec![[0, 1, 2]],
            ..Soup::default()
        };
        Mesh::new(soup).unwrap().0
    }

    #[test]
    fn a_scene_and_its_buffers_come_back() {
        let mesh = triangle();
        let views = vertex_views(&mesh);
        let scene = PaintScene {
            mesh: "triangle.ply".to_owned(),
            uv: UvSource::Sphere,
            size: [16; 2],
            views,
            truth: None,
        };
        let again = read_scene(&write_scene(&scene).unwrap()).unwrap();
        assert_eq!(again.views.len(), 12);
        for (a, b) in scene.views.iter().zip(&again.views) {
            let [a, b] = [a, b].map(|view| ViewBuffers::of(&mesh, view, 16, 16));
            let bytes = write_buffers(&a).unwrap();
            let read = read_buffers(&bytes, [16; 2]).unwrap();
            for ((a, b), read) in a.pixels.iter().zip(&b.pixels).zip(&read.pixels) {
                assert_eq!((a.is_some(), b.is_some()), (read.is_some(), read.is_some()));
                if let (Some(a), Some(b), Some(read)) = (a, b, read) {
                    assert!((a.wi - b.wi).length() < 1e-9, "the camera came back");
                    assert!((a.wi - read.wi).length() < 1e-6 && (a.uv - read.uv).length() < 1e-6);
                }
            }
        }
    }

    #[test]
    fn views_that_cannot_be_are_refused_in_a_line() {
        let view = "[[view]]\nname = \"a\"\neye = [0, 0, 3]\ntarget = [0, 0, 0]\nup = [0, 1, 0]\n\
            fov_deg = 30\nlight_direction = [0, 0, 1]\n";
        assert_eq!(read_views(view).unwrap().len(), 1);
        let broken = [
            view.replace("eye = [0, 0, 3]", "eye = [0, 0, 0]"),
            view.replace("up = [0, 1, 0]", "up = [0, 0, 1]"),
            view.replace("fov_deg = 30", "fov_deg = 190"),
            view.replace("light_direction = [0, 0, 1]", ""),
            view.replace("light_direction = [0, 0, 1]", "light_direction = [0, 0, 0]"),
            view.replace("name = \"a\"", "name = \"../a\""),
            view.replace("fov_deg = 30", "fov_deg = 30\nwhite = [1, 0, 1]"),
            view.repeat(2),
            String::new(),
            "view = 3".to_owned(),
        ];
        for text in broken {
            let error = read_views(&text).unwrap_err().to_string();
            assert!(!error.contains('\n'), "{error}");
        }
    }

    #[test]
    fn paintings_come_back() {
        let image = PaintedImage {
            width: 2,
            height: 1,
            pixels: vec![[0.25, 0.5, 1.0, 1.0], [0.0, 0.0, 0.0, 0.0]],
        };
        assert_eq!(read_painting(&write_painting(&image).unwrap()).unwrap(), image);
        assert!(read_painting(b"no picture").is_err());
    }
}
