//! Our own containers.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = brdf_container::read_container(data, brdf_model::MerlLookup::Nearest);
});
