//! Names of images with angles in them.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    if let Ok(name) = std::str::from_utf8(data) {
        let _ = btf_io::parse_image_name(name);
    }
});
