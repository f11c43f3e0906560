//! Tables of samples and of directions.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    if let Ok(text) = std::str::from_utf8(data) {
        let _ = brdf_io::read_table(text, &brdf_io::TableOptions::default());
        let _ = brdf_io::direction_rows(text);
    }
});
