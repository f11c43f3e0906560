//! Compressed BTFs: books packed to bits, ready for random access.

use std::ops::Range;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::bits::{MAX_ENTRY_BITS, PackedEntries, index_bits, pack, packed_len};
use crate::{
    AngularGrid, Chroma, Codebooks, CompressedTexture, Encoding, IndexCodebook, Quantizer,
    TextureInfo, ValueBook, VqError,
};

/// Numbers of rows of the shared books.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "the names are those of the books")]
pub struct BookRows {
    pub p1: usize,
    pub p2: usize,
    pub c: usize,
    pub i1: usize,
    pub i2: usize,
    pub m: usize,
    pub p3: usize,
    pub p4: usize,
}

impl BookRows {
    /// Returns the numbers of rows of unpacked books.
    pub fn of(books: &Codebooks) -> Self {
        Self {
            p1: books.p1.rows(),
            p2: books.p2.rows(),
            c: books.c.rows(),
            i1: books.i1.rows(),
            i2: books.i2.rows(),
            m: books.m.rows(),
            p3: books.p3.rows(),
            p4: books.p4.rows(),
        }
    }
}

/// Name, size and scale codes of one texture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TextureHeader {
    /// Name, size and meaning.
    #[serde(flatten)]
    pub info: TextureInfo,
    /// Codes of the scales of P6.
    pub scale: Quantizer,
}

/// The meaning of the streams of a [`VqModel`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Header {
    /// Lengths of rows and meaning of nodes.
    pub grid: AngularGrid,
    /// Meaning of the values.
    pub encoding: Encoding,
    /// Relation of chrominance to luminance.
    pub chroma: Chroma,
    /// Sizes of the books.
    pub rows: BookRows,
    /// Codes of the values of P1.
    pub p1: Quantizer,
    /// Codes of the two columns of C.
    pub c: [Quantizer; 2],
    /// Codes of the scales of P2.
    pub p2: Quantizer,
    /// Codes of the scales of P3.
    pub p3: Quantizer,
    /// Codes of the scales of P4.
    pub p4: Quantizer,
    /// The textures.
    pub materials: Vec<TextureHeader>,
}

/// Bits of the values of P1 and C: a byte, so that decoders read them as they are.
pub(crate) const VALUE_BITS: u32 = 8;

/// Numbers of bits that scales are stored in, 1 to 16.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScaleBits {
    /// Bits of P2's scales.
    pub p2: u32,
    /// Bits of P3's scales.
    pub p3: u32,
    /// Bits of P4's scales.
    pub p4: u32,
    /// Bits of P6's scales.
    pub p6: u32,
    /// Logarithmic steps everywhere, instead of only where linear ones are too coarse.
    pub always_log: bool,
}

impl ScaleBits {
    /// Returns the paper's bits: 8, and 16 for P2 where radiance is linear.
    pub fn paper(encoding: Encoding) -> Self {
        let p2 = if encoding == Encoding::Linear { 16 } else { 8 };
        Self { p2, p3: 8, p4: 8, p6: 8, always_log: false }
    }

    /// Returns the bits for refined books. 6 logarithmic bits lose 0.01 dB of sRGB against 8, and leave room for
    /// more rows; linear radiance spans more.
    pub fn refined(encoding: Encoding) -> Self {
        match encoding {
            Encoding::Srgb => Self { p2: 6, p3: 6, p4: 6, p6: 8, always_log: true },
            Encoding::Linear => Self { p2: 10, p3: 10, p4: 10, p6: 12, always_log: true },
        }
    }
}

/// Shape of a packed book.
#[derive(Clone, Copy, Debug)]
struct Shape {
    name: &'static str,
    rows: usize,
    len: usize,
    entry_bits: u32,
}

impl Header {
    /// The shared books in the order of their streams.
    fn shapes(&self) -> [Shape; 8] {
        let (grid, rows) = (&self.grid, &self.rows);
        let shape = |name, rows, len, entry_bits| Shape { name, rows, len, entry_bits };
        let indexed = |name, rows, len, target, scale: &Quantizer| {
            shape(name, rows, len, index_bits(target) + scale.bits)
        };
        [
            shape("P1", rows.p1, grid.betas, VALUE_BITS),
            indexed("P2", rows.p2, grid.alphas, rows.p1, &self.p2),
            shape("C", rows.c, 2, VALUE_BITS),
            shape("I1", rows.i1, grid.betas, index_bits(rows.c)),
            shape("I2", rows.i2, grid.alphas, index_bits(rows.i1)),
            shape("M", rows.m, 1, index_bits(rows.p2) + index_bits(rows.i2)),
            indexed("P3", rows.p3, grid.thetas, rows.m, &self.p3),
            indexed("P4", rows.p4, grid.phis, rows.p3, &self.p4),
        ]
    }

    /// P6 of every material and level.
    fn texture_shapes(&self) -> impl Iterator<Item = Shape> + '_ {
        self.materials.iter().flat_map(move |material| {
            let entry_bits = index_bits(self.rows.p4) + material.scale.bits;
            let rows = material.info.level_lens();
            rows.map(move |rows| Shape { name: "P6", rows, len: 1, entry_bits })
        })
    }

    /// Returns the names of all streams, in order: the books, then `P6.material.level`.
    pub fn stream_names(&self) -> Vec<String> {
        let textures = self.materials.iter().enumerate().flat_map(|(index, material)| {
            (0..material.info.levels).map(move |level| format!("P6.{index}.{level}"))
        });
        self.shapes().iter().map(|s| s.name.to_owned()).chain(textures).collect()
    }

    fn check(&self) -> Result<(), VqError> {
        self.grid.check()?;
        let refuse = |what, found: String, expected| Err(VqError::Header { what, found, expected });
        let scales = self.materials.iter().map(|m| &m.scale);
        let quantizers = [&self.p1, &self.c[0], &self.c[1], &self.p2, &self.p3, &self.p4];
        if let Some(bad) = quantizers.into_iter().chain(scales).find(|q| !q.is_sound()) {
            return refuse("a quantizer", format!("{bad:?}"), "1 to 16 bits of a finite range");
        }
        if let Some(bad) = quantizers[..3].iter().find(|q| q.bits != VALUE_BITS) {
            return refuse("bits of values", bad.bits.to_string(), "8");
        }
        for material in &self.materials {
            material.info.check()?;
        }
        if let Some(bad) = self.shapes().iter().find(|s| s.rows == 0 || s.rows > 1 << 30) {
            return refuse("rows of a book", format!("{} in {}", bad.rows, bad.name), "1 to 2^30");
        }
        match self.shapes().into_iter().find(|s| s.entry_bits > MAX_ENTRY_BITS) {
            Some(bad) => refuse("bits of an entry", bad.entry_bits.to_string(), "at most 56"),
            None => Ok(()),
        }
    }
}

/// The bytes that a model reads from: owned, or a mapped file.
pub type SharedBytes = Arc<dyn AsRef<[u8]> + Send + Sync>;

/// A BTF in packed codebooks. Every index was checked when the model was made; reading never goes out of bounds.
#[derive(Clone)]
pub struct VqModel {
    header: Header,
    bytes: SharedBytes,
    ranges: Vec<Range<usize>>,
}

impl std::fmt::Debug for VqModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("VqModel").field("header", &self.header).finish_non_exhaustive()
    }
}

impl VqModel {
    /// Returns a model made from its header and the ranges in `bytes` of each of [`Header::stream_names`].
    ///
    /// # Errors
    ///
    /// [`VqError::Header`], [`VqError::Grid`], [`VqError::Stream`], [`VqError::Index`].
    pub fn new(
        header: Header,
        bytes: SharedBytes,
        ranges: Vec<Range<usize>>,
    ) -> Result<Self, VqError> {
        header.check()?;
        let model = Self { header, bytes, ranges };
        model.check_streams()?;
        model.check_indices()?;
        Ok(model)
    }

    fn check_streams(&self) -> Result<(), VqError> {
        let shapes = self.header.shapes().into_iter().chain(self.header.texture_shapes());
        let (all, mut ranges) = ((*self.bytes).as_ref(), self.ranges.iter());
        for shape in shapes {
            let Shape { name, rows, len, entry_bits } = shape;
            let expected = rows.checked_mul(len).and_then(|n| packed_len(n, entry_bits));
            let found = ranges.next().and_then(|r| all.get(r.clone())).map_or(0, <[u8]>::len);
            if expected != Some(found) {
                let expected = expected.unwrap_or(usize::MAX);
                return Err(VqError::Stream { book: name, found, expected, rows });
            }
        }
        Ok(())
    }

    fn check_indices(&self) -> Result<(), VqError> {
        let (header, rows) = (&self.header, &self.header.rows);
        let targets = [
            (1, "P1", rows.p1),
            (3, "C", rows.c),
            (4, "I1", rows.i1),
            (5, "P2", rows.p2),
            (6, "M", rows.m),
            (7, "P3", rows.p3),
        ];
        let shapes = header.shapes();
        for (book, target, target_rows) in targets {
            self.check_book(book, &shapes[book], 0, target, target_rows)?;
        }
        self.check_book(5, &shapes[5], index_bits(rows.p2), "I2", rows.i2)?;
        for (at, shape) in header.texture_shapes().enumerate() {
            self.check_book(shapes.len() + at, &shape, 0, "P4", rows.p4)?;
        }
        Ok(())
    }

    fn check_book(
        &self,
        stream: usize,
        shape: &Shape,
        shift: u32,
        target: &'static str,
        rows: usize,
    ) -> Result<(), VqError> {
        // An index of so many bits can only be too large if the rows are no power of two.
        let mask = (1_u64 << index_bits(rows)) - 1;
        let entries = PackedEntries::new(self.stream(stream), shape.entry_bits);
        let bad = (0..shape.rows * shape.len)
            .map(|at| (at, (entries.get(at) >> shift) & mask))
            .find(|(_, index)| *index >= rows as u64);
        match bad {
            Some((at, index)) => Err(VqError::Index {
                book: shape.name,
                row: at / shape.len,
                index: u32::try_from(index).unwrap_or(u32::MAX),
                target,
                rows,
            }),
            None => Ok(()),
        }
    }

    /// Packs books and textures into bits. Every scale loses what its bits cannot hold.
    ///
    /// # Errors
    ///
    /// [`VqError::Header`] where a book is empty or an entry would need more than 56 bits.
    pub fn pack(
        books: &Codebooks,
        materials: &[CompressedTexture],
        bits: ScaleBits,
    ) -> Result<Self, VqError> {
        let quantize = |width: u32, values: &[f32]| {
            let spacing =
                if bits.always_log { Quantizer::logarithmic } else { Quantizer::for_scales };
            spacing(width, values)
        };
        let column = |c: usize| {
            Quantizer::linear(VALUE_BITS, books.c.values.iter().skip(c).step_by(2).copied())
        };
        let header = Header {
            grid: books.grid,
            encoding: books.encoding,
            chroma: books.chroma,
            rows: BookRows::of(books),
            // Densities along β are peaks and floors, where radiance is linear.
            p1: match (bits.always_log, books.encoding) {
                (true, Encoding::Linear) => Quantizer::logarithmic(VALUE_BITS, &books.p1.values),
                _ => Quantizer::linear(VALUE_BITS, books.p1.values.iter().copied()),
            },
            c: [column(0), column(1)],
            p2: quantize(bits.p2, &books.p2.scale),
            p3: quantize(bits.p3, &books.p3.scale),
            p4: quantize(bits.p4, &books.p4.scale),
            materials: materials
                .iter()
                .map(|material| TextureHeader {
                    info: material.info.clone(),
                    scale: quantize(bits.p6, &all_scales(material)),
                })
                .collect(),
        };
        header.check()?;
        let streams = pack_streams(&header, books, materials);
        let mut bytes = Vec::new();
        let mut ranges = Vec::new();
        for stream in streams {
            ranges.push(bytes.len()..bytes.len() + stream.len());
            bytes.extend(stream);
        }
        Self::new(header, Arc::new(bytes), ranges)
    }

    /// Returns what the streams mean.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Returns the bytes of a stream, by its place in [`Header::stream_names`].
    pub fn stream(&self, at: usize) -> &[u8] {
        let bytes: &[u8] = (*self.bytes).as_ref();
        self.ranges.get(at).and_then(|range| bytes.get(range.clone())).unwrap_or_default()
    }

    /// Returns the name and the bytes of each stream, without headers.
    pub fn stream_bytes(&self) -> Vec<(String, usize)> {
        let names = self.header.stream_names();
        names.into_iter().enumerate().map(|(at, name)| (name, self.stream(at).len())).collect()
    }

    /// Returns the books and textures with the values that their bits hold.
    pub fn unpack(&self) -> (Codebooks, Vec<CompressedTexture>) {
        let Header { grid, rows, .. } = self.header;
        let mut books = Codebooks::new(grid, self.header.encoding, self.header.chroma);
        let header = &self.header;
        books.p1.values = self.values(0, rows.p1 * grid.betas, |_| &header.p1);
        books.c.values = self.values(2, rows.c * 2, |at| &header.c[at % 2]);
        let scaled = |book: &mut IndexCodebook, stream, entries, target, scale: &Quantizer| {
            (book.index, book.scale) = self.scaled(stream, entries, target, scale);
        };
        scaled(&mut books.p2, 1, rows.p2 * grid.alphas, rows.p1, &header.p2);
        scaled(&mut books.p3, 6, rows.p3 * grid.thetas, rows.m, &header.p3);
        scaled(&mut books.p4, 7, rows.p4 * grid.phis, rows.p3, &header.p4);
        books.i1.index = self.plain(3, rows.i1 * grid.betas, index_bits(rows.c));
        books.i2.index = self.plain(4, rows.i2 * grid.alphas, index_bits(rows.i1));
        let low = index_bits(rows.p2);
        let entries = PackedEntries::new(self.stream(5), low + index_bits(rows.i2));
        books.m.index = (0..rows.m)
            .map(|at| entries.get(at))
            .flat_map(|entry| [low_bits(entry, low), low_bits(entry >> low, 32)])
            .collect();
        let mut stream = header.shapes().len();
        let materials = header.materials.iter().map(|material| {
            let lens = material.info.level_lens().enumerate();
            let levels = lens.map(|(level, texels)| {
                let (index, scale) = self.scaled(stream + level, texels, rows.p4, &material.scale);
                IndexCodebook { len: 1, index, scale }
            });
            let levels: Vec<IndexCodebook> = levels.collect();
            stream += material.info.levels;
            CompressedTexture { info: material.info.clone(), levels }
        });
        let materials = materials.collect();
        (books, materials)
    }

    fn values<'a>(
        &self,
        stream: usize,
        count: usize,
        quantizer: impl Fn(usize) -> &'a Quantizer,
    ) -> Vec<f32> {
        let entries = PackedEntries::new(self.stream(stream), quantizer(0).bits);
        (0..count).map(|at| quantizer(at).decode(low_bits(entries.get(at), 32))).collect()
    }

    fn plain(&self, stream: usize, count: usize, bits: u32) -> Vec<u32> {
        let entries = PackedEntries::new(self.stream(stream), bits);
        (0..count).map(|at| low_bits(entries.get(at), 32)).collect()
    }

    fn scaled(
        &self,
        stream: usize,
        count: usize,
        target: usize,
        scale: &Quantizer,
    ) -> (Vec<u32>, Vec<f32>) {
        let bits = index_bits(target);
        let entries = PackedEntries::new(self.stream(stream), bits + scale.bits);
        let table = scale.table();
        (0..count)
            .map(|at| entries.get(at))
            .map(|e| (low_bits(e, bits), table[low_bits(e >> bits, 32) as usize]))
            .unzip()
    }
}

#[expect(clippy::cast_possible_truncation, reason = "masked to at most 32 bits")]
fn low_bits(entry: u64, bits: u32) -> u32 {
    (entry & ((1_u64 << bits) - 1)) as u32
}

fn all_scales(material: &CompressedTexture) -> Vec<f32> {
    material.levels.iter().flat_map(|level| level.scale.iter().copied()).collect()
}

fn pack_streams(
    header: &Header,
    books: &Codebooks,
    materials: &[CompressedTexture],
) -> Vec<Vec<u8>> {
    let rows = &header.rows;
    let values = |book: &ValueBook, q: &dyn Fn(usize) -> Quantizer| {
        let codes = book.values.iter().enumerate().map(|(at, v)| u64::from(q(at).encode(*v)));
        pack(codes, q(0).bits)
    };
    let plain = |book: &IndexCodebook, target| {
        pack(book.index.iter().map(|i| u64::from(*i)), index_bits(target))
    };
    let scaled = |book: &IndexCodebook, target, q: &Quantizer| {
        let bits = index_bits(target);
        let codes = book.scale.iter().map(|s| u64::from(q.encode(*s)) << bits);
        pack(codes.zip(&book.index).map(|(s, i)| s | u64::from(*i)), bits + q.bits)
    };
    let low = index_bits(rows.p2);
    let merged = books.m.index.chunks_exact(2);
    let merged = merged.map(|pair| u64::from(pair[0]) | u64::from(pair[1]) << low);
    let mut streams = vec![
        values(&books.p1, &|_| header.p1),
        scaled(&books.p2, rows.p1, &header.p2),
        values(&books.c, &|at| header.c[at % 2]),
        plain(&books.i1, rows.c),
        plain(&books.i2, rows.i1),
        pack(merged, low + index_bits(rows.i2)),
        scaled(&books.p3, rows.m, &header.p3),
        scaled(&books.p4, rows.p3, &header.p4),
    ];
    for (material, header) in materials.iter().zip(&header.materials) {
        streams.extend(material.levels.iter().map(|l| scaled(l, rows.p4, &header.scale)));
    }
    streams
}
