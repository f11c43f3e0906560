//! Compressed BTFs: what was written is read, what is broken is refused.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::sync::Arc;

use brdf_container::{read_btf, write_btf};
use brdf_files::MappedFile;
use brdf_model::DirectionSampler as _;
use btf_vq::{
    AngularGrid, BtfModel, BtfRecord, Chroma, Codebooks, CompressedTexture, Encoding,
    IndexCodebook, Mode, ScaleBits, TextureInfo, VqModel,
};

/// A model of 2 × 2 × 2 × 1 nodes and 2 × 2 texels.
fn model() -> BtfModel {
    let grid = AngularGrid { alphas: 2, betas: 2, thetas: 2, phis: 1, ..AngularGrid::default() };
    let mut books = Codebooks::new(grid, Encoding::Srgb, Chroma::Relative);
    books.p1.values = vec![1.0, 0.5, 0.2, 0.9, 0.3, 0.3];
    books.p2.index = vec![0, 1, 2, 0];
    books.p2.scale = vec![1.0, 0.5, 0.25, 0.7];
    books.c.values = vec![0.1, -0.1, 0.0, 0.2, 0.3, 0.1];
    books.i1.index = vec![0, 1, 2, 1, 0, 0];
    books.i2.index = vec![0, 2, 1, 1, 2, 0];
    books.m.index = vec![0, 0, 1, 2, 0, 1];
    books.p3.index = vec![0, 1, 2, 1];
    books.p3.scale = vec![1.0, 0.6, 0.8, 0.9];
    books.p4.index = vec![0, 1, 0];
    books.p4.scale = vec![1.0, 0.7, 0.5];
    let index = vec![0, 2, 1, 2];
    let texture = IndexCodebook { len: 1, index, scale: vec![0.5, 0.6, 0.7, 0.8] };
    let info = TextureInfo {
        name: "tiny".to_owned(),
        width: 2,
        height: 2,
        cosine_included: true,
        levels: 1,
    };
    let mut materials = [CompressedTexture { info, levels: vec![texture] }];
    books.normalize(&mut materials);
    BtfModel::Vq(VqModel::pack(&books, &materials, ScaleBits::refined(Encoding::Srgb)).unwrap())
}

fn written() -> Vec<u8> {
    let made = BtfRecord { mode: Mode::Refined, measure: None, epsilon: None, raw_bytes: 1000 };
    write_btf(&model(), &made).unwrap()
}

#[test]
fn a_model_comes_back_from_its_bytes() {
    let (model, bytes) = (model(), written());
    let read = read_btf(Arc::new(MappedFile::from(bytes.clone()))).unwrap();
    assert_eq!(read.bytes, bytes.len());
    assert_eq!(read.model.textures(), model.textures());
    for (at, (name, _)) in model.stream_bytes().iter().enumerate() {
        assert!(read.model.stream(at) == model.stream(at), "{name}");
    }
}

#[test]
fn broken_models_are_refused_or_read_within_bounds() {
    let bytes = written();
    let wi = glam::DVec3::new(0.6, 0.0, 0.8);
    let read = |bytes: Vec<u8>| {
        let Ok(file) = read_btf(Arc::new(MappedFile::from(bytes))) else { return false };
        for texture in 0..file.model.textures().len() {
            let reader = file.model.reader(texture).unwrap();
            let (width, height) = reader.size(0);
            for texel in 0..(width * height).min(16) {
                reader.texel(0, texel, &reader.taps(wi, wi));
                reader.light_sampler(0, texel, wi).sample([0.3, 0.7]);
            }
        }
        true
    };
    assert!(read(bytes.clone()), "the whole file");
    for length in 0..bytes.len() {
        assert!(!read(bytes[..length].to_vec()), "cut to {length} bytes");
    }
    for at in 0..bytes.len() {
        for flip in [0x01, 0x80, 0xff] {
            let mut broken = bytes.clone();
            broken[at] ^= flip;
            read(broken); // refused or read, without a panic
        }
    }
}
