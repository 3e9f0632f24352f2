//! Estimates from a log with sectors.

use sextant_kernel::Unwatched;
use sextant_mapper::{EstimateKind, MlTmConfig, MmTm, ProfileConfig, TrapezoidConfig};

use super::{ARRAY, lanes, mean_error_m, nodes};

#[test]
fn a_fitted_posterior_mean_beats_the_argmax_of_a_trapezoid() {
    let nodes = nodes(11, 80);
    let log = ARRAY.log(3, &nodes, &lanes(1.5));
    let error_m = |profile, estimate| {
        let config = MlTmConfig { estimate, z_range_m: Some([0.0, 2.5]), ..MlTmConfig::new(0.2, profile) };
        let map = MmTm::try_from(config).expect("good settings").map(&log, &Unwatched);
        mean_error_m(&map.map(|(map, _)| map), &nodes)
    };
    let trapezoid = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.96, 2.0, 7.1));
    let (argmax_m, _) = error_m(trapezoid, EstimateKind::Argmax);
    let (fitted_m, unmapped) = error_m(ProfileConfig::Fitted(Default::default()), EstimateKind::PosteriorMean);
    assert_eq!(unmapped, 0);
    assert!(fitted_m < 0.85 * argmax_m && fitted_m < 0.45, "fitted {fitted_m} m, trapezoid {argmax_m} m");
}
