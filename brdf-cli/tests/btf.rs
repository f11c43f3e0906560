//! `brdf btf` from maps to pictures, on a tiny texture.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test that cannot go on has failed"
)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn brdf(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_brdf"))
        .arg("btf")
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the binary runs")
}

fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = brdf(folder, arguments);
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "brdf btf {arguments:?}: {err}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&succeed(folder, arguments)).expect("JSON")
}

/// The one line of a command that must fail.
fn fail(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = brdf(folder, arguments);
    let err = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "brdf btf {arguments:?}: {err}");
    if code == 1 {
        assert_eq!(err.trim_end().lines().count(), 1, "one line: {err}");
    }
    err
}

/// Maps of bumps in two colours.
fn write_maps(folder: &Path) {
    let height =
        |x: u32, y: u32| image::Rgb([u8::try_from((x % 8) * 20 + (y % 8) * 10).unwrap(); 3]);
    let colour = |x: u32, y: u32| {
        image::Rgb(if (x / 8 + y / 8).is_multiple_of(2) { [200_u8, 90, 60] } else { [60, 90, 200] })
    };
    image::RgbImage::from_fn(16, 16, height).save(folder.join("height.png")).unwrap();
    image::RgbImage::from_fn(16, 16, colour).save(folder.join("albedo.png")).unwrap();
}

const SYNTH: [&str; 13] = [
    "synth",
    "--height",
    "height.png",
    "--albedo",
    "albedo.png",
    "--size",
    "16",
    "--samples",
    "2",
    "--bounce-rays",
    "0",
    "-o",
    "bumps",
];

#[test]
fn a_texture_goes_from_maps_to_pictures() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    write_maps(folder);
    succeed(folder, &SYNTH);

    let info = json(folder, &["info", "bumps", "--json"]);
    assert_eq!(info["images"], 6561);
    assert_eq!(info["raw_bytes"], 6561 * 256 * 3);

    let compressed =
        json(folder, &["compress", "bumps", "-o", "b.btfvq", "--ratio", "60", "--json"]);
    assert!(compressed["bytes"].as_u64().unwrap() < 95_000, "{compressed}");
    assert!(compressed["books"]["p4"].as_u64().unwrap() > 4, "{compressed}");
    assert!(compressed["peak_memory"].as_u64().unwrap() > 0, "{compressed}");
    let again = fs::read(folder.join("b.btfvq")).unwrap();
    succeed(folder, &["compress", "bumps", "-o", "b.btfvq", "--ratio", "60"]);
    assert!(again == fs::read(folder.join("b.btfvq")).unwrap(), "equal runs give equal bytes");

    let compared = json(folder, &["compare", "bumps", "b.btfvq", "--json"]);
    let number = |value: &Value| value.as_f64().unwrap();
    assert!(number(&compared["psnr"]) > 22.0, "{compared}");
    assert!(number(&compared["floor"]["psnr"]) > number(&compared["psnr"]), "{compared}");
    assert!(number(&compared["mssim"]) > 0.7, "{compared}");

    let queries =
        "u,v,theta_i_deg,phi_i_deg,theta_v_deg,phi_v_deg\n0.1,0.2,30,10,45,80\n0,0,95,0,0,0\n";
    fs::write(folder.join("q.csv"), queries).unwrap();
    let values = succeed(folder, &["eval", "b.btfvq", "--queries", "q.csv"]);
    let rows: Vec<&str> = values.lines().collect();
    assert_eq!(rows.len(), 3, "{values}");
    assert!(rows[2].ends_with(",0,0,0"), "below the horizon: {values}");

    let samples = succeed(folder, &["sample", "b.btfvq", "--view-deg", "45,0", "-n", "50"]);
    assert_eq!(samples.lines().count(), 51);

    for shape in ["plane", "sphere", "cylinder"] {
        succeed(folder, &["render", "b.btfvq", "--shape", shape, "--size", "48", "-o", "p.png"]);
        assert!(fs::metadata(folder.join("p.png")).unwrap().len() > 500, "{shape}");
    }

    succeed(folder, &["decompress", "b.btfvq", "-o", "again"]);
    let info = json(folder, &["info", "again", "--json"]);
    assert_eq!(info["images"], 6561);
}

#[test]
fn other_modes_levels_and_several_inputs_work() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    write_maps(folder);
    succeed(folder, &SYNTH);
    let paper = json(
        folder,
        &["compress", "bumps", "-o", "p.btfvq", "--mode", "paper", "--measure", "ssim", "--json"],
    );
    // At most 1.2 % of 256 texels.
    assert!((1..=3).contains(&paper["books"]["p4"].as_u64().unwrap()), "{paper}");
    let lpca = json(
        folder,
        &["compress", "bumps", "-o", "l.btfvq", "--mode", "lpca", "--ratio", "20", "--json"],
    );
    assert!(lpca["books"]["components"].as_u64().unwrap() >= 1, "{lpca}");
    succeed(folder, &["compare", "bumps", "l.btfvq", "--no-floor"]);
    succeed(folder, &["render", "l.btfvq", "--size", "32", "-o", "l.png"]);

    let two = ["compress", "bumps", "bumps", "-o", "two.btfvq", "--mipmaps", "--ratio", "60"];
    succeed(folder, &two);
    let info = json(folder, &["info", "two.btfvq", "--json"]);
    let textures = info["textures"].as_array().unwrap();
    assert_eq!((textures.len(), &textures[1]["levels"]), (2, &Value::from(5)), "{info}");
    succeed(folder, &["compare", "bumps", "two.btfvq", "--texture", "2", "--no-floor"]);
}

#[test]
fn what_cannot_be_read_is_refused_in_one_line() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    write_maps(folder);
    fs::create_dir(folder.join("empty")).unwrap();
    fail(folder, &["info", "nowhere"], 1);
    fail(folder, &["info", "empty"], 1);
    fail(folder, &["compress", "empty", "-o", "x.btfvq"], 1);
    assert!(!folder.join("x.btfvq").exists());
    fail(folder, &["render", "height.png"], 1);
    fail(folder, &["compress", "empty", "--mode", "paper", "--ratio", "9"], 2);
    fail(folder, &["compress", "empty", "--epsilon", "0.1"], 2);
    fail(folder, &["sample", "height.png", "--view-deg", "95,0"], 1);
    fs::write(folder.join("q.csv"), "0.1,0.2,30\n").unwrap();
    let line = fail(folder, &["synth", "--albedo", "q.csv", "--height", "height.png"], 1);
    assert!(line.contains("q.csv"), "{line}");
}
