//! The methods at their sizes, and fits by them.

use brdf_factor::TexelFormat;
use brdf_fit::{
    CompactMethod, CompactSettings, FactorModel, FactorModelSettings, FactoredMethod,
    FactoredSettings, Fit, FitSettings, IsotropicSettings, LogChoice, Material, NetworkSettings,
    SearchSettings, SeparableMethod, SeparableSettings, fit, fit_factor_model, train_network,
};
use brdf_job::Job;
use brdf_model::{Brdf, Nbrdf};
use brdf_param::Parametrization;

/// Steps for scattered rows, of which there are a hundredth as many as drawn pairs.
const STEPS_FOR_ROWS: usize = 6_000;

/// A kind of model of one size.
pub(crate) struct Method {
    /// What tables call it.
    pub(crate) name: &'static str,
    /// What plots call all of its sizes.
    pub(crate) family: &'static str,
    /// Whether it is a model of about 8 kB, or the largest of a kind that stays below.
    pub(crate) is_shown: bool,
    way: Way,
}

enum Way {
    Fit(FitSettings),
    FactorModel,
    Network,
}

/// A model of any kind.
pub(crate) enum Model {
    Fit(Box<Fit>),
    FactorModel(FactorModel),
    Network(Box<Nbrdf>),
}

impl Model {
    pub(crate) fn brdf(&self) -> &dyn Brdf {
        match self {
            Self::Fit(fit) => fit.brdf(),
            Self::FactorModel(model) => model,
            Self::Network(network) => network.as_ref(),
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Fit(fit) => fit.bytes(),
            Self::FactorModel(model) => model.bytes(),
            Self::Network(_) => 4 * Nbrdf::WEIGHTS,
        }
    }
}

impl Method {
    pub(crate) fn fit(&self, material: &Material<'_>) -> anyhow::Result<Model> {
        let job = Job::new();
        Ok(match &self.way {
            Way::Fit(settings) => Model::Fit(Box::new(fit(material, settings, &job)?)),
            Way::FactorModel => {
                let settings = FactorModelSettings::default();
                Model::FactorModel(fit_factor_model(material, &settings, &job)?)
            }
            Way::Network => {
                let usual = NetworkSettings::default();
                let settings = match material.samples() {
                    Some(_) => NetworkSettings { steps: STEPS_FOR_ROWS, ..usual },
                    None => usual,
                };
                Model::Network(Box::new(train_network(material, &settings, &job)?))
            }
        })
    }
}

/// Every method at its sizes.
pub(crate) fn methods(with_search: bool, with_networks: bool) -> Vec<Method> {
    let mut methods = Vec::new();
    let mut add = |name, family, is_shown, way| {
        methods.push(Method { name, family, is_shown, way });
    };
    let compact = |method| Way::Fit(FitSettings::Compact(CompactSettings::of(method)));
    let splines = [
        ("splines 1k", 1_000),
        ("splines 2.7k", 2_700),
        ("splines 8k", 8_192),
        ("splines 33k", 33_000),
    ];
    for (name, bytes) in splines {
        add(name, "splines", bytes == 8_192, compact(CompactMethod::Spline { bytes }));
    }
    for (name, lobes) in [("GGX, 1 lobe", 1), ("GGX, 2 lobes", 2)] {
        add(name, "GGX lobes", lobes == 2, compact(CompactMethod::Ggx { lobes }));
    }
    add("factor model", "factor model", true, Way::FactorModel);
    if with_networks {
        add("network", "network", true, Way::Network);
    }
    for (name, bytes) in [("angles 2.7k", 2_700), ("angles 8k", 8_192), ("angles 34k", 34_560)] {
        let angles = IsotropicSettings { bytes, ..IsotropicSettings::default() };
        let settings =
            FactoredSettings::of(FactoredMethod::Isotropic(angles)).storing(TexelFormat::F16);
        add(name, "angles", bytes == 8_192, Way::Fit(FitSettings::Factored(settings)));
    }
    for (name, size) in [("McCool 10²", 10), ("McCool 18²", 18), ("McCool 38²", 38)] {
        let mccool = FactoredSettings::of(FactoredMethod::McCool);
        let settings = FactoredSettings { texture_size: Some(size), ..mccool };
        add(name, "McCool", size == 18, Way::Fit(FitSettings::Factored(settings)));
    }
    for (name, resolution, rank) in [("log-SVD 16", 16, 3), ("log-SVD 32", 32, 3)] {
        let settings = SeparableSettings {
            parametrization: Parametrization::HalfDifference,
            isotropic: true,
            resolution,
            rank: Some(rank),
            ..SeparableSettings::of(SeparableMethod::LogSvd(LogChoice::Offset))
        };
        let way = Way::Fit(FitSettings::Separable(settings));
        add(name, "log-SVD", resolution == 16, way);
    }
    if with_search {
        let searches =
            [("search 3 × 8²", 3, 8), ("search 4 × 13²", 4, 13), ("search 5 × 24²", 5, 24)];
        for (name, terms, size) in searches {
            let search = SearchSettings { terms, ..SearchSettings::default() };
            let search = FactoredSettings::of(FactoredMethod::Search(search));
            let settings = FactoredSettings { texture_size: Some(size), ..search };
            add(name, "search", size == 13, Way::Fit(FitSettings::Factored(settings)));
        }
    }
    methods
}
