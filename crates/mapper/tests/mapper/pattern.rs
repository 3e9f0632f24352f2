//! Maps by the gains of an antenna with many lobes.

use std::f64::consts::PI;
use std::sync::{Arc, LazyLock};

use sextant_channel::{
    Antenna, AntennaConfig, BoxConfig, CodeBookConfig, Obstacle, ObstacleConfig, ObstacleField, Orientation,
    Position, Reception, ReceptionLog, ReflectionsConfig, SectorGains, SectorGainsConfig, SectorReport, SectorTable,
    ShapeConfig, Stop,
};
use sextant_kernel::{NodeId, Purpose, RobotId, Seed, SimTime, Unwatched};
use sextant_mapper::{
    EstimateKind, Estimator, Finding, FittedConfig, Knowledge, KnowledgeKind, LogParts, Mapper, MlTmConfig, MmTm,
    ObstacleUse, PatternFit, ProfileConfig, Region, SectorModel, SectorsConfig, TopologyMap,
};

use crate::parts::Parts;

/// Sectors of the antenna.
const SECTORS: u8 = 24;
/// Length of a grid of nodes and stops (m).
const SIDE_M: f64 = 24.0;

fn draw(purpose: u64, numbers: [u64; 3]) -> f64 {
    Seed(11).normal(Purpose::new(purpose), numbers)
}

/// Gains of sectors that point in all directions, each with lobes of its own elsewhere and a weaker back: sums of waves
/// over the azimuth (dBi), in steps of 4 degrees.
fn gains() -> Vec<Vec<f64>> {
    let of_sector = |sector: u8| {
        let middle = 360.0 * f64::from(sector) / f64::from(SECTORS);
        (0..90).map(move |i| {
            let azimuth = 4.0 * f64::from(i) - 180.0;
            let off = (azimuth - middle + 540.0_f64).rem_euclid(360.0) - 180.0;
            let lobes: f64 = (2..7_u32)
                .map(|wave| {
                    let phase = draw(20, [sector.into(), wave.into(), 0]) * PI;
                    4.0 * (f64::from(wave) * azimuth.to_radians() + phase).cos()
                })
                .sum();
            let back = -4.0 * (1.0 - azimuth.to_radians().cos());
            8.0 - (off / 14.0).powi(2).min(6.0) + lobes + back
        })
    };
    (0..SECTORS).map(|sector| of_sector(sector).collect()).collect()
}

fn antenna(gains: &[Vec<f64>]) -> Antenna {
    let sectors = (0..).zip(gains).map(|(sector, row)| SectorGainsConfig { sector, gain_dbi: vec![row.clone()] });
    Antenna::try_from(AntennaConfig::CodeBook(CodeBookConfig {
        azimuths_deg: Some((0..90).map(|i| 4.0 * f64::from(i) - 180.0).collect()),
        elevations_deg: Some(vec![0.0]),
        sectors: Some(sectors.collect()),
        ..CodeBookConfig::default()
    }))
    .expect("a sound code book")
}

/// What the log and its antenna differ by.
#[derive(Clone, Copy, Default)]
struct Unknown {
    ripple_db: f64,
    yaw_deg: f64,
    /// Whether the antenna turns with the robot, which the log knows.
    turns: bool,
}

struct Survey {
    log: ReceptionLog,
    /// The SNRs of all sectors that nodes could decode.
    reports: Vec<SectorReport>,
    truth: Vec<Position>,
    ripple: Vec<f64>,
}

/// A survey of 90 nodes in a plane. Links lose 15 dB at 1 m and 22 dB more a decade, with a deviation of 3 dB; nine of ten
/// packets arrive; strengths have errors of 1 dB.
fn survey(unknown: Unknown) -> Survey {
    let gains = gains();
    let ripple: Vec<f64> = (0..SECTORS).map(|sector| unknown.ripple_db * draw(21, [sector.into(), 0, 0])).collect();
    let uniform = |of: u64, axis: u64| Seed(12).uniform(Purpose::new(22), [of, axis, 0]);
    let truth: Vec<Position> =
        (0..90).map(|node| Position::new(SIDE_M * uniform(node, 0), SIDE_M * uniform(node, 1), 0.0)).collect();
    let stops: Vec<Stop> = (0..49_u32)
        .map(|stop| {
            let at = |index: u32| 4.0 * f64::from(index) + 0.137;
            let position = Position::new(at(stop % 7), at(stop / 7), 0.0);
            Stop {
                robot: RobotId(0),
                time: SimTime::from_nanos(u64::from(stop) * 1_000_000_000),
                position,
                heading_rad: unknown.turns.then(|| 1.7 * f64::from(stop)),
            }
        })
        .collect();
    let (mut receptions, mut reports) = (Vec::new(), Vec::new());
    for (node, &place) in (0_u32..).zip(&truth) {
        for (stop, of_stop) in (0_u32..).zip(&stops) {
            let apart = place - of_stop.position;
            let turned_deg = unknown.yaw_deg + of_stop.heading_rad.unwrap_or(0.0).to_degrees();
            let azimuth = (apart.y_m.atan2(apart.x_m).to_degrees() - turned_deg + 180.0).rem_euclid(360.0);
            let strength = |sector: usize| {
                let steps = azimuth / 4.0;
                let (first, share) = (steps.floor(), steps.fract());
                let row = &gains[sector];
                let at = |step: f64| (0..90_u32).zip(row).find(|&(i, _)| f64::from(i) >= step.rem_euclid(90.0));
                let at = |step: f64| at(step).map_or(row[0], |(_, &gain)| gain);
                let gain = at(first) + share * (at(first + 1.0) - at(first)) + ripple[sector];
                gain + draw(23, [node.into(), stop.into(), sector as u64])
            };
            let best = (1..usize::from(SECTORS))
                .fold(0, |best, next| if strength(next) > strength(best) { next } else { best });
            let power = 15.0 + strength(best) - 22.0 * apart.dot(apart).sqrt().max(0.1).log10();
            let lost = Seed(13).uniform(Purpose::new(24), [node.into(), stop.into(), 0]) > 0.9;
            let power = power + 3.0 * draw(25, [node.into(), stop.into(), 0]);
            if power > 12.0 && !lost {
                let sector = u8::try_from(best).ok();
                let node = NodeId(node);
                let of_sector = |sector: u8| SectorReport {
                    node,
                    stop,
                    sector,
                    snr_db: (4.0 * (power - strength(best) + strength(sector.into()))).round() / 4.0,
                };
                reports.extend((0..SECTORS).map(of_sector).filter(|report| report.snr_db > 0.0));
                receptions.push(Reception { node, stop, received: 1, sent: 1, sector, rssi_dbm: None, snr_db: None });
            }
        }
    }
    let antenna = Arc::new(antenna(&gains));
    let table = SectorTable::from(SectorGains::new(antenna, Orientation::LEVEL));
    let names = (0..truth.len()).map(|node| format!("n{node}")).collect();
    let log = ReceptionLog::new(names, stops, receptions, Vec::new())
        .and_then(|log| log.with_sectors(table))
        .expect("a sound log");
    Survey { log, reports, truth, ripple }
}

/// The survey without anything unknown, and its map by gains.
static KNOWN: LazyLock<(Survey, TopologyMap, PatternFit)> = LazyLock::new(|| {
    let survey = survey(Unknown::default());
    let (map, fit) = map(&survey.log, SectorModel::Gains);
    (survey, map, fit.expect("a law"))
});

fn estimator(model: SectorModel) -> MmTm {
    let config = MlTmConfig {
        estimate: EstimateKind::PosteriorMean,
        sectors: Some(SectorsConfig { model: Some(model), ..SectorsConfig::default() }),
        ..MlTmConfig::new(0.2, ProfileConfig::Fitted(FittedConfig::default()))
    };
    MmTm::try_from(config).expect("sound settings")
}

fn map(log: &ReceptionLog, model: SectorModel) -> (TopologyMap, Option<PatternFit>) {
    let (map, learned) = estimator(model).estimate(&Knowledge::from(log), &Unwatched).expect("a map");
    (map, learned.and_then(|learned| learned.get::<PatternFit>().cloned()))
}

/// Median error (m): that of nodes which several stops heard.
fn median_m(map: &TopologyMap, truth: &[Position]) -> f64 {
    let placed = map.estimates.iter().zip(truth);
    let mut errors: Vec<f64> = placed.filter_map(|(e, t)| Some(e.as_ref()?.position.distance_m(*t))).collect();
    errors.sort_by(f64::total_cmp);
    errors[errors.len() / 2]
}

/// Mean error (m), and share of the nodes in their 95 % regions.
fn score(map: &TopologyMap, truth: &[Position]) -> (f64, f64) {
    let placed: Vec<_> = map.estimates.iter().zip(truth).filter_map(|(e, &t)| Some((e.as_ref()?, t))).collect();
    let count = placed.len() as f64;
    let error: f64 = placed.iter().map(|(estimate, truth)| estimate.position.distance_m(*truth)).sum();
    let held = placed.iter().filter(|(e, truth)| Region::of_95(e).is_some_and(|region| region.contains(*truth)));
    (error / count, held.count() as f64 / count)
}

#[test]
fn gains_place_nodes_far_better_than_wedges_of_the_same_sectors() {
    let (Survey { log, truth, .. }, by_gains, PatternFit { law, .. }) = &*KNOWN;
    let (by_wedges, none) = map(log, SectorModel::Wedge);
    assert!(none.is_none());
    let ((error_m, held), (of_wedges_m, _)) = (score(by_gains, truth), score(&by_wedges, truth));
    assert!(error_m < 0.55 * of_wedges_m, "{error_m} m, by wedges {of_wedges_m} m");
    assert!((0.9..=0.99).contains(&held), "{held} of the nodes in their regions");
    assert!((law.exponent - 2.2).abs() < 0.3 && (law.delivery - 0.9).abs() < 0.06, "{law:?}");
}

#[test]
fn a_map_by_gains_is_the_same_in_parts() {
    let (Survey { log, .. }, map, fit) = &*KNOWN;
    let mapper = Mapper::new(estimator(SectorModel::Gains));
    let parts = Parts::new(log, 3);
    let (of_parts, learned) = mapper.map_parts(&parts, Knowledge::from(parts.whole()), &Unwatched).unwrap();
    assert!(of_parts == *map && map.mapped() > 80, "{} mapped", map.mapped());
    assert!(learned.is_some_and(|learned| learned.get::<PatternFit>() == Some(fit)));
}

#[test]
fn ripple_that_nobody_measured_is_found_with_the_map() {
    let Survey { log, truth, ripple, .. } = survey(Unknown { ripple_db: 2.0, ..Unknown::default() });
    let (map, fit) = map(&log, SectorModel::Gains);
    let (error_m, held) = score(&map, &truth);
    let fit = fit.expect("a law");
    let pairs: Vec<_> = fit.law.ripple_db.iter().copied().zip(ripple).collect();
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / pairs.len() as f64;
    let (of_found, of_true) = (mean(&|p| p.0), mean(&|p| p.1));
    let product = mean(&|p| (p.0 - of_found) * (p.1 - of_true));
    let [found, truly] = [mean(&|p| (p.0 - of_found).powi(2)), mean(&|p| (p.1 - of_true).powi(2))];
    let correlation = product / (found * truly).sqrt();
    assert!(correlation > 0.8 && (fit.ripple_sigma_db - 2.0).abs() < 0.9, "{correlation}, {}", fit.ripple_sigma_db);
    assert!(error_m < 0.5 && held >= 0.85, "{error_m} m, {held} in their regions");
}

#[test]
fn an_antenna_that_is_turned_from_what_the_log_says_is_found() {
    for yaw_deg in [12.0, -130.0] {
        let Survey { log, truth, .. } = survey(Unknown { yaw_deg, ..Unknown::default() });
        let (map, fit) = map(&log, SectorModel::Gains);
        let (error_m, _) = score(&map, &truth);
        let found = fit.expect("a law").law.yaw_rad.to_degrees();
        let off = (found - yaw_deg + 540.0).rem_euclid(360.0) - 180.0;
        assert!(off.abs() < 1.5 && error_m < 0.5, "turned by {yaw_deg}, found {found}: {error_m} m");
    }
}

#[test]
fn an_antenna_that_turns_with_the_robot_is_mapped_by_its_headings() {
    let Survey { log, truth, .. } = survey(Unknown { yaw_deg: 12.0, turns: true, ..Unknown::default() });
    let (by_gains, fit) = map(&log, SectorModel::Gains);
    let (error_m, held) = score(&by_gains, &truth);
    let law = fit.expect("a law").law;
    assert!(error_m < 0.7 && held >= 0.88, "{error_m} m, {held} in their regions");
    assert!((law.yaw_rad.to_degrees() - 12.0).abs() < 1.5, "{law:?}");
    // A wedge has one direction at all stops.
    let of_wedges = estimator(SectorModel::Wedge).estimate(&Knowledge::from(&log), &Unwatched).unwrap_err();
    assert!(of_wedges.to_string().contains("gains of the sectors of an antenna that turns"), "{of_wedges}");
    // Without the headings the same log tells no directions.
    let still = log.stops().iter().map(|stop| Stop { heading_rad: None, ..*stop }).collect();
    let table = log.sectors().expect("it has sectors").clone();
    let still = ReceptionLog::new(log.names().to_vec(), still, log.receptions().iter().collect(), Vec::new())
        .and_then(|log| log.with_sectors(table))
        .unwrap();
    let (astray_m, _) = score(&map(&still, SectorModel::Gains).0, &truth);
    assert!(astray_m > 3.0 * error_m, "{astray_m} m, with headings {error_m} m");
}

#[test]
fn ratios_of_all_sectors_place_nodes_better_than_the_name_of_the_best() {
    let Survey { log, reports, truth, ripple } = survey(Unknown { ripple_db: 2.0, yaw_deg: 5.0, turns: false });
    let (by_names, _) = map(&log, SectorModel::Gains);
    let log = log.with_sector_snrs(reports).expect("sound reports");
    let (by_reports, fit) = map(&log, SectorModel::Gains);
    let (_, held) = score(&by_reports, &truth);
    let (error_m, of_names_m) = (median_m(&by_reports, &truth), median_m(&by_names, &truth));
    let law = fit.expect("a law").law;
    assert!(error_m < 0.6 * of_names_m, "{error_m} m, by names {of_names_m} m");
    assert!(held >= 0.88, "{held} in their regions");
    assert!((law.noise_db - 1.0).abs() < 0.25 && (law.yaw_rad.to_degrees() - 5.0).abs() < 1.0, "{law:?}");
    let level = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
    let (found, truly) = (level(&law.ripple_db), level(&ripple));
    let off = law.ripple_db.iter().zip(&ripple).map(|(a, b)| (a - found - b + truly).abs()).fold(0.0, f64::max);
    assert!(off < 1.0, "the ripple is off by {off} dB");
}

/// A room of 8 by 6 m whose walls reflect with a loss of 9 dB: six nodes, six stops, and reports of all sectors that are
/// stronger than 3.5 dB. Powers of the straight way and of the images of the node in the four walls are summed.
fn room_with_reports() -> Survey {
    const ROOM_M: [f64; 2] = [8.0, 6.0];
    let gains = gains();
    let places = [[1.2, 3.7], [2.6, 0.9], [4.4, 3.1], [5.1, 5.2], [6.7, 2.2], [7.3, 4.6]];
    let truth: Vec<Position> = places.iter().map(|&[x, y]| Position::new(x, y, 0.0)).collect();
    let stops: Vec<Stop> = (0_u32..)
        .zip([[1.5, 1.5], [4.0, 1.2], [6.5, 1.5], [6.5, 4.5], [4.0, 4.8], [1.5, 4.5]])
        .map(|(stop, [x, y])| Stop {
            robot: RobotId(0),
            time: SimTime::from_nanos(u64::from(stop) * 1_000_000_000),
            position: Position::new(x, y, 0.0),
            heading_rad: None,
        })
        .collect();
    let gain_db = |sector: u8, apart: Position| {
        let steps = (apart.y_m.atan2(apart.x_m).to_degrees() + 180.0) / 4.0;
        let row = &gains[usize::from(sector)];
        let at = |step: f64| (0..90_u32).zip(row).find(|&(i, _)| f64::from(i) >= step.rem_euclid(90.0));
        let at = |step: f64| at(step).map_or(row[0], |(_, &gain)| gain);
        at(steps.floor()) + steps.fract() * (at(steps.floor() + 1.0) - at(steps.floor()))
    };
    let (mut receptions, mut reports) = (Vec::new(), Vec::new());
    for (node, &place) in (0_u32..).zip(&truth) {
        let images = [
            (Position::new(-place.x_m, place.y_m, 0.0), 9.0),
            (Position::new(2.0 * ROOM_M[0] - place.x_m, place.y_m, 0.0), 9.0),
            (Position::new(place.x_m, -place.y_m, 0.0), 9.0),
            (Position::new(place.x_m, 2.0 * ROOM_M[1] - place.y_m, 0.0), 9.0),
        ];
        for (stop, of_stop) in (0_u32..).zip(&stops) {
            let shadow_db = 2.0 * draw(26, [node.into(), stop.into(), 0]);
            let snr_db = |sector: u8| {
                let ways = [(place, 0.0)].into_iter().chain(images);
                let power = ways.map(|(from, loss_db)| {
                    let apart = from - of_stop.position;
                    let level_db = 12.0 + shadow_db - 10.0 * apart.dot(apart).log10() - loss_db;
                    10.0_f64.powf(0.1 * (level_db + gain_db(sector, apart)))
                });
                (40.0 * power.sum::<f64>().log10()).round() / 4.0
            };
            let node = NodeId(node);
            let of_sector = |sector: u8| SectorReport { node, stop, sector, snr_db: snr_db(sector) };
            let heard: Vec<SectorReport> =
                (0..SECTORS).map(of_sector).filter(|report| report.snr_db >= 3.5).collect();
            let best = heard.iter().max_by(|a, b| a.snr_db.total_cmp(&b.snr_db));
            if let Some(&SectorReport { sector, snr_db, .. }) = best {
                let (sector, snr_db) = (Some(sector), Some(snr_db));
                receptions.push(Reception { node, stop, received: 1, sent: 1, sector, rssi_dbm: None, snr_db });
            }
            reports.extend(heard);
        }
    }
    let antenna = Arc::new(antenna(&gains));
    let table = SectorTable::from(SectorGains::new(antenna, Orientation::LEVEL));
    let names = (0..truth.len()).map(|node| format!("n{node}")).collect();
    let log = ReceptionLog::new(names, stops, receptions, Vec::new())
        .and_then(|log| log.with_sectors(table))
        .expect("a sound log");
    Survey { log, reports, truth, ripple: Vec::new() }
}

#[test]
fn walls_that_nobody_knows_neither_turn_the_antenna_nor_move_the_nodes() {
    let Survey { log, reports, truth, .. } = room_with_reports();
    let log = log.with_sector_snrs(reports).expect("sound reports");
    let (map, fit) = map(&log, SectorModel::Gains);
    let (error_m, held) = score(&map, &truth);
    let law = fit.expect("a law").law;
    assert!(error_m < 0.15, "{error_m} m: {law:?}");
    assert!(held >= 0.8, "{held} in their regions");
    assert!(law.yaw_rad.abs() < 1e-12, "turned by {} rad", law.yaw_rad);
    assert!(law.reports.added_share > 0.05 && law.reports.blocked_share < 0.2, "{:?}", law.reports);
}

/// The four walls of the room, moved by so much along x and against y (m). They reflect with a loss of 9 dB.
fn walls(moved_m: f64) -> ObstacleField {
    let wall = |[x, y]: [f64; 2], sides: [f64; 2]| {
        let shape = BoxConfig::new(Position::new(x + moved_m, y - moved_m, 0.0), [sides[0], sides[1], 3.0]);
        let config = ObstacleConfig::of(ShapeConfig::Box(shape), "concrete");
        Obstacle::try_from(config).expect("a sound wall")
    };
    ObstacleField::new(vec![
        wall([4.0, -0.1], [8.4, 0.2]),
        wall([4.0, 6.1], [8.4, 0.2]),
        wall([-0.1, 3.0], [0.2, 6.0]),
        wall([8.1, 3.0], [0.2, 6.0]),
    ])
}

/// The settings of a map by gains among known obstacles.
fn among_obstacles() -> MlTmConfig {
    let sectors = SectorsConfig {
        model: Some(SectorModel::Gains),
        obstacles: ObstacleUse::Known,
        reflections: Some(ReflectionsConfig { loss_db: Some(9.0), ..ReflectionsConfig::default() }),
        ..SectorsConfig::default()
    };
    MlTmConfig {
        estimate: EstimateKind::PosteriorMean,
        sectors: Some(sectors),
        ..MlTmConfig::new(0.2, ProfileConfig::Fitted(FittedConfig::default()))
    }
}

#[test]
fn walls_that_are_known_place_nodes_better_and_wrong_ones_do_no_harm() {
    let Survey { log, reports, truth, .. } = room_with_reports();
    let log = log.with_sector_snrs(reports).expect("sound reports");
    let (unknown_m, _) = score(&map(&log, SectorModel::Gains).0, &truth);
    let among = |field: &ObstacleField| {
        let estimator = MmTm::try_from(among_obstacles()).expect("sound settings");
        let knowledge = Knowledge { obstacles: Some(field), ..Knowledge::from(&log) };
        let (map, learned) = estimator.estimate(&knowledge, &Unwatched).expect("a map");
        let law = learned.and_then(|learned| learned.get::<PatternFit>().map(|fit| fit.law.clone())).expect("a law");
        let (error_m, held) = score(&map, &truth);
        (error_m, held, law.reports.known_sigma_db, law.reports.added_share)
    };
    let (right_m, held, right_db, added) = among(&walls(0.0));
    assert!(right_m < 0.6 * unknown_m && held >= 0.8, "{right_m} m, unknown {unknown_m} m, {held} in their regions");
    assert!(right_db < 1.0 && added < 0.1, "{right_db} dB, {added}");
    let (wrong_m, _, wrong_db, _) = among(&walls(0.2));
    assert!(wrong_m < 1.5 * unknown_m + 0.01, "{wrong_m} m, unknown {unknown_m} m");
    assert!(wrong_db > 2.0 * right_db, "wrong {wrong_db} dB, right {right_db} dB");
}

#[test]
fn obstacles_are_known_to_maps_by_gains_alone_and_must_be_given() {
    let key = |change: &dyn Fn(&mut SectorsConfig)| {
        let mut config = among_obstacles();
        config.sectors.as_mut().into_iter().for_each(change);
        MmTm::try_from(config).unwrap_err().key
    };
    assert_eq!(key(&|sectors| sectors.model = None), "sectors.obstacles");
    assert_eq!(key(&|sectors| sectors.carrier_ghz = Some(0.0)), "sectors.carrier_ghz");
    assert_eq!(key(&|sectors| sectors.obstacles = ObstacleUse::Unknown), "sectors.reflections");
    let estimator = MmTm::try_from(among_obstacles()).expect("sound settings");
    assert!(estimator.uses().contains(&KnowledgeKind::Obstacles));
    let nothing = estimator.estimate(&Knowledge::from(&KNOWN.0.log), &Unwatched).unwrap_err();
    assert!(nothing.to_string().contains("obstacles"), "{nothing}");
}

#[test]
fn gains_of_other_identities_are_told_as_a_contradiction() {
    let (Survey { log, .. }, right, fit) = &*KNOWN;
    let mixed = log.receptions().iter().map(|heard| {
        let sector = heard.sector.map(|sector| sector * 7 % SECTORS);
        Reception { sector, ..heard }
    });
    let table = log.sectors().expect("it has sectors").clone();
    let mixed = ReceptionLog::new(log.names().to_vec(), log.stops().to_vec(), mixed.collect(), Vec::new())
        .and_then(|log| log.with_sectors(table))
        .unwrap();
    let warned = |map: &TopologyMap, fit: &PatternFit| {
        fit.lines("a", map).iter().any(|line| line.text.contains("contradicts the pattern"))
    };
    let (of_mixed, fit_of_mixed) = map(&mixed, SectorModel::Gains);
    assert!(warned(&of_mixed, &fit_of_mixed.expect("a law")) && !warned(right, fit));
}
