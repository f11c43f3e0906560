//! BTFs as products of factors: for each channel, a vector of each pair of directions times a vector
//! of each texel.

use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use half::f16;
use half::slice::HalfFloatSliceExt as _;

use crate::bonn_header::{BonnHeader, check_end, read_f32};
use crate::colour_model::{ColourModel, exponentials};
use brdf_io::Cursor;
use brdf_io::FormatError;

/// Images that are multiplied at once: their factors stay in the cache.
const TILE: usize = 256;

/// Factors of a file and how their products become colours.
#[derive(Debug)]
pub(crate) struct Factors {
    channels: [Channel; 3],
    model: ColourModel,
}

/// Factors of one channel.
#[derive(Clone, Copy, Debug)]
struct Channel {
    scalar: Scalar,
    /// Length of the vectors.
    components: usize,
    images: Rows,
    texels: Rows,
}

/// Where the vectors of a channel lie.
#[derive(Clone, Copy, Debug)]
struct Rows {
    /// Where the matrix starts, in bytes.
    start: usize,
    /// Rows from one image or texel to the next, and the row of the first.
    step: usize,
    first: usize,
}

/// How numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scalar {
    F16,
    F32,
    F64,
}

/// Two matrices of rows of `components` numbers.
#[derive(Clone, Copy, Debug)]
struct MatrixPair {
    scalar: Scalar,
    components: usize,
    rows: usize,
    columns: usize,
    /// Where the rows start, and where the columns.
    starts: [usize; 2],
}

impl Factors {
    /// Reads where the factors of each channel lie.
    pub(crate) fn read_decorrelated(
        bytes: &[u8],
        header: &BonnHeader,
        cursor: &mut Cursor<'_>,
    ) -> Result<Self, FormatError> {
        cursor.take(4, "the number of components")?;
        let model = read_model(cursor)?;
        let mut channel = || -> Result<Channel, FormatError> {
            let pair = MatrixPair::read(cursor)?;
            let (images, texels) = pair.sides(header.images(), header.texels(), 1)?;
            Ok(pair.channel(images, texels, 0))
        };
        let channels = [channel()?, channel()?, channel()?];
        check_end(bytes, cursor)?;
        Ok(Self { channels, model })
    }

    /// Reads where the factors of all channels lie, whose rows alternate.
    pub(crate) fn read_joint(
        bytes: &[u8],
        header: &BonnHeader,
        cursor: &mut Cursor<'_>,
        head: bool,
    ) -> Result<Self, FormatError> {
        let model = if head { read_joint_head(cursor)? } else { ColourModel::Rgb };
        cursor.take(4, "the number of components")?;
        let pair = MatrixPair::read(cursor)?;
        let (images, texels) = pair.sides(header.images(), header.texels(), 3)?;
        check_end(bytes, cursor)?;
        Ok(Self { channels: [0, 1, 2].map(|number| pair.channel(images, texels, number)), model })
    }

    /// Multiplies: `out[image][texel][channel]` for consecutive texels.
    pub(crate) fn read_texels(&self, bytes: &[u8], texels: Range<usize>, out: &mut [f32]) {
        for number in 0..3 {
            self.read_channel(bytes, number, texels.clone(), out);
        }
        for texel in out.as_chunks_mut::<3>().0 {
            *texel = self.model.to_rgb(*texel);
        }
    }

    /// Multiplies one channel, and takes exponentials of logarithms.
    fn read_channel(&self, bytes: &[u8], number: usize, texels: Range<usize>, out: &mut [f32]) {
        let channel = &self.channels[number];
        let count = texels.len();
        let spatial = channel.vectors(bytes, channel.texels, texels);
        let spatial = MatRef::from_row_major_slice(&spatial, count, channel.components);
        let mut products = vec![0.0; TILE * count];
        for (tile, places) in out.chunks_mut(3 * count * TILE).enumerate() {
            let images = places.len() / (3 * count);
            let start = tile * TILE;
            let angular = channel.vectors(bytes, channel.images, start..start + images);
            let angular = MatRef::from_row_major_slice(&angular, images, channel.components);
            let products = &mut products[..images * count];
            // One column for each image.
            let product = MatMut::from_column_major_slice_mut(products, count, images);
            matmul(product, Accum::Replace, spatial, angular.transpose(), 1.0, Par::Seq);
            if self.model.is_logarithm(number) {
                exponentials(products);
            }
            for (value, texel) in products.iter().zip(places.as_chunks_mut::<3>().0) {
                texel[number] = *value;
            }
        }
    }
}

/// The colour model of factors channel by channel.
fn read_model(cursor: &mut Cursor<'_>) -> Result<ColourModel, FormatError> {
    let offset = cursor.offset();
    let number = i32::from_le_bytes(cursor.array("the colour model")?);
    let mean = read_triple(cursor)?;
    let rows = [read_triple(cursor)?, read_triple(cursor)?, read_triple(cursor)?];
    ColourModel::of(number, rows, mean).ok_or_else(|| FormatError::Field {
        offset,
        what: "the colour model",
        found: number.to_string(),
        expected: "0 to 5 or 9 to 12".to_owned(),
    })
}

fn read_triple(cursor: &mut Cursor<'_>) -> Result<[f32; 3], FormatError> {
    let mut value = || read_f32(cursor, "the colours of the model");
    Ok([value()?, value()?, value()?])
}

/// Whether logarithms are stored. A height map is skipped.
fn read_joint_head(cursor: &mut Cursor<'_>) -> Result<ColourModel, FormatError> {
    let offset = cursor.offset();
    let version = cursor.u8("the version of the head of factors")?;
    if version > 2 {
        return Err(FormatError::Field {
            offset,
            what: "the version of the head of factors",
            found: version.to_string(),
            expected: "0 to 2".to_owned(),
        });
    }
    let logarithms = version >= 1 && cursor.u32("the way in which the range was reduced")? != 0;
    if version >= 2 {
        let width = cursor.u32("the width of the height map")? as usize;
        let height = cursor.u32("the height of the height map")? as usize;
        cursor.take(width.saturating_mul(height).saturating_mul(2), "the height map")?;
    }
    Ok(if logarithms { ColourModel::LogRgb } else { ColourModel::Rgb })
}

impl MatrixPair {
    /// Reads sizes, and makes sure that the numbers are all there.
    fn read(cursor: &mut Cursor<'_>) -> Result<Self, FormatError> {
        let offset = cursor.offset();
        let scalar = Scalar::read(cursor)?;
        let mut count = |what| cursor.u32(what).map(|count| count as usize);
        let components = count("the number of components")?;
        let rows = count("the number of rows")?;
        let columns = count("the number of columns")?;
        if components == 0 {
            return Err(FormatError::Field {
                offset: offset + 1,
                what: "the number of components",
                found: "0".to_owned(),
                expected: "1 or more".to_owned(),
            });
        }
        let mut skip = |count: usize, what| {
            let start = cursor.offset();
            let length = count.saturating_mul(components).saturating_mul(scalar.size());
            cursor.take(length, what).map(|_| start)
        };
        skip(1, "singular values")?;
        let starts = [skip(rows, "factors of rows")?, skip(columns, "factors of columns")?];
        Ok(Self { scalar, components, rows, columns, starts })
    }

    /// Where the vectors of images and of texels lie, and in which steps: rows, which alternate
    /// between `channels`, may stand for either.
    fn sides(
        &self,
        images: usize,
        texels: usize,
        channels: usize,
    ) -> Result<([usize; 2], [usize; 2]), FormatError> {
        let rows = [self.starts[0], channels];
        let columns = [self.starts[1], 1];
        if self.rows == channels * images && self.columns == texels {
            Ok((rows, columns))
        } else if self.rows == channels * texels && self.columns == images {
            Ok((columns, rows))
        } else {
            Err(FormatError::Field {
                offset: self.starts[0],
                what: "the size of the factors",
                found: format!("{} rows and {} columns", self.rows, self.columns),
                expected: format!(
                    "{} for pairs of directions and {texels} for texels",
                    channels * images
                ),
            })
        }
    }

    fn channel(&self, images: [usize; 2], texels: [usize; 2], number: usize) -> Channel {
        // A side with one row for all channels starts at its first row.
        let rows = |[start, step]: [usize; 2]| Rows { start, step, first: number % step };
        Channel {
            scalar: self.scalar,
            components: self.components,
            images: rows(images),
            texels: rows(texels),
        }
    }
}

impl Channel {
    /// Vectors of consecutive images or texels, one after the other.
    fn vectors(&self, bytes: &[u8], rows: Rows, range: Range<usize>) -> Vec<f32> {
        let length = self.components * self.scalar.size();
        let mut values = Vec::with_capacity(range.len() * self.components);
        // Rows of one channel after the other, or between those of other channels.
        let (runs, run_length) =
            if rows.step == 1 { (1, range.len() * length) } else { (range.len(), length) };
        for run in 0..runs {
            let row = rows.first + rows.step * (range.start + run);
            let start = rows.start + row * length;
            self.scalar.append(&bytes[start..start + run_length], &mut values);
        }
        values
    }
}

impl Scalar {
    fn read(cursor: &mut Cursor<'_>) -> Result<Self, FormatError> {
        let offset = cursor.offset();
        match cursor.u8("the size of numbers")? {
            2 => Ok(Self::F16),
            4 => Ok(Self::F32),
            8 => Ok(Self::F64),
            other => Err(FormatError::Field {
                offset,
                what: "the size of numbers",
                found: other.to_string(),
                expected: "2, 4 or 8 bytes".to_owned(),
            }),
        }
    }

    fn size(self) -> usize {
        match self {
            Self::F16 => 2,
            Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "values are given out in f32")]
    fn append(self, bytes: &[u8], values: &mut Vec<f32>) {
        match self {
            Self::F16 => {
                let chunks = bytes.as_chunks::<2>().0;
                let halves: Vec<f16> = chunks.iter().map(|c| f16::from_le_bytes(*c)).collect();
                let start = values.len();
                values.resize(start + halves.len(), 0.0);
                halves.convert_to_f32_slice(&mut values[start..]);
            }
            Self::F32 => {
                let chunks = bytes.as_chunks::<4>().0;
                values.extend(chunks.iter().map(|chunk| f32::from_le_bytes(*chunk)));
            }
            Self::F64 => {
                let chunks = bytes.as_chunks::<8>().0;
                values.extend(chunks.iter().map(|chunk| f64::from_le_bytes(*chunk) as f32));
            }
        }
    }
}
