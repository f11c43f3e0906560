//! Packs images into a ZIP archive, opens it as a BTF and prints what is in it and what is unusual.
//!
//! `cargo run --release -p btf-io --example archive`
#![allow(clippy::print_stdout, reason = "an example")]

use std::io::Write as _;

use brdf_image::{DisplayImage, encode_png};
use brdf_job::Job;
use btf_io::open_btf;
use btf_vq::BtfSource as _;

const DIRECTIONS: [(u8, u16); 4] = [(0, 0), (30, 0), (30, 120), (60, 240)];

fn main() -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("felt.zip");
    let mut archive = zip::ZipWriter::new(std::fs::File::create(&path)?);
    for (tv, pv) in DIRECTIONS {
        for (tl, pl) in DIRECTIONS {
            let mut picture = DisplayImage::filled(16, 16, [240 - 2 * tl - tv, 90, 60]);
            picture.paste(&DisplayImage::filled(8, 16, [60, 90, 240 - 2 * tl - tv]), 0, 0);
            let name = format!("tv{tv:03}_pv{pv:03}/tl{tl:03} pl{pl:03} tv{tv:03} pv{pv:03}.png");
            archive.start_file(name, zip::write::SimpleFileOptions::default())?;
            archive.write_all(&encode_png(&picture)?)?;
        }
    }
    archive.start_file("readme.txt", zip::write::SimpleFileOptions::default())?;
    archive.finish()?;

    let input = open_btf(&path)?;
    let layout = input.layout();
    println!("{} × {} texels, {} images", layout.width, layout.height, layout.image_count());
    if let Some(notes) = input.notes() {
        println!("{} missing; not images: {}", notes.missing, notes.foreign_files.join(", "));
    }
    let btf = input.load(64 << 20, &Job::new())?;
    let mut texel = vec![0.0; 3 * layout.image_count()];
    btf.read_texels(0..1, &mut texel)?;
    println!("the first texel in all images, blue:");
    for (images, view) in texel.chunks_exact(3 * DIRECTIONS.len()).zip(&layout.views) {
        let blue: Vec<String> =
            images.chunks_exact(3).map(|rgb| format!("{:.3}", rgb[2])).collect();
        println!("  seen from {:.2}: {}", view.wo, blue.join(" "));
    }
    Ok(())
}
