//! Searches in several families keep, for each number of textures, the model of the best one.

use brdf_factor::Coordinate;
use brdf_fit::{
    FactoredMethod, FactoredSettings, Fit, FitSettings, Material, SearchSettings, Strategy, fit,
};
use brdf_job::Job;
use brdf_model::{Channels, PairSampling, Preset, SampleSet};
use brdf_param::Space;
use brdf_search::Objective;

fn settings(strategy: Strategy, terms: usize) -> FitSettings {
    let search = SearchSettings { strategy, terms, restarts: Some(1), ..Default::default() };
    FitSettings::Factored(FactoredSettings {
        samples: 1_500,
        texture_size: Some(6),
        channels: Some(Channels::Luminance),
        ..FactoredSettings::of(FactoredMethod::Search(search))
    })
}

/// With one texture of this material standard space is better, with more half/difference space.
#[test]
fn each_number_of_textures_keeps_the_best_space() {
    let ward = Preset::find("ward").expect("a preset").brdf();
    let material = Material::new("ward", &ward);
    for (strategy, terms) in [(Strategy::Joint, 3), (Strategy::Powell(Objective::Relative), 2)] {
        let fitted = fit(&material, &settings(strategy, terms), &Job::new()).expect("a fit");
        let Fit::Factored(fitted) = fitted else { unreachable!("a product was asked for") };
        let tried = &fitted.search.as_ref().expect("a search").tried;
        for (index, term) in fitted.terms.iter().enumerate() {
            let best = tried
                .iter()
                .min_by(|a, b| a.validation[index].total_cmp(&b.validation[index]))
                .expect("two families");
            assert_eq!(term.family, Some(best.family), "{strategy:?}, {} textures", index + 1);
            let space = best.family.space;
            for factor in fitted.fits[index].model.factors() {
                let coordinates = factor.coordinates().iter();
                let mut spaces = coordinates.map(|coordinate| match coordinate {
                    Coordinate::Projected { space, .. } => Some(*space),
                    _ => None,
                });
                assert!(spaces.all(|found| found == Some(space)), "{strategy:?}: {space:?}");
            }
            // What was chosen is as good on other pairs as it was on those that it was chosen by.
            let held_out = term.held_out.expect("pairs are drawn").log.mean_square;
            let ratio = held_out / best.validation[index];
            assert!((0.8..1.25).contains(&ratio), "{strategy:?}: {ratio}");
        }
        let spaces: Vec<Space> =
            fitted.terms.iter().filter_map(|term| Some(term.family?.space)).collect();
        if strategy == Strategy::Joint {
            assert_eq!(spaces, [Space::Standard, Space::HalfDifference, Space::HalfDifference]);
        }

        // The file says so, whichever model is taken out of it.
        let file = fitted.model();
        assert_eq!(Some(file.record.space), spaces.last().copied());
        let small = file.keep(1).expect("a smaller model");
        assert_eq!(small.record.space, spaces[0]);
        let (space, projections) = small.projections().expect("one space");
        assert_eq!((space, projections.len()), (spaces[0], 1));
    }
}

/// Families are compared on a part of the rows; those that win are searched again with all of them.
#[test]
fn winners_of_measured_rows_are_searched_again() {
    let ward = Preset::find("ward").expect("a preset").brdf();
    let sampling = PairSampling { count: 1_200, seed: 3, theta_max: 1.3 };
    let rows = SampleSet::draw(&ward, &sampling, Channels::Luminance);
    let material = Material::from_samples("ward", &rows);
    let fitted = fit(&material, &settings(Strategy::Joint, 3), &Job::new()).expect("a fit");
    let Fit::Factored(fitted) = fitted else { unreachable!("a product was asked for") };
    let tried = &fitted.search.as_ref().expect("a search").tried;
    let (compared, again) = tried.split_at(2);
    assert!(compared.iter().all(|search| search.validation.len() == 3));
    assert!(again.iter().all(|search| search.validation.is_empty()));
    for term in &fitted.terms {
        assert!(again.iter().any(|search| Some(search.family) == term.family), "{again:?}");
    }
    let evaluated: usize = tried.iter().map(|search| search.evaluations).sum();
    assert_eq!(fitted.evaluations, evaluated + fitted.fits.len());
}
