//! Reports of all sectors that a node heard: what they say, when they are on air, what they cost, and what is lost.

use sextant_channel::{Position, SectorReport};
use sextant_kernel::{NodeId, Seed, StationId};
use sextant_mac::dmg::{ContentionConfig, CsmaFeedbackConfig, SweepBody};
use sextant_sim::{
    DeathsConfig, FaultsConfig, FrameOutcome, Observer, Packets, Setup, Simulation, Survey, Unobserved,
};

use crate::sweeps::{OnAir, Scene, Sent};

/// The noise of the radios over their sensitivity of -60 dBm, with which 0 dBi reach 7 m without shadowing (dB).
const SENSITIVITY_DB: f64 = 71.5 - 60.0;

/// Nodes at these places and a robot that asks for all sectors.
fn scene(places: Vec<Position>) -> Scene {
    let config = CsmaFeedbackConfig { max_retries: 7, report_all_sectors: true };
    Scene { contention: ContentionConfig::CsmaFeedback(config), ..Scene::of(places) }
}

fn run(setup: Setup, observer: &mut impl Observer) -> Survey {
    Simulation::new(setup).expect("a good setup").run(observer)
}

fn at(range_m: f64, azimuth_deg: f64) -> Position {
    let azimuth_rad = azimuth_deg.to_radians();
    Position::new(range_m * azimuth_rad.cos(), range_m * azimuth_rad.sin(), 0.0)
}

/// By how much a frame with 0 dBi over this range is stronger than the sensitivity (dB).
fn margin_db(range_m: f64) -> f64 {
    20.0 * (7.0 / range_m).log10()
}

fn of_kind(on_air: &OnAir, is: impl Fn(&SweepBody) -> bool) -> Vec<Sent> {
    on_air.0.iter().filter(|sent| is(&sent.3.body)).copied().collect()
}

fn feedback(on_air: &OnAir) -> Vec<Sent> {
    of_kind(on_air, |body| matches!(body, SweepBody::Feedback { .. }))
}

fn reports(on_air: &OnAir) -> Vec<Sent> {
    of_kind(on_air, |body| matches!(body, SweepBody::Brp { .. }))
}

fn of_robot(survey: &Survey) -> Packets {
    *survey.networks[0].packets.last().expect("a robot")
}

/// The reports of a node at a stop: sectors and SNRs (dB).
fn reported(survey: &Survey, node: u32) -> Vec<(u8, f64)> {
    survey.log().sector_snrs(NodeId(node), 0).iter().map(|of| (of.sector, f64::from(of.snr_db))).collect()
}

#[test]
fn a_node_reports_the_power_of_each_sector_that_it_heard_to_a_quarter_of_a_decibel() {
    let range_m = 1.2;
    let survey = run(scene(vec![at(range_m, 100.0)]).setup(), &mut Unobserved);
    // 10 and 12.5 degrees off the boresights of beams of 22.5 degrees; the next ones are 32.5 and 35 degrees off, and
    // weaker than the sensitivity.
    let expected = [(4, 10.0), (5, 12.5)].map(|(sector, off_deg)| {
        let gain_dbi = -3.01 * (2.0_f64 * off_deg / 22.5).powi(2);
        (sector, SENSITIVITY_DB + margin_db(range_m) + gain_dbi)
    });
    let found = reported(&survey, 0);
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for ((sector, snr_db), (of, exact_db)) in found.into_iter().zip(expected) {
        assert!(sector == of && (snr_db - exact_db).abs() <= 0.13, "sector {sector}: {snr_db}, not {exact_db} dB");
    }
    // The best of them is what the answer names.
    let [best] = survey.log().of(NodeId(0)).to_vec()[..] else { panic!("one stop") };
    assert_eq!((best.sector, best.snr_db), (Some(4), Some(reported(&survey, 0)[0].1)));
}

#[test]
fn nodes_report_the_gains_of_a_code_book_by_the_identities_of_its_sectors() {
    let identities = [0_u8, 7, 30, 59, 63];
    let gain_dbi =
        |number: usize, step: usize| f64::from(u8::try_from((7 * number + 11 * step) % 23).unwrap()) - 14.0;
    let sectors = identities.iter().enumerate().map(|(number, identity)| {
        let gains: Vec<f64> = (0..9).map(|step| gain_dbi(number, step)).collect();
        format!("{{ sector = {identity}, gain_dbi = [{gains:?}] }}")
    });
    let sectors = sectors.collect::<Vec<_>>().join(", ");
    let antennas = format!(
        "robots.code_book = {{ azimuths_deg = [0, 40, 80, 120, 160, 200, 240, 280, 320], elevations_deg = [0], \
         sectors = [{sectors}] }}\nnodes.sectors = {{ azimuth_sectors = 8, boresight_gain_dbi = 10 }}"
    );
    let ranges_m = [1.5, 2.5, 4.0];
    let mut absent = 0;
    for step in 0..9 {
        for range_m in ranges_m {
            let scene = scene(vec![at(range_m, 40.0 * step as f64)]);
            let mut setup = scene.setup();
            setup.networks[0].technology = scene.technology(&toml::from_str(&antennas).expect("antennas"));
            let survey = run(setup, &mut Unobserved);
            let found = reported(&survey, 0);
            let levels = (0..5).map(|number| margin_db(range_m) + gain_dbi(number, step));
            let heard = identities.into_iter().zip(levels).filter(|&(_, over_db)| over_db >= 0.0);
            let expected: Vec<(u8, f64)> =
                heard.map(|(sector, over_db)| (sector, SENSITIVITY_DB + over_db)).collect();
            absent += 5 - expected.len();
            assert_eq!(found.len(), expected.len(), "{found:?}, not {expected:?}");
            for (&(sector, snr_db), &(of, exact_db)) in found.iter().zip(&expected) {
                assert!(sector == of && (snr_db - exact_db).abs() <= 0.13, "{found:?}, not {expected:?}");
            }
        }
    }
    assert!((30..100).contains(&absent), "{absent} sectors are too weak");
}

#[test]
fn a_report_follows_the_feedback_after_sifs_and_costs_its_airtime() {
    let mut on_air = OnAir::default();
    let asked = run(scene(vec![at(1.2, 100.0)]).setup(), &mut on_air);
    let ([question], [report]) = (&feedback(&on_air)[..], &reports(&on_air)[..]) else { panic!("one of each") };
    assert_eq!((report.2, report.4), (StationId(0), FrameOutcome::Received));
    assert_eq!(report.0, question.1 + 3_000);
    // 48 octets in control PHY: 7552 chips, then 928 bits of 32 chips.
    assert_eq!(report.1 - report.0, (7552 + 928 * 32) * 1000 / 1760 + 1);
    assert!(report.1 <= question.1 + 1000 * u64::from(question.3.duration_us), "the feedback claims the medium");
    let SweepBody::Feedback { refinement, .. } = question.3.body else { unreachable!("it is feedback") };
    assert!(refinement.asks_for_all_sectors());
    assert_eq!((of_robot(&asked).reports_asked, of_robot(&asked).reports_received), (1, 1));

    let config = CsmaFeedbackConfig { max_retries: 7, report_all_sectors: false };
    let silent = Scene { contention: ContentionConfig::CsmaFeedback(config), ..scene(vec![at(1.2, 100.0)]) };
    let mut before = OnAir::default();
    let unasked = run(silent.setup(), &mut before);
    assert!(reports(&before).is_empty() && !unasked.log().has_sector_snrs());
    assert_eq!(of_robot(&unasked).reports_asked, 0);
    // Nothing else changes but the energy of the node, by the frame.
    assert_eq!(asked.packets, unasked.packets);
    let sent_s = |on_air: &OnAir, station| -> f64 {
        on_air.0.iter().filter(|sent| sent.2 == station).map(|sent| 1e-9 * (sent.1 - sent.0) as f64).sum()
    };
    for station in [StationId(0), StationId(1)] {
        let power_w =
            |survey: &Survey, on_air| survey.networks[0].energy[station.index()].tx_j / sent_s(on_air, station);
        let (with, without) = (power_w(&asked, &on_air), power_w(&unasked, &before));
        assert!(with > 0.0 && (with / without - 1.0).abs() < 1e-9, "{with} and {without} W");
    }
}

#[test]
fn reports_of_many_nodes_are_asked_for_and_received_as_the_ledger_says() {
    let places: Vec<Position> = (0..40).map(|i| at(1.0 + 0.1 * f64::from(i), 37.0 * f64::from(i))).collect();
    let scene = Scene { sweeps: 3, node_sectors: 4, ..scene(places) };
    let mut on_air = OnAir::default();
    let survey = run(scene.setup(), &mut on_air);
    let (questions, answers) = (feedback(&on_air), reports(&on_air));
    let received = answers.iter().filter(|sent| sent.4 == FrameOutcome::Received).count() as u64;
    let robot = of_robot(&survey);
    assert_eq!((robot.reports_asked, robot.reports_received), (questions.len() as u64, received));
    assert!(answers.len() <= questions.len() && received >= 50, "{received} of {}", questions.len());
    for packets in &survey.networks[0].packets {
        let lost = packets.lost_collision + packets.lost_channel_access + packets.lost_signal + packets.not_listened;
        assert_eq!(packets.offered, packets.received + lost + packets.out_of_range + packets.pending);
        assert_eq!(packets.lost_queue, 0);
    }
    // No report without a reception; what is not fading is the same in all sweeps.
    let log = survey.log();
    let of_log: Vec<SectorReport> = log.sector_reports().collect();
    assert!(of_log.iter().all(|report| log.at(report.node, report.stop).is_some_and(|found| found.received > 0)));
    assert!(of_log.iter().all(|report| (4.0 * report.snr_db).fract().abs() < 1e-9));
    assert_eq!(survey.log(), run(scene.setup(), &mut Unobserved).log());
}

#[test]
fn nodes_that_hear_each_other_leave_the_medium_to_a_report() {
    let places: Vec<Position> = (0..20).map(|i| at(0.5, 18.0 * f64::from(i))).collect();
    // One wide sector each: no answer points past the others.
    let scene = Scene { sweeps: 3, node_sectors: 1, ..scene(places) };
    let robot = of_robot(&run(scene.setup(), &mut Unobserved));
    assert!(robot.reports_asked >= 50, "{}", robot.reports_asked);
    // Two of equal backoffs hide both from the others, who may begin when the robot talks past them.
    assert!(10 * robot.reports_received >= 9 * robot.reports_asked, "{robot:?}");
}

#[test]
fn a_report_that_is_lost_leaves_the_answer_and_the_sweep_ends() {
    let mut on_air = OnAir::default();
    let whole = run(scene(vec![at(1.2, 100.0)]).setup(), &mut on_air);
    let asked_ns = feedback(&on_air)[0].1;
    // The node dies between the feedback and its report.
    let scene = scene(vec![at(1.2, 100.0)]);
    let mut setup = scene.setup();
    let at_s = 1e-9 * (asked_ns + 1_000) as f64;
    let deaths = DeathsConfig { share: Some(1.0), names: None, from_s: at_s, to_s: at_s };
    let faults = FaultsConfig { deaths: Some(deaths), ..FaultsConfig::default() };
    setup.faults = faults.build(&setup.world.nodes, Seed(1)).expect("good faults");
    let mut on_air = OnAir::default();
    let survey = run(setup, &mut on_air);
    assert!(reports(&on_air).is_empty());
    assert_eq!((of_robot(&survey).reports_asked, of_robot(&survey).reports_received), (1, 0));
    assert!(!survey.log().has_sector_snrs());
    assert_eq!(survey.log().of(NodeId(0)).to_vec(), whole.log().of(NodeId(0)).to_vec());
    assert_eq!(survey.end, whole.end);
}
