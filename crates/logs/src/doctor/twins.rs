//! Two names of one node.

use std::collections::BTreeSet;

use sextant_channel::{Reception, ReceptionLog};
use sextant_kernel::NodeId;

use super::finding::Finding;
use crate::median::median;
use sextant_kernel::text::listed;

/// Nodes that were heard at fewer stops are not compared.
const LEAST: usize = 6;
/// Two nodes that have at least this share of their stops in common, and whose rows there are alike in at least this share.
const COMMON: f64 = 0.9;
/// Strengths that differ by at most this are alike (dB).
const ALIKE_DB: f64 = 0.5;
/// Each node is compared with those that have one of its so many strongest stops in common, and at most so many of them.
const STRONGEST: usize = 3;
const MOST: usize = 40;

/// What is odd of nodes with nearly the same rows.
pub(super) fn finding(log: &ReceptionLog) -> Option<Finding> {
    let rows: Vec<Vec<Reception>> = (0..log.node_count())
        .map(|node| log.of(NodeId::from_index(node)).iter().filter(|row| row.received > 0).collect())
        .collect();
    let mut of_stop: Vec<Vec<usize>> = vec![Vec::new(); log.stops().len()];
    let mut pairs = BTreeSet::new();
    for (node, heard) in rows.iter().enumerate().filter(|(_, heard)| heard.len() >= LEAST) {
        let mut strongest: Vec<&Reception> = heard.iter().collect();
        let value = |row: &Reception| row.rssi_dbm.unwrap_or(-200.0) + f64::from(row.received) / f64::from(row.sent);
        strongest.sort_by(|a, b| value(b).total_cmp(&value(a)));
        for row in strongest.into_iter().take(STRONGEST) {
            let others = &mut of_stop[row.stop as usize];
            pairs.extend(others.iter().take(MOST).map(|&other| (other, node)));
            others.push(node);
        }
    }
    let twins: Vec<String> = pairs
        .into_iter()
        .filter(|&(a, b)| are_alike(&rows[a], &rows[b]))
        .map(|(a, b)| format!("{} and {}", log.names()[a], log.names()[b]))
        .collect();
    (!twins.is_empty()).then(|| Finding {
        check: "twins",
        odd: format!("these nodes have nearly the same rows: {}", listed(&twins)),
        cost: "one node with two names is mapped twice, and its evidence counts twice for the law of the radio"
            .to_owned(),
        remedy:
            "give a node one name (two names of an address, or two receivers' files in one), or leave one of them out"
                .to_owned(),
    })
}

/// Whether the rows of two nodes tell of one. Rows without strengths must have some packets lost and some not: many nodes
/// are heard always. Strengths must be others than usual: many nodes are heard at the limit of the receiver.
fn are_alike(a: &[Reception], b: &[Reception]) -> bool {
    let usual_dbm = median_dbm(a);
    let (mut at, mut common, mut alike, mut telling) = (0, 0_usize, 0_usize, 0_usize);
    for one in a {
        while b.get(at).is_some_and(|other| other.stop < one.stop) {
            at += 1;
        }
        let Some(other) = b.get(at).filter(|other| other.stop == one.stop) else { continue };
        common += 1;
        let (is_alike, tells) = match (one.rssi_dbm, other.rssi_dbm) {
            (Some(one_dbm), Some(other_dbm)) => {
                let tells = usual_dbm.is_some_and(|usual_dbm| (one_dbm - usual_dbm).abs() > 2.0 * ALIKE_DB);
                ((one_dbm - other_dbm).abs() <= ALIKE_DB, tells)
            }
            (None, None) => (one.received == other.received, one.received < one.sent),
            _ => (false, false),
        };
        alike += usize::from(is_alike);
        telling += usize::from(is_alike && tells);
    }
    let all = a.len().max(b.len()) as f64;
    common as f64 >= COMMON * all && alike as f64 >= COMMON * common as f64 && telling >= LEAST
}

/// The median strength of rows.
fn median_dbm(rows: &[Reception]) -> Option<f64> {
    let mut levels: Vec<f64> = rows.iter().filter_map(|row| row.rssi_dbm).collect();
    median(&mut levels)
}
