//! Separable filters of single planes.

/// What stands beyond the rim of a plane.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Border {
    /// The outermost value.
    Clamp,
    /// The plane mirrored about its rim, the outermost value twice.
    Mirror,
}

/// Filters along rows with one odd-sized kernel and along columns with another.
pub(super) fn separable(
    plane: &[f64],
    width: usize,
    along_rows: &[f64],
    along_columns: &[f64],
    border: Border,
) -> Vec<f64> {
    let height = plane.len() / width.max(1);
    let mut rows = vec![0.0; plane.len()];
    for (source, target) in plane.chunks_exact(width).zip(rows.chunks_exact_mut(width)) {
        for (x, value) in target.iter_mut().enumerate() {
            *value = taps(along_rows, x, width, border).map(|(i, k)| k * source[i]).sum();
        }
    }
    let mut out = vec![0.0; plane.len()];
    for (y, target) in out.chunks_exact_mut(width).enumerate() {
        for (row, weight) in taps(along_columns, y, height, border) {
            let source = &rows[row * width..][..width];
            target.iter_mut().zip(source).for_each(|(sum, value)| *sum += weight * value);
        }
    }
    out
}

/// Places of a kernel centred on `at`, and its weights.
fn taps(
    kernel: &[f64],
    at: usize,
    count: usize,
    border: Border,
) -> impl Iterator<Item = (usize, f64)> {
    let radius = kernel.len() / 2;
    kernel.iter().enumerate().map(move |(offset, weight)| {
        let place = at + offset;
        let inside = if place >= radius && place - radius < count {
            place - radius
        } else {
            match border {
                Border::Clamp => place.saturating_sub(radius).min(count - 1),
                Border::Mirror => mirrored(place, radius, count),
            }
        };
        (inside, *weight)
    })
}

/// The place under tap `place − radius` of a mirrored line.
pub(super) fn mirrored(place: usize, radius: usize, count: usize) -> usize {
    let period = 2 * count;
    // Shifted by whole periods so that nothing is negative.
    let shifted = (place + period * (radius / period + 1) - radius) % period;
    if shifted < count { shifted } else { period - 1 - shifted }
}

/// exp(−x²/(2σ²)) at −radius … radius, scaled to sum 1.
pub(super) fn gaussian(sigma: f64, radius: u32) -> Vec<f64> {
    let raw: Vec<f64> = offsets(radius).map(|x| (-x * x / (2.0 * sigma * sigma)).exp()).collect();
    let sum: f64 = raw.iter().sum();
    raw.into_iter().map(|v| v / sum).collect()
}

/// −radius … radius.
pub(super) fn offsets(radius: u32) -> impl Iterator<Item = f64> {
    (0..=2 * radius).map(move |i| f64::from(i) - f64::from(radius))
}
