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
            "--bytes is for --method auto, spline or ggx",
        ),
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
