//! `brdf relight` from an object to a picture.

use std::fs;
use std::path::Path;

use crate::support::{ball, brdf, fail, read_rgb, succeed, text};
use serde_json::Value;

fn json(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&succeed(folder, arguments)).expect("JSON")
}

const MAKE: [&str; 7] =
    ["relight", "precompute", "ball.obj", "--map-resolution", "24", "-o", "b.prt"];

#[test]
fn an_object_is_relit_compared_and_timed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ball(folder);
    let brown = ["--brdf", "preset:light-brown-plastic", "--json"];
    let made = json(folder, &[&MAKE[..], &brown].concat());
    assert!(made["terms"].as_u64().unwrap() >= 16 && made["resumed"] == 0, "{made}");
    for key in ["vertices", "entries", "components", "transport_bytes", "bytes", "seconds"] {
        assert!(made[key].as_f64().unwrap() > 0.0, "{key}: {made}");
    }
    assert!(!folder.join("b.prt.part").exists());
    let first = fs::read(folder.join("b.prt")).unwrap();
    json(folder, &[&MAKE[..], &brown].concat());
    assert!(fs::read(folder.join("b.prt")).unwrap() == first, "the same bytes");

    let wavelet = ["--codec", "wavelet", "--coefficients", "64", "-o", "w.prt"];
    let wavelet = json(folder, &[&MAKE[..5], &wavelet, &brown].concat());
    assert!(wavelet["components"] == 0, "{wavelet}");
    let compare = ["relight", "compare", "b.prt", "--vertices", "30", "--json"];
    let split = json(folder, &[&compare[..], &["--brdf", "preset:light-brown-plastic"]].concat());
    let of = |key: &str| split[key].as_f64().unwrap();
    assert!(of("total") < 0.15 && of("total") > 0.0, "{split}");
    assert!(of("rank") < of("total") * 1.2 && of("visibility") < 0.05, "{split}");
    assert!(of("coefficients") > 0.0 && of("light") >= 0.0, "{split}");
    let other =
        brdf(folder, &["relight", "compare", "b.prt", "--vertices", "4", "--brdf", "preset:ggx"]);
    assert!(text(&other.stderr).contains("made with"), "{other:?}");

    let bench =
        json(folder, &["relight", "bench", "b.prt", "--frames", "2", "--size", "32", "--json"]);
    for key in ["precompute_s", "light_kernel_fps", "light_frame_fps", "view_frame_fps", "bytes"] {
        assert!(bench[key].as_f64().unwrap() > 0.0, "{key}: {bench}");
    }

    let render = ["relight", "render", "b.prt", "--size", "64", "--view", "0,0,3.5"];
    succeed(folder, &[&render[..], &["-o", "a.png"]].concat());
    succeed(folder, &[&render[..], &["--rotate-deg", "180", "-o", "b.png"]].concat());
    let brightest = |name: &str| {
        let (width, pixels) = read_rgb(&folder.join(name));
        let columns = pixels.iter().enumerate();
        let columns = columns.map(|(at, p)| (u64::from(p[1]).pow(3), (at % width) as u64));
        let (sum, moment) = columns.fold((0, 0), |(s, m), (v, x)| (s + v, m + v * x));
        moment as f64 / sum as f64
    };
    // The sun stands to the left, before the object or behind it.
    let (before, behind) = (brightest("a.png"), brightest("b.png"));
    assert!((before - behind).abs() > 2.0, "the light turns: {before} and {behind}");

    let sweep = ["relight", "sweep", "b.prt", "--size", "32", "--brdf"];
    let sweep = [&sweep[..], &["preset:light-brown-plastic", "--terms", "1,4,16"]].concat();
    succeed(folder, &[&sweep[..], &["-o", "terms"]].concat());
    let report = fs::read(folder.join("terms/report.json")).unwrap();
    let report: Value = serde_json::from_slice(&report).unwrap();
    let errors: Vec<f64> = serde_json::from_value(report["relative_rms"].clone()).unwrap();
    // Brute force is at vertices, of which the ball has few: more terms draw a sharper highlight.
    assert!(errors.len() == 3 && errors[0] > errors[1], "{report}");
    assert!(errors.iter().all(|error| (0.01..0.3).contains(error)), "{report}");
    for name in ["strip.png", "errors.svg"] {
        assert!(folder.join("terms").join(name).exists(), "{name}");
    }
    let few = ["relight", "sweep", "w.prt", "--size", "32", "--coefficients", "4,64", "-o", "few"];
    succeed(folder, &few);
    let clusters = fail(folder, &["relight", "sweep", "b.prt", "--coefficients", "4"], 2);
    assert!(clusters.contains("--codec wavelet"), "{clusters}");
    let beyond = fail(folder, &["relight", "sweep", "b.prt", "--terms", "90"], 2);
    assert!(beyond.contains("has 1 to"), "{beyond}");

    let turn =
        ["relight", "turntable", "b.prt", "--frames", "3", "--size", "32", "--env", "light:studio"];
    succeed(folder, &[&turn[..], &["-o", "frames"]].concat());
    succeed(folder, &[&turn[..], &["--turn", "light", "-o", "lights"]].concat());
    for name in ["frames", "lights"] {
        let frames =
            [1, 2, 3].map(|i| fs::read(folder.join(format!("{name}/frame-00{i}.png"))).unwrap());
        assert!(frames[0] != frames[1] && frames[1] != frames[2], "{name}: frames differ");
    }
}

#[test]
fn an_interrupted_run_goes_on_to_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ball(folder);
    let make = [
        "relight",
        "precompute",
        "ball.obj",
        "--rank",
        "2",
        "--map-resolution",
        "16",
        "--quality",
        "1",
        "--ground",
        "--json",
        "-o",
        "t.prt",
    ];
    let whole = json(folder, &make);
    assert!(whole["vertices"].as_u64().unwrap() > 148 * 148);
    let wanted = fs::read(folder.join("t.prt")).unwrap();
    // A run that is killed leaves its chunks, and the last of them may be cut off.
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_brdf"))
        .args(make)
        .args(["--force"])
        .current_dir(folder)
        .spawn()
        .unwrap();
    let part = folder.join("t.prt.part");
    let started = std::time::Instant::now();
    while fs::metadata(&part).map_or(0, |m| m.len()) < 100 && started.elapsed().as_secs() < 60 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(fs::read(folder.join("t.prt")).unwrap() == wanted, "the old file stays whole");
    let mut bytes = fs::read(&part).unwrap();
    bytes.extend([9; 30]);
    fs::write(&part, bytes).unwrap();
    let resumed = json(folder, &[&make[..], &["--resume"]].concat());
    assert!(resumed["resumed"].as_u64().unwrap() >= 100, "{}", resumed["resumed"]);
    assert!(fs::read(folder.join("t.prt")).unwrap() == wanted, "the same file");
    assert!(!part.exists());
}

#[test]
fn what_cannot_be_relit_is_refused_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ball(folder);
    succeed(folder, &[&MAKE[..], &["--rank", "2"]].concat());
    let bytes = fs::read(folder.join("b.prt")).unwrap();
    fs::write(folder.join("half.prt"), &bytes[..bytes.len() / 2]).unwrap();
    let half = fail(folder, &["relight", "render", "half.prt"], 1);
    assert!(half.contains("half.prt"), "{half}");
    let obj = fail(folder, &["relight", "render", "ball.obj"], 1);
    assert!(obj.contains("ball.obj"), "{obj}");
    let info = fail(folder, &["compare", "preset:ggx", "b.prt"], 1);
    assert!(info.contains("brdf relight"), "{info}");
    let missing = fail(folder, &["relight", "render", "b.prt", "--env", "no.hdr"], 1);
    assert!(missing.contains("no.hdr"), "{missing}");
    let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n";
    fs::write(folder.join("black.hdr"), [&header[..], &[0; 4 * 32]].concat()).unwrap();
    let black = fail(folder, &["relight", "render", "b.prt", "--env", "black.hdr"], 1);
    assert!(black.contains("no texel is lit"), "{black}");
    fs::write(folder.join("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    fail(folder, &["relight", "precompute", "flat.obj"], 1);
    fail(folder, &["relight", "precompute", "ball.obj", "--rank", "65"], 2);
    let mixed = fail(folder, &["relight", "precompute", "ball.obj", "--coefficients", "64"], 2);
    assert!(mixed.contains("--codec wavelet"), "{mixed}");
    fs::write(folder.join("notes.txt"), "mine").unwrap();
    let mine = brdf(folder, &["relight", "precompute", "ball.obj", "-o", "notes.txt"]);
    assert_eq!(mine.status.code(), Some(1), "{mine:?}");
    assert!(!folder.join("notes.txt.part").exists(), "said before the work, not after");
    let anew = brdf(folder, &[&MAKE[..], &["--rank", "1", "--resume"]].concat());
    assert!(text(&anew.stderr).contains("begun anew"), "{anew:?}");
    fail(folder, &["relight", "render", "b.prt", "--view", "0,0,0.5"], 2);
    fail(folder, &["relight", "render", "b.prt", "-o", "x.jpg"], 1);
    let rank = ["--rank", "64", "--map-resolution", "4", "-o", "c.prt"];
    let rank = brdf(folder, &[&["relight", "precompute", "ball.obj"][..], &rank].concat());
    assert!(text(&rank.stderr).contains("rank 64; expected 1 to 12"), "{rank:?}");
}
