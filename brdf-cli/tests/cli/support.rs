//! Running the binary.

use std::path::Path;
use std::process::{Command, Output};

pub(crate) fn brdf(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_brdf"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the binary runs")
}

/// Standard output of a command that must succeed.
pub(crate) fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = brdf(folder, arguments);
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "brdf {arguments:?}: {out}{err}");
    out
}

/// Standard error of a command that must fail: with one line, unless it was used wrongly.
pub(crate) fn fail(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = brdf(folder, arguments);
    let err = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "brdf {arguments:?}: {err}");
    if code == 1 {
        assert_eq!(err.trim_end().lines().count(), 1, "one line: {err}");
        assert!(err.starts_with("brdf: "), "{err}");
    }
    err
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
