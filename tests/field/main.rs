//! Files as people have them: each of `../shared/field`, beside the data folder, comes out as it should, in values, counts
//! or the essentials of a message. Each stands for a kind of trouble.

use brdf_io::{FormatError, Measurement, ReadOptions, TableOptions, read};
use brdf_model::Channels;

/// What is right for a file.
enum Right {
    /// So many rows of so many channels, so many of them dropped, and notes that say these things.
    Rows(usize, Channels, usize, &'static [&'static str]),
    /// A material that is no list of rows.
    Material(&'static str),
    /// An error that says these things.
    Error(&'static [&'static str]),
}

use Channels::{Luminance, Rgb};
use Right::{Error, Material, Rows};

const MEASUREMENTS: [(&str, Right); 36] = [
    ("61-semicolon-comma.csv", Rows(648, Rgb, 0, &["semicolons", "decimals follow a comma"])),
    ("61c-decimal-comma-tabs.txt", Rows(648, Luminance, 0, &["tabs", "decimals follow a comma"])),
    ("62-bom.csv", Rows(648, Rgb, 0, &[])),
    ("64-minus-999.csv", Rows(609, Rgb, 39, &[])),
    ("66-nan-cells.csv", Rows(615, Rgb, 33, &[])),
    ("67-transmission-rows.csv", Rows(648, Rgb, 160, &[])),
    ("68b-contradicting-duplicates.csv", Rows(848, Rgb, 0, &["179 pairs", "3.00 times"])),
    ("69-nanometres.csv", Rows(648, Luminance, 0, &["0.55 µm", "0.45, 0.55, 0.65"])),
    ("70-wavelength-columns.csv", Rows(648, Rgb, 0, &["3 wavelengths from 450 to 650 nm"])),
    ("71-in-plane.csv", Rows(165, Luminance, 0, &["one plane"])),
    ("71c-in-plane-spectral.csv", Rows(165, Rgb, 0, &["one plane", "degrees", "6 wavelengths"])),
    ("72-degrees-called-radians.csv", Error(&["line 3", "radians", "are these degrees?"])),
    ("74-units-row.csv", Rows(648, Rgb, 0, &[])),
    ("75-no-header.txt", Error(&["no header", "theta_i_deg=#1"])),
    ("76b-percent-shift.txt", Rows(648, Luminance, 0, &[])),
    ("76e-pandas-index.csv", Rows(648, Luminance, 0, &[])),
    ("76h-repeated-header.csv", Error(&["line 75"])),
    ("79-spaces-in-names.csv", Rows(648, Rgb, 0, &[])),
    ("87-footer.csv", Error(&["line 651", "End of measurement"])),
    ("90-astm.txt", Rows(648, Luminance, 0, &["degrees"])),
    ("91-small.ssdd", Error(&["SSDD"])),
    ("92-user-made-rgb.bsdf", Material("RGL tensor file")),
    ("94-spectral.bsdf", Error(&["spectral file"])),
    ("95-float64.bsdf", Error(&["phi_i", "f32"])),
    ("98-truncated.bsdf", Error(&["byte 932", "rgb", "700 bytes"])),
    ("100-lfs-pointer.binary", Error(&["Git LFS pointer", "git lfs pull"])),
    ("101-login-page.binary", Error(&["web page"])),
    ("102-90x90x360.binary", Error(&["byte 8", "phi_d", "360", "180"])),
    ("103-f32.binary", Error(&["4108", "34992012"])),
    ("105-merl.zip", Error(&["archive", "brdfs/", "unpack"])),
    ("106-foreign.safetensors", Error(&["unknown format"])),
    ("108-keras-layers.npz", Material("NBRDF archive")),
    ("111-rusin.alta", Error(&["RUSIN_TH_TD_PD"])),
    ("117-zemax.bsdf", Error(&["Zemax"])),
    ("119-explorer.brdf", Error(&["BRDF Explorer"])),
    ("45-env.exr", Error(&["OpenEXR"])),
];

fn field(name: &str) -> Option<Vec<u8>> {
    brdf_tests::data_file(&format!("../field/{name}"))
        .map(|path| std::fs::read(path).expect("a readable file"))
}

fn check(name: &str, found: Result<Measurement, FormatError>, right: &Right) {
    let says = |text: &str, parts: &[&str]| {
        for part in parts {
            assert!(text.contains(part), "{name}: {text:?} does not say {part:?}");
        }
    };
    match (found, right) {
        (Ok(found), Rows(count, channels, dropped, parts)) => {
            let samples = found.measured.samples().unwrap_or_else(|| panic!("{name}: no rows"));
            assert_eq!((samples.len(), samples.channels()), (*count, *channels), "{name}");
            assert_eq!(samples.dropped().total(), *dropped, "{name}");
            let notes: Vec<String> = found.notes.iter().map(ToString::to_string).collect();
            says(&notes.join("; "), parts);
        }
        (Ok(found), Material(format)) => assert_eq!(found.format.name(), *format, "{name}"),
        (Err(error), Error(parts)) => {
            let text = error.to_string();
            assert!(!text.contains('\n') && text.len() < 400, "{name}: {text}");
            says(&text, parts);
        }
        (Ok(found), Error(_)) => panic!("{name}: read as {}", found.format.name()),
        (Err(error), _) => panic!("{name}: {error}"),
    }
}

#[test]
fn measurements_come_out_right() {
    for (name, right) in &MEASUREMENTS {
        if let Some(bytes) = field(name) {
            check(name, read(&bytes, &ReadOptions::default()), right);
        }
    }
}

/// The same rows, whatever dialect they stand in.
#[test]
fn dialects_have_the_same_rows() {
    let names = [
        "62-bom.csv",
        "61-semicolon-comma.csv",
        "74-units-row.csv",
        "79-spaces-in-names.csv",
        "70-wavelength-columns.csv",
    ];
    let found: Option<Vec<Vec<u8>>> = names.into_iter().map(field).collect();
    let Some(found) = found else { return };
    let read = |bytes: &Vec<u8>| read(bytes, &ReadOptions::default()).unwrap();
    let first = read(&found[0]);
    let first = first.measured.samples().unwrap();
    for (name, bytes) in names.iter().zip(&found) {
        let again = read(bytes);
        let again = again.measured.samples().unwrap();
        for index in 0..first.len() {
            assert_eq!(first.pair(index), again.pair(index), "{name}");
        }
        if *name != "70-wavelength-columns.csv" {
            assert_eq!(first.values(), again.values(), "{name}");
        }
    }
}

/// What a user may say of a table that does not say it.
#[test]
fn tables_are_read_as_told() {
    let with = |columns: &str, rows: &[&str]| ReadOptions {
        table: TableOptions {
            columns: (!columns.is_empty()).then(|| columns.parse().unwrap()),
            rows: rows.iter().map(|row| row.parse().unwrap()).collect(),
            ..TableOptions::default()
        },
        ..ReadOptions::default()
    };
    let numbered = "theta_i_deg=#1,phi_i_deg=#2,theta_o_deg=#3,phi_o_deg=#4,r=#5,g=#6,b=#7";
    let degrees = "theta_i_deg=theta_i_rad,phi_i_deg=phi_i_rad,theta_o_deg=theta_o_rad,\
                   phi_o_deg=phi_o_rad,r=r,g=g,b=b";
    let constant =
        "theta_i_deg=theta_i_deg,phi_i_deg=0,theta_o_deg=theta_o_deg,phi_o_deg=180,value=value";
    for (name, options, right) in [
        ("75-no-header.txt", with(numbered, &[]), Rows(648, Rgb, 0, &[])),
        ("72-degrees-called-radians.csv", with(degrees, &[]), Rows(648, Rgb, 0, &[])),
        ("71-in-plane.csv", with(constant, &[]), Rows(165, Luminance, 0, &[])),
        ("69-nanometres.csv", with("", &["wavelength_nm=650"]), Rows(648, Luminance, 0, &["0.65"])),
        ("69-nanometres.csv", with("", &["wavelength_nm=700"]), Error(&["700", "450, 550, 650"])),
    ] {
        if let Some(bytes) = field(name) {
            check(name, read(&bytes, &options), &right);
        }
    }
}
