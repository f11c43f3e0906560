//! Sizes of the refined books for a number of bytes.

use brdf_job::Job;

use crate::bits::{index_bits, packed_len};
use crate::model::{BookRows, ScaleBits, VALUE_BITS};
use crate::projected_texels::ProjectedTexels;
use crate::refined::{CodebookSizes, encode_refined};
use crate::{AngularGrid, Chroma, Codebooks, VqError};

/// Returns the bytes of the streams of books of these sizes and `texels` texels. Each entry takes an index of ⌈log₂
/// rows⌉ bits and a scale, every stream is rounded up to bytes, and the two chrominances take 8 bits each.
pub fn stream_bytes(grid: &AngularGrid, rows: &BookRows, bits: &ScaleBits, texels: usize) -> u64 {
    let scaled = |rows, len, target, scale| (rows * len, index_bits(target) + scale);
    let streams = [
        (rows.p1 * grid.betas, VALUE_BITS),
        scaled(rows.p2, grid.alphas, rows.p1, bits.p2),
        (rows.c * 2, VALUE_BITS),
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
const SPLITS: [[f64; 4]; 2] = [[0.38, 0.44, 0.14, 0.04], [0.46, 0.40, 0.11, 0.03]];
/// The same for BRDFs, whose views are few and whose slices are fine: every view has a row as long as
/// there is room, and lines along β take the rest.
const BRDF_SPLIT: [f64; 4] = [1.0, 1.0, 0.2, 0.7];
/// Share of pairs of P2 and I2 that are different ones, among the views of P3, before any was seen.
const DIFFERENT: f64 = 0.55;
/// Texels on which splits are compared.
const TRIAL: usize = 8192;

/// Returns the sizes of books that make `bytes` in all, headers not counted: the split with the least error on a
/// part of the texels. Books in proportion are tried on that part, which also shows how many rows of M come out.
///
/// # Errors
///
/// [`VqError::Budget`] where P6 alone takes more; [`VqError::Stopped`].
///
/// # Panics
///
/// If there are no surveys.
pub fn choose_sizes(
    surveys: &[ProjectedTexels],
    bits: &ScaleBits,
    bytes: u64,
    job: &Job<'_>,
) -> Result<CodebookSizes, VqError> {
    let ProjectedTexels { grid, encoding, .. } = surveys[0];
    let texels = surveys.iter().map(ProjectedTexels::texels).sum();
    let room = Room { grid: &grid, bits, textures: surveys.len(), texels, bytes };
    if grid.phis == 1 {
        return room.sizes(&BRDF_SPLIT, 1.0);
    }
    let sizes: Vec<CodebookSizes> =
        SPLITS.iter().map(|split| room.sizes(split, DIFFERENT)).collect::<Result<_, _>>()?;
    if texels <= 2 * TRIAL {
        return Ok(sizes[0]);
    }
    let share = TRIAL as f64 / texels as f64;
    let part: Vec<ProjectedTexels> = surveys.iter().map(|s| s.every(texels / TRIAL)).collect();
    let jobs = job.split_into(&[1.0; SPLITS.len()]);
    let trials = SPLITS.iter().zip(&sizes).zip(&jobs).map(|((split, sizes), trial)| {
        let empty = Codebooks::new(grid, encoding, Chroma::Relative);
        let encoded = encode_refined(&part, &sizes.times(share), empty, trial)?;
        let BookRows { m, p3, .. } = BookRows::of(&encoded.books);
        let different = m as f64 / (p3 * grid.thetas).max(1) as f64;
        Ok((split, different, encoded.errors.total))
    });
    let trials = trials.collect::<Result<Vec<_>, VqError>>()?;
    match trials.into_iter().min_by(|a, b| a.2.total_cmp(&b.2)) {
        Some((split, different, _)) => room.sizes(split, different),
        None => Ok(sizes[0]),
    }
}

/// What books have to fit into.
struct Room<'a> {
    grid: &'a AngularGrid,
    bits: &'a ScaleBits,
    /// Each brings colours of its own.
    textures: usize,
    texels: usize,
    bytes: u64,
}

impl Room<'_> {
    /// The sizes of a split that fill the bytes, or hold every slice in fewer.
    fn sizes(&self, split: &[f64; 4], different: f64) -> Result<CodebookSizes, VqError> {
        let taken = |sizes: &CodebookSizes| {
            stream_bytes(self.grid, &sizes.rows(self.grid, different), self.bits, self.texels)
        };
        let least = taken(&self.sizes_in(0.0, split, different));
        if least > self.bytes {
            let what = format!("{} texels", self.texels);
            return Err(VqError::Budget { bytes: self.bytes, what, least });
        }
        // Codebooks that hold every slice already leave their room to others.
        let (mut low, mut high) = (0.0, 64.0 * self.bytes as f64);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            let sizes = self.sizes_in(middle, split, different);
            if taken(&sizes) <= self.bytes { low = middle } else { high = middle }
        }
        Ok(self.sizes_in(low, split, different))
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "rows of books")]
    fn sizes_in(&self, room: f64, split: &[f64; 4], different: f64) -> CodebookSizes {
        let (grid, texels) = (self.grid, self.texels);
        let rows = |share: f64, row_bits: f64, most: usize| {
            ((8.0 * room * share / row_bits) as usize).clamp(4.min(most), most)
        };
        // Bits of indices are those of typical books; the search settles what they really take.
        let p4 = rows(split[0], grid.phis as f64 * 20.0, texels);
        let merged = 27.0 * different;
        let p3 = rows(split[1], grid.thetas as f64 * (22.0 + merged), grid.phis * p4);
        let p2 = rows(split[2], grid.alphas as f64 * 18.0, grid.thetas * p3);
        let p1 = rows(split[3], grid.betas as f64 * 8.0, grid.alphas * p2);
        if grid.phis == 1 {
            let i1 = (grid.alphas * p2 / 8).clamp(4, 1024);
            return CodebookSizes { p4, p3, p2, p1, i2: p2, i1, c: i1.min(256) };
        }
        let i2 = (p3 / 16).clamp(4, 1024 * self.textures);
        let i1 = (2 * i2).min(256 * self.textures);
        CodebookSizes { p4, p3, p2, p1, i2, i1, c: 256.min(64 * self.textures) }
    }
}

impl CodebookSizes {
    /// Returns the rows of all books, where `different` of the views of P3, as a share, have a row of M of their
    /// own.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "rows of books")]
    pub fn rows(&self, grid: &AngularGrid, different: f64) -> BookRows {
        let Self { p4, p3, p2, p1, i2, i1, c } = *self;
        let m = (different * (p3 * grid.thetas) as f64) as usize;
        BookRows { p1, p2, c, i1, i2, m: m.max(1), p3, p4 }
    }

    /// Returns sizes that are `share` of these, with as many colours, so that as many pairs of P2 and I2 differ
    /// among so many views.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "rows of books")]
    pub fn times(&self, share: f64) -> Self {
        let part = |rows: usize| ((rows as f64 * share) as usize).max(4);
        Self {
            p4: part(self.p4),
            p3: part(self.p3),
            p2: part(self.p2),
            p1: part(self.p1),
            i2: self.i2,
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
            let rows = BookRows { p1, p2, c, i1, i2, m, p3, p4 };
            let bytes = stream_bytes(&grid, &rows, &ScaleBits::paper(encoding), 256 * 256);
            let ratio = bytes as f64 / reported as f64;
            assert!((ratio - 1.0).abs() < 0.04, "{name}: {bytes} bytes of {reported}");
        }
        assert_eq!(index_bits(1311), 11);
    }

    #[test]
    fn sizes_fill_what_they_are_given() {
        let grid = AngularGrid::default();
        let bits = ScaleBits::refined(Encoding::Srgb);
        for bytes in [400_000_u64, 1_690_000, 5_000_000] {
            let room = Room { grid: &grid, bits: &bits, textures: 1, texels: 65_536, bytes };
            for split in &SPLITS {
                let sizes = room.sizes(split, DIFFERENT).unwrap();
                let taken = stream_bytes(&grid, &sizes.rows(&grid, DIFFERENT), &bits, 65_536);
                assert!(
                    taken <= bytes && taken > bytes * 97 / 100,
                    "{taken} of {bytes}: {sizes:?}"
                );
            }
        }
        let room = Room { grid: &grid, bits: &bits, textures: 1, texels: 65_536, bytes: 1000 };
        assert!(room.sizes(&SPLITS[0], DIFFERENT).is_err());
    }

    #[test]
    fn brdfs_get_a_row_for_every_slice_where_there_is_room() {
        let grid = AngularGrid { alphas: 45, betas: 45, thetas: 35, phis: 1, ..Default::default() };
        let bits = ScaleBits::refined(Encoding::Srgb);
        let room = Room { grid: &grid, bits: &bits, textures: 1, texels: 60, bytes: 7_000_000 };
        let sizes = room.sizes(&BRDF_SPLIT, 1.0).unwrap();
        assert_eq!([sizes.p4, sizes.p3, sizes.p2, sizes.p1], [60, 60, 2100, 94_500]);
        let room = Room { bytes: 1_000_000, ..room };
        let sizes = room.sizes(&BRDF_SPLIT, 1.0).unwrap();
        assert!(sizes.p1 < 94_500 && sizes.p3 == 60, "{sizes:?}");
    }
}
