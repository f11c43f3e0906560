//! The model: a stream of a few kilobytes, and the tables that it is read from.

use brdf_model::{Brdf, Channels, DirectionSlices, GgxLobes, Rgb, RgbBatch};
use brdf_param::{DirectionPair, HalfDifference};
use glam::{DVec2, DVec3};

use crate::base::{ALPHAS, from_numbers, length, numbers, value_of};
use crate::basis::CubicBasis;
use crate::batch;
use crate::channel::Channel;
use crate::error::SplineError;
use crate::harmonics::Symmetry;
use crate::nodes::COSINE_MIN;
use crate::products::Shape;
use crate::stream::{Quantized, Steps};
use crate::table::{Tables, table_size};
use crate::warp::HalfAxis;

/// In the first byte of a stream, above lobes, channels and the symmetry.
const VERSION: u8 = 1;
/// Most numbers of the table over θd and φd: several times those of the largest model that is fitted.
const TABLE_MAX: usize = 8_000_000;
/// Most terms.
const TERMS_MAX: usize = 64;
/// Most splines of either side.
const SPLINES_MAX: usize = 200;
/// Largest order of a harmonic.
const ORDER_MAX: usize = 40;

/// An isotropic BRDF as a sum of products of splines over θh and over (θd, φd), of ln(a + f).
///
/// It is never brighter than what was fitted, and keeps its value beyond 87° from the normal. Turning both directions
/// about the normal changes nothing, and exchanging them changes nothing if [`SplineBrdf::symmetry`] says so. It is
/// evaluated from two linear tables, which are made when it is read.
///
/// ```
/// use brdf_job::Job;
/// use brdf_model::{Brdf, Preset};
/// use brdf_param::DirectionPair;
/// use brdf_spline::{SplineBrdf, SplineSettings, fit_splines};
///
/// let gold = Preset::find("ggx").expect("a preset").brdf();
/// let settings = SplineSettings { bytes: 1_000, ..SplineSettings::default() };
/// let fit = fit_splines(&gold, &settings, &Job::new())?;
/// assert!(fit.model.as_bytes().len() <= 1_000 && fit.model.symmetry().is_reciprocal());
///
/// let again = SplineBrdf::from_bytes(fit.model.as_bytes())?;
/// let mirror = DirectionPair::from_angles(0.8, 0.0, 0.8, std::f64::consts::PI);
/// let (found, exact) = (again.eval(&mirror).r, gold.eval(&mirror).r);
/// assert!((found / exact - 1.0).abs() < 0.1, "{found} against {exact}");
/// # Ok::<(), brdf_spline::SplineError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SplineBrdf {
    bytes: Vec<u8>,
    shape: Shape,
    channels: Vec<Channel>,
    base: Option<GgxLobes>,
    tables: Tables,
}

impl SplineBrdf {
    /// Returns the model of a stream.
    ///
    /// # Errors
    ///
    /// [`SplineError::Stream`] if the head of the stream is not one that [`SplineBrdf::as_bytes`] returns. Coefficients
    /// that are cut off read as what follows from zeros.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SplineError> {
        let mut head = Head { rest: bytes };
        let [kind, terms, half, difference, order] = head.array()?;
        let symmetry = Symmetry::ALL[usize::from(kind & 3)];
        let channels = if kind >> 2 & 1 == 1 { 3 } else { 1 };
        within("version of a spline stream", kind >> 6, VERSION, VERSION, "1")?;
        let few = CubicBasis::FEWEST;
        within("number of terms", usize::from(terms), 1, TERMS_MAX, "1 to 64")?;
        within("splines over θh", usize::from(half), few, SPLINES_MAX, "5 to 200")?;
        within("splines over θd", usize::from(difference), few, SPLINES_MAX, "5 to 200")?;
        within("order of harmonics", usize::from(order), 0, ORDER_MAX, "0 to 40")?;
        let alpha = head.f32()?;
        within("α of the axis of θh", alpha, 1e-6, 1.0, "1e-6 to 1")?;
        let sizes = [head.f32()?, head.f32()?];
        for step in sizes {
            within("step of coefficients", step, 1e-12, 1e12, "1e-12 to 1e12")?;
        }
        let mut transforms = Vec::with_capacity(channels);
        for _ in 0..channels {
            let offset = head.f32()?;
            within("offset a", offset, f32::MIN_POSITIVE, 1e30, "a positive number")?;
            let range = [head.f32()?, head.f32()?];
            within("smallest value", range[0], 0.0, 1e30, "0 to 1e30")?;
            within("largest value", range[1], range[0], 1e30, "at least the smallest")?;
            transforms.push(Channel { offset, range });
        }
        let base = match usize::from(kind >> 3 & 7) {
            0 => None,
            lobes => Some(head.base(lobes, channels)?),
        };
        let exponents = head.take(usize::from(terms))?.iter().map(|e| e.cast_signed()).collect();
        let shape = Shape {
            terms: terms.into(),
            half: CubicBasis { count: half.into(), is_even: true },
            axis: HalfAxis { alpha: alpha.into() },
            difference: CubicBasis { count: difference.into(), is_even: false },
            symmetry,
            order: order.into(),
            channels,
        };
        let [rows, columns] = table_size(&shape);
        let numbers = rows * (columns + 1) * shape.terms * shape.channels;
        within("numbers of the table over θd and φd", numbers, 0, TABLE_MAX, "at most 8 million")?;
        let steps = Steps { half: sizes[0], exponents, difference: sizes[1] };
        let quantized = Quantized::decode(shape, steps, head.rest);
        Ok(Self::with_bytes(bytes.to_vec(), &quantized, transforms, base))
    }

    /// Returns the model of coefficients, over a base as it is stored.
    pub(crate) fn new(
        quantized: &Quantized,
        channels: Vec<Channel>,
        base: Option<GgxLobes>,
    ) -> Self {
        let bytes = stream(quantized, &channels, base.as_ref());
        Self::with_bytes(bytes, quantized, channels, base)
    }

    fn with_bytes(
        bytes: Vec<u8>,
        quantized: &Quantized,
        channels: Vec<Channel>,
        base: Option<GgxLobes>,
    ) -> Self {
        let tables = Tables::new(&quantized.products());
        Self { bytes, shape: quantized.shape.clone(), channels, base, tables }
    }

    /// Returns the stream: all that there is to know of the model.
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Returns the number of products.
    pub fn terms(&self) -> usize {
        self.shape.terms
    }

    /// Returns the numbers of splines over θh and over θd, and of harmonics of φd.
    pub fn functions(&self) -> [usize; 3] {
        [self.shape.half.count, self.shape.difference.count, self.shape.harmonics().len()]
    }

    /// Returns the angle α, in radians, up to which splines over θh are evenly spaced.
    pub fn alpha(&self) -> f64 {
        self.shape.axis.alpha
    }

    /// Returns a of ln(a + f) for each channel, sr⁻¹.
    pub fn offsets(&self) -> Vec<f64> {
        self.channels.iter().map(|channel| channel.offset.into()).collect()
    }

    /// Returns the smallest and largest value of each channel, sr⁻¹, that the model returns above the horizon.
    pub fn ranges(&self) -> Vec<[f64; 2]> {
        self.channels.iter().map(|channel| channel.range.map(f64::from)).collect()
    }

    /// Returns the lobes that the products change, if there are any; of luminance, in all three channels.
    pub fn base(&self) -> Option<&GgxLobes> {
        self.base.as_ref()
    }

    /// Returns which exchanges leave the model unchanged.
    pub fn symmetry(&self) -> Symmetry {
        self.shape.symmetry
    }

    /// Returns the channels: one for luminance, or three.
    pub fn channels(&self) -> Channels {
        if self.shape.channels == 1 { Channels::Luminance } else { Channels::Rgb }
    }

    /// Returns the bytes of the tables that the model is read from, in memory.
    pub fn table_bytes(&self) -> usize {
        self.tables.bytes()
    }
}

impl Brdf for SplineBrdf {
    fn eval(&self, pair: &DirectionPair) -> Rgb {
        if pair.wi.z <= 0.0 || pair.wo.z <= 0.0 {
            return Rgb::BLACK;
        }
        let held = DirectionPair::new(hold(pair.wi), hold(pair.wo));
        let angles = HalfDifference::from_pair(&held);
        let y = self.tables.read(angles.theta_h, angles.theta_d, angles.phi_d);
        let base = value_of(self.base.as_ref(), &held);
        let value = |c: usize| self.channels[c].value(y[c], base.map(|base| base[c]));
        match self.channels.len() {
            1 => Rgb::splat(value(0)),
            _ => Rgb::from(std::array::from_fn(value)),
        }
    }

    fn eval_batch(&self, pairs: DirectionSlices<'_>, out: &mut RgbBatch) {
        batch::evaluate(&self.tables, &self.channels, self.base.as_ref(), pairs, out);
    }
}

/// A direction, or the one at its azimuth beyond which models are not fitted.
pub(crate) fn hold(w: DVec3) -> DVec3 {
    if w.z >= COSINE_MIN {
        return w;
    }
    let across = w.truncate().normalize_or(DVec2::X) * (1.0 - COSINE_MIN * COSINE_MIN).sqrt();
    across.extend(COSINE_MIN)
}

/// The bytes of a model.
pub(crate) fn stream(
    quantized: &Quantized,
    channels: &[Channel],
    base: Option<&GgxLobes>,
) -> Vec<u8> {
    let shape = &quantized.shape;
    let symmetry = Symmetry::ALL.iter().position(|s| *s == shape.symmetry).unwrap_or_default();
    #[expect(clippy::cast_possible_truncation, reason = "all counts have limits below 256")]
    let byte = |count: usize| count as u8;
    let lobes = byte(base.map_or(0, |base| base.lobes.len()));
    let kind = VERSION << 6 | lobes << 3 | u8::from(shape.channels == 3) << 2 | byte(symmetry);
    let mut bytes = vec![kind];
    let counts = [shape.terms, shape.half.count, shape.difference.count, shape.order];
    bytes.extend(counts.map(byte));
    #[expect(clippy::cast_possible_truncation, reason = "a setting of three digits")]
    let alpha = shape.axis.alpha as f32;
    bytes.extend(alpha.to_le_bytes());
    bytes.extend(quantized.steps.half.to_le_bytes());
    bytes.extend(quantized.steps.difference.to_le_bytes());
    for channel in channels {
        let numbers = [channel.offset, channel.range[0], channel.range[1]];
        bytes.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
    }
    if let Some(base) = base {
        bytes.extend(numbers(base, channels.len()).iter().flat_map(|v| v.to_le_bytes()));
    }
    bytes.extend(quantized.steps.exponents.iter().map(|e| e.cast_unsigned()));
    bytes.extend(quantized.encode());
    bytes
}

/// The head of a stream.
struct Head<'a> {
    rest: &'a [u8],
}

impl<'a> Head<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], SplineError> {
        let (taken, rest) =
            self.rest.split_at_checked(count).ok_or_else(|| SplineError::Stream {
                what: "bytes left of the head of a spline stream:",
                found: self.rest.len().to_string(),
                expected: "a whole head",
            })?;
        self.rest = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], SplineError> {
        let mut found = [0; N];
        found.copy_from_slice(self.take(N)?);
        Ok(found)
    }

    fn f32(&mut self) -> Result<f32, SplineError> {
        Ok(f32::from_le_bytes(self.array()?))
    }

    fn base(&mut self, lobes: usize, channels: usize) -> Result<GgxLobes, SplineError> {
        let mut numbers = Vec::with_capacity(length(lobes, channels));
        for _ in 0..length(lobes, channels) {
            let number = self.f32()?;
            within("number of a base", number, 0.0, 1e9, "0 to 1e9")?;
            numbers.push(number);
        }
        let base = from_numbers(&numbers, lobes, channels);
        for lobe in &base.lobes {
            // The ends themselves are rounded.
            within("α of a lobe", lobe.alpha, 0.99 * ALPHAS[0], 1.01 * ALPHAS[1], "1e-4 to 10")?;
        }
        Ok(base)
    }
}

fn within<T: PartialOrd + std::fmt::Display>(
    what: &'static str,
    found: T,
    min: T,
    max: T,
    expected: &'static str,
) -> Result<(), SplineError> {
    if found >= min && found <= max {
        Ok(())
    } else {
        Err(SplineError::Stream { what, found: found.to_string(), expected })
    }
}
