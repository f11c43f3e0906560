//! Transport as components that clusters of vertices share.

use std::borrow::Cow;

use rayon::prelude::*;

use crate::chunk::Chunk;
use crate::coefficients::Coding;
use crate::error::RelightError;
use crate::light::LitCoefficients;
use crate::store::SparseTransport;

/// Transport in which each vertex is a weighted sum of the components of its cluster. Borrowed arrays may lie in a
/// mapped file.
#[derive(Clone, Debug, PartialEq)]
pub struct ClusteredTransport<'a> {
    /// `[component][term]`.
    components: SparseTransport<'a>,
    terms: usize,
    /// Of each vertex.
    clusters: Cow<'a, [u16]>,
    /// Of each cluster, its first component; one more at the end.
    first: Cow<'a, [u32]>,
    /// Vertex after vertex, one for each component of its cluster; 32767 for 1.
    weights: Cow<'a, [i16]>,
    /// Where each vertex's weights start; one more at the end.
    starts: Vec<u32>,
}

/// Vertices that a task takes at once.
const TASK: usize = 256;

impl ClusteredTransport<'static> {
    /// Of clusters of vertices, with the components of each.
    pub(crate) fn of(coding: Coding, terms: usize, clusters: &[Vec<u32>], made: &[Chunk]) -> Self {
        let vertices = clusters.iter().map(Vec::len).sum();
        let mut cluster_of = vec![0; vertices];
        let mut weights_of = vec![&[][..]; vertices];
        let mut first = vec![0];
        for (number, (members, made)) in (0_u16..).zip(clusters.iter().zip(made)) {
            let count = made.vectors.len();
            let next = u32::try_from(count).unwrap_or(u32::MAX);
            first.push(first.last().map_or(0, |last| last + next));
            for (at, vertex) in members.iter().enumerate() {
                cluster_of[*vertex as usize] = number;
                weights_of[*vertex as usize] = &made.weights[at * count..][..count];
            }
        }
        let vectors: Vec<_> = made.iter().flat_map(|made| &made.vectors).collect();
        let starts = starts(&cluster_of, &first);
        Self {
            components: SparseTransport::of(coding, &vectors),
            terms,
            clusters: cluster_of.into(),
            first: first.into(),
            weights: weights_of.concat().into(),
            starts,
        }
    }
}

/// Where the weights of each vertex start.
fn starts(clusters: &[u16], first: &[u32]) -> Vec<u32> {
    let counts = clusters.iter().map(|cluster| {
        let at = usize::from(*cluster);
        first[at + 1] - first[at]
    });
    let ends = counts.scan(0_u32, |end, count| {
        *end = end.saturating_add(count);
        Some(*end)
    });
    std::iter::once(0).chain(ends).collect()
}

impl<'a> ClusteredTransport<'a> {
    /// Returns transport made from its arrays, in the form that [`ClusteredTransport::parts`] returns.
    ///
    /// # Errors
    ///
    /// [`RelightError::Transport`] unless they fit together: vertices of clusters that are there, components in the
    /// order of clusters, and a weight for each component of each vertex's cluster.
    pub fn new(
        components: SparseTransport<'a>,
        terms: usize,
        clusters: Cow<'a, [u16]>,
        first: Cow<'a, [u32]>,
        weights: Cow<'a, [i16]>,
    ) -> Result<Self, RelightError> {
        let refuse = |found: String, expected| Err(RelightError::Transport { found, expected });
        let last = first.last().map_or(0, |last| *last as usize);
        let ascends = first.first() == Some(&0) && first.is_sorted();
        if !ascends || terms == 0 || Some(components.vectors()) != last.checked_mul(terms) {
            let found = format!("{} vectors of {last} components", components.vectors());
            return refuse(found, "a vector of each term for each component, in ascending order");
        }
        if let Some(beyond) = clusters.iter().find(|at| usize::from(**at) + 1 >= first.len()) {
            let found = format!("cluster {beyond} of {}", first.len() - 1);
            return refuse(found, "vertices of clusters that are there");
        }
        let starts = starts(&clusters, &first);
        if starts.last().map(|end| *end as usize) != Some(weights.len()) {
            let found = format!("{} weights", weights.len());
            return refuse(found, "one for each component of the cluster of each vertex");
        }
        Ok(Self { components, terms, clusters, first, weights, starts })
    }

    /// Returns the components, the cluster of each vertex, the first component of each cluster, and the weights.
    pub fn parts(&self) -> (&SparseTransport<'a>, &[u16], &[u32], &[i16]) {
        (&self.components, &self.clusters, &self.first, &self.weights)
    }

    /// Number of vectors that it stands for: vertices times terms.
    pub(crate) fn vectors(&self) -> usize {
        self.clusters.len() * self.terms
    }

    /// Returns the number of components of all clusters.
    pub fn components(&self) -> usize {
        self.components.vectors() / self.terms
    }

    /// Returns the number of clusters.
    pub fn clusters(&self) -> usize {
        self.first.len() - 1
    }

    /// Bytes as stored.
    pub(crate) fn bytes(&self) -> usize {
        self.components.bytes()
            + 2 * (self.clusters.len() + self.weights.len())
            + 4 * self.first.len()
    }

    /// Products of all vectors with light, into `out`; `scratch` is memory that is used again.
    pub(crate) fn relight(
        &self,
        light: &LitCoefficients,
        scratch: &mut Vec<[f32; 3]>,
        out: &mut [[f32; 3]],
    ) {
        assert_eq!(out.len(), self.vectors(), "room for each vector");
        scratch.resize(self.components.vectors(), [0.0; 3]);
        self.components.relight(light, scratch);
        let lit = &scratch[..];
        out.par_chunks_mut(TASK * self.terms).enumerate().for_each(|(task, out)| {
            pulp::Arch::new().dispatch(AddComponents {
                transport: self,
                lit,
                first: task * TASK,
                out,
            });
        });
    }
}

/// Adds the components of some vertices.
struct AddComponents<'a> {
    transport: &'a ClusteredTransport<'a>,
    lit: &'a [[f32; 3]],
    first: usize,
    out: &'a mut [[f32; 3]],
}

impl pulp::NullaryFnOnce for AddComponents<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { transport, lit, first, out } = self;
        let terms = transport.terms;
        for (vertex, out) in (first..).zip(out.chunks_exact_mut(terms)) {
            let component = transport.first[usize::from(transport.clusters[vertex])] as usize;
            let [start, end] = [vertex, vertex + 1].map(|at| transport.starts[at] as usize);
            let weights = &transport.weights[start..end];
            let lit = lit[component * terms..][..weights.len() * terms].as_flattened();
            add_all_columns(weights, lit, out.as_flattened_mut());
        }
    }
}

/// Writes weighted sums of the rows of `lit` into `out`, as many columns at once as registers hold: those of sixteen
/// terms, the usual number, then of eight, four and one.
#[inline(always)]
fn add_all_columns(weights: &[i16], lit: &[f32], out: &mut [f32]) {
    let done = add_columns::<48>(weights, lit, out, 0);
    let done = add_columns::<24>(weights, lit, out, done);
    let done = add_columns::<12>(weights, lit, out, done);
    add_columns::<3>(weights, lit, out, done);
}

/// Writes the sums of the columns from `first` on, `N` at once, and returns the first column of those that are left,
/// fewer than `N`.
#[inline(always)]
fn add_columns<const N: usize>(
    weights: &[i16],
    lit: &[f32],
    out: &mut [f32],
    first: usize,
) -> usize {
    let width = out.len();
    let (blocks, rest) = out[first..].as_chunks_mut::<N>();
    for (column, sums) in (first..).step_by(N).zip(blocks) {
        let mut total = [0.0; N];
        for (weight, row) in weights.iter().zip(lit.chunks_exact(width)) {
            let weight = f32::from(*weight) * (1.0 / 32767.0);
            let row = &row[column..][..N];
            for (total, value) in total.iter_mut().zip(row) {
                *total += weight * value;
            }
        }
        *sums = total;
    }
    width - rest.len()
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::*;

    fn rows() -> impl Strategy<Value = (usize, Vec<i16>, Vec<f32>)> {
        (1_usize..40, 0_usize..6).prop_flat_map(|(terms, rows)| {
            (Just(terms), vec(any::<i16>(), rows), vec(-1.0..1.0_f32, rows * 3 * terms))
        })
    }

    proptest! {
        #[test]
        fn blocks_of_columns_add_to_the_bit_what_a_plain_loop_adds((terms, weights, lit) in rows()) {
            let mut plain = vec![0.0_f32; 3 * terms];
            for (weight, row) in weights.iter().zip(lit.chunks_exact(3 * terms)) {
                let weight = f32::from(*weight) * (1.0 / 32767.0);
                plain.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
            }
            let mut out = vec![f32::NAN; 3 * terms];
            add_all_columns(&weights, &lit, &mut out);
            prop_assert_eq!(out, plain);
        }
    }
}
