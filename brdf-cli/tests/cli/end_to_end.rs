//! The binary as people and pipelines use it: exit codes, streams, files.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::support::{brdf, fail, succeed, text};
use brdf_image::DisplayImage;
use brdf_image::encode_png;
use serde_json::Value;
use tempfile::TempDir;

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

/// A fit over fixed coordinates, at once.
const QUICK: [&str; 6] = ["--method", "mccool", "--texture-size", "8", "--samples", "3000"];
/// A small search.
const SEARCH: [&str; 10] =
    ["--terms", "2", "--restarts", "4", "--texture-size", "8", "--samples", "3000", "--seed", "2"];

#[test]
fn factor_without_input_writes_its_folder() {
    let root = TempDir::new().unwrap();
    let out = succeed(root.path(), &[&["factor"], &QUICK[..]].concat());
    assert!(out.contains("2 textures"), "{out}");
    let names = ["model.safetensors", "spheres.png", "report.html", "report.json"];
    let factors = ["factor-0.exr", "factor-0.png", "factor-1.exr", "factor-1.png"];
    for name in names.iter().chain(&factors) {
        let length = fs::metadata(root.path().join("brdf-out").join(name)).unwrap().len();
        assert!(length > 100, "{name} has {length} bytes");
    }
    let page = fs::read_to_string(root.path().join("brdf-out/report.html")).unwrap();
    assert!(page.contains("data:image/png;base64,") && !page.contains("src=\"http"));
    // Once more, over itself, now by a search.
    let out = succeed(root.path(), &[&["factor"], &SEARCH[..]].concat());
    assert!(out.contains(", reciprocal): mean square") && out.contains("McCool"), "{out}");
    assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1, "nothing is left beside it");
}

/// The two figures that a prototype recorded, over the spread of scrambles.
#[test]
fn mccool_reproduces_the_recorded_errors() {
    let root = TempDir::new().unwrap();
    for (preset, expected) in
        [("preset:lafortune-blue-paint", 0.0268), ("preset:cook-torrance", 0.0444)]
    {
        let options = "--method mccool --luminance --samples 45000 --texture-size 16 --bound cube \
                       --smoothing 1e-3 --space standard --json";
        let arguments: Vec<&str> =
            ["factor", preset].into_iter().chain(options.split_whitespace()).collect();
        let report = json(&succeed(root.path(), &arguments));
        let found = report["terms"][0]["log"]["mean_square"].as_f64().unwrap();
        assert!((found / expected - 1.0).abs() < 0.06, "{preset}: {found}");
    }
}

#[test]
fn factor_json_has_the_documented_keys() {
    let root = TempDir::new().unwrap();
    let arguments = [&["factor", "preset:ggx", "--json"], &QUICK[..]].concat();
    let printed = succeed(root.path(), &arguments);
    let report = json(&printed);
    for key in [
        "input",
        "model",
        "method",
        "space",
        "samples",
        "terms",
        "baseline",
        "evaluations",
        "seconds",
        "bytes",
    ] {
        assert!(!report[key].is_null(), "{key} in {report}");
    }
    assert!(report["samples"]["used"].is_u64() && report["samples"]["dropped"].is_object());
    let term = &report["terms"][0];
    assert_eq!(term["textures"], 2);
    for errors in [term, &term["held_out"], &report["baseline"]["mccool"]] {
        for kind in ["log", "linear"] {
            for measure in ["mean_abs", "mean_square", "max"] {
                assert!(errors[kind][measure].is_f64(), "{kind} {measure} in {errors}");
            }
        }
    }
    let stored = fs::read_to_string(root.path().join("brdf-out/report.json")).unwrap();
    assert_eq!(printed.trim_end(), stored);
}

#[test]
fn compare_json_has_the_documented_keys() {
    let root = TempDir::new().unwrap();
    succeed(root.path(), &[&["factor", "preset:plastic"], &QUICK[..]].concat());
    let arguments = [
        "compare",
        "preset:plastic",
        "brdf-out/model.safetensors",
        "preset:plastic",
        "--luminance",
        "--samples",
        "2000",
        "--seed",
        "7",
        "--max-theta-deg",
        "70",
        "--json",
    ];
    let report = json(&succeed(root.path(), &arguments));
    assert_eq!(report["reference"], "preset:plastic");
    assert_eq!((&report["samples"], &report["seed"]), (&Value::from(2000), &Value::from(7)));
    let results = report["results"].as_array().unwrap();
    assert!(results[0]["bytes"].as_u64().unwrap() > 0);
    assert!(results[0]["cosine_rms"].as_f64().unwrap() > 0.0);
    for key in ["mean_abs", "mean_square", "max"] {
        assert!(results[0]["log"][key].as_f64().unwrap() > 0.0, "{key}");
        assert!(results[1]["linear"][key].as_f64().unwrap().abs() < 1e-12, "identical: {key}");
    }
    // All measures: zero, or the best there is, for the reference itself.
    let all = [&arguments[..], &["--metrics", "all"]].concat();
    let report = json(&succeed(root.path(), &all));
    let (model, same) = (&report["results"][0], &report["results"][1]);
    let keys = [
        "log_cosine_rms",
        "cube_root_rms",
        "log_relative_rms",
        "cosine_rms",
        "cosine_rms_relative",
        "cosine_rms_both",
        "cosine_rms_within_80",
    ];
    for key in keys {
        assert!(model[key].as_f64().unwrap() > 0.0, "{key}");
        assert!(same[key].as_f64().unwrap().abs() < 1e-12, "{key} of the reference");
    }
    assert!(model["ms_per_million"].as_f64().unwrap() > 0.0);
    let lights: Vec<&str> = model["pictures"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["light"].as_str().unwrap())
        .collect();
    assert_eq!(lights, ["sky", "studio", "point"]);
    for picture in model["pictures"].as_array().unwrap() {
        assert!(picture["psnr_db"].as_f64().unwrap() > 10.0);
        assert!((0.2..1.0).contains(&picture["ssim"].as_f64().unwrap()));
        assert!((0.0..0.8).contains(&picture["flip"].as_f64().unwrap()));
        assert!(picture["delta_e_itp"].as_f64().unwrap() > 0.0);
    }
    for picture in same["pictures"].as_array().unwrap() {
        assert!(picture["psnr_db"].is_null());
        assert!((picture["ssim"].as_f64().unwrap() - 1.0).abs() < 1e-9);
        assert!(picture["flip"].as_f64().unwrap() < 1e-9);
        assert!(picture["delta_e_itp"].as_f64().unwrap() < 1e-9);
    }
}

#[test]
fn folders_are_compared_by_name() {
    let root = TempDir::new().unwrap();
    fs::create_dir(root.path().join("measured")).unwrap();
    for preset in ["plastic", "ggx", "ward"] {
        let reference = format!("preset:{preset}");
        succeed(root.path(), &["convert", &reference, &format!("measured/{preset}.binary")]);
    }
    fs::create_dir(root.path().join("fitted")).unwrap();
    for preset in ["plastic", "ggx"] {
        let (file, out) = (format!("measured/{preset}.binary"), format!("fitted/{preset}"));
        succeed(root.path(), &[&["factor", &file, "-o", &out], &QUICK[..]].concat());
    }
    let report =
        json(&succeed(root.path(), &["compare", "measured", "fitted", "-n", "2000", "--json"]));
    assert_eq!(report["materials"].as_array().unwrap().len(), 2);
    assert_eq!(report["unmatched"].as_array().unwrap().len(), 1, "ward has no model");
    let distribution = &report["distributions"][0];
    let log = distribution["measures"]
        .as_array()
        .unwrap()
        .iter()
        .find(|m| m["measure"] == "log.mean_square")
        .unwrap();
    let worst: Vec<f64> =
        log["worst"].as_array().unwrap().iter().map(|w| w[1].as_f64().unwrap()).collect();
    assert!(worst[0] >= worst[1]);
    assert!((log["median"].as_f64().unwrap() - 0.5 * (worst[0] + worst[1])).abs() < 1e-12);
    fail(root.path(), &["compare", "measured", "preset:ggx"], 1);
}

#[test]
fn sums_of_products_are_models_like_any_other() {
    let root = TempDir::new().unwrap();
    let runs: [&[&str]; 7] = [
        &["--method", "svd", "--rank", "3", "--joint-rgb"],
        &["--method", "log-svd", "--rank", "3", "--space", "half-difference", "--isotropic"],
        &["--method", "log-svd", "--log-map", "cosine", "--space", "hybrid", "--map", "polar"],
        &["--method", "eigen", "--rank", "3", "--map", "parabolic"],
        &["--method", "eigen", "--rank", "3", "--eigen-solver", "power"],
        &["--method", "nmf", "--rank", "2", "--weight-power", "0.5"],
        &["--method", "normalized", "--luminance"],
    ];
    for run in runs {
        let arguments =
            [&["factor", "preset:red-plastic", "--resolution", "16", "--json"], run].concat();
        let report = json(&succeed(root.path(), &arguments));
        for key in
            ["input", "model", "method", "space", "map", "matrix", "terms", "spectra", "bytes"]
        {
            assert!(!report[key].is_null(), "{key} of {run:?}");
        }
        let term = report["terms"].as_array().unwrap().last().unwrap().clone();
        for key in ["rank", "relative_residual", "log_cosine_rms", "held_out"] {
            assert!(!term[key].is_null(), "{key} of {run:?}");
        }
        assert!(term["relative_residual"].as_f64().unwrap() < 1.0, "{run:?}: {term}");
        for name in ["spectrum.svg", "first-0.png", "first-0.exr", "spheres.png", "report.html"] {
            assert!(root.path().join("brdf-out").join(name).is_file(), "{name} of {run:?}");
        }
        let model = "brdf-out/model.safetensors";
        assert!(succeed(root.path(), &["info", model]).contains("terms"));
        succeed(root.path(), &["compare", "preset:red-plastic", model, "-n", "500"]);
        succeed(root.path(), &["convert", model, "again.safetensors"]);
        assert_eq!(
            fs::read(root.path().join(model)).unwrap(),
            fs::read(root.path().join("again.safetensors")).unwrap()
        );
    }
}

#[test]
fn every_kind_of_plot_is_drawn_as_svg_and_png() {
    let root = TempDir::new().unwrap();
    succeed(root.path(), &[&["factor", "preset:plastic"], &QUICK[..]].concat());
    let quick = ["factor", "preset:plastic", "-o", "sum", "--method", "svd", "--resolution", "12"];
    succeed(root.path(), &quick);
    let plots: [&[&str]; 10] = [
        &["preset:ggx", "--kind", "slice", "--azimuth-deg", "0,90"],
        &["preset:ggx", "--kind", "slice", "--space", "hybrid", "--azimuth-deg", "90"],
        &["preset:ggx", "--kind", "polar"],
        &["preset:ggx", "--kind", "lobe", "--incidence-deg", "45"],
        &["brdf-out/model.safetensors", "--kind", "factors"],
        &["sum/model.safetensors", "--kind", "factors"],
        &["sum/model.safetensors", "--kind", "spectrum"],
        &["preset:plastic", "--kind", "coverage"],
        &["function:all", "--kind", "parametrizations"],
        &["function:grazing", "--kind", "parametrizations"],
    ];
    for plot in plots {
        for (file, start) in [("out.svg", &b"<svg"[..]), ("out.png", b"\x89PNG")] {
            succeed(root.path(), &[&["plot", "-o", file], plot].concat());
            let bytes = fs::read(root.path().join(file)).unwrap();
            assert!(bytes.starts_with(start) && bytes.len() > 2_000, "{plot:?}: {}", bytes.len());
        }
    }
    fail(root.path(), &["plot", "preset:ggx", "--kind", "factors", "-o", "out.svg"], 1);
    fail(root.path(), &["plot", "preset:ggx", "--kind", "slice", "-o", "out.pdf"], 1);
    fail(root.path(), &["plot", "preset:ggx", "preset:ward", "--kind", "polar", "-o", "o.svg"], 2);
}

#[test]
fn a_study_names_a_winner_for_every_figure() {
    let root = TempDir::new().unwrap();
    let arguments = ["study", "preset:plastic", "preset:ggx", "-o", "study", "--json"];
    let report = json(&succeed(root.path(), &arguments));
    assert_eq!(report["materials"].as_array().unwrap().len(), 2);
    for wins in report["wins"].as_array().unwrap() {
        let total: u64 =
            wins["counts"].as_array().unwrap().iter().map(|c| c[1].as_u64().unwrap()).sum();
        assert_eq!(total, 2, "{wins}");
    }
    for name in ["report.html", "report.json", "study.csv", "slices-0.svg", "slices-1.svg"] {
        assert!(root.path().join("study").join(name).is_file(), "{name}");
    }
    // Once more, over itself.
    succeed(root.path(), &arguments);
}

#[test]
fn models_are_byte_identical_for_any_number_of_threads_and_runs() {
    let root = TempDir::new().unwrap();
    let model = |threads: &str, folder: &str, options: &[&str]| {
        let status = Command::new(env!("CARGO_BIN_EXE_brdf"))
            .args(["factor", "preset:ward", "-o", folder])
            .args(options)
            .env("RAYON_NUM_THREADS", threads)
            .current_dir(root.path())
            .output()
            .unwrap();
        assert!(status.status.success());
        ["model.safetensors", "factor-0.exr", "spheres.png"]
            .map(|name| fs::read(root.path().join(folder).join(name)).unwrap())
    };
    for options in [&QUICK[..], &SEARCH] {
        let one = model("1", "a", options);
        assert_eq!(one, model("2", "b", options));
        assert_eq!(one, model("1", "c", options));
    }
}

#[test]
fn sample_eval_and_convert_feed_each_other() {
    let root = TempDir::new().unwrap();
    succeed(root.path(), &["sample", "preset:ward", "-n", "200", "-o", "pairs.csv"]);
    let values = succeed(root.path(), &["eval", "preset:ward", "--directions", "pairs.csv"]);
    let pairs = fs::read_to_string(root.path().join("pairs.csv")).unwrap();
    assert_eq!(values.lines().next(), pairs.lines().next());
    for (a, b) in values.lines().zip(pairs.lines()).skip(1) {
        let numbers = |line: &str| -> Vec<f64> {
            line.split(',').map(|field| field.parse().unwrap()).collect()
        };
        for (x, y) in numbers(a).into_iter().zip(numbers(b)) {
            assert!((x - y).abs() <= 1e-9 * x.abs().max(1.0), "{a} against {b}");
        }
    }
    succeed(root.path(), &["convert", "pairs.csv", "pairs.safetensors"]);
    succeed(root.path(), &["convert", "preset:plastic", "plastic.binary"]);
    let facts = succeed(root.path(), &["info", "pairs.safetensors", "plastic.binary", "--json"]);
    let facts = json(&facts);
    assert_eq!(facts[0]["samples"]["count"], 200);
    assert_eq!(facts[1]["format"], "MERL binary");
    // A pipe does as well as a file.
    let piped = Command::new("sh")
        .args(["-c", "cat pairs.csv | \"$BRDF\" eval preset:ward --directions /dev/stdin"])
        .env("BRDF", env!("CARGO_BIN_EXE_brdf"))
        .current_dir(root.path())
        .output()
        .unwrap();
    assert_eq!(text(&piped.stdout), values);
}

/// Mean square log errors on held-out pairs, beside those recorded: an option that is not passed on moves
/// them by far more than a tenth.
#[test]
fn every_method_and_option_has_its_effect() {
    let root = TempDir::new().unwrap();
    let planes = "projections = [[[1,0,1,0],[0,1,0,1]], [[1,0,0,0],[0,1,0,0]]]";
    fs::write(root.path().join("planes.toml"), planes).unwrap();
    fs::write(
        root.path().join("planes.json"),
        r#"{"space": "half-difference", "projections": [[[1,0,0,0],[0,1,0,0]]]}"#,
    )
    .unwrap();
    let report_of = |method: &[&str], run: &str| {
        let words = run.split_whitespace();
        let arguments: Vec<&str> = ["factor", "preset:plastic", "--json"]
            .iter()
            .chain(method)
            .copied()
            .chain(words)
            .collect();
        json(&succeed(root.path(), &arguments))
    };
    let held_out = |report: &Value| {
        let best = report["terms"].as_array().unwrap().last().unwrap()["held_out"].clone();
        ["log", "linear"].map(|kind| best[kind]["mean_square"].as_f64().unwrap())
    };
    let searches = [
        ("--luminance --reciprocal auto --space standard", 0.0498),
        ("--space half-difference --weight f --beside h", 0.0424),
        ("--search powell --space half-difference --luminance --objective blend", 0.0478),
        ("--start planes.toml", 0.0500),
        ("--start planes.json --reciprocal off", 0.0590),
        ("--start mccool --space standard", 0.0380),
        ("--time-limit 0.001 --luminance", 0.0703),
    ];
    for (run, expected) in searches {
        let report = report_of(&SEARCH, run);
        let [error, _] = held_out(&report);
        let is_cut_short = run.contains("0.001");
        assert!(error < 1.1 * expected, "{run}: {error}");
        // A faster machine gets further within a millisecond.
        assert!(is_cut_short || error > 0.9 * expected, "{run}: {error}");
        let best = report["terms"].as_array().unwrap().last().unwrap();
        assert!(!best["projections"].as_array().unwrap().is_empty(), "{run}");
        let stopped = report["search"]["stopped"].as_str();
        assert_eq!(stopped, is_cut_short.then_some("time limit"), "{run}");
    }
    let runs = [
        ("--method mccool", 2, 0.0680),
        ("--method radial", 2, 0.000216),
        ("--method radial --reciprocal off", 3, 0.000217),
        ("--method projections --projections planes.toml", 2, 0.100),
        ("--method projections --projections planes.toml --space half-difference", 2, 0.0679),
        ("--method projections --projections planes.json --reciprocal off", 1, 0.0681),
        ("--method mccool --log-map log --weight f", 2, 0.0963),
        ("--method mccool --log-map highlight --weight f2", 2, 0.0563),
        ("--method mccool --replicate 4 --max-theta-deg 70 --seed 9", 2, 0.0490),
        ("--method mccool --luminance --bound cube --reciprocal off", 3, 0.104),
    ];
    for (run, textures, expected) in runs {
        let report = report_of(&QUICK[2..], run);
        let [log, linear] = held_out(&report);
        // A model of a − f may go negative in the shadows, where its logarithm then is anything.
        let error = if run.contains("highlight") { linear } else { log };
        assert!((error / expected - 1.0).abs() < 0.1, "{run}: {error}");
        assert_eq!(
            report["terms"].as_array().unwrap().last().unwrap()["textures"],
            textures,
            "{run}"
        );
    }
}

/// The models of fewer textures in a file are those that the search reported.
#[test]
fn a_smaller_model_can_be_kept_later() {
    let root = TempDir::new().unwrap();
    let arguments = [&["factor", "preset:plastic", "--json"], &SEARCH[..]].concat();
    let report = json(&succeed(root.path(), &arguments));
    let model = "brdf-out/model.safetensors";
    let kept = succeed(root.path(), &["factor", "--from", model, "--keep", "1", "-o", "small"]);
    assert!(kept.contains("1 textures"), "{kept}");
    let compared = [
        "compare",
        "preset:plastic",
        "small/model.safetensors",
        "--samples",
        "3000",
        "--seed",
        "2",
        "--json",
    ];
    let found = json(&succeed(root.path(), &compared));
    let measure = |report: &Value| report["log"]["mean_square"].as_f64().unwrap();
    let (recorded, again) = (measure(&report["terms"][0]), measure(&found["results"][0]));
    assert!((recorded - again).abs() < 1e-9, "{recorded} {again}");
    let none = fail(root.path(), &["factor", "--from", model, "--keep", "3", "-o", "none"], 1);
    assert!(none.contains("1, 2"), "{none}");
    // A model is a start for the next search, in its own space.
    let space = report["space"].as_str().unwrap();
    let other = if space == "standard" { "half-difference" } else { "standard" };
    let start = [&["factor", "--start", model, "-o", "next", "--luminance"], &SEARCH[..]].concat();
    succeed(root.path(), &start);
    fail(root.path(), &[&start[..], &["--space", other]].concat(), 2);
}

#[test]
fn bad_input_gets_one_clear_line() {
    let root = TempDir::new().unwrap();
    let place = |name: &str, content: &[u8]| fs::write(root.path().join(name), content).unwrap();
    place("short.binary", &[90, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0, 1, 2]);
    place("dims.binary", &[90, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0]);
    place("empty.csv", b"");
    place("words.csv", b"theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value\n1,2,3,x,5\n");
    place("dark.csv", b"theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value\n100,2,3,4,5\n");
    place("rows.json", br#"{"projections": [[[1,0,0,0],[2,0,0,0]]]}"#);
    fs::create_dir(root.path().join("folder")).unwrap();
    let cases: [(&[&str], &[&str]); 15] = [
        (&["factor", "nothing.brdf"], &["nothing.brdf", "opening"]),
        (&["factor", "cook-torrance"], &["preset:cook-torrance"]),
        (&["factor", "preset:gold"], &["preset:gold", "lafortune-blue-paint"]),
        (&["info", "short.binary"], &["short.binary", "14 bytes", "34992012"]),
        (&["info", "empty.csv"], &["empty.csv", "empty"]),
        (&["info", "words.csv"], &["words.csv", "line 2", "\"x\"", "a number"]),
        (&["factor", "dark.csv"], &["dark.csv", "1 below the horizon"]),
        (&["factor", "folder"], &["folder", "expected a file"]),
        (
            &["factor", "--method", "projections", "--projections", "rows.json"],
            &["rows.json", "projection 1", "dependent"],
        ),
        (&["factor", "-o", "missing/out"], &["missing/out"]),
        (&["render", "preset:ggx", "--env", "words.csv"], &["words.csv", "HDR"]),
        (
            &["factor", "--method", "svd", "--memory-limit", "10M"],
            &["1804 × 1804 × 3", "MiB", "lower resolution"],
        ),
        (&["factor", "--method", "svd", "--resolution", "4", "--rank", "99"], &["99", "1 to 12"]),
        (&["plot", "function:gloss", "--kind", "slice", "-o", "o.svg"], &["specular, fresnel"]),
        (&["study", "nothing.npz"], &["nothing.npz", "opening"]),
    ];
    for (arguments, words) in cases {
        let message = fail(root.path(), arguments, 1);
        for word in words {
            assert!(message.contains(word), "{word:?} in {message}");
        }
    }
    assert!(!root.path().join("brdf-out").exists(), "nothing half-written");
}

#[test]
fn wrong_usage_exits_with_2() {
    let root = TempDir::new().unwrap();
    let cases: [&[&str]; 27] = [
        &["factor", "--terms", "9"],
        &["factor", "--method", "mccool", "--terms", "3"],
        &["factor", "--method", "radial", "--reciprocal", "auto"],
        &["factor", "--objective", "absolute"],
        &["factor", "--from", "model.safetensors"],
        &["factor", "--start", "mccool", "--beside", "h"],
        &["factor", "--texture-size", "0"],
        &["factor", "--texture-size", "1"],
        &["factor", "--texture-size", "100000"],
        &["factor", "--smoothing=-1"],
        &["factor", "--method", "mccool", "--space", "half-difference"],
        &["factor", "--method", "radial", "--space", "half-difference"],
        &["factor", "--method", "projections"],
        &["factor", "--max-theta-deg", "91"],
        &["compare", "preset:ggx"],
        &["factor", "--rank", "4"],
        &["factor", "--method", "svd", "--texture-size", "16"],
        &["factor", "--method", "svd", "--log-map", "log"],
        &["factor", "--method", "nmf", "--eigen-solver", "power"],
        &["factor", "--method", "mccool", "--space", "hybrid"],
        &["factor", "--method", "svd", "--map", "merl", "--resolution", "20"],
        &["factor", "--method", "eigen", "--space", "half-difference"],
        &["factor", "--method", "eigen", "--joint-rgb"],
        &["factor", "--method", "normalized", "--rank", "2"],
        &["factor", "--method", "svd", "--keep", "2"],
        &["compare", "preset:ggx", "preset:ggx", "--env", "a.hdr"],
        &["plot", "preset:ggx", "--kind", "slice", "--azimuth-deg", "nan", "-o", "a.svg"],
    ];
    for arguments in cases {
        fail(root.path(), arguments, 2);
    }
    assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0, "nothing was written");
}

/// A small picture of a ramp along x.
fn place_map(folder: &Path, name: &str, side: usize, colour: [u8; 3]) {
    let mut picture = DisplayImage::filled(side, side, colour);
    for row in 0..side {
        picture.set(0, row, colour.map(|value| value / 2));
    }
    fs::write(folder.join(name), encode_png(&picture).unwrap()).unwrap();
}

#[test]
fn maps_of_any_sizes_become_a_btf() {
    let root = TempDir::new().unwrap();
    place_map(root.path(), "height.png", 6, [200; 3]);
    place_map(root.path(), "normal.png", 8, [128, 128, 255]);
    place_map(root.path(), "albedo.png", 5, [255, 128, 0]);
    let quick = ["--size", "4", "--samples", "1", "--bounce-rays", "2", "-o", "wool", "--json"];
    let synth = |arguments: &[&str]| {
        let start = ["btf", "synth", "--albedo", "albedo.png"];
        json(&succeed(root.path(), &[&start[..], &quick[..], arguments].concat()))
    };
    let report = synth(&["--height", "height.png", "--height-scale", "0.2"]);
    assert_eq!((&report["images"], &report["size"]), (&Value::from(6561), &Value::from(4)));
    let range = [0, 1].map(|end| report["height_range"][end].as_f64().unwrap());
    // Greys of 100 and 200 of 255, somewhat levelled by the filter.
    let span = range[1] - range[0];
    assert!(range[0] < -0.03 && range[1] > 0.01 && span < 0.2 * 100.0 / 255.0, "{range:?}");
    assert!(report["seconds"].as_f64().unwrap() > 0.0);
    assert!((0.0..0.1).contains(&report["clipped"].as_f64().unwrap()));
    let image = root.path().join("wool/tv075_pv345/00080 tl075 pl345 tv075 pv345.jpg");
    assert!(image.exists());
    synth(&["--normal", "normal.png", "--roughness", "albedo.png", "--roughness-channel", "r"]);

    fs::write(root.path().join("wool/notes.txt"), "mine").unwrap();
    let again = ["btf", "synth", "--albedo", "albedo.png", "--height", "height.png"];
    let message = fail(root.path(), &[&again[..], &quick[..]].concat(), 1);
    assert!(message.contains("wool") && message.contains("--force"), "{message}");
    synth(&["--height", "height.png", "--force"]);
    assert_eq!(fs::read_to_string(root.path().join("wool/notes.txt")).unwrap(), "mine");
}

#[test]
fn maps_that_make_no_surface_get_one_clear_line() {
    let root = TempDir::new().unwrap();
    place_map(root.path(), "map.png", 4, [128; 3]);
    fs::write(root.path().join("words.png"), "no image").unwrap();
    let synth = |arguments: &[&str], code: i32| {
        fail(root.path(), &[&["btf", "synth"], arguments].concat(), code)
    };
    let albedo = ["--albedo", "map.png"];
    for (arguments, words) in [
        (&["--height", "words.png"][..], ["words.png", "PNG or JPEG"]),
        (&["--height", "none.png"], ["none.png", "opening"]),
        (&["--height", "map.png", "--roughness", "none.png"], ["none.png", "opening"]),
    ] {
        let message = synth(&[&albedo[..], arguments].concat(), 1);
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
    for arguments in [
        &[][..],
        &["--height", "map.png", "--size", "0"],
        &["--height", "map.png", "--height-scale", "NaN"],
        &["--height", "map.png", "--roughness", "NaN"],
        &["--height", "map.png", "--samples", "0"],
    ] {
        synth(&[&albedo[..], arguments].concat(), 2);
    }
    assert!(!root.path().join("btf").exists(), "nothing half-written");
}

#[test]
fn foreign_files_are_left_alone() {
    let root = TempDir::new().unwrap();
    let folder = root.path().join("brdf-out");
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("notes.txt"), "mine").unwrap();
    let arguments = [&["factor"], &QUICK[..]].concat();
    let message = fail(root.path(), &arguments, 1);
    assert!(message.contains("--force"), "{message}");
    succeed(root.path(), &[&arguments[..], &["--force"]].concat());
    assert_eq!(fs::read_to_string(folder.join("notes.txt")).unwrap(), "mine");
    assert!(folder.join("report.html").exists());
}

#[test]
fn files_that_brdf_did_not_write_are_overwritten_only_by_force() {
    let root = TempDir::new().unwrap();
    for (name, command) in [
        ("a.png", &["render", "preset:ggx", "--size", "16", "-o", "a.png"][..]),
        ("a.csv", &["sample", "preset:ggx", "-n", "5", "-o", "a.csv"]),
        ("a.safetensors", &["convert", "preset:ggx", "a.safetensors"]),
    ] {
        fs::write(root.path().join(name), "mine").unwrap();
        let message = fail(root.path(), command, 1);
        assert!(message.contains(name) && message.contains("--force"), "{message}");
        assert_eq!(fs::read_to_string(root.path().join(name)).unwrap(), "mine");
        succeed(root.path(), &[command, &["--force"]].concat());
        succeed(root.path(), command);
    }
}

#[test]
fn a_reader_that_stops_early_is_no_error() {
    let root = TempDir::new().unwrap();
    let status = Command::new("sh")
        .args(["-c", "\"$BRDF\" sample preset:ggx -n 20000 | head -n 1; exit ${PIPESTATUS:-0}"])
        .env("BRDF", env!("CARGO_BIN_EXE_brdf"))
        .current_dir(root.path())
        .output()
        .unwrap();
    assert!(!text(&status.stderr).contains("roken pipe"), "{}", text(&status.stderr));
}

#[test]
fn help_teaches_and_completions_complete() {
    let root = TempDir::new().unwrap();
    let help = succeed(root.path(), &["factor", "--help"]);
    for word in ["degrees", "Examples:", "[default: 45000]", "--reciprocal"] {
        assert!(help.contains(word), "{word} in the help");
    }
    assert!(succeed(root.path(), &["completions", "bash"]).contains("_brdf"));
    assert_eq!(brdf(root.path(), &[]).status.code(), Some(2), "no arguments explain themselves");
}
