//! Cells that stations agree on by MSF (RFC 9033).

use super::{assert_close, mac, network};

/// A node whose packets need c cells of each slotframe ends with so many that 25 to 75 % of them are used, or with one. From below it
/// gets the first such number; frames that wait by then may bring it one more.
#[test]
fn a_node_gets_as_many_cells_as_its_packets_need() {
    let folder = tempfile::tempdir().expect("a folder");
    for interval_s in [10.0, 1.5, 1.0, 0.5, 0.25] {
        let rest = format!(
            "duration_s = 6000.0
warm_up_s = 3000.0
traffic.periodic = {{ mpdu_octets = 50, interval_s = {interval_s}, jitter = 0.0, acknowledged = true }}
mac.tsch.schedule.msf = {{}}"
        );
        let mac = mac(&network(folder.path(), 1, None, &rest));
        let needed = (1.01_f64 / interval_s / 0.75).ceil();
        let negotiated = mac.slots.expect("slots").negotiated.expect("MSF");
        let of = format!("each {interval_s} s");
        let cells = negotiated.cells.expect("a node");
        assert!((needed..=needed + 1.0).contains(&cells), "{of}: {negotiated:?}, {needed} are needed");
        assert_close(negotiated.mean_cells, cells, 1e-9, &of);
        assert_eq!((negotiated.transactions, negotiated.failures), (0, 0), "{of}");
        assert_close(mac.all.prr.expect("packets"), 1.0, 1e-9, &of);
    }
}

/// Over links that lose frames and acknowledgements, transactions fail and schedules differ: nodes find it, and go on.
#[test]
fn nodes_with_bad_links_agree_again_and_deliver() {
    let folder = tempfile::tempdir().expect("a folder");
    let names: Vec<String> = (0..6).map(|node| format!("n{node}")).collect();
    let links: Vec<(&str, &str, f64)> =
        names.iter().flat_map(|node| [(&**node, "sink", 0.5), ("sink", &**node, 0.5)]).collect();
    let rest = "duration_s = 20000.0
traffic.periodic = { mpdu_octets = 50, interval_s = 1.0, jitter = 0.5, acknowledged = true }
mac.tsch = { max_retries = 3, schedule.msf = {} }";
    let mac = mac(&network(folder.path(), 6, Some(&links), rest));
    let negotiated = mac.slots.expect("slots").negotiated.expect("MSF");
    assert!(negotiated.failures > 5 && negotiated.failures < negotiated.transactions, "{negotiated:?}");
    // A frame needs (1 - (1 - q)^4) / q transmissions with q = 0.25, and there are 1.01 frames in a slotframe: 2.76 cells, which are
    // a quarter to three quarters of those that a node has, but for the start.
    assert!(negotiated.mean_cells > 3.0 && negotiated.mean_cells < 11.0, "{negotiated:?}");
    // A packet is lost if all of its transmissions are, 0.5^4. More are lost to full queues: at the start all nodes share one cell, and
    // those that begin again do so too.
    let delivered = mac.all.prr.expect("packets");
    assert!(delivered > 0.7 && delivered < 1.0 - 0.5_f64.powi(4) + 0.01, "{delivered}");
}

/// One sink knows all cells: no slot is given away twice, and on one channel no two nodes collide in the cells of their own.
#[test]
fn a_sink_gives_each_slot_to_one_node() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = "duration_s = 20000.0
warm_up_s = 2000.0
traffic.periodic = { mpdu_octets = 50, interval_s = 0.6, jitter = 0.5, acknowledged = true }
mac.tsch = { hopping = [20], schedule.msf = {} }";
    let mac = mac(&network(folder.path(), 12, None, rest));
    let negotiated = mac.slots.expect("slots").negotiated.expect("MSF");
    assert_eq!(negotiated.relocations, 0);
    assert_close(mac.all.prr.expect("packets"), 1.0, 1e-3, "delivery");
}

/// A node that dies has no cells from then on: the mean over time is that of its life, and at the end it does not count.
#[test]
fn a_dead_node_has_no_cells() {
    let folder = tempfile::tempdir().expect("a folder");
    let rest = "duration_s = 6000.0
warm_up_s = 2000.0
mac.tsch.schedule.msf = {}
faults.deaths = { names = [\"n1\"], from_s = 3000.0, to_s = 3000.0 }
[[traffic.groups]]
name = \"calm\"
nodes.names = [\"n0\"]
traffic.periodic = { mpdu_octets = 50, interval_s = 10.0, acknowledged = true }
[[traffic.groups]]
name = \"busy\"
nodes = \"others\"
traffic.periodic = { mpdu_octets = 50, interval_s = 0.25, acknowledged = true }";
    let slots = mac(&network(folder.path(), 2, None, rest)).slots.expect("slots");
    let negotiated = slots.negotiated.expect("MSF");
    assert_eq!((slots.joined, negotiated.cells), (1, Some(1.0)));
    // The other one needs 1.01 / 0.25 / 0.75 cells: six, or one more, since the warm-up and to its death.
    assert!((3.5..=4.0).contains(&negotiated.mean_cells), "{negotiated:?}");
}
