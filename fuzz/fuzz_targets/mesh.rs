//! PLY and OBJ meshes.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = brdf_mesh::parse_mesh(data);
});
