//! Binary BTFs.
#![no_main]

use btf_vq::BtfSource as _;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let bytes = brdf_files::MappedFile::from(data.to_vec());
    let Ok(file) = btf_io::BtfFile::new(bytes) else { return };
    let texels = file.layout().texel_count().min(3);
    let values = 3 * texels * file.layout().image_count();
    // A short file may claim many images of few components.
    if values < 1 << 20 {
        let _ = file.read_texels(0..texels, &mut vec![0.0; values]);
    }
});
