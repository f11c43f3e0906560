//! Binary BTFs: files built from known factors give the values of their products.
#![expect(clippy::unwrap_used, reason = "helpers of tests; the lint knows test functions only")]

use brdf_files::MappedFile;
use brdf_io::FormatError;
use brdf_job::Job;
use btf_io::{Btf, BtfFile, open_btf};
use btf_vq::{BtfSource as _, Encoding};
use half::f16;

const VIEWS: usize = 3;
const LIGHTS: usize = 4;
const IMAGES: usize = VIEWS * LIGHTS;
const WIDTH: usize = 5;
const HEIGHT: usize = 2;
const TEXELS: usize = WIDTH * HEIGHT;
const COMPONENTS: usize = 2;

fn count(value: usize) -> [u8; 4] {
    u32::try_from(value).unwrap().to_le_bytes()
}

/// What is said about the measurement, for a version of it.
fn measurement(version: usize, cosine: bool) -> Vec<u8> {
    let mut rest = [count(version).to_vec(), vec![b' '; 240], vec![0; 16]].concat();
    if version > 1 {
        rest.extend(count(usize::from(cosine)));
    }
    if version > 2 {
        rest.extend([count(6).as_slice(), b"<xml/>"].concat());
    }
    if version > 3 {
        rest.extend(count(3));
        ["R", "G", "B"].iter().for_each(|c| rest.extend([&count(1), c.as_bytes()].concat()));
    }
    [count(rest.len() + 4).to_vec(), rest].concat()
}

/// Polar angle and azimuth of a direction.
fn angles(number: usize) -> [f32; 2] {
    [0.3 * f32::from(u8::try_from(number).unwrap()), 0.5]
}

fn directions() -> Vec<u8> {
    let direction = |number| angles(number).map(f32::to_le_bytes).concat();
    let mut bytes = count(VIEWS).to_vec();
    for view in 0..VIEWS {
        bytes.extend(direction(view));
        bytes.extend(count(LIGHTS));
        (0..LIGHTS).for_each(|light| bytes.extend(direction(light)));
    }
    bytes
}

/// All that stands before what a kind of file adds.
fn head(signature: &str, version: usize, frames: Option<usize>) -> Vec<u8> {
    let mut bytes = [
        signature.as_bytes().to_vec(),
        measurement(version, true),
        directions(),
        count(WIDTH).to_vec(),
        count(HEIGHT).to_vec(),
    ]
    .concat();
    if let Some(frames) = frames {
        bytes.extend(count(frames));
        bytes.extend(vec![0; 36 * frames]);
    }
    bytes
}

/// Sixteenths, which all sizes of numbers hold.
fn number(value: usize) -> f32 {
    f32::from(u16::try_from(value % 11).unwrap()) / 16.0
}

/// Factors of an image or texel for a channel: exact in half precision.
fn image_factor(image: usize, channel: usize) -> [f32; COMPONENTS] {
    [number(image + 3 * channel), number(2 * image + channel)]
}

fn texel_factor(texel: usize, channel: usize) -> [f32; COMPONENTS] {
    [number(3 * texel + channel), number(texel + 5 * channel)]
}

fn product(image: usize, texel: usize, channel: usize, texel_channel: usize) -> f32 {
    let (a, b) = (image_factor(image, channel), texel_factor(texel, texel_channel));
    a[0] * b[0] + a[1] * b[1]
}

fn scalars(size: u8, values: &[f32]) -> Vec<u8> {
    match size {
        2 => values.iter().flat_map(|v| f16::from_f32(*v).to_le_bytes()).collect(),
        4 => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        _ => values.iter().flat_map(|v| f64::from(*v).to_le_bytes()).collect(),
    }
}

fn pair(size: u8, rows: &[f32], columns: &[f32]) -> Vec<u8> {
    [
        vec![size],
        count(COMPONENTS).to_vec(),
        count(rows.len() / COMPONENTS).to_vec(),
        count(columns.len() / COMPONENTS).to_vec(),
        scalars(size, &[1.0; COMPONENTS]),
        scalars(size, rows),
        scalars(size, columns),
    ]
    .concat()
}

/// A file of factors channel by channel, rows for images or for texels.
fn decorrelated(model: i32, size: u8, transposed: bool) -> Vec<u8> {
    let mut bytes = head("!DFMF08FCR", 4, Some(2));
    bytes.extend(count(COMPONENTS));
    bytes.extend(model.to_le_bytes());
    bytes.extend([0; 48]);
    for channel in 0..3 {
        let images: Vec<f32> = (0..IMAGES).flat_map(|i| image_factor(i, channel)).collect();
        let texels: Vec<f32> = (0..TEXELS).flat_map(|t| texel_factor(t, channel)).collect();
        let (rows, columns) = if transposed { (texels, images) } else { (images, texels) };
        bytes.extend(pair(size, &rows, &columns));
    }
    bytes
}

/// A file of factors whose rows alternate between channels.
fn joint(signature: &str, size: u8, transposed: bool, logarithms: bool) -> Vec<u8> {
    let mut bytes = head(signature, 3, signature.ends_with('R').then_some(0));
    if signature.ends_with("CER") {
        bytes.push(2);
        bytes.extend(count(usize::from(logarithms)));
        bytes.extend([count(2), count(3)].concat());
        bytes.extend([0; 12]);
    }
    bytes.extend(count(COMPONENTS));
    let both = |sides: usize, factor: fn(usize, usize) -> [f32; 2], channels: usize| -> Vec<f32> {
        (0..channels * sides).flat_map(|row| factor(row / channels, row % channels)).collect()
    };
    bytes.extend(if transposed {
        pair(size, &both(TEXELS, texel_factor, 3), &both(IMAGES, image_factor, 1))
    } else {
        pair(size, &both(IMAGES, image_factor, 3), &both(TEXELS, texel_factor, 1))
    });
    bytes
}

/// A file of all values, with or without the texels of the first line's middle.
fn texels(packing: u8, absent: &[usize], lines: usize) -> Vec<u8> {
    let mut bytes = head("!BDIF06R2!", 2, None);
    bytes.extend(count(lines));
    bytes.push(packing);
    bytes.extend((0..TEXELS).map(|texel| u8::from(!absent.contains(&texel))));
    bytes.extend(count(0));
    let stored: Vec<usize> =
        (0..TEXELS).filter(|texel| packing == 0 || !absent.contains(texel)).collect();
    for chunk in stored.chunks(lines * WIDTH) {
        bytes.extend(count(chunk.len() * IMAGES * 6));
        for texel in chunk {
            for image in 0..IMAGES {
                let values = [0, 1, 2].map(|channel| number(7 * texel + 3 * image + channel));
                bytes.extend(scalars(2, &values));
            }
        }
    }
    bytes
}

fn open(bytes: &[u8]) -> Result<BtfFile, FormatError> {
    BtfFile::new(MappedFile::from(bytes.to_vec()))
}

/// Reads all texels, in one go and in two, and compares with what they should be.
fn check(bytes: &[u8], expected: impl Fn(usize, usize, usize) -> f32) {
    let file = open(bytes).unwrap();
    for range in [0..TEXELS, 0..3, 3..TEXELS] {
        let mut out = vec![f32::NAN; 3 * IMAGES * range.len()];
        file.read_texels(range.clone(), &mut out).unwrap();
        for (at, value) in out.iter().enumerate() {
            let (image, texel) = (at / 3 / range.len(), range.start + at / 3 % range.len());
            let expected = expected(image, texel, at % 3);
            assert!(
                (value - expected).abs() <= 1e-5,
                "image {image}, texel {texel}: {value} for {expected}"
            );
        }
    }
}

#[test]
fn factors_of_each_channel_are_multiplied() {
    for size in [2, 4, 8] {
        for transposed in [false, true] {
            check(&decorrelated(0, size, transposed), |image, texel, channel| {
                product(image, texel, channel, channel)
            });
        }
    }
}

#[test]
fn colour_models_are_undone() {
    check(&decorrelated(12, 4, false), |image, texel, channel| {
        product(image, texel, channel, channel).exp() - 1e-5
    });
    // Luma as a logarithm, chroma relative to it; green falls below zero and is cut.
    check(&decorrelated(11, 2, false), |image, texel, channel| {
        let [y, u, v] = [0, 1, 2].map(|c| product(image, texel, c, c));
        let rgb = [1.0 + 1.139_83 * v, 1.0 - 0.394_65 * u - 0.5806 * v, 1.0 + 2.032_11 * u];
        (y.exp() * rgb[channel] - 1e-5).max(0.0)
    });
}

#[test]
fn joint_factors_are_multiplied() {
    for signature in ["!FMF12FCER", "!FMF06FCR", "!FMF06FC"] {
        check(&joint(signature, 2, false, false), |image, texel, channel| {
            product(image, texel, channel, 0)
        });
        check(&joint(signature, 4, true, false), |image, texel, channel| {
            product(image, texel, 0, channel)
        });
    }
    check(&joint("!FMF12FCER", 4, false, true), |image, texel, channel| {
        product(image, texel, channel, 0).exp() - 1e-5
    });
}

#[test]
fn stored_texels_are_read_and_absent_ones_are_black() {
    let value =
        |image: usize, texel: usize, channel: usize| number(7 * texel + 3 * image + channel);
    for lines in [1, 2, 7] {
        check(&texels(0, &[2], lines), value);
        check(&texels(2, &[], lines), value);
        check(&texels(2, &[1, 2, 8], lines), |image, texel, channel| {
            if [1, 2, 8].contains(&texel) { 0.0 } else { value(image, texel, channel) }
        });
    }
    assert_eq!(open(&texels(2, &[1, 2, 8], 1)).unwrap().absent_texels(), 3);
}

#[test]
fn directions_and_meaning_are_those_of_the_head() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("felt.btf");
    std::fs::write(&path, decorrelated(0, 2, false)).unwrap();
    let Btf::File(file) = open_btf(&path).unwrap().load(0, &Job::new()).unwrap() else {
        panic!("a file")
    };
    let layout = file.layout();
    assert_eq!((layout.width, layout.height, layout.image_count()), (WIDTH, HEIGHT, IMAGES));
    assert_eq!((layout.encoding, layout.cosine_included), (Encoding::Linear, true));
    let [theta, phi] = angles(2).map(f64::from);
    let expected = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
    assert!(layout.views[2].wo.distance(expected.into()) < 1e-6, "view");
    assert!(layout.views[1].lights[2].distance(expected.into()) < 1e-6, "light");
    let unmarked = head("!FMF06FC", 1, None);
    assert!(
        open(
            &[
                unmarked,
                joint("!FMF06FC", 2, false, false)[head("!FMF06FC", 3, None).len()..].to_vec()
            ]
            .concat()
        )
        .is_ok_and(|file| !file.layout().cosine_included)
    );
}

#[test]
fn what_is_not_read_is_refused_by_name() {
    let mut other_lights = decorrelated(0, 2, false);
    // The azimuth of the last light of the second view.
    let at = 10 + measurement(4, true).len() + 4 + 2 * (12 + 8 * LIGHTS) - 4;
    other_lights[at] ^= 1;
    let long = [decorrelated(0, 2, false), vec![0]].concat();
    let mut pvf = decorrelated(0, 2, false);
    pvf.splice(..10, *b"!PVF06FCR");
    for (bytes, words) in [
        (texels(1, &[], 1), "1 (bzip)"),
        (decorrelated(6, 2, false), "the colour model is 6"),
        (decorrelated(0, 3, false), "the size of numbers is 3"),
        (other_lights, "the same lights for all views"),
        (long, "expected"),
        (pvf, "!PVF06FCR"),
    ] {
        let message = open(&bytes).unwrap_err().to_string();
        assert!(message.contains(words) && !message.contains('\n'), "{message}");
    }
    // Infinite factors are found where they are used.
    let mut infinite = decorrelated(0, 4, false);
    let end = infinite.len();
    infinite[end - 4..].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let file = open(&infinite).unwrap();
    let mut out = vec![0.0; 3 * IMAGES * TEXELS];
    let message = file.read_texels(0..TEXELS, &mut out).unwrap_err().to_string();
    assert!(message.contains("column 4, row 1"), "{message}");
}

#[test]
fn cut_and_damaged_files_are_read_or_refused() {
    for bytes in [
        decorrelated(11, 2, false),
        joint("!FMF12FCER", 4, true, true),
        joint("!FMF06FC", 8, false, false),
        texels(2, &[1, 2, 8], 1),
    ] {
        open(&bytes).unwrap();
        for length in 0..bytes.len() {
            assert!(open(&bytes[..length]).is_err(), "cut at {length}");
        }
        for at in 0..bytes.len() {
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                let Ok(file) = open(&damaged) else { continue };
                let count = file.layout().texel_count().min(7);
                let mut out = vec![0.0; 3 * file.layout().image_count() * count];
                let _ = file.read_texels(0..count, &mut out);
            }
        }
    }
}
