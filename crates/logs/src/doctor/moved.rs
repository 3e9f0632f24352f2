//! Nodes that moved during the survey: two places, one after the other, explain them better than anything else does.
//!
//! Whatever changes between two halves of a survey makes two places fit better than one. So two places must beat what else
//! changes, each with its own evidence ([`super::evidence`]): one place and a level that steps at any time (power, a door, a
//! body), one place and a level that drifts, one place and another shadowing from some time on. Floors are judged one by one, and
//! many nodes that move are a robot that did, or a floor that no height tells.

use nalgebra::DMatrix;
use rayon::prelude::*;
use sextant_channel::ReceptionLog;
use sextant_kernel::NodeId;

use super::distance_law::DistanceLaw;
use super::evidence::{FieldAt, NodeField, ln_mean};
use super::finding::Finding;
use super::node_strengths::{NodeStrengths, floors};
use super::stop_text::stop_text;
use crate::place::distance::plane_m;
use sextant_kernel::text::listed;

/// A node is checked if it was heard at so many stops at least, and so many before and after it may have moved.
const LEAST: usize = 20;
const LEAST_PART: usize = 10;
/// Tenths of the stops that heard it after which it may have moved, or its level may have changed.
const SPLITS: [usize; 7] = [2, 3, 4, 5, 6, 7, 8];
/// Two places beat what else explains a node by so many nats, and by the logarithm of the number of nodes that are tried.
const CLEAR: f64 = 5.0;
/// They are farther apart than this share of the extent of the area in which the node was heard.
const APART: f64 = 0.2;
/// Of so many nodes that are checked, at most one moved.
const FEW: usize = 3;
/// Levels step by about this, or drift by these over these shares of the stops (dB).
const STEP_DB: f64 = 10.0;
const DRIFTS: [(f64, f64); 4] = [(4.0, 0.1), (4.0, 0.5), (10.0, 0.1), (10.0, 0.5)];
/// With more shared shadowing, places are not told by strengths (dB).
const MOST_SHADOWING_DB: f64 = 8.0;
/// More nodes are not checked, and of a node not more stops.
const MOST_NODES: usize = 200;
const MOST_STOPS: usize = 100;

/// What is odd of nodes that moved, in a log whose strengths follow `law`.
pub(super) fn finding(log: &ReceptionLog, law: &DistanceLaw) -> Option<Finding> {
    if law.shadowing.shared_db > MOST_SHADOWING_DB || law.gain <= 0.0 {
        return None;
    }
    let floors = floors(log);
    let every = log.node_count().div_ceil(MOST_NODES).max(1);
    let heard = |node| NodeStrengths::of(log, NodeId::from_index(node), &floors, [LEAST, MOST_STOPS]);
    let nodes: Vec<(usize, Vec<NodeStrengths>)> =
        (0..log.node_count()).step_by(every).map(|node| (node, heard(node).collect())).collect();
    let checked = nodes.iter().filter(|(_, floors)| !floors.is_empty()).count();
    let clear = CLEAR + libm::log(checked.max(1) as f64);
    let moved: Vec<(usize, Moved)> = nodes
        .par_iter()
        .filter_map(|(node, floors)| {
            let moved = floors.iter().filter_map(|heard| moved(heard, law, clear));
            Some((*node, moved.max_by(|a, b| a.gain.total_cmp(&b.gain))?))
        })
        .collect();
    if moved.is_empty() || FEW * moved.len() > checked {
        return None;
    }
    let told = |(node, Moved { after, apart_m, .. }): &(usize, Moved)| {
        let time_s = log.stops()[*after as usize].time.as_secs_f64();
        let when = if time_s > 0.0 { format!("about {time_s:.0} s") } else { stop_text(log, *after) };
        format!("{} ({apart_m:.1} m at {when})", log.names()[*node])
    };
    Some(Finding {
        check: "moved-nodes",
        odd: format!(
            "two places one after the other explain what was heard of these nodes better than one place, even one whose losses \
             change: {}",
            listed(&moved.iter().map(told).collect::<Vec<_>>())
        ),
        cost: "such a node is placed between the two, or at one of them".to_owned(),
        remedy: "if it was moved, give it another name from that time on, or map the two parts of the survey by themselves"
            .to_owned(),
    })
}

/// When a node moved, how far, and how much better that explains it (nats).
struct Moved {
    after: u32,
    apart_m: f64,
    gain: f64,
}

/// A node that moved, if two places are better than all else by more than `clear`.
fn moved(heard: &NodeStrengths, law: &DistanceLaw, clear: f64) -> Option<Moved> {
    let DistanceLaw { shadowing, lattice, .. } = law;
    let field = NodeField::new(heard, lattice);
    let count = heard.len();
    let rows: Vec<usize> = (0..count).collect();
    let in_order = |rows: &[usize]| field.at(rows, field.covariance(rows, *shadowing));
    let (forward, backward) = (in_order(&rows)?, in_order(&rows.iter().rev().copied().collect::<Vec<_>>())?);
    let mut splits: Vec<usize> =
        SPLITS.iter().map(|tenths| (count * tenths / 10).clamp(LEAST_PART, count - LEAST_PART)).collect();
    splits.dedup();
    let part = |of: &FieldAt, count: usize| of.of_first(count).by_place();
    let parts: Vec<(usize, [Vec<f64>; 2])> =
        splits.iter().map(|&at| (at, [part(&forward, at), part(&backward, count - at)])).collect();
    let two = |[before, after]: &[Vec<f64>; 2]| ln_mean(before.iter().copied()) + ln_mean(after.iter().copied());
    let (at, best) = parts.iter().max_by(|a, b| two(&a.1).total_cmp(&two(&b.1)))?;
    let highest = two(best);
    let mut gain = f64::INFINITY;
    // What needs less work comes first: most nodes end there.
    let other_shadowing =
        parts.iter().map(|(_, [before, after])| ln_mean(before.iter().zip(after).map(|(a, b)| a + b)));
    let whole = forward.of_first(count);
    let steps = splits.iter().map(|&at| forward.stepped(&whole, at, STEP_DB * STEP_DB).one_place());
    let drifts = DRIFTS.iter().map(|&(drift_db, share)| {
        let span = share * count as f64;
        let drift = |a: usize, b: usize| drift_db * drift_db * libm::exp(-(a.abs_diff(b) as f64) / span);
        let covariance = field.covariance(&rows, *shadowing) + DMatrix::from_fn(count, count, drift);
        field.at(&rows, covariance).map_or(f64::NEG_INFINITY, |field| field.of_first(count).one_place())
    });
    for rival in other_shadowing.chain(steps).chain(drifts) {
        gain = gain.min(highest - rival);
        if gain <= clear {
            return None;
        }
    }
    let lattice = &field.lattice;
    let apart_m = plane_m(lattice.middle(&best[0]), lattice.middle(&best[1]));
    (apart_m > APART * lattice.extent_m).then(|| Moved { after: heard.stops[*at], apart_m, gain })
}
