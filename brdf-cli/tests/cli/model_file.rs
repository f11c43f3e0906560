//! Models evaluated without this project: `docs/evaluate_model.py` gives what `brdf eval` gives.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::{fail, python, succeed, text};
use brdf_container::{write_compact, write_separable};
use brdf_fit::{
    CompactBrdf, CompactMethod, CompactSettings, Fit, FitSettings, LogChoice, Material,
    SeparableMap, SeparableMethod, SeparableSettings, fit,
};
use brdf_job::Job;
use brdf_model::{Analytic, Brdf, Channels, MerlNodes, Preset, Rgb};
use brdf_param::{DirectionPair, Parametrization};
use brdf_separable::{EigenSolver, Fill};
use tempfile::TempDir;

/// Products of textures: every coordinate, space, log map and format of texels, with and without reciprocity.
const PRODUCTS: [&str; 17] = [
    "preset:ggx --method mccool",
    "preset:ashikhmin-shirley --method mccool --reciprocal off --luminance --bound cube --max-theta-deg 60",
    "preset:plastic --method radial --reciprocal off --log-map log",
    "preset:plastic --method projections --projections planes.toml",
    "preset:ward --method projections --projections planes.toml --space half-difference --reciprocal off \
     --log-map highlight",
    "preset:ggx --terms 1 --restarts 1 --space standard --beside d",
    "preset:red-plastic --terms 1 --restarts 1 --space half-difference --beside radial --search powell",
    "preset:red-plastic --method mccool --preinvert basis.safetensors",
    "black.csv --method mccool",
    "preset:ggx --angles polar --bytes 3k --no-ceiling",
    "preset:cook-torrance --angles cartesian --spacing 0.5 --bytes 3k --luminance",
    "preset:ggx --angles oriented --bytes 3k --reciprocal off",
    "preset:plastic --coordinates angles.toml",
    "preset:ggx --method mccool --texels f16",
    "preset:plastic --method radial --reciprocal off --luminance --texels u8",
    "preset:ggx --angles cartesian --bytes 1500 --texels f16 --luminance",
    "preset:ggx --angles polar --bytes 1k --texels u8",
];

/// Splines of a material with both symmetries, in colour and grey, alone and on lobes, and lobes.
const COMPACT: [&str; 6] = [
    "preset:ggx --method spline --bytes 600",
    "preset:plastic --method spline --bytes 600 --luminance",
    "rows.csv --method spline --bytes 600",
    "rows.csv --method spline --bytes 500 --luminance",
    "preset:red-plastic --method ggx --lobes 1",
    "preset:ggx --method ggx --lobes 2",
];

/// Sums of products: every parametrization, isotropic and not, every map of the hemisphere, value map and
/// kind of second side. From the library, since the command draws pictures too.
fn sums() -> Vec<(&'static str, SeparableSettings)> {
    use Parametrization::{
        HalfDifference, Hybrid, KautzMcCool, OnionSlice, Orthographic, Standard,
    };
    use SeparableMap::{Merl, Parabolic, Polar, Spherical};
    use SeparableMethod::{Eigen, LogSvd, Nmf, Normalized, Svd};
    let offset = LogSvd(LogChoice::Offset);
    let of = |method, parametrization, map| SeparableSettings {
        parametrization,
        map,
        resolution: 9,
        rank: (method != Normalized).then_some(3),
        fill: Fill::Zero,
        ..SeparableSettings::of(method)
    };
    let isotropic = |settings| SeparableSettings { isotropic: true, ..settings };
    let joint = |settings| SeparableSettings { joint_rgb: true, ..settings };
    let grey = |settings| SeparableSettings { channels: Some(Channels::Luminance), ..settings };
    let disc = SeparableMap::Orthographic;
    let edge = MerlNodes::Edge;
    vec![
        ("red-plastic", joint(of(Svd, Standard, Polar))),
        ("ggx", of(Eigen(EigenSolver::Krylov), Standard, Parabolic)),
        ("ward", grey(of(Eigen(EigenSolver::Power), Standard, Spherical))),
        ("plastic", grey(isotropic(of(Nmf, Standard, Polar)))),
        ("ward", of(offset, HalfDifference, Parabolic)),
        ("ggx", joint(isotropic(of(offset, HalfDifference, Spherical)))),
        ("red-plastic", of(Nmf, KautzMcCool, Polar)),
        ("red-plastic", isotropic(of(Svd, KautzMcCool, disc))),
        ("ward", of(Normalized, Orthographic, Spherical)),
        ("red-plastic", isotropic(of(Svd, Orthographic, disc))),
        ("ward", of(Svd, Hybrid, disc)),
        ("red-plastic", isotropic(of(LogSvd(LogChoice::Cosine), Hybrid, Polar))),
        ("ward", of(Svd, OnionSlice, Spherical)),
        ("ggx", isotropic(of(offset, OnionSlice, Parabolic))),
        ("ggx", grey(of(Normalized, HalfDifference, Merl))),
        (
            "plastic",
            SeparableSettings { merl_nodes: edge, ..grey(of(Normalized, HalfDifference, Merl)) },
        ),
    ]
}

#[test]
fn every_kind_of_model_is_evaluated_by_numpy_as_by_brdf() {
    let Some(python) = python() else { return };
    let root = TempDir::new().unwrap();
    let folder = root.path();
    write_inputs(folder);
    let products = PRODUCTS.map(|run| {
        // Textures over angles have their size from `--bytes`.
        let size = if run.contains("--angles") { "" } else { " --texture-size 6" };
        format!("{run} --samples 1000{size}")
    });
    // A fit by a basis, which has its own settings, comes after the one that keeps it.
    let with = "preset:ggx --with basis.safetensors".to_owned();
    let mut runs: Vec<String> = products.into_iter().chain([with]).collect();
    let mut models = Vec::new();
    for (index, run) in runs.iter().enumerate() {
        let output = index.to_string();
        let words = ["factor"].into_iter().chain(run.split_whitespace()).chain(["-o", &output]);
        succeed(folder, &words.collect::<Vec<_>>());
        models.push(format!("{index}/model.safetensors"));
    }
    for (preset, settings) in sums() {
        let material = Preset::find(preset).unwrap().brdf();
        let run = format!("{preset}: {settings:?}");
        let settings = FitSettings::Separable(settings);
        let fitted = fit(&Material::new(preset, &material), &settings, &Job::new()).unwrap();
        let Fit::Separable(fitted) = fitted else { unreachable!("a sum was asked for") };
        models.push(format!("sum{}.safetensors", runs.len()));
        let bytes = write_separable(&fitted.model).unwrap();
        fs::write(folder.join(&models[runs.len()]), bytes).unwrap();
        runs.push(run);
    }
    compare_all(&python, folder, "pairs.csv", &runs, &models);
}

/// Splines and lobes. Mirror directions are among the pairs, where the azimuth of the difference vector fades.
#[test]
fn compact_models_are_evaluated_by_numpy_as_by_brdf() {
    let Some(python) = python() else { return };
    let root = TempDir::new().unwrap();
    let folder = root.path();
    write_inputs(folder);
    let pairs = fs::read_to_string(folder.join("pairs.csv")).unwrap();
    // Exactly mirrored; then half vectors within 1e-5 of the normal; then a light beyond 87 degrees.
    let more = "40,10,40,190,0,0,0\n75,-30,75,150,0,0,0\n40,10,40.0003,190,0,0,0\n\
                60,0,60.0005,180.0003,0,0,0\n88,100,70,-80,0,0,0\n";
    fs::write(folder.join("mirrored.csv"), format!("{pairs}{more}")).unwrap();
    let mut runs: Vec<String> = COMPACT.map(str::to_owned).into();
    let mut models = Vec::new();
    for (index, run) in runs.iter().enumerate() {
        let output = index.to_string();
        let words = ["factor"].into_iter().chain(run.split_whitespace()).chain(["-o", &output]);
        succeed(folder, &words.collect::<Vec<_>>());
        models.push(format!("{index}/model.safetensors"));
    }
    for (side, is_mirrored, is_reciprocal) in
        [(Side::Light, true, false), (Side::Left, false, false), (Side::LeftOfLight, false, true)]
    {
        let material = OneSided { plastic: Preset::find("red-plastic").unwrap().brdf(), side };
        let method = CompactMethod::Spline { bytes: 600 };
        let settings = FitSettings::Compact(CompactSettings::of(method));
        let run = format!("{side:?}");
        let fitted = fit(&Material::new(&run, &material), &settings, &Job::new()).unwrap();
        let Fit::Compact(fitted) = fitted else { unreachable!("a compact model was asked for") };
        let CompactBrdf::Spline(model) = &fitted.model.model else { unreachable!("of splines") };
        let symmetry = model.symmetry();
        assert_eq!(symmetry.is_mirrored(), is_mirrored, "{run}");
        assert_eq!(symmetry.is_reciprocal(), is_reciprocal, "{run}");
        models.push(format!("{run}.safetensors"));
        fs::write(folder.join(&models[runs.len()]), write_compact(&fitted.model).unwrap()).unwrap();
        runs.push(run);
    }
    compare_all(&python, folder, "mirrored.csv", &runs, &models);
}

/// Red plastic that is brighter from one side.
struct OneSided {
    plastic: Analytic,
    side: Side,
}

/// What makes a material brighter.
#[derive(Clone, Copy, Debug)]
enum Side {
    /// A light above the viewer: light and viewer cannot be exchanged.
    Light,
    /// A viewer to the left of the light: no symmetry is left.
    Left,
    /// A viewer to the left of a light above it: the mirror image differs.
    LeftOfLight,
}

impl Brdf for OneSided {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        let above = pair.wi.z - pair.wo.z;
        let left = pair.wi.cross(pair.wo).z;
        let side = match self.side {
            Side::Light => above,
            Side::Left => left,
            Side::LeftOfLight => left * above,
        };
        self.plastic.eval(pair) * (1.0 + 0.5 * side)
    }
}

/// The program as a reader runs it, on the largest model of a search and on a smaller one.
#[test]
fn the_documented_program_reads_any_number_of_textures() {
    let Some(python) = python() else { return };
    let root = TempDir::new().unwrap();
    let folder = root.path();
    write_inputs(folder);
    let search = "factor preset:ggx --terms 2 --restarts 1 --space standard --samples 1000 --texture-size 6 --texels";
    for (texels, keep) in [("f32", "1"), ("f32", "2"), ("u8", "1"), ("u8", "2")] {
        let model = &format!("{texels}/model.safetensors");
        if keep == "1" {
            succeed(folder, &search.split(' ').chain([texels, "-o", texels]).collect::<Vec<_>>());
        }
        let kept = &format!("{texels}-{keep}");
        succeed(folder, &["factor", "--from", model, "--keep", keep, "-o", kept]);
        let program = program();
        let arguments = [program.to_str().unwrap(), model, "pairs.csv", "--textures", keep];
        let output = Command::new(&python).args(arguments).current_dir(folder).output().unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        let found = rows(&text(&output.stdout), 0);
        compare(kept, &found, &in_brdf(folder, "pairs.csv", &format!("{kept}/model.safetensors")));
    }
    let model = "f32/model.safetensors";
    fail(folder, &["eval", model, "--directions", "nothing.csv"], 1);
}

fn program() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/evaluate_model.py")
}

/// Pairs up to the horizon and below it, planes, and rows of a material whose green is black.
fn write_inputs(folder: &Path) {
    succeed(
        folder,
        &[
            "sample",
            "preset:red-plastic",
            "-n",
            "300",
            "--max-theta-deg",
            "89.5",
            "-o",
            "pairs.csv",
        ],
    );
    let sampled = fs::read_to_string(folder.join("pairs.csv")).unwrap();
    // The viewer, then the light, along the normal; then below the horizon.
    let more = "30,20,0,0,0,0,0\n0,0,70,200,0,0,0\n100,20,30,40,0,0,0\n30,40,91,20,0,0,0\n";
    fs::write(folder.join("pairs.csv"), format!("{sampled}{more}")).unwrap();
    fs::write(folder.join("rows.csv"), &sampled).unwrap();
    let black: Vec<String> = sampled
        .lines()
        .take(100)
        .enumerate()
        .map(|(index, line)| {
            let mut fields: Vec<&str> = line.split(',').collect();
            if index > 0 {
                fields[5] = "0";
            }
            fields.join(",")
        })
        .collect();
    fs::write(folder.join("black.csv"), black.join("\n")).unwrap();
    let planes = "projections = [[[1,0,1,0],[0,1,0,1]], [[0.3,-0.8,0.1,0.4],[0.9,0.2,-0.5,0.1]]]";
    fs::write(folder.join("planes.toml"), planes).unwrap();
    // What no choice of angles has, and textures of other coordinates beside them.
    let angles = r#"
        [[factors]]
        coordinates = [{ kind = "isotropic", axes = [
            { angle = "theta-h", spacing = { kind = "asinh", alpha = 0.05 } }, { angle = "theta-d" }] }]
        grid = { columns = 12, rows = 7 }
        [[factors]]
        coordinates = [{ kind = "isotropic", axes = [{ angle = "theta-i" }, { angle = "delta-phi" }] },
            { kind = "isotropic", axes = [{ angle = "theta-i" }, { angle = "delta-phi" }], swapped = true }]
        grid = { columns = 6, rows = 9 }
        [[factors]]
        coordinates = [{ kind = "isotropic", axes = [{ angle = "phi-d" }, { angle = "theta-d" }] }]
        grid = { columns = 6, rows = 5 }
        [[factors]]
        coordinates = [{ kind = "h" }]
        grid = { columns = 6, rows = 6 }
    "#;
    fs::write(folder.join("angles.toml"), angles).unwrap();
}

/// Holds the values of every model, at a table of pairs, by NumPy and by `brdf` together.
fn compare_all(python: &str, folder: &Path, pairs: &str, runs: &[String], models: &[String]) {
    let found = in_numpy(python, folder, pairs, models);
    assert_eq!(found.len(), runs.len(), "one set of values for each model");
    for ((run, model), found) in runs.iter().zip(models).zip(&found) {
        compare(run, found, &in_brdf(folder, pairs, model));
    }
}

/// Values of every model at all pairs, by one run of Python.
fn in_numpy(python: &str, folder: &Path, pairs: &str, models: &[String]) -> Vec<Vec<[f64; 3]>> {
    let script = "import sys, pathlib\n\
                  sys.dont_write_bytecode = True\n\
                  sys.path.insert(0, str(pathlib.Path(sys.argv[1]).parent))\n\
                  from evaluate_model import Model, read_pairs\n\
                  pairs = read_pairs(sys.argv[2])\n\
                  for name in sys.argv[3:]:\n    \
                  value = Model(name).evaluate(*pairs)\n    \
                  print('model')\n    \
                  for row in value:\n        \
                  print(*(float(row[c % len(row)]) for c in range(3)), sep=',')\n";
    let output = Command::new(python)
        .args(["-c", script])
        .arg(program())
        .arg(pairs)
        .args(models)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
        .split("model\n")
        .skip(1)
        .map(|part| rows(&format!("\n{part}"), 0))
        .collect()
}

fn in_brdf(folder: &Path, pairs: &str, model: &str) -> Vec<[f64; 3]> {
    rows(&succeed(folder, &["eval", model, "--directions", pairs]), 4)
}

/// Three numbers of every line but the first, after `skip` others.
fn rows(table: &str, skip: usize) -> Vec<[f64; 3]> {
    let numbers = |line: &str| {
        let values: Vec<f64> = line.split(',').skip(skip).map(|v| v.parse().unwrap()).collect();
        values.try_into().unwrap()
    };
    table.lines().skip(1).map(numbers).collect()
}

fn compare(run: &str, found: &[[f64; 3]], expected: &[[f64; 3]]) {
    assert_eq!(found.len(), expected.len(), "{run}");
    let mean = expected.iter().flatten().sum::<f64>() / (3 * expected.len()) as f64;
    assert!(mean > 1e-3, "{run}: all black");
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        for (f, e) in found.iter().zip(expected) {
            // Terms of both signs cancel in single precision.
            let allowed = 1e-5 * e.abs() + 1e-6 * mean;
            assert!(
                (f - e).abs() <= allowed,
                "{run}, pair {index}: {found:?} against {expected:?}"
            );
        }
    }
}
