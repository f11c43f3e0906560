//! Methods that take a material to be isotropic give isotropic models, the mirror direction included.

use brdf_factor::{IsotropicPairs, Spacing, TexelFormat};
use brdf_fit::{
    AutoSettings, CompactMethod, CompactSettings, FactoredMethod, FactoredSettings, Fit,
    FitSettings, IsotropicSettings, LogChoice, Material, Method, SeparableMap, SeparableMethod,
    SeparableSettings, fit,
};
use brdf_job::Job;
use brdf_model::{PairSampling, Preset, SampleSet};
use brdf_param::{DirectionPair, Parametrization};

fn material() -> impl brdf_model::Brdf {
    Preset::find("cook-torrance").expect("a preset").brdf()
}

fn fitted(settings: &FitSettings) -> Fit {
    fit(&Material::new("cook-torrance", &material()), settings, &Job::new()).expect("a fit")
}

#[test]
fn turning_both_directions_changes_no_isotropic_model() {
    let compact = |method| FitSettings::Compact(CompactSettings::of(method));
    let separable = |map| {
        FitSettings::Separable(SeparableSettings {
            parametrization: Parametrization::HalfDifference,
            isotropic: true,
            resolution: 16,
            map,
            rank: Some(2),
            ..SeparableSettings::of(SeparableMethod::LogSvd(LogChoice::Offset))
        })
    };
    let radial = FactoredSettings {
        samples: 3000,
        texture_size: Some(16),
        ..FactoredSettings::of(FactoredMethod::Radial)
    };
    let angles = |pairs, texels| {
        let spacing = Some(Spacing::Power { exponent: 0.5 });
        let angles = IsotropicSettings { pairs: Some(pairs), spacing, bytes: 3000 };
        let method = FactoredMethod::Isotropic(angles);
        let settings = FactoredSettings::of(method).storing(texels);
        FitSettings::Factored(FactoredSettings { samples: 3000, ..settings })
    };
    let settings = [
        angles(IsotropicPairs::Polar, TexelFormat::F32),
        angles(IsotropicPairs::Polar, TexelFormat::U8),
        angles(IsotropicPairs::Cartesian, TexelFormat::F16),
        angles(IsotropicPairs::Oriented, TexelFormat::U8),
        separable(SeparableMap::Merl),
        FitSettings::Auto(AutoSettings::default()),
        compact(CompactMethod::Spline { bytes: 900 }),
        compact(CompactMethod::Ggx { lobes: 2 }),
        FitSettings::Factored(radial),
        separable(SeparableMap::Parabolic),
    ];
    let mirrors = (0..20).map(|step| {
        let theta = 0.07 * f64::from(step);
        DirectionPair::from_angles(theta, 0.0, theta, std::f64::consts::PI)
    });
    let sampling = PairSampling { count: 100, seed: 5, theta_max: 1.5 };
    let pairs: Vec<DirectionPair> = sampling.pairs().chain(mirrors).collect();
    for settings in settings {
        let model = fitted(&settings);
        for pair in &pairs {
            let value = model.brdf().eval(pair).g;
            for turn in [0.4, 1.3, 2.9] {
                let turned = model.brdf().eval(&pair.rotated_about_normal(turn)).g;
                let off = (turned - value).abs();
                assert!(off <= 1e-5 * value, "{}: {value}, turned {turned}", model.method());
            }
            let exchanged = model.brdf().eval(&pair.swapped()).g;
            let is_reciprocal = !matches!(model, Fit::Separable(_));
            assert!(
                !is_reciprocal || (exchanged - value).abs() <= 1e-6 * value,
                "{}: {value}, exchanged {exchanged}",
                model.method()
            );
        }
    }
}

#[test]
fn splines_are_chosen_where_they_are_best_and_few_rows_are_no_error() {
    let auto = FitSettings::Auto(AutoSettings::default());
    assert_eq!(fitted(&auto).method(), Method::Spline);
    let sampling = PairSampling { count: 40, seed: 1, theta_max: 1.4 };
    let few = SampleSet::draw(&material(), &sampling, brdf_model::Channels::Rgb);
    let few = fit(&Material::from_samples("forty rows", &few), &auto, &Job::new());
    assert!(few.is_ok(), "forty rows: {few:?}");
}
