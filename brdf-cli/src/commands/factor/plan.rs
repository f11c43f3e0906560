//! From the arguments of `brdf factor` to what is fitted or searched.

use std::path::Path;
use std::time::Duration;

use brdf_container::{ProjectionFile, read_coordinates, read_projection_source};
use brdf_files::{FileError, MappedFile};
use brdf_fit::{FactoredMethod, SearchSettings, Strategy};
use brdf_param::{Projection, Space};
use brdf_search::Objective;

use super::Factor;
use crate::args::{first_given, positive, usage};
use crate::choices::{BesideArg, MethodArg, ObjectiveArg, ReciprocityArg, SpaceArg, StrategyArg};

/// How projections are searched.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Search (--method search)")]
pub(super) struct SearchArgs {
    /// How projections are searched [default: joint]
    #[arg(long, value_enum)]
    search: Option<StrategyArg>,

    /// Largest number of projections; models of fewer are kept too [default: 5]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=8))]
    terms: Option<u8>,

    /// Random starts: of two planes together for joint (three quarters as many of three), of each
    /// term for powell [default: 40, 6]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    restarts: Option<u32>,

    /// What --search powell minimizes [default: relative]
    #[arg(long, value_enum)]
    objective: Option<ObjectiveArg>,

    /// Projections to start from beside the others: a model that brdf wrote, or a file as for
    /// --projections. `mccool` keeps McCool's factors and searches from there
    #[arg(long, value_name = "FILE|mccool")]
    start: Option<String>,

    /// Factors over fixed coordinates that every model has beside the searched ones
    #[arg(long, value_enum)]
    beside: Option<BesideArg>,

    /// End the search after this many seconds with the best found so far
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    time_limit: Option<f64>,
}

impl SearchArgs {
    /// When a search is to end.
    pub(super) fn time_limit(&self) -> Option<Duration> {
        // More than a year is no limit; unbounded numbers would overflow a duration.
        self.time_limit.map(|seconds| Duration::from_secs_f64(seconds.min(4e7)))
    }

    /// The first option that was given, if any.
    pub(super) fn given(&self) -> Option<&'static str> {
        first_given(&[
            (self.search.is_some(), "--search"),
            (self.terms.is_some(), "--terms"),
            (self.restarts.is_some(), "--restarts"),
            (self.objective.is_some(), "--objective"),
            (self.start.is_some(), "--start"),
            (self.beside.is_some(), "--beside"),
            (self.time_limit.is_some(), "--time-limit"),
        ])
    }
}

impl Factor {
    /// Refuses what only sums of products have.
    pub(super) fn check_homomorphic(&self) -> anyhow::Result<()> {
        let name = self.method().name();
        if let Some(option) = self.separable.given() {
            return Err(usage(format!(
                "{option} is for --method svd, log-svd, eigen, nmf or normalized, not {name}"
            )));
        }
        let is_isotropic = self.method() == MethodArg::Isotropic;
        if let Some(option) = self.compact.given().filter(|_| !is_isotropic) {
            return Err(usage(format!(
                "{option} is for --method auto, spline, ggx or isotropic, not {name}"
            )));
        }
        if self.log_map.homomorphic().is_none() {
            return Err(usage(format!("--log-map cosine is for --method log-svd, not {name}")));
        }
        if self.space.is_some_and(|space| space.spaces().is_empty()) {
            return Err(usage(format!(
                "--method {name} has no such space; expected standard or half-difference (others are \
                 for --method svd and its kin)"
            )));
        }
        Ok(())
    }

    /// What is to be done.
    pub(super) fn plan(&self) -> anyhow::Result<FactoredMethod> {
        if self.method() != MethodArg::Projections && self.projections.is_some() {
            return Err(usage(
                "--projections is for --method projections (--start begins a search)",
            ));
        }
        if self.method() != MethodArg::Coordinates && self.coordinates.is_some() {
            return Err(usage("--coordinates is for --method coordinates"));
        }
        if self.method() == MethodArg::Search {
            return Ok(FactoredMethod::Search(self.search_settings()?));
        }
        let name = self.method().name();
        if let Some(option) = self.search.given() {
            return Err(usage(format!("{option} is for --method search, not {name}")));
        }
        if self.reciprocal == ReciprocityArg::Auto && self.method() != MethodArg::Isotropic {
            return Err(usage(format!(
                "--reciprocal auto is for --method search or isotropic, not {name}"
            )));
        }
        if self.space == Some(SpaceArg::Auto) {
            return Err(usage(format!("--space auto is for --method search, not {name}")));
        }
        if self.method() != MethodArg::Projections && self.space == Some(SpaceArg::HalfDifference) {
            return Err(usage(format!(
                "--method {name} has coordinates of its own: --space half-difference does not \
                 apply to it"
            )));
        }
        Ok(match self.method() {
            MethodArg::Radial => FactoredMethod::Radial,
            MethodArg::Isotropic => {
                if self.texture_size.is_some() {
                    return Err(usage(
                        "--texture-size is for square textures; here --bytes says how large",
                    ));
                }
                FactoredMethod::Isotropic(self.compact.isotropic_settings()?)
            }
            MethodArg::Coordinates => {
                let Some(path) = &self.coordinates else {
                    return Err(usage("--method coordinates needs --coordinates FILE"));
                };
                let bytes = MappedFile::open(path)?;
                let specs = read_coordinates(&String::from_utf8_lossy(&bytes));
                FactoredMethod::Coordinates(specs.map_err(FileError::content(path))?)
            }
            MethodArg::Projections => {
                let Some(path) = &self.projections else {
                    return Err(usage("--method projections needs --projections FILE"));
                };
                let (projections, space) = self.projections_of(path)?;
                FactoredMethod::Projections { space: space.unwrap_or(Space::Standard), projections }
            }
            // Searches and sums of products were told apart before.
            _ => FactoredMethod::McCool,
        })
    }

    fn search_settings(&self) -> anyhow::Result<SearchSettings> {
        let args = &self.search;
        let strategy = match (args.search.unwrap_or(StrategyArg::Joint), args.objective) {
            (StrategyArg::Joint, None) => Strategy::Joint,
            (StrategyArg::Joint, Some(_)) => {
                return Err(usage(
                    "--objective is for --search powell; --weight f or f2 leads the joint search \
                     towards linear error",
                ));
            }
            (StrategyArg::Powell, objective) => {
                Strategy::Powell(objective.map_or(Objective::Relative, Into::into))
            }
        };
        let mccool = args.start.as_deref() == Some("mccool");
        if mccool && args.beside.is_some() {
            return Err(usage("--start mccool and --beside both name fixed factors; give one"));
        }
        let (start, space) = match args.start.as_deref() {
            Some(file) if !mccool => self.projections_of(Path::new(file))?,
            _ => (Vec::new(), self.space.and_then(|space| single(space.spaces()))),
        };
        let beside = if mccool { Some(BesideArg::Mccool) } else { args.beside };
        Ok(SearchSettings {
            strategy,
            terms: args.terms.map_or(5, usize::from),
            restarts: args.restarts.map(|count| count as usize),
            spaces: space.map_or(SpaceArg::Auto.spaces().to_vec(), |space| vec![space]),
            start,
            fixed: beside.map(Into::into),
        })
    }

    /// The projections of a file and their space, which must be the one asked for, if any.
    fn projections_of(&self, path: &Path) -> anyhow::Result<(Vec<Projection>, Option<Space>)> {
        let bytes = MappedFile::open(path)?;
        let ProjectionFile { space, projections } =
            read_projection_source(&bytes).map_err(FileError::content(path))?;
        let asked = self.space.and_then(|space| single(space.spaces()));
        if let (Some(asked), Some(found)) = (asked, space)
            && asked != found
        {
            return Err(usage(format!(
                "--space {} contradicts {}, whose projections are in {} space",
                asked.name(),
                path.display(),
                found.name()
            )));
        }
        Ok((projections, asked.or(space)))
    }
}

fn single<T: Copy>(choices: &[T]) -> Option<T> {
    match choices {
        [only] => Some(*only),
        _ => None,
    }
}
