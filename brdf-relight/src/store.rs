//! Kept coefficients of many vertices, ordered for relighting.
//!
//! Light has few coefficients, so that coefficients stand together, not vectors: in blocks of 8,192 vectors, for each
//! coefficient the vectors that keep it.

use std::borrow::Cow;

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use crate::chunk::SparseVectors;
use crate::coefficients::Coding;
use crate::cube::TEXELS;
use crate::error::RelightError;
use crate::light::LitCoefficients;

/// Number of vectors of a block; their numbers within it fit sixteen bits.
pub const VERTEX_BLOCK: usize = 8192;

/// Sparse vectors, ordered by coefficient. Borrowed arrays may lie in a mapped file.
#[derive(Clone, Debug, PartialEq)]
pub struct SparseTransport<'a> {
    coding: Coding,
    /// Of each vector, what its codes are multiplied by.
    scales: Cow<'a, [f32]>,
    /// Of each block and coefficient, the first entry; one more at the end of each block.
    offsets: Cow<'a, [u32]>,
    /// Numbers of vectors within their block.
    owners: Cow<'a, [u16]>,
    codes: Codes<'a>,
}

/// Codes of the entries of a [`SparseTransport`].
#[derive(Clone, Debug, PartialEq)]
pub enum Codes<'a> {
    /// Codes of [`Coding::Rgb`].
    Rgb(Cow<'a, [u32]>),
    /// Codes of [`Coding::Scalar`].
    Scalar(Cow<'a, [u16]>),
}

impl Codes<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Rgb(codes) => codes.len(),
            Self::Scalar(codes) => codes.len(),
        }
    }

    fn word(&self, at: usize) -> u32 {
        match self {
            Self::Rgb(codes) => codes[at],
            Self::Scalar(codes) => codes[at].into(),
        }
    }
}

impl SparseTransport<'static> {
    /// Returns the vectors of vertices, or of components, each of which has the same number of terms, ordered by
    /// coefficient.
    pub fn of(coding: Coding, vertices: &[&SparseVectors]) -> Self {
        let scales: Vec<f32> =
            vertices.iter().flat_map(|v| &v.largest).map(|v| v / coding.top()).collect();
        // Where each vector's entries start within its vertex.
        let vectors: Vec<(&SparseVectors, usize, usize)> = vertices
            .iter()
            .flat_map(|vertex| {
                let ends = vertex.counts.iter().scan(0, |end, count| {
                    let start = *end;
                    *end += usize::from(*count);
                    Some((*vertex, start, *end))
                });
                ends.collect::<Vec<_>>()
            })
            .collect();
        let blocks: Vec<(Vec<u32>, Vec<u16>, Vec<u32>)> =
            vectors.par_chunks(VERTEX_BLOCK).map(ordered).collect();
        let (mut offsets, mut owners, mut codes) = (Vec::new(), Vec::new(), Vec::new());
        for (starts, own, code) in blocks {
            let base = u32::try_from(owners.len()).unwrap_or(u32::MAX);
            offsets.extend(starts.into_iter().map(|start| base + start));
            owners.extend(own);
            codes.extend(code);
        }
        let codes = match coding {
            Coding::Rgb => Codes::Rgb(codes.into()),
            Coding::Scalar => {
                let low = |code: &u32| u16::try_from(code & 0xffff).unwrap_or(0);
                Codes::Scalar(codes.iter().map(low).collect::<Vec<_>>().into())
            }
        };
        Self {
            coding,
            scales: scales.into(),
            offsets: offsets.into(),
            owners: owners.into(),
            codes,
        }
    }
}

/// The entries of a block by coefficient: starts, owners, codes.
fn ordered(vectors: &[(&SparseVectors, usize, usize)]) -> (Vec<u32>, Vec<u16>, Vec<u32>) {
    let mut starts = vec![0_u32; TEXELS + 1];
    let entries = |(vertex, start, end): &(&SparseVectors, usize, usize)| {
        *start..(*end).min(vertex.places.len())
    };
    for vector in vectors {
        for at in entries(vector) {
            starts[usize::from(vector.0.places[at]) + 1] += 1;
        }
    }
    for at in 0..TEXELS {
        starts[at + 1] += starts[at];
    }
    let total = starts[TEXELS] as usize;
    let (mut owners, mut codes) = (vec![0; total], vec![0; total]);
    let mut next = starts.clone();
    for (number, vector) in vectors.iter().enumerate() {
        for at in entries(vector) {
            let place = &mut next[usize::from(vector.0.places[at])];
            owners[*place as usize] = u16::try_from(number).unwrap_or(u16::MAX);
            codes[*place as usize] = vector.0.codes[at];
            *place += 1;
        }
    }
    (starts, owners, codes)
}

impl<'a> SparseTransport<'a> {
    /// Returns transport made from its arrays, in the form that [`SparseTransport::parts`] returns.
    ///
    /// # Errors
    ///
    /// [`RelightError::Transport`] unless they fit together: offsets that ascend to the number of entries, owners within
    /// their block, finite scales.
    pub fn new(
        scales: Cow<'a, [f32]>,
        offsets: Cow<'a, [u32]>,
        owners: Cow<'a, [u16]>,
        codes: Codes<'a>,
    ) -> Result<Self, RelightError> {
        let refuse = |found: String, expected| Err(RelightError::Transport { found, expected });
        let (vectors, entries) = (scales.len(), owners.len());
        if codes.len() != entries {
            return refuse(format!("{} codes of {entries} entries", codes.len()), "as many");
        }
        if offsets.len() != vectors.div_ceil(VERTEX_BLOCK) * (TEXELS + 1) {
            return refuse(format!("{} offsets", offsets.len()), "24,577 for each 8,192 vectors");
        }
        let ascends = offsets.windows(2).all(|pair| pair[0] <= pair[1]);
        let first = offsets.first().is_none_or(|first| *first == 0);
        let last = offsets.last().map_or(0, |last| *last as usize);
        if !(ascends && first && last == entries) {
            return refuse(
                format!("offsets up to {last}"),
                "offsets that ascend from 0 to the number of entries",
            );
        }
        for (block, starts) in offsets.chunks_exact(TEXELS + 1).enumerate() {
            let own = &owners[starts[0] as usize..starts[TEXELS] as usize];
            let count = (vectors - block * VERTEX_BLOCK).min(VERTEX_BLOCK);
            let next = offsets.get((block + 1) * (TEXELS + 1));
            if own.iter().any(|owner| usize::from(*owner) >= count)
                || next.is_some_and(|next| *next != starts[TEXELS])
            {
                return refuse(
                    format!("an entry beyond block {block}"),
                    "entries of vectors of their block",
                );
            }
        }
        if !scales.iter().all(|scale| scale.is_finite()) {
            return refuse("a scale that is not finite".to_owned(), "finite scales");
        }
        let coding = match codes {
            Codes::Rgb(_) => Coding::Rgb,
            Codes::Scalar(_) => Coding::Scalar,
        };
        Ok(Self { coding, scales, offsets, owners, codes })
    }

    /// Returns scales, offsets, owners and codes.
    pub fn parts(&self) -> (&[f32], &[u32], &[u16], &Codes<'a>) {
        (&self.scales, &self.offsets, &self.owners, &self.codes)
    }

    /// Returns how values are stored.
    pub fn coding(&self) -> Coding {
        self.coding
    }

    /// Returns the number of vectors: vertices times terms.
    pub fn vectors(&self) -> usize {
        self.scales.len()
    }

    /// Returns the number of kept coefficients.
    pub fn entries(&self) -> usize {
        self.owners.len()
    }

    /// Returns the bytes that it takes as stored: entries, scales and offsets.
    pub fn bytes(&self) -> usize {
        (2 + self.coding.bytes()) * self.entries() + 4 * (self.scales.len() + self.offsets.len())
    }

    /// Returns transport that keeps the `count` largest coefficients of each vector; of equal ones the first.
    pub fn largest(&self, count: usize) -> SparseTransport<'static> {
        let top = self.coding.top();
        let empty = |scale: &f32| SparseVectors {
            largest: vec![scale * top],
            counts: vec![0],
            ..Default::default()
        };
        let mut vectors: Vec<SparseVectors> = self.scales.iter().map(empty).collect();
        for (block, starts) in self.offsets.chunks_exact(TEXELS + 1).enumerate() {
            for (place, ends) in (0_u16..).zip(starts.windows(2)) {
                for at in ends[0] as usize..ends[1] as usize {
                    let vector = &mut vectors[block * VERTEX_BLOCK + usize::from(self.owners[at])];
                    vector.places.push(place);
                    vector.codes.push(self.codes.word(at));
                }
            }
        }
        vectors.par_iter_mut().for_each(|vector| {
            let size = |code: u32| self.coding.decode(code).iter().map(|v| v * v).sum::<f32>();
            let mut order: Vec<usize> = (0..vector.codes.len()).collect();
            order.sort_by(|a, b| size(vector.codes[*b]).total_cmp(&size(vector.codes[*a])));
            order.truncate(count);
            order.sort_unstable();
            vector.places = order.iter().map(|at| vector.places[*at]).collect();
            vector.codes = order.iter().map(|at| vector.codes[*at]).collect();
            vector.counts[0] = u16::try_from(order.len()).unwrap_or(u16::MAX);
        });
        SparseTransport::of(self.coding, &vectors.iter().collect::<Vec<_>>())
    }

    /// Writes the products of all vectors with light into `out`, red, green and blue for each.
    ///
    /// # Panics
    ///
    /// Unless `out` has room for each vector.
    pub fn relight(&self, light: &LitCoefficients, out: &mut [[f32; 3]]) {
        assert_eq!(out.len(), self.vectors(), "room for each vector");
        let blocks = out.par_chunks_mut(VERTEX_BLOCK).zip(self.scales.par_chunks(VERTEX_BLOCK));
        blocks.enumerate().for_each_init(
            || vec![Vec4::ZERO; VERTEX_BLOCK],
            |sums, (block, (out, scales))| {
                let starts = &self.offsets[block * (TEXELS + 1)..][..TEXELS + 1];
                sums.fill(Vec4::ZERO);
                pulp::Arch::new().dispatch(AddBlock { transport: self, light, starts, sums });
                for ((value, sum), scale) in out.iter_mut().zip(sums.iter()).zip(scales) {
                    *value = (scale * sum.truncate()).to_array();
                }
            },
        );
    }
}

/// Adds the products of a block to sums, which have a fourth number for the sake of speed.
struct AddBlock<'a> {
    transport: &'a SparseTransport<'a>,
    light: &'a LitCoefficients,
    starts: &'a [u32],
    sums: &'a mut [Vec4],
}

impl pulp::NullaryFnOnce for AddBlock<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { transport, light, starts, sums } = self;
        for (place, light) in light.places().iter().zip(light.values()) {
            let light = Vec3::from_array(*light).extend(0.0);
            let place = usize::from(*place);
            let entries = starts[place] as usize..starts[place + 1] as usize;
            let owners = &transport.owners[entries.clone()];
            match &transport.codes {
                Codes::Rgb(codes) => {
                    for (owner, code) in owners.iter().zip(&codes[entries]) {
                        let value = Vec3::from_array(Coding::Rgb.decode(*code)).extend(0.0);
                        sums[usize::from(*owner)] += light * value;
                    }
                }
                Codes::Scalar(codes) => {
                    for (owner, code) in owners.iter().zip(&codes[entries]) {
                        let [x, _, _] = Coding::Scalar.decode(u32::from(*code));
                        sums[usize::from(*owner)] += light * x;
                    }
                }
            }
        }
    }
}
