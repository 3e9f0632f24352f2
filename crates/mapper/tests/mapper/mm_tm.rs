//! MmTM: what it demands of a log, and how a sector is compared with a direction.

use sextant_channel::{EvenSectorsConfig, Position, Reception, ReceptionLog, SectorConfig, SectorTable, Stop};
use sextant_kernel::{NodeId, Unwatched};
use sextant_mapper::{
    AlgorithmConfig, ChannelProfileConfig, MapError, Mapper, MlTm, MlTmConfig, MmTm, ObstacleUse, ProfileConfig,
    SectorModel, SectorTolerance, SectorsConfig, SilenceRule, SoftSectorsConfig, TopologyMap, TrapezoidConfig,
};

/// A log of one node, heard at the stops with a sector.
fn log(stops: &[Position], heard: &[(u32, u8)], table: Option<SectorTable>) -> ReceptionLog {
    let stops = stops.iter().map(|&position| Stop::at(position)).collect();
    let heard = heard
        .iter()
        .map(|&(stop, sector)| Reception { sector: Some(sector), ..Reception::heard(NodeId(0), stop, 1, 1) });
    let log = ReceptionLog::new(vec!["n".into()], stops, heard.collect(), Vec::new()).expect("a log");
    match table {
        Some(table) => log.with_sectors(table).expect("sectors of the table"),
        None => log,
    }
}

fn even(azimuth_sectors: u8, elevations_deg: Vec<[f64; 2]>) -> SectorTable {
    let config = EvenSectorsConfig { azimuth_sectors, first_azimuth_deg: 0.0, elevations_deg };
    SectorTable::try_from(config).expect("sound sectors")
}

fn config(grid_step_m: f64) -> MlTmConfig {
    MlTmConfig::new(grid_step_m, ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 7.0)))
}

fn map(config: MlTmConfig, log: &ReceptionLog) -> Result<TopologyMap, MapError> {
    MmTm::try_from(config).expect("good settings").map(log, &Unwatched).map(|(map, _)| map)
}

fn place(map: &TopologyMap) -> Position {
    map.estimates[0].as_ref().expect("the node was heard").position
}

const WHOLE: [f64; 2] = [-90.0, 90.0];

#[test]
fn it_is_ml_tm_with_sectors_under_its_own_name() {
    let stops: Vec<Position> = (0..9).map(|i| Position::new(f64::from(i), 0.0, 0.0)).collect();
    // To the left of a lane along x: sectors 1, 2 and 3 of 8 point ahead, aside and back.
    let log = log(&stops, &[(2, 1), (3, 2), (4, 2), (5, 3)], Some(even(8, vec![WHOLE])));
    let found = map(config(0.25), &log).unwrap();
    assert_eq!(found.algorithm, "mmtm");
    assert!(place(&found).y_m > 0.5);
    let ml_tm = MlTm::try_from(config(0.25)).unwrap().map(&log, &Unwatched).unwrap();
    assert_eq!(found.estimates, ml_tm.estimates);
    let mapper = Mapper::try_from(AlgorithmConfig::Mmtm(config(0.25))).unwrap();
    assert_eq!((mapper.name(), mapper.map(&log).unwrap()), ("mmtm", found));
}

#[test]
fn a_log_without_sectors_or_without_their_directions_is_an_error_that_says_so() {
    let stops = [Position::ORIGIN, Position::new(1.0, 0.0, 0.0)];
    let error = map(config(0.25), &log(&stops, &[(0, 3)], None)).unwrap_err();
    assert!(matches!(error, MapError::Missing { algorithm: "mmtm", .. }));
    assert!(error.to_string().contains("directions") && error.to_string().contains("`sectors.csv`"), "{error}");
    let plain = Reception::heard(NodeId(0), 0, 1, 1);
    let at = |position| Stop::at(position);
    let plain = ReceptionLog::new(vec!["n".into()], stops.map(at).to_vec(), vec![plain], Vec::new()).unwrap();
    let plain = plain.with_sectors(even(8, vec![WHOLE])).unwrap();
    let error = map(config(0.25), &plain).unwrap_err();
    assert!(error.to_string().contains("the antenna sector of each reception"), "{error}");
    assert!(map(config(0.25), &log(&stops, &[], None)).is_ok(), "a log in which nothing was heard");
    let fitted = MlTmConfig { profile: ProfileConfig::Fitted(Default::default()), ..config(0.25) };
    assert!(matches!(map(fitted, &plain).unwrap_err(), MapError::Missing { .. }));
}

#[test]
fn a_sector_narrower_than_a_grid_step_still_places_nodes() {
    // Of 64 sectors each is 5.625 degrees wide: 0.69 m over 7 m. Grids are finer and much coarser than that.
    let stops = [Position::ORIGIN, Position::new(1.0, 0.0, 0.0), Position::new(0.0, 3.0, 0.0)];
    let node = Position::new(4.0, 2.0, 0.0);
    let sector = |stop: &Position| {
        let apart = node - *stop;
        let along = (apart.y_m.atan2(apart.x_m).to_degrees() / 5.625 + 0.5).rem_euclid(64.0);
        (0..64_u8).find(|&sector| along < f64::from(sector) + 1.0).unwrap()
    };
    let heard: Vec<(u32, u8)> = (0..).zip(stops.iter().map(sector)).collect();
    let log = log(&stops, &heard, Some(even(64, vec![WHOLE])));
    for step_m in [0.1, 0.4, 0.7, 1.2] {
        let map = map(config(step_m), &log).unwrap();
        let estimate = map.estimates[0].as_ref().unwrap();
        let error_m = estimate.position.distance_m(node);
        assert!(error_m < 1.2 * step_m.max(0.5), "step {step_m}: {error_m}");
    }
}

#[test]
fn settings_that_leave_sectors_out_are_rejected() {
    let sectors = SectorsConfig { tolerance: SectorTolerance::Unlimited, ..SectorsConfig::default() };
    let unlimited = MlTmConfig { sectors: Some(sectors), ..config(0.25) };
    let key = |config| Mapper::try_from(AlgorithmConfig::Mmtm(config)).unwrap_err().key;
    assert_eq!(key(unlimited), "mmtm.sectors.tolerance");
    let channel = ChannelProfileConfig { obstacles: ObstacleUse::Known, ..ChannelProfileConfig::default() };
    let known = MlTmConfig { profile: ProfileConfig::Channel(channel), ..config(0.25) };
    assert_eq!(key(known), "mmtm.profile.channel.obstacles");
    assert_eq!(key(config(-1.0)), "mmtm.grid_step_m");
}

#[test]
fn azimuths_are_compared_across_half_a_turn_and_from_the_robot_to_the_vertex() {
    // One stop; sector 4 of 8 points to −x, across the azimuth at which angles jump from 180 to −180 degrees.
    for tolerance in [SectorTolerance::Positional, SectorTolerance::Angular, SectorTolerance::AngularLiteral] {
        for (sector, ahead) in [(4, [-1.0, 0.0]), (0, [1.0, 0.0]), (2, [0.0, 1.0]), (6, [0.0, -1.0])] {
            let sectors = Some(SectorsConfig { tolerance, ..SectorsConfig::default() });
            let ml_tm = MlTm::try_from(MlTmConfig { sectors, ..config(0.25) }).unwrap();
            let log = log(&[Position::ORIGIN], &[(0, sector)], Some(even(8, vec![WHOLE])));
            let surface = ml_tm.surface(&log, NodeId(0), &Unwatched).unwrap();
            let (mut inside, mut outside) = (0, 0);
            for (index, value) in (0..).zip(&surface.log_likelihood) {
                let vertex = surface.lattice.position(surface.lattice.vertex(index));
                let along = vertex.x_m * ahead[0] + vertex.y_m * ahead[1];
                let aside = (vertex.y_m * ahead[0] - vertex.x_m * ahead[1]).abs();
                let off_axis_deg = aside.atan2(along).to_degrees();
                if vertex.length_m() > 1.0 && vertex.length_m() < 6.9 {
                    inside += u32::from(off_axis_deg < 22.0 && value.is_finite());
                    assert!(value.is_finite() || off_axis_deg > 22.0, "{tolerance:?} {sector}: {vertex}");
                    // Half a cell's diagonal one metre away is 10.2 degrees; a step of 0.25 m over 7 m is 2 degrees.
                    outside += u32::from(off_axis_deg > 33.0 && value.is_finite());
                }
            }
            assert!(inside > 250 && outside == 0, "{tolerance:?} {sector}: {inside}, {outside}");
        }
    }
}

#[test]
fn a_vertex_at_the_robot_is_in_every_sector() {
    let shift = [0.381_966_011_250_105, 0.236_067_977_499_79].map(|phase| 0.25 * phase);
    let stop = Position::new(shift[0], shift[1], 0.0);
    for tolerance in [SectorTolerance::Positional, SectorTolerance::Angular, SectorTolerance::AngularLiteral] {
        for sector in 0..64 {
            let sectors = Some(SectorsConfig { tolerance, ..SectorsConfig::default() });
            let ml_tm = MlTm::try_from(MlTmConfig { sectors, ..config(0.25) }).unwrap();
            let log = log(&[stop], &[(0, sector)], Some(even(64, vec![WHOLE])));
            let surface = ml_tm.surface(&log, NodeId(0), &Unwatched).unwrap();
            let lattice = &surface.lattice;
            let at_stop = (0..)
                .zip(&surface.log_likelihood)
                .find(|&(index, _)| lattice.position(lattice.vertex(index)).distance_m(stop) < 1e-9);
            assert!(at_stop.expect("a vertex at the stop").1.is_finite(), "{tolerance:?} {sector}");
        }
    }
}

#[test]
fn one_sector_all_round_is_no_test_of_azimuth() {
    let stops = [-2.0, 0.0, 1.5].map(|x| Position::new(x, 0.0, 0.0));
    let log = log(&stops, &[(0, 0), (2, 0)], Some(even(1, vec![WHOLE])));
    let without = SectorsConfig { tolerance: SectorTolerance::Unlimited, ..SectorsConfig::default() };
    let without = MlTm::try_from(MlTmConfig { sectors: Some(without), ..config(0.25) }).unwrap();
    assert_eq!(map(config(0.25), &log).unwrap().estimates, without.map(&log, &Unwatched).unwrap().estimates);
}

#[test]
fn near_the_robot_the_margin_is_that_of_half_a_step_over_the_distance() {
    // A sector of 10 degrees along x; the vertex is 0.5 m away at 25 degrees: 20 degrees beyond the edge.
    // Half a step of 0.4 m over 0.5 m is 21.8 degrees, and a step over the range of 7 m is 3.3 degrees.
    let azimuth = 25.0_f64.to_radians();
    let vertex = Position::new(0.4 * 0.381_966_011_250_105, 0.4 * 0.236_067_977_499_79, 0.0);
    let sector = SectorConfig {
        sector: 9,
        azimuth_from_deg: -5.0,
        azimuth_to_deg: 5.0,
        elevation_from_deg: -90.0,
        elevation_to_deg: 90.0,
    };
    let admits = |tolerance, distance_m: f64| {
        let stop = vertex - Position::new(azimuth.cos(), azimuth.sin(), 0.0) * distance_m;
        let log = log(&[stop], &[(0, 9)], Some(SectorTable::new([sector.clone()]).unwrap()));
        let sectors = Some(SectorsConfig { tolerance, ..SectorsConfig::default() });
        let ml_tm = MlTm::try_from(MlTmConfig { sectors, ..config(0.4) }).unwrap();
        let surface = ml_tm.surface(&log, NodeId(0), &Unwatched).unwrap();
        let lattice = &surface.lattice;
        let mut found = (0..).zip(&surface.log_likelihood).filter(|(_, value)| value.is_finite());
        found.any(|(index, _)| lattice.position(lattice.vertex(index)).distance_m(vertex) < 1e-9)
    };
    assert!(admits(SectorTolerance::Angular, 0.5) && !admits(SectorTolerance::Angular, 0.6));
    assert!(!admits(SectorTolerance::AngularLiteral, 0.5));
}

#[test]
fn a_stop_that_heard_nothing_rules_out_only_places_that_its_sectors_cover() {
    // Two stops on the floor under a node, and one that no sector of its antenna (up to 50 degrees) points from: the node
    // is right above it.
    let stops = [Position::new(-2.0, 0.0, 0.0), Position::new(0.0, 0.0, 0.0), Position::new(2.0, 0.0, 0.0)];
    let table = even(8, vec![[0.0, 50.0]]);
    // Elevation 45 degrees from both ends: the node is at (0, 0, 2).
    let log = log(&stops, &[(0, 0), (2, 4)], Some(table));
    let with = |silence| {
        let sectors =
            Some(SectorsConfig { silence, tolerance: SectorTolerance::AngularLiteral, ..SectorsConfig::default() });
        let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.95, 3.5, 7.0));
        let config = MlTmConfig { sectors, z_range_m: Some([0.0, 3.0]), profile, ..config(0.2) };
        let ml_tm = MlTm::try_from(config.clone()).unwrap();
        let surface = ml_tm.surface(&log, NodeId(0), &Unwatched).unwrap();
        let lattice = &surface.lattice;
        let near = |place: Position| {
            let distances = (0..lattice.len()).map(|i| lattice.position(lattice.vertex(i)).distance_m(place));
            (0..)
                .zip(distances)
                .min_by(|a: &(usize, f64), b| a.1.total_cmp(&b.1))
                .map(|(i, _)| surface.log_likelihood[i])
        };
        (near(Position::new(0.0, 0.0, 2.0)).unwrap(), near(Position::new(0.0, 0.0, 0.5)).unwrap())
    };
    let (above, _) = with(SilenceRule::Covered);
    let (above_everywhere, _) = with(SilenceRule::Everywhere);
    // Both stops heard it with 0.95 each; the one below says nothing, or has missed a packet with 0.95.
    assert!((above - 2.0 * 0.95_f64.ln()).abs() < 1e-5, "{above}");
    assert!((above_everywhere - (2.0 * 0.95_f64.ln() + 0.05_f64.ln())).abs() < 1e-5, "{above_everywhere}");
}

#[test]
fn a_soft_sector_adds_the_logarithm_of_its_probability() {
    // One stop, eight sectors of 45 degrees. With normal errors of 2 dB, the probability is near exp(G/β)/Σ exp(G/β).
    let log = log(&[Position::ORIGIN], &[(0, 1)], Some(even(8, vec![WHOLE])));
    let soft = SoftSectorsConfig { sigma_db: Some(2.0), ..SoftSectorsConfig::default() };
    let with = |model| {
        let sectors = Some(SectorsConfig {
            model: Some(model),
            tolerance: SectorTolerance::Positional,
            ..SectorsConfig::default()
        });
        let ml_tm = MlTm::try_from(MlTmConfig { sectors, ..config(0.1) }).unwrap();
        ml_tm.surface(&log, NodeId(0), &Unwatched).unwrap()
    };
    let surface = with(SectorModel::Soft(soft));
    let beta_db = 2.0 * 2.0_f64.sqrt() / 1.702;
    let ln_probability = |azimuth_deg: f64| {
        let weight = |sector: f64| {
            let off = (azimuth_deg - 45.0 * sector + 180.0).rem_euclid(360.0) - 180.0;
            (-(12.0 * (off / 45.0).powi(2)).min(30.0) / beta_db).exp()
        };
        (weight(1.0) / (0..8).map(|sector| weight(f64::from(sector))).sum::<f64>()).ln()
    };
    let mut compared = 0;
    for (index, &value) in (0..).zip(&surface.log_likelihood) {
        let vertex = surface.lattice.position(surface.lattice.vertex(index));
        let expected = ln_probability(vertex.y_m.atan2(vertex.x_m).to_degrees());
        if (4.0..6.8).contains(&vertex.length_m()) && expected > -7.0 {
            compared += 1;
            let reception = (0.9 * (7.0 - vertex.length_m()) / 6.0).ln();
            assert!((value - reception - expected).abs() < 0.12, "{vertex}: {value}, {reception} and {expected}");
        }
    }
    assert!(compared > 1000, "{compared}");
    // What the edges admit is a part of it.
    let finite = |surface: &sextant_mapper::Surface| surface.log_likelihood.iter().filter(|v| v.is_finite()).count();
    assert!(finite(&surface) > finite(&with(SectorModel::Wedge)));
    for (soft, key) in [
        (SoftSectorsConfig { sigma_db: Some(0.0), ..soft }, "sectors.model.soft.sigma_db"),
        (SoftSectorsConfig { side_lobe_db: -1.0, ..soft }, "sectors.model.soft.side_lobe_db"),
    ] {
        let sectors = Some(SectorsConfig { model: Some(SectorModel::Soft(soft)), ..SectorsConfig::default() });
        assert_eq!(MlTm::try_from(MlTmConfig { sectors, ..config(0.25) }).unwrap_err().key, key);
    }
}
