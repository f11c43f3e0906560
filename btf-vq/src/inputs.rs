//! What is compressed together: textures of images, or BRDFs as textures of one texel.

use brdf_job::Job;
use brdf_model::Brdf;

use crate::brdfs::{RAW_BRDF_BYTES, Tabulated, tabulate};
use crate::codebooks::TextureInfo;
use crate::error::VqError;
use crate::grid::{AngularGrid, LightParametrization};
use crate::mip::Mipped;
use crate::resample::Resampler;
use crate::source::BtfSource;
use crate::texels::{NodeTable, TexelSet};

/// The paper's nodes for BTFs along α, β, θv and φv, and its finer ones for BRDFs.
const NODES: [usize; 4] = [11, 11, 7, 16];
const BRDF_NODES: [usize; 4] = [91, 91, 45, 1];

/// The grid of directions that is asked for, or the paper's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GridChoice {
    /// Nodes along α, β, θv and φv; `None` takes those of the paper: 11 × 11 × 7 × 16 for images, 91 × 91 × 45 × 1
    /// for BRDFs.
    pub nodes: Option<[usize; 4]>,
    /// Map from light directions to the grid.
    pub parametrization: LightParametrization,
}

impl GridChoice {
    fn or(self, usual: [usize; 4]) -> AngularGrid {
        let [alphas, betas, thetas, phis] = self.nodes.unwrap_or(usual);
        AngularGrid { alphas, betas, thetas, phis, parametrization: self.parametrization }
    }
}

impl From<AngularGrid> for GridChoice {
    fn from(grid: AngularGrid) -> Self {
        let nodes = Some([grid.alphas, grid.betas, grid.thetas, grid.phis]);
        Self { nodes, parametrization: grid.parametrization }
    }
}

/// The textures to compress: images of BTFs, or BRDFs as textures of one texel.
pub struct TextureInputs<'a> {
    /// Name, size and meaning of each texture.
    pub infos: Vec<TextureInfo>,
    /// Bytes of the raw images, or of the tables of BRDFs, of all textures together, as the paper counts.
    pub raw_bytes: u64,
    /// Grid of light and view directions.
    pub grid: AngularGrid,
    data: Data<'a>,
}

enum Data<'a> {
    Images(Vec<&'a dyn BtfSource>),
    Brdfs(NodeTable),
}

impl std::fmt::Debug for TextureInputs<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TextureInputs").field("infos", &self.infos).finish_non_exhaustive()
    }
}

impl<'a> TextureInputs<'a> {
    /// Returns inputs of the images of named sources, with coarser levels if `has_mipmaps`.
    pub fn images(
        sources: Vec<(String, &'a dyn BtfSource)>,
        grid: GridChoice,
        has_mipmaps: bool,
    ) -> Self {
        let (mut infos, mut raw_bytes) = (Vec::new(), 0);
        for (name, source) in &sources {
            let layout = source.layout();
            infos.push(TextureInfo {
                name: name.clone(),
                width: layout.width,
                height: layout.height,
                cosine_included: layout.cosine_included,
                levels: if has_mipmaps { Mipped::count(layout) } else { 1 },
            });
            raw_bytes += layout.raw_bytes();
        }
        let sources = sources.into_iter().map(|(_, source)| source).collect();
        Self { infos, raw_bytes, grid: grid.or(NODES), data: Data::Images(sources) }
    }

    /// Returns inputs of named BRDFs, each a texture of one texel, and what was changed in each.
    ///
    /// # Errors
    ///
    /// [`VqError::NotFinite`]; [`VqError::Header`] for an impossible grid; [`VqError::Stopped`].
    pub fn brdfs(
        brdfs: &[(String, &dyn Brdf)],
        grid: GridChoice,
        job: &Job<'_>,
    ) -> Result<(Self, Vec<Tabulated>), VqError> {
        job.begin("tabulating", brdfs.len() as u64);
        let grid = grid.or(BRDF_NODES);
        let (mut infos, mut table, mut changes) = (Vec::new(), NodeTable::new(grid)?, Vec::new());
        for (name, brdf) in brdfs {
            job.check()?;
            changes.push(tabulate(&mut table, *brdf)?);
            infos.push(TextureInfo {
                name: name.clone(),
                width: 1,
                height: 1,
                cosine_included: true,
                levels: 1,
            });
            job.advance(1);
        }
        let raw_bytes = RAW_BRDF_BYTES * infos.len() as u64;
        Ok((Self { infos, raw_bytes, grid, data: Data::Brdfs(table) }, changes))
    }

    /// Returns the number of texels of all levels.
    pub fn texels(&self) -> usize {
        self.infos.iter().flat_map(TextureInfo::level_lens).sum()
    }

    /// Returns the sets of each texture among those of [`TextureInputs::with_sets`]; those of BRDFs, of one texel,
    /// all together.
    pub(crate) fn by_texture<'s, 't>(
        &self,
        sets: &'s [TexelSet<'t>],
    ) -> impl Iterator<Item = &'s [TexelSet<'t>]> {
        let infos = match self.data {
            Data::Images(_) => self.infos.as_slice(),
            Data::Brdfs(_) => &self.infos[..1],
        };
        let mut first = 0;
        infos.iter().map(move |info| {
            let own = &sets[first..first + info.levels];
            first += info.levels;
            own
        })
    }

    /// Calls `f` with the texels, those of each texture's levels one after another, and returns its result.
    ///
    /// # Errors
    ///
    /// [`VqError::Header`] for directions that cannot be resampled; what `f` says.
    pub fn with_sets<T, E: From<VqError>>(
        &self,
        f: impl FnOnce(&[TexelSet<'_>]) -> Result<T, E>,
    ) -> Result<T, E> {
        let sources = match &self.data {
            Data::Brdfs(table) => return f(&[TexelSet::Nodes(table)]),
            Data::Images(sources) => sources,
        };
        let places: Vec<(&dyn BtfSource, usize)> = sources
            .iter()
            .zip(&self.infos)
            .flat_map(|(source, info)| (0..info.levels).map(move |level| (*source, level)))
            .collect();
        let levels: Vec<Mipped<'_>> =
            places.iter().map(|(source, level)| Mipped::new(*source, *level)).collect();
        let resamplers: Vec<Resampler> = levels
            .iter()
            .map(|level| Resampler::new(level.layout(), self.grid))
            .collect::<Result<_, VqError>>()?;
        let sets: Vec<TexelSet<'_>> = places
            .iter()
            .zip(levels.iter().zip(&resamplers))
            .map(|((source, level), (mipped, resampler))| TexelSet::Images {
                // The finest level is the source itself, which reads whole blocks.
                source: if *level == 0 { *source } else { mipped },
                resampler,
            })
            .collect();
        f(&sets)
    }
}
