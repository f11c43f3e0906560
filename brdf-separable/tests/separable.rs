//! Sums of products: the laws of their decompositions, and models that are what they were made of.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "a test that cannot go on has failed"
)]

use brdf_job::Job;
use brdf_model::{Brdf, Channels, PairSampling, Preset, Rgb, cosine_rms};
use brdf_param::{DirectionPair, HemisphereMap, Parametrization};
use brdf_separable::{
    BrdfMatrix, Decomposition, EigenSolver, Fill, HemisphereGrid, KrylovParams, Layout,
    MatrixParams, NonnegativeParams, SeparableError, SeparableParams, ValueTransform,
    cosine_rms_by_rank, factorize_matrix, nonnegative_factors, power_iteration, top_eigenpairs,
    top_singular_triplets,
};
use faer::Mat;
use proptest::prelude::*;

/// A matrix of numbers in [−1, 1] without structure.
fn noise(rows: usize, columns: usize, seed: u64) -> Mat<f64> {
    Mat::from_fn(rows, columns, |row, column| {
        let mut bits =
            seed ^ (((row as u64) << 32) | column as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        for _ in 0..3 {
            bits ^= bits >> 29;
            bits = bits.wrapping_mul(0xbf58_476d_1ce4_e5b9);
        }
        let unit = (bits >> 11) as f64 / 9_007_199_254_740_992.0;
        2.0 * unit - 1.0
    })
}

/// Orthonormal columns.
fn orthonormal(rows: usize, columns: usize, seed: u64) -> Mat<f64> {
    noise(rows, columns, seed).qr().compute_thin_Q()
}

/// A symmetric matrix with these eigenvalues.
fn planted(size: usize, values: &[f64], seed: u64) -> Mat<f64> {
    let vectors = orthonormal(size, values.len(), seed);
    let scaled = Mat::from_fn(size, values.len(), |row, k| vectors[(row, k)] * values[k]);
    &scaled * vectors.transpose()
}

fn disc(resolution: usize) -> Layout {
    let chart = HemisphereGrid::Plane { map: HemisphereMap::OrthographicDisc, resolution };
    Layout::new(Parametrization::Standard, chart, chart)
}

fn sampled(name: &str, layout: &Layout) -> BrdfMatrix {
    let brdf = Preset::find(name).unwrap().brdf();
    BrdfMatrix::sample(&brdf, layout, &MatrixParams::default()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn eigenpairs_of_a_planted_indefinite_matrix_come_back(
        size in 170_usize..300,
        seed in 0_u64..1000,
    ) {
        let values = [9.0, -7.0, 6.0, 5.0, -4.0, 1.0, 0.5, -0.2];
        let matrix = planted(size, &values, seed);
        let params = KrylovParams { rank: 5, tolerance: 1e-9, ..KrylovParams::default() };
        let pairs = top_eigenpairs(matrix.as_ref(), &params).unwrap();
        prop_assert!(pairs.converged);
        for (found, expected) in pairs.values.iter().zip(values) {
            prop_assert!((found - expected).abs() < 1e-8, "{found} for {expected}");
        }
        for (k, value) in pairs.values.iter().enumerate() {
            let v = pairs.left.col(k);
            let off = (&matrix * v - v * faer::Scale(*value)).norm_l2();
            prop_assert!(off < 1e-7, "residual {off} of {value}");
        }
    }

    #[test]
    fn a_truncated_svd_misses_what_its_singular_values_say(
        rows in 165_usize..200,
        columns in 165_usize..220,
        seed in 0_u64..1000,
    ) {
        let values = [8.0, 5.0, 3.0, 2.0, 1.0, 0.5];
        let (left, right) = (orthonormal(rows, 6, seed), orthonormal(columns, 6, seed + 1));
        let scaled = Mat::from_fn(rows, 6, |row, k| left[(row, k)] * values[k]);
        let matrix = &scaled * right.transpose();
        for rank in 1..=5 {
            let params = KrylovParams { rank, tolerance: 1e-9, ..KrylovParams::default() };
            let pairs = top_singular_triplets(matrix.as_ref(), &params).unwrap();
            let scaled = Mat::from_fn(rows, rank, |row, k| pairs.left[(row, k)] * pairs.values[k]);
            let missed = (&matrix - &scaled * pairs.right.transpose()).norm_l2();
            let expected = values[rank..].iter().map(|v| v * v).sum::<f64>().sqrt();
            prop_assert!((missed - expected).abs() < 1e-7, "{missed} at rank {rank}, not {expected}");
        }
    }

    #[test]
    fn the_dense_and_the_iterative_solver_agree(seed in 0_u64..1000) {
        // 150 is decomposed densely, the same matrix beside zeros is not.
        let small = planted(150, &[5.0, -4.0, 3.0, -2.0, 1.0], seed);
        let large = Mat::from_fn(200, 200, |row, column| {
            if row < 150 && column < 150 { small[(row, column)] } else { 0.0 }
        });
        let params = KrylovParams { rank: 4, tolerance: 1e-9, ..KrylovParams::default() };
        let dense = top_eigenpairs(small.as_ref(), &params).unwrap();
        let iterative = top_eigenpairs(large.as_ref(), &params).unwrap();
        for (a, b) in dense.values.iter().zip(&iterative.values) {
            prop_assert!((a - b).abs() < 1e-8, "{a} against {b}");
        }
    }

    #[test]
    fn nonnegative_factors_are_and_find_a_planted_product(
        rows in 20_usize..60,
        columns in 20_usize..60,
        seed in 0_u64..1000,
    ) {
        let positive = |rows, columns, seed| {
            let raw = noise(rows, columns, seed);
            Mat::from_fn(rows, columns, |row, column| raw[(row, column)].max(0.0))
        };
        let matrix = positive(rows, 2, seed) * positive(columns, 2, seed + 1).transpose();
        let params = NonnegativeParams { rank: 2, sweeps: 600, tolerance: 1e-9 };
        let (w, h, _) = nonnegative_factors(matrix.as_ref(), &params, &Job::new()).unwrap();
        let negative = |side: &Mat<f64>| (0..side.ncols()).any(|c| side.col(c).iter().any(|v| *v < 0.0));
        prop_assert!(!negative(&w) && !negative(&h));
        let missed = (&matrix - &w * h.transpose()).norm_l2() / matrix.norm_l2();
        prop_assert!(missed < 0.05, "missed {missed}");
    }
}

#[test]
fn the_ashikhmin_shirley_matrix_has_its_recorded_eigenvalues() {
    let matrix = sampled("ashikhmin-shirley", &disc(48)).channel(0);
    let params = KrylovParams { rank: 8, ..KrylovParams::default() };
    let pairs = top_eigenpairs(matrix.as_ref(), &params).unwrap();
    let recorded = [390.56, -311.28, 296.89, -281.14, 260.07, -241.98, 241.98, -239.84];
    assert!(pairs.values.len() >= 8 && pairs.residuals.iter().all(|r| *r <= 1e-5));
    for (found, expected) in pairs.values.iter().zip(recorded) {
        // The sixth and seventh have the same size; either may come first.
        assert!((found.abs() - f64::abs(expected)).abs() < 0.01, "{found} for {expected}");
    }
    let signs: f64 = pairs.values[5..7].iter().map(|v| v.signum()).sum();
    assert!(signs.abs() < 0.5, "one of each sign");
}

#[test]
fn the_printed_power_iteration_fails_on_it() {
    let matrix = sampled("ashikhmin-shirley", &disc(48)).channel(0);
    let pairs = power_iteration(matrix.as_ref(), 8, 1);
    let worst = pairs.iter().map(|p| p.residual).fold(0.0, f64::max);
    assert!(worst > 0.1, "the pair ±241.98 lets the quotient settle on no eigenvalue: {worst}");
    let exact = [390.56, 311.28, 296.89, 281.14, 260.07, 241.98, 241.98, 239.84];
    let farthest = pairs
        .iter()
        .map(|p| exact.iter().map(|e| (p.value.abs() - e).abs()).fold(f64::INFINITY, f64::min))
        .fold(0.0, f64::max);
    assert!(farthest > 1.0, "a value that belongs to no eigenvector: off by {farthest}");
}

#[test]
fn residuals_fall_with_every_term_and_match_the_spectrum() {
    let matrix = sampled("plastic", &disc(24));
    let fit = factorize_matrix(
        &matrix,
        &SeparableParams { rank: 12, ..SeparableParams::default() },
        &Job::new(),
    )
    .unwrap();
    let residuals: Vec<f64> = fit.errors.iter().map(|e| e.relative_residual).collect();
    assert!(residuals.windows(2).all(|pair| pair[1] <= pair[0]), "{residuals:?}");
    // Orthographic texels weigh alike, so that shares of energy are those of the spectrum.
    let squares = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
    let values = &fit.spectra[0].values;
    for rank in 1..values.len() {
        let lost = residuals[rank - 1].powi(2) - residuals[values.len() - 1].powi(2);
        let scale = (1.0 - residuals[values.len() - 1].powi(2)) / squares(values);
        assert!((lost - scale * squares(&values[rank..])).abs() < 1e-5, "rank {rank}");
    }
}

#[test]
fn isotropic_pairs_are_never_split() {
    // n = 40 plastic: 332.1, then two eigenvalues of −124.3 each.
    let matrix = sampled("plastic", &disc(48));
    let decomposition = Decomposition::Eigen(EigenSolver::Krylov);
    let params = SeparableParams { rank: 2, decomposition, ..SeparableParams::default() };
    let fit = factorize_matrix(&matrix, &params, &Job::new()).unwrap();
    assert_eq!((fit.model.rank(), fit.spectra[0].added), (3, 1));
    let turned = |phi: f64| {
        let pair = DirectionPair::from_angles(0.6, phi, 0.5, phi + 2.0);
        fit.model.eval_unclamped(&pair).g
    };
    // To the interpolation between texels.
    assert!((turned(0.0) - turned(0.7)).abs() < 0.01 * turned(0.0).abs().max(0.05));
}

#[test]
fn one_product_of_the_normalized_decomposition_is_exact_for_products() {
    let matrix = sampled("lambert", &disc(16));
    let decomposition = Decomposition::Normalized;
    let params = SeparableParams { rank: 1, decomposition, ..SeparableParams::default() };
    let fit = factorize_matrix(&matrix, &params, &Job::new()).unwrap();
    assert!(fit.errors[0].relative_residual < 1e-6, "{:?}", fit.errors);
    // A constant has rank one, and no decomposition invents more.
    let svd = factorize_matrix(
        &matrix,
        &SeparableParams { rank: 4, ..SeparableParams::default() },
        &Job::new(),
    )
    .unwrap();
    assert_eq!(svd.model.rank(), 1);
}

#[test]
fn nmf_models_are_never_negative_and_svd_models_ring() {
    let layout = disc(24);
    let matrix = sampled("ggx", &layout);
    let decomposed = |decomposition| {
        factorize_matrix(
            &matrix,
            &SeparableParams { rank: 6, decomposition, ..SeparableParams::default() },
            &Job::new(),
        )
        .unwrap()
        .model
    };
    let sampling = PairSampling { count: 5_000, seed: 3, theta_max: 1.5 };
    let lowest = |model: &dyn Brdf| {
        sampling.pairs().map(|pair| model.eval_unclamped(&pair).g).fold(f64::INFINITY, f64::min)
    };
    assert!(lowest(&decomposed(Decomposition::Nmf)) >= 0.0);
    assert!(lowest(&decomposed(Decomposition::Svd)) < 0.0);
}

#[test]
fn joint_channels_share_scalar_textures() {
    let matrix = sampled("red-plastic", &disc(20));
    let fit = factorize_matrix(
        &matrix,
        &SeparableParams { rank: 6, joint_rgb: true, ..SeparableParams::default() },
        &Job::new(),
    )
    .unwrap();
    assert_eq!((fit.model.first_channels(), fit.spectra.len()), (1, 1));
    let brdf = Preset::find("red-plastic").unwrap().brdf();
    let pair = DirectionPair::from_angles(0.3, 0.2, 0.5, 1.9);
    let (exact, short): (Rgb, Rgb) = (brdf.eval(&pair), fit.model.eval(&pair));
    assert!(
        (exact.r - short.r).abs() < 0.15 * exact.r && short.r > short.g,
        "{short:?} for {exact:?}"
    );
}

#[test]
fn truncated_models_are_the_leading_terms() {
    let matrix = sampled("plastic", &disc(16));
    let fit = factorize_matrix(
        &matrix,
        &SeparableParams { rank: 6, ..SeparableParams::default() },
        &Job::new(),
    )
    .unwrap();
    let pair = DirectionPair::from_angles(0.4, 0.0, 0.7, 2.5);
    let mut partial = Vec::new();
    fit.model.partial_sums(&pair, |_, value| partial.push(value.g));
    for rank in 1..=fit.model.rank() {
        let short = fit.model.truncated(rank).unwrap();
        let single = short.eval_unclamped(&pair).g;
        assert!((single - partial[rank - 1]).abs() < 1e-5, "{single} at rank {rank}");
    }
    assert!(fit.model.truncated(fit.model.rank() + 1).is_err());
}

#[test]
fn requests_that_cannot_be_met_are_refused() {
    let brdf = Preset::find("plastic").unwrap().brdf();
    let tight = MatrixParams { memory_limit: 1 << 20, ..MatrixParams::default() };
    let refused = BrdfMatrix::sample(&brdf, &disc(48), &tight).unwrap_err();
    assert!(matches!(refused, SeparableError::Memory { rows: 1804, .. }), "{refused}");
    assert!(refused.to_string().contains("MiB"), "{refused}");

    let matrix = sampled("plastic", &disc(4));
    let too_many = SeparableParams { rank: 1000, ..SeparableParams::default() };
    assert!(matches!(
        factorize_matrix(&matrix, &too_many, &Job::new()),
        Err(SeparableError::Rank { max: 12, .. })
    ));

    let chart = HemisphereGrid::Plane { map: HemisphereMap::Polar, resolution: 8 };
    let halves = Layout::new(Parametrization::HalfDifference, chart, chart);
    let eigen = SeparableParams {
        decomposition: Decomposition::Eigen(EigenSolver::Krylov),
        ..SeparableParams::default()
    };
    let refused = factorize_matrix(&sampled("plastic", &halves), &eigen, &Job::new()).unwrap_err();
    assert!(matches!(refused, SeparableError::NotSymmetric { .. }), "{refused}");

    let logs =
        MatrixParams { maps: [ValueTransform::Offset { a: 1e-5 }; 3], ..MatrixParams::default() };
    let matrix = BrdfMatrix::sample(&brdf, &disc(8), &logs).unwrap();
    let nmf = SeparableParams { decomposition: Decomposition::Nmf, ..SeparableParams::default() };
    assert!(matches!(
        factorize_matrix(&matrix, &nmf, &Job::new()),
        Err(SeparableError::Negative { .. })
    ));
}

#[test]
fn cells_are_counted_by_where_their_value_came_from() {
    let brdf = Preset::find("plastic").unwrap().brdf();
    let chart = HemisphereGrid::Plane { map: HemisphereMap::Polar, resolution: 12 };
    let layout = Layout::new(Parametrization::HalfDifference, chart, chart);
    for fill in [Fill::Edge, Fill::Zero] {
        let params = MatrixParams { theta_max: 1.3, fill, ..MatrixParams::default() };
        let counts = BrdfMatrix::sample(&brdf, &layout, &params).unwrap().counts();
        assert_eq!(counts.cells, 144 * 144);
        assert_eq!(counts.valid + counts.filled + counts.zero, counts.cells);
        assert!(counts.valid > 0);
        match fill {
            Fill::Edge => assert!(counts.filled > 0 && counts.zero == 0, "{counts:?}"),
            Fill::Zero => assert!(counts.zero > 0 && counts.filled == 0, "{counts:?}"),
        }
    }
}

#[test]
fn models_do_not_depend_on_the_number_of_threads() {
    let made = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let matrix = sampled("red-plastic", &disc(20));
            let decomposition = Decomposition::Eigen(EigenSolver::Krylov);
            let params = SeparableParams { rank: 5, decomposition, ..SeparableParams::default() };
            factorize_matrix(&matrix, &params, &Job::new()).unwrap().model
        })
    };
    assert_eq!(made(1), made(2));
}

/// Recorded by the project's relighting experiments: relative errors of 8 and 16 terms at 48².
#[test]
fn the_cosine_weighted_error_of_plastic_is_the_recorded_one() {
    let brdf = Preset::find("plastic").unwrap().brdf();
    let matrix = sampled("plastic", &disc(48));
    let decomposition = Decomposition::Eigen(EigenSolver::Krylov);
    // Pairs of equal eigenvalues would be completed: 5, 8 and 16 terms.
    for (rank, relative) in [(8, 0.342), (16, 0.217)] {
        let params = SeparableParams { rank, decomposition, ..SeparableParams::default() };
        let model = factorize_matrix(&matrix, &params, &Job::new()).unwrap().model;
        let model = model.truncated(rank).unwrap();
        let rms = cosine_rms(&brdf, &model, Channels::Luminance, 1);
        let found = rms.relative;
        // Plastic is grey. Both look up in f32, in another order.
        let by_rank = cosine_rms_by_rank(&brdf, &model, 1)[rank - 1];
        assert!((by_rank.absolute / rms.absolute - 1.0).abs() < 1e-4);
        assert!((by_rank.within_80 / rms.within_80 - 1.0).abs() < 1e-4);
        assert!((found / relative - 1.0).abs() < 0.05, "rank {rank}: {found}");
    }
}
