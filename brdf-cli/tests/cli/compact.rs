//! Small models by the method that suits, and what options choose.

use crate::support::{fail, succeed};
use serde_json::Value;

fn report(folder: &std::path::Path, words: &str) -> Value {
    let words: Vec<&str> = words.split(' ').collect();
    serde_json::from_str(&succeed(folder, &words)).unwrap()
}

#[test]
fn an_isotropic_material_becomes_the_best_small_model() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    let found = report(root, "factor preset:plastic --bytes 1k --json -o a");
    assert_eq!(found["method"], "spline");
    assert!(found["bytes"].as_u64().unwrap() <= 1024, "{found}");
    assert!(found["score"].as_f64().unwrap() < 0.01, "{found}");
    let good = report(root, "factor preset:ggx --error .01 --json -o b");
    let bytes = good["bytes"].as_u64().unwrap();
    assert!(good["score"].as_f64().unwrap() < 0.012 && bytes <= 500, "{good}");
    // Options of one method choose it.
    let lobes = report(root, "factor preset:ggx --lobes 1 --json -o c");
    assert_eq!((&lobes["method"], &lobes["bytes"]), (&"ggx".into(), &44.into()));
    let info = report(root, "info a/model.safetensors c/model.safetensors --json");
    assert_eq!(info[0]["compact"]["method"], "spline");
    assert_eq!(info[1]["compact"]["makeup"]["lobes"]["lobes"].as_array().unwrap().len(), 1);
}

#[test]
fn textures_over_angles_are_chosen_by_trial_or_by_name() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    let words = "factor preset:cook-torrance --method isotropic --bytes 4k --samples 20000";
    let chosen = report(root, &format!("{words} --json -o a"));
    assert_eq!(chosen["method"], "isotropic");
    assert!(chosen["bytes"].as_u64().unwrap() <= 4096, "{chosen}");
    let notes = chosen["notes"].to_string();
    assert!(notes.contains("polar evenly spaced") && notes.contains("oriented"), "{notes}");
    // Weights of the logarithm alone do better by it, those of all measures nearer to the highlight.
    let log =
        |report: &Value| report["terms"][0]["held_out"]["log"]["mean_square"].as_f64().unwrap();
    let words = "factor preset:cook-torrance --angles cartesian --bytes 4k --samples 20000 --weight log --highlight 0 \
                 --offset 1e-5";
    let named = report(root, &format!("{words} --json -o b"));
    assert!(log(&named) < 0.001 && log(&named) < log(&chosen), "{named}");
    // McCool's textures of as many bytes stand beside it.
    let mccool = named["baseline"]["mccool"]["held_out"]["log"]["mean_square"].as_f64().unwrap();
    assert!(mccool > 10.0 * log(&named), "{named}");
    // What is not reciprocal has to be better to be chosen.
    let words = "factor preset:ggx --angles polar --spacing 1 --bytes 3k --reciprocal auto";
    let auto = report(root, &format!("{words} --json -o c"));
    assert_eq!(auto["settings"]["reciprocal"], true, "{auto}");
    assert!(auto["notes"].to_string().contains("not reciprocal"), "{auto}");
    assert!(root.join("b/factor-3.exr").exists() && !root.join("b/factor-4.exr").exists());
}

#[test]
fn texels_of_fewer_bits_leave_room_for_more_of_them() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    let words = "factor preset:ggx --angles polar --spacing 1 --bytes 4k --samples 20000 --json";
    let of = |texels: &str| report(root, &format!("{words} --texels {texels} -o {texels}"));
    let texels = |report: &Value| report["solve"]["unknowns"].as_u64().unwrap();
    let plain = of("f32");
    assert!(plain["terms"][0].get("stored").is_none() && plain.get("fitted_fidelity").is_none());
    for (name, times) in [("f16", 2.0), ("u8", 3.8)] {
        let stored = of(name);
        assert!(stored["bytes"].as_u64().unwrap() <= 4096, "{stored}");
        assert_eq!(stored["settings"]["texels"], name);
        let more = texels(&stored) as f64 / texels(&plain) as f64;
        assert!((more / times - 1.0).abs() < 0.1, "{name}: {more} times the texels");
        // Errors as fitted and as stored stand side by side.
        let term = &stored["terms"][0];
        let log = |errors: &Value| errors["held_out"]["log"]["mean_square"].as_f64().unwrap();
        let (fitted, rounded) = (log(term), log(&term["stored"]));
        assert!(fitted > 0.0 && rounded > 0.0 && fitted < 2.0 * rounded, "{term}");
        assert!(stored["fitted_fidelity"]["highlight"].is_object(), "{stored}");
        let words = format!("info {name}/model.safetensors");
        let said = succeed(root, &words.split(' ').collect::<Vec<_>>());
        assert!(said.contains(&format!("as stored in {name}")), "{said}");
    }
    let said = succeed(
        root,
        &"factor preset:ggx --bytes 2k --texels u8 -o d".split(' ').collect::<Vec<_>>(),
    );
    assert!(said.contains("isotropic in") && said.contains("as stored in u8"), "{said}");
}

#[test]
fn options_that_do_not_go_together_are_refused() {
    let root = tempfile::tempdir().unwrap();
    for (words, says) in [
        (
            "factor preset:ggx --method spline --terms 3",
            "--terms does not apply to --method spline",
        ),
        ("factor preset:ggx --method ggx --bytes 1k", "--bytes is for --method spline"),
        ("factor preset:ggx --method spline --lobes 2", "--lobes is for --method ggx"),
        ("factor preset:ggx --method spline --error .1", "--error is for --method auto"),
        (
            "factor preset:ggx --method mccool --bytes 1k",
            "--bytes is for --method auto, spline, ggx or isotropic",
        ),
        ("factor preset:ggx --method mccool --angles polar", "--angles is for --method auto"),
        ("factor preset:ggx --angles polar --texture-size 8", "here --bytes says how large"),
        (
            "factor preset:ggx --method spline --texels f16",
            "--texels does not apply to --method spline",
        ),
        ("factor preset:ggx --method auto --texels u8", "--texels does not apply to --method auto"),
        ("factor preset:ggx --method svd --texels u8", "--texels does not apply to --method svd"),
        ("factor preset:ggx --method coordinates", "needs --coordinates FILE"),
        ("factor preset:ggx --method spline --highlight .5", "--highlight does not apply"),
        (
            "factor preset:ggx --method spline --bytes 100",
            "a model of 100 bytes; expected 300 to 200000",
        ),
    ] {
        let code = if says.starts_with("a model") { 1 } else { 2 };
        let said = fail(root.path(), &words.split(' ').collect::<Vec<_>>(), code);
        assert!(said.contains(says), "{words}: {said}");
    }
}
