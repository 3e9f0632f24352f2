//! Links that robots keep while they drive, end to end, against counts by hand.

use sextant::summary::{LinkSummary, MissionSummary};
use sextant::{Scenario, Unwatched};

/// A robot that creeps from the origin along x beside three nodes, in free space; `rule` is that of its training.
fn creeping(speed_m_per_s: f64, rule: &str, more: &str) -> Scenario {
    let text = format!(
        r#"
name = "creeping"
seed = 1
[world.nodes.explicit]
positions_m = [[2, 3], [60, 3], [120, 3]]
[radio]
tx_power_dbm = 0.0
sensitivity_dbm = -78.0
[channel.path_loss.close_in]
carrier_ghz = 60.48
exponent = 2.0
[mac.sector_sweep]
[antenna]
node_headings = "aligned"
nodes.sectors = {{ azimuth_sectors = 16 }}
robots.sectors = {{ azimuth_sectors = 32 }}
[[robots]]
name = "robot"
role = "agent"
start_m = [0.0, 0.0]
speed_m_per_s = {speed_m_per_s}
[[applications]]
map.physical = {{}}
duration_s = 60.0
[applications.algorithm.beam_tracking]
way_m = [[4.0, 0.0]]
retrain.{rule}
{more}
"#
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("creeping.toml");
    std::fs::write(&path, text).expect("a file");
    Scenario::load(&path).expect("a scenario")
}

fn mission(scenario: &Scenario) -> MissionSummary {
    let done = sextant::run(scenario, &mut (), &Unwatched).expect("a run");
    done.summary().applications[0].clone()
}

fn link(scenario: &Scenario) -> LinkSummary {
    mission(scenario).link.expect("a link")
}

fn is_near(found: f64, expected: f64, what: &str) {
    assert!((found / expected - 1.0).abs() < 1e-4, "{what}: {found}, by hand {expected}");
}

#[test]
fn a_link_that_hardly_moves_brings_what_is_counted_by_hand() {
    // 4 m at 2 m/s: 20 beacon intervals of 102.4 ms. A beacon takes 24.655 us, and a slot for 16 sectors 290 us.
    let (beacon, slots, interval) = (24.655e-6, 9e-6 + 8.0 * 290e-6, 102.4e-3);
    let all = 32.0 * beacon + 31.0 * 1e-6 + slots;
    let each = link(&creeping(2.0, "every = 1", ""));
    assert_eq!((each.searches, each.near_trainings, each.failed_trainings, each.handovers), (20, 0, 0, 0));
    is_near(each.overhead, all / interval, "every interval");
    let fifth = link(&creeping(2.0, "every = 5", ""));
    assert_eq!(fifth.searches, 4);
    is_near(fifth.overhead, (4.0 * all + 16.0 * beacon) / (20.0 * interval), "each fifth interval");
    // Nobody is more than 5 m away: no outage, and MCS 12 all the time if the sectors are right.
    assert_eq!((each.outage, each.ideal_outage, each.frames_lost), (0.0, 0.0, Some(0.0)));
    // Ten steps of 9.92 ms have 54 exchanges of 64 MPDUs in 182.364 us each, and one with what is left.
    let steps = 10.0;
    let step = (interval - all) / steps;
    let left = step - 54.0 * 182.364e-6;
    // A shorter frame: 3328 + 1024 + 64 chips, blocks of 512 with 1344 bits of data, MPDUs of 1536 octets.
    let fits = |mpdus: f64| {
        let blocks = ((mpdus * 1536.0 * 8.0 / 504.0).ceil() * 672.0 / 1792.0).ceil();
        (3328.0 + 1024.0 + 64.0 + blocks * 512.0) / 1.76e9 + 3.382e-6 + 6e-6 <= left
    };
    let mpdus = (1..64).map(f64::from).filter(|&mpdus| fits(mpdus)).fold(0.0, f64::max);
    let bits = steps * (54.0 * 64.0 + mpdus) * 12_000.0;
    is_near(each.throughput_bit_per_s, bits / interval, "throughput");
    assert!((each.by_mcs[12] - 1.0).abs() < 1e-12 && each.by_mcs.len() == 13, "{:?}", each.by_mcs);
}

#[test]
fn a_prediction_sweeps_few_sectors_and_keeps_the_link() {
    let known = link(&creeping(2.0, "predicted = { sectors = 4 }", ""));
    let pointed = link(&creeping(2.0, "predicted = { sectors = 1 }", ""));
    let searched = link(&creeping(2.0, "on_fall = {}", ""));
    let all = link(&creeping(2.0, "every = 1", ""));
    for link in [&known, &pointed, &searched, &all] {
        assert_eq!((link.outage, link.failed_trainings), (0.0, 0));
        assert!(link.throughput_bit_per_s <= link.ideal_throughput_bit_per_s);
    }
    // In free space the sector that a map points to is the best one: as strong as after all sectors. A link that falls by 3 dB beside
    // the best since the last training, because the node is farther away now, is searched once.
    assert!(known.searches <= 1 && pointed.searches <= 1, "{} {}", known.searches, pointed.searches);
    assert!(known.near_trainings > 8 && known.near_trainings < 20, "{}", known.near_trainings);
    let loss_db = |link: &LinkSummary| link.snr_loss_db.expect("data");
    assert!(loss_db(&known) < loss_db(&all) + 0.5 && loss_db(&pointed) < loss_db(&all) + 0.5);
    assert!(known.overhead < 0.3 * all.overhead, "{} {}", known.overhead, all.overhead);
    assert!(searched.searches < all.searches && searched.searches > 1);
}

#[test]
fn a_refinement_costs_its_time_and_leaves_no_weaker_link() {
    let without = link(&creeping(2.0, "every = 1", ""));
    let with = link(&creeping(2.0, "every = 1", "refine = true"));
    let loss_db = |link: &LinkSummary| link.snr_loss_db.expect("data");
    assert!(loss_db(&with) < loss_db(&without) + 0.3, "{} {}", loss_db(&with), loss_db(&without));
    // BRP frames of 44 and 52 octets, a training unit of 4992 chips, and spaces of 3, 40 and 40 us.
    let frame = |bits: f64, words: f64| (7552.0 + (88.0 + bits + 168.0 * (1.0 + words)) * 32.0) / 1.76e9;
    let refinement = 3e-6 + frame(304.0, 2.0) + 4992.0 / 1.76e9 + 40e-6 + frame(368.0, 3.0) + 40e-6;
    is_near((with.overhead - without.overhead) * 102.4e-3, refinement, "refinement");
}

#[test]
fn a_mission_says_whether_its_robot_got_to_the_end_of_its_way() {
    let scenario = creeping(2.0, "every = 1", "");
    let whole = mission(&scenario);
    assert_eq!(whole.arrived, Some(true));
    // 4 m at 2 m/s.
    assert!(whole.time_s.is_some_and(|time_s| (time_s - 2.0).abs() < 1e-6), "{:?}", whole.time_s);
    // The run ends in the second beacon interval, of which half has data: shares are of what was, not of the whole interval.
    let cut = mission(&scenario.with("applications.0.duration_s", 0.15).expect("a scenario"));
    assert_eq!((cut.arrived, cut.time_s), (Some(false), None));
    let link = cut.link.expect("a link");
    assert!((link.by_mcs.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{:?}", link.by_mcs);
    let whole = whole.link.expect("a link");
    assert!(link.throughput_bit_per_s > 0.98 * whole.throughput_bit_per_s, "{}", link.throughput_bit_per_s);
}

#[test]
fn what_cannot_be_trained_is_refused_at_its_key() {
    let scenario = creeping(2.0, "predicted = {}", "");
    let refused = |key: &str, value: f64| {
        let key = format!("applications.0.algorithm.beam_tracking.{key}");
        scenario.with(&key, value).err().expect("a refusal").to_string()
    };
    // 32 beacons and 8 slots take 3.15 ms.
    for (key, value, allowed) in [
        ("beacon_interval_ms", 5.0, "at least 6.298"),
        ("beacon_interval_ms", 2000.0, "1 to 1000"),
        ("retrain.predicted.margin_db", -1.0, "0 to 100"),
    ] {
        let problem = refused(key, value);
        assert!(problem.contains(key) && problem.contains(allowed), "{problem}");
    }
    let many = scenario.with("applications.0.algorithm.beam_tracking.retrain.predicted.sectors", 33);
    let problem = many.err().expect("a refusal").to_string();
    assert!(problem.contains("1 to 32, the sectors of a robot"), "{problem}");
    let even = scenario.with("antenna.nodes", "{ omnidirectional = {} }");
    let problem = even.err().expect("a refusal").to_string();
    assert!(problem.contains("with nodes whose antenna has no sectors"), "{problem}");
}
