//! Spaces and texels in bytes.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::LocalPca;
use crate::projected_texels::ProjectedTexels;
use crate::{AngularGrid, Encoding, SharedBytes, TextureInfo, VqError};

/// A straight line from 8-bit codes to values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Steps {
    /// Value of code 0.
    pub min: f32,
    /// Difference of neighbouring codes.
    pub step: f32,
}

impl Steps {
    fn over(values: impl Iterator<Item = f32>) -> Self {
        let (min, max) =
            values.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if min < max {
            Self { min, step: (max - min) / 255.0 }
        } else {
            Self { min: min.min(max), step: 0.0 }
        }
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
    fn encode(self, value: f32) -> u8 {
        if self.step > 0.0 {
            ((value - self.min) / self.step).round().clamp(0.0, 255.0) as u8
        } else {
            0
        }
    }

    pub(super) fn decode(self, code: u8) -> f32 {
        self.min + self.step * f32::from(code)
    }
}

/// The meaning of the streams of an [`LpcaModel`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LpcaHeader {
    /// Nodes.
    pub grid: AngularGrid,
    /// Meaning of the values.
    pub encoding: Encoding,
    /// Number of spaces, 1 to 256.
    pub clusters: usize,
    /// Dimensions of each, 0 to 64.
    pub components: usize,
    /// Codes of bases, `[cluster][mean, components …]`.
    pub basis: Vec<Steps>,
    /// Codes of coefficients, `[cluster][component]`.
    pub coefficients: Vec<Steps>,
    /// The textures.
    pub materials: Vec<TextureInfo>,
}

impl LpcaHeader {
    /// Bytes of a texel: its cluster, if there are several, and its coefficients.
    pub(super) fn texel_len(&self) -> usize {
        usize::from(self.clusters > 1) + self.components
    }

    /// Returns the names of the streams, in order.
    pub fn stream_names(&self) -> Vec<String> {
        let textures = self.materials.iter().enumerate().flat_map(|(index, material)| {
            (0..material.levels).map(move |level| format!("texels.{index}.{level}"))
        });
        std::iter::once("basis".to_owned()).chain(textures).collect()
    }

    fn check(&self) -> Result<(), VqError> {
        self.grid.check()?;
        let refuse = |what, found: String, expected| Err(VqError::Header { what, found, expected });
        let Self { clusters, components, .. } = *self;
        if !(1..=256).contains(&clusters) || components > 64 {
            let found = format!("{clusters} × {components}");
            return refuse("clusters × components", found, "1 to 256 clusters of at most 64");
        }
        let lines = [self.basis.len(), self.coefficients.len()];
        if lines != [clusters * (components + 1), clusters * components] {
            return refuse("the number of ranges", format!("{lines:?}"), "one for each vector");
        }
        let steps = self.basis.iter().chain(&self.coefficients);
        if !steps.clone().all(|s| s.min.is_finite() && s.step.is_finite()) {
            return refuse("a range", "not finite".to_owned(), "finite numbers");
        }
        for material in &self.materials {
            material.check()?;
        }
        Ok(())
    }
}

/// A BTF compressed by local principal components, a byte a value: the rival that the paper compares with.
#[derive(Clone)]
pub struct LpcaModel {
    header: LpcaHeader,
    bytes: SharedBytes,
    ranges: Vec<Range<usize>>,
}

impl std::fmt::Debug for LpcaModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LpcaModel").field("header", &self.header).finish_non_exhaustive()
    }
}

impl LpcaModel {
    /// Returns a model made from its header and the ranges in `bytes` of each of [`LpcaHeader::stream_names`].
    ///
    /// # Errors
    ///
    /// [`VqError::Header`], [`VqError::Grid`], [`VqError::Stream`], [`VqError::Index`].
    pub fn new(
        header: LpcaHeader,
        bytes: SharedBytes,
        ranges: Vec<Range<usize>>,
    ) -> Result<Self, VqError> {
        header.check()?;
        let model = Self { header, bytes, ranges };
        let header = &model.header;
        let nodes = header.clusters * header.grid.node_count() * 3;
        let mut expected = vec![("basis", nodes, header.components + 1)];
        for material in &header.materials {
            let texels = material.level_lens();
            expected.extend(texels.map(|texels| ("texels", texels, header.texel_len())));
        }
        for (at, (book, rows, len)) in expected.into_iter().enumerate() {
            let found = model.stream(at).len();
            if found != rows * len {
                return Err(VqError::Stream { book, found, expected: rows * len, rows });
            }
            let is_texture = at > 0 && header.clusters > 1;
            let clusters = model.stream(at).iter().step_by(len.max(1)).enumerate();
            let bad =
                clusters.filter(|_| is_texture).find(|c| usize::from(*c.1) >= header.clusters);
            if let Some((row, index)) = bad {
                let index = u32::from(*index);
                return Err(VqError::Index {
                    book,
                    row,
                    index,
                    target: "basis",
                    rows: header.clusters,
                });
            }
        }
        Ok(model)
    }

    /// Packs a fit of a survey into bytes. The texels of the survey are those of the levels of these materials, one
    /// after another. Every value loses what a byte cannot hold.
    ///
    /// # Errors
    ///
    /// [`VqError::Header`] for more clusters or components than a model can have.
    pub fn pack(
        survey: &ProjectedTexels,
        fit: &LocalPca,
        materials: Vec<TextureInfo>,
    ) -> Result<Self, VqError> {
        let (clusters, components) = (fit.clusters(), fit.components);
        let vectors = components + 1;
        let values = survey.space.lift(&fit.spaces);
        let len = survey.space.len;
        let plain: Vec<Vec<f32>> = values
            .chunks_exact(len)
            .map(|v| v.iter().zip(&survey.root_weights).map(|(v, r)| v / r).collect())
            .collect();
        let basis: Vec<Steps> = plain.iter().map(|v| Steps::over(v.iter().copied())).collect();
        let nodes = survey.grid.node_count();
        let mut bytes = Vec::with_capacity(clusters * vectors * len);
        for cluster in 0..clusters {
            for node in 0..nodes {
                for channel in 0..3 {
                    let at = channel * nodes + node;
                    let of = |v: usize| {
                        basis[cluster * vectors + v].encode(plain[cluster * vectors + v][at])
                    };
                    bytes.extend((0..vectors).map(of));
                }
            }
        }
        let coefficients: Vec<Steps> = (0..clusters * components)
            .map(|at| {
                let (cluster, component) = (at / components, at % components);
                let members = fit.coefficients.chunks_exact(components).zip(&fit.cluster);
                let own = members.filter(|(_, c)| **c as usize == cluster);
                Steps::over(own.map(|(x, _)| x[component]))
            })
            .map(|s| if s.min.is_finite() { s } else { Steps { min: 0.0, step: 0.0 } })
            .collect();
        let mut ranges: Vec<Range<usize>> = std::iter::once(0..bytes.len()).collect();
        let mut texel = 0;
        for material in &materials {
            for texels in material.level_lens() {
                let start = bytes.len();
                for at in texel..texel + texels {
                    let cluster = fit.cluster[at] as usize;
                    if clusters > 1 {
                        bytes.push(u8::try_from(cluster).unwrap_or(u8::MAX));
                    }
                    let own = &fit.coefficients[at * components..][..components];
                    let lines = &coefficients[cluster * components..][..components];
                    bytes.extend(own.iter().zip(lines).map(|(x, line)| line.encode(*x)));
                }
                texel += texels;
                ranges.push(start..bytes.len());
            }
        }
        let header = LpcaHeader {
            grid: survey.grid,
            encoding: survey.encoding,
            clusters,
            components,
            basis,
            coefficients,
            materials,
        };
        Self::new(header, std::sync::Arc::new(bytes), ranges)
    }

    /// Returns what the streams mean.
    pub fn header(&self) -> &LpcaHeader {
        &self.header
    }

    /// Returns the bytes of a stream, by its place in [`LpcaHeader::stream_names`].
    pub fn stream(&self, at: usize) -> &[u8] {
        let bytes: &[u8] = (*self.bytes).as_ref();
        self.ranges.get(at).and_then(|range| bytes.get(range.clone())).unwrap_or_default()
    }
}
