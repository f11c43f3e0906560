//! Painted materials and preinverted matrices.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = brdf_container::read_painted(data);
    let _ = brdf_container::read_basis(data);
});
