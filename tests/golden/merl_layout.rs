//! The derived MERL-layout tables against the RGL materials they were resampled from.
//!
//! Origin: f_r = mean of eval(a, b) and eval(b, a) at the cell centres, stored as f32-rounded
//! doubles, −1 beyond 85°.

use brdf_files::MappedFile;
use brdf_io::{Measured, ReadOptions, read, read_merl, write_merl};
use brdf_model::{Brdf, MerlLookup, MerlTable};
use brdf_tests::data_file;

#[test]
fn cells_hold_the_material_at_their_centres() {
    for name in ["aurora_white", "vch_silk_blue"] {
        let (Some(table), Some(material)) = (
            data_file(&format!("merl_layout_derived/{name}.binary")),
            data_file(&format!("rgl/{name}_rgb.bsdf")),
        ) else {
            return;
        };
        let options = ReadOptions { merl_lookup: MerlLookup::Nearest, ..ReadOptions::default() };
        let table = read(&MappedFile::open(&table).unwrap(), &options).unwrap();
        let material = read(&MappedFile::open(&material).unwrap(), &options).unwrap();
        let Measured::Merl(cells) = &table.measured else { panic!("a MERL table") };
        assert_eq!(cells.invalid_cells(), 457_656, "invalid cells of {name}");
        let (mut errors, mut count) = (0_u32, 0_u32);
        for index in (0..MerlTable::CELLS).step_by(61) {
            let pair = MerlTable::cell_pair(index);
            if !cells.has_data(&pair) {
                continue;
            }
            let brdf = material.measured.brdf();
            let expected = (brdf.eval(&pair) + brdf.eval(&pair.swapped())) * 0.5;
            let found = cells.eval(&pair);
            for (f, e) in found.channels().into_iter().zip(expected.channels()) {
                count += 1;
                // RGL's warps amplify f32 rounding next to table edges.
                errors += u32::from((f - e).abs() > 2e-3 * e + 1e-4);
            }
        }
        assert!(count > 40_000 && errors * 1000 < count, "{name}: {errors} of {count} differ");
    }
}

#[test]
fn writing_and_reading_a_table_changes_no_bit() {
    let Some(path) = data_file("merl_layout_derived/aurora_white.binary") else { return };
    let bytes = std::fs::read(path).unwrap();
    let table = read_merl(&bytes, MerlLookup::Nearest).unwrap();
    let again = read_merl(&write_merl(&table), MerlLookup::Nearest).unwrap();
    assert_eq!(table, again);
}
