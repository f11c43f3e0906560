//! `brdf paint` from a scene to a picture, and preinverted factorization.

use std::fs;
use std::path::Path;

use crate::support::{brdf, fail, read_rgb, succeed, write_png};
use serde_json::Value;

fn json(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&succeed(folder, arguments)).expect("JSON")
}

const TRUTH: &str = "preset:lafortune-blue-paint,preset:red-plastic,preset:ggx";

fn setup(folder: &Path, more: &[&str]) -> Value {
    let plain = ["paint", "setup", "shape:torus", "--uv", "sphere", "--size", "48", "--json"];
    json(folder, &[&plain[..], more].concat())
}

#[test]
fn a_rendered_scene_becomes_a_material_that_holds_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let made = setup(folder, &["--truth", TRUTH]);
    assert_eq!((made["views"].as_u64(), made["uv"].as_str()), (Some(12), Some("sphere")));
    let extract = ["paint", "extract", "scene", "--products", "3", "--map-size", "32", "--json"];
    let report = json(folder, &extract);
    let (train, held_out) =
        (report["rms"]["train"].as_f64().unwrap(), report["rms"]["held_out"].as_f64().unwrap());
    assert!(train < 0.06 && held_out < 0.08, "{train}, {held_out}");
    assert_eq!(report["products"], 3);
    for key in ["max", "unconstrained_texels", "seconds", "samples", "skipped", "notes"] {
        assert!(!report[key].is_null(), "{key}");
    }
    for name in ["material.safetensors", "map-3.exr", "coverage.png", "view-12.png", "report.html"]
    {
        assert!(folder.join("material").join(name).exists(), "{name}");
    }
    let first = fs::read(folder.join("material/material.safetensors")).unwrap();
    json(folder, &extract);
    let again = fs::read(folder.join("material/material.safetensors")).unwrap();
    assert!(first == again, "the same bytes");
    let view = ["--size", "48", "--ground", "--view-deg", "40,30", "-o", "p.png"];
    let preview = ["paint", "preview", "material", "--mesh", "shape:torus"];
    succeed(folder, &[&preview[..], &view[..]].concat());
    let (_, pixels) = read_rgb(&folder.join("p.png"));
    let brightest = pixels.iter().map(|p| p[0]).max().unwrap();
    assert!(brightest > 120, "lit: {brightest}");

    let paper = ["--solver", "paper", "--mode", "hybrid", "-o", "paper"];
    let paper = json(folder, &[&extract[..], &paper[..]].concat());
    assert!(paper["rms"]["train"].as_f64().unwrap() > train, "turns are better");
    let held =
        json(folder, &[&extract[..], &["--hold-out", "view03,view07", "-o", "held"]].concat());
    assert!(held["samples"].as_u64() < report["samples"].as_u64());
    for mode in ["brdf", "four-factor"] {
        let report = json(folder, &[&extract[..], &["--mode", mode, "-o", mode]].concat());
        assert_eq!(report["products"], 1);
    }
}

#[test]
fn hand_made_paintings_count_where_they_are_opaque() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    setup(folder, &[]);
    let error = fail(folder, &["paint", "extract", "scene"], 1);
    assert!(error.contains("no painting"), "{error}");
    let paint = |name: &str, size: u32, opaque: u8| {
        let path = folder.join("scene/painted").join(name);
        write_png(&path, [size; 2], |_, _| [180, 90, 40, opaque]);
    };
    paint("view00.png", 48, 0);
    let error = fail(folder, &["paint", "extract", "scene"], 1);
    assert!(error.contains("transparent"), "{error}");
    paint("view00.png", 40, 255);
    let error = fail(folder, &["paint", "extract", "scene"], 1);
    assert!(error.contains("view00") && error.contains("48"), "{error}");
    paint("view00.png", 48, 255);
    fs::write(folder.join("scene/painted/view01.png"), b"no picture").unwrap();
    let error = fail(folder, &["paint", "extract", "scene"], 1);
    assert!(error.contains("view01.png"), "{error}");
    fs::remove_file(folder.join("scene/painted/view01.png")).unwrap();
    fs::write(folder.join("scene/painted/view0.png"), b"a typo").unwrap();
    let report = json(folder, &["paint", "extract", "scene", "--mode", "brdf", "--json"]);
    let notes = report["notes"].to_string();
    assert!(
        notes.contains("not painted: view01")
            && notes.contains("view0.png: of no view")
            && notes.contains("beside the object"),
        "{notes}"
    );
    assert!(report["rms"]["held_out"].is_null());

    // A second set-up keeps what was painted.
    let error = fail(folder, &["paint", "setup", "shape:torus"], 1);
    assert!(error.contains("scene"), "{error}");
    setup(folder, &["--force"]);
    assert!(folder.join("scene/painted/view00.png").exists());
    fail(folder, &["paint", "setup", "shape:torus", "--views", "0", "-o", "x"], 2);
    fail(folder, &["paint", "setup", "shape:torus", "--size", "48x9", "-o", "x"], 2);
    let log_map = ["--log-map", "highlight", "--offset", "0.1"];
    fail(folder, &[&["paint", "extract", "scene"], &log_map[..]].concat(), 2);
    fail(folder, &["paint", "setup", "shape:torus", "--truth", "preset:ggx", "-o", "x"], 2);
    let light = "[[view]]\nname = \"in\"\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nup = [0, 1, 0]\n\
        fov_deg = 30\nlight_position = [0, 0, 0.1]\n";
    fs::write(folder.join("views.toml"), light).unwrap();
    let inside =
        fail(folder, &["paint", "setup", "shape:torus", "--views", "views.toml", "-o", "x"], 1);
    assert!(inside.contains("inside"), "{inside}");
    fs::write(folder.join("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    let flat = fail(folder, &["paint", "setup", "flat.obj", "-o", "x"], 1);
    assert!(flat.contains("flat.obj") && flat.contains("degenerate"), "{flat}");
    let tiled = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 3 0\nvt 0 3\nf 1/1 2/2 3/3\n";
    fs::write(folder.join("tiled.obj"), tiled).unwrap();
    let output = brdf(folder, &["paint", "setup", "tiled.obj", "-o", "x"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("repeat a tile"), "{output:?}");
    let other = fail(folder, &["paint", "preview", "views.toml", "--mesh", "shape:torus"], 1);
    assert!(other.contains("views.toml"), "{other}");
}

/// Photographs as they come: poses in a file, no square, shadows, lights of unequal strength, and three kinds of
/// files. They are rendered; what is extracted is judged by the albedo that they were rendered with.
#[test]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "pixels of pictures")]
fn photographs_of_known_poses_become_a_material() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut views = String::new();
    let files = ["a.png", "b.jpg", "c.exr", "d.png"];
    for (at, file) in files.iter().enumerate() {
        let (sin, cos) = (1.3 * at as f64).sin_cos();
        let eye = [4.0 * sin, 2.5, 4.0 * cos];
        let light = [2.5 * sin + 1.0, 1.0, 2.5 * cos];
        let name = &file[..1];
        views += &format!(
            "[[view]]\nname = \"{name}\"\neye = {eye:?}\ntarget = [0.0, 0.0, 0.0]\nup = [0.0, 1.0, 0.0]\n\
             fov_deg = 34.0\nlight_position = {light:?}\nwhite = [0.3, 0.25, 0.2]\n"
        );
    }
    fs::write(folder.join("views.toml"), views).unwrap();
    let setup = ["paint", "setup", "shape:torus", "--views", "views.toml", "--size", "96x64"];
    let made = json(folder, &[&setup[..], &["--uv", "sphere", "--json"]].concat());
    assert_eq!(made["size"], serde_json::json!([96, 64]));
    let (albedo, white) = ([0.7, 0.4, 0.2], [0.3, 0.25, 0.2]);
    for file in files {
        let buffers = folder.join(format!("scene/buffers/{}.exr", &file[..1]));
        let buffers = brdf_container::read_buffers(&fs::read(&buffers).unwrap(), [96, 64]).unwrap();
        let shadowed = buffers.pixels.iter().flatten().filter(|s| s.irradiance == 0.0).count();
        assert!(shadowed > 10, "{file}: the ring shades itself");
        let path = folder.join("scene/painted").join(file);
        let linear = |at: usize| {
            // What is in shadow is not quite black in a photograph.
            let lit = buffers.pixels[at].map_or(0.3, |s| (s.wi.z * s.irradiance).max(0.02));
            [0, 1, 2].map(|c| albedo[c] * white[c] * lit)
        };
        match file.split_once('.').unwrap() {
            (_, "exr") => {
                let pixels = (0..96 * 64).map(|at| {
                    let [r, g, b] = linear(at).map(|v| v as f32);
                    [r, g, b, 1.0]
                });
                let image =
                    brdf_paint::PaintedImage { width: 96, height: 64, pixels: pixels.collect() };
                fs::write(path, brdf_container::write_painting(&image).unwrap()).unwrap();
            }
            (name, ending) => {
                let encode = |v: f64| {
                    let low = 12.92 * v;
                    if v <= 0.003_130_8 { low } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
                };
                let scaled = |most: f64| {
                    (0..96 * 64).flat_map(move |at| {
                        linear(at).map(|v| (most * encode(v).min(1.0)).round() as u16)
                    })
                };
                let narrow: Vec<u8> = scaled(255.0).map(|v| v as u8).collect();
                let mut bytes = Vec::new();
                match (name, ending) {
                    ("a", _) => {
                        let mut encoder = png::Encoder::new(&mut bytes, 96, 64);
                        encoder.set_color(png::ColorType::Rgb);
                        encoder.set_depth(png::BitDepth::Sixteen);
                        let deep: Vec<u8> = scaled(65535.0).flat_map(u16::to_be_bytes).collect();
                        encoder.write_header().unwrap().write_image_data(&deep).unwrap();
                    }
                    (_, "png") => write_png(&path, [96, 64], |x, y| {
                        let at = 3 * (96 * y + x) as usize;
                        [narrow[at], narrow[at + 1], narrow[at + 2]]
                    }),
                    _ => {
                        let mut encoder = jpeg_encoder::Encoder::new(&mut bytes, 75);
                        encoder.set_sampling_factor(jpeg_encoder::SamplingFactor::R_4_4_4);
                        encoder.encode(&narrow, 96, 64, jpeg_encoder::ColorType::Rgb).unwrap();
                    }
                }
                if !bytes.is_empty() {
                    fs::write(path, bytes).unwrap();
                }
            }
        }
    }
    let extract =
        ["paint", "extract", "scene", "--mode", "brdf", "--least-cosine", "0.25", "--json"];
    let report = json(folder, &extract);
    assert!(report["skipped"]["shadowed"].as_u64().unwrap() > 40, "{report}");
    // The blocks of the JPEG run over the rim of the object.
    assert!(report["contradicted_cells"].as_u64().unwrap() < 10, "{report}");
    let rms = |report: &Value, of: &str| report["rms"][of].as_f64().unwrap();
    assert!(rms(&report, "train") < 0.06, "{report}");
    let held = json(folder, &[&extract[..], &["--hold-out", "b", "-o", "held"]].concat());
    let (train, jpeg) = (rms(&held, "train"), rms(&held, "held_out"));
    assert!(train < 0.015 && jpeg < 0.05, "16 bits, 8 bits and floats: {train}; the JPEG: {jpeg}");
    let few = json(folder, &[&extract[..], &["--pixels", "800", "-o", "few"]].concat());
    assert_eq!(few["samples"], 800);
    assert!(few["notes"].to_string().contains("more than --pixels"), "{few}");
    write_png(&folder.join("scene/painted/d.png"), [96, 64], |_, _| [255; 3]);
    let full = json(folder, &[&extract[..], &["-o", "full"]].concat());
    assert!(full["notes"].to_string().contains("may have been brighter"), "{full}");
    let view = ["--view-deg", "0,90", "--light-deg", "0,0", "--size", "64", "-o", "p.png"];
    let preview = ["paint", "preview", "material", "--mesh", "shape:torus"];
    succeed(folder, &[&preview[..], &view[..]].concat());
    let (_, pixels) = read_rgb(&folder.join("p.png"));
    let brightest = |c: usize| pixels.iter().map(|p| f64::from(p[c]) / 255.0).fold(0.0, f64::max);
    for (channel, albedo) in albedo.iter().enumerate() {
        let found = ((brightest(channel) + 0.055) / 1.055).powf(2.4);
        assert!((found - albedo).abs() < 0.04, "the top of the ring: {found} for {albedo}");
    }
}

#[test]
fn an_inverted_matrix_serves_materials_at_the_same_places() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let plain = ["factor", "preset:ggx", "--method", "mccool", "--texture-size", "8"];
    let samples = ["--samples", "3000"];
    let arguments =
        [&plain[..], &samples, &["--preinvert", "basis.safetensors", "--json"]].concat();
    json(folder, &arguments);
    let with = ["factor", "preset:cook-torrance", "--with", "basis.safetensors", "-o", "with"];
    let reused = json(folder, &[&with[..], &["--json"]].concat());
    let direct = ["factor", "preset:cook-torrance", "--method", "mccool", "--texture-size", "8"];
    let direct = json(folder, &[&direct[..], &samples, &["-o", "direct", "--json"]].concat());
    let error = |report: &Value| report["terms"][0]["log"]["mean_square"].as_f64();
    let (a, b) = (error(&reused).unwrap(), error(&direct).unwrap());
    assert!((a / b - 1.0).abs() < 1e-6, "{a} and {b}");
    let svd =
        ["--components", "60", "--damping", "linear", "--preinvert", "b.safetensors", "--force"];
    json(folder, &[&plain[..], &samples, &svd, &["--json"]].concat());
    let with = ["factor", "preset:cook-torrance", "--with", "b.safetensors", "-o", "svd", "--json"];
    let coarse = error(&json(folder, &with)).unwrap();
    assert!(coarse > a, "60 components of more: {coarse} and {a}");

    fail(folder, &["factor", "--preinvert", "x.safetensors"], 2);
    let below = [&plain[..], &["--preinvert", "x.safetensors", "--zeros", "below"]].concat();
    let below = fail(folder, &below, 1);
    assert!(below.contains("expected exact"), "{below}");
    fail(folder, &["factor", "--with", "basis.safetensors", "--zeros", "below"], 2);
    fail(folder, &["factor", "--with", "basis.safetensors", "--samples", "4"], 2);
    fs::write(
        folder.join("rows.csv"),
        "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value\n\
        10,0,20,180,0.5\n30,0,40,180,0.4\n",
    )
    .unwrap();
    let other = fail(folder, &["factor", "rows.csv", "--with", "basis.safetensors", "-o", "y"], 1);
    assert!(other.contains("make a basis"), "{other}");
    let model = fail(folder, &["factor", "--with", "with/model.safetensors", "-o", "z"], 1);
    assert!(model.contains("expected a preinverted matrix"), "{model}");
}
