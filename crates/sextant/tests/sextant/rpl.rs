//! RPL and packets in fragments, end to end: ways up, down and from node to node, deaths, loops, full tables, and shares of
//! fragments against closed forms.

use std::path::Path;

use sextant::summary::RoutingSummary;
use sextant::{Scenario, Unwatched};

use crate::linked;
use crate::programs::shipped;
use crate::routing::{chain, network, routing};

/// Nodes `n0`, `n1`, .. in a chain to the sink without losses. All have packets, and ten minutes pass before they count.
fn talking_chain(folder: &Path, nodes: usize, rest: &str) -> RoutingSummary {
    let talk = r#"
duration_s = 6600.0
warm_up_s = 600.0
mac.csma_unslotted = { rx_on_when_idle = true, max_retries = 3 }
traffic.periodic = { mpdu_octets = 60, interval_s = 10.0, jitter = 0.5 }
"#;
    routing(&linked::chain(folder, nodes, [1.0, 1.0], &format!("{talk}{rest}")))
}

fn nearly_all(delivered: u64, offered: u64) -> bool {
    delivered <= offered && offered - delivered <= offered / 100
}

#[test]
fn requests_and_answers_arrive_in_both_modes_over_as_many_hops() {
    let folder = tempfile::tempdir().expect("a folder");
    for mode in ["non_storing", "storing"] {
        let rest = format!("[routing]\nto = \"sink_and_back\"\ntree.rpl.mode = \"{mode}\"\n");
        let found = talking_chain(folder.path(), 4, &rest);
        let answers = found.answers.expect("the sink answers");
        assert!(nearly_all(found.delivered, found.offered) && nearly_all(answers.delivered, answers.offered));
        let (there, back) = (found.hops.expect("some arrived"), answers.hops.expect("some arrived"));
        assert_eq!((there.max, back.max, found.no_route, found.loops), (4, 4, Some(0), 0), "{mode}");
        assert!((there.mean - 2.5).abs() < 0.02 && (back.mean - 2.5).abs() < 0.02, "{there:?} {back:?}");
        let rpl = found.rpl.expect("a tree of RPL");
        let routes = rpl.routes_known_s.expect("the sink knows all ways");
        assert!(routes < 360.0 && rpl.most_routes == 4, "{mode}: {rpl:?}");
        assert_eq!((rpl.mode, rpl.local_repairs, rpl.full_tables), (mode, 0, 0));
    }
}

/// In a chain of three, packets to a node nearer to the sink are where they should be on their way up, after 1, 2 and 1 hops; the
/// others turn at the sink, after 5, 4 and 3: 16/6 on average. If stations know those below them, they turn at the first that is
/// above both: the hops are the distance, 4/3 on average.
#[test]
fn packets_to_nodes_turn_at_the_sink_or_at_the_first_common_ancestor() {
    let folder = tempfile::tempdir().expect("a folder");
    for (mode, mean, most) in [("non_storing", 16.0 / 6.0, 5), ("storing", 4.0 / 3.0, 2)] {
        let rest = format!("[routing]\nto = \"nodes\"\ntree.rpl.mode = \"{mode}\"\n");
        let found = talking_chain(folder.path(), 3, &rest);
        let hops = found.hops.expect("some arrived");
        assert!(nearly_all(found.delivered, found.offered), "{mode}: {found:?}");
        // The hops of 1800 packets have a standard deviation of 1.5 at most: four standard errors.
        assert!((hops.mean - mean).abs() < 0.14 && hops.max == most, "{mode}: {hops:?}");
        assert_eq!((found.no_route, found.loops), (Some(0), 0), "{mode}");
    }
}

#[test]
fn without_ways_down_no_node_registers() {
    let folder = tempfile::tempdir().expect("a folder");
    let found = talking_chain(folder.path(), 3, "[routing.tree.rpl]\nmode = \"none\"\n");
    let rpl = found.rpl.expect("a tree of RPL");
    assert_eq!((rpl.dao, rpl.dao_ack, rpl.routes_known_s, rpl.most_routes), (0, 0, None, 0));
    assert!(nearly_all(found.delivered, found.offered) && rpl.dio > 0);
}

/// The node next to the sink has room for one of the two nodes below it, and the sink for all.
#[test]
fn a_full_table_is_counted_and_who_finds_no_room_gets_no_answers() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = "[routing]\nto = \"sink_and_back\"\ntree.rpl = { mode = \"storing\", route_table = 1 }\n";
    let found = talking_chain(folder.path(), 2, rest);
    let rpl = found.rpl.expect("a tree of RPL");
    assert!(rpl.full_tables > 0 && rpl.most_routes == 1 && rpl.routes_known_s.is_none(), "{rpl:?}");
    assert!(nearly_all(found.delivered, found.offered), "packets go up without a way down");
    let answers = found.answers.expect("the sink answers");
    let no_route = found.no_route.expect("packets go down");
    assert!(no_route.abs_diff(answers.offered / 2) < 10 && nearly_all(answers.delivered + no_route, answers.offered));
}

/// `n0` reaches the sink directly over a link that loses frames, or by `n1` without losses. With half of the frames lost the
/// direct link takes two transmissions, and the least rank takes it. With 65 % lost two hops take fewer transmissions.
#[test]
fn objective_functions_choose_hops_or_transmissions() {
    let folder = tempfile::tempdir().expect("a folder");
    let mean_hops = |share: f64, objective: &str| {
        let relay = [("n0", "n1"), ("n1", "n0"), ("n1", "sink"), ("sink", "n1")].map(|(a, b)| (a, b, 1.0));
        let links = [&[("n0", "sink", share), ("sink", "n0", 1.0)][..], &relay].concat();
        let rest = format!(
            "max_retries = 7\n[routing.tree.rpl]\nmode = \"none\"\nmin_hop_rank_increase = 128\nobjective.{objective}\n"
        );
        routing(&network(folder.path(), 2, &links, &rest)).hops.expect("some arrived").mean
    };
    let (of0, mrhof) = (mean_hops(0.5, "of0 = {}"), mean_hops(0.35, "mrhof.hysteresis = 0"));
    assert!(of0 < 1.3 && mrhof > 1.8, "{of0} and {mrhof}");
}

/// Stations at these places, which hear each other within 25 m. `n0` has a packet each half second.
fn places(folder: &Path, places: &[[f64; 2]], rest: &str) -> RoutingSummary {
    let text = format!(
        r#"
name = "places"
duration_s = 4000.0
world.nodes.explicit.positions_m = {places:?}
radio = {{ tx_power_dbm = 0.0, sensitivity_dbm = -90.0 }}
channel.max_range_m = 25.0
channel.path_loss.log_distance = {{ exponent = 3.0, reference_loss_db = 40.0 }}
mac.csma_unslotted = {{ rx_on_when_idle = true, max_retries = 7 }}
[[sinks]]
name = "sink"
position_m = [0.0, 0.0]
[[traffic.groups]]
name = "origin"
nodes.names = ["n0"]
traffic.periodic = {{ mpdu_octets = 50, interval_s = 0.5, jitter = 0.3 }}
[routing]
resends = 0
{rest}
"#
    );
    std::fs::write(folder.join("scenario.toml"), text).expect("a file");
    routing(&Scenario::load(folder.join("scenario.toml")).expect("a scenario"))
}

/// `n0` reaches the sink by `n1` or by `n2`. The one that it uses dies in the middle of the run.
#[test]
fn a_tree_heals_after_the_death_of_a_parent() {
    let folder = tempfile::tempdir().expect("a folder");
    let diamond = [[40.0, 0.0], [20.0, 10.0], [20.0, -10.0]];
    for mode in ["non_storing", "storing"] {
        let tree = format!("tree.rpl.mode = \"{mode}\"\n");
        let first = places(folder.path(), &diamond, &tree);
        assert_eq!(first.rpl.as_ref().and_then(|rpl| rpl.healing), None);
        let first = first.nodes[0].parent.clone().expect("a parent");
        let other = if first == "n1" { "n2" } else { "n1" };
        let dies = format!("{tree}[faults.deaths]\nnames = [\"{first}\"]\nfrom_s = 2000.0\nto_s = 2001.0\n");
        let healed = places(folder.path(), &diamond, &dies);
        assert_eq!(places(folder.path(), &diamond, &dies), healed, "the same scenario and seed");
        assert_eq!((healed.nodes[0].parent.as_deref(), healed.nodes[0].parent_changes), (Some(other), 1), "{mode}");
        let healing = healed.rpl.and_then(|rpl| rpl.healing).expect("a node lost its parent");
        assert_eq!((healing.orphans, healing.healed), (1, 1));
        // Three packets without an acknowledgement are enough, and one comes each half second.
        assert!(healing.max_s.expect("a time") < 3.0, "{mode}: {healing:?}");
        assert!(healed.delivery.expect("packets") > 0.995, "{mode}: {:?}", healed.delivery);
    }
}

/// The node next to the sink in a chain dies. The one behind it takes its own child as its parent, because it has no other one.
/// Their packets go to and fro until ranks say so. Then all take their ranks back, and ask for others.
#[test]
fn a_loop_is_found_by_ranks_and_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let row = [[60.0, 0.0], [40.0, 0.0], [20.0, 0.0]];
    let dies = "tree.rpl = {}\n[faults.deaths]\nnames = [\"n2\"]\nfrom_s = 2000.0\nto_s = 2001.0\n";
    let found = places(folder.path(), &row, dies);
    let rpl = found.rpl.as_ref().expect("a tree of RPL");
    assert!(rpl.rank_errors > 0 && rpl.rank_error_drops == 0, "{rpl:?}");
    assert_eq!(found.without_way, 2, "the two beyond the dead node");
    // Two nodes ask each 30 s. 4000 packets come after the death, and few of them go round: those that meet the loop while it is new.
    assert!(rpl.dis > 100 && found.loops < 400 && found.hop_limit_drops < 5, "{found:?}");
}

/// `n0` reaches the sink by `n1` alone, whose link to the sink is gone for 500 s, so that `n1` takes `n0` as its parent. A packet that
/// meets a wrong rank twice is sent on, or dropped.
#[test]
fn a_packet_that_meets_a_wrong_rank_twice_is_sent_on_or_dropped() {
    let folder = tempfile::tempdir().expect("a folder");
    let found = |policy: &str| {
        let both = [("n0", "n1", 1.0), ("n1", "n0", 1.0), ("n1", "sink", 1.0), ("sink", "n1", 1.0)];
        let rest = format!("[routing]\ntree.rpl.rank_errors = \"{policy}\"\n");
        network(folder.path(), 2, &both, &rest);
        let mut rows = std::fs::read_to_string(folder.path().join("links.csv")).expect("a file");
        rows += "2000,n1,sink,0\n2000,sink,n1,0\n2500,n1,sink,1\n2500,sink,n1,1\n";
        std::fs::write(folder.path().join("links.csv"), rows).expect("a file");
        routing(&Scenario::load(folder.path().join("scenario.toml")).expect("a scenario"))
    };
    let (forward, drop) = (found("forward"), found("drop"));
    let rpl = |found: &RoutingSummary| found.rpl.clone().expect("a tree of RPL");
    assert!(rpl(&forward).rank_errors > 0 && rpl(&forward).rank_error_drops == 0, "{:?}", rpl(&forward));
    assert!(rpl(&drop).rank_error_drops > 0 && drop.loops < forward.loops, "{:?}", rpl(&drop));
}

/// A packet of 200 octets goes in two fragments and one of 400 in four, because a frame has room for 116. It arrives if all of
/// them do.
#[test]
fn a_packet_in_fragments_arrives_if_all_of_them_do() {
    let folder = tempfile::tempdir().expect("a folder");
    for (tree, octets, pieces) in [
        ("shortest = {}", 200, 2),
        ("shortest = {}", 400, 4),
        ("collection = {}", 200, 2),
        ("rpl = { mode = \"none\", objective.mrhof.max_link_metric = 1280 }", 200, 2),
    ] {
        let rest = format!(
            "max_retries = 0\n[routing]\nresends = 0\nusable_prr = 0.1\nfragments = {{ packet_octets = {octets}, \
             reassembly_s = 1.0, reassembly_buffers = 20 }}\ntree.{tree}\n"
        );
        let found = routing(&chain(folder.path(), 1, 0.85, 1.0, &rest));
        let delivery = 0.85_f64.powi(pieces);
        let n = found.offered as f64;
        let error = 5.0 * (delivery * (1.0 - delivery) / n).sqrt();
        let share = found.delivered as f64 / n;
        assert!((share - delivery).abs() < error, "{tree}: {share}, not {delivery} +- {error}");
        let fragments = found.fragments.expect("fragments");
        // The sender stops after the first one that is lost: the receiver waits in vain unless that is the first.
        let failures = (0.85 - delivery) * n;
        let failed = fragments.reassembly_failures as f64;
        assert!((failed - failures).abs() < 0.15 * failures, "{tree}: {failed} failures, not {failures}");
    }
}

/// Each fragment has its own tries on each hop: over h hops a packet of k fragments arrives with (1 - (1 - p)^(R + 1))^(h k).
#[test]
fn each_fragment_has_its_own_tries_on_each_hop() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = "max_retries = 1\n[routing]\nresends = 0\nusable_prr = 0.1\nfragments = { packet_octets = 400, \
        reassembly_s = 1.0, reassembly_buffers = 20 }\ntree.shortest = {}\n";
    let found = routing(&chain(folder.path(), 2, 0.8, 1.0, rest));
    let delivery = (1.0 - 0.2_f64.powi(2)).powi(2 * 4);
    let n = found.offered as f64;
    let (share, error) = (found.delivered as f64 / n, 5.0 * (delivery * (1.0 - delivery) / n).sqrt());
    assert!((share - delivery).abs() < error, "{share}, not {delivery} +- {error}");
}

/// Three hundred nodes within 71 m of a sink register with it. Messages in loops are not copied, so the network comes to rest.
#[test]
fn a_dense_network_registers_and_comes_to_rest() {
    let settings = [
        "sweep={}",
        "duration_s=1200.0",
        "world.nodes.random.count=300",
        "world.nodes.random.region.disc.radius_m=71.0",
        "channel.shadowing={ sigma_db = 3.0, correlation = { per_link = {} } }",
        "routing.tree={ rpl = {} }",
    ]
    .map(str::to_owned);
    let found = routing(&shipped("routing/collection-tree.toml").with_all(&settings, None).expect("a scenario"));
    let rpl = found.rpl.expect("a tree of RPL");
    assert!(nearly_all(found.delivered, found.offered) && found.without_way == 0, "{:?}", found.delivery);
    assert!(rpl.dao < 3 * 300 * 5 && rpl.most_routes == 300, "{rpl:?}");
}

/// The MAC of a saturated node has no room for DIOs: those that it refuses are not counted.
#[test]
fn messages_that_the_mac_refuses_are_not_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = "[routing]\nresends = 0\ntree.rpl = { mode = \"none\", dio_min_s = 0.1, dio_doublings = 0 }\n";
    let set = ["duration_s=60.0", "traffic={ saturated = { mpdu_octets = 50 } }"].map(str::to_owned);
    let scenario = chain(folder.path(), 1, 1.0, 1.0, rest).with_all(&set, None).expect("a scenario");
    let run = sextant::run(&scenario, &mut (), &Unwatched).expect("a run");
    let packets = &run.survey().expect("a simulation").networks[0].packets;
    let refused: u64 = packets.iter().map(|packets| packets.lost_queue).sum();
    let taken = packets.iter().map(|packets| packets.offered).sum::<u64>() - refused;
    let found = run.summary().routing.clone().expect("routing");
    let rpl = found.rpl.as_ref().expect("a tree of RPL");
    let counted = found.delivered + rpl.dio + rpl.unicast_dio + rpl.dis;
    // One packet may be under way at the end.
    assert!(refused > 100 && taken.abs_diff(counted) <= 1, "{refused} refused, {taken} taken: {found:?}");
}

#[test]
fn a_table_that_is_too_small_for_the_sink_is_a_warning() {
    let warned = |table: &str| {
        let set = [format!("routing.tree.rpl.route_table={table}"), "sweep={}".to_owned()];
        let scenario = shipped("routing/rpl-node-to-node.toml").with_all(&set, None).expect("a scenario");
        let found = sextant::forecast::warnings(&scenario).into_iter();
        found.map(|warning| warning.to_string()).find(|warning| warning.contains("route_table"))
    };
    assert_eq!(warned("40"), None);
    let warning = warned("39").expect("a warning");
    assert!(warning.contains("39 of 40 nodes") && warning.contains("at least 40"), "{warning}");
}

#[test]
fn settings_that_do_not_fit_are_refused_with_their_key_and_what_is_allowed() {
    let good = shipped("routing/collection-tree.toml");
    let message = |set: &[&str]| {
        let set: Vec<String> = ["sweep={}"].iter().chain(set).map(|&set| set.to_owned()).collect();
        good.with_all(&set, None).err().expect("a mistake").to_string()
    };
    let rpl = |key: &str, value: &str| format!("routing.tree={{ rpl = {{ {key} = {value} }} }}");
    for (key, value, allowed) in [
        ("min_hop_rank_increase", "0", "1 to 4096"),
        ("dio_min_s", "0.0", "0.001 to 1000"),
        ("dio_doublings", "21", "0 to 20"),
        ("dis_interval_s", "0.0", "1 to 100000"),
        ("dao_delay_s", "0.0", "0.1 to 1000"),
        ("dao_tries", "101", "0 to 100"),
        ("dao_retry_s", "0.0", "0.1 to 1000"),
        ("route_lifetime_min", "2", "3 to 254"),
        ("probing_interval_s", "0.5", "0, or 1 to 100000"),
        ("route_table", "0", "1 to 65535"),
        ("objective.mrhof.hysteresis", "40000", "0 to 32768"),
        ("objective.mrhof.hysteresis_time_s", "-1.0", "0 to 100000"),
        ("objective.mrhof.max_link_metric", "100", "128 to 1280"),
        ("objective.mrhof.max_path_cost", "255", "256 to 65000"),
        ("mode", "\"some\"", "unknown choice `some`"),
        ("rank_errors", "\"ignore\"", "unknown choice `ignore`"),
    ] {
        let found = message(&[&rpl(key, value)]);
        assert!(found.contains(&format!("routing.tree.rpl.{key}")) && found.contains(allowed), "{key}: {found}");
    }
    let tree = rpl("mode", "\"non_storing\"");
    for (set, parts) in [
        (&[&*tree, "traffic.periodic.mpdu_octets=34"][..], ["traffic.periodic.mpdu_octets", "at least 35"]),
        (&[&rpl("mode", "\"none\""), "routing.to=\"nodes\""], ["routing.tree.rpl.mode", "non_storing"]),
        (&["routing.fragments={ packet_octets = 39 }"], ["routing.fragments.packet_octets", "40 to 1280"]),
        (
            &["routing.fragments={ packet_octets = 200, reassembly_s = 0.0 }"],
            ["routing.fragments.reassembly_s", "0.1 to 60"],
        ),
        (
            &["routing.fragments={ packet_octets = 200, reassembly_buffers = 0 }"],
            ["routing.fragments.reassembly_buffers", "1 to 255"],
        ),
        (&[&*tree, "mac={ sleep = { interval_ms = 125.0, csl = {} } }"], ["mac.sleep", "another tree"]),
    ] {
        let found = message(set);
        for part in parts {
            assert!(found.contains(part), "{set:?}: {found}");
        }
    }
}

#[test]
fn keys_that_change_nothing_are_a_warning() {
    let good = shipped("routing/rpl-udp.toml");
    let messages = |set: &[&str]| {
        let set: Vec<String> = set.iter().map(|&set| set.to_owned()).collect();
        let warnings = sextant::forecast::warnings(&good.with_all(&set, None).expect("a scenario"));
        warnings.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    for (set, expected) in [
        (&["routing.tree.rpl.route_table=7"][..], "`routing.tree.rpl.route_table`: it changes nothing"),
        (
            &["routing.to=\"sink\"", "routing.tree.rpl.mode=\"none\"", "routing.tree.rpl.dao_tries=2"],
            "`routing.tree.rpl.dao_tries`: it changes nothing",
        ),
        (
            &["duration_s=100", "warm_up_s=0", "faults.deaths={share=0.1,from_s=200.0,to_s=300.0}"],
            "are due after the end of the run, at 100 s",
        ),
    ] {
        let found = messages(set);
        assert!(found.iter().any(|message| message.contains(expected)), "{set:?}: {found:?}");
    }
    let none = messages(&[]);
    assert!(
        !none.iter().any(|message| message.contains("changes nothing") || message.contains("faults")),
        "{none:?}"
    );
}
