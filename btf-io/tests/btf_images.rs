//! Folders and archives of images: what is written is read, and what is wrong is named.
#![expect(clippy::unwrap_used, reason = "helpers of tests; the lint knows test functions only")]

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use brdf_files::MappedFile;
use brdf_image::encode_exr;
use brdf_job::{Job, Progress};
use btf_io::{Btf, BtfImages, BtfInput, LoadedBtf, open_btf, read_btf_image};
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
    let Btf::Images(loaded) = input.load(usize::MAX, &Job::new()).unwrap() else {
        panic!("images")
    };
    loaded
}

/// What opening or loading a folder of files says.
fn refusal(files: &[(String, Vec<u8>)]) -> String {
    let folder = tempfile::tempdir().unwrap();
    write_folder(folder.path(), files);
    let message = match open_btf(folder.path()) {
        Err(error) => error.to_string(),
        Ok(input) => input.load(usize::MAX, &Job::new()).unwrap_err().to_string(),
    };
    assert!(!message.contains('\n'), "{message}");
    message
}

/// A whole image.
fn image(btf: &LoadedBtf, at: usize) -> Vec<f32> {
    let mut values = vec![0.0; 3 * btf.layout().texel_count()];
    btf.read_image(at, &mut values).unwrap();
    values
}

/// A whole display-referred image in bytes.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "these were bytes")]
fn rgb8(btf: &LoadedBtf, at: usize) -> Vec<u8> {
    image(btf, at).iter().map(|v| (v * 255.0).round() as u8).collect()
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
                assert_eq!(rgb8(&loaded, 4 * view + light), texels(view, light));
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
    let watch = |progress: &Progress<'_>| {
        done.fetch_max(progress.done, Ordering::Relaxed);
    };
    for memory_limit in [usize::MAX, 0] {
        done.store(0, Ordering::Relaxed);
        let loaded = input.load(memory_limit, &Job::watched_by(&watch)).unwrap();
        assert_eq!(done.load(Ordering::Relaxed), 16, "every image is counted once");
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

fn jpeg(width: usize, height: usize, texels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let [width, height] = [width, height].map(|side| u16::try_from(side).unwrap());
    jpeg_encoder::Encoder::new(&mut bytes, 95)
        .encode(texels, width, height, jpeg_encoder::ColorType::Rgb)
        .unwrap();
    bytes
}

/// An uncoded Radiance picture of powers of two, whose lines are columns from the bottom up.
fn radiance(view: usize, light: usize) -> Vec<u8> {
    let mut bytes =
        format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n+X {WIDTH} +Y {HEIGHT}\n").into_bytes();
    for column in 0..WIDTH {
        for row in (0..HEIGHT).rev() {
            let exponent = 120 + (column + 3 * row + 2 * view + light) % 16;
            bytes.extend([128, 64, 0, u8::try_from(exponent).unwrap()]);
        }
    }
    bytes
}

fn radiance_value(texel: usize, view: usize, light: usize) -> [f32; 3] {
    let exponent = (texel % WIDTH + 3 * (texel / WIDTH) + 2 * view + light) % 16;
    let value = 2.0_f32.powi(i32::try_from(exponent).unwrap() - 9);
    [value, value / 2.0, 0.0]
}

/// Files named as UTIA does, each made from the number of its view and its light.
fn utia_files(make: impl Fn(usize, usize) -> Vec<u8>) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for (view, (tv, pv)) in DIRECTIONS.iter().enumerate() {
        for (light, (tl, pl)) in DIRECTIONS.iter().enumerate() {
            let name =
                format!("tv{tv:03}_pv{pv:03}/tl{tl:03}_pl{pl:03}.0_tv{tv:03}_pv{pv:03}.image");
            files.push((name, make(view, light)));
        }
    }
    files
}

fn loaded(files: &[(String, Vec<u8>)]) -> LoadedBtf {
    let folder = tempfile::tempdir().unwrap();
    write_folder(folder.path(), files);
    load(&open_btf(folder.path()).unwrap())
}

#[test]
fn jpeg_images_are_read() {
    let smooth = |view: usize, light: usize| -> Vec<u8> {
        let value = |texel: usize| 40 + 5 * (texel % WIDTH) + 10 * view + light;
        (0..WIDTH * HEIGHT).flat_map(|t| [u8::try_from(value(t)).unwrap(); 3]).collect()
    };
    let btf = loaded(&utia_files(|view, light| jpeg(WIDTH, HEIGHT, &smooth(view, light))));
    for image in 0..16 {
        let found = rgb8(&btf, image);
        let expected = smooth(image / 4, image % 4);
        assert!(found.iter().zip(&expected).all(|(a, b)| a.abs_diff(*b) <= 3), "image {image}");
    }
}

#[test]
fn linear_images_are_read_in_half_precision() {
    let btf = loaded(&utia_files(radiance));
    assert_eq!((btf.layout().encoding, btf.negative_values()), (Encoding::Linear, 0));
    for range in [0..64, 100..180] {
        let mut out = vec![0.0; 16 * 3 * range.len()];
        btf.read_texels(range.clone(), &mut out).unwrap();
        let expected: Vec<f32> = (0..16)
            .flat_map(|i| range.clone().flat_map(move |t| radiance_value(t, i / 4, i % 4)))
            .collect();
        assert!(out == expected, "texels {range:?}");
    }
}

#[test]
fn exr_images_of_xyz_become_rgb_and_colours_below_zero_are_counted() {
    let channels = |xyz: [f32; 3]| {
        let named = ["X", "Y", "Z"].into_iter().zip(xyz);
        let planes: Vec<(&str, Vec<f32>)> = named.map(|(n, v)| (n, vec![v; 6])).collect();
        encode_exr(3, 2, &planes).unwrap()
    };
    let btf = loaded(&utia_files(|_, _| channels([0.950_47, 1.0, 1.088_83])));
    assert!(image(&btf, 3).iter().all(|value| (value - 1.0).abs() < 1e-3));
    // Green light of one wavelength lies outside of what red, green and blue can mix.
    let btf = loaded(&utia_files(|_, _| channels([0.2, 1.0, 0.1])));
    assert_eq!(btf.negative_values(), 2 * 6 * 16);
    assert!(image(&btf, 3).iter().all(|&value| value >= 0.0));

    let planes = ["450", "550", "650"].map(|name| (name, vec![1.0; 6]));
    let message = refusal(&utia_files(|_, _| encode_exr(3, 2, &planes).unwrap()));
    assert!(message.contains("450, 550, 650"), "{message}");
}

#[test]
fn unusable_values_are_refused_with_their_place() {
    let planes = ["R", "G", "B"].map(|name| (name, vec![1.0, 1.0, 1.0, 1.0, f32::INFINITY, 1.0]));
    let mut files = utia_files(|_, _| encode_exr(3, 2, &planes).unwrap());
    let message = refusal(&files);
    assert!(message.contains("column 1, row 1") && message.contains("inf (3"), "{message}");
    // Linear images and others do not mix, whether their extensions tell or not.
    for name in ["tl75 pl0 tv0 pv0.image", "tl75 pl0 tv0 pv0.hdr"] {
        files = utia_files(|view, light| png(WIDTH, HEIGHT, &texels(view, light)));
        files.push((name.to_owned(), radiance(0, 0)));
        let message = refusal(&files);
        assert!(message.contains(name) && message.contains("8-bit"), "{message}");
    }
}

#[test]
fn wide_and_transparent_png_images_are_narrowed_or_refused() {
    let encode = |color, depth, data: &[u8]| {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    };
    for (color, depth, data, expected) in [
        (png::ColorType::Rgb, png::BitDepth::Sixteen, &[255, 255, 1, 0, 0, 127][..], [255, 1, 0]),
        (png::ColorType::Grayscale, png::BitDepth::Eight, &[7], [7, 7, 7]),
        (png::ColorType::Grayscale, png::BitDepth::One, &[128], [255, 255, 255]),
        (png::ColorType::Rgba, png::BitDepth::Eight, &[1, 2, 3, 255], [1, 2, 3]),
    ] {
        let btf = loaded(&utia_files(|_, _| encode(color, depth, data)));
        assert_eq!(rgb8(&btf, 0), expected, "{color:?}");
    }
    let glass = encode(png::ColorType::Rgba, png::BitDepth::Eight, &[1, 2, 3, 254]);
    assert!(refusal(&utia_files(|_, _| glass.clone())).contains("transparent"));
}

#[test]
fn archives_with_a_password_and_lying_sizes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wool.zip");
    // Flags and sizes stand at fixed places behind the signature of each entry in the list.
    for (at, value, word) in [(8, 0x01, "encrypted"), (27, 0x7f, "more than")] {
        let mut bytes = zipped(&ubo_files());
        let mut place = 0;
        while let Some(next) = bytes[place..].windows(4).position(|w| w == b"PK\x01\x02") {
            place += next;
            bytes[place + at] |= value;
            place += 4;
        }
        fs::write(&path, bytes).unwrap();
        let message = open_btf(&path).unwrap_err().to_string();
        assert!(message.contains(word) && message.contains("tl000 pl000"), "{message}");
    }
}

/// One small image of each kind.
fn kinds() -> [Vec<u8>; 5] {
    let planes = ["R", "G", "B"].map(|name| (name, vec![0.5; WIDTH * HEIGHT]));
    let mut coded = b"#?RADIANCE\nEXPOSURE=1.5\n\n-Y 2 +X 8\n".to_vec();
    coded.extend([2, 2, 0, 8, 136, 9, 136, 8, 4, 1, 2, 3, 4, 132, 7, 136, 130]);
    coded.extend([5, 6, 7, 130, 1, 1, 1, 3, 5, 6, 7, 130, 1, 1, 1, 3]);
    [
        png(WIDTH, HEIGHT, &texels(0, 0)),
        jpeg(WIDTH, HEIGHT, &texels(0, 0)),
        radiance(0, 0),
        coded,
        encode_exr(WIDTH, HEIGHT, &planes).unwrap(),
    ]
}

#[test]
fn cut_and_damaged_images_are_read_or_refused() {
    for bytes in kinds() {
        read_btf_image(&bytes).unwrap();
        for length in 0..bytes.len() {
            // A JPEG may lack its last marker, a PNG its last chunk.
            let outcome = read_btf_image(&bytes[..length]);
            assert!(outcome.is_err() || length + 12 >= bytes.len(), "cut at {length}");
        }
        for at in 0..bytes.len().min(4_000) {
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                let _ = read_btf_image(&damaged);
            }
        }
    }
}

#[test]
fn cut_and_damaged_archives_are_read_or_refused() {
    let files = utia_files(|view, light| png(1, 1, &texels(view, light)[..3]));
    let bytes = zipped(&files);
    let read = |bytes: &[u8]| {
        let bytes = MappedFile::from(bytes.to_vec());
        let images = BtfImages::in_archive(Path::new("btf.zip"), bytes)?;
        images.load(1 << 20, &Job::new())
    };
    read(&bytes).unwrap();
    for length in (0..bytes.len()).step_by(7) {
        assert!(read(&bytes[..length]).is_err(), "cut at {length}");
    }
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x81;
        let _ = read(&damaged);
    }
}
