//! Nodes that one place does not explain: they moved during the survey.

use rayon::prelude::*;
use sextant_channel::ReceptionLog;
use sextant_kernel::NodeId;

use super::finding::Finding;
use super::node_fit::{Law, NodeFit, Observation, plane_m};
use sextant_kernel::text::listed;

/// A node is checked if it was heard at so many stops at least, and so many before and after it may have moved.
const LEAST: usize = 20;
const LEAST_PART: usize = 8;
/// Tenths of the stops that heard it after which it may have moved.
const SPLITS: [usize; 5] = [3, 4, 5, 6, 7];
/// It moved if two places leave at most this share of the loss that one place leaves, gain at least this much, and are
/// farther apart than this share of the extent of the stops that heard it.
const LEFT: f64 = 0.45;
const GAIN: f64 = 12.0;
const APART: f64 = 0.25;
/// More nodes are not checked, and of a node not more stops.
const MOST_NODES: usize = 200;
const MOST_STOPS: usize = 160;

/// What is odd of nodes that seem to have moved.
pub(super) fn finding(log: &ReceptionLog) -> Option<Finding> {
    let every = log.node_count().div_ceil(MOST_NODES).max(1);
    let nodes: Vec<usize> = (0..log.node_count()).step_by(every).collect();
    let moved: Vec<String> = nodes
        .into_par_iter()
        .filter_map(|node| {
            let Moved { after, apart_m } = moved(&observations(log, NodeId::from_index(node)))?;
            let stop = log.stops()[after as usize].time.as_secs_f64();
            let when = if stop > 0.0 { format!("about {stop:.0} s") } else { format!("about stop {after}") };
            Some(format!("{} ({apart_m:.1} m at {when})", log.names()[node]))
        })
        .collect();
    (!moved.is_empty()).then(|| Finding {
        check: "moved-nodes",
        odd: format!(
            "one place does not explain what was heard of these nodes, two places one after the other do: {}",
            listed(&moved)
        ),
        cost: "such a node is placed between the two, or at one of them".to_owned(),
        remedy: "give the node another name from that time on, or map the two parts of the survey by themselves"
            .to_owned(),
    })
}

/// When a node moved, and how far.
struct Moved {
    after: u32,
    apart_m: f64,
}

/// The strengths of a node in the order of the survey, and their stops.
fn observations(log: &ReceptionLog, node: NodeId) -> Vec<(u32, Observation)> {
    let heard = log.of(node);
    let heard = heard.iter().filter(|reception| reception.received > 0);
    let observation = |stop: u32, value| Observation { at: log.stops()[stop as usize].position, value, weight: 1.0 };
    let all: Vec<_> = heard
        .filter_map(|row| Some((row.stop, observation(row.stop, row.rssi_dbm.filter(|&dbm| dbm < 0.0)?))))
        .collect();
    let every = all.len().div_ceil(MOST_STOPS).max(1);
    all.into_iter().step_by(every).collect()
}

fn moved(heard: &[(u32, Observation)]) -> Option<Moved> {
    if heard.len() < LEAST {
        return None;
    }
    let all: Vec<Observation> = heard.iter().map(|(_, observation)| *observation).collect();
    let law = Law::Strengths { scale_db: 4.0 };
    let one = NodeFit::of(&all, law)?;
    if one.loss < GAIN {
        return None;
    }
    let middle = all[all.len() / 2].at;
    let extent_m = all.iter().map(|observation| plane_m(observation.at, middle)).fold(0.0, f64::max);
    let most = (LEFT * one.loss).min(one.loss - GAIN);
    let split = |tenths: usize| {
        let at = all.len() * tenths / 10;
        let (before, after) = all.split_at(at.clamp(LEAST_PART, all.len() - LEAST_PART));
        // No loss is below 0, so that the second part, whatever it is, cannot make up for the first.
        let first = NodeFit::of(before, law).filter(|first| first.loss <= most)?;
        let second = NodeFit::of(after, law)?;
        let apart_m = plane_m(first.place(), second.place());
        Some((first.loss + second.loss, Moved { after: heard[before.len()].0, apart_m }))
    };
    let best = SPLITS.into_iter().filter_map(split).min_by(|a, b| a.0.total_cmp(&b.0));
    let (loss, moved) = best?;
    let is_clear = loss <= LEFT * one.loss && one.loss - loss >= GAIN && moved.apart_m > APART * extent_m;
    is_clear.then_some(moved)
}
