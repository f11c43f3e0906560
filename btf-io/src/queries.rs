//! Tables of places and directions at which a BTF is asked for, and of what it answers.

use std::fmt::Write as _;

use brdf_io::FormatError;
use brdf_param::spherical_direction;
use btf_vq::{BtfReader, DrawnLight};

/// Returns the rows of a table of u, v, and four angles in degrees: θ and φ of the light, then of the view. Numbers are
/// separated by commas, blanks or tabs; a first line that begins with a letter is a header.
///
/// ```
/// let rows = btf_io::read_queries(b"u,v,theta_i_deg,phi_i_deg,theta_v_deg,phi_v_deg\n0.5,0.5,30,0,45,180\n")?;
/// assert_eq!(rows, [[0.5, 0.5, 30.0, 0.0, 45.0, 180.0]]);
/// # Ok::<(), brdf_io::FormatError>(())
/// ```
///
/// # Errors
///
/// [`FormatError::Line`] for a row of anything but six finite numbers.
pub fn read_queries(bytes: &[u8]) -> Result<Vec<[f64; 6]>, FormatError> {
    let text = String::from_utf8_lossy(bytes);
    let mut rows = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.trim();
        let is_header = number == 0 && line.starts_with(|c: char| c.is_alphabetic());
        if line.is_empty() || is_header {
            continue;
        }
        let fields = line.split([',', ' ', '\t']).filter(|field| !field.is_empty());
        let numbers: Option<Vec<f64>> = fields.map(|field| field.parse().ok()).collect();
        let row = numbers.and_then(|numbers| <[f64; 6]>::try_from(numbers).ok());
        match row.filter(|row| row.iter().all(|value| value.is_finite())) {
            Some(row) => rows.push(row),
            None => {
                return Err(FormatError::Line {
                    line: number + 1,
                    found: format!("{line:?}"),
                    expected: "six numbers: u,v and four angles in degrees".to_owned(),
                });
            }
        }
    }
    Ok(rows)
}

/// Returns the table of rows as [`read_queries`] returns them with r, g, b, the linear radiance of a level of a BTF, and the
/// number of rows below the horizon, whose radiance is 0.
pub fn answer_table(reader: &BtfReader<'_>, level: usize, rows: &[[f64; 6]]) -> (String, usize) {
    let mut table = String::from("u,v,theta_i_deg,phi_i_deg,theta_v_deg,phi_v_deg,r,g,b\n");
    let mut below = 0;
    for row in rows {
        let [u, v, angles @ ..] = *row;
        let [theta_i, phi_i, theta_v, phi_v] = angles.map(f64::to_radians);
        let (wi, wo) = (spherical_direction(theta_i, phi_i), spherical_direction(theta_v, phi_v));
        let is_above = angles[0].abs() < 90.0 && angles[2].abs() <= 90.0;
        below += usize::from(!is_above);
        let texel = reader.texel_at(level, u, v);
        let [r, g, b] = match is_above {
            true => reader.linear(level, texel, &reader.taps(wi, wo)),
            false => [0.0; 3],
        };
        row.iter().for_each(|number| _ = write!(table, "{number},"));
        _ = writeln!(table, "{r},{g},{b}");
    }
    (table, below)
}

/// Returns the table of drawn directions: theta_i_deg, phi_i_deg, pdf in sr⁻¹ and r, g, b, the linear radiance.
pub fn drawn_table(drawn: &[DrawnLight]) -> String {
    let mut table = String::from("theta_i_deg,phi_i_deg,pdf,r,g,b\n");
    for DrawnLight { wi, pdf, radiance: [r, g, b] } in drawn {
        let azimuth = wi.y.atan2(wi.x).to_degrees();
        let polar = wi.z.clamp(-1.0, 1.0).acos().to_degrees();
        _ = writeln!(table, "{polar},{azimuth},{pdf},{r},{g},{b}");
    }
    table
}
