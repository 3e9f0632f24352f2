//! Tests of links, by closed forms.

use sextant_channel::Channel;

use super::*;

/// Two nodes 10 m apart, a wall of 1 m between them, a robot, and a sink beside the first node.
const WORLD: &str = r#"
name = "two"
seed = 3
[world.nodes.explicit]
positions_m = [[0.0, 0.0], [10.0, 0.0]]
[[world.obstacles]]
name = "wall"
absorption_per_m = 1.0
shape.box = { center_m = [5.0, 0.0, 0.0], size_m = [1.0, 4.0, 3.0] }
[radio]
tx_power_dbm = 0.0
sensitivity_dbm = -90.0
noise_floor_dbm = -100.0
groups = [{ nodes.names = ["n1"], tx_power_dbm = 5.0, sensitivity_dbm = -80.0, noise_floor_dbm = -95.0 }]
[channel.path_loss.log_distance]
exponent = 2.0
reference_loss_db = 40.0
[traffic.periodic]
interval_s = 1.0
[[robots]]
name = "robot"
start_m = [0.0, 10.0]
[robots.controller.waypoints]
places_m = [[1.0, 10.0]]
[[robots]]
name = "agent"
role = "agent"
start_m = [0.0, 5.0]
[[sinks]]
name = "sink"
position_m = [0.0, 1.0]
"#;

fn two(more: &str) -> Scenario {
    Scenario::parse(&format!("{more}\n{WORLD}")).expect("a good scenario")
}

fn near(value: f64, expected: f64) {
    assert!((value - expected).abs() < 1e-9, "{value}, not {expected}");
}

#[test]
fn the_items_of_a_link_name_what_is_in_the_way_and_sum_to_its_power() {
    let walls = "[[world.walls]]\nname = \"corner\"\npoints_m = [[2, -3], [2, 0], [4, 0]]\nmaterial = \"glass\"\nloss_db = 3\n\
                 [[world.walls]]\npoints_m = [[2, -3], [2, 3]]\nloss_db = 7\n";
    for wall in ["absorption_per_m = 1.0", "material = \"brick\"\nloss_db = 4", "loss_db = inf"] {
        let reflections = "[channel.reflections]\nloss_db = 6\nground_z_m = -40\n[traffic.periodic]";
        let text = WORLD.replace("absorption_per_m = 1.0", wall).replace("[traffic.periodic]", reflections);
        let scenario =
            Scenario::parse(&text.replace("[radio]", &format!("{walls}[radio]"))).expect("a good scenario");
        let report = explain_link(&scenario, "n0", "n1", None).unwrap();
        let path = report.path.as_ref().unwrap();
        let by_obstacles: Option<f64> = path.obstacles.iter().map(|crossed| crossed.loss_db).sum();
        assert_eq!(by_obstacles.is_none(), path.obstacle_loss_db.is_none());
        let losses_db = match (by_obstacles, path.reflection_gain_db) {
            (Some(by_obstacles), Some(gain_db)) => {
                near(by_obstacles, path.obstacle_loss_db.unwrap());
                path.reference_loss_db + path.distance_loss_db + by_obstacles - gain_db
            }
            _ => -path.reflections_alone_db.unwrap(),
        };
        near(report.directions.as_ref().unwrap()[0].received_dbm.unwrap(), -losses_db);
        let parts =
            path.obstacles.iter().map(|crossed| crossed.fixed_db.map(|fixed_db| crossed.absorption_db + fixed_db));
        assert!(parts.eq(path.obstacles.iter().map(|crossed| crossed.loss_db)), "{path:?}");
        let text = report.to_string();
        assert!(text.contains("corner, piece 1, 1.92 m of glass"), "{text}");
        assert_eq!(text.contains("wall, 1.00 m of brick"), wall.contains("brick"), "{text}");
        assert_eq!(text.contains("instead of all losses"), wall.contains("inf"), "{text}");
    }
}

#[test]
fn a_link_through_a_wall_has_the_power_of_the_closed_form() {
    let report = explain_link(&two(""), "n0", "n1", None).unwrap();
    let path = report.path.as_ref().unwrap();
    near(path.reference_loss_db, 40.0);
    near(path.distance_loss_db, 20.0);
    let wall_db = 10.0 * std::f64::consts::E.log10();
    assert_eq!((path.obstacles.len(), path.obstacles[0].name.as_deref()), (1, Some("wall")));
    near(path.obstacles[0].length_m, 1.0);
    near(path.obstacles[0].loss_db.unwrap(), wall_db);
    let [forth, back] = report.directions.as_ref().unwrap();
    near(forth.received_dbm.unwrap(), -60.0 - wall_db);
    near(back.received_dbm.unwrap(), -55.0 - wall_db);
    // n1 hears from -80 dBm on, and needs 3 dB above its noise; the other way the sensitivity is -90 dBm.
    near(forth.reception.least_power_dbm, -80.0);
    near(back.reception.margin_db.unwrap(), 35.0 - wall_db);
    near(forth.reception.snr_db.unwrap(), 35.0 - wall_db);
    near(forth.reception.busy_from_dbm, -70.0);
    assert!(forth.reception.is_busy && (forth.reception.probability - 1.0).abs() < 1e-12);
    assert_eq!(report.shadowing.draw_db, None);
    let text = report.to_string();
    for line in ["wall, 1.00 m inside", "n0 to n1", "n1 to n0", "-64.34 dBm", "-59.34 dBm"] {
        assert!(text.contains(line), "{line}: {text}");
    }
}

#[test]
fn shadowing_is_that_of_the_channel_of_the_simulator() {
    let shadowed = |correlation: &str| {
        let shadowing = format!("{{ sigma_db = 6.0, correlation = {correlation} }}");
        two("").with("channel.shadowing", shadowing).expect("a good scenario")
    };
    for correlation in ["\"per_link\"", "{ spatial = { distance_m = 5.0 } }"] {
        let scenario = shadowed(correlation);
        let setup = scenario.setup();
        let channel = Channel::new(setup.networks[0].channel, setup.world.obstacles.clone(), setup.seed);
        let places = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 1.0, 0.0]].map(Position::from);
        // The agent takes no part in the survey, so the sink is the fourth station.
        let names = ["n0", "n1", "robot", "sink"];
        for (a, b) in [(0, 1), (0, 2), (2, 1), (3, 1), (2, 3)] {
            let report = explain_link(&scenario, names[a], names[b], None).unwrap();
            let direction = &report.directions.as_ref().unwrap()[0];
            let tx = sextant_channel::Dbm(direction.tx_power_dbm);
            let station = StationId::from_index;
            let power = channel.received_power(tx, station(a), places[a], station(b), places[b], 0).unwrap();
            assert_eq!(direction.received_dbm, Some(power.0), "{correlation}: {} to {}", names[a], names[b]);
        }
    }
    let report = explain_link(&shadowed("\"per_packet\""), "n0", "sink", None).unwrap();
    let reception = &report.directions.as_ref().unwrap()[0].reception;
    assert_eq!(report.shadowing.draw_db, None);
    // 50 dB of margin are more than eight standard deviations.
    assert!(reception.probability_over_shadowing > 1.0 - 1e-12);
}

#[test]
fn the_share_over_shadowing_is_the_tail_of_a_normal_distribution() {
    let scenario = two("").with("channel.shadowing.sigma_db", 8.0).unwrap();
    // n1 needs -80 dBm. The mean over 10 m and the wall is 0 - 60 - 4.343 dBm: with -15.657 dBm less, half arrive.
    let at = |tx_power_dbm: f64| {
        let scenario = scenario.with("radio.tx_power_dbm", tx_power_dbm).unwrap();
        let report = explain_link(&scenario, "n0", "n1", None).unwrap();
        report.directions.unwrap()[0].reception.probability_over_shadowing
    };
    let half_dbm = -20.0 + 10.0 * std::f64::consts::E.log10();
    near(at(half_dbm), 0.5);
    assert!((at(half_dbm + 8.0) - 0.841_344_746).abs() < 1e-8 && (at(half_dbm - 8.0) - 0.158_655_254).abs() < 1e-8);
    // With bit errors the probability is a sum over the draws. It lies near that of the threshold where bits begin to fail.
    let ber = scenario.with("reception", "\"ber\"").unwrap().with("radio.groups", "[]").unwrap();
    let share =
        explain_link(&ber, "n0", "n1", None).unwrap().directions.unwrap()[0].reception.probability_over_shadowing;
    assert!(share > 0.99 && share <= 1.0, "{share}");
}

#[test]
fn the_best_sector_is_chosen_and_its_gain_is_that_of_the_antenna() {
    let mut text =
        WORLD.replace("[traffic.periodic]\ninterval_s = 1.0\n", "").replace("noise_floor_dbm = -100.0\n", "");
    let groups = text.find("groups = ").unwrap();
    let end = text[groups..].find('\n').unwrap();
    text.replace_range(groups..=groups + end, "");
    text += "[mac.sector_sweep]\n[antenna]\nnode_headings = \"aligned\"\nnodes.sectors.azimuth_sectors = 8\n\
        robots.sectors.azimuth_sectors = 16\nrobots.sectors.quasi_omni_gain_dbi = 2.0\n";
    let scenario = Scenario::parse(&text).unwrap();
    let report = explain_link(&scenario, "n0", "robot", None).unwrap();
    // The robot stands north of the node: the third of eight sectors, and south is the thirteenth of sixteen.
    let [forth, back] = report.directions.as_ref().unwrap();
    assert_eq!((forth.sector, back.sector), (Some(2), Some(12)));
    near(forth.receive_gain_db, 2.0);
    let antennas = scenario.networks()[0].technology.antennas().unwrap();
    near(forth.transmit_gain_db, antennas.nodes().gain(2, Position::new(0.0, 1.0, 0.0)).0);
    near(forth.received_dbm.unwrap(), -60.0 + forth.transmit_gain_db + 2.0);
}

#[test]
fn a_place_is_a_sink_and_an_agent_is_at_its_start() {
    let scenario = two("");
    let report = explain_link(&scenario, " n0", "3,4", None).unwrap();
    near(report.distance_m, 5.0);
    near(report.directions.as_ref().unwrap()[0].received_dbm.unwrap(), -40.0 - 20.0 * 5_f64.log10());
    assert!(report.ends[1].kind.starts_with("place"));
    let report = explain_link(&scenario, "agent", "0, 0, 2", None).unwrap();
    assert_eq!(report.ends[0].kind, "robot, at its start");
    near(report.distance_m, 29_f64.sqrt());
    let limited = scenario.with("channel.max_range_m", 4.0).unwrap();
    let report = explain_link(&limited, "n0", "3,4", None).unwrap();
    assert_eq!((report.directions.is_none(), report.max_range_m), (true, Some(4.0)));
    assert!(report.to_string().contains("no link: the radius of communication is 4 m"));
}

#[test]
fn wrong_ends_are_refused_with_what_is_allowed() {
    let scenario = two("");
    let why = |a: &str, b: &str| explain_link(&scenario, a, b, None).unwrap_err().to_string();
    assert!(why("robto", "n0").contains("did you mean `robot`"), "{}", why("robto", "n0"));
    assert!(why("n0", "zzz").contains("allowed: the name of a node"));
    assert!(why("n0", "n0").contains("named twice"));
    assert!(why("n0", "0,0").contains("same place, (0, 0, 0) m"));
    assert!(why("n0", "inf,0").contains("finite"));
    assert!(why("n0", "1,2,3,4").contains("is not a place"));
    let network = explain_link(&scenario, "n0", "n1", Some("rf")).unwrap_err().to_string();
    assert!(network.contains("`rf`") && network.contains("there is one network"), "{network}");
}

#[test]
fn a_link_between_storeys_loses_what_its_way_through_the_slab_takes() {
    let storeys = "[[world.storeys]]\nname = \"ground\"\nheight_m = 2.5\n\
                   [[world.storeys]]\nname = \"upper\"\nheight_m = 2.5\n\
                   slab = { corners_m = [[-5, -5], [15, -5], [15, 5], [-5, 5]], thickness_m = 0.5, absorption_per_m = 2, loss_db = 6 }\n";
    let at = "positions_m = [[0.0, 0.0, 1.0], [3.0, 0.0, 2.0]]\nstoreys.upper = [\"n1\"]";
    let text = WORLD.replace("positions_m = [[0.0, 0.0], [10.0, 0.0]]", at);
    let text = text.replace("[radio]", &format!("{storeys}[radio]")).replace("exponent = 2.0", "exponent = 3.0");
    let report = explain_link(&Scenario::parse(&text).expect("a good scenario"), "n0", "n1", None).unwrap();
    let path = report.path.as_ref().unwrap();
    let [crossed] = &path.obstacles[..] else { panic!("{:?}", path.obstacles) };
    assert_eq!((crossed.name.as_deref(), crossed.obstacle), (Some("slab of upper"), 1));
    // From 1 m to 2 m above a floor at 3 m: 4 m up over 3 m, and 5/4 of the thickness inside.
    near(crossed.length_m, 0.625);
    near(crossed.loss_db.unwrap(), 6.0 + 20.0 * std::f64::consts::LOG10_E * 0.625);
}
