//! Packets over several hops, end to end: delivery, transmissions and delays against closed forms, and trees against other
//! ways to work them out.

use std::path::Path;

use sextant::summary::RoutingSummary;
use sextant::{Scenario, Unwatched};

use crate::linked;
use crate::programs::shipped;

/// `n0` has packets; its tables of channel access end with `rest`.
const ORIGIN: &str = r#"
duration_s = 4000.0
[[traffic.groups]]
name = "origin"
nodes.names = ["n0"]
traffic.periodic = { mpdu_octets = 50, interval_s = 0.5, jitter = 0.3 }
[mac.csma_unslotted]
rx_on_when_idle = true
"#;

/// Nodes `n0`, `n1`, .. and a sink, whose links are `links` alone. `n0` has packets.
pub(crate) fn network(folder: &Path, nodes: usize, links: &[(&str, &str, f64)], rest: &str) -> Scenario {
    linked::network(folder, nodes, Some(links), &format!("{ORIGIN}{rest}"))
}

/// A chain from `n0` to the sink with so many hops, each of which loses the same shares of frames and of acknowledgements.
pub(crate) fn chain(folder: &Path, hops: usize, frames: f64, acknowledgements: f64, rest: &str) -> Scenario {
    linked::chain(folder, hops, [frames, acknowledgements], &format!("{ORIGIN}{rest}"))
}

pub(crate) fn routing(scenario: &Scenario) -> RoutingSummary {
    let run = sextant::run(scenario, &mut (), &Unwatched).expect("a run");
    run.summary().routing.clone().expect("routing")
}

const SHORTEST: &str = "[routing]\nresends = 0\nusable_prr = 0.1\ntree.shortest = {}\n";

/// When the frame of a relay begins on average (us after it received the packet), if its backoff starts at `start`: the radio
/// is not free while it turns around and acknowledges, until 192 + 352 us. An assessment before that finds it busy, and the
/// next backoff is longer.
fn mean_start_us(start: f64, exponent: i32) -> f64 {
    let periods = 1 << exponent;
    let after = |period: i32| {
        let assessed = start + 320.0 * f64::from(period);
        if assessed < 192.0 + 352.0 {
            mean_start_us(assessed + 128.0, (exponent + 1).min(5))
        } else {
            assessed + 128.0 + 192.0
        }
    };
    (0..periods).map(after).sum::<f64>() / f64::from(periods)
}

/// A first hop takes the mean backoff of 3.5 periods, an assessment, a turnaround and the frame. A relay has its packet at the
/// end of the frame, and its radio when it has acknowledged.
#[test]
fn a_chain_without_loss_delivers_all_in_the_sum_of_backoffs_and_airtimes() {
    let folder = tempfile::tempdir().expect("a folder");
    let airtime_us = f64::from(6 + 50) * 32.0;
    for hops in 1..=4_u8 {
        let found = routing(&chain(folder.path(), hops.into(), 1.0, 1.0, SHORTEST));
        assert_eq!((found.delivery, found.duplicates, found.loops), (Some(1.0), 0, 0));
        assert_eq!(found.hops.map(|hops| (hops.mean, hops.max)), Some((f64::from(hops), hops)));
        assert_eq!((found.stretch, found.transmissions_per_delivery), (Some(1.0), Some(f64::from(hops))));
        let of_first = 3.5 * 320.0 + 128.0 + 192.0 + airtime_us;
        let expected_s = 1e-6 * (of_first + f64::from(hops - 1) * (mean_start_us(0.0, 3) + airtime_us));
        // 8000 packets, whose hops have deviations of at most 1.4 ms: five standard errors.
        let error_s = 5.0 * 1.4e-3 * (f64::from(hops) / 8000.0).sqrt();
        let mean_s = found.delay_s.expect("delays").mean;
        assert!((mean_s - expected_s).abs() < error_s, "{hops} hops: {mean_s}, not {expected_s}");
    }
}

/// A hop brings a packet over with 1 - (1 - p)^(R + 1), where p is the share of frames that arrive. Its transmissions end with an
/// acknowledgement, so they are (1 - (1 - q)^(R + 1)) / q, where q is p times the share of acknowledgements that arrive.
#[test]
fn a_lossy_chain_delivers_what_the_closed_form_says() {
    let folder = tempfile::tempdir().expect("a folder");
    for (hops, frames, acknowledgements, retries) in [(3, 0.7_f64, 1.0_f64, 3), (2, 0.5, 0.5, 1), (4, 0.8, 0.9, 0)] {
        let rest = format!("max_retries = {retries}\n{SHORTEST}");
        let found = routing(&chain(folder.path(), hops, frames, acknowledgements, &rest));
        let over = 1.0 - (1.0 - frames).powi(retries + 1);
        let tried = i32::try_from(hops).expect("few hops");
        let delivery = over.powi(tried);
        let n = found.offered as f64;
        let error = 5.0 * (delivery * (1.0 - delivery) / n).sqrt();
        let share = found.delivered as f64 / n;
        assert!((share - delivery).abs() < error, "{share}, not {delivery} +- {error}");
        // Each hop sends what came so far.
        let q = frames * acknowledgements;
        let of_hop = (1.0 - (1.0 - q).powi(retries + 1)) / q;
        let expected: f64 = (0..tried).map(|hop| over.powi(hop) * of_hop).sum();
        let sent = found.transmissions as f64 / n;
        assert!((sent - expected).abs() < 0.03 * expected, "{sent}, not {expected}");
    }
}

/// With r resends of R retries each, a hop has (r + 1) (R + 1) tries. A packet whose acknowledgements are all lost is sent again
/// under a new sequence number: such copies are dropped, and counted.
#[test]
fn resends_bring_more_packets_and_their_copies_are_dropped() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = "max_retries = 0\n[routing]\nresends = 2\nusable_prr = 0.1\ntree.shortest = {}\n";
    let found = routing(&chain(folder.path(), 2, 0.6, 0.5, rest));
    let delivery = (1.0 - 0.4_f64.powi(3)).powi(2);
    let n = found.offered as f64;
    let share = found.delivered as f64 / n;
    assert!((share - delivery).abs() < 5.0 * (delivery * (1.0 - delivery) / n).sqrt(), "{share}, not {delivery}");
    // A copy arrives if a frame arrived without its acknowledgement and a later one arrives. By enumeration of three tries,
    // where a try is acknowledged with 0.3, arrives alone with 0.3, and is lost with 0.4: the mean number of arrivals less the
    // probability of one. Tries: 1 + 0.7 + 0.49, each of which arrives with 0.6.
    let of_hop = 0.6 * 2.19 - (1.0 - 0.4_f64.powi(3));
    let expected = of_hop * (1.0 + (1.0 - 0.4_f64.powi(3)));
    let copies = found.duplicates as f64 / n;
    assert!((copies - expected).abs() < 0.05 * expected, "{copies}, not {expected}");
}

/// A packet that finds its MAC busy with a beacon waits: it was not sent, so that this is no try. That ends, whatever the load.
#[test]
fn a_packet_that_finds_its_mac_busy_is_not_given_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = "[routing]\nresends = 0\ntree.collection = { beacon_max_s = 1.0 }\n";
    let found = routing(&chain(folder.path(), 1, 1.0, 1.0, rest));
    assert!(found.beacons > 4000 && found.given_up == 0, "{found:?}");
    assert_eq!(found.delivery, Some(1.0));
    let set = [
        "sweep={}",
        "duration_s=60.0",
        "warm_up_s=0.0",
        "routing.resends=0",
        "mac.tsch.queue_frames=1",
        "traffic={ saturated = {} }",
    ]
    .map(str::to_owned);
    let busy = routing(&shipped("tsch/msf-tree.toml").with_all(&set, None).expect("a scenario"));
    assert!(busy.offered > 0, "{busy:?}");
}

/// Direct 0.4 in each direction, two hops of 0.9: 1/0.16 = 6.25 transmissions against 2/0.81 = 2.47.
#[test]
fn the_shortest_way_has_fewest_hops_or_fewest_transmissions() {
    let folder = tempfile::tempdir().expect("a folder");
    let both = [("n0", "sink", 0.4), ("n0", "n1", 0.9), ("n1", "sink", 0.9)];
    let links: Vec<_> = both.into_iter().flat_map(|(a, b, share)| [(a, b, share), (b, a, share)]).collect();
    let parent = |tree: &str| {
        let rest = format!("[routing]\nusable_prr = 0.3\ntree.{tree}\n");
        let found = routing(&network(folder.path(), 2, &links, &rest));
        found.nodes[0].parent.clone().expect("a parent")
    };
    assert_eq!(parent("shortest.metric = \"hops\""), "sink");
    assert_eq!(parent("shortest.metric = \"etx\""), "n1");
    assert_eq!(parent("collection = {}"), "n1");
}

/// Links among ten nodes and the sink, by a rule that gives each its own share.
fn mesh() -> (Vec<String>, Vec<Vec<f64>>) {
    let names: Vec<String> = (0..10).map(|node| format!("n{node}")).chain(["sink".to_owned()]).collect();
    let count = names.len();
    let share = |a: usize, b: usize| {
        let (low, high) = (a.min(b), a.max(b));
        let mixed = (low * 7 + high * 13 + low * high * 5) % 17;
        let near = high - low <= 3;
        if near { 0.35 + 0.038 * mixed as f64 } else { 0.0 }
    };
    let shares = (0..count).map(|a| (0..count).map(|b| if a == b { 0.0 } else { share(a, b) }).collect()).collect();
    (names, shares)
}

/// The least transmissions from each station to the sink, by the algorithm of Floyd and Warshall.
fn least_etx(shares: &[Vec<f64>]) -> Vec<f64> {
    let count = shares.len();
    let mut etx: Vec<Vec<f64>> = shares
        .iter()
        .map(|row| row.iter().map(|&share| if share > 0.0 { 1.0 / (share * share) } else { f64::INFINITY }).collect())
        .collect();
    for over in 0..count {
        for a in 0..count {
            for b in 0..count {
                etx[a][b] = etx[a][b].min(etx[a][over] + etx[over][b]);
            }
        }
    }
    (0..count).map(|a| if a + 1 == count { 0.0 } else { etx[a][count - 1] }).collect()
}

/// Transmissions from each node to the sink along the parents of a result.
fn along_parents(found: &RoutingSummary, names: &[String], shares: &[Vec<f64>]) -> Vec<f64> {
    let parents: Vec<usize> = (found.nodes.iter())
        .map(|node| names.iter().position(|name| Some(name) == node.parent.as_ref()).expect("a parent"))
        .collect();
    let cost = |mut at: usize| {
        let mut sum = 0.0;
        while at < parents.len() {
            sum += 1.0 / shares[at][parents[at]].powi(2);
            at = parents[at];
        }
        sum
    };
    (0..parents.len()).map(cost).collect()
}

#[test]
fn trees_by_transmissions_are_as_short_as_floyd_and_warshall_say() {
    let folder = tempfile::tempdir().expect("a folder");
    let (names, shares) = mesh();
    let mut links = Vec::new();
    for (a, row) in shares.iter().enumerate() {
        for (b, &share) in row.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            links.push((&*names[a], &*names[b], share));
        }
    }
    let least = least_etx(&shares);
    let with = |tree: &str| {
        let rest = format!("[routing]\nusable_prr = 0.1\ntree.{tree}\n");
        let all = network(folder.path(), 10, &links, &rest);
        along_parents(&routing(&all), &names, &shares)
    };
    for (found, least) in with("shortest.metric = \"etx\"").iter().zip(&least) {
        assert!((found - least).abs() < 1e-9, "{found}, not {least}");
    }
    // Beacons estimate one direction alone, and a parent is kept: the tree that they build is near the best one.
    let built = with("collection.hysteresis_etx = 0.5");
    let (sum, best) = (built.iter().sum::<f64>(), least[..10].iter().sum::<f64>());
    assert!(sum >= best - 1e-9 && sum < 1.25 * best, "{sum} against {best}");
}

/// `n0` reaches the sink by `n1` or by `n2`. The one that it uses dies in the middle of the run.
#[test]
fn a_parent_that_dies_is_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let both = [("n0", "n1", 1.0), ("n1", "sink", 1.0), ("n0", "n2", 1.0), ("n2", "sink", 1.0)];
    let links: Vec<_> = both.into_iter().flat_map(|(a, b, share)| [(a, b, share), (b, a, share)]).collect();
    let found = |rest: &str| routing(&network(folder.path(), 3, &links, rest));
    let built = "[routing]\ntree.collection = {}\n";
    let first = found(built).nodes[0].parent.clone().expect("a parent");
    let other = if first == "n1" { "n2" } else { "n1" };
    let dies = format!("[faults.deaths]\nnames = [\"{first}\"]\nfrom_s = 2000.0\nto_s = 2001.0\n");
    let repaired = found(&format!("{built}{dies}"));
    assert_eq!(found(&format!("{built}{dies}")), repaired, "the same scenario and seed");
    assert_eq!(repaired.nodes[0].parent.as_deref(), Some(other));
    assert_eq!(repaired.nodes[0].parent_changes, 1);
    // What the queue of the dead node held is lost, and hardly anything else: 8000 packets.
    assert!(repaired.delivery.expect("packets") > 0.999, "{repaired:?}");
    // A tree that does not change loses the second half.
    let fixed = found(&format!("[routing]\nresends = 0\ntree.shortest = {{}}\n{}", dies.replace(&first, "n1")));
    assert!((fixed.delivery.expect("packets") - 0.5).abs() < 0.01, "{:?}", fixed.delivery);
}

#[test]
fn settings_that_do_not_fit_are_refused_with_their_key_and_what_is_allowed() {
    let good = shipped("routing/collection-tree.toml");
    let message = |set: &[&str]| {
        let set: Vec<String> = set.iter().map(|&set| set.to_owned()).collect();
        good.with_all(&set, None).err().expect("a mistake").to_string()
    };
    for (set, parts) in [
        (&["routing.queue_packets=0"][..], ["routing.queue_packets", "1 to 1000"]),
        (&["routing.usable_prr=0.0"], ["routing.usable_prr", "above 0, to 1"]),
        (&["routing.tree.collection.beacon_min_s=0.0"], ["routing.tree.collection.beacon_min_s", "0.01 to 100000"]),
        (&["routing.tree.collection.beacon_max_s=0.1"], ["routing.tree.collection.beacon_max_s", "0.128 to 1000000"]),
        (&["routing.tree.collection.hysteresis_etx=-1.0"], ["hysteresis_etx", "0 to 100"]),
        (&["routing.tree={ given = { file = \"none.csv\" } }"], ["routing.tree.given.file", "a text file"]),
        (&["routing.tree={ best = {} }"], ["unknown choice `best`", "routing.tree"]),
        (
            &["mac.csma_unslotted.rx_on_when_idle=false"],
            ["mac.csma_unslotted.rx_on_when_idle", "each hop is acknowledged"],
        ),
        (&["mac={ beacon_enabled = {} }"], ["mac.beacon_enabled", "`csma_unslotted`"]),
        (&["mac={ program = {} }"], ["mac.program", "`csma_unslotted`"]),
        (&["traffic.periodic.acknowledged=true"], ["traffic.periodic.acknowledged", "each hop is acknowledged"]),
        (&["traffic.periodic.mpdu_octets=19"], ["traffic.periodic.mpdu_octets", "at least 20"]),
        (&["routing.to=\"all\""], ["unknown choice `all`", "routing.to"]),
        (
            &["routing.to=\"nodes\"", "traffic.periodic.mpdu_octets=23"],
            ["traffic.periodic.mpdu_octets", "at least 24"],
        ),
        (&["routing.to=\"nodes\"", "world.nodes.random.count=1"], ["routing.to", "at least two nodes"]),
        (&["sinks=[]"], ["sinks", "at least one sink"]),
    ] {
        let message = message(set);
        for part in parts {
            assert!(message.contains(part), "{set:?}: {message}");
        }
    }
}

/// Nodes `n0`, `n1`, .. in a chain to the sink, each of which has a packet every ten seconds; these shares of the frames arrive
/// over each link up and down.
pub(crate) fn talking_chain(
    folder: &Path,
    nodes: usize,
    [up, down]: [f64; 2],
    duration_s: f64,
    to: &str,
) -> Scenario {
    let rest = format!(
        r#"
duration_s = {duration_s}
mac.csma_unslotted = {{ rx_on_when_idle = true, max_retries = 3 }}
traffic.periodic = {{ mpdu_octets = 50, interval_s = 10.0, jitter = 0.5 }}
routing = {{ to = "{to}", resends = 0, tree.shortest = {{}} }}
"#
    );
    linked::chain(folder, nodes, [up, down], &rest)
}

/// A hop up has four tries, so it brings the share `q = 1 - (1 - p)^4`, and of the requests over `h` hops `q^h` arrive. Each is
/// answered once, and nothing but acknowledgements is lost on the way down.
#[test]
fn each_request_that_arrives_is_answered_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let found = routing(&talking_chain(folder.path(), 3, [0.7, 1.0], 60_000.0, "sink_and_back"));
    let q = 1.0 - 0.3_f64.powi(4);
    let expected = (q + q.powi(2) + q.powi(3)) / 3.0;
    // Five standard errors, and 0.1 % for frames that overlap.
    let error = 5.0 * (expected * (1.0 - expected) / found.offered as f64).sqrt() + 0.001;
    let delivery = found.delivery.expect("packets");
    assert!((delivery - expected).abs() < error, "{delivery}, not {expected} by {error}");
    let answers = found.answers.expect("the sink answers");
    assert_eq!((answers.offered, found.to), (found.delivered, Some("sink_and_back")));
    assert!(answers.delivery.expect("answers") > 0.99, "{answers:?}");
}

/// Without losses all answers arrive, over as many hops as the requests.
#[test]
fn answers_go_back_the_way_of_the_request() {
    let folder = tempfile::tempdir().expect("a folder");
    let found = routing(&talking_chain(folder.path(), 3, [1.0; 2], 20_000.0, "sink_and_back"));
    let answers = found.answers.expect("the sink answers");
    let known = answers.offered - found.no_route.expect("packets go down");
    assert!(answers.offered - known < 10, "only until each node has told its parent");
    assert!(known - answers.pending - answers.delivered <= known / 200, "{answers:?}");
    let (there, back) = (found.hops.expect("some arrived"), answers.hops.expect("some arrived"));
    assert_eq!((there.max, back.max), (3, 3));
    assert!((there.mean - 2.0).abs() < 0.01 && (back.mean - 2.0).abs() < 0.01, "{there:?} {back:?}");
}

/// Node `i` of three is `3 - i` hops from the sink. A packet goes up, and down if it has not met its target: the six pairs have
/// 1, 2, 5, 1, 4 and 3 hops.
#[test]
fn packets_to_nodes_go_up_to_their_target_or_to_the_sink_and_down() {
    let folder = tempfile::tempdir().expect("a folder");
    let found = routing(&talking_chain(folder.path(), 3, [1.0; 2], 20_000.0, "nodes"));
    let no_route = found.no_route.expect("packets go down");
    assert!(no_route < 10, "{no_route}: only until each node has told its parent");
    assert!(found.offered - found.pending - found.delivered - no_route <= found.offered / 100, "{found:?}");
    let hops = found.hops.expect("some arrived");
    assert_eq!(hops.max, 5);
    // Over 6000 packets, the standard error is 0.019.
    assert!((hops.mean - 16.0 / 6.0).abs() < 0.1, "{hops:?}");
    assert_eq!((found.answers, found.stretch, found.loops), (None, None, 0));
}

/// All packets of `n0` meet their target `n1` after one hop. Up to the sink there are two hops that lose half of the frames, in four
/// tries each.
#[test]
fn a_packet_that_meets_its_target_on_the_way_up_is_delivered_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let shortest = talking_chain(folder.path(), 2, [0.5, 1.0], 20_000.0, "nodes");
    let built = shortest.with_all(&["routing.tree={ collection = {} }".to_owned()], None).expect("a scenario");
    for found in [routing(&shortest), routing(&built)] {
        let [first, second] = &found.nodes[..] else { panic!("{found:?}") };
        let expected = 1.0 - 0.5_f64.powi(4);
        // Four standard errors, and 0.1 % for frames that overlap or come before a parent is known. To the sink it is 0.879.
        let error = 4.0 * (expected * (1.0 - expected) / first.offered as f64).sqrt() + 0.001;
        let share = first.delivered as f64 / first.offered as f64;
        assert!((share - expected).abs() < error, "{share}, not {expected} by {error}");
        assert!(first.delay_s < second.delay_s, "{found:?}");
    }
}

/// A packet has one transmission where nothing is lost. More packets come than can be sent, so those of the warm-up are sent
/// after it, and do not count.
#[test]
fn transmissions_are_those_of_the_packets_that_count() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = "duration_s = 4.0\nwarm_up_s = 2.0\nmac.csma_unslotted.rx_on_when_idle = true\n\
                traffic.periodic = { mpdu_octets = 50, interval_s = 0.003 }\n\
                routing = { queue_packets = 1000, tree.shortest = {} }\n";
    let found = routing(&linked::chain(folder.path(), 1, [1.0; 2], rest));
    assert!(found.delivered > 20 && found.pending > 100, "{found:?}");
    // The last one may be on air at the end.
    assert!(found.transmissions - found.delivered <= 1, "{found:?}");
}

/// The frames of routing are those of the MAC, as there are neither beacons nor a warm-up: those of a packet that its station
/// still has at the end, or that died with it, and those of the sink.
#[test]
fn transmissions_on_all_hops_are_those_of_the_mac_of_nodes_and_sinks() {
    let folder = tempfile::tempdir().expect("a folder");
    let both = |scenario: &Scenario| {
        let run = sextant::run(scenario, &mut (), &Unwatched).expect("a run");
        let summary = run.summary();
        let mac = summary.mac.clone().expect("traffic");
        let of_sink = mac.sinks[0].sent.as_ref().map_or(0, |sent| sent.transmissions);
        (summary.routing.as_ref().expect("routing").transmissions, mac.all.transmissions, of_sink)
    };
    let dies = "[faults.deaths]\nnames = [\"n1\"]\nfrom_s = 2000.0\nto_s = 2001.0\n";
    let rest = format!("max_retries = 7\n{SHORTEST}{dies}");
    let (on_hops, of_nodes, of_sink) = both(&chain(folder.path(), 3, 0.3, 0.3, &rest));
    assert!(of_nodes > 10_000 && of_sink == 0, "{of_nodes}, {of_sink}");
    assert_eq!(on_hops, of_nodes);
    let answers = talking_chain(folder.path(), 3, [0.7, 0.7], 20_000.0, "sink_and_back");
    let (on_hops, of_nodes, of_sink) = both(&answers);
    assert!(of_sink > 1000, "{of_sink}");
    assert_eq!(on_hops, of_nodes + of_sink);
}
