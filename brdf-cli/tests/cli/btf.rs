//! `brdf btf` from maps to pictures, on a tiny texture.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::support::{python, write_png};

fn in_btf<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    [&["btf"], arguments].concat()
}

fn succeed(folder: &Path, arguments: &[&str]) -> String {
    crate::support::succeed(folder, &in_btf(arguments))
}

fn fail(folder: &Path, arguments: &[&str], code: i32) -> String {
    crate::support::fail(folder, &in_btf(arguments), code)
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&succeed(folder, arguments)).expect("JSON")
}

/// Maps of bumps in two colours.
fn write_maps(folder: &Path) {
    let height = |x, y| [u8::try_from((x % 8) * 20 + (y % 8) * 10).unwrap(); 3];
    let colour = |x, y| if (x / 8 + y / 8) % 2 == 0 { [200, 90, 60] } else { [60, 90, 200] };
    write_png(&folder.join("height.png"), [16; 2], height);
    write_png(&folder.join("albedo.png"), [16; 2], colour);
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
fn a_compressed_texture_grows() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    write_maps(folder);
    succeed(folder, &SYNTH);
    let mut flat = SYNTH.to_vec();
    flat[12] = "flat";
    flat.extend(["--height-scale", "0.005"]);
    succeed(folder, &flat);
    let psnr = |model: &str, texture: &str, input: &str| {
        let arguments = ["compare", input, model, "--texture", texture, "--no-floor", "--json"];
        json(folder, &arguments)["psnr"].as_f64().unwrap()
    };
    // 1.2 % of 256 texels are three rows of P4 for the paper's mode.
    for (mode, least) in [("refined", 20.0), ("paper", 12.0)] {
        let (one, both) = (format!("{mode}.btfvq"), format!("{mode}-both.btfvq"));
        succeed(folder, &["compress", "bumps", "-o", &one, "--mode", mode]);
        let grown = json(folder, &["add", &one, "flat", "-o", &both, "--json"]);
        let bytes = fs::metadata(folder.join(&one)).unwrap().len();
        assert!(grown["bytes"].as_u64().unwrap() > bytes, "{grown}");
        assert_eq!(grown["raw_bytes"], 2 * 6561 * 256 * 3);
        let change = psnr(&one, "bumps", "bumps") - psnr(&both, "bumps", "bumps");
        assert!(change.abs() < 0.1, "{mode}: {change} dB");
        let found = psnr(&both, "flat", "flat");
        assert!(found > least, "{mode}: {found} dB");
        let line = fail(folder, &["add", &both, "flat", "-o", "x.btfvq"], 1);
        assert!(line.contains("flat already"), "{line}");
    }
    succeed(folder, &["compress", "bumps", "-o", "l.btfvq", "--mode", "lpca", "--ratio", "20"]);
    let line = fail(folder, &["add", "l.btfvq", "flat", "-o", "x.btfvq"], 1);
    assert!(line.contains("share nothing"), "{line}");
    let line = fail(folder, &["add", "refined.btfvq", "preset:ggx", "-o", "x.btfvq"], 1);
    assert!(line.contains("Srgb") && line.contains("Linear"), "{line}");
    assert!(!folder.join("x.btfvq").exists());
}

#[test]
fn brdfs_share_books_as_textures_of_one_texel() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    let presets = ["preset:lambert", "preset:ward", "preset:ggx"];
    let mut compress = vec!["compress"];
    compress.extend(presets);
    compress.extend(["-o", "b.btfvq", "--grid", "31,31,15,1", "--ratio", "300", "--json"]);
    let made = json(folder, &compress);
    assert_eq!((&made["books"]["p4"], &made["raw_bytes"]), (&3.into(), &(3 * 17_496_000).into()));
    assert!(made["ratio"].as_f64().unwrap() > 290.0, "{made}");
    for preset in presets {
        let compared = json(folder, &["compare", preset, "b.btfvq", "--json"]);
        let (relative, floor) =
            (compared["relative"].as_f64().unwrap(), compared["floor"].as_f64().unwrap());
        assert!(relative < floor + 0.02, "{preset}: {compared}");
    }
    let texture = ["--texture", "preset:lambert"];
    fs::write(folder.join("q.csv"), "0,0,30,10,45,80\n").unwrap();
    let values =
        succeed(folder, &["eval", "b.btfvq", "--queries", "q.csv", texture[0], texture[1]]);
    assert!(values.lines().count() == 2, "{values}");
    let line = fail(folder, &["compare", "preset:plastic", "b.btfvq"], 1);
    assert!(line.contains("no texture"), "{line}");
    fs::create_dir(folder.join("images")).unwrap();
    let line = fail(folder, &["compress", "preset:ggx", "images", "-o", "x.btfvq"], 1);
    assert!(line.contains("one kind"), "{line}");
    fail(folder, &["compress", "preset:ggx", "--grid", "3,3", "-o", "x.btfvq"], 2);
    fail(folder, &["compress", "preset:ggx", "--grid", "1,3,3,1", "-o", "x.btfvq"], 1);
}

/// Names in a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[cfg(unix)]
#[test]
fn a_run_that_cannot_finish_leaves_the_old_file() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    fs::write(folder.join("old.btfvq"), "precious").unwrap();
    let compress = ["compress", "preset:ggx", "--grid", "31,31,15,1", "--force", "-o", "old.btfvq"];
    // No file may grow beyond 4 kB: writing fails as on a full disk.
    let script = "trap '' XFSZ; ulimit -f 8; exec \"$0\" btf \"$@\"";
    let output = Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_brdf")])
        .args(compress)
        .current_dir(folder)
        .output()
        .unwrap();
    let err = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), err.lines().count()), (Some(1), 1), "{err}");
    assert_eq!(fs::read_to_string(folder.join("old.btfvq")).unwrap(), "precious");
    assert_eq!(names(folder), ["old.btfvq"]);

    let fine = ["compress", "preset:ggx", "--force", "-o", "old.btfvq"];
    let mut child = Command::new(env!("CARGO_BIN_EXE_brdf"))
        .arg("btf")
        .args(fine)
        .current_dir(folder)
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(200));
    assert!(child.try_wait().unwrap().is_none(), "still at work");
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(fs::read_to_string(folder.join("old.btfvq")).unwrap(), "precious");
    assert_eq!(names(folder), ["old.btfvq"]);
}

/// The NumPy of docs/btf.md gives what `brdf btf eval` gives at nodes of the grid.
#[test]
fn the_documented_numpy_reads_a_file() {
    let Some(python) = python() else { return };
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/btf.md");
    let docs = fs::read_to_string(docs).unwrap();
    let snippet = docs.split("```python\n").nth(1).and_then(|rest| rest.split("```").next());
    let root = tempfile::tempdir().unwrap();
    let folder = root.path();
    write_maps(folder);
    succeed(folder, &SYNTH);
    succeed(folder, &["compress", "bumps", "-o", "wool.btfvq", "--ratio", "60"]);
    // Nodes away from the horizon: texels of a row, views of 22.5° steps and 15°.
    let script = format!(
        "{}\nqueries = open('q.csv', 'w')\n\
         for n in range(60):\n    \
         x, phi, theta, a, b = n % 16, n * 7 % 16, 1 + n % 4, 2 + n % 7, 2 + n * 3 % 7\n    \
         alpha, s, f = np.radians(18 * a - 90), b / 5 - 1, np.radians(22.5 * phi)\n    \
         c = np.sqrt(1 - s * s); p, q, z = c * np.sin(alpha), s, c * np.cos(alpha)\n    \
         i, j = p * np.cos(f) - q * np.sin(f), p * np.sin(f) + q * np.cos(f)\n    \
         angles = np.degrees(np.arccos(z)), np.degrees(np.arctan2(j, i)), 15 * theta, 22.5 * phi\n    \
         print((x + .5) / 16, 1 - .5 / 16, *angles, sep=',', file=queries)\n    \
         print(luminance(x, phi, theta)[a, b])\n",
        snippet.expect("a Python snippet")
    );
    let output = Command::new(&python).args(["-c", &script]).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let values = succeed(folder, &["eval", "wool.btfvq", "--queries", "q.csv"]);
    let encode =
        |v: f64| if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    let mut compared = 0;
    for (python, row) in printed.lines().zip(values.lines().skip(1)) {
        let rgb: Vec<f64> = row.split(',').skip(6).map(|v| encode(v.parse().unwrap())).collect();
        // Negative channels were set to 0 on the way; they say nothing about luminance.
        if rgb.iter().all(|v| *v > 0.0) {
            let luma = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
            let python: f64 = python.parse().unwrap();
            assert!((luma - python).abs() < 1e-4, "{row}: {luma} {python}");
            compared += 1;
        }
    }
    assert!(compared > 30, "{compared} of 60 nodes compared");
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
