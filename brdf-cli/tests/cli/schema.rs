//! What commands print as JSON, held against the schemas under `docs/schema`, which are those of the records.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{ball, succeed, write_png};
use serde_json::Value;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/schema")
}

#[test]
fn the_committed_schemas_are_those_of_the_records() {
    let schemas = brdf_report::schemas();
    for (name, schema) in &schemas {
        let committed = fs::read_to_string(folder().join(format!("{name}.json"))).unwrap();
        let committed: Value = serde_json::from_str(&committed).unwrap();
        assert_eq!(
            &committed,
            schema.as_value(),
            "{name}: run `cargo run -p brdf-report --features schema --example schemas docs/schema`"
        );
    }
    let files = fs::read_dir(folder()).unwrap().count();
    assert_eq!(files, schemas.len(), "a schema of no record");
}

/// Runs a command that prints JSON, and holds it against a schema.
fn holds(root: &Path, schema: &str, words: &str) {
    let printed = succeed(root, &words.split(' ').collect::<Vec<_>>());
    let printed: Value = serde_json::from_str(&printed).unwrap();
    check(schema, words, &printed);
}

fn check(schema: &str, words: &str, printed: &Value) {
    let text = fs::read_to_string(folder().join(format!("{schema}.json"))).unwrap();
    let validator = jsonschema::validator_for(&serde_json::from_str(&text).unwrap()).unwrap();
    let wrong: Vec<String> = validator
        .iter_errors(printed)
        .map(|error| format!("{}: {error}", error.instance_path()))
        .collect();
    assert!(wrong.is_empty(), "{words} against {schema}: {}", wrong.join("; "));
    // A schema that allows anything would hold for this too.
    assert!(!validator.is_valid(&Value::from("no record")), "{schema} allows anything");
}

#[test]
fn brdf_commands_print_what_the_schemas_say() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    holds(root, "factor", "factor --terms 2 --restarts 1 --samples 2000 --json -o a");
    holds(root, "factor", "factor preset:ggx --method mccool --samples 2000 --json -o m");
    holds(root, "factor-compact", "factor preset:ggx --bytes 500 --json -o small");
    holds(root, "factor-compact", "factor preset:ggx --method ggx --json -o lobes");
    holds(root, "factor-keep", "factor --from a/model.safetensors --keep 1 --json -o k");
    holds(
        root,
        "factor-separable",
        "factor preset:plastic --method eigen --rank 2 --resolution 8 --json -o s",
    );
    holds(root, "compare", "compare preset:ggx a/model.safetensors --metrics all -n 500 --json");
    for name in ["ref", "fit"] {
        fs::create_dir(root.join(name)).unwrap();
        fs::copy(root.join("a/model.safetensors"), root.join(name).join("a.safetensors")).unwrap();
    }
    holds(root, "compare-folders", "compare ref fit -n 500 --json");
    succeed(root, &["sample", "preset:ggx", "-n", "200", "-o", "rows.csv"]);
    holds(root, "info", "info preset:ggx a/model.safetensors s/model.safetensors rows.csv --json");
    holds(root, "study", "study preset:ggx --json -o st");
}

#[test]
fn btf_commands_print_what_the_schemas_say() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    succeed(
        root,
        &[
            "btf",
            "compress",
            "preset:ggx",
            "-o",
            "c.btfvq",
            "--grid",
            "11,11,7,8",
            "--ratio",
            "500",
        ],
    );
    let height = |x, y| [if (x + y) % 3 == 0 { 255 } else { 90 }];
    write_png(&root.join("height.png"), [8; 2], height);
    write_png(&root.join("albedo.png"), [8; 2], |_, _| [200, 120, 60]);
    holds(
        root,
        "btf-synth",
        "btf synth --height height.png --albedo albedo.png --size 8 --samples 1 --bounce-rays 0 --json -o c-images",
    );
    holds(
        root,
        "btf-compress",
        "btf compress preset:ggx preset:ward -o d.btfvq --grid 11,11,7,1 --json",
    );
    holds(root, "btf-compare-brdfs", "btf compare preset:ggx d.btfvq --json");
    holds(root, "btf-info-compressed", "btf info d.btfvq --json");
    holds(root, "btf-decompress", "btf decompress c.btfvq -o images --json");
    holds(root, "btf-info", "btf info c-images --json");
    holds(root, "btf-compress", "btf compress c-images -o e.btfvq --ratio 20 --json");
    holds(root, "btf-compare", "btf compare c-images e.btfvq --json");
    holds(
        root,
        "btf-study",
        "btf study c-images --methods lpca --ratios 5 --every 2000 --json -o btf-study",
    );
}

#[test]
fn painting_and_relighting_print_what_the_schemas_say() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    let truth = "preset:lambert,preset:plastic,preset:ggx";
    holds(
        root,
        "paint-setup",
        &format!("paint setup shape:torus --views 3 --size 32 --truth {truth} --json -o scene"),
    );
    holds(
        root,
        "paint-extract",
        "paint extract scene --products 1 --texels 16 --map-size 16 --json -o material",
    );
    ball(root);
    holds(
        root,
        "relight-precompute",
        "relight precompute ball.obj --rank 2 --quality 1 --map-resolution 8 --json -o o.prt",
    );
    holds(root, "relight-compare", "relight compare o.prt --vertices 5 --json");
    holds(root, "relight-bench", "relight bench o.prt --frames 1 --size 16 --json");
    succeed(
        root,
        &["relight", "turntable", "o.prt", "--frames", "2", "--size", "16", "-o", "turn"],
    );
    succeed(root, &["relight", "sweep", "o.prt", "--terms", "1,2", "--size", "16", "-o", "sweep"]);
    for (schema, folder) in [("relight-turntable", "turn"), ("relight-sweep", "sweep")] {
        let report = fs::read_to_string(root.join(folder).join("report.json")).unwrap();
        check(schema, folder, &serde_json::from_str(&report).unwrap());
    }
}
