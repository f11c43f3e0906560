//! What is compressed: BTFs, or BRDFs as textures of one texel.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::bail;
use brdf_io::Btf;
use btf_vq::{
    AngularGrid, BtfSource, LightParametrization, Mipped, NodeTable, Resampler, TexelSet,
    TextureInfo,
};

use super::brdfs::{RAW_BYTES, is_brdf, open_brdfs, tabulate, texture_name};
use super::loading::{MemoryArgs, load, notes};
use crate::progress::Progress;

/// Textures to compress.
pub(super) struct Inputs {
    /// One for each texture.
    pub(super) infos: Vec<TextureInfo>,
    /// Bytes of the raw images, or numbers, of all, as the paper counts.
    pub(super) raw_bytes: u64,
    /// Lights and views are laid out so.
    pub(super) grid: AngularGrid,
    data: Data,
}

enum Data {
    Images(Vec<Btf>),
    Brdfs(NodeTable),
}

/// The paper's nodes for BTFs along α, β, θv and φv, and its finer ones for BRDFs.
const NODES: [usize; 4] = [11, 11, 7, 16];
const BRDF_NODES: [usize; 4] = [91, 91, 45, 1];

/// A grid that a command asks for.
#[derive(Clone, Copy)]
pub(super) struct GridChoice {
    /// Along α, β, θv and φv; without, those of the paper for what inputs are.
    pub(super) nodes: Option<[usize; 4]>,
    pub(super) parametrization: LightParametrization,
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

impl Inputs {
    /// Reads inputs.
    pub(super) fn open(
        paths: &[PathBuf],
        grid: GridChoice,
        with_mipmaps: bool,
        memory: MemoryArgs,
    ) -> anyhow::Result<Self> {
        let brdf = paths.iter().find(|path| is_brdf(path));
        let other = paths.iter().find(|path| !is_brdf(path));
        match (brdf, other) {
            (Some(brdf), Some(other)) => bail!(
                "{} is a BRDF and {} is not; compress one kind at a time",
                brdf.display(),
                other.display()
            ),
            (Some(_), None) => Self::brdfs(paths, grid.or(BRDF_NODES)),
            _ => Self::images(paths, grid.or(NODES), with_mipmaps, memory),
        }
    }

    fn images(
        paths: &[PathBuf],
        grid: AngularGrid,
        with_mipmaps: bool,
        memory: MemoryArgs,
    ) -> anyhow::Result<Self> {
        let each = MemoryArgs { memory: memory.memory / paths.len().max(1) };
        let (mut infos, mut sources, mut raw_bytes) = (Vec::new(), Vec::new(), 0);
        for path in paths {
            for note in notes(&brdf_io::open_btf(path)?) {
                writeln!(std::io::stderr(), "{}: {note}", path.display())?;
            }
            let source = load(path, each)?;
            let layout = source.layout();
            infos.push(TextureInfo {
                name: stem(path),
                width: layout.width,
                height: layout.height,
                cosine_included: layout.cosine_included,
                levels: if with_mipmaps { Mipped::count(layout) } else { 1 },
            });
            raw_bytes += layout.raw_bytes();
            sources.push(source);
        }
        Ok(Self { infos, raw_bytes, grid, data: Data::Images(sources) })
    }

    fn brdfs(paths: &[PathBuf], grid: AngularGrid) -> anyhow::Result<Self> {
        let progress = Progress::new(paths.len() as u64);
        let (mut infos, mut table) = (Vec::new(), NodeTable::new(grid)?);
        for path in paths {
            progress.step(format!("tabulating {}", path.display()));
            for subject in open_brdfs(path)? {
                if let Some(note) = tabulate(&mut table, subject.brdf())? {
                    writeln!(std::io::stderr(), "{}: {note}", subject.argument)?;
                }
                let name = texture_name(&subject);
                let (width, height, levels) = (1, 1, 1);
                infos.push(TextureInfo { name, width, height, cosine_included: true, levels });
            }
            progress.done(1);
        }
        let raw_bytes = RAW_BYTES * infos.len() as u64;
        Ok(Self { infos, raw_bytes, grid, data: Data::Brdfs(table) })
    }

    /// The only input, if it is images.
    pub(super) fn only_images(&self) -> Option<&Btf> {
        match &self.data {
            Data::Images(sources) => sources.first().filter(|_| sources.len() == 1),
            Data::Brdfs(_) => None,
        }
    }

    /// Texels of all levels.
    pub(super) fn texels(&self) -> usize {
        self.infos.iter().flat_map(TextureInfo::level_lens).sum()
    }

    /// The sets of [`Inputs::with_sets`] of each texture; those of BRDFs, of one texel, all together.
    pub(super) fn by_texture<'s, 'a>(
        &self,
        sets: &'s [TexelSet<'a>],
    ) -> impl Iterator<Item = &'s [TexelSet<'a>]> {
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

    /// What `f` makes of the texels: those of each texture's levels, one after another.
    pub(super) fn with_sets<T>(
        &self,
        f: impl FnOnce(&[TexelSet<'_>]) -> anyhow::Result<T>,
    ) -> anyhow::Result<T> {
        let sources = match &self.data {
            Data::Brdfs(table) => return f(&[TexelSet::Nodes(table)]),
            Data::Images(sources) => sources,
        };
        let places: Vec<(&Btf, usize)> = sources
            .iter()
            .zip(&self.infos)
            .flat_map(|(source, info)| (0..info.levels).map(move |level| (source, level)))
            .collect();
        let levels: Vec<Mipped<'_>> =
            places.iter().map(|(source, level)| Mipped::new(*source, *level)).collect();
        let resamplers: Vec<Resampler> = levels
            .iter()
            .map(|level| Resampler::new(level.layout(), self.grid))
            .collect::<Result<_, _>>()?;
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

/// A name without folders and ending.
fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
