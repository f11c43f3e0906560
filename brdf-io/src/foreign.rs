//! Files that people mistake for measurements, and formats of other programs that are not read.

use crate::error::FormatError;

/// How files begin, what they are, and what to do about them.
const BEGINNINGS: [(&[u8], &str, &str); 12] = [
    (
        b"version https://git-lfs.github.com/spec",
        "a Git LFS pointer, not the file itself",
        "`git lfs pull` fetches it",
    ),
    (b"<!doctype html", "a web page", "the download may have needed a login"),
    (b"<html", "a web page", "the download may have needed a login"),
    (b"\x89HDF\r\n", "an HDF5 file", "networks are read from NumPy archives (.npz)"),
    (b"\x89PNG\r\n", "a PNG picture", "expected a measurement"),
    (b"\xff\xd8\xff", "a JPEG picture", "expected a measurement"),
    (b"\x76\x2f\x31\x01", "an OpenEXR picture", "expected a measurement"),
    (b"#?radiance", "a Radiance picture", "expected a measurement"),
    (b"#?rgbe", "a Radiance picture", "expected a measurement"),
    (b"%PDF", "a PDF document", "expected a measurement"),
    (b"\x1f\x8b", "a gzip archive", "unpack it first"),
    (b"7z\xbc\xaf", "a 7z archive", "unpack it first"),
];

/// Marks within the first lines of a text.
const MARKS: [(&[&str], &str, &str); 4] = [
    (
        &["ScatterType", "AngleOfIncidence"],
        "a tabular BSDF of Zemax or Radiant Imaging",
        "it is not read; write its rows as a table with theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg and value",
    ),
    (&["<WindowElement"], "a BSDF of WINDOW in XML (Klems or tensor tree)", "it is not read"),
    (&["DATA_TYPE", "PARAM_TYPE"], "an SSDD file", "it is not read"),
    (
        &["::begin"],
        "a shader of BRDF Explorer",
        "it is a formula, not a measurement, and is not read; presets have the usual formulas",
    ),
];

/// Returns what a file is, if it is known and no measurement that is read.
pub(crate) fn foreign(bytes: &[u8], text: Option<&str>) -> Option<FormatError> {
    let found = |what: &str, advice| Some(FormatError::Foreign { what: what.to_owned(), advice });
    let start = bytes.trim_ascii_start();
    for (beginning, what, advice) in BEGINNINGS {
        let is_it = start.len() >= beginning.len()
            && start[..beginning.len()].eq_ignore_ascii_case(beginning);
        if is_it {
            return found(what, advice);
        }
    }
    let text = text?;
    let is_there = |marks: &[&str]| marks.iter().all(|mark| text.contains(mark));
    let (_, what, advice) = MARKS.iter().find(|(marks, _, _)| is_there(marks))?;
    found(what, advice)
}
