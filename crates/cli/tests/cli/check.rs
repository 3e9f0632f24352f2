//! `sextant check`: all mistakes at once, what follows from a scenario, and warnings.

use std::process::Output;

use serde_json::Value;

use crate::program::{Said, call, check_text, folder, run_text, scenario, sextant, unwrapped};

/// A valid scenario without warnings: a robot drives along a line of nodes, with known reception.
const LINE: &str = r#"name = "line"
[world.nodes.explicit]
positions_m = [[0, 0], [10, 0], [20, 0], [30, 0]]
[radio]
tx_power_dbm = 0
sensitivity_dbm = -90
[channel.path_loss.log_distance]
exponent = 3.0
[channel.shadowing]
sigma_db = 6.0
[traffic.periodic]
mpdu_octets = 20
interval_s = 0.5
[[robots]]
name = "rover"
start_m = [0, 1]
speed_m_per_s = 2.0
listen_s = 2.0
[robots.controller.waypoints]
places_m = [[0, 1], [10, 1], [20, 1], [30, 1]]
"#;

/// Exit code, standard output and standard error of `sextant` in a folder with `a.toml`.
fn told(text: &str, words: &[&str]) -> Output {
    call(folder(&[("a.toml", text)]).path(), words)
}

/// The forecast of a scenario.
fn forecast(text: &str) -> Value {
    let mut answer = told(text, &["check", "-v", "a.toml", "--format", "json"]).json();
    answer[0]["forecast"].take()
}

#[test]
fn many_mistakes_are_printed_at_once_in_the_order_of_the_file() {
    let mut text = LINE.to_owned();
    for (from, to) in [
        ("name = \"line\"", "name = \"line\"\nsede = 1"),
        ("[30, 0]]", "\"far\"]"),
        ("tx_power_dbm = 0", "tx_power_dbn = 0"),
        ("sensitivity_dbm = -90", "sensitivity_dbm = \"low\""),
        ("exponent = 3.0", "exponent = -3.0"),
        ("sigma_db = 6.0", "sigma_db = true"),
        ("mpdu_octets = 20", "mpdu_octets = 300"),
        ("interval_s = 0.5", "interval_s = 0.0"),
        ("start_m = [0, 1]", "start_m = [0]"),
        ("speed_m_per_s = 2.0", "speed_m_per_s = 0.0"),
        ("[robots.controller.waypoints]\nplaces_m = [[0, 1], [10, 1], [20, 1], [30, 1]]", "[robots.controller]"),
    ] {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        text = text.replace(from, to);
    }
    text.push_str("[[maps]]\nalgorithm = 3\n");
    let (code, stdout, stderr) = told(&text, &["check", "a.toml"]).all();
    assert_eq!((code, stdout.as_str()), (2, ""));
    insta::assert_snapshot!(stderr);
}

#[test]
fn a_wrong_duration_alone_is_blamed() {
    let text = LINE.replace("name = \"line\"", "name = \"line\"\nduration_s = -1\nwarm_up_s = 5");
    let (code, _, said) = told(&text, &["check", "a.toml"]).all();
    assert!(code == 2 && said.contains("`duration_s` is -1"), "{said}");
    assert!(!said.contains("`warm_up_s` is 5"), "{said}");
}

#[test]
fn the_ranges_are_those_of_the_closed_form() {
    let forecast = forecast(LINE);
    let range = &forecast["networks"][0]["range"];
    // A frame is received if it is 3 dB above the noise, which is 0.403 dB below the sensitivity. Free space over 1 m at
    // 2405 MHz costs 40.07 dB; one of 100 normal gains is above 2.326 standard deviations.
    let range_m = |share_sigmas: f64| {
        let budget_db = 0.0 - (-90.0 - 0.403 + 3.0) - 40.07 + share_sigmas * 6.0;
        10.0_f64.powf(budget_db / 30.0)
    };
    let near = |found: &Value, expected: f64| (found.as_f64().expect("a number") / expected - 1.0).abs() < 0.002;
    assert!(near(&range["half_m"], range_m(0.0)), "{range}, {}", range_m(0.0));
    assert!(near(&range["hundredth_m"], range_m(2.3263)), "{range}, {}", range_m(2.3263));
    // 10 and 20 m are below the range of 38 m, and so is 30 m.
    assert_eq!(forecast["networks"][0]["neighbours"]["mean"], 3.0);
    // 26 octets with the header of the physical layer at 250 kb/s, twice a second, from four nodes.
    let load = &forecast["networks"][0]["load"];
    assert!(near(&load["airtime_s"], 26.0 * 32e-6) && near(&load["rate_per_s"], 2.0), "{load}");
    let erlang = load["mean_erlang"].as_f64().expect("a number");
    assert!(erlang > 26.0 * 32e-6 * 2.0 && erlang < 4.0 * 26.0 * 32e-6 * 2.0, "{load}");
}

#[test]
fn the_way_of_a_planned_path_is_that_of_the_run() {
    let (_folder, run) = run_text(LINE, &[]);
    let forecast = forecast(LINE);
    let way = &forecast["robots"][0];
    assert_eq!(way["estimate"], false);
    let near = |found: &Value, expected: &Value, tolerance: f64| {
        let (found, expected) = (found.as_f64().expect("a number"), expected.as_f64().expect("a number"));
        assert!((found - expected).abs() <= tolerance * expected.abs() + 1e-6, "{found} {expected}");
    };
    let gathering = &run["gathering"];
    near(&way["stops"], &gathering["stops"], 0.0);
    near(&way["path_length_m"], &gathering["path_length_m"], 1e-6);
    near(&way["duration_s"], &gathering["duration_s"], 1e-6);
    near(&forecast["cost"]["frames"], &gathering["packets_sent"], 0.1);
    near(&forecast["cost"]["events"], &run["simulation"]["events"], 0.5);
    // 16 pairs of node and stop with four packets each: most are received, hardly any is lost to others.
    let per_stop = gathering["packets_received"].as_f64().expect("a number") / 4.0;
    near(&way["packets_expected"], &per_stop.into(), 0.25);
}

#[test]
fn packets_are_received_as_often_as_forecast_at_each_distance() {
    // One node, and a robot that stays for a while at each distance; shadowing is drawn for each packet.
    let (mut scenario, packets) = (LINE.replace("[[0, 0], [10, 0], [20, 0], [30, 0]]", "[[0, 0]]"), 400.0);
    scenario = scenario.replace("listen_s = 2.0", "listen_s = 200.0");
    for distance_m in [20.0, 38.0, 60.0] {
        let text = scenario
            .replace("start_m = [0, 1]", &format!("start_m = [{distance_m}, 0]"))
            .replace("[[0, 1], [10, 1], [20, 1], [30, 1]]", &format!("[[{distance_m}, 0]]"));
        let forecast = forecast(&text)["robots"][0]["packets_expected"].as_f64().expect("a number") / packets;
        let gathering = run_text(&text, &[]).1["gathering"].take();
        let count = |key: &str| gathering[key].as_f64().expect("a number");
        let measured = count("packets_received") / count("packets_sent");
        // Four standard deviations: a false alarm in 16000 cases.
        let tolerance = 4.0 * (forecast * (1.0 - forecast) / packets).sqrt() + 0.005;
        assert!((measured - forecast).abs() < tolerance, "{distance_m} m: {measured} {forecast}");
    }
}

#[test]
fn a_forecast_is_printed_as_a_table() {
    let (code, stdout, stderr) = told(LINE, &["check", "-v", "a.toml"]).all();
    assert_eq!((code, stderr.as_str()), (0, ""));
    insta::assert_snapshot!(stdout);
}

/// The warnings of the scenario with `from` replaced by `to`.
fn warnings(from: &str, to: &str) -> String {
    assert_eq!(LINE.matches(from).count(), 1, "{from}");
    let (code, stdout, stderr) = told(&LINE.replace(from, to), &["check", "a.toml"]).all();
    assert_eq!(code, 0, "{stderr}");
    assert!(stdout.starts_with("ok line"), "{stdout}");
    stderr
}

#[test]
fn likely_mistakes_are_warned_of() {
    let wall = |settings: &str| {
        let shape = "shape.box = { center_m = [5.0, 0.5, 0.0], size_m = [0.2, 0.2, 0.2] }";
        format!("[radio]\n{settings}").replace("[radio]", &format!("[[world.obstacles]]\n{shape}")) + "\n[radio]"
    };
    let above = "[[world.obstacles]]\nmaterial = \"brick\"\nshape.box = { center_m = [5.0, 0.0, 9.0], size_m = [1.0, 1.0, 1.0] }\n[radio]";
    for (from, to, expected) in [
        ("exponent = 3.0", "exponent = 3.0\nreference_loss_db = 0.0", "remove the key for the loss of free space"),
        ("interval_s = 0.5", "interval_s = 5.0", "`robots[0].listen_s`"),
        ("[30, 0]]", "[3000, 0], [4000, 0]]", "from 2 of 5 nodes less than 1 %"),
        ("[radio]", &wall("solid = false\nloss_db = 0.0"), "blocks nothing: it neither absorbs"),
        ("[radio]", above, "blocks nothing: it lies beside"),
        ("[radio]", "[[sinks]]\nname = \"gate\"\nposition_m = [5000, 0]\n[radio]", "the sink `gate` hears each node"),
        ("[[0, 1], [10, 1], [20, 1], [30, 1]]", "[[0, 1]]", "the robot never moves"),
        ("name = \"line\"", "name = \"line\"\nenergy = \"nrf52840\"", "`nrf52840` has no idle current"),
        ("[radio]", "[radio]\nphy = \"ask868\"", "`energy`: `at86rf212b` has no ASK"),
    ] {
        let found = warnings(from, to);
        assert!(found.contains("warning: a.toml: `") && found.contains(expected), "{to}: {found}");
    }
    assert_eq!(warnings("name = \"line\"", "name = \"line\""), "");
}

#[test]
fn a_way_that_is_not_looked_at_to_its_end_says_so_and_names_no_node_out_of_reach() {
    // The last node is heard only at the last of 25 001 stops.
    let far = "[0, 0], [10, 0], [20, 0], [30000, 0]]";
    let nodes = LINE.replace("[[0, 0], [10, 0], [20, 0], [30, 0]]", &format!("[{far}"));
    let stops = (0..25_000).map(|i| format!("[{}, 1], ", 0.001 * f64::from(i))).collect::<String>();
    let text = nodes.replace("[[0, 1], [10, 1], [20, 1], [30, 1]]", &format!("[{stops}[30000, 1]]"));
    let (code, stdout, stderr) = told(&text, &["check", "-v", "a.toml"]).all();
    assert_eq!((code, stderr.as_str()), (0, ""));
    assert!(stdout.contains("(only the first part of a long way)"), "{stdout}");
}

#[test]
fn a_run_warns_before_it_starts_unless_it_is_quiet() {
    let text = LINE.replace("interval_s = 0.5", "interval_s = 5.0");
    let (code, _, stderr) = told(&text, &["run", "a.toml"]).all();
    assert_eq!(code, 0, "{stderr}");
    assert!(stderr.contains("warning: `robots[0].listen_s`"), "{stderr}");
    let (_, _, stderr) = told(&text, &["run", "a.toml", "--quiet"]).all();
    assert_eq!(stderr, "");
}

#[test]
fn a_shipped_scenario_with_sectors_has_a_forecast() {
    let path = scenario("mmtm/warehouse-vaa.toml");
    let text = sextant().args(["check", "-v"]).arg(path).output().expect("the program starts").printed();
    assert!(text.contains("radio range") && text.contains("packets a stop"), "{text}");
}

#[test]
fn a_ground_above_the_stations_is_told() {
    let ground = |z_m: f64| {
        let reflections = format!("[channel.reflections]\nground_z_m = {z_m:?}\nground_material = \"concrete\"\n");
        let text = LINE.replace("[channel.shadowing]", &format!("{reflections}[channel.shadowing]"));
        let (code, stdout, stderr) = told(&text, &["check", "a.toml"]).all();
        assert_eq!(code, 0, "{stderr}");
        unwrapped(&(stdout + &stderr))
    };
    for z_m in [3.0, 0.0] {
        let said = ground(z_m);
        assert!(said.contains("channel.reflections.ground_z_m"), "{said}");
        assert!(said.contains("5 of 5 stations are not above the ground"), "{said}");
    }
    let said = ground(-1.0);
    assert!(!said.contains("not above the ground"), "{said}");
}

#[test]
fn a_window_in_which_no_answer_ends_is_refused() {
    let text = LINE
        .replace(
            "[channel.path_loss.log_distance]\nexponent = 3.0",
            "[channel.path_loss.close_in]\ncarrier_ghz = 60.48\nexponent = 2.0",
        )
        .replace(
            "[traffic.periodic]\nmpdu_octets = 20\ninterval_s = 0.5\n",
            "[mac.sector_sweep]\nwindow_ms = 0.1\n[antenna.nodes.sectors]\nazimuth_sectors = 8\n\
             [antenna.robots.sectors]\nazimuth_sectors = 16\n",
        )
        .replace("listen_s = 2.0", "listen_s = 2.0\nsweeps_per_stop = 2");
    let message = check_text(&text, &[]);
    assert!(message.contains("window_ms") && message.contains("at least 0.145 for the 8 frames"), "{message}");
    told(&text.replace("window_ms = 0.1", "window_ms = 1"), &["check", "a.toml"]).printed();
}
