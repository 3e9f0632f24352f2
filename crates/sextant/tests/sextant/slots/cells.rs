//! Single cells: contention in shared ones, retries and waiting times in dedicated ones, listening in empty ones.

use sextant::{Scenario, Unwatched};

use super::{assert_close, mac, network};

/// Nodes with one frame each for a shared cell: delivery, transmissions of a node, and cells until delivery on average. The rows
/// were worked out apart from this program; their standard errors are at most 0.002.
#[test]
fn contenders_for_a_shared_cell_deliver_as_often_as_the_back_off_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let rounds = 1500_u32;
    for (nodes, retries, exponents, expected) in [
        (2, 3, (1, 7), [0.9845, 2.624, 3.23]),
        (5, 3, (1, 7), [0.7366, 3.665, 6.99]),
        (10, 7, (1, 7), [0.9999, 5.126, 23.04]),
        // The back-off of Contiki-NG.
        (5, 7, (2, 5), [1.0, 3.081, 9.18]),
    ] {
        let (min_be, max_be) = exponents;
        let rest = format!(
            "duration_s = 60.0
traffic.once = {{ mpdu_octets = 50, at_s = 0.0, acknowledged = true }}
mac.tsch = {{ max_retries = {retries}, min_be = {min_be}, max_be = {max_be}, schedule.minimal = {{ slotframe = 5 }} }}"
        );
        let scenario = network(folder.path(), nodes, None, &rest);
        let (mut delivered, mut transmissions, mut cells) = (0, 0, 0.0);
        for seed in 0..rounds {
            let mac = mac(&scenario.with("seed", u64::from(seed)).expect("a seed"));
            delivered += mac.all.delivered;
            transmissions += mac.all.transmissions;
            // The end of a frame that goes out in the slot 5 c: offset to the delimiter, and 51 octets after it.
            let mean_s = mac.all.delay_s.map_or(0.0, |delay| delay.mean);
            cells += mac.all.delivered as f64 * (mean_s - (2120.0 + 51.0 * 32.0) * 1e-6) / 0.05;
        }
        let frames = f64::from(rounds) * nodes as f64;
        let [share, tries, wait]: [f64; 3] = expected;
        // Four standard errors, with those of the expected values; rounds are independent, nodes in a round are not.
        let round = f64::from(rounds).sqrt();
        let of = |what: &str| format!("{nodes} nodes, {retries} retries: {what}");
        let share_error = 4.0 * (share * (1.0 - share)).sqrt() / round + 0.002;
        assert_close(delivered as f64 / frames, share, share_error, &of("delivery"));
        assert_close(transmissions as f64 / frames, tries, 4.0 * tries * 0.5 / round + 0.005, &of("transmissions"));
        assert_close(cells / delivered as f64, wait, 4.0 * wait / round + 0.03, &of("cells"));
    }
}

/// Delivery 1 - (1 - p)^(R + 1), transmissions of a frame (1 - (1 - q)^(R + 1)) / q where q is the share of frames that are
/// received and whose acknowledgements are, and the waiting time for the next cell.
#[test]
fn a_dedicated_cell_delivers_with_its_retries_and_waits_for_its_slot() {
    let folder = tempfile::tempdir().expect("a folder");
    let (slots, retries) = (20, 3);
    for (frames, acknowledgements) in [(0.7, 1.0), (0.5, 1.0), (0.8, 0.75)] {
        let rest = format!(
            r#"duration_s = 40000.0
traffic.periodic = {{ mpdu_octets = 50, interval_s = 4.0, jitter = 0.5, acknowledged = true }}
[mac.tsch]
max_retries = {retries}
[mac.tsch.schedule.own]
slotframe = {slots}
cells = [
  {{ node = "n0", peer = "sink", timeslot = 7, options = "transmit" }},
  {{ node = "sink", peer = "n0", timeslot = 7, options = "receive" }},
]"#
        );
        let links = [("n0", "sink", frames), ("sink", "n0", acknowledgements)];
        let mac = mac(&network(folder.path(), 1, Some(&links), &rest)).all;
        let (packets, both) = (mac.offered as f64, frames * acknowledgements);
        // A frame is sent again if it was not acknowledged, and delivered if any of its transmissions was received.
        let share = 1.0 - (1.0 - frames).powi(retries + 1);
        let tries = (1.0 - (1.0 - both).powi(retries + 1)) / both;
        let error = 4.0 / packets.sqrt();
        assert_close(mac.prr.expect("packets"), share, error * (share * (1.0 - share)).sqrt(), "delivery");
        assert_close(mac.transmissions as f64 / packets, tries, error * 1.2, "transmissions");
        // Half a slotframe to the slot, as many slotframes as failed before, and what comes before the end of the frame. The
        // packet is offered at any time, and its slot starts later.
        let frame_s = 20.0 * 0.01;
        let lost = |k: i32| (1.0 - frames).powi(k) * frames / share;
        let failures: f64 = (1..=retries).map(|k| f64::from(k) * lost(k)).sum();
        let delay_s = frame_s / 2.0 + failures * frame_s + (2120.0 + 51.0 * 32.0) * 1e-6;
        let delay = mac.delay_s.expect("delays").mean;
        assert_close(delay, delay_s, error * frame_s * 1.2, "delay");
    }
}

/// A window of 2200 us in one of L slots of 10 ms, and the union of the three slotframes of Orchestra.
#[test]
fn idle_stations_have_the_duty_cycle_of_their_schedule() {
    let folder = tempfile::tempdir().expect("a folder");
    let silent = "duration_s = 20000.0\ntraffic.silent = {}\nmac.tsch.schedule.";
    for slots in [3, 7, 101, 397] {
        let rest = format!("{silent}minimal.slotframe = {slots}");
        let found = mac(&network(folder.path(), 3, None, &rest)).slots.expect("slots");
        let expected = 0.22 / f64::from(slots);
        assert_close(found.duty_cycle.expect("nodes"), expected, 1e-5, "nodes");
        assert_close(found.sink_duty_cycle.expect("a sink"), expected, 1e-5, "sink");
        assert_close(1e6 * found.mean_current_a.expect("no scan"), 2460.0 / f64::from(slots), 0.2, "current");
        assert_eq!((found.receive, found.transmit, found.transmit_acknowledged), (0, 0, 0));
        // The time of a node ends with its death.
        let death = "{ deaths = { names = [\"n0\"], from_s = 5000.0, to_s = 5000.0 } }";
        let dead = network(folder.path(), 3, None, &rest).with("faults", death).expect("a death");
        assert_close(
            mac(&dead).slots.and_then(|slots| slots.duty_cycle).expect("nodes"),
            expected,
            1e-5,
            "nodes, one of which dies",
        );
    }
    let rest = format!("{silent}orchestra = {{}}");
    let found = mac(&network(folder.path(), 3, None, &rest)).slots.expect("slots");
    assert_close(found.duty_cycle.expect("nodes"), 0.22 * 0.091_48, 2e-6, "orchestra");
    // A sink has no time source, whose beacons it would hear.
    let expected = 0.22 * (1.0 - 30.0 / 31.0 * 16.0 / 17.0);
    assert_close(found.sink_duty_cycle.expect("a sink"), expected, 2e-6, "orchestra, sink");
}

/// Sender-based cells: nobody else sends in them, so that nothing collides, whatever the load.
#[test]
fn cells_of_senders_do_not_collide() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = |unicast: &str| {
        format!(
            "duration_s = 400.0
traffic.saturated = {{ mpdu_octets = 50, start_spread_s = 1.0, acknowledged = true }}
mac.tsch.schedule.orchestra = {{ unicast = \"{unicast}\", unicast_slotframe = 17 }}"
        )
    };
    let by_sender = mac(&network(folder.path(), 10, None, &rest("sender_based")));
    assert_eq!((by_sender.all.retries, by_sender.all.lost_collision), (0, 0));
    // One frame in each slotframe, but for slots that beacons have: none are sent.
    let slotframes = 400.0 / 0.17;
    assert_close(by_sender.all.delivered as f64 / 10.0, slotframes, 0.01 * slotframes, "frames of a node");
    let by_receiver = mac(&network(folder.path(), 10, None, &rest("receiver_based")));
    assert!(by_receiver.all.retries > 1000, "{}", by_receiver.all.retries);
}

#[test]
fn hops_without_cells_are_a_warning() {
    let folder = tempfile::tempdir().expect("a folder");
    let both = |up: &str, down: &str| {
        format!(
            "{{ node = \"*\", peer = \"sink\", timeslot = 1, options = \"{up}\" }}, \
             {{ node = \"sink\", peer = \"*\", timeslot = 1, options = \"{down}\" }}"
        )
    };
    let warned = |cells: &str, to: &str, tree: &str| {
        let rest = format!(
            "duration_s = 9.0\ntraffic.periodic = {{ mpdu_octets = 40, interval_s = 1.0 }}\n\
             routing = {{ to = \"{to}\", tree.{tree} = {{}} }}\n\
             [mac.tsch.schedule.own]\nslotframe = 11\ncells = [{cells}]\n"
        );
        let warnings = sextant::forecast::warnings(&network(folder.path(), 2, None, &rest));
        let of_cells = warnings.into_iter().filter(|warning| warning.key == "mac.tsch.schedule.own");
        of_cells.map(|warning| warning.message).collect::<Vec<String>>()
    };
    let up = both("transmit shared", "receive");
    assert!(warned(&up, "sink", "shortest").is_empty());
    let says = |found: Vec<String>, what: &str| assert!(found.len() == 1 && found[0].starts_with(what), "{found:?}");
    let nowhere = "`sink` has no cell for packets to `n0` (and the same of 1 further hop): none arrives";
    says(warned(&up, "sink_and_back", "shortest"), nowhere);
    says(warned(&up, "sink_and_back", "collection"), "`sink` has no cell for packets: none arrives");
    let deaf = both("transmit shared", "receive transmit");
    let nobody = "nobody who should listens in the cells of `sink` for packets to `n0`";
    says(warned(&deaf, "sink_and_back", "shortest"), nobody);
    let heard = both("transmit receive shared", "transmit receive shared");
    assert!(warned(&heard, "sink_and_back", "shortest").is_empty());
}

/// With sender-based cells a node listens in that of its parent, if packets go down.
#[test]
fn packets_go_down_in_cells_of_senders() {
    let folder = tempfile::tempdir().expect("a folder");
    let found = |to: &str| {
        let rest = format!(
            "duration_s = 600.0
traffic.periodic = {{ mpdu_octets = 60, interval_s = 10.0 }}
mac.tsch.schedule.orchestra = {{ unicast = \"sender_based\" }}
routing = {{ to = \"{to}\", tree.shortest = {{}} }}"
        );
        let run = sextant::run(&network(folder.path(), 2, None, &rest), &mut (), &Unwatched).expect("a run");
        let summary = run.summary();
        let slots = summary.mac.as_ref().and_then(|mac| mac.slots).expect("slots");
        (summary.routing.clone().expect("routing"), slots.duty_cycle.expect("nodes"))
    };
    let (both, listening) = found("sink_and_back");
    let answers = both.answers.expect("the sink answers");
    assert!(answers.offered >= 100 && answers.delivered + answers.pending == answers.offered, "{answers:?}");
    assert!(answers.pending <= 2, "{answers:?}");
    let (up, deaf) = found("sink");
    assert_eq!(up.delivered + up.pending, up.offered);
    assert!(deaf < listening, "no more listening than packets need: {deaf}, {listening}");
}

/// One of two channels brings no frames, and the cell comes on both in turn: every other packet is lost.
#[test]
fn rows_of_measured_links_count_on_their_own_channel() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = "duration_s = 2000.0
traffic.periodic = { mpdu_octets = 50, interval_s = 1.0, jitter = 0.5, acknowledged = true }
mac.tsch = { hopping = [11, 12], max_retries = 0, schedule.minimal.slotframe = 7 }";
    let links = [("n0", "sink", 1.0), ("sink", "n0", 1.0)];
    let prr = |scenario: &Scenario| mac(scenario).all.prr.expect("packets");
    assert!(prr(&network(folder.path(), 1, Some(&links), rest)) > 0.999);
    let rows = "t_s,from,to,channel,prr\n0,n0,sink,11,1\n0,sink,n0,11,1\n0,n0,sink,12,0\n";
    std::fs::write(folder.path().join("links.csv"), rows).expect("a file");
    let half = Scenario::load(folder.path().join("scenario.toml")).expect("a scenario");
    // Five standard errors of 2000 packets.
    assert_close(prr(&half), 0.5, 0.056, "share of packets");
}
