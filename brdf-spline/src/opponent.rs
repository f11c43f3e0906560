//! Colours as a mean and two differences, which is how coefficients are solved for and coded.

/// Returns a colour's mean and two differences, orthonormal; a single channel as it is.
pub(crate) fn to_opponent([r, g, b]: [f64; 3], channels: usize) -> [f64; 3] {
    if channels == 1 {
        return [r, 0.0, 0.0];
    }
    [(r + g + b) / 3_f64.sqrt(), (r - b) / 2_f64.sqrt(), (r - 2.0 * g + b) / 6_f64.sqrt()]
}

/// Returns the colour of [`to_opponent`].
pub(crate) fn from_opponent([mean, warm, magenta]: [f64; 3], channels: usize) -> [f64; 3] {
    if channels == 1 {
        return [mean, 0.0, 0.0];
    }
    let (a, b, c) = (mean / 3_f64.sqrt(), warm / 2_f64.sqrt(), magenta / 6_f64.sqrt());
    [a + b + c, a - 2.0 * c, a - b + c]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back_and_keep_their_length() {
        let colour = [0.3, -1.2, 2.5];
        let opponent = to_opponent(colour, 3);
        let length = |v: [f64; 3]| v.iter().map(|v| v * v).sum::<f64>();
        assert!((length(opponent) - length(colour)).abs() < 1e-14);
        let back = from_opponent(opponent, 3);
        assert!(back.iter().zip(colour).all(|(a, b)| (a - b).abs() < 1e-15), "{back:?}");
    }
}
