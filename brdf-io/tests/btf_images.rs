//! Folders and archives of images: what is written is read, and what is wrong is named.
#![expect(clippy::unwrap_used, reason = "helpers of tests; the lint knows test functions only")]

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use brdf_io::{Btf, BtfImages, BtfInput, LoadedBtf, open_btf};
use btf_vq::{BtfSource as _, Encoding};

const WIDTH: usize = 20;
const HEIGHT: usize = 9;
/// Views and lights in degrees, in the order in which a set sorts them.
const DIRECTIONS: [(u32, u32); 4] = [(0, 0), (15, 0), (15, 60), (30, 330)];

/// Any picture that differs between images and has no two equal texels in a row or column.
fn texels(view: usize, light: usize) -> Vec<u8> {
    (0..WIDTH * HEIGHT)
        .flat_map(|texel| [texel, 17 * view + texel / 3, 31 * light + texel / WIDTH])
        .map(|value| u8::try_from(value % 256).unwrap())
        .collect()
}

fn png(width: usize, height: usize, texels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let sides = [width, height].map(|side| u32::try_from(side).unwrap());
    let mut encoder = png::Encoder::new(&mut bytes, sides[0], sides[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header().unwrap().write_image_data(texels).unwrap();
    bytes
}

/// Name and content of each file, named as UBO2003 does: a folder for each view, a counter that
/// says nothing.
fn ubo_files() -> Vec<(String, Vec<u8>)> {
    let mut files = vec![("MANYFILES/readme.txt".to_owned(), b"about".to_vec())];
    for (view, (tv, pv)) in DIRECTIONS.iter().enumerate() {
        for (light, (tl, pl)) in DIRECTIONS.iter().enumerate() {
            let counter = 15 - light;
            let name = format!(
                "MANYFILES/tv{tv:03}_pv{pv:03}/{counter:05} tl{tl:03} pl{pl:03} tv{tv:03} pv{pv:03}.png"
            );
            files.push((name, png(WIDTH, HEIGHT, &texels(view, light))));
        }
    }
    files
}

fn write_folder(root: &Path, files: &[(String, Vec<u8>)]) {
    for (name, bytes) in files {
        let path = root.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

fn zipped(files: &[(String, Vec<u8>)]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

fn images(input: BtfInput) -> BtfImages {
    let BtfInput::Images(images) = input else { panic!("images") };
    images
}

fn load(input: &BtfInput) -> LoadedBtf {
    let Btf::Images(loaded) = input.load(usize::MAX, &|_| ()).unwrap() else { panic!("images") };
    loaded
}

/// What opening or loading a folder of files says.
fn refusal(files: &[(String, Vec<u8>)]) -> String {
    let folder = tempfile::tempdir().unwrap();
    write_folder(folder.path(), files);
    let message = match open_btf(folder.path()) {
        Err(error) => error.to_string(),
        Ok(input) => input.load(usize::MAX, &|_| ()).unwrap_err().to_string(),
    };
    assert!(!message.contains('\n'), "{message}");
    message
}

#[test]
fn folders_and_archives_hold_the_same() {
    let folder = tempfile::tempdir().unwrap();
    write_folder(folder.path(), &ubo_files());
    let archive = folder.path().join("wool.zip");
    fs::write(&archive, zipped(&ubo_files())).unwrap();
    for path in [folder.path().join("MANYFILES"), archive] {
        let input = open_btf(&path).unwrap();
        let layout = input.layout();
        assert_eq!((layout.width, layout.height), (WIDTH, HEIGHT), "size");
        assert_eq!((layout.encoding, layout.cosine_included), (Encoding::Srgb, true), "meaning");
        assert_eq!(layout.views.len(), 4, "views");
        let loaded = load(&input);
        for (view, (tv, pv)) in DIRECTIONS.iter().enumerate() {
            let (theta, phi) = (f64::from(*tv).to_radians(), f64::from(*pv).to_radians());
            let wo = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
            assert!(layout.views[view].wo.distance(wo.into()) < 1e-12, "view {view}");
            for light in 0..4 {
                assert_eq!(loaded.image_rgb8(4 * view + light).unwrap(), texels(view, light));
            }
        }
        let notes = images(input).notes().clone();
        assert_eq!((notes.missing, notes.foreign_files.len()), (0, 1), "{notes:?}");
    }
}

#[test]
fn blocks_are_the_texels_of_all_images_in_memory_and_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    write_folder(folder.path(), &ubo_files());
    let input = open_btf(folder.path()).unwrap();
    let done = AtomicU64::new(0);
    let count = |n| {
        done.fetch_add(n, Ordering::Relaxed);
    };
    for memory_limit in [usize::MAX, 0] {
        let loaded = input.load(memory_limit, &count).unwrap();
        for range in [0..64, 64..128, 128..180, 0..180, 50..130, 7..7] {
            let mut out = vec![-1.0; 16 * 3 * range.len()];
            loaded.read_texels(range.clone(), &mut out).unwrap();
            let expected: Vec<f32> = (0..16)
                .flat_map(|i| texels(i / 4, i % 4)[3 * range.start..3 * range.end].to_vec())
                .map(|byte| f32::from(byte) / 255.0)
                .collect();
            assert!(out == expected, "texels {range:?}");
        }
    }
    assert_eq!(done.into_inner(), 32, "every image is counted once for each loading");
}

#[test]
fn missing_and_moved_images_are_noted() {
    let mut files = ubo_files();
    files.retain(|(name, _)| !name.contains("tl015 pl060 tv015 pv000"));
    for (name, _) in &mut files {
        *name = name.replace("tl030 pl330 tv030 pv330", "tl035 pl330 tv030 pv330");
    }
    let folder = tempfile::tempdir().unwrap();
    write_folder(folder.path(), &files);
    let input = images(open_btf(folder.path()).unwrap());
    let notes = input.notes();
    assert_eq!(notes.missing, 1, "{notes:?}");
    assert!(notes.off_table_lights.len() == 1 && notes.off_table_lights[0].contains("tl035"));
    assert_eq!(input.layout().image_count(), 15);
}

#[test]
fn names_that_contradict_each_other_are_refused() {
    let base = ubo_files();
    let with = |name: &str| [base.clone(), vec![(name.to_owned(), base[1].1.clone())]].concat();
    for (name, words) in [
        ("b/tl0 pl0 tv0 pv0.png", ["tl000 pl000 tv000 pv000", "b/tl0 pl0 tv0 pv0"]),
        ("tl010 pl000 tv000.png", ["tl010 pl000 tv000.png", "only tl, pl, tv"]),
        ("tl095 pl000 tv000 pv000.png", ["tl095", "95°"]),
    ] {
        let message = refusal(&with(name));
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
}

#[test]
fn sets_that_are_too_small_are_refused() {
    for (key, word) in [("tv0", "2 views"), ("tl0", "2 lights of the view at (0°, 0°)")] {
        let mut files = ubo_files();
        files.retain(|(name, _)| {
            name.contains(&format!("{key}00")) || name.contains(&format!("{key}30"))
        });
        let message = refusal(&files);
        assert!(message.contains(word) && message.contains("at least 3"), "{message}");
    }
    let message = refusal(&ubo_files()[..1]);
    assert!(message.contains("no BTF in 1 files"), "{message}");
}

#[test]
fn images_unlike_the_others_are_refused_by_name() {
    let mut sizes = ubo_files();
    sizes[7].1 = png(HEIGHT, WIDTH, &texels(0, 0));
    let message = refusal(&sizes);
    let first = "tl000 pl000 tv000 pv000";
    assert!(message.contains("9 × 20") && message.contains("20 × 9"), "{message}");
    assert!(message.contains(&sizes[7].0[20..]) && message.contains(first), "{message}");

    let mut corrupt = ubo_files();
    let length = corrupt[9].1.len();
    corrupt[9].1.truncate(length - 20);
    let message = refusal(&corrupt);
    assert!(message.contains(&corrupt[9].0) && message.contains("PNG"), "{message}");

    let mut text = ubo_files();
    text[9].1 = b"not an image".to_vec();
    let message = refusal(&text);
    assert!(message.contains(&text[9].0) && message.contains("not an image"), "{message}");
}
