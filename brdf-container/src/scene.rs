//! Scenes to paint: what `scene.toml` says, the buffers of its views, and the pictures that come back.

use std::io::Cursor;
use std::path::Path;

use brdf_paint::{LightSource, PaintView, PaintedImage, PixelSurface, ViewBuffers};
use brdf_mesh::{Camera, UvSource};
use btf_vq::colour::srgb_to_linear;
use glam::{DVec2, DVec3};
use image::{DynamicImage, ImageReader, Limits};
use serde::{Deserialize, Serialize};

use crate::btf::image_size;
use crate::exr_image::{exr_error, read_exr_layer, write_exr};
use crate::{FormatError, IoError, MappedFile};

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

/// A material that pictures were rendered with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TruthRecord {
    /// The materials that are blended, as they were given.
    pub materials: [String; 3],
    /// What f π was multiplied by.
    pub scale: f64,
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
const MAX_BYTES: u64 = 2 << 30;

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

    fn view(self) -> Result<PaintView, FormatError> {
        let refuse = |what: &str, expected: &str| FormatError::Missing {
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

fn views(raw: Vec<RawView>) -> Result<Vec<PaintView>, FormatError> {
    if raw.is_empty() || raw.len() > MAX_VIEWS {
        return Err(FormatError::Missing {
            what: format!("usable list of views ({} of them)", raw.len()),
            expected: format!("1 to {MAX_VIEWS} entries [[view]]"),
        });
    }
    let views: Vec<PaintView> = raw.into_iter().map(RawView::view).collect::<Result<_, _>>()?;
    let mut names: Vec<&str> = views.iter().map(|view| view.name.as_str()).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(FormatError::Missing {
            what: format!("name for each view: {} occurs twice", pair[0]),
            expected: "different names".to_owned(),
        }),
        None => Ok(views),
    }
}

/// Reads `scene.toml`.
///
/// # Errors
///
/// [`FormatError::Library`] for wrong syntax, [`FormatError::Missing`] for cameras or lights that cannot be.
pub fn read_scene(text: &str) -> Result<PaintScene, FormatError> {
    let raw: RawScene = toml::from_str(text).map_err(|e| library("scene", &e.message()))?;
    let [width, height] = raw.size;
    if ![width, height].iter().all(|side| (1..=MAX_SIDE).contains(side)) {
        return Err(FormatError::Missing {
            what: format!("usable size ({width} × {height})"),
            expected: format!("1 to {MAX_SIDE} pixels along each side"),
        });
    }
    let RawScene { mesh, uv, size, truth, view } = raw;
    Ok(PaintScene { mesh, uv, size, views: views(view)?, truth })
}

/// Reads a list of views: entries `[[view]]` with `name`, `eye`, `target`, `up`, `fov_deg` across the picture, and
/// `light_direction` or `light_position`, in axes of the mesh; perhaps `white`, linear RGB (default 1), and `shadows`
/// (default true).
///
/// # Errors
///
/// As [`read_scene`].
pub fn read_views(text: &str) -> Result<Vec<PaintView>, FormatError> {
    let raw: RawViews = toml::from_str(text).map_err(|e| library("views", &e.message()))?;
    views(raw.view)
}

/// The text of `scene.toml`.
///
/// # Errors
///
/// [`FormatError::Library`] if it cannot be written.
pub fn scene_to_toml(scene: &PaintScene) -> Result<String, FormatError> {
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

/// The buffers of a view as an EXR image of f32 channels: `mask`, `normal.X` … in axes of the mesh, `wi.X` …
/// and `wo.X` … in the frame of the surface, `u`, `v`, and `irradiance`, 0 in shadow.
///
/// # Errors
///
/// [`FormatError::Library`] if the encoder refuses.
pub fn buffers_to_exr(buffers: &ViewBuffers) -> Result<Vec<u8>, FormatError> {
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
    write_exr(buffers.width, buffers.height, &channels)
}

/// Reads the buffers of a view whose pictures have `size` columns and rows.
///
/// # Errors
///
/// [`IoError::File`]; [`IoError::Format`] for an image of another size or without these channels.
pub fn read_buffers(path: &Path, size: [usize; 2]) -> Result<ViewBuffers, IoError> {
    let bytes = MappedFile::open(path)?;
    let read = || {
        let [width, height] = image_size(&bytes)?;
        if [width, height] != size {
            return Err(FormatError::Missing {
                what: format!("buffers of the scene's size: {width} × {height} pixels"),
                expected: format!("{} × {}", size[0], size[1]),
            });
        }
        let (width, height, channels) = read_exr(&bytes)?;
        let planes: Vec<&Vec<f32>> = BUFFERS
            .iter()
            .map(|wanted| {
                let found = channels.iter().find(|(name, _)| name == wanted);
                found.map(|(_, values)| values).ok_or_else(|| FormatError::Missing {
                    what: format!("channel `{wanted}`"),
                    expected: "buffers as `brdf paint setup` writes them".to_owned(),
                })
            })
            .collect::<Result<_, _>>()?;
        let pixels = (0..width * height).map(|at| {
            let value = |plane: usize| f64::from(planes[plane][at]);
            let vector =
                |plane: usize| DVec3::new(value(plane), value(plane + 1), value(plane + 2));
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
    };
    read().map_err(IoError::format(path))
}

/// A picture in linear RGB with coverage as an EXR image.
///
/// # Errors
///
/// [`FormatError::Library`] if the encoder refuses.
pub fn painting_to_exr(image: &PaintedImage) -> Result<Vec<u8>, FormatError> {
    let channel = |at: usize| image.pixels.iter().map(|pixel| pixel[at]).collect();
    let channels = [("A", channel(3)), ("B", channel(2)), ("G", channel(1)), ("R", channel(0))];
    write_exr(image.width, image.height, &channels)
}

/// Reads a picture: PNG or JPEG of 8 or 16 bits, taken as sRGB, or linear EXR. Without opacity all of it counts
/// as painted.
///
/// # Errors
///
/// [`IoError::File`]; [`IoError::Format`] for anything else.
pub fn read_painting(path: &Path) -> Result<PaintedImage, IoError> {
    let bytes = MappedFile::open(path)?;
    let is_exr = bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]);
    let read = if is_exr { parse_exr_painting(&bytes) } else { parse_painting(&bytes) };
    read.map_err(IoError::format(path))
}

fn parse_exr_painting(bytes: &[u8]) -> Result<PaintedImage, FormatError> {
    let (width, height, channels) = read_exr(bytes)?;
    let plane = |wanted: &str| channels.iter().find(|(name, _)| name == wanted).map(|(_, v)| v);
    let grey = plane("Y");
    let colour = |name: &str| {
        plane(name).or(grey).ok_or_else(|| FormatError::Missing {
            what: format!("channel `{name}`"),
            expected: "R, G, B, or Y, and perhaps A".to_owned(),
        })
    };
    let (red, green, blue) = (colour("R")?, colour("G")?, colour("B")?);
    let alpha = plane("A");
    // EXR holds colours times coverage.
    let pixels = (0..width * height).map(|at| {
        let a = alpha.map_or(1.0, |alpha| alpha[at]);
        let scale = if a > 0.0 { a.recip() } else { 0.0 };
        [scale * red[at], scale * green[at], scale * blue[at], a]
    });
    Ok(PaintedImage { width, height, pixels: pixels.collect() })
}

fn parse_painting(bytes: &[u8]) -> Result<PaintedImage, FormatError> {
    image_size(bytes)?;
    let refused =
        |problem: String| FormatError::Library { what: "picture (PNG, JPEG or EXR)", problem };
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| refused(error.to_string()))?;
    let mut limits = Limits::default();
    let side = u32::try_from(MAX_SIDE).unwrap_or(u32::MAX);
    (limits.max_image_width, limits.max_image_height) = (Some(side), Some(side));
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    let image: DynamicImage = reader.decode().map_err(|error| refused(error.to_string()))?;
    let image = image.into_rgba16();
    let scaled = |value: u16| f32::from(value) / f32::from(u16::MAX);
    let pixels = image.pixels().map(|pixel| {
        let [r, g, b, a] = pixel.0.map(scaled);
        [srgb_to_linear(r), srgb_to_linear(g), srgb_to_linear(b), a]
    });
    Ok(PaintedImage {
        width: image.width() as usize,
        height: image.height() as usize,
        pixels: pixels.collect(),
    })
}

type Planes = (usize, usize, Vec<(String, Vec<f32>)>);

/// The channels of an EXR image.
fn read_exr(bytes: &[u8]) -> Result<Planes, FormatError> {
    let [width, height] = image_size(bytes)?;
    let layer = read_exr_layer(bytes)?;
    let channels = layer.channel_data.list.iter();
    let planes = channels.map(|channel| {
        (channel.name.to_string(), channel.sample_data.values_as_f32().collect::<Vec<f32>>())
    });
    let planes: Vec<(String, Vec<f32>)> = planes.collect();
    match planes.iter().find(|(_, values)| values.len() != width * height) {
        Some((name, _)) => Err(exr_error(format!("channel {name} is subsampled"))),
        None => Ok((width, height, planes)),
    }
}

fn library(what: &'static str, problem: &dyn std::fmt::Display) -> FormatError {
    FormatError::Library { what, problem: problem.to_string() }
}

#[cfg(test)]
mod tests {
    use brdf_paint::vertex_views;
    use brdf_mesh::{Mesh, Soup};

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
        let again = read_scene(&scene_to_toml(&scene).unwrap()).unwrap();
        assert_eq!(again.views.len(), 12);
        for (a, b) in scene.views.iter().zip(&again.views) {
            let [a, b] = [a, b].map(|view| ViewBuffers::of(&mesh, view, 16, 16));
            let bytes = buffers_to_exr(&a).unwrap();
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("b.exr");
            std::fs::write(&path, bytes).unwrap();
            let read = read_buffers(&path, [16; 2]).unwrap();
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
    fn paintings_are_linear_and_keep_their_coverage() {
        let image = PaintedImage {
            width: 2,
            height: 1,
            pixels: vec![[0.25, 0.5, 1.0, 1.0], [0.0, 0.0, 0.0, 0.0]],
        };
        let exr = parse_exr_painting(&painting_to_exr(&image).unwrap()).unwrap();
        assert_eq!(exr, image);
        let mut png = Vec::new();
        let rgba = image::RgbaImage::from_raw(2, 1, vec![188, 188, 188, 255, 9, 9, 9, 0]).unwrap();
        rgba.write_to(&mut Cursor::new(&mut png), image::ImageFormat::Png).unwrap();
        let read = parse_painting(&png).unwrap();
        assert!((read.pixels[0][0] - 0.5).abs() < 0.01 && read.pixels[1][3] == 0.0, "{read:?}");
        assert!(parse_painting(b"no picture").is_err() && parse_exr_painting(&png).is_err());
    }
}
