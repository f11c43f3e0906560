//! How texels are stored: as f32, as f16, or in eight bits between a smallest and a largest value.

use half::f16;
use serde::{Deserialize, Serialize};

/// The number of channels that a texel has room for.
const CHANNELS: usize = 4;

/// The way in which the log values of a texture are stored.
///
/// ```
/// use brdf_factor::TexelFormat;
///
/// // 24² texels of three channels; eight bits come with six numbers more, the ends of three ranges.
/// let bytes = |format: TexelFormat| format.bytes(24 * 24, 3);
/// assert_eq!(bytes(TexelFormat::F32), 6_912);
/// assert_eq!(bytes(TexelFormat::F16), 3_456);
/// assert_eq!(bytes(TexelFormat::U8), 1_728 + 24);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum TexelFormat {
    /// Single precision.
    #[default]
    F32,
    /// Half precision.
    F16,
    /// 256 even steps from the smallest to the largest value of each channel of a texture.
    U8,
}

impl TexelFormat {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::F32, Self::F16, Self::U8];

    /// Returns the name, as records have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F16 => "f16",
            Self::U8 => "u8",
        }
    }

    /// Returns whether this is single precision, the format of what is fitted.
    pub fn is_f32(&self) -> bool {
        *self == Self::F32
    }

    /// Returns the bytes of one value.
    pub fn value_bytes(self) -> usize {
        match self {
            Self::F32 => 4,
            Self::F16 => 2,
            Self::U8 => 1,
        }
    }

    /// Returns the bytes of the ranges of a texture: two f32 for each channel of eight bits.
    pub fn range_bytes(self, channels: usize) -> usize {
        if self == Self::U8 { 2 * size_of::<f32>() * channels } else { 0 }
    }

    /// Returns the bytes of a texture of so many texels, ranges included.
    pub fn bytes(self, texels: usize, channels: usize) -> usize {
        self.value_bytes() * texels * channels + self.range_bytes(channels)
    }

    /// Returns how many texels so many textures can have in these bytes, all together; 0 where their ranges alone
    /// take more.
    pub fn texels_within(self, bytes: usize, textures: usize, channels: usize) -> usize {
        let rest = bytes.saturating_sub(textures * self.range_bytes(channels));
        rest / (self.value_bytes() * channels.max(1))
    }
}

/// The format of a texture's texels, with the smallest and largest value of each channel of eight bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Coding {
    F32,
    F16,
    U8([Range; CHANNELS]),
}

/// The ends of the values of a channel.
pub(crate) type Range = [f32; 2];

impl Coding {
    /// The coding of these texels in a format.
    pub(crate) fn of(format: TexelFormat, texels: &[[f64; CHANNELS]]) -> Self {
        match format {
            TexelFormat::F32 => Self::F32,
            TexelFormat::F16 => Self::F16,
            TexelFormat::U8 => Self::U8(std::array::from_fn(|channel| {
                let values = texels.iter().map(|texel| texel[channel]);
                let [low, high] = ends(values);
                [narrow(low), narrow(high)]
            })),
        }
    }

    pub(crate) fn format(&self) -> TexelFormat {
        match self {
            Self::F32 => TexelFormat::F32,
            Self::F16 => TexelFormat::F16,
            Self::U8(_) => TexelFormat::U8,
        }
    }

    /// The nearest value that can be stored in a channel.
    pub(crate) fn nearest(&self, channel: usize, value: f64) -> f32 {
        match self {
            Self::F32 => narrow(value),
            Self::F16 => f16::from_f64(value).to_f32(),
            Self::U8(ranges) => decoded(code(value, ranges[channel]), ranges[channel]),
        }
    }
}

/// The smallest and the largest of some values; 0 twice of none.
pub(crate) fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    });
    if low <= high { [low, high] } else { [0.0; 2] }
}

/// The code of the value nearest to this one.
fn code(value: f64, [low, high]: Range) -> u8 {
    let (low, high) = (f64::from(low), f64::from(high));
    if high <= low {
        return 0;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 255")]
    let code = ((value - low) / (high - low) * 255.0).round().clamp(0.0, 255.0) as u8;
    code
}

/// The value of a code.
fn decoded(code: u8, [low, high]: Range) -> f32 {
    let (low, high) = (f64::from(low), f64::from(high));
    narrow(low + (high - low) * (f64::from(code) / 255.0))
}

#[expect(clippy::cast_possible_truncation, reason = "texels are evaluated as f32")]
fn narrow(value: f64) -> f32 {
    value as f32
}

/// The texels of one texture as a file holds them.
///
/// A value in eight bits is low + (high − low) · code / 255, rounded to f32.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredTexels {
    /// How values are stored.
    pub format: TexelFormat,
    /// Values in little-endian order, row by row, the channels of a texel side by side.
    pub bytes: Vec<u8>,
    /// Smallest and largest value of each channel in eight bits; empty of other formats.
    pub ranges: Vec<[f32; 2]>,
}

impl StoredTexels {
    pub(crate) fn of(texels: &[[f32; CHANNELS]], coding: &Coding, channels: usize) -> Self {
        let channels = channels.min(CHANNELS);
        let values = texels.iter().flat_map(|texel| texel[..channels].iter().enumerate());
        let bytes = match coding {
            Coding::F32 => values.flat_map(|(_, v)| v.to_le_bytes()).collect(),
            Coding::F16 => values.flat_map(|(_, v)| f16::from_f32(*v).to_le_bytes()).collect(),
            Coding::U8(ranges) => values.map(|(c, v)| code(f64::from(*v), ranges[c])).collect(),
        };
        let ranges = match coding {
            Coding::U8(ranges) => ranges[..channels].to_vec(),
            _ => Vec::new(),
        };
        Self { format: coding.format(), bytes, ranges }
    }

    /// The texels and their coding; none unless there are ranges just for the channels of eight bits, all in order.
    pub(crate) fn read(&self, channels: usize) -> Option<(Vec<[f32; CHANNELS]>, Coding)> {
        let has_ranges = if self.format == TexelFormat::U8 { channels } else { 0 };
        let is_range =
            |range: &Range| range.iter().all(|end| end.is_finite()) && range[0] <= range[1];
        if !(1..=CHANNELS).contains(&channels)
            || self.ranges.len() != has_ranges
            || !self.ranges.iter().all(is_range)
        {
            return None;
        }
        let mut ranges = [[0.0; 2]; CHANNELS];
        ranges[..has_ranges].copy_from_slice(&self.ranges);
        let texel = |values: &mut dyn Iterator<Item = f32>| {
            let mut texel = [0.0; CHANNELS];
            texel.iter_mut().zip(values).for_each(|(texel, value)| *texel = value);
            texel
        };
        let texels = self.bytes.chunks_exact(channels * self.format.value_bytes());
        Some(match self.format {
            TexelFormat::F32 => {
                let read = |bytes: &[u8]| {
                    let (values, _) = bytes.as_chunks::<4>();
                    texel(&mut values.iter().map(|bytes| f32::from_le_bytes(*bytes)))
                };
                (texels.map(read).collect(), Coding::F32)
            }
            TexelFormat::F16 => {
                let read = |bytes: &[u8]| {
                    let (values, _) = bytes.as_chunks::<2>();
                    texel(&mut values.iter().map(|bytes| f16::from_le_bytes(*bytes).to_f32()))
                };
                (texels.map(read).collect(), Coding::F16)
            }
            TexelFormat::U8 => {
                let read = |codes: &[u8]| {
                    texel(&mut codes.iter().zip(ranges).map(|(code, range)| decoded(*code, range)))
                };
                (texels.map(read).collect(), Coding::U8(ranges))
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn bytes_say_how_many_texels_there_can_be() {
        for format in TexelFormat::ALL {
            for bytes in [0, 50, 96, 1000, 8192] {
                let texels = format.texels_within(bytes, 4, 3);
                let taken = |texels| format.bytes(texels, 3) + 3 * format.bytes(0, 3);
                assert!(texels == 0 || taken(texels) <= bytes, "{format:?} in {bytes}");
                assert!(taken(texels + 1) > bytes, "{format:?} in {bytes}: not one more");
            }
        }
    }

    #[test]
    fn a_channel_of_one_value_takes_one_code() {
        let texels = [[-3.5; CHANNELS]; 4];
        let coding = Coding::of(TexelFormat::U8, &texels);
        assert_eq!(coding.nearest(0, -3.5).to_bits(), (-3.5_f32).to_bits());
        assert_eq!(StoredTexels::of(&[[-3.5; CHANNELS]; 4], &coding, 1).bytes, [0; 4]);
    }

    #[test]
    fn ranges_have_to_fit_the_channels() {
        let of = |format, ranges: &[Range]| {
            StoredTexels { format, bytes: vec![0; 12], ranges: ranges.to_vec() }.read(3)
        };
        let range = [0.0, 1.0];
        assert!(of(TexelFormat::U8, &[range; 3]).is_some());
        assert!(of(TexelFormat::U8, &[range; 2]).is_none());
        assert!(of(TexelFormat::F16, &[range; 3]).is_none());
        for bad in [[1.0, 0.0], [0.0, f32::NAN], [0.0, f32::INFINITY]] {
            assert!(of(TexelFormat::U8, &[range, bad, range]).is_none(), "{bad:?}");
        }
    }

    proptest! {
        #[test]
        fn what_is_stored_is_near_and_comes_back_to_the_bit(
            values in prop::collection::vec(prop::array::uniform4(-30.0..30.0_f64), 1..40),
            scale in prop::sample::select(vec![1.0, 1e-9, 1e3]),
            channels in prop::sample::select(vec![1, 3]),
        ) {
            let texels: Vec<[f64; CHANNELS]> = values
                .iter()
                .map(|texel| std::array::from_fn(|c| if c < channels { scale * texel[c] } else { 0.0 }))
                .collect();
            for format in TexelFormat::ALL {
                let coding = Coding::of(format, &texels);
                let rounded: Vec<[f32; CHANNELS]> = texels
                    .iter()
                    .map(|texel| std::array::from_fn(|c| coding.nearest(c, texel[c])))
                    .collect();
                for channel in 0..channels {
                    let [low, high] = ends(texels.iter().map(|texel| texel[channel]));
                    let largest = low.abs().max(high.abs());
                    let step = match format {
                        TexelFormat::F32 => largest / f64::from(1 << 23),
                        // Below 6e-5 steps are even.
                        TexelFormat::F16 => largest.max(6.2e-5) / f64::from(1 << 10),
                        TexelFormat::U8 => (high - low) / 255.0,
                    };
                    for (texel, rounded) in texels.iter().zip(&rounded) {
                        let off = (f64::from(rounded[channel]) - texel[channel]).abs();
                        prop_assert!(off <= 0.5 * step + 1e-7 * largest, "{format:?}: off by {off}");
                    }
                }
                let stored = StoredTexels::of(&rounded, &coding, channels);
                prop_assert_eq!(
                    stored.bytes.len() + 8 * stored.ranges.len(),
                    format.bytes(texels.len(), channels)
                );
                let (back, again) = stored.read(channels).expect("sound");
                prop_assert_eq!(&back, &rounded);
                prop_assert_eq!(StoredTexels::of(&back, &again, channels), stored);
            }
        }

        /// Whatever the codes and ranges of a file are, writing it again changes no texel.
        #[test]
        fn any_codes_come_back(
            codes in prop::collection::vec(any::<u8>(), 1..30),
            low in prop_oneof![-1e3..1e3_f32, Just(-1.0e30_f32), Just(1.0)],
            width in prop_oneof![Just(0.0_f32), 0.0..1e-6_f32, 0.0..1e3_f32, Just(1e30)],
        ) {
            let ranges = vec![[low, low + width]];
            let stored = StoredTexels { format: TexelFormat::U8, bytes: codes, ranges };
            let (texels, coding) = stored.read(1).expect("sound");
            let (again, _) = StoredTexels::of(&texels, &coding, 1).read(1).expect("sound");
            prop_assert_eq!(again, texels);
        }
    }
}
