//! Images of BTFs: Radiance, JPEG, PNG and OpenEXR.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = btf_io::read_btf_image(data);
});
