//! Running the binary.

use std::f64::consts::{PI, TAU};
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output};

pub(crate) fn brdf(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_brdf"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the binary runs")
}

/// Standard output of a command that must succeed.
pub(crate) fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = brdf(folder, arguments);
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "brdf {arguments:?}: {out}{err}");
    out
}

/// Standard error of a command that must fail: with one line, unless it was used wrongly.
pub(crate) fn fail(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = brdf(folder, arguments);
    let err = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "brdf {arguments:?}: {err}");
    if code == 1 {
        assert_eq!(err.trim_end().lines().count(), 1, "one line: {err}");
        assert!(err.starts_with("brdf: "), "{err}");
    }
    err
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Writes a PNG of 8 bits: grey, RGB or RGBA by the number of values of a pixel.
pub(crate) fn write_png<const N: usize>(
    path: &Path,
    [width, height]: [u32; 2],
    pixel: impl Fn(u32, u32) -> [u8; N],
) {
    let values: Vec<u8> = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .flat_map(|(x, y)| pixel(x, y))
        .collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(match N {
        1 => png::ColorType::Grayscale,
        3 => png::ColorType::Rgb,
        _ => png::ColorType::Rgba,
    });
    encoder.write_header().unwrap().write_image_data(&values).unwrap();
    fs::write(path, bytes).unwrap();
}

/// Reads a picture of three bytes a pixel: pixels in a row, and the pixels.
pub(crate) fn read_rgb(path: &Path) -> (usize, Vec<[u8; 3]>) {
    let image = brdf_image::decode_stored(&fs::read(path).unwrap()).unwrap();
    (image.width, image.samples.into_bytes().as_chunks().0.to_vec())
}

/// A Python with numpy and safetensors, if there is one; says so if a test is skipped for want of it.
pub(crate) fn python() -> Option<String> {
    let python = std::env::var("BRDF_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let modules = Command::new(&python).args(["-c", "import numpy, safetensors"]).output();
    if modules.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    let reason = "has no numpy and safetensors; set BRDF_PYTHON to one that has";
    writeln!(std::io::stderr(), "skipped: {python} {reason}").expect("standard error");
    None
}

/// A ball of few triangles.
pub(crate) fn ball(folder: &Path) {
    let (rings, sectors) = (12_usize, 20_usize);
    let mut obj = String::new();
    for ring in 0..=rings {
        for sector in 0..sectors {
            let theta = PI * ring as f64 / rings as f64;
            let phi = TAU * sector as f64 / sectors as f64;
            let (x, y, z) = (theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            obj += &format!("v {x} {y} {z}\n");
        }
    }
    for ring in 0..rings {
        for sector in 0..sectors {
            let at = |ring: usize, sector: usize| ring * sectors + sector % sectors + 1;
            let [a, b] = [at(ring, sector), at(ring, sector + 1)];
            let [c, d] = [at(ring + 1, sector), at(ring + 1, sector + 1)];
            obj += &format!("f {a} {b} {c}\nf {b} {d} {c}\n");
        }
    }
    fs::write(folder.join("ball.obj"), obj).unwrap();
}
