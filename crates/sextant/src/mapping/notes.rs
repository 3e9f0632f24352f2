//! What the user should know of a log before the maps are trusted.

use sextant_channel::{Position, ReceptionLog};
use sextant_mapper::EstimatorFindings;

use super::input::Input;
use crate::measure::axes;
use crate::summary::LogCounts;
use sextant_kernel::NodeId;
use sextant_kernel::text::{counted, listed};
use sextant_logs::doctor::{self, PlacedBy};

/// Silence tells nothing if less than this share of the packets was missed.
const RARELY_MISSED: f64 = 0.01;

/// The notes on `log`, of which these are the `counts`: which nodes were never heard, and whether silence says anything.
pub(super) fn of_log(log: &ReceptionLog, counts: &LogCounts) -> Vec<String> {
    let mut notes = Vec::new();
    let unheard = counts.unheard.iter().filter(|node| log.ranges_to(**node).is_empty());
    let unheard: Vec<&str> = unheard.map(|node| log.names()[node.index()].as_str()).collect();
    if !unheard.is_empty() {
        let were = if unheard.len() == 1 { "was" } else { "were" };
        notes.push(format!(
            "{} of {} {were} never heard by a robot: {}",
            unheard.len(),
            counted(log.node_count(), "node"),
            listed(&unheard)
        ));
    }
    notes.extend(other_names(log));
    // A pair that is absent is one packet that was missed.
    let pairs = counts.heard(log.node_count()) * log.stops().len() as u64;
    let sent = pairs - counts.listed_of_heard + counts.sent_of_heard;
    let missed = sent - counts.received;
    let has_strengths = 2 * counts.with_strength > counts.receptions;
    if counts.received > 0 && (missed as f64) < RARELY_MISSED * sent as f64 && !has_strengths {
        notes.push(format!(
            "nearly every node was heard at every stop ({missed} of {sent} packets were missed), so packets tell hardly \
             anything about distances: a map needs stops that are out of reach of some nodes, or signal strengths"
        ));
    }
    notes
}

/// A note on a log whose path is the odometry in the file `name`, as it is.
pub(super) fn of_odometry(name: &str) -> String {
    format!("{name} is the path, and odometry drifts: `sextant map` with option `estimate_path` corrects it")
}

/// A note if nodes were heard and ranges were measured, but to no node that was heard.
fn other_names(log: &ReceptionLog) -> Option<String> {
    let is_heard = |node: NodeId| log.of(node).iter().any(|entry| entry.received > 0);
    let nodes = || (0..log.node_count()).map(NodeId::from_index);
    let name = |node: NodeId| log.names()[node.index()].as_str();
    let ranged: Vec<NodeId> = nodes().filter(|node| !log.ranges_to(*node).is_empty()).collect();
    let heard: Vec<&str> = nodes().filter(|node| is_heard(*node)).map(name).collect();
    if ranged.is_empty() || heard.is_empty() || ranged.iter().any(|node| is_heard(*node)) {
        return None;
    }
    let ranged: Vec<&str> = ranged.into_iter().map(name).collect();
    Some(format!(
        "no node with ranges is one that was heard: ranges are to {}, and heard were {}. If they are the same nodes, give them \
         the same names",
        listed(&ranged),
        listed(&heard)
    ))
}

/// A note on nodes with ranges that have no place on the map, which has its nodes at `places`.
fn without_place(log: &ReceptionLog, places: &[Option<Position>]) -> Option<String> {
    let nodes = (0..log.node_count()).map(NodeId::from_index);
    let ranged: Vec<NodeId> = nodes.filter(|node| !log.ranges_to(*node).is_empty()).collect();
    let is_lost = |node: &&NodeId| places.get(node.index()).is_some_and(Option::is_none);
    let lost: Vec<&str> = ranged.iter().filter(is_lost).map(|node| log.names()[node.index()].as_str()).collect();
    let heights = || log.ranges().iter().map(|sample| sample.position.z_m);
    let span_m = heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min);
    // In the plane three circles meet in a point, in space four spheres.
    let needed = if span_m > 1e-3 { 4 } else { 3 };
    (!lost.is_empty()).then(|| {
        format!(
            "{} of {} with ranges {} no place: {}. A place takes ranges from at least {needed} stops, or places half a metre apart, \
             and ranges that agree",
            lost.len(),
            counted(ranged.len(), "node"),
            if lost.len() == 1 { "has" } else { "have" },
            listed(&lost)
        )
    })
}

/// The notes on a map of the log of `input`: what is odd in its law and places, and in how it differs from the true places of the nodes.
///
/// The map has its nodes at `places`, and what was estimated with it is `learned`.
pub(super) fn of_map(
    input: &Input,
    places: &[Option<Position>],
    learned: Option<&EstimatorFindings>,
    truth: Option<&[Option<Position>]>,
) -> Vec<String> {
    let axes = truth.and_then(|truth| axes(truth, places, input.odometry.as_deref()));
    let (log, placed_by) = (input.log(), PlacedBy::of_middles(&input.middles));
    let findings = doctor::of_map(log, places, learned, placed_by).into_iter().chain(axes);
    findings.map(|finding| finding.to_string()).chain(without_place(log, places)).collect()
}

#[cfg(test)]
mod tests {
    use sextant_channel::{Position, RangeSample, Reception, Stop};

    use super::*;

    /// The notes on a log of four stops with these packets (node, stop, received, sent).
    fn notes(names: usize, packets: &[(u32, u32, u32, u32)]) -> Vec<String> {
        let stop = |i: u8| Stop::at(Position::new(f64::from(i), 0.0, 0.0));
        let entry = |&(node, stop, received, sent)| Reception::heard(NodeId(node), stop, received, sent);
        let names = (0..names).map(|i| format!("n{i}")).collect();
        let entries = packets.iter().map(entry).collect();
        let log = ReceptionLog::new(names, (0..4).map(stop).collect(), entries, Vec::new()).unwrap();
        of_log(&log, &LogCounts::of(&log))
    }

    #[test]
    fn nodes_that_were_never_heard_are_named() {
        let notes = notes(4, &[(1, 0, 3, 5), (2, 1, 0, 5), (3, 2, 0, 0)]);
        assert_eq!(notes, ["3 of 4 nodes were never heard by a robot: n0, n2, n3"]);
    }

    /// A log of one stop with nodes `a` and `b`: `a` was heard, and there is a range to the node with this number.
    fn ranged(node: u32) -> ReceptionLog {
        let stop = Stop::at(Position::ORIGIN);
        let (sector, rssi_dbm, snr_db) = (None, None, None);
        let heard = Reception { node: NodeId(0), stop: 0, received: 1, sent: 1, sector, rssi_dbm, snr_db };
        let sample = RangeSample::of(NodeId(node), Position::ORIGIN, 4.0);
        let names = ["a", "b"].map(str::to_owned).to_vec();
        let log = ReceptionLog::new(names, vec![stop], vec![heard], Vec::new()).unwrap();
        log.with_ranges(vec![sample]).unwrap()
    }

    #[test]
    fn nodes_with_ranges_and_no_place_are_named_with_what_they_need() {
        let told = without_place(&ranged(1), &[None, None]).unwrap();
        assert!(
            told.starts_with("1 of 1 node with ranges has no place: b. A place takes ranges from at least 3"),
            "{told}"
        );
        assert_eq!(without_place(&ranged(1), &[None, Some(Position::ORIGIN)]), None);
    }

    #[test]
    fn ranges_to_nodes_that_were_never_heard_ask_for_their_names() {
        assert_eq!(other_names(&ranged(0)), None);
        let told = other_names(&ranged(1)).unwrap();
        assert!(
            told.starts_with("no node with ranges is one that was heard: ranges are to b, and heard were a."),
            "{told}"
        );
    }

    #[test]
    fn a_log_without_silence_says_that_packets_tell_nothing() {
        let all = |received| (0..4).map(|stop| (0, stop, received, 100)).collect::<Vec<_>>();
        let full = notes(1, &all(100));
        assert!(full.len() == 1 && full[0].contains("(0 of 400 packets were missed)"), "{full:?}");
        // Of 400 packets, 3 are missed: less than one in a hundred. At the fourth it is not.
        let mut packets = all(100);
        packets[2].2 = 97;
        assert_eq!(notes(1, &packets).len(), 1);
        packets[2].2 = 96;
        assert_eq!(notes(1, &packets), Vec::<String>::new());
        // A stop that is not listed is a packet that was missed; a stop with 0 of 0 is not.
        assert_eq!(notes(1, &[(0, 0, 5, 5), (0, 1, 5, 5), (0, 2, 5, 5)]), Vec::<String>::new());
        assert_eq!(notes(1, &[(0, 0, 5, 5), (0, 1, 5, 5), (0, 2, 5, 5), (0, 3, 0, 0)]).len(), 1);
    }
}
