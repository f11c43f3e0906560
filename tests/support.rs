//! What the cross-crate tests share: the data folder.

use std::path::PathBuf;

/// The folder of measured data: `BRDF_DATA`, or `../shared/data` beside the project.
///
/// `None`, with a printed reason, where a file in it is missing: tests then skip.
#[expect(clippy::print_stderr, reason = "a skipped test says why")]
pub fn data_file(relative: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("BRDF_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"),
        PathBuf::from,
    );
    let path = folder.join(relative);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: {relative} is not in the data folder; set BRDF_DATA to where it is");
    None
}
