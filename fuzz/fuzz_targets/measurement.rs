//! Any bytes, whatever format they are taken for.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = brdf_io::read(data, &brdf_io::ReadOptions::default());
});
