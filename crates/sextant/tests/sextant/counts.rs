//! Counts that hold together, whatever the channel access: each packet in one class, what a transmission is, and who is in a mean.

use std::time::Duration;

use sextant::summary::{MacSummary, TrafficSummary};
use sextant::{Programs, Scenario, Unwatched, explain_link};
use sextant_sim::{
    Application, Destination, FrameId, FrameOutcome, NetworkId, Observer, PacketEnd, PacketFate, PacketTrace, Port,
    RadioEvent, RadioFrame, SendOutcome, Timer,
};

use crate::star::{star, summary};

fn mac(scenario: &Scenario) -> MacSummary {
    summary(scenario).mac.expect("sinks")
}

/// Each packet is in one class, and a retry is a transmission of a packet after its first one.
fn assert_sums(all: &TrafficSummary, what: &str) {
    let lost = all.lost_collision + all.lost_channel_access + all.lost_queue + all.lost_signal;
    let counted = all.delivered + lost + all.out_of_range + all.not_listened + all.died + all.pending;
    assert_eq!(counted, all.offered, "{what}: {all:?}");
    assert_eq!(all.transmissions, all.sent + all.retries, "{what}: {all:?}");
}

/// Counts packets as their traces say.
#[derive(Default)]
struct Traced {
    offered: u64,
    died: u64,
    received: u64,
    sent: u64,
    transmissions: u64,
}

impl Observer for Traced {
    fn traced(&mut self, packet: &PacketTrace) {
        if !packet.counts {
            return;
        }
        assert_eq!(packet.fate == PacketFate::Died, packet.end == PacketEnd::Died && packet.delivered.is_none());
        self.offered += 1;
        self.died += u64::from(packet.fate == PacketFate::Died);
        self.received += u64::from(packet.fate == PacketFate::Sent(FrameOutcome::Received));
        self.sent += u64::from(!packet.transmissions.is_empty());
        self.transmissions += packet.transmissions.len() as u64;
    }

    fn wants_packets(&self) -> bool {
        true
    }
}

impl sextant::RunObserver for Traced {}

/// Queues are full when the nodes die.
#[test]
fn each_packet_counts_once_whatever_its_node_dies_of() {
    let busy = "{ mpdu_octets = 100, interval_s = 0.004, acknowledged = true }";
    let slow = "{ mpdu_octets = 100, interval_s = 0.05, acknowledged = true }";
    for (table, traffic, capacity_j) in [
        ("csma_unslotted = { rx_on_when_idle = true, queue_frames = 4 }", busy, 0.4),
        ("csma_unslotted = { sleep_between_frames = true, queue_frames = 4 }", busy, 0.1),
        ("beacon_enabled = { beacon_order = 4, superframe_order = 3, queue_frames = 4 }", busy, 0.2),
        ("tsch = { queue_frames = 4, schedule.minimal.slotframe = 3 }", busy, 0.04),
        ("sleep = { interval_s = 0.25, queue_frames = 4, sinks = \"sleep\", wake_up.x_mac = {} }", slow, 0.02),
        (
            "sleep = { interval_s = 0.25, queue_frames = 4, sinks = \"sleep\", wake_up.repeated_data = {} }",
            slow,
            0.02,
        ),
        ("sleep = { interval_s = 0.25, queue_frames = 4, sinks = \"sleep\", wake_up.csl = {} }", slow, 0.02),
    ] {
        for death in [
            format!("battery.capacity_j = {capacity_j}\n"),
            "faults.deaths = { share = 1.0, from_s = 3.0, to_s = 3.2 }\n".to_owned(),
        ] {
            let rest =
                format!("duration_s = 20.0\nwarm_up_s = 0.5\nmac.{table}\ntraffic.periodic = {traffic}\n{death}");
            let mut traced = Traced::default();
            let scenario = star(&[1.0, 2.0], &rest);
            let run = sextant::run(&scenario, &mut traced, &Unwatched).expect("a run");
            let mac = run.summary().mac.as_ref().expect("sinks");
            assert_sums(&mac.all, &rest);
            mac.nodes.iter().for_each(|node| assert_sums(&node.traffic, &rest));
            assert!(mac.all.died > 0 && mac.all.pending == 0, "{rest}: {:?}", mac.all);
            assert_eq!((traced.died, traced.received), (mac.all.died, mac.all.delivered), "{rest}");
            assert_eq!(traced.sent, mac.all.sent, "{rest}");
            if !table.contains("repeated_data") {
                assert_eq!(traced.transmissions, mac.all.transmissions, "{rest}");
            }
        }
    }
}

/// The far node reaches the sink over the near one, which dies with what it has; the far one keeps the rest.
#[test]
fn each_packet_over_several_hops_counts_once() {
    for (table, tree) in [
        ("csma_unslotted = { rx_on_when_idle = true, max_retries = 7 }", "shortest = {}"),
        ("csma_unslotted = { rx_on_when_idle = true, max_retries = 7 }", "collection = {}"),
        ("tsch.schedule.minimal.slotframe = 5", "shortest = {}"),
    ] {
        let rest = format!(
            "duration_s = 60.0\nchannel.max_range_m = 12.0\nmac.{table}\nrouting.tree.{tree}\n\
             traffic.periodic = {{ mpdu_octets = 60, interval_s = 0.01 }}\n\
             faults.deaths = {{ names = [\"n1\"], from_s = 30.0, to_s = 30.0 }}\n"
        );
        let found = summary(&star(&[20.0, 10.0], &rest));
        assert_sums(&found.mac.expect("sinks").all, &rest);
        let routing = found.routing.expect("hops");
        assert_eq!(routing.delivered + routing.pending + routing.died + routing.lost, routing.offered, "{rest}");
        assert!(routing.died > 0 && routing.delivered > 0, "{rest}: {routing:?}");
        // The node that died lived for half of the time.
        let node_h = 1.5 * 60.0 / 3600.0;
        assert!((routing.parent_changes_per_node_h * node_h - routing.parent_changes as f64).abs() < 1e-9);
    }
}

/// The relay dies, and no strobe is answered any more: attempts that send nothing are no transmissions of a hop.
#[test]
fn hops_have_as_many_transmissions_as_channel_access() {
    let found = summary(&star(
        &[20.0, 10.0],
        "duration_s = 60.0\nchannel.max_range_m = 12.0\nrouting.tree.shortest = {}\n\
         mac.sleep = { interval_s = 0.25, max_retries = 2, sinks = \"sleep\", wake_up.x_mac = {} }\n\
         traffic.periodic = { mpdu_octets = 60, interval_s = 4.0 }\n\
         faults.deaths = { names = [\"n1\"], from_s = 30.0, to_s = 30.0 }\n",
    ));
    let (mac, routing) = (found.mac.expect("sinks"), found.routing.expect("hops"));
    assert!(mac.all.no_acknowledgement > 3, "{:?}", mac.all);
    assert_eq!(routing.transmissions, mac.all.transmissions);
}

/// Nobody answers strobes, so the packet itself never goes out.
#[test]
fn strobes_that_nobody_answers_are_no_transmissions() {
    let rest = |wake_up: &str| {
        format!(
            "duration_s = 300.0\nmac.sleep = {{ interval_s = 0.25, max_retries = 2, wake_up.{wake_up} }}\n\
             traffic.periodic = {{ mpdu_octets = 50, interval_s = 20.0, acknowledged = true }}\n"
        )
    };
    let strobed = mac(&star(&[1e4], &rest("x_mac = {}")));
    assert_sums(&strobed.all, "x_mac");
    assert_eq!((strobed.all.sent, strobed.all.transmissions, strobed.all.retries), (0, 0, 0));
    let sleep = strobed.sleep.expect("sleeps");
    // Three attempts, each over an interval, which is 190 periods of 1312 us, and a little more.
    let per_packet = sleep.strobes_per_packet.expect("strobes were sent for packets");
    assert!((3.0 * 189.0..3.0 * 195.0).contains(&per_packet), "{sleep:?}");
    assert!(strobed.all.no_acknowledgement > 10 && strobed.all.out_of_range == strobed.all.no_acknowledgement);
    // Copies of one attempt are one transmission.
    let repeated = mac(&star(&[1e4], &rest("repeated_data = {}")));
    assert_sums(&repeated.all, "repeated_data");
    let ended = repeated.all.no_acknowledgement;
    assert!((3 * ended..=3 * ended + 3).contains(&repeated.all.transmissions), "{:?}", repeated.all);
}

/// Two nodes that do not hear each other strobe the sink between them.
#[test]
fn packets_whose_strobes_collide_are_lost_to_collisions() {
    let rest = "duration_s = 60.0\nreception.overlap = {}\nchannel.max_range_m = 6.0\n\
                mac.sleep = { interval_s = 0.5, max_retries = 0, sinks = \"sleep\", wake_up.x_mac = {} }\n\
                traffic.saturated = { mpdu_octets = 50, acknowledged = true, start_spread_s = 0.0 }\n";
    let all = mac(&star(&[5.0, -5.0], rest)).all;
    assert_sums(&all, "hidden");
    assert!(all.lost_collision > 10 && all.lost_signal == 0, "{all:?}");
}

/// `n1` dies before the end of the warm-up: it has no part in means.
#[test]
fn nodes_that_died_in_the_warm_up_are_left_out_of_means() {
    let traffic = "traffic.poisson = { mpdu_octets = 60, rate_per_s = 0.5, acknowledged = true }\n";
    for table in ["tsch.schedule.minimal.slotframe = 11", "sleep = { interval_s = 0.25, wake_up.csl = {} }"] {
        let rest = |more: &str| format!("duration_s = 100.0\nwarm_up_s = 20.0\nmac.{table}\n{traffic}{more}");
        let dies = "faults.deaths = { names = [\"n1\"], from_s = 10.0, to_s = 10.0 }\n";
        let [alone, found] = [mac(&star(&[1.0], &rest(""))), mac(&star(&[1.0, 2.0], &rest(dies)))];
        let shares = |mac: &MacSummary| {
            let slots = mac.slots.as_ref().map(|slots| (slots.duty_cycle, slots.counted_nodes));
            let sleep = mac.sleep.as_ref().map(|sleep| (sleep.duty_cycle, sleep.counted_nodes));
            let (share, counted) = slots.or(sleep).expect("a duty cycle");
            (share.expect("a node that counts"), counted)
        };
        let ((alone, all), (share, counted)) = (shares(&alone), shares(&found));
        assert_eq!((all, counted), (None, Some(1)), "{table}");
        assert!((share / alone - 1.0).abs() < 0.05, "{table}: {share}, not {alone}");
        // Of no node there is no mean.
        let none = mac(&star(&[1.0], &rest(&dies.replace("n1", "n0"))));
        let shares = [none.slots.and_then(|slots| slots.duty_cycle), none.sleep.and_then(|sleep| sleep.duty_cycle)];
        assert_eq!(shares, [None; 2], "{table}");
    }
}

#[test]
fn the_probability_of_a_link_is_the_share_that_a_run_delivers() {
    // 40 dB of loss; a fifth of the frames is lost for other reasons.
    for (rest, tx_power_dbm, sensitivity_dbm) in [
        ("reception.ber = {}\n", -56.0, -110.0),
        ("reception.overlap = {}\nchannel.shadowing.sigma_db = 6.0\n", -50.0, -90.0),
    ] {
        let all = format!(
            "duration_s = 4000.0\n{rest}radio.noise_floor_dbm = -95.0\nmac.csma_unslotted.rx_on_when_idle = true\n\
             traffic.periodic = {{ mpdu_octets = 40, interval_s = 1.0 }}\nfaults.message_loss = 0.2\n"
        );
        let scenario = star(&[1.0], &all).with("radio.tx_power_dbm", tx_power_dbm).expect("a power");
        let scenario = scenario.with("radio.sensitivity_dbm", sensitivity_dbm).expect("a sensitivity");
        let report = explain_link(&scenario, "n0", "sink", None).expect("a link");
        let text = report.to_string();
        assert!(text.contains("a further 20.0 % of the frames (`faults.message_loss`)"), "{text}");
        let reception = &report.directions.expect("a link")[0].reception;
        let expected = match rest.contains("shadowing") {
            true => reception.probability_over_shadowing,
            false => reception.probability,
        };
        let prr = mac(&scenario).all.prr.expect("packets");
        assert!(expected > 0.05 && expected < 0.79, "{expected}");
        // Four standard errors of 4000 packets, at most.
        assert!((prr - expected).abs() < 0.032, "{prr}, not {expected}: {rest}");
    }
}

/// `far` is out of everybody's reach, and `dead` dies before its first packet: the one is in the denominator, the other has none.
#[test]
fn a_node_that_nobody_hears_counts_and_one_that_died_before_its_first_packet_does_not() {
    let acknowledged = "{ mpdu_octets = 50, interval_s = 4.0, acknowledged = true }";
    let to_all = "{ mpdu_octets = 50, interval_s = 4.0 }";
    for (table, traffic) in [
        ("csma_unslotted = {}", acknowledged),
        ("csma_unslotted = {}", to_all),
        ("beacon_enabled = { beacon_order = 4, superframe_order = 3 }", acknowledged),
        ("tsch.schedule.minimal.slotframe = 5", acknowledged),
        ("tsch.schedule.minimal.slotframe = 5", to_all),
        ("sleep = { interval_s = 0.25, sinks = \"sleep\", wake_up.csl = {} }", acknowledged),
        ("sleep = { interval_s = 0.25, sinks = \"sleep\", wake_up.csl = {} }", to_all),
        ("sleep = { interval_s = 0.25, sinks = \"sleep\", wake_up.x_mac = {} }", acknowledged),
        ("sleep = { interval_s = 0.25, sinks = \"sleep\", wake_up.repeated_data = {} }", to_all),
    ] {
        let rest = format!(
            "duration_s = 200.0\nchannel.max_range_m = 50.0\nmac.{table}\ntraffic.periodic = {traffic}\n\
             faults.deaths = {{ names = [\"n2\"], from_s = 1e-6, to_s = 1e-6 }}\n"
        );
        let mut traced = Traced::default();
        let run = sextant::run(&star(&[1.0, 1e4, 2.0], &rest), &mut traced, &Unwatched).expect("a run");
        let mac = run.summary().mac.as_ref().expect("sinks");
        let [near, far, dead] = &mac.nodes[..] else { panic!("three nodes") };
        assert_sums(&mac.all, &rest);
        assert_eq!((dead.traffic.offered, dead.traffic.prr), (0, None), "{rest}");
        assert!(
            far.traffic.offered >= 49 && far.traffic.pending <= 1 && far.traffic.prr == Some(0.0),
            "{rest}: {far:?}"
        );
        let offered = near.traffic.offered + far.traffic.offered;
        assert_eq!((mac.all.offered, mac.all.died), (offered, 0), "{rest}");
        let over = (offered - near.traffic.pending - far.traffic.pending) as f64;
        assert_eq!(mac.all.prr, Some(near.traffic.delivered as f64 / over), "{rest}");
        assert!(near.traffic.prr > Some(0.9), "{rest}: {near:?}");
        assert_eq!((traced.offered, traced.received, traced.died), (offered, near.traffic.delivered, 0), "{rest}");
        let mut printed = Vec::new();
        sextant::summary::write(run.summary(), &mut printed).expect("memory");
        let printed = String::from_utf8(printed).expect("a text");
        let share = format!("{:.2} %", 100.0 * mac.all.prr.expect("a share"));
        assert!(printed.contains(&share) && printed.contains("1 node died, and offered no packets from then on: n2"));
    }
}

/// Sends a packet each second without looking at the channel.
struct Aloha(Option<FrameId>);

impl Application for Aloha {
    fn started(&mut self, port: &mut Port<'_>) {
        port.after(Duration::from_secs(1), Timer(0));
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        let mut radio = port.radio(NetworkId(0)).expect("a program commands the radio");
        self.0 = radio.offer(Destination::All, 9).ok();
        let frame = RadioFrame { to: Destination::All, payload: b"a reading", acknowledged: false, packet: self.0 };
        radio.transmit(frame).expect("the radio is free");
        port.after(Duration::from_secs(1), Timer(0));
    }

    fn radio(&mut self, network: NetworkId, event: &RadioEvent<'_>, port: &mut Port<'_>) {
        if let (RadioEvent::Sent { .. }, Some(packet)) = (event, self.0.take()) {
            let _ = port.radio(network).and_then(|mut radio| radio.done(packet, SendOutcome::Sent));
        }
    }
}

/// The same for nodes whose programs command their radios.
#[test]
fn packets_of_programs_that_nobody_hears_count_too() {
    let rest = "duration_s = 100.5\nchannel.max_range_m = 50.0\nmac.program = {}\n\
                faults.deaths = { names = [\"n2\"], from_s = 0.5, to_s = 0.5 }\n";
    let scenario = star(&[1.0, 1e4, 2.0], rest);
    let programs = ["n0", "n1", "n2"]
        .into_iter()
        .fold(Programs::default(), |programs, node| programs.with_node(node, Box::new(Aloha(None))));
    let mut traced = Traced::default();
    let run = sextant::run_with(&scenario, programs, &mut traced, &Unwatched).expect("a run");
    let mac = run.summary().mac.as_ref().expect("sinks");
    assert_sums(&mac.all, rest);
    let of = |node: usize| (mac.nodes[node].traffic.offered, mac.nodes[node].traffic.prr);
    assert_eq!([of(0), of(1), of(2)], [(100, Some(1.0)), (100, Some(0.0)), (0, None)]);
    assert_eq!((mac.all.offered, mac.all.prr, mac.all.out_of_range), (200, Some(0.5), 100));
    assert_eq!((traced.offered, traced.received), (200, 100));
}

fn warned(scenario: &Scenario) -> Vec<String> {
    sextant::forecast::warnings(scenario).iter().map(ToString::to_string).collect()
}

fn assert_warned(scenario: &Scenario, parts: &[&str]) {
    let found = warned(scenario);
    assert!(found.iter().any(|warning| parts.iter().all(|part| warning.contains(part))), "{parts:?}: {found:#?}");
}

#[test]
fn a_named_chip_that_is_too_weak_is_a_warning() {
    let scenario = |energy: &str, power_dbm: f64| {
        let rest = format!(
            "duration_s = 9.0\n{energy}traffic.periodic.interval_s = 1.0\n\
             radio.groups = [{{ nodes.names = [\"n0\"], tx_power_dbm = {power_dbm:.1} }}]\n"
        );
        star(&[1.0, 2.0], &rest)
    };
    let parts = ["energy", "`cc2420` sends with at most 0 dBm", "taken for 3 dBm"];
    assert_warned(&scenario("energy.cc2420 = {}\n", 3.0), &parts);
    assert_eq!(warned(&scenario("energy.cc2420 = {}\n", -3.0)), [""; 0]);
    // Nobody has named it.
    assert_eq!(warned(&scenario("", 3.0)), [""; 0]);
}

#[test]
fn cells_that_lead_nowhere_are_a_warning() {
    let scenario = |cells: &[[&str; 4]], to: &str| {
        let cell = |[node, peer, slot, options]: &[&str; 4]| {
            format!("{{ node = \"{node}\", peer = \"{peer}\", timeslot = {slot}, options = \"{options}\" }}")
        };
        let cells: Vec<String> = cells.iter().map(cell).collect();
        let rest = format!(
            "duration_s = 9.0\ntraffic.periodic = {{ mpdu_octets = 40, interval_s = 1.0, acknowledged = {to} }}\n\
             [mac.tsch.schedule.own]\nslotframe = 11\ncells = [{}]\n",
            cells.join(", ")
        );
        star(&[1.0, 2.0], &rest)
    };
    let good = [["n0", "sink", "1", "transmit"], ["n1", "sink", "2", "transmit"], ["sink", "n0", "1", "receive"]];
    let key = "mac.tsch.schedule.own";
    assert_warned(&scenario(&good[..2], "true"), &[key, "`n0` (and 1 node more) has cells in which nobody listens"]);
    assert_warned(&scenario(&good, "true"), &[key, "`n1` has cells in which nobody listens"]);
    assert_warned(&scenario(&[good[0], good[2]], "true"), &[key, "`n1` has no cell in which its packets may go"]);
    let all = [&good[..], &[["sink", "n1", "2", "receive"]]].concat();
    assert!(!warned(&scenario(&all, "true")).iter().any(|warning| warning.contains(key)));
    // Packets to all need cells to all.
    assert_warned(&scenario(&all, "false"), &[key, "`n0` (and 1 node more) has no cell"]);
    let shared = [["*", "*", "0", "transmit receive shared"]];
    assert!(!warned(&scenario(&shared, "false")).iter().any(|warning| warning.contains(key)));
}

#[test]
fn packets_that_are_due_after_the_end_are_a_warning() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("t.csv"), "t_s,node,mpdu_octets\n1,n0,30\n9,n0,30\n12,n1,30\n")
        .expect("a file");
    let traced = star(&[1.0, 2.0], "duration_s = 9.0\ntraffic.silent = {}\n");
    let path = format!("{:?}", folder.path().join("t.csv"));
    let traced = traced.with("traffic", format!("{{ trace.file = {path} }}")).expect("a table");
    assert_warned(
        &traced,
        &["traffic.trace", "2 of 3 packets of the table are due after the end of the run, at 9 s"],
    );
    let once = |at_s: f64| {
        star(&[1.0], &format!("duration_s = 9.0\ntraffic.once = {{ mpdu_octets = 30, at_s = {at_s:.1} }}\n"))
    };
    assert_warned(&once(9.5), &["traffic.once", "`n0` has its first packet after the end of the run"]);
    assert_eq!(warned(&once(8.5)), [""; 0]);
}

#[test]
fn packets_that_are_all_due_in_the_warm_up_are_a_warning() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("t.csv"), "t_s,node,mpdu_octets\n1,n0,30\n1,n1,30\n6,n1,30\n9,n0,30\n")
        .expect("a file");
    let path = format!("{:?}", folder.path().join("t.csv"));
    let timed = |duration_s: f64, traffic: &str| {
        let rest = format!("duration_s = {duration_s:?}\nwarm_up_s = 5.0\ntraffic.{traffic}\n");
        star(&[1.0, 2.0], &rest)
    };
    let once = |at_s: f64| timed(9.0, &format!("once = {{ mpdu_octets = 30, at_s = {at_s:.1} }}"));
    let poisson = |rate_per_s: f64| timed(5.01, &format!("poisson.rate_per_s = {rate_per_s}"));
    let between = "has no packet between the end of the warm-up, at 5 s, and that of the run, at";
    assert_warned(&once(4.5), &["traffic.once", "`n0` (and 1 node more)", between, "nothing of it counts"]);
    assert!(warned(&poisson(0.9)).iter().any(|warning| warning.contains(between)), "{:?}", warned(&poisson(0.9)));
    for fine in [once(5.0), once(8.5), poisson(9000.0), timed(5.01, "saturated = { mpdu_octets = 30 }")] {
        assert_eq!(warned(&fine), [""; 0]);
    }
    let listed = timed(9.0, "silent = {}").with("traffic", format!("{{ trace.file = {path} }}")).expect("a table");
    let of_nodes =
        |found: Vec<String>| found.into_iter().filter(|warning| warning.contains(between)).collect::<Vec<_>>();
    let found = of_nodes(warned(&listed));
    assert!(found.len() == 1 && found[0].contains("`n0` has no packet"), "{found:?}");
    // The run says so too, where none counts, and not where the traffic is meant to be silent.
    let note = "no node had a packet after the warm-up of 5 s, so nothing is measured of its traffic";
    let empty = summary(&once(4.5));
    assert_eq!(empty.notes, [note]);
    let mut printed = Vec::new();
    sextant::summary::write(&empty, &mut printed).expect("memory");
    assert!(String::from_utf8(printed).expect("a text").contains(&format!("warning: {note}")));
    for fine in [once(8.5), timed(9.0, "silent = {}")] {
        assert_eq!(summary(&fine).notes, [""; 0]);
    }
    let late = star(&[1.0], "duration_s = 9.0\ntraffic.once = { mpdu_octets = 30, at_s = 9.5 }\n");
    assert_eq!(summary(&late).notes, ["no node had a packet, so nothing is measured of its traffic"]);
}

/// A MAC without a queue often refuses beacons: those never go out.
#[test]
fn beacons_that_the_mac_refused_do_not_count() {
    #[derive(Default)]
    struct Beacons {
        taken: u64,
        refused: u64,
    }
    impl Observer for Beacons {
        fn traced(&mut self, packet: &PacketTrace) {
            if packet.to == Destination::All {
                *if packet.end == PacketEnd::QueueFull { &mut self.refused } else { &mut self.taken } += 1;
            }
        }

        fn wants_packets(&self) -> bool {
            true
        }
    }
    impl sextant::RunObserver for Beacons {}
    let rest = "duration_s = 60.0\nmac.csma_unslotted = { rx_on_when_idle = true, queue_frames = 0 }\n\
                routing.tree.collection = { beacon_max_s = 1.0 }\n\
                traffic.periodic = { mpdu_octets = 100, interval_s = 0.03 }\n";
    let mut beacons = Beacons::default();
    let run = sextant::run(&star(&[1.0, 2.0], rest), &mut beacons, &Unwatched).expect("a run");
    let told = run.summary().routing.as_ref().expect("hops").beacons;
    assert!(beacons.refused > 5, "{} refused", beacons.refused);
    assert_eq!(told, beacons.taken);
}
