//! A binary arithmetic coder whose probabilities follow what was coded, and integers made of its bits.
//!
//! The range coder is that of LZMA (I. Pavlov): 32 bits of range, carries kept back. A probability moves by
//! a share of its error that falls with the number of bits it has seen, which suits streams of a few
//! thousand numbers.

/// Bits of precision of a probability.
const PRECISION: u32 = 16;
/// Bits that a probability remembers at most.
const MEMORY: u16 = 60;
const TOP: u32 = 1 << 24;

/// The probability that a bit is 0, and how many bits it was learnt from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bit {
    zero: u16,
    seen: u16,
}

impl Default for Bit {
    fn default() -> Self {
        Self { zero: 1 << (PRECISION - 1), seen: 0 }
    }
}

impl Bit {
    fn learn(&mut self, bit: bool) {
        let target: i32 = if bit { 64 } else { (1 << PRECISION) - 64 };
        let step = (target - i32::from(self.zero)) * 2 / (2 * i32::from(self.seen) + 3);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "stays between the two targets"
        )]
        {
            self.zero = (i32::from(self.zero) + step) as u16;
        }
        self.seen = (self.seen + 1).min(MEMORY);
    }

    fn bound(self, range: u32) -> u32 {
        (range >> PRECISION) * u32::from(self.zero)
    }
}

/// Takes bits and makes bytes of them.
#[derive(Debug)]
pub(crate) struct Encoder {
    low: u64,
    range: u32,
    cache: u8,
    /// Bytes that a carry may still change, the cached one included.
    held: usize,
    bytes: Vec<u8>,
}

impl Encoder {
    pub(crate) fn new() -> Self {
        Self { low: 0, range: u32::MAX, cache: 0, held: 1, bytes: Vec::new() }
    }

    pub(crate) fn bit(&mut self, model: &mut Bit, bit: bool) {
        let bound = model.bound(self.range);
        if bit {
            self.low += u64::from(bound);
            self.range -= bound;
        } else {
            self.range = bound;
        }
        model.learn(bit);
        while self.range < TOP {
            self.range <<= 8;
            self.shift();
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "bytes are cut out of a word")]
    fn shift(&mut self) {
        if self.low < 0xff00_0000 || self.low > u64::from(u32::MAX) {
            let carry = (self.low >> 32) as u8;
            for index in 0..self.held {
                let byte = if index == 0 { self.cache } else { 0xff };
                self.bytes.push(byte.wrapping_add(carry));
            }
            self.held = 0;
            self.cache = (self.low >> 24) as u8;
        }
        self.held += 1;
        self.low = (self.low & 0x00ff_ffff) << 8;
    }

    /// Returns the bytes; zeros at the end, which a decoder adds by itself, are cut.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        for _ in 0..5 {
            self.shift();
        }
        while self.bytes.last() == Some(&0) {
            self.bytes.pop();
        }
        // The first byte is what was held at the start: 0, as no carry reaches it.
        self.bytes.drain(..self.bytes.len().min(1));
        self.bytes
    }
}

/// Takes the bytes of an [`Encoder`] and returns its bits, given the same models in the same order.
#[derive(Debug)]
pub(crate) struct Decoder<'a> {
    code: u32,
    range: u32,
    bytes: std::slice::Iter<'a, u8>,
}

impl<'a> Decoder<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let mut made = Self { code: 0, range: u32::MAX, bytes: bytes.iter() };
        for _ in 0..4 {
            made.code = made.code << 8 | made.next();
        }
        made
    }

    fn next(&mut self) -> u32 {
        self.bytes.next().copied().unwrap_or(0).into()
    }

    pub(crate) fn bit(&mut self, model: &mut Bit) -> bool {
        let bound = model.bound(self.range);
        let bit = self.code >= bound;
        if bit {
            self.code -= bound;
            self.range -= bound;
        } else {
            self.range = bound;
        }
        model.learn(bit);
        while self.range < TOP {
            self.range <<= 8;
            self.code = self.code << 8 | self.next();
        }
        bit
    }
}

/// Either end of a stream: a description of what stands in it serves both.
pub(crate) trait Coder {
    /// Codes a bit: an encoder takes `bit`, a decoder returns what it reads.
    fn code(&mut self, model: &mut Bit, bit: bool) -> bool;
}

impl Coder for Encoder {
    fn code(&mut self, model: &mut Bit, bit: bool) -> bool {
        self.bit(model, bit);
        bit
    }
}

impl Coder for Decoder<'_> {
    fn code(&mut self, model: &mut Bit, _: bool) -> bool {
        self.bit(model)
    }
}

/// Largest number of binary digits of an integer: rounded coefficients end at 4e6, what guesses leave at four times that.
const DIGITS: usize = 24;

/// The model of integers that are expected to be of similar size.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Magnitudes {
    /// Whether there are more digits than this.
    more: [Bit; DIGITS],
    /// The digit after the first, by number of digits.
    second: [Bit; DIGITS],
    sign: Bit,
}

impl Magnitudes {
    /// Codes an integer: its number of binary digits in unary, its digits, its sign.
    pub(crate) fn code(&mut self, coder: &mut impl Coder, value: i32) -> i32 {
        let magnitude = value.unsigned_abs();
        let wanted = (u32::BITS - magnitude.leading_zeros()) as usize;
        let mut digits = 0;
        while digits < DIGITS && coder.code(&mut self.more[digits], digits < wanted) {
            digits += 1;
        }
        if digits == 0 {
            return 0;
        }
        let mut found = 1_u32;
        for digit in (0..digits - 1).rev() {
            let bit = magnitude >> digit & 1 == 1;
            // Lower digits are as good as random.
            let mut even = Bit::default();
            let model = if digit + 2 == digits { &mut self.second[digits - 1] } else { &mut even };
            found = found << 1 | u32::from(coder.code(model, bit));
        }
        let found = found.cast_signed();
        if coder.code(&mut self.sign, value < 0) { -found } else { found }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn integers_come_back(values in prop::collection::vec(-70_000..70_000_i32, 0..300)) {
            let (mut encoder, mut model) = (Encoder::new(), Magnitudes::default());
            for &value in &values {
                model.code(&mut encoder, value);
            }
            let bytes = encoder.finish();
            let (mut decoder, mut model) = (Decoder::new(&bytes), Magnitudes::default());
            for &value in &values {
                prop_assert_eq!(model.code(&mut decoder, 0), value);
            }
        }
    }

    /// Numbers of a known distribution take little more than its entropy.
    #[test]
    fn streams_are_near_the_entropy() {
        let values: Vec<i32> = (0..4000_i32).map(|i| i * i % 7 / 3 - 1).collect();
        let mut counts = [0.0_f64; 3];
        values.iter().for_each(|v| counts[usize::try_from(v + 1).expect("small")] += 1.0);
        let shares = counts.iter().filter(|count| **count > 0.0);
        let entropy: f64 = shares.map(|count| -count * (count / 4000.0).log2() / 8.0).sum();
        let (mut encoder, mut model) = (Encoder::new(), Magnitudes::default());
        values.iter().for_each(|&value| {
            model.code(&mut encoder, value);
        });
        let bytes = encoder.finish().len() as f64;
        assert!(bytes < 1.03 * entropy + 8.0, "{bytes} bytes, entropy {entropy}");
    }
}
