//! Batteries that run empty, end to end, against times and energies worked out by hand.

use std::collections::BTreeMap;

use sextant::summary::{BatterySummary, Summary};
use sextant::{Scenario, Unwatched};
use sextant_kernel::{NodeId, SimTime, StationId};
use sextant_sim::{FrameOnAir, Observer, PacketEnd, PacketFate, PacketTrace};

use crate::star::{self, assert_close, summary};

/// Energy of the longest frame (J): 133 octets of 32 us with the 62 mW or less of the chips here.
const FRAME_J: f64 = 133.0 * 32e-6 * 0.062;

/// A star in which frames that overlap are lost.
fn star(places_m: &[f64], rest: &str) -> Scenario {
    star::star(places_m, &format!("reception.overlap = {{}}\n{rest}"))
}

fn battery(summary: &Summary) -> &BatterySummary {
    summary.battery.as_ref().expect("batteries")
}

const PERIODIC: &str = "traffic.periodic = { mpdu_octets = 50, interval_s = 1.0 }";

/// 5.64 J at 18.8 mA and 3 V: 100 s. What it sends takes a little less than receiving: 17.4 mA.
#[test]
fn a_node_that_listens_dies_when_its_capacity_is_spent() {
    let rest = format!(
        "duration_s = 200.0\nmac.csma_unslotted.rx_on_when_idle = true\n{PERIODIC}\nbattery.capacity_j = 5.64\n"
    );
    let found = summary(&star(&[1.0], &rest));
    let node = &battery(&found).nodes[0];
    let death_s = node.depleted_s.expect("it is empty");
    // 100 frames of 56 octets with the headers, 1792 us each, at 4.2 mW less.
    let longer_s = 100.0 * 1792e-6 * 4.2 / 56.4;
    assert_close(death_s, 100.0 + longer_s, 0.002, "death");
    assert_close(node.mean_power_w * death_s, 5.64, FRAME_J, "energy");
    let energy = &found.mac.as_ref().expect("sinks").all.energy_j;
    assert_close(energy.tx + energy.rx + energy.idle, 5.64, FRAME_J, "energy of the radio");
    assert_eq!((battery(&found).depleted, battery(&found).first_death_s), (1, Some(death_s)));
    assert_eq!(battery(&found).half_death_s, Some(death_s));
    // Nothing is sent after the death, so nothing more is offered.
    assert_eq!(found.mac.as_ref().expect("sinks").all.offered, 100);
}

/// A node that idles between packets, alone, without a backoff: by hand, of each second it takes 192 us to come on, 128 us
/// to look, 192 us to turn around and 1792 us to send.
#[test]
fn a_node_that_rests_dies_by_the_sum_of_its_states_and_its_load() {
    let rest = format!(
        "duration_s = 3000.0\nmac.csma_unslotted = {{ rx_on_when_idle = false, min_be = 0 }}\n{PERIODIC}\n\
         [battery]\ncapacity_mah = 0.2\nload_ma = 0.1\n"
    );
    let found = summary(&star(&[1.0], &rest));
    let receiving_s = 192e-6 + 128e-6 + 192e-6;
    let second_mj = 56.4 * receiving_s + 52.2 * 1792e-6 + 1.278 * (1.0 - receiving_s - 1792e-6) + 0.3;
    let node = &battery(&found).nodes[0];
    assert_close(node.capacity_j, 2.16, 1e-12, "capacity");
    assert_close(node.mean_power_w, 1e-3 * second_mj, 2e-7, "power");
    assert_close(node.depleted_s.expect("empty"), 2160.0 / second_mj, 0.2, "death");
    assert_close(node.mean_power_w * node.depleted_s.expect("empty"), 2.16, FRAME_J, "energy");
    // A battery that outlives the run has the lifetime that this one had, but for the part of a second at its end.
    let longer = rest.replace("capacity_mah = 0.2", "capacity_mah = 200.0");
    let outlived = summary(&star(&[1.0], &longer));
    let node = &battery(&outlived).nodes[0];
    assert_eq!(node.depleted_s, None);
    assert_close(node.lifetime_d.expect("a load") * 86_400.0, 2_160_000.0 / second_mj, 100.0, "lifetime");
    assert_close(node.capacity_j - node.left_j, 3000.0 * 1e-3 * second_mj, 1e-3, "what it used");
}

/// The same node asleep between its packets. It has no idle time before it looks, so coming on takes nothing: 128 us to look, 192 us to turn around, 1792 us to send, and 640 us of spacing, idle.
#[test]
fn a_node_that_sleeps_between_packets_draws_what_sleeping_takes() {
    let rest = format!(
        "duration_s = 4000.0\nmac.csma_unslotted = {{ sleep_between_frames = true, min_be = 0 }}\n{PERIODIC}\n\
         battery.capacity_j = 100.0\n"
    );
    let found = summary(&star(&[1.0], &rest));
    let active_s = 128e-6 + 192e-6 + 1792e-6 + 640e-6;
    let second_mj = 56.4 * (128e-6 + 192e-6) + 52.2 * 1792e-6 + 1.278 * 640e-6 + 0.06 * (1.0 - active_s);
    let node = &battery(&found).nodes[0];
    assert_close(node.mean_power_w, 1e-3 * second_mj, 1e-7, "power");
    assert_close(node.lifetime_d.expect("a load") * 86_400.0, 1e5 / second_mj, 1e2, "lifetime");
    // The chip says what sleeping costs: an idle one would last a fifth as long.
    let idle = summary(&star(&[1.0], &rest.replace("sleep_between_frames = true, ", "")));
    assert!(battery(&idle).nodes[0].lifetime_d.expect("a load") < 0.25 * node.lifetime_d.expect("a load"));
}

/// A node that hears no sink keeps its packets, and dies with them.
#[test]
fn packets_over_several_hops_that_wait_in_an_empty_node_are_not_pending() {
    let rest = format!(
        "duration_s = 200.0\nmac.csma_unslotted.rx_on_when_idle = true\n{PERIODIC}\nbattery.capacity_j = 5.64\n\
         routing.tree.collection = {{}}\n"
    );
    let found = summary(&star(&[10_000.0], &rest));
    let routing = found.routing.as_ref().expect("routing");
    assert_eq!((battery(&found).depleted, routing.pending, routing.delivery), (1, 0, Some(0.0)));
}

/// What draws until a death in the warm-up is known: the node has a power and a lifetime.
#[test]
fn a_node_that_dies_in_the_warm_up_has_the_power_of_its_life() {
    let rest = format!(
        "duration_s = 200.0\nwarm_up_s = 100.0\nmac.csma_unslotted.rx_on_when_idle = true\n{PERIODIC}\n\
         battery.capacity_j = 100.0\nfaults.deaths = {{ names = [\"n1\"], from_s = 50.0, to_s = 50.0 }}\n"
    );
    let scenario = star(&[1.0, 2.0], &rest);
    let found = summary(&scenario);
    assert!(battery(&found).lifetime_d.is_some(), "{found:?}");
    assert_close(battery(&found).nodes[1].mean_power_w, 0.0564, 1e-4, "power of one that died by a fault");
    let small = summary(&scenario.with("battery.capacity_j", 2.82).expect("a capacity"));
    let node = &battery(&small).nodes[0];
    assert_close(node.mean_power_w * node.depleted_s.expect("it is empty"), 2.82, FRAME_J, "energy");
}

/// Energy spent up to the death is the capacity, whatever the channel access: within a frame.
#[test]
fn what_a_node_spent_until_its_death_is_its_capacity() {
    let busy = "traffic.poisson = { mpdu_octets = 80, rate_per_s = 8.0, acknowledged = true }\n";
    let slots = "traffic.poisson = { mpdu_octets = 80, rate_per_s = 2.0, acknowledged = true }\n\
                 [mac.tsch.schedule.minimal]\nslotframe = 3\n";
    let beacons = "traffic.poisson = { mpdu_octets = 60, rate_per_s = 4.0, acknowledged = true }\n\
                   mac.beacon_enabled = { beacon_order = 4, superframe_order = 3 }\n";
    for (rest, capacity_j) in [
        (format!("mac.csma_unslotted.rx_on_when_idle = false\n{busy}"), 0.15),
        (format!("mac.csma_unslotted.rx_on_when_idle = true\n{busy}"), 2.0),
        (format!("mac.csma_unslotted.sleep_between_frames = true\n{busy}"), 0.1),
        (slots.to_owned(), 0.2),
        (beacons.to_owned(), 0.3),
    ] {
        let rest = format!("duration_s = 300.0\n{rest}[battery]\ncapacity_j = {capacity_j}\ncapacity_spread = 0.1\n");
        let found = summary(&star(&[1.0, 2.0, 3.0], &rest));
        let nodes = &battery(&found).nodes;
        assert_eq!(battery(&found).depleted, 3, "{rest}");
        for (node, mac) in nodes.iter().zip(&found.mac.as_ref().expect("sinks").nodes) {
            let radio = &mac.traffic.energy_j;
            let (spent_j, death_s) = (radio.tx + radio.rx + radio.idle, node.depleted_s.expect("empty"));
            assert_close(spent_j, node.capacity_j, FRAME_J, &rest);
            assert_close(node.mean_power_w * death_s, node.capacity_j, FRAME_J, &rest);
        }
        assert!((nodes[0].capacity_j - nodes[1].capacity_j).abs() > 1e-6);
        let first_s = nodes.iter().filter_map(|node| node.depleted_s).fold(f64::MAX, f64::min);
        assert_eq!(battery(&found).first_death_s, Some(first_s));
    }
}

/// Nodes that sleep between checks of the channel: until its death, each draws the mean power that their links tell.
#[test]
fn what_a_sleeping_node_spent_until_its_death_is_its_capacity() {
    for form in ["x_mac = {}", "repeated_data = {}", "csl = {}"] {
        let rest = format!(
            "duration_s = 1500.0\nmac.sleep = {{ interval_s = 0.25, wake_up.{form} }}\n\
             traffic.poisson = {{ mpdu_octets = 60, rate_per_s = 0.1, acknowledged = true }}\n\
             battery.capacity_j = 0.3\n"
        );
        let found = summary(&star(&[1.0], &rest));
        let node = &battery(&found).nodes[0];
        let death_s = node.depleted_s.expect("empty");
        assert_close(node.mean_power_w * death_s, node.capacity_j, FRAME_J, form);
        let mac = found.mac.as_ref().expect("sinks");
        let power_w = mac.sleep.as_ref().expect("sleeps").mean_power_w;
        assert_close(power_w.expect("a node"), node.mean_power_w, 1e-3 * node.mean_power_w, form);
        assert!(mac.all.died <= 1 && mac.all.pending == 0, "{form}");
    }
}

/// Looks at batteries change nothing but what is said of batteries.
#[test]
fn a_battery_that_does_not_run_empty_changes_nothing_else() {
    let traffic = "traffic.poisson = { mpdu_octets = 80, rate_per_s = 8.0, acknowledged = true }\n";
    let slow = "traffic.poisson = { mpdu_octets = 80, rate_per_s = 0.2, acknowledged = true }\n";
    let routed = "[routing.tree.collection]\n";
    for rest in [
        format!("mac.csma_unslotted.rx_on_when_idle = false\n{traffic}"),
        format!("mac.csma_unslotted.sleep_between_frames = true\n{traffic}"),
        format!(
            "mac.csma_unslotted = {{ rx_on_when_idle = true, max_retries = 7 }}\ntraffic.periodic.interval_s = 0.5\n{routed}"
        ),
        format!("{traffic}[mac.tsch.schedule.minimal]\nslotframe = 5\n"),
        format!("{traffic}mac.beacon_enabled = {{ beacon_order = 4, superframe_order = 3 }}\n"),
        format!("{slow}mac.sleep = {{ interval_s = 0.25, sinks = \"sleep\", wake_up.x_mac = {{}} }}\n"),
        format!("{slow}mac.sleep = {{ interval_s = 0.25, sinks = \"sleep\", wake_up.csl = {{}} }}\n"),
    ] {
        let without = format!("duration_s = 60.0\nwarm_up_s = 7.3\n{rest}");
        let with = format!(
            "{without}[battery]\ncell = \"cr2032\"\nmodel.kibam = {{ available_share = 0.2, rate_per_min = 0.1 }}\n"
        );
        let places: Vec<f64> = (1..9).map(f64::from).collect();
        let (without, mut with) = (summary(&star(&places, &without)), summary(&star(&places, &with)));
        assert_eq!(with.battery.take().map(|battery| battery.depleted), Some(0));
        for depth in with.routing.iter_mut().flat_map(|routing| &mut routing.by_depth) {
            assert_eq!(depth.depleted.take(), Some(0));
            assert!(depth.lifetime_d.take().is_some());
        }
        (with.scenario, with.timing) = (without.scenario.clone(), without.timing);
        assert_eq!(with, without, "{rest}");
    }
}

/// Keeps how packets ended.
#[derive(Default)]
struct Ends(BTreeMap<[&'static str; 2], u64>);

impl Observer for Ends {
    fn traced(&mut self, packet: &PacketTrace) {
        *self.0.entry([packet.end.name(), packet.fate.name()]).or_default() += 1;
    }

    fn wants_packets(&self) -> bool {
        true
    }
}

impl sextant::RunObserver for Ends {}

/// Keeps the frames of the first node, and when its battery was empty.
#[derive(Default)]
struct LastFrames {
    frames: Vec<(SimTime, SimTime)>,
    depleted: Option<SimTime>,
}

impl Observer for LastFrames {
    fn framed(&mut self, frame: FrameOnAir<'_>) {
        if frame.source == StationId(0) {
            self.frames.push((frame.start, frame.start + frame.airtime));
        }
    }

    fn wants_frames(&self) -> bool {
        true
    }

    fn depleted(&mut self, _node: NodeId, time: SimTime) {
        self.depleted = Some(time);
    }
}

impl sextant::RunObserver for LastFrames {}

/// Wake-up frames of CSL go out back to back for an interval. The node dies amid them, and only the frame on air ends.
#[test]
fn a_node_that_dies_while_it_wakes_another_sends_no_further_frame() {
    for form in ["csl = {}", "x_mac = {}", "repeated_data = {}"] {
        let rest = format!(
            "duration_s = 100.0\nmac.sleep = {{ interval_s = 1.0, sinks = \"sleep\", wake_up.{form} }}\n\
             traffic.periodic = {{ mpdu_octets = 50, interval_s = 10.0, acknowledged = true }}\n\
             battery.capacity_j = 0.01\n"
        );
        let mut seen = LastFrames::default();
        sextant::run(&star(&[1.0], &rest), &mut seen, &Unwatched).expect("a run");
        let depleted = seen.depleted.expect("it is empty");
        let after = seen.frames.iter().filter(|(start, _)| *start > depleted).count();
        assert_eq!(after, 0, "{form}: {:?}", seen.frames.last());
        // It was sending.
        let (_, ended) = *seen.frames.last().expect("frames");
        let quiet_s = depleted.as_secs_f64() - ended.as_secs_f64();
        assert!(quiet_s < 0.003, "{form}: quiet for {quiet_s} s");
    }
}

/// More is offered than the channel takes, so that queues are full at the deaths.
#[test]
fn packets_that_wait_in_a_node_whose_battery_is_empty_are_lost() {
    for mac in [
        "mac.csma_unslotted = { rx_on_when_idle = true, queue_frames = 4 }\n",
        "mac.tsch = { queue_frames = 4, schedule.minimal.slotframe = 3 }\n",
    ] {
        let rest = format!(
            "duration_s = 20.0\nwarm_up_s = 1.0\n{mac}\
             traffic.periodic = {{ mpdu_octets = 100, interval_s = 0.004, acknowledged = true }}\n\
             battery.capacity_j = {}\n",
            if mac.contains("tsch") { 0.04 } else { 0.4 }
        );
        let scenario = star(&[1.0, 2.0], &rest);
        let mut ends = Ends::default();
        let run = sextant::run(&scenario, &mut ends, &Unwatched).expect("a run");
        let all = &run.summary().mac.as_ref().expect("sinks").all;
        assert_eq!(run.summary().battery.as_ref().expect("batteries").depleted, 2, "{mac}");
        // Each node leaves its queue, and the packet under way if that was not received.
        assert!((6..=10).contains(&all.died), "{mac}: {}", all.died);
        assert_eq!(all.pending, 0);
        let counted = all.delivered + all.lost_collision + all.lost_channel_access + all.lost_queue + all.lost_signal;
        assert_eq!(counted + all.out_of_range + all.not_listened + all.died, all.offered, "{mac}");
        assert_close(all.prr.expect("packets"), all.delivered as f64 / all.offered as f64, 1e-12, "PRR");
        let died = ends.0[&[PacketEnd::Died.name(), PacketFate::Died.name()]];
        assert_eq!(died, all.died, "{mac}: {:?}", ends.0);
    }
}

/// `n0` is out of reach of the sink; `n1` and `n2` are its two ways. The one that it uses has a small battery.
#[test]
fn a_tree_leaves_a_parent_whose_battery_is_empty() {
    let rest = |groups: &str| {
        format!(
            "duration_s = 4000.0\nchannel.max_range_m = 12.0\ntraffic.periodic.interval_s = 5.0\n\
             mac.csma_unslotted.rx_on_when_idle = true\n[routing.tree.collection]\n\
             [battery]\ncapacity_mah = 2500.0\n{groups}"
        )
    };
    let of = |groups: &str| summary(&star(&[20.0, 10.0, 10.5], &rest(groups)));
    let parent =
        |summary: &Summary| summary.routing.as_ref().expect("hops").nodes[0].parent.clone().expect("a parent");
    let first = parent(&of(""));
    let small = format!("[[battery.groups]]\nnodes = {{ names = [\"{first}\"] }}\ncapacity_j = 112.8\n");
    let repaired = of(&small);
    assert!(parent(&repaired) != first && parent(&repaired) != "sink");
    assert_close(battery(&repaired).first_death_s.expect("empty"), 2000.0, 2.0, "death");
    assert_eq!((battery(&repaired).depleted, battery(&repaired).half_death_s), (1, None));
    let routing = repaired.routing.as_ref().expect("hops");
    assert!(routing.delivery.expect("packets") > 0.99, "{routing:?}");
    // The packets of the dead node itself end with it: 400 of 800.
    let dead = routing.nodes.iter().find(|node| node.name == first).expect("a node");
    assert!((399..=401).contains(&dead.offered), "{}", dead.offered);
}

#[test]
fn what_does_not_fit_is_refused_with_its_key() {
    let good =
        star(&[1.0, 2.0], "duration_s = 1.0\ntraffic.periodic.interval_s = 1.0\n[battery]\ncapacity_mah = 1.0\n");
    for (set, parts) in [
        ("battery={}", ["battery.capacity_mah", "`capacity_mah`, `capacity_j` or `cell`"]),
        ("battery.capacity_j=2.0", ["battery.capacity_j", "set one of them"]),
        ("battery.capacity_mah=0.0", ["battery.capacity_mah", "0"]),
        ("battery.voltage_v=-1.0", ["battery.voltage_v", "-1"]),
        ("battery.self_discharge_per_year=1.0", ["battery.self_discharge_per_year", "0 to less than 1"]),
        ("battery.capacity_spread=0.5", ["battery.capacity_spread", "0 to 0.3"]),
        ("battery.load_ma=-0.1", ["battery.load_ma", "-0.1"]),
        ("battery.cell=\"aaa\"", ["unknown choice `aaa`", "battery.cell"]),
        (
            "battery.model={ peukert = { rated_h = 20.0, exponent = 3.0 } }",
            ["battery.model.peukert.exponent", "1 to 2"],
        ),
        (
            "battery.model={ kibam = { available_share = 0.0, rate_per_min = 0.1 } }",
            ["battery.model.kibam.available_share", "above 0 and below 1"],
        ),
        (
            "battery.groups=[{ nodes = { names = [\"n9\"] } }]",
            ["battery.groups[0].nodes.names[0]", "the name of a node"],
        ),
        ("battery.capacity_ah=1.0", ["unknown key `capacity_ah`", "battery"]),
    ] {
        let message = good.with_all(&[set.to_owned()], None).err().expect("a mistake").to_string();
        for part in parts {
            assert!(message.contains(part), "{set}: {message}");
        }
    }
}
