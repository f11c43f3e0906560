//! From logarithms to values.

/// How a channel's logarithm becomes a value: eʸ − a, or (a + g) eʸ − a over a base g, within the range of what was
/// measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Channel {
    /// a, sr⁻¹.
    pub(crate) offset: f32,
    /// Smallest and largest value that was fitted, sr⁻¹.
    pub(crate) range: [f32; 2],
}

impl Channel {
    pub(crate) fn value(self, y: f64, base: Option<f64>) -> f64 {
        let [min, max] = self.range.map(f64::from);
        let offset = f64::from(self.offset);
        let factor = base.map_or(1.0, |base| offset + base);
        (factor * y.exp() - offset).clamp(min, max)
    }
}
