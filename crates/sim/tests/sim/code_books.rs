//! Sweeps of antennas with measured sectors: their identities on air and in the log, their powers, and their answers.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::StationId;
use sextant_mac::dmg::{AbftConfig, ContentionConfig, SweepBody, SweepFrame, TxSector};
use sextant_sim::{FrameOutcome, Simulation, Survey};

use crate::network;
use crate::sweeps::{OnAir, Scene, receptions};

/// A code book with a sector of 9 dBi every 40 degrees, from azimuth 0 on, and -11 dBi at other places of the grid.
fn book(identities: &[u8], rest: &str) -> String {
    let sectors = identities.iter().enumerate().map(|(number, identity)| {
        let gains = (0..9).map(|step| if step == number { "9" } else { "-11" });
        format!("{{ sector = {identity}, gain_dbi = [[{}]] }}", gains.collect::<Vec<_>>().join(", "))
    });
    let azimuths = "[0, 40, 80, 120, 160, 200, 240, 280, 320]";
    let sectors = sectors.collect::<Vec<_>>().join(", ");
    format!("{{ azimuths_deg = {azimuths}, elevations_deg = [0], sectors = [{sectors}]{rest} }}")
}

fn run(scene: &Scene, antennas: &str, on_air: &mut OnAir) -> Survey {
    let mut setup = scene.setup();
    setup.networks[0].technology = scene.technology(&toml::from_str(antennas).expect("antennas"));
    Simulation::new(setup).expect("a good setup").run(on_air)
}

#[test]
fn sectors_go_on_air_and_into_the_log_by_the_identities_of_the_code_book() {
    // Azimuth 120 from the robot, and 300 from the node, whose nearest sector points at 280.
    let place = Position::new(-2.0, 2.0 * 3.0_f64.sqrt(), 0.0);
    let (of_robot, of_node) = ([0, 7, 30, 59, 63], [2, 3, 5, 8, 13, 21, 34, 55, 61]);
    let antennas = format!(
        "robots.code_book = {}\nnodes.code_book = {}\nnode_headings = 'aligned'",
        book(&of_robot, ""),
        book(&of_node, "")
    );
    let mut on_air = OnAir::default();
    let survey = run(&Scene::of(vec![place]), &antennas, &mut on_air);
    let (mut swept, mut answered, mut outcomes) = (Vec::new(), Vec::new(), Vec::new());
    for &(_, _, _, SweepFrame { body, .. }, outcome) in &on_air.0 {
        match body {
            SweepBody::Iss { sector, total_sectors, cdown, .. } => {
                assert_eq!((total_sectors, usize::from(cdown)), (5, 4 - swept.len()));
                swept.push(sector);
            }
            SweepBody::Rss { sector, feedback, .. } => {
                assert_eq!(feedback.select, TxSector::first_antenna(59), "the sector that points at the node");
                answered.push(sector);
                outcomes.push(outcome);
            }
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(swept, of_robot.map(TxSector::first_antenna));
    assert_eq!(answered, of_node.map(TxSector::first_antenna));
    assert_eq!(outcomes[7], FrameOutcome::Received, "sector 55 points back");
    assert_eq!(receptions(&survey, 0).iter().map(|found| found.sector).collect::<Vec<_>>(), [Some(59)]);
    let sectors = survey.log().sectors().expect("sectors");
    assert_eq!(sectors.identities(), "0, 7, 30, 59, 63");
    // The log has the gains of the antenna, by the same identities.
    let gains = sectors.gains().expect("gains");
    assert_eq!(gains.identities(), of_robot);
    let mut towards_node = Vec::new();
    gains.all_dbi(place * (1.0 / place.length_m()), &mut towards_node);
    assert!(towards_node.iter().zip([-11.0, -11.0, -11.0, 9.0, -11.0]).all(|(gain, of)| (gain - of).abs() < 1e-9));
}

#[test]
fn answers_too_weak_for_the_robot_are_lost_to_a_weak_signal() {
    // The robot reaches the node, whose sectors are weak: some answers are below the sensitivity, others far below.
    for node_dbi in [-20.0, -60.0, -100.0] {
        let antennas = format!(
            "robots.code_book = {}\nnodes.sectors = {{ azimuth_sectors = 8, boresight_gain_dbi = {node_dbi} }}",
            book(&[1, 2], ", boresight_gain_dbi = 5.0")
        );
        let scene = Scene { sweeps: 3, ..Scene::of(vec![Position::new(6.0, 0.0, 0.0)]) };
        let mut on_air = OnAir::default();
        let survey = run(&scene, &antennas, &mut on_air);
        let of_node = on_air.0.iter().filter(|sent| sent.2 == StationId(0));
        assert!(
            of_node.clone().count() == 24 && of_node.clone().all(|sent| sent.4 == FrameOutcome::Weak),
            "{node_dbi}"
        );
        let packets = survey.networks[0].packets[0];
        assert_eq!((packets.offered, packets.lost_signal, packets.not_listened), (3, 3, 0), "{node_dbi}");
        assert_eq!(receptions(&survey, 0).first().map_or(0, |found| found.received), 0);
    }
}

#[test]
fn a_node_with_more_sectors_than_a_slot_has_frames_answers_in_several_slots() {
    let abft = AbftConfig { slots: 8, frames_per_slot: 16, feedback: true };
    let scene = Scene {
        node_sectors: 36,
        sweeps: 12,
        contention: ContentionConfig::Abft(abft),
        ..Scene::of(vec![Position::new(3.0, 1.0, 0.0)])
    };
    let mut on_air = OnAir::default();
    let survey = Simulation::new(scene.setup()).expect("a good setup").run(&mut on_air);
    let sectors: Vec<u8> = on_air
        .0
        .iter()
        .filter_map(|sent| match sent.3.body {
            SweepBody::Rss { sector, .. } => Some(sector.sector),
            _ => None,
        })
        .collect();
    // Each sweep goes through all sectors, in one A-BFT or on to the next one.
    assert!(
        sectors.len() > 300 && sectors.chunks(36).all(|sweep| sweep.iter().copied().eq((0..36).take(sweep.len())))
    );
    let [reception] = receptions(&survey, 0)[..] else { panic!("one stop") };
    assert!(reception.received >= 8 && reception.sent == 12, "{reception:?}");
}

#[test]
fn a_robot_listens_with_the_gain_that_was_measured_in_the_direction_of_the_node() {
    let folder = std::env::temp_dir().join(format!("sextant-quasi-omni-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for files");
    let file = folder.join("book.csv");
    let rows = (0..36).flat_map(|step| {
        let azimuth = 10 * step;
        let heard = if azimuth == 90 { "-7.5" } else { "2.5" };
        [format!("0,{azimuth},0,{}\n", 3 - step % 5), format!("quasi_omni,{azimuth},0,{heard}\n")]
    });
    let text = format!("sector,azimuth_deg,elevation_deg,gain_dbi\n{}", rows.collect::<String>());
    std::fs::write(&file, text).expect("a file");
    let antennas = format!(
        "robots.code_book.file = {:?}\nnodes.sectors = {{ azimuth_sectors = 1, boresight_gain_dbi = 0 }}\n\
         node_headings = 'aligned'",
        file.display().to_string()
    );
    let rssi_dbm = |place: Position| {
        let survey = run(&Scene::of(vec![place]), &antennas, &mut OnAir::default());
        receptions(&survey, 0)[0].rssi_dbm.expect("a power")
    };
    // The node's one sector points along x: at the same angle to it on both sides, so only the robot's gain differs.
    let (north, south) = (rssi_dbm(Position::new(0.0, 2.0, 0.0)), rssi_dbm(Position::new(0.0, -2.0, 0.0)));
    assert!((north - south + 10.0).abs() < 1e-9, "{north} and {south} dBm");
    std::fs::remove_dir_all(&folder).expect("the folder goes");
}

#[test]
fn an_antenna_that_its_robot_holds_turns_with_it() {
    // East, north, back to the south-west.
    let stops = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0)].map(|(x_m, y_m)| Position::new(x_m, y_m, 0.0));
    let places: Vec<Position> = (0..12)
        .map(|node| 3.0 + 30.0 * f64::from(node))
        .map(|deg| Position::new(3.0 * deg.to_radians().cos(), 3.0 * deg.to_radians().sin(), 0.0))
        .collect();
    let identities: Vec<u8> = (0..9).collect();
    let antennas = format!(
        "robots.code_book = {}\nrobot_headings = 'body'\nrobot_mount.yaw_deg = 25\nnodes.sectors.azimuth_sectors = 8",
        book(&identities, "")
    );
    let scene = Scene { sweeps: 8, ..Scene::of(places.clone()) };
    let mut setup = scene.setup();
    setup.networks[0].technology = scene.technology(&toml::from_str(&antennas).expect("antennas"));
    setup.robots[0] = network::tour(stops.to_vec(), 0.1, Duration::from_millis(100));
    setup.robots[0].body.sweeps_per_stop = scene.sweeps;
    let survey = Simulation::new(setup).expect("a good setup").run(&mut OnAir::default());
    let log = survey.log();
    let headings_deg: Vec<f64> =
        log.stops().iter().map(|stop| stop.heading_rad.expect("it turns").to_degrees().round()).collect();
    assert_eq!(headings_deg, [0.0, 0.0, 90.0, -135.0]);
    let mut heard = 0;
    for reception in log.receptions().iter() {
        let stop = log.stops()[reception.stop as usize];
        let apart = places[reception.node.index()] - stop.position;
        let sector_deg = 40.0 * f64::from(reception.sector.expect("a sector")) + 25.0;
        let points_deg = sector_deg + stop.heading_rad.expect("it turns").to_degrees();
        let off_deg = (apart.y_m.atan2(apart.x_m).to_degrees() - points_deg + 540.0).rem_euclid(360.0) - 180.0;
        assert!(off_deg.abs() <= 20.0 + 1e-6, "{reception:?}: {off_deg} degrees off");
        heard += 1;
    }
    assert!(heard >= 36, "{heard} receptions of 48");
}
