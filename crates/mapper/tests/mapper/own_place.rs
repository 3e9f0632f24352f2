//! A node's own place: the same as on the map of a robot that stopped at the anchors, and the literal formulas.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use proptest::prelude::*;
use sextant_channel::{EvenSectorsConfig, Position, Reception, ReceptionLog, SectorTable, Stop, Wedge};
use sextant_kernel::{NodeId, Purpose, RobotId, Seed, SimTime, Unwatched};
use sextant_mapper::{
    AnchorSilence, Estimate, EstimateKind, HeardAnchor, HeardSector, MlTm, MlTmConfig, OwnEstimate, OwnPlace,
    OwnPlaceConfig, PlaceModel, ProfileConfig, SectorTolerance, SectorsConfig, SilenceRule, TrapezoidConfig,
};

const WHOLE: [f64; 2] = [-FRAC_PI_2, FRAC_PI_2];
const RANGE_M: f64 = 7.0;

fn config(step_m: f64) -> OwnPlaceConfig {
    OwnPlaceConfig::new(step_m, ProfileConfig::Trapezoid(TrapezoidConfig::new(0.95, 2.0, RANGE_M)))
}

fn own(config: OwnPlaceConfig) -> OwnPlace {
    OwnPlace::try_from(config).expect("good settings")
}

fn omni(place: Position) -> HeardAnchor {
    HeardAnchor { place, sector: None, covariance: None, packets: 1 }
}

fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

fn azimuth(from: Position, to: Position) -> f64 {
    libm::atan2(to.y_m - from.y_m, to.x_m - from.x_m)
}

fn elevation(from: Position, to: Position) -> f64 {
    libm::atan2(to.z_m - from.z_m, libm::hypot(to.x_m - from.x_m, to.y_m - from.y_m))
}

/// The sector that points from `place` to `node`, with the middle of sector 0 at `turn`.
fn sector_towards(place: Position, node: Position, sectors: u8, turn: f64) -> u8 {
    let width = TAU / f64::from(sectors);
    let along = (azimuth(place, node) - turn + 0.5 * width).rem_euclid(TAU) / width;
    (0..sectors).rev().find(|&i| f64::from(i) <= along).unwrap_or(0)
}

fn wedge(middle: f64, width: f64) -> Wedge {
    Wedge { azimuth_from_rad: middle - 0.5 * width, azimuth_width_rad: width, elevation_rad: WHOLE }
}

/// The map of a robot that stopped at the anchors and heard one node at those with a sector or `true`.
fn log(anchors: &[(Position, bool, Option<u8>)], table: Option<SectorTable>) -> ReceptionLog {
    let stops = anchors.iter().map(|&(position, ..)| Stop {
        robot: RobotId(0),
        time: SimTime::ZERO,
        position,
        heading_rad: None,
    });
    let receptions = (0_u32..).zip(anchors).filter(|(_, anchor)| anchor.1).map(|(stop, &(_, _, sector))| Reception {
        node: NodeId(0),
        stop,
        received: 1,
        sent: 1,
        sector,
        rssi_dbm: None,
        snr_db: None,
    });
    let log = ReceptionLog::new(vec!["n0".into()], stops.collect(), receptions.collect(), Vec::new()).expect("a log");
    match table {
        Some(table) => log.with_sectors(table).expect("sectors of the table"),
        None => log,
    }
}

fn assert_same(own: &OwnEstimate, other: &Estimate) {
    let own = &own.estimate;
    assert!(own.position.distance_m(other.position) < 1e-6, "{own:?} {other:?}");
    assert_eq!(own.ties, other.ties);
    let difference = own.log_likelihood.zip(other.log_likelihood).map(|(a, b)| (a - b).abs());
    assert!(difference.is_some_and(|difference| difference < 1e-8), "{own:?} {other:?}");
    match (&own.covariance, &other.covariance) {
        (Some(a), Some(b)) => {
            for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
                assert!((a - b).abs() < 1e-6);
            }
        }
        (a, b) => assert_eq!(a, b),
    }
}

/// A node within the range of all anchors, in the plane or in space.
fn scene() -> impl Strategy<Value = (Position, Vec<Position>)> {
    let place = |z: f64| (-4.5..4.5_f64, -4.5..4.5_f64, -z..=z).prop_map(|(x, y, z)| Position::new(x, y, z));
    prop_oneof![Just(0.0), Just(2.0)].prop_flat_map(move |z| {
        let node = (-0.3..0.3_f64, -0.3..0.3_f64).prop_map(|(x, y)| Position::new(x, y, 0.0));
        (node, prop::collection::vec(place(z), 1..8))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn without_sectors_it_is_ml_tm((_, places) in scene(), heard in 1..255_u8, literal: bool, silence: bool, mean: bool) {
        let estimate = if mean { EstimateKind::PosteriorMean } else { EstimateKind::Argmax };
        let trapezoid = TrapezoidConfig::new(0.95, 2.0, RANGE_M);
        let profile = ProfileConfig::Trapezoid(if literal { trapezoid.literal() } else { trapezoid });
        let anchors: Vec<_> = places.iter().enumerate().map(|(i, &place)| (place, heard >> i & 1 == 1, None)).collect();
        let silence = if silence { AnchorSilence::Missed } else { AnchorSilence::Ignored };
        let log_anchors: Vec<_> = anchors.iter().copied().filter(|a| a.1 || silence == AnchorSilence::Missed).collect();
        // Without heights of the settings, both take those of their own places.
        let z_range_m = Some(if places.iter().any(|place| place.z_m.abs() > 0.0) { [-2.0, 2.0] } else { [0.0, 0.0] });
        let ml_tm = MlTmConfig { estimate, z_range_m, ..MlTmConfig::new(0.4, profile.clone()) };
        let map = MlTm::try_from(ml_tm).unwrap().map(&log(&log_anchors, None), &Unwatched).unwrap();
        let here = own(OwnPlaceConfig { estimate, silence, z_range_m, ..OwnPlaceConfig::new(0.4, profile) });
        let of = |wanted: bool| -> Vec<HeardAnchor> {
            anchors.iter().filter(|a| a.1 == wanted).map(|a| omni(a.0)).collect()
        };
        match (here.estimate(&of(true), &of(false)), &map.estimates[0]) {
            (Some(own), Some(other)) if !other.infeasible => {
                prop_assert_eq!(own.violations, 0);
                assert_same(&own, other);
            }
            (own, other) => prop_assert_eq!(own.is_some(), other.is_some()),
        }
    }

    #[test]
    fn with_sectors_it_is_mm_tm(
        (node, places) in scene(), turn_deg in -180.0..180.0_f64, which in 0..3_usize, mean: bool,
    ) {
        let estimate = if mean { EstimateKind::PosteriorMean } else { EstimateKind::Argmax };
        let tolerance =
            [SectorTolerance::Positional, SectorTolerance::Angular, SectorTolerance::AngularLiteral][which];
        let table = SectorTable::try_from(EvenSectorsConfig {
            azimuth_sectors: 8, first_azimuth_deg: turn_deg, elevations_deg: vec![[-90.0, 90.0]],
        }).unwrap();
        let sector = |place| sector_towards(place, node, 8, turn_deg.to_radians());
        let anchors: Vec<_> = places.iter().map(|&place| (place, true, Some(sector(place)))).collect();
        let profile = config(0.4).profile;
        let sectors = SectorsConfig { tolerance, silence: SilenceRule::Everywhere, ..SectorsConfig::default() };
        let ml_tm = MlTmConfig { estimate, sectors: Some(sectors), ..MlTmConfig::new(0.4, profile) };
        let map = MlTm::try_from(ml_tm).unwrap().map(&log(&anchors, Some(table.clone())), &Unwatched).unwrap();
        let heard: Vec<HeardAnchor> = anchors.iter().map(|&(place, _, sector)| {
            let sector = table.iter().find(|other| Some(other.sector) == sector).unwrap();
            let sector = HeardSector { wedge: sector.wedge().unwrap(), azimuth_sigma_rad: 0.0 };
            HeardAnchor { sector: Some(sector), ..omni(place) }
        }).collect();
        let own = own(OwnPlaceConfig { estimate, tolerance, ..config(0.4) }).estimate(&heard, &[]).unwrap();
        let other = map.estimates[0].as_ref().unwrap();
        prop_assert_eq!(own.violations > 0, other.infeasible);
        if !other.infeasible {
            assert_same(&own, other);
        }
    }

    #[test]
    fn a_contradiction_breaks_the_fewest_conditions(
        places in prop::collection::vec((-9.0..9.0_f64, -9.0..9.0_f64), 2..7), middles in prop::collection::vec(-PI..PI, 7),
    ) {
        let width = TAU / 8.0;
        let heard: Vec<HeardAnchor> = places.iter().zip(&middles).map(|(&(x, y), &middle)| {
            let sector = HeardSector { wedge: wedge(middle, width), azimuth_sigma_rad: 0.0 };
            HeardAnchor { sector: Some(sector), ..omni(Position::new(x, y, 0.0)) }
        }).collect();
        let step_m = 0.5;
        let here = own(OwnPlaceConfig { tolerance: SectorTolerance::AngularLiteral, ..config(step_m) });
        let found = here.estimate(&heard, &[]).unwrap();
        // The literal count, on the same vertices: odd fractions of a step.
        let margin = libm::atan(step_m / RANGE_M);
        let mut best = (usize::MAX, f64::NEG_INFINITY);
        for i in -40..40 {
            for j in -40..40 {
                let place = Position::new(
                    (f64::from(i) + 0.381_966_011_250_105) * step_m,
                    (f64::from(j) + 0.236_067_977_499_79) * step_m,
                    0.0,
                );
                let (mut broken, mut rest, mut is_near) = (0, 0.0, false);
                for (anchor, middle) in heard.iter().zip(&middles) {
                    let distance_m = place.distance_m(anchor.place);
                    let s = if distance_m <= 2.0 { 0.95 } else { 0.95 * (RANGE_M - distance_m) / (RANGE_M - 2.0) };
                    if distance_m < RANGE_M { rest += libm::log(s); is_near = true } else { broken += 1 }
                    let off = wrapped(azimuth(anchor.place, place) - middle).abs();
                    broken += usize::from(off > 0.5 * width + margin);
                }
                if is_near && (broken < best.0 || (broken == best.0 && rest > best.1)) {
                    best = (broken, rest);
                }
            }
        }
        prop_assert_eq!(found.violations, best.0);
        prop_assert_eq!(found.estimate.infeasible, best.0 > 0);
        prop_assert!((found.estimate.log_likelihood.unwrap() - best.1).abs() < 1e-6, "{:?} {:?}", found, best);
    }

    #[test]
    fn the_soft_mean_is_that_of_the_literal_formula_on_a_fine_grid(
        (node, places) in scene(), sigma in 0.05..0.4_f64, spread_m in 0.1..0.8_f64,
    ) {
        let places: Vec<Position> = places.into_iter().map(|place| Position { z_m: 0.0, ..place }).collect();
        prop_assume!(places.len() > 1 && places.iter().all(|place| place.distance_m(node) > 1.0));
        let variance = spread_m * spread_m;
        let covariance = [[variance, 0.0, 0.0], [0.0, variance, 0.0], [0.0, 0.0, variance]];
        let width = TAU / 8.0;
        let middle = |place: Position| azimuth(place, node) + 0.3 * width;
        let heard: Vec<HeardAnchor> = places.iter().map(|&place| {
            let sector = HeardSector { wedge: wedge(middle(place), width), azimuth_sigma_rad: sigma };
            HeardAnchor { sector: Some(sector), covariance: Some(covariance), ..omni(place) }
        }).collect();
        let soft = OwnPlaceConfig { model: PlaceModel::Soft, estimate: EstimateKind::PosteriorMean, ..config(0.25) };
        let found = own(soft).estimate(&heard, &[]).unwrap().estimate;
        let s = |d: f64| if d <= 2.0 { 0.95 } else { (0.95 * (RANGE_M - d) / (RANGE_M - 2.0)).max(1e-6) };
        let phi = |x: f64| 0.5 * libm::erfc(-x / std::f64::consts::SQRT_2);
        let (mut total, mut sum, mut squares) = (0.0, [0.0; 2], [0.0; 2]);
        for i in -130..130 {
            for j in -130..130 {
                let place = Position::new((f64::from(i) + 0.37) * 0.1, (f64::from(j) + 0.61) * 0.1, 0.0);
                let weight: f64 = places.iter().map(|&anchor| {
                    let d = place.distance_m(anchor);
                    let apart = 3.0_f64.sqrt() * spread_m;
                    let heard = (s(d - apart) + 4.0 * s(d) + s(d + apart)) / 6.0;
                    let spread = ((variance + 0.25 * 0.25 / 12.0) / (d * d) + sigma * sigma).sqrt().min(TAU.sqrt());
                    let off = wrapped(azimuth(anchor, place) - middle(anchor));
                    heard * (0.02 + 0.98 * (phi((0.5 * width - off) / spread) - phi((-0.5 * width - off) / spread)))
                }).product();
                total += weight;
                for (axis, value) in [place.x_m, place.y_m].into_iter().enumerate() {
                    sum[axis] += weight * value;
                    squares[axis] += weight * value * value;
                }
            }
        }
        let mean = Position::new(sum[0] / total, sum[1] / total, 0.0);
        let spread = [0, 1].map(|axis| (squares[axis] / total - (sum[axis] / total).powi(2)).sqrt());
        let wide = spread[0].max(spread[1]);
        prop_assert!(found.position.distance_m(mean) < 0.25 * wide, "{:?} {mean:?} {spread:?}", found);
        let covariance = found.covariance.unwrap();
        for axis in 0..2 {
            let ratio = covariance[axis][axis].sqrt() / spread[axis];
            prop_assert!((0.7..1.2).contains(&ratio), "{ratio}: {covariance:?} {spread:?}");
        }
    }
}

/// Errors of nodes in a field of anchors whose orientations are off by a normal law: wedge argmax and soft mean (m), and
/// the share of soft estimates within the 95 % ellipse in the plane.
fn errors(sigma: f64, nodes: u64) -> ([f64; 2], f64) {
    const PURPOSE: Purpose = Purpose::new(20);
    let seed = Seed(11);
    let width = TAU / 8.0;
    let wedge_model = own(OwnPlaceConfig { tolerance: SectorTolerance::Angular, ..config(0.25) });
    let soft = OwnPlaceConfig { model: PlaceModel::Soft, estimate: EstimateKind::PosteriorMean, ..config(0.25) };
    let soft = own(soft);
    let (mut sums, mut inside) = ([0.0; 2], 0.0);
    for node in 0..nodes {
        let uniform = |k: u64| 2.0 * seed.uniform(PURPOSE, [node, k, 0]) - 1.0;
        let truth = Position::new(uniform(0), uniform(1), 0.0);
        let mut heard = Vec::new();
        for k in 0..12 {
            let place = Position::new(7.0 * uniform(10 + k), 7.0 * uniform(30 + k), 0.0);
            let d = place.distance_m(truth);
            let s = if d <= 2.0 { 0.95 } else { 0.95 * (RANGE_M - d) / (RANGE_M - 2.0) };
            if seed.uniform(PURPOSE, [node, k, 1]) >= s {
                continue;
            }
            let turn = PI * uniform(50 + k);
            let sector = f64::from(sector_towards(place, truth, 8, turn));
            let believed = turn + sigma * seed.normal(PURPOSE, [node, k, 2]);
            let wedge = wedge(believed + sector * width, width);
            let sector = HeardSector { wedge, azimuth_sigma_rad: sigma };
            heard.push(HeardAnchor { sector: Some(sector), ..omni(place) });
        }
        if heard.is_empty() {
            continue;
        }
        let estimates =
            [&wedge_model, &soft].map(|model| model.estimate(&heard, &[]).expect("anchors were heard").estimate);
        for (sum, estimate) in sums.iter_mut().zip(&estimates) {
            *sum += estimate.position.distance_m(truth);
        }
        let c = estimates[1].covariance.expect("a mean has one");
        let off = truth - estimates[1].position;
        let determinant = c[0][0] * c[1][1] - c[0][1] * c[1][0];
        let square = (c[1][1] * off.x_m * off.x_m - 2.0 * c[0][1] * off.x_m * off.y_m + c[0][0] * off.y_m * off.y_m)
            / determinant;
        inside += f64::from(u8::from(square < 5.991));
    }
    let nodes = nodes as f64;
    (sums.map(|sum| sum / nodes), inside / nodes)
}

#[test]
fn the_soft_mean_is_nearer_and_knows_how_near() {
    for sigma in [0.0, 0.1, 0.3] {
        let ([wedge_m, soft_m], inside) = errors(sigma, 300);
        eprintln!("sigma {sigma}: wedge {wedge_m:.3} m, soft {soft_m:.3} m, inside {inside:.3}");
        assert!(soft_m < wedge_m, "sigma {sigma}: wedge {wedge_m} m, soft {soft_m} m");
        // 95 % of 300 has a standard deviation of 1.3 %; four of them, and the law is not normal.
        assert!((0.88..=1.0).contains(&inside), "sigma {sigma}: {inside}");
    }
}

#[test]
fn without_uncertainty_the_soft_likelihood_has_the_peak_of_the_wedge() {
    let truth = Position::new(0.4, -0.3, 0.0);
    let places = [[4.0, 1.0], [-3.0, 2.5], [1.0, -4.5], [-2.0, -3.0]].map(|[x, y]| Position::new(x, y, 0.0));
    let heard = places.map(|place| {
        let sector = HeardSector { wedge: wedge(azimuth(place, truth), TAU / 8.0), azimuth_sigma_rad: 0.0 };
        HeardAnchor { sector: Some(sector), ..omni(place) }
    });
    let of = |model| own(OwnPlaceConfig { model, ..config(0.02) }).estimate(&heard, &[]).unwrap();
    let (hard, soft) = (of(PlaceModel::Wedge), of(PlaceModel::Soft));
    assert!(hard.estimate.position.distance_m(soft.estimate.position) < 0.04, "{hard:?} {soft:?}");
    let apart = hard.estimate.log_likelihood.unwrap() - soft.estimate.log_likelihood.unwrap();
    assert!(apart.abs() < 1e-3, "{hard:?} {soft:?}");
}

#[test]
fn a_wedge_bounds_the_elevation() {
    let anchor = Position::new(0.0, 0.0, 3.0);
    let down = Wedge { elevation_rad: [-1.0, -0.6], ..wedge(0.0, TAU / 8.0) };
    let sector = Some(HeardSector { wedge: down, azimuth_sigma_rad: 0.0 });
    for model in [PlaceModel::Wedge, PlaceModel::Soft] {
        let here = own(OwnPlaceConfig { model, z_range_m: Some([0.0, 3.0]), ..config(0.25) });
        let found = here.estimate(&[HeardAnchor { sector, ..omni(anchor) }], &[]).unwrap();
        let elevation = elevation(anchor, found.estimate.position);
        assert!((-1.15..-0.45).contains(&elevation), "{model:?}: {elevation}");
        assert_eq!(found.violations, 0);
    }
}

#[test]
fn silence_pushes_away_from_an_anchor_that_was_not_heard() {
    let (heard, near) = (omni(Position::new(0.0, 0.0, 0.0)), omni(Position::new(3.0, 0.0, 0.0)));
    let of = |silence, model| {
        let config = OwnPlaceConfig { silence, model, estimate: EstimateKind::PosteriorMean, ..config(0.25) };
        own(config).estimate(&[heard], &[near]).unwrap().estimate.position.x_m
    };
    for model in [PlaceModel::Wedge, PlaceModel::Soft] {
        assert!(of(AnchorSilence::Ignored, model).abs() < 0.1);
        assert!(of(AnchorSilence::Missed, model) < -0.5);
    }
    let none = own(OwnPlaceConfig { silence: AnchorSilence::Missed, ..config(0.25) });
    let unsent = HeardAnchor { packets: 0, ..near };
    assert_eq!(none.estimate(&[heard], &[unsent]), none.estimate(&[heard], &[]));
}

#[test]
fn bad_evidence_does_no_harm() {
    for model in [PlaceModel::Wedge, PlaceModel::Soft] {
        for estimate in [EstimateKind::Argmax, EstimateKind::PosteriorMean] {
            let here = own(OwnPlaceConfig { model, estimate, ..config(0.25) });
            assert_eq!(here.estimate(&[], &[]), None);
            let good = omni(Position::new(1.0, 2.0, 0.0));
            let lost = omni(Position::new(f64::NAN, 0.0, 0.0));
            assert_eq!(here.estimate(&[lost], &[]), None);
            assert_eq!(here.estimate(&[HeardAnchor { packets: 0, ..good }], &[]), None);
            // The same place twice, and places that are no numbers or on another continent.
            let far = omni(Position::new(8e8, 0.0, 0.0));
            let found = here.estimate(&[good, good, lost, far], &[lost]).unwrap();
            assert!(found.estimate.position.distance_m(good.place) < 2.5, "{found:?}");
            assert_eq!(found.violations, 1);
            let unknown = [[f64::NAN; 3]; 3];
            let sector = HeardSector { wedge: wedge(0.0, 1.0), azimuth_sigma_rad: f64::NAN };
            let odd = HeardAnchor { covariance: Some(unknown), sector: Some(sector), ..good };
            let found = here.estimate(&[odd], &[]).unwrap();
            assert!(found.estimate.position.is_finite() && found.estimate.position.distance_m(good.place) < RANGE_M);
        }
    }
}

#[test]
fn anchors_far_apart_do_not_make_the_search_long() {
    let heard: Vec<HeardAnchor> =
        (0..6).map(|i| omni(Position::new(100.0 * f64::from(i), 10.0 * f64::from(i % 2), 0.0))).collect();
    let found = own(config(0.25)).estimate(&heard, &[]).unwrap();
    assert_eq!(found.violations, 5);
    assert!(found.vertices < 40_000, "{}", found.vertices);
}

#[test]
fn settings_are_checked() {
    let key = |config: OwnPlaceConfig| OwnPlace::try_from(config).unwrap_err().key;
    for step_m in [0.0, f64::NAN, -1.0, 8.0, 1e-9] {
        assert_eq!(key(config(step_m)), "grid_step_m");
    }
    assert_eq!(key(OwnPlaceConfig { z_range_m: Some([2.0, 1.0]), ..config(0.25) }), "z_range_m");
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.0, 2.0, 7.0));
    assert_eq!(key(OwnPlaceConfig::new(0.25, profile)), "profile.trapezoid.p0");
}

#[test]
fn the_memory_is_that_of_evidence_and_result() {
    let anchor = omni(Position::new(1.0, 2.0, 0.0));
    let found = own(config(0.25)).estimate(&[anchor], &[]).unwrap();
    assert_eq!(found.peak_octets, 14 + 4 + 4 * found.estimate.ties as usize);
    let sector = Some(HeardSector { wedge: wedge(0.0, 1.0), azimuth_sigma_rad: 0.1 });
    let known = HeardAnchor { sector, covariance: Some([[0.0; 3]; 3]), ..anchor };
    let found = own(config(0.25)).estimate(&[known], &[]).unwrap();
    assert_eq!(found.peak_octets, 14 + 20 + 24 + 4 + 4 * found.estimate.ties as usize);
}
