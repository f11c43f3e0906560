//! PLY and OBJ meshes.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = brdf_io::parse_mesh(data);
});
