//! The model: a stream of a few kilobytes, and the tables that it is read from.

use brdf_model::{Brdf, Channels, DirectionSlices, Rgb, RgbBatch};
use brdf_param::{DirectionPair, HalfDifference};
use glam::{DVec2, DVec3};

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

/// First byte of a stream: a version, above the symmetry and the channels.
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
        within("version of a spline stream", kind >> 3, VERSION, VERSION, "1")?;
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
        Ok(Self::with_bytes(bytes.to_vec(), &quantized, transforms))
    }

    /// Returns the model of coefficients.
    pub(crate) fn new(quantized: &Quantized, channels: Vec<Channel>) -> Self {
        Self::with_bytes(stream(quantized, &channels), quantized, channels)
    }

    fn with_bytes(bytes: Vec<u8>, quantized: &Quantized, channels: Vec<Channel>) -> Self {
        let tables = Tables::new(&quantized.products());
        Self { bytes, shape: quantized.shape.clone(), channels, tables }
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
        match &self.channels[..] {
            [grey] => Rgb::splat(grey.value(y[0])),
            channels => Rgb::from(std::array::from_fn(|c| channels[c].value(y[c]))),
        }
    }

    fn eval_batch(&self, pairs: DirectionSlices<'_>, out: &mut RgbBatch) {
        batch::evaluate(&self.tables, &self.channels, pairs, out);
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
pub(crate) fn stream(quantized: &Quantized, channels: &[Channel]) -> Vec<u8> {
    let shape = &quantized.shape;
    let symmetry = Symmetry::ALL.iter().position(|s| *s == shape.symmetry).unwrap_or_default();
    #[expect(clippy::cast_possible_truncation, reason = "all counts have limits below 256")]
    let byte = |count: usize| count as u8;
    let kind = VERSION << 3 | u8::from(shape.channels == 3) << 2 | byte(symmetry);
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
