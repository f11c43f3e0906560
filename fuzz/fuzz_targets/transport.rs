//! Transport of objects, and the chunks of its making.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = brdf_container::read_relight(data);
    let _ = brdf_container::read_piece(data);
});
