//! Transport of objects, and the chunks of its making.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = brdf_io::parse_relight(data);
    let _ = brdf_io::chunk_from_bytes(data);
});
