//! Keys that change nothing are warned of, and they change nothing indeed; interferers that nobody hears.

use sextant::{Scenario, Unwatched};

/// Four nodes and a sink, all of which hear each other but for shadowing, with the rest of the scenario.
fn scenario(rest: &str) -> Scenario {
    let text = format!(
        r#"
name = "idle"
duration_s = 100.0
world.nodes.explicit = {{ names = ["a", "b", "c", "d"], positions_m = [[15.0, 0.0], [30.0, 0.0], [15.0, 10.0], [30.0, 10.0]] }}
sinks = [{{ name = "sink", position_m = [0.0, 0.0] }}]
radio.tx_power_dbm = 0.0
radio.sensitivity_dbm = -90.0
channel.path_loss.log_distance = {{ exponent = 3.0, reference_loss_db = 40.0 }}
channel.shadowing.sigma_db = 6.0
{rest}
"#
    );
    Scenario::parse(&text).expect("a scenario")
}

fn warned(scenario: &Scenario) -> Vec<String> {
    sextant::forecast::warnings(scenario).iter().map(ToString::to_string).collect()
}

/// All that a run finds.
fn result(scenario: &Scenario) -> String {
    let mut summary =
        serde_json::to_value(sextant::run(scenario, &mut (), &Unwatched).expect("a run").summary()).expect("JSON");
    let object = summary.as_object_mut().expect("an object");
    object.remove("timing");
    object.remove("scenario");
    summary.to_string()
}

const BROADCASTS: &str = "traffic.poisson = { mpdu_octets = 70, rate_per_s = 0.5 }";
const ACKNOWLEDGED: &str = "traffic.poisson = { mpdu_octets = 70, rate_per_s = 0.5, acknowledged = true }";
const SATURATED: &str = "traffic.saturated.mpdu_octets = 70";
const MINIMAL: &str = "mac.tsch.schedule.minimal.slotframe = 7";

/// Settings of a network, and a key with another value than its default, which changes nothing there.
const IDLE: [(&[&str], &str, &str); 22] = [
    (&["mac.csma_unslotted = {}", BROADCASTS], "mac.csma_unslotted.max_retries", "1"),
    (&["mac.csma_unslotted.rx_on_when_idle = true", ACKNOWLEDGED], "mac.csma_unslotted.idle_turnarounds", "true"),
    (&["mac.csma_unslotted = {}", SATURATED], "mac.csma_unslotted.queue_frames", "5"),
    (
        &["mac.beacon_enabled.beacon_order = 4", "mac.beacon_enabled.superframe_order = 4", BROADCASTS],
        "mac.beacon_enabled.max_retries",
        "1",
    ),
    (&[MINIMAL, BROADCASTS], "mac.tsch.max_retries", "1"),
    (&[MINIMAL, BROADCASTS], "mac.tsch.min_be", "3"),
    (&[MINIMAL, BROADCASTS], "mac.tsch.max_be", "3"),
    (&[MINIMAL, BROADCASTS], "mac.tsch.timeslot.tx_ack_delay_us", "1100"),
    (&[MINIMAL, BROADCASTS], "mac.tsch.timeslot.rx_ack_delay_us", "700"),
    (&[MINIMAL, BROADCASTS], "mac.tsch.timeslot.ack_wait_us", "600"),
    (&[MINIMAL, ACKNOWLEDGED], "mac.tsch.synchronisation.keep_alive_s", "5.0"),
    (&[MINIMAL, ACKNOWLEDGED], "mac.tsch.synchronisation.lost_after_s", "40.0"),
    (&[MINIMAL, ACKNOWLEDGED], "radio.cca_threshold_dbm", "-85.0"),
    (&["mac.sleep = { sinks = \"sleep\", wake_up.x_mac = {} }", BROADCASTS], "mac.sleep.max_retries", "1"),
    (&["mac.sleep = { sinks = \"sleep\", wake_up.x_mac = {} }", ACKNOWLEDGED], "mac.sleep.allowed_ppm", "5.0"),
    (
        &["mac.sleep = { sinks = \"sleep\", wake_up.repeated_data = {} }", ACKNOWLEDGED],
        "mac.sleep.allowed_ppm",
        "5.0",
    ),
    (
        &["mac.sleep = { sinks = \"sleep\", wake_up.repeated_data = {} }", BROADCASTS],
        "mac.sleep.wake_up.repeated_data.phases",
        "\"learned\"",
    ),
    (&["mac.sleep.wake_up.csl = {}", ACKNOWLEDGED], "mac.sleep.allowed_ppm", "5.0"),
    (&["mac.sleep.wake_up.csl = {}", ACKNOWLEDGED], "mac.sleep.wake_up.csl.phases", "\"unknown\""),
    (
        &["mac.csma_unslotted.rx_on_when_idle = true", BROADCASTS, "routing.tree.rpl.mode = \"none\""],
        "routing.tree.rpl.route_lifetime_min",
        "4",
    ),
    (
        &["mac.csma_unslotted.rx_on_when_idle = true", BROADCASTS, "routing.tree.rpl.mode = \"none\""],
        "routing.tree.rpl.dao_delay_s",
        "1.0",
    ),
    (
        &["mac.csma_unslotted.rx_on_when_idle = true", BROADCASTS, "routing.tree.rpl.dao_tries = 0"],
        "routing.tree.rpl.dao_retry_s",
        "1.0",
    ),
];

#[test]
fn keys_that_change_nothing_are_warned_of_and_change_nothing() {
    for (rest, key, value) in IDLE {
        let without = scenario(&rest.join("\n"));
        let with = without.with(key, value).expect("a scenario");
        let expected = format!("`{key}`: it changes nothing: ");
        assert!(
            warned(&with).iter().any(|warning| warning.starts_with(&expected)),
            "{rest:?} {key}: {:?}",
            warned(&with)
        );
        assert_eq!(result(&with), result(&without), "{rest:?} {key}");
        let warned = warned(&without);
        assert!(!warned.iter().any(|warning| warning.contains("changes nothing")), "{rest:?}: {warned:?}");
    }
}

#[test]
fn keys_that_are_used_or_have_their_default_are_not_warned_of() {
    let learned = "mac.sleep = { sinks = \"sleep\", wake_up.repeated_data.phases = \"learned\" }";
    for (rest, key, value) in [
        (&["mac.csma_unslotted = {}", BROADCASTS][..], "mac.csma_unslotted.max_retries", "3"),
        (&["mac.csma_unslotted = {}", ACKNOWLEDGED], "mac.csma_unslotted.max_retries", "1"),
        (
            &["mac.csma_unslotted.rx_on_when_idle = true", BROADCASTS, "routing.tree.shortest = {}"],
            "mac.csma_unslotted.max_retries",
            "1",
        ),
        (&["mac.csma_unslotted = {}", ACKNOWLEDGED], "mac.csma_unslotted.idle_turnarounds", "true"),
        (&["mac.csma_unslotted = {}", BROADCASTS], "mac.csma_unslotted.queue_frames", "5"),
        // Frames that keep the time are acknowledged, and so are those that ask for cells.
        (&[MINIMAL, BROADCASTS, "radio.clock_ppm = 30.0"], "mac.tsch.max_retries", "1"),
        (&[MINIMAL, BROADCASTS, "radio.clock_ppm = 30.0"], "mac.tsch.synchronisation.keep_alive_s", "5.0"),
        (&["mac.tsch.schedule.msf = {}", BROADCASTS], "mac.tsch.max_retries", "1"),
        (&[learned, ACKNOWLEDGED], "mac.sleep.allowed_ppm", "5"),
        (&["mac.sleep.wake_up.csl = {}", BROADCASTS], "mac.sleep.allowed_ppm", "5"),
        (&["mac.sleep.wake_up.csl = {}", ACKNOWLEDGED], "mac.sleep.allowed_ppm", "20"),
    ] {
        let warned = warned(&scenario(&rest.join("\n")).with(key, value).expect("a scenario"));
        assert!(!warned.iter().any(|warning| warning.contains("changes nothing")), "{rest:?} {key}: {warned:?}");
    }
}

#[test]
fn interferers_that_nobody_hears_are_warned_of() {
    let found = |mac: &str, interferer: &str| {
        let interferers = format!("interferers = [{{ name = \"oven\", power_dbm = 20.0, {interferer} }}]");
        warned(&scenario(&[mac, BROADCASTS, &interferers].join("\n")))
    };
    let csma = "mac.csma_unslotted = {}";
    let near = "position_m = [5.0, 5.0]";
    for (mac, interferer, expected) in [
        (
            csma,
            format!("{near}, channel = 20"),
            "`interferers[0]`: no station can hear `oven`: its spectrum, 2449 to 2451 MHz",
        ),
        (csma, format!("{near}, channel = 20"), "of the networks, which are at 2405 MHz"),
        (csma, format!("{near}, center_mhz = 868.3"), "867.3 to 869.3 MHz"),
        (MINIMAL, format!("{near}, center_mhz = 2500.0"), "2405 to 2480 MHz"),
        (
            "channel.max_range_m = 60.0",
            "position_m = [15.0, 99.0], channel = 11".to_owned(),
            "`interferers[0].position_m`: no station can hear `oven`: the nearest one is 89.0 m away",
        ),
    ] {
        let warned = found(mac, &interferer);
        assert!(warned.iter().any(|warning| warning.contains(expected)), "{mac} {interferer}: {warned:?}");
    }
    // In the band, by its leakage, or on one of the channels of the hops.
    let wide = "channel = 14, leakage = [[0.0, -30.0], [20.0, -30.0]]";
    for (mac, interferer) in [(csma, "channel = 11"), (csma, wide), (MINIMAL, "channel = 20")] {
        let warned = found(mac, &format!("{near}, {interferer}"));
        assert!(!warned.iter().any(|warning| warning.contains("interferers")), "{mac} {interferer}: {warned:?}");
    }
}
