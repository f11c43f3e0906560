//! Principal components of the transport of a cluster of vertices (Sloan et al. 2003).

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par, Side};

use crate::chunk::{Chunk, Entries, SparseVectors};
use crate::coefficients::Coding;
use crate::cube::TEXELS;
use crate::error::RelightError;
use crate::maps::Terms;

/// The components of so many vertices, of which numbers that hold an energy below `least` are left out, and then
/// components that hold less than their numbers and weights cost at that price.
///
/// # Errors
///
/// [`RelightError::Components`] if eigenvalues are not found.
pub(crate) fn components(
    members: &[Entries],
    terms: &Terms,
    least: f64,
) -> Result<Chunk, RelightError> {
    let channels = terms.channels;
    let columns = columns(members, terms, least);
    let matrix = dense(members, &columns, channels);
    let count = members.len();
    let mut gram = Mat::<f32>::zeros(count, count);
    matmul(&mut gram, Accum::Replace, matrix.transpose(), &matrix, 1.0, Par::Seq);
    let gram = Mat::<f64>::from_fn(count, count, |i, j| f64::from(gram[(i.max(j), i.min(j))]));
    let eigen = gram
        .self_adjoint_eigen(Side::Lower)
        .map_err(|error| RelightError::Components { found: format!("{error:?}") })?;
    // Eigenvalues ascend.
    let price_of_weights = 0.5 * least * count as f64;
    let energies = eigen.S().column_vector();
    let kept = (0..count).rev().take_while(|at| energies[*at] > price_of_weights).count();
    #[expect(clippy::cast_possible_truncation, reason = "weights of 16 bits")]
    let shares = Mat::<f32>::from_fn(count, kept, |i, j| eigen.U()[(i, count - 1 - j)] as f32);
    let mut bases = Mat::<f32>::zeros(matrix.nrows(), kept);
    matmul(&mut bases, Accum::Replace, &matrix, &shares, 1.0, Par::Seq);

    let mut made = Chunk::default();
    let mut chosen = Vec::new();
    for component in 0..kept {
        // Of either sign, as eigenvectors have.
        let shares = shares.col(component);
        let largest =
            shares.iter().fold(0.0_f32, |most, v| if v.abs() > most.abs() { *v } else { most });
        let values = bases.col(component).iter().copied().collect::<Vec<f32>>();
        let (entries, energy) = entries(&values, &columns, terms, largest, least);
        let price = least * entries.iter().map(Vec::len).sum::<usize>() as f64;
        if energy > price + price_of_weights {
            made.vectors.push(vectors(&entries, Coding::of(channels)));
            chosen.push((component, largest));
        }
    }
    for member in 0..count {
        for (component, largest) in &chosen {
            made.weights.push(code(shares[(member, *component)] / largest));
        }
    }
    Ok(made)
}

/// Place and channels of a number.
type Entry = (u16, Vec<f32>);

/// Numbers of a component that hold more than `least`, by term, without its weight and times `scale`; and what they hold.
fn entries(
    values: &[f32],
    columns: &[u32],
    terms: &Terms,
    scale: f32,
    least: f64,
) -> (Vec<Vec<Entry>>, f64) {
    let count = terms.weights.len();
    let (mut entries, mut energy) = (vec![Vec::new(); count], 0.0);
    for (column, values) in columns.iter().zip(values.chunks_exact(terms.channels)) {
        let own: f64 = values.iter().map(|v| f64::from(*v).powi(2)).sum();
        if own > least {
            energy += own;
            let (place, term) = (*column as usize / count, *column as usize % count);
            let scale = scale / terms.weights[term];
            let values = values.iter().map(|v| scale * v).collect();
            entries[term].push((u16::try_from(place).unwrap_or(u16::MAX), values));
        }
    }
    (entries, energy)
}

/// Columns that hold more than `least` over all members: no component has a larger number there.
fn columns(members: &[Entries], terms: &Terms, least: f64) -> Vec<u32> {
    let mut energies = vec![0.0_f32; TEXELS * terms.weights.len()];
    for member in members {
        let values = member.values.chunks_exact(terms.channels);
        for (column, values) in member.columns.iter().zip(values) {
            energies[*column as usize] += values.iter().map(|v| v * v).sum::<f32>();
        }
    }
    let columns = (0_u32..).zip(&energies).filter(|(_, energy)| f64::from(**energy) > least);
    columns.map(|(column, _)| column).collect()
}

/// `[column, channel]` by members.
fn dense(members: &[Entries], columns: &[u32], channels: usize) -> Mat<f32> {
    let mut matrix = Mat::zeros(columns.len() * channels, members.len());
    for (at, member) in members.iter().enumerate() {
        let mut rows = columns.iter().enumerate().peekable();
        for (column, values) in member.columns.iter().zip(member.values.chunks_exact(channels)) {
            while rows.next_if(|(_, other)| *other < column).is_some() {}
            if let Some((row, _)) = rows.next_if(|(_, other)| *other == column) {
                for (channel, value) in values.iter().enumerate() {
                    matrix[(row * channels + channel, at)] = *value;
                }
            }
        }
    }
    matrix
}

/// A component's numbers, term after term.
fn vectors(entries: &[Vec<Entry>], coding: Coding) -> SparseVectors {
    let mut vectors = SparseVectors::default();
    for entries in entries {
        let all = entries.iter().flat_map(|(_, value)| value);
        let largest = all.fold(0.0_f32, |most, v| most.max(v.abs()));
        vectors.add_term(
            largest,
            entries.iter().map(|(place, value)| (*place, &value[..])),
            coding,
        );
    }
    vectors
}

/// A weight up to 1.
#[expect(clippy::cast_possible_truncation, reason = "rounded, up to 32767")]
fn code(weight: f32) -> i16 {
    (weight * f32::from(i16::MAX)).round() as i16
}
