//! Estimates from a log with sectors.

use sextant_channel::ReceptionLog;
use sextant_kernel::Unwatched;
use sextant_mapper::{
    EstimateKind, Fitted, FittedConfig, MlTmConfig, MmTm, ObstacleKnowledge, ProfileConfig, SectorModel,
    SectorsConfig, SelfCalibrated, SelfCalibratedConfig, SoftSectorsConfig, TableProfile, TrapezoidConfig,
};

use super::{ARRAY, Radio, lanes, mean_error_m, nodes};

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

#[test]
fn a_fitted_curve_counts_silence_only_where_sectors_point() {
    // Half of the stops near a node are right below it, where no sector of this array points.
    let low = Radio { rings_deg: &[[0.0, 35.0]], ..ARRAY };
    let nodes = nodes(5, 80);
    let log = low.log(8, &nodes, &lanes(1.5));
    let fit = |log: &ReceptionLog| {
        let fitted = Fitted::try_from(FittedConfig::default()).expect("good settings");
        fitted.fit(log, Some([0.0, 2.5]), &Unwatched).expect("nobody interrupts").expect("nodes were heard").curve
    };
    let plain = ReceptionLog::new(log.names().to_vec(), log.stops().to_vec(), log.receptions().to_vec(), Vec::new());
    let (with, without) = (fit(&log), fit(&plain.unwrap()));
    // Mean deviation from the true curve over the range.
    let off = |curve: &TableProfile| {
        let at = |i: i32| 0.1 * f64::from(i);
        (5..65).map(|i| (curve.probability(at(i)) - low.probability(at(i))).abs()).sum::<f64>() / 60.0
    };
    assert!(off(&with) < 0.06 && off(&without) > 2.0 * off(&with), "{} with, {} without", off(&with), off(&without));
}

#[test]
fn a_self_calibrated_map_uses_sectors() {
    let nodes = nodes(21, 80);
    let log = ARRAY.log(4, &nodes, &lanes(1.5));
    let plain = ReceptionLog::new(log.names().to_vec(), log.stops().to_vec(), log.receptions().to_vec(), Vec::new());
    let config = SelfCalibratedConfig {
        z_range_m: Some([0.0, 2.5]),
        obstacles: ObstacleKnowledge::None,
        ..SelfCalibratedConfig::default()
    };
    let algorithm = SelfCalibrated::try_from(config).expect("good settings");
    let error_m = |log: &ReceptionLog| {
        let map = algorithm.map(log, &Unwatched).map(|(map, _)| map);
        mean_error_m(&map, &nodes).0
    };
    let (with_m, without_m) = (error_m(&log), error_m(&plain.unwrap()));
    assert!(with_m < 0.8 * without_m, "{with_m} m with sectors, {without_m} m without");
}

#[test]
fn many_packets_missed_where_no_sector_points_say_nothing() {
    let many = Radio { packets: 60, noise_deg: 0.0, rings_deg: &[[0.0, 35.0]], ..ARRAY };
    let nodes = nodes(2, 12);
    let log = many.log(4, &nodes, &lanes(1.5));
    let config = SelfCalibratedConfig { z_range_m: Some([0.0, 2.5]), ..SelfCalibratedConfig::default() };
    let map = SelfCalibrated::try_from(config).expect("good settings").map(&log, &Unwatched).map(|(map, _)| map);
    let (error_m, unmapped) = mean_error_m(&map, &nodes);
    assert!(error_m < 0.5 && unmapped == 0, "{error_m} m");
}

#[test]
fn probabilities_of_sectors_place_nodes_better_than_their_edges() {
    let noisy = Radio { sigma_db: 3.0, sectors: 32, ..ARRAY };
    let nodes = nodes(31, 80);
    let log = noisy.log(6, &nodes, &lanes(3.0));
    let error_m = |model| {
        let sectors = Some(SectorsConfig { model: Some(model), ..SectorsConfig::default() });
        let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.96, 2.0, 7.1));
        let config = MlTmConfig {
            sectors,
            estimate: EstimateKind::PosteriorMean,
            z_range_m: Some([0.0, 2.5]),
            ..MlTmConfig::new(0.2, profile)
        };
        let map = MmTm::try_from(config).expect("good settings").map(&log, &Unwatched);
        mean_error_m(&map.map(|(map, _)| map), &nodes).0
    };
    let soft = |sigma_db| SectorModel::Soft(SoftSectorsConfig { sigma_db, ..SoftSectorsConfig::default() });
    let (edges_m, given_m, fitted_m) = (error_m(SectorModel::Wedge), error_m(soft(Some(3.0))), error_m(soft(None)));
    assert!(given_m < 0.97 * edges_m && fitted_m < 0.97 * edges_m, "{edges_m} m; {given_m} m, fitted {fitted_m} m");
}
