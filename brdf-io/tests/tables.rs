//! Tables in the dialects that people write, and what is refused instead of being read wrongly.
#![cfg(feature = "table")]

use std::fmt::Write as _;

use brdf_io::{FormatError, ReadNote, ReadOptions, TableOptions, read, read_table};
use brdf_model::{Channels, SampleSet};
use proptest::prelude::*;

/// Rows of a grid of directions: light, viewer and difference of azimuths in degrees, and a value.
fn grid() -> Vec<[f64; 4]> {
    let mut rows = Vec::new();
    for theta_i in [5.0, 20.0, 40.0, 60.0] {
        for theta_o in [10.0, 15.0, 30.0, 45.0, 60.0] {
            for phi in [0.0, 90.0, 180.0] {
                rows.push([theta_i, theta_o, phi, 0.1 + 0.001 * (theta_i + theta_o + phi)]);
            }
        }
    }
    rows
}

fn table(header: &str, row: impl Fn(&[f64; 4], &mut String)) -> String {
    let mut text = format!("{header}\n");
    for own in grid() {
        row(&own, &mut text);
    }
    text
}

fn read_plainly(text: &str) -> Result<(SampleSet, Vec<ReadNote>), FormatError> {
    read_table(text, &TableOptions::default())
}

fn refused(text: &str) -> String {
    read_plainly(text).expect_err("a table that could be read wrongly").to_string()
}

#[test]
fn columns_that_tell_materials_apart_have_to_be_chosen() {
    for (name, values) in [("polarisation", ["s", "p"]), ("plate", ["7", "8"])] {
        let text = table(
            &format!("theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,{name},value"),
            |[i, o, phi, value], text| {
                for (own, factor) in values.iter().zip([1.0, 3.0]) {
                    writeln!(text, "{i},0,{o},{phi},{own},{}", value * factor).unwrap();
                }
            },
        );
        let message = refused(&text);
        assert!(message.contains(name) && message.contains(values[0]), "{message}");
        let take = |value: &str| {
            let rows = vec![format!("{name}={value}").parse().unwrap()];
            read_table(&text, &TableOptions { rows, ..TableOptions::default() })
        };
        let (first, notes) = take(values[0]).unwrap();
        assert_eq!((first.len(), notes.len()), (grid().len(), 0));
        let (second, _) = take(values[1]).unwrap();
        assert!((second.values()[0][0] / first.values()[0][0] - 3.0).abs() < 1e-12);
        let (all, notes) = take("any").unwrap();
        assert_eq!(all.len(), 2 * grid().len());
        assert!(matches!(notes[..], [ReadNote::Contradictions { .. }]), "{notes:?}");
        assert!(take("x").unwrap_err().to_string().contains(values[1]));
    }
    // A wavelength without a unit cannot be chosen by its length.
    let text = table(
        "wavelength,theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value",
        |[i, o, phi, value], text| {
            let length = if *phi > 90.0 { 450 } else { 650 };
            writeln!(text, "{length},{i},0,{o},{phi},{value}").unwrap();
        },
    );
    assert!(
        refused(&text).contains("450, 650"),
        "no direction is there twice, but the name says it"
    );
}

#[test]
fn what_differs_in_every_row_tells_nothing_apart() {
    let mut number = 0;
    let header = "number,theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value,sigma";
    let mut text = format!("{header}\n");
    for [i, o, phi, value] in grid().into_iter().chain(grid()) {
        number += 1;
        let sigma = 1e-5 * f64::from(number);
        writeln!(text, "{number},{i},0,{o},{phi},{value},{sigma}").unwrap();
    }
    let (samples, notes) = read_plainly(&text).unwrap();
    assert_eq!((samples.len(), notes.len()), (2 * grid().len(), 0));
}

#[test]
fn units_that_cannot_be_are_refused() {
    let radians =
        table("theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value", |[i, o, phi, value], t| {
            let [i, o, phi] = [i, o, phi].map(|angle| angle.to_radians());
            writeln!(t, "{i},0,{o},{phi},{value}").unwrap();
        });
    assert!(refused(&radians).contains("are these radians?"));
    let columns = "theta_i_rad=theta_i_deg,phi_i_rad=phi_i_deg,theta_o_rad=theta_o_deg,\
                   phi_o_rad=phi_o_deg,value=value";
    let options = TableOptions { columns: Some(columns.parse().unwrap()), ..Default::default() };
    let (samples, _) = read_table(&radians, &options).unwrap();
    assert!((samples.pair(samples.len() - 1).wo.z - 0.5).abs() < 1e-9);

    let degrees =
        table("theta_i_rad,phi_i_rad,theta_o_rad,phi_o_rad,value", |[i, o, phi, value], t| {
            writeln!(t, "{i},0,{o},{phi},{value}").unwrap();
        });
    assert!(refused(&degrees).contains("are these degrees?"));
    let lengths = |name: &str, length: f64| {
        let header = format!("{name},theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value");
        refused(&table(&header, |[i, o, phi, value], t| {
            writeln!(t, "{length},{i},0,{o},{phi},{value}").unwrap();
        }))
    };
    assert!(lengths("wavelength_nm", 0.55).contains("are these µm?"));
    assert!(lengths("wavelength_um", 550.0).contains("are these nm?"));
    let beyond = "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value\n30,0,200,0,1\n";
    assert!(refused(beyond).contains("line 2"), "{}", refused(beyond));
}

#[test]
fn angles_without_a_unit_are_degrees_only_where_nothing_else_fits() {
    let text = |azimuth: f64, unit: f64| {
        table("theta_i phi_i theta_o phi_o value", |[i, o, phi, value], t| {
            let [i, o, phi] = [*i, *o, phi.min(azimuth)].map(|angle| angle * unit);
            writeln!(t, "{i} 0 {o} {phi} {value}").unwrap();
        })
    };
    let (samples, notes) = read_plainly(&text(180.0, 1.0)).unwrap();
    assert!((samples.pair(samples.len() - 1).wo.z - 0.5).abs() < 1e-9);
    assert!(notes.iter().any(|note| matches!(note, ReadNote::DegreesAssumed)));
    assert!(refused(&text(180.0, std::f64::consts::PI / 180.0)).contains("without a unit"));
    // What is called an azimuth could be the polar angle.
    assert!(refused(&text(80.0, 1.0)).contains("without a unit"));
}

#[test]
fn cosines_are_divided_out_and_wavelengths_are_said() {
    let text =
        "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value_cos\n30,0,60,180,0.1\n30,0,0,0,0.1\n";
    let (samples, notes) = read_plainly(text).unwrap();
    assert!((samples.values()[0][0] - 0.2).abs() < 1e-12);
    assert!(matches!(notes[..], [ReadNote::CosineDividedOut]));

    let text = "theta_i_deg phi_i_deg theta_o_deg phi_o_deg\n";
    let bands = format!("{},0.45um,0.65um\n30,0,0,0,0.1,0.4\n", text.trim_end().replace(' ', ","));
    let wavelength = |wavelength_um| TableOptions { wavelength_um, ..TableOptions::default() };
    let (samples, notes) = read_table(&bands, &wavelength(Some(0.6))).unwrap();
    assert_eq!(samples.values(), [[0.4]]);
    assert!(notes[0].to_string().contains("0.6 µm is not among them"), "{}", notes[0]);
    let plain = "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,value\n30,0,0,0,0.1\n";
    let message = read_table(plain, &wavelength(Some(0.6))).unwrap_err().to_string();
    assert!(message.contains("wavelength"), "{message}");
}

/// Ways to write the same table.
#[derive(Clone, Copy, Debug)]
struct Style {
    separator: char,
    decimal: char,
    mark: &'static str,
    end: &'static str,
    encoding: usize,
    has_units: bool,
    has_index: bool,
}

fn styles() -> impl Strategy<Value = Style> {
    let separators = prop::sample::select(vec![
        (',', '.'),
        (';', '.'),
        (';', ','),
        ('\t', '.'),
        ('\t', ','),
        (' ', '.'),
        (' ', ','),
    ]);
    let marks = prop::sample::select(vec!["", "#", "# ", "% ", "// ", "; ", "! "]);
    let ends = prop::sample::select(vec!["\n", "\r\n", "\r"]);
    (separators, marks, ends, 0..5_usize, any::<bool>(), any::<bool>()).prop_map(
        |((separator, decimal), mark, end, encoding, has_units, has_index)| {
            let mark = if separator == ';' && mark == "; " { "" } else { mark };
            Style { separator, decimal, mark, end, encoding, has_units, has_index }
        },
    )
}

impl Style {
    fn write(self, rows: &[[f64; 5]]) -> Vec<u8> {
        let join = |fields: &[String]| fields.join(&self.separator.to_string());
        let names = ["theta_i", "phi_i", "theta_o", "phi_o", "value"];
        let header = names.map(|name| match name {
            "value" => name.to_owned(),
            _ if self.has_units => name.to_owned(),
            _ => format!("{name}_deg"),
        });
        let index = if self.has_index { vec!["n".to_owned()] } else { Vec::new() };
        let mut lines = vec![format!("{}{}", self.mark, join(&[index, header.to_vec()].concat()))];
        if self.has_units {
            let units = ["deg", "deg", "deg", "deg", "1/sr"].map(str::to_owned);
            let index = if self.has_index { vec!["-".to_owned()] } else { Vec::new() };
            lines.push(format!("{}{}", self.mark, join(&[index, units.to_vec()].concat())));
        }
        for (number, row) in rows.iter().enumerate() {
            let fields = row.map(|v| format!("{v:.6}").replace('.', &self.decimal.to_string()));
            let index = if self.has_index { vec![number.to_string()] } else { Vec::new() };
            lines.push(join(&[index, fields.to_vec()].concat()));
        }
        let text = lines.join(self.end) + self.end;
        let utf16 = |mark: [u8; 2], bytes: fn(u16) -> [u8; 2]| {
            mark.into_iter().chain(text.encode_utf16().flat_map(bytes)).collect()
        };
        match self.encoding {
            0 => text.into_bytes(),
            1 => format!("\u{feff}{text}").into_bytes(),
            2 => utf16([0xFF, 0xFE], u16::to_le_bytes),
            3 => utf16([0xFE, 0xFF], u16::to_be_bytes),
            _ => [b"# gr\xf6\xdfe\n".to_vec(), text.into_bytes()].concat(),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn every_dialect_gives_the_same_samples(
        style in styles(),
        rows in prop::collection::vec(
            [30.0..80.0_f64, 0.0..360.0, 30.0..80.0, 0.0..360.0, 0.01..9.0], 8..30),
    ) {
        let bytes = style.write(&rows);
        let found = read(&bytes, &ReadOptions::default());
        let found = found.map_err(|error| TestCaseError::fail(format!("{style:?}: {error}")))?;
        let samples = found.measured.samples().expect("rows");
        prop_assert_eq!((samples.len(), samples.channels()), (rows.len(), Channels::Luminance));
        for (index, row) in rows.iter().enumerate() {
            prop_assert!((samples.values()[0][index] - row[4]).abs() < 1e-6);
            let pair = samples.pair(index);
            prop_assert!((pair.wi.z - row[0].to_radians().cos()).abs() < 1e-6);
            prop_assert!((pair.wo.z - row[2].to_radians().cos()).abs() < 1e-6);
        }
    }
}
