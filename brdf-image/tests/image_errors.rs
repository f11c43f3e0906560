//! Measures of pictures: symmetric, bounded, and at their ideal on equal pictures.

use brdf_image::{PIXELS_PER_DEGREE, Planes, delta_e_itp_map, flip_map, psnr_db, ssim_map};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn image_measures_are_symmetric_and_find_equals(
        values in prop::collection::vec(0.0..1.0_f64, 6 * 20 * 24),
    ) {
        let planes = |part: usize| Planes {
            width: 24,
            channels: std::array::from_fn(|c| values[(3 * part + c) * 480..][..480].to_vec()),
        };
        let (a, b) = (planes(0), planes(1));
        let mask = vec![true; 480];
        prop_assert_eq!(psnr_db(&a, &a, &mask), None);
        prop_assert_eq!(psnr_db(&a, &b, &mask), psnr_db(&b, &a, &mask));
        type Map = fn(&Planes, &Planes) -> Vec<f64>;
        let maps: [(Map, f64); 3] = [
            (ssim_map, 1.0),
            (|a, b| flip_map(a, b, PIXELS_PER_DEGREE), 0.0),
            (delta_e_itp_map, 0.0),
        ];
        for (map, equal) in maps {
            prop_assert!(map(&a, &a).iter().all(|v| (v - equal).abs() < 1e-9));
            for (there, back) in map(&a, &b).iter().zip(map(&b, &a)) {
                prop_assert!((there - back).abs() < 1e-9);
            }
        }
        prop_assert!(flip_map(&a, &b, PIXELS_PER_DEGREE).iter().all(|v| (0.0..=1.0).contains(v)));
        prop_assert!(ssim_map(&a, &b).iter().all(|v| *v <= 1.0 + 1e-12));
    }
}
