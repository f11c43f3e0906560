//! Tables of places and directions at which a BTF is asked for.

use brdf_io::FormatError;

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
