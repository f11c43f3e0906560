//! Archives of neural BRDFs.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let _ = brdf_io::read_nbrdf(data, None);
    let _ = brdf_io::nbrdf_names(data);
});
