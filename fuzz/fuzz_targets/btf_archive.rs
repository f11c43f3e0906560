//! Archives of images named by angles.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let bytes = brdf_files::MappedFile::from(data.to_vec());
    if let Ok(images) = btf_io::BtfImages::in_archive("btf.zip".as_ref(), bytes) {
        let _ = images.load(1 << 20, &brdf_job::Job::new());
    }
});
