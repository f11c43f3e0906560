//! Sizes of the refined books for a number of bytes.

use crate::bits::{index_bits, packed_len};
use crate::model::{Rows, ScaleBits};
use crate::refined::{BookSizes, encode_refined};
use crate::survey::Survey;
use crate::{AngularGrid, VqError};

/// Bytes of the streams of books of these sizes and so many texels: index of ⌈log₂ rows⌉ bits and scale
/// for each entry, every stream rounded up to bytes. Two chrominances of 8 bits.
pub fn stream_bytes(grid: &AngularGrid, rows: &Rows, bits: &ScaleBits, texels: usize) -> u64 {
    let scaled = |rows, len, target, scale| (rows * len, index_bits(target) + scale);
    let streams = [
        (rows.p1 * grid.betas, bits.p1),
        scaled(rows.p2, grid.alphas, rows.p1, bits.p2),
        (rows.c * 2, 8),
        scaled(rows.i1, grid.betas, rows.c, 0),
        scaled(rows.i2, grid.alphas, rows.i1, 0),
        (rows.m, index_bits(rows.p2) + index_bits(rows.i2)),
        scaled(rows.p3, grid.thetas, rows.m, bits.p3),
        scaled(rows.p4, grid.phis, rows.p3, bits.p4),
        (texels, index_bits(rows.p4) + bits.p6),
    ];
    streams.iter().filter_map(|(entries, bits)| packed_len(*entries, *bits)).map(|n| n as u64).sum()
}

/// How bytes are shared among P4, P3 with M, P2 and P1, of what is left after P6 and the colours.
const SPLITS: [[f64; 4]; 3] =
    [[0.38, 0.44, 0.14, 0.04], [0.46, 0.40, 0.11, 0.03], [0.28, 0.46, 0.21, 0.05]];
/// Share of pairs of P2 and I2 that are different ones, among the views of P3.
const DIFFERENT: f64 = 0.55;
/// Texels on which splits are compared.
const TRIAL: usize = 8192;

/// Sizes for so many bytes in all: the split with the least error on a part of the texels, with
/// books in proportion.
///
/// # Errors
///
/// [`VqError::Budget`] where P6 alone takes more.
pub fn choose_sizes(survey: &Survey, bits: &ScaleBits, bytes: u64) -> Result<BookSizes, VqError> {
    let texels = survey.texels();
    let all: Vec<BookSizes> = SPLITS
        .iter()
        .map(|split| sizes_for(&survey.grid, bits, texels, bytes, split))
        .collect::<Result<_, _>>()?;
    if texels <= 2 * TRIAL {
        return Ok(all[0]);
    }
    #[expect(clippy::cast_precision_loss, reason = "counts of texels")]
    let share = TRIAL as f64 / texels as f64;
    let part = survey.every(texels / TRIAL);
    let errors = all.iter().map(|sizes| encode_refined(&part, &sizes.times(share)).errors.total);
    let best = all.iter().zip(errors).min_by(|a, b| a.1.total_cmp(&b.1));
    Ok(best.map_or(all[0], |b| *b.0))
}

/// The sizes of a split that fill so many bytes.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "rows of books"
)]
fn sizes_for(
    grid: &AngularGrid,
    bits: &ScaleBits,
    texels: usize,
    bytes: u64,
    split: &[f64; 4],
) -> Result<BookSizes, VqError> {
    let sizes = |room: f64| {
        let rows = |share: f64, row_bits: f64, most: usize| {
            ((8.0 * room * share / row_bits) as usize).clamp(4, most.max(4))
        };
        // Bits of indices are those of typical books; the search below settles what they really take.
        let p4 = rows(split[0], grid.phis as f64 * 20.0, texels);
        let merged = 27.0 * DIFFERENT;
        let p3 = rows(split[1], grid.thetas as f64 * (22.0 + merged), grid.phis * p4);
        let p2 = rows(split[2], grid.alphas as f64 * 18.0, grid.thetas * p3);
        let p1 = rows(split[3], grid.betas as f64 * 8.0, grid.alphas * p2);
        let i2 = (p3 / 16).clamp(4, 1024);
        BookSizes { p4, p3, p2, p1, i2, i1: (2 * i2).clamp(4, 256), c: 64 }
    };
    let taken = |sizes: &BookSizes| stream_bytes(grid, &sizes.rows(grid), bits, texels);
    let (mut low, mut high) = (0.0, bytes as f64);
    if taken(&sizes(low)) > bytes {
        return Err(VqError::Budget {
            bytes,
            what: format!("{texels} texels"),
            least: taken(&sizes(low)),
        });
    }
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if taken(&sizes(middle)) <= bytes { low = middle } else { high = middle }
    }
    Ok(sizes(low))
}

impl BookSizes {
    /// Rows of all books, with those of M as they usually come out.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "rows of books"
    )]
    pub fn rows(&self, grid: &AngularGrid) -> Rows {
        let Self { p4, p3, p2, p1, i2, i1, c } = *self;
        let m = (DIFFERENT * (p3 * grid.thetas) as f64) as usize;
        Rows { p1, p2, c, i1, i2, m: m.max(1), p3, p4 }
    }

    /// Books of a share of these sizes.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "rows of books"
    )]
    pub fn times(&self, share: f64) -> Self {
        let part = |rows: usize| ((rows as f64 * share) as usize).max(4);
        Self {
            p4: part(self.p4),
            p3: part(self.p3),
            p2: part(self.p2),
            p1: part(self.p1),
            i2: part(self.i2),
            i1: self.i1,
            c: self.c,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Encoding, index_bits};

    /// Table 3 of the paper, decoded: reported bytes, then rows of P1 P2 C I1 I2 M P3 P4.
    const TABLE_3: [(&str, Encoding, u64, [usize; 8]); 10] = [
        (
            "corduroy",
            Encoding::Srgb,
            3_084_692,
            [11372, 43177, 29, 29904, 36700, 48934, 12633, 851],
        ),
        ("fabric1", Encoding::Srgb, 3_558_788, [16821, 73400, 16, 887, 667, 73400, 20972, 1311]),
        ("fabric2", Encoding::Srgb, 1_815_996, [10486, 36700, 9, 1049, 612, 36700, 12633, 790]),
        ("foil1", Encoding::Srgb, 632_352, [3510, 8066, 7, 105, 33, 8066, 8738, 790]),
        ("leather", Encoding::Srgb, 1_036_352, [6211, 16311, 7, 577, 306, 17070, 12633, 790]),
        ("pulli", Encoding::Srgb, 4_873_008, [33642, 103_381, 9, 3105, 4893, 103_381, 20972, 1311]),
        ("wood2", Encoding::Srgb, 4_625_772, [15234, 36700, 59, 179_423, 52429, 52429, 12633, 790]),
        ("wool", Encoding::Srgb, 5_514_260, [10486, 66728, 22, 62108, 88434, 95325, 20972, 1311]),
        (
            "ceiling",
            Encoding::Linear,
            2_653_188,
            [17942, 31913, 33, 23747, 17070, 33364, 11523, 1057],
        ),
        (
            "walkway",
            Encoding::Linear,
            7_514_860,
            [80740, 109_553, 39, 26913, 17476, 109_553, 20972, 1311],
        ),
    ];

    #[test]
    fn the_papers_file_sizes_are_reproduced() {
        let grid = AngularGrid::default();
        for (name, encoding, reported, [p1, p2, c, i1, i2, m, p3, p4]) in TABLE_3 {
            let rows = Rows { p1, p2, c, i1, i2, m, p3, p4 };
            let bytes = stream_bytes(&grid, &rows, &ScaleBits::paper(encoding), 256 * 256);
            #[expect(clippy::cast_precision_loss, reason = "a ratio of file sizes")]
            let ratio = bytes as f64 / reported as f64;
            assert!((ratio - 1.0).abs() < 0.04, "{name}: {bytes} bytes of {reported}");
        }
        assert_eq!(index_bits(1311), 11);
    }

    #[test]
    fn sizes_fill_what_they_are_given() {
        let grid = AngularGrid::default();
        let bits = ScaleBits::refined();
        for bytes in [400_000_u64, 1_690_000, 5_000_000] {
            for split in &SPLITS {
                let sizes = sizes_for(&grid, &bits, 65_536, bytes, split).unwrap();
                let taken = stream_bytes(&grid, &sizes.rows(&grid), &bits, 65_536);
                assert!(
                    taken <= bytes && taken > bytes * 97 / 100,
                    "{taken} of {bytes}: {sizes:?}"
                );
            }
        }
        assert!(sizes_for(&grid, &bits, 65_536, 1000, &SPLITS[0]).is_err());
    }
}
