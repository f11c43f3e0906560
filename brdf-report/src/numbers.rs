//! Numbers as people read them.

/// Returns four significant digits, in plain notation where that is short.
pub fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    if (1e-4..1e5).contains(&value.abs()) {
        #[expect(clippy::cast_possible_truncation, reason = "an exponent from −4 to 4")]
        let exponent = value.abs().log10().floor() as i32;
        let decimals = usize::try_from(3 - exponent).unwrap_or(0);
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    }
}

/// Returns the number, or a dash where there is none.
pub fn or_dash(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), significant)
}

/// Returns a count of bytes in the unit that fits.
pub fn bytes(count: usize) -> String {
    let real = count as f64;
    match count {
        0..1_000 => format!("{count} B"),
        1_000..1_000_000 => format!("{:.1} kB", real / 1e3),
        _ => format!("{:.1} MB", real / 1e6),
    }
}

/// Returns a share as a percentage.
pub fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_digits_stay() {
        assert_eq!(significant(0.026_823), "0.02682");
        assert_eq!(significant(123.456), "123.5");
        assert_eq!(significant(1.5e-7), "1.500e-7");
        assert_eq!(bytes(4096), "4.1 kB");
    }
}
