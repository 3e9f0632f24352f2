//! Stops that are shorter than the nodes' sending intervals.

use std::time::Duration;

use sextant_channel::ReceptionLog;
use sextant_kernel::NodeId;

use super::finding::Finding;

/// At least this share of the pairs of a heard node and a stop is no evidence.
const MOST: f64 = 0.75;
/// Fewer pairs say nothing.
const LEAST: usize = 40;

/// What is odd of a log of which most pairs are 0 of 0. `usual` are the usual length of a stop and the usual interval of the
/// nodes, if they are known.
pub(crate) fn finding(log: &ReceptionLog, usual: Option<(Duration, Duration)>) -> Option<Finding> {
    let nodes = (0..log.node_count()).map(NodeId::from_index);
    let (mut pairs, mut empty) = (0, 0);
    for heard in nodes.map(|node| log.of(node)).filter(|of_node| of_node.iter().any(|row| row.received > 0)) {
        pairs += log.stops().len();
        empty += heard.iter().filter(|row| row.sent == 0).count();
    }
    if pairs < LEAST || (empty as f64) < MOST * pairs as f64 {
        return None;
    }
    let share = 100.0 * empty as f64 / pairs as f64;
    let (why, remedy) = match usual {
        Some((stop, interval)) => (
            format!(
                ": a stop takes {:.1} s as a rule, a node sends every {:.1} s",
                stop.as_secs_f64(),
                interval.as_secs_f64()
            ),
            format!(
                "`stop_every={:.0}s` gives each node a packet at each stop, if the robot hardly moves meanwhile; or let \
                 nodes send more often",
                interval.as_secs_f64().ceil()
            ),
        ),
        None => (
            String::new(),
            "listen longer at each stop than the nodes' interval; `sent` counts what a node sent meanwhile"
                .to_owned(),
        ),
    };
    Some(Finding {
        check: "short-listening",
        odd: format!("at {share:.0} % of the pairs of a node and a stop the node sent nothing (0 of 0){why}"),
        cost: "these pairs say nothing, so silence bounds the places of nodes at few stops only".to_owned(),
        remedy,
    })
}
