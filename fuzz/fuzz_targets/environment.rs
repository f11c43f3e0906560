//! Radiance HDR environments.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = brdf_render::Environment::from_hdr(data);
});
