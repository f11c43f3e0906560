//! Sums of products.

use std::f64::consts::FRAC_PI_2;
use std::time::Instant;

use brdf_job::Job;
use brdf_model::{
    ANISOTROPIC, Channels, MerlNodes, SampleSet, ScrambledSobol, anisotropy, largest_albedo,
    log_offsets, measure,
};
use brdf_param::Parametrization;
use brdf_separable::{
    BrdfMatrix, Decomposition, EigenSolver, Fill, HemisphereGrid, Layout, MatrixParams,
    SeparableBrdf, SeparableParams, ValueTransform, factorize_matrix,
};

use crate::error::FitError;
use crate::material::Material;
use crate::method::{Method, SeparableMap};
use crate::note::FitNote;
use crate::record::{Albedo, RankRecord, SeparableRecord, SeparableSettingsRecord};
use crate::training::drawn;

/// Which decomposition makes the terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SeparableMethod {
    /// Truncated singular value decomposition.
    Svd,
    /// The same of logarithms.
    LogSvd(LogChoice),
    /// Eigenpairs: one set of textures for light and view.
    Eigen(EigenSolver),
    /// Non-negative textures.
    Nmf,
    /// One product, without iteration.
    Normalized,
}

/// Which logarithm is factored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LogChoice {
    /// ln(a + f), a = 1e-5 of the mean.
    #[default]
    Offset,
    /// ln(1 + f cosθi).
    Cosine,
}

impl SeparableMethod {
    /// Returns the name, as records have it.
    pub fn name(self) -> Method {
        match self {
            Self::Svd => Method::Svd,
            Self::LogSvd(_) => Method::LogSvd,
            Self::Eigen(_) => Method::Eigen,
            Self::Nmf => Method::Nmf,
            Self::Normalized => Method::Normalized,
        }
    }

    fn decomposition(self) -> Decomposition {
        match self {
            Self::Svd | Self::LogSvd(_) => Decomposition::Svd,
            Self::Eigen(solver) => Decomposition::Eigen(solver),
            Self::Nmf => Decomposition::Nmf,
            Self::Normalized => Decomposition::Normalized,
        }
    }
}

/// How a sum of products is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeparableSettings {
    /// Which decomposition.
    pub method: SeparableMethod,
    /// What the two sides are functions of.
    pub parametrization: Parametrization,
    /// How the hemisphere is laid out in textures; MERL's grid goes with half and difference vector.
    pub map: SeparableMap,
    /// Where in their cells the nodes of MERL's grid stand.
    pub merl_nodes: MerlNodes,
    /// Texels along each side of a texture.
    pub resolution: usize,
    /// Whether the material is taken to be isotropic: textures over the polar angle alone on the first side.
    pub isotropic: bool,
    /// Number of terms; none for 4, or 1 of the normalized product. Pairs of equal magnitude are completed beyond it.
    pub rank: Option<usize>,
    /// Whether all channels are decomposed together: scalar textures on the first side.
    pub joint_rgb: bool,
    /// What stands in cells without data.
    pub fill: Fill,
    /// p of the weights cosᵖθ of both sides.
    pub weight_power: f64,
    /// Most bytes for the matrix and the work on it.
    pub memory_limit: usize,
    /// Grazing limit of the matrix, radians.
    pub theta_max: f64,
    /// Which scramble the held-out pairs come from.
    pub seed: u64,
    /// Channels to fit; none for those that the material has.
    pub channels: Option<Channels>,
}

impl SeparableSettings {
    /// Returns the usual settings of a method: wi × wo, 48² texels.
    pub fn of(method: SeparableMethod) -> Self {
        Self {
            method,
            parametrization: Parametrization::Standard,
            map: SeparableMap::Orthographic,
            merl_nodes: MerlNodes::Centre,
            resolution: 48,
            isotropic: false,
            rank: None,
            joint_rgb: false,
            fill: Fill::Edge,
            weight_power: 0.0,
            memory_limit: 4 << 30,
            theta_max: FRAC_PI_2,
            seed: 1,
            channels: None,
        }
    }

    /// Returns the grids of both sides.
    pub fn layout(&self) -> Layout {
        let Some(map) = self.map.hemisphere() else {
            let nodes = self.merl_nodes;
            return Layout::new(
                self.parametrization,
                HemisphereGrid::MerlThetaH { nodes },
                HemisphereGrid::MerlThetaDPhiD { nodes },
            );
        };
        let resolution = self.resolution;
        let plane = HemisphereGrid::Plane { map, resolution };
        let first = if self.isotropic { HemisphereGrid::Radius { map, resolution } } else { plane };
        Layout::new(self.parametrization, first, plane)
    }

    /// Grazing limit of the held-out pairs, radians: that of other fits, unless the matrix ends before it.
    fn held_out_theta_max(&self) -> f64 {
        self.theta_max.min(80_f64.to_radians())
    }

    /// What of each channel is factored; offsets of logarithms from the mean of what was drawn.
    fn transforms(&self, samples: Option<&SampleSet>, channels: Channels) -> [ValueTransform; 3] {
        match self.method {
            SeparableMethod::LogSvd(LogChoice::Cosine) => [ValueTransform::Cosine; 3],
            SeparableMethod::LogSvd(LogChoice::Offset) => {
                let offsets = samples.map_or_else(Vec::new, log_offsets);
                let offset = |channel: usize| {
                    let channel = if channels == Channels::Luminance { 0 } else { channel };
                    offsets.get(channel).copied().unwrap_or(1e-5)
                };
                std::array::from_fn(|channel| ValueTransform::Offset { a: offset(channel) })
            }
            _ => [ValueTransform::Linear; 3],
        }
    }
}

/// A sum of products and how it was made: what a model file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct SeparableModel {
    /// The model.
    pub model: SeparableBrdf,
    /// How it was made.
    pub record: SeparableRecord,
}

/// A sum of products with its errors.
#[derive(Clone, Debug)]
pub struct SeparableFit {
    /// The model, its errors and settings.
    pub model: SeparableModel,
    /// Rows and columns of the matrix.
    pub matrix: [usize; 2],
    /// How the hemisphere is laid out in textures.
    pub map: SeparableMap,
    /// Largest directional albedos within the grazing limit of held-out pairs.
    pub albedo: Albedo,
    /// Of filling the matrix.
    pub fill_seconds: f64,
    /// Of filling and decomposing it.
    pub seconds: f64,
    /// What a reader should know.
    pub notes: Vec<FitNote>,
}

/// Fits a sum of products; see [`fit`](crate::fit) for what is held out. Of scattered rows all are used.
///
/// # Errors
///
/// [`FitError::Separable`]; [`FitError::Stopped`].
pub fn fit_separable(
    material: &Material<'_>,
    settings: &SeparableSettings,
    job: &Job<'_>,
) -> Result<SeparableFit, FitError> {
    let [drawing, filling, decomposing, measuring] = job.split([1.0, 2.0, 4.0, 3.0]);
    let channels = settings.channels.unwrap_or(material.channels());
    let layout = settings.layout();
    let reference = channels.of(material.brdf());
    let reference = reference.as_ref();
    let held_out_theta_max = settings.held_out_theta_max();
    drawing.begin("drawing held-out pairs", 1);
    let unseen = material.samples().is_none().then(|| {
        let seed = ScrambledSobol::held_out_seed(settings.seed);
        drawn(material, channels, seed, held_out_theta_max)
    });
    drawing.check()?;

    filling.begin("filling the matrix", 1);
    let decomposition = settings.method.decomposition();
    let params = SeparableParams {
        decomposition,
        rank: settings.rank.unwrap_or_else(|| match decomposition {
            Decomposition::Normalized => 1,
            _ => smaller_side(&layout).min(4),
        }),
        joint_rgb: settings.joint_rgb,
        ..SeparableParams::default()
    };
    let sampling = MatrixParams {
        channels,
        theta_max: settings.theta_max,
        fill: settings.fill,
        maps: settings.transforms(unseen.as_ref().or(material.samples()), channels),
        weight_power: settings.weight_power,
        memory_limit: settings.memory_limit,
    };
    let start = Instant::now();
    let mut matrix = BrdfMatrix::sample(reference, &layout, &sampling)?;
    let fill_seconds = start.elapsed().as_secs_f64();
    filling.check()?;
    let mut asymmetry = None;
    if matches!(decomposition, Decomposition::Eigen(_)) {
        asymmetry = matrix.asymmetry();
        matrix = matrix.symmetrized()?;
    }
    let fit = factorize_matrix(&matrix, &params, &decomposing)?;
    let seconds = start.elapsed().as_secs_f64();

    measuring.begin("measuring", fit.errors.len() as u64);
    let terms: Vec<RankRecord> = fit
        .errors
        .iter()
        .map(|errors| {
            measuring.check()?;
            let held_out = match &unseen {
                Some(unseen) if !unseen.is_empty() => {
                    let model = fit.model.truncated(errors.rank)?;
                    Some(measure(unseen, &model, &log_offsets(unseen)))
                }
                _ => None,
            };
            measuring.advance(1);
            Ok(RankRecord { matrix: *errors, held_out })
        })
        .collect::<Result<_, FitError>>()?;
    let record = SeparableRecord {
        method: settings.method.name(),
        input: material.name().to_owned(),
        settings: SeparableSettingsRecord {
            decomposition,
            rank: params.rank,
            joint_rgb: params.joint_rgb,
            theta_max: sampling.theta_max,
            fill: sampling.fill,
            weight_power: sampling.weight_power,
            held_out_theta_max,
            seed: settings.seed,
        },
        cells: matrix.counts(),
        asymmetry,
        spectra: fit.spectra,
        terms,
    };
    let model = SeparableModel { model: fit.model, record };
    let albedo = Albedo {
        reference: material
            .samples()
            .is_none()
            .then(|| largest_albedo(reference, held_out_theta_max).0),
        model: largest_albedo(&model.model, held_out_theta_max).0,
    };
    let notes = notes(material, &model, albedo);
    Ok(SeparableFit {
        model,
        matrix: [matrix.rows().len(), matrix.columns().len()],
        map: settings.map,
        albedo,
        fill_seconds,
        seconds,
        notes,
    })
}

fn smaller_side(layout: &Layout) -> usize {
    layout.first.nodes().len().min(layout.second.nodes().len())
}
/// Asymmetry above this is more than rounding.
const ROUNDING: f64 = 1e-6;

/// What is wrong with a sum of products that its errors alone do not show.
fn notes(material: &Material<'_>, file: &SeparableModel, albedo: Albedo) -> Vec<FitNote> {
    let mut notes = Vec::new();
    let fit = &file.record;
    if material.samples().is_some() {
        notes.push(FitNote::Interpolated);
    }
    let change = anisotropy(material.brdf());
    if file.model.layout().is_isotropic() && change > ANISOTROPIC {
        notes.push(FitNote::Anisotropic { change });
    }
    let without = fit.terms.last().and_then(|term| Some(term.held_out.as_ref()?.without_logarithm));
    if let Some(values) = without.filter(|count| *count > 0) {
        notes.push(FitNote::WithoutLogarithm { values });
    }
    let cells = fit.cells;
    if cells.filled > 0 {
        notes.push(FitNote::CellsFilled { cells: cells.filled, of: cells.cells });
    }
    if cells.zero > 0 {
        notes.push(FitNote::CellsZero { cells: cells.zero, of: cells.cells });
    }
    if cells.unknown_lines > 0 {
        notes.push(FitNote::UnknownLines { lines: cells.unknown_lines });
    }
    if cells.clamped > 0 {
        notes.push(FitNote::CellsClamped { cells: cells.clamped });
    }
    if let Some(asymmetry) = fit.asymmetry.filter(|a| *a > ROUNDING) {
        notes.push(FitNote::NotReciprocal { asymmetry });
    }
    spectrum_notes(fit, &mut notes);
    if let Some(reference) = albedo.reference
        && !(0.8..=1.25).contains(&(albedo.model / reference))
    {
        notes.push(FitNote::AlbedoOff { model: albedo.model, reference, factored: false });
    }
    notes
}

fn spectrum_notes(fit: &SeparableRecord, notes: &mut Vec<FitNote>) {
    let rank = fit.settings.rank;
    let added = fit.spectra.iter().map(|s| s.added).max().unwrap_or(0);
    if added > 0 {
        notes.push(FitNote::GroupsCompleted { added, rank });
    }
    if fit.spectra.iter().any(|s| s.cuts_a_group) {
        notes.push(FitNote::GroupCut);
    }
    let found = fit.spectra.iter().map(|s| s.values.len()).min().unwrap_or(0);
    if found < rank {
        notes.push(FitNote::FewTerms { found, rank });
    }
    let residual = fit.spectra.iter().flat_map(|s| &s.residuals).copied().fold(0.0, f64::max);
    if fit.settings.decomposition == Decomposition::Eigen(EigenSolver::Power) {
        notes.push(FitNote::PowerIteration { residual });
    } else if fit.spectra.iter().any(|s| !s.converged) {
        notes.push(FitNote::NotConverged { residual });
    }
}
