//! A path-loss exponent that no surroundings have.

use super::explained::NodeSums;
use super::finding::Finding;
use super::placed_by::PlacedBy;

/// Exponents of real surroundings, from a waveguide-like corridor to obstructed factories (Rappaport 2002, table 4.2).
const USUAL: [f64; 2] = [1.5, 6.0];
/// The standard error is at least this, because the places come from the same strengths.
const LEAST_ERROR: f64 = 0.1;
/// Fewer nodes do not tell the uncertainty.
const LEAST_NODES: usize = 3;

/// What is odd of the `exponent` that a map was made with; `nodes` are its nodes.
pub(super) fn finding(exponent: f64, nodes: &[NodeSums], placed_by: PlacedBy) -> Option<Finding> {
    if (USUAL[0]..=USUAL[1]).contains(&exponent) {
        return None;
    }
    let error = standard_error(nodes).map(|error| error.max(LEAST_ERROR));
    let [low, high] = USUAL;
    if error.is_some_and(|error| exponent + 2.0 * error >= low && exponent - 2.0 * error <= high) {
        return None;
    }
    let within = error.map_or_else(String::new, |error| format!(" ± {:.2}", 2.0 * error));
    Some(Finding {
        check: "exponent",
        odd: format!(
            "the path-loss exponent of the map is {exponent:.2}{within}; real surroundings have {low} to {high:.0}"
        ),
        cost: if exponent < low {
            "strengths hardly bound distances, so places come from little evidence".to_owned()
        } else {
            "distances from strengths are too much alike, so nodes are placed too near each other".to_owned()
        },
        remedy: format!(
            "check that `rssi_dbm` are dBm of the packet (not noise, not a controlled power){}, and compare with \
             `algorithm=strongest-stop`",
            placed_by.clocks()
        ),
    })
}

/// The standard error of the exponent, from how the nodes disagree: that of the slope of strengths over the logarithm of
/// distance within each node, by leaving out one node after the other (jackknife; Tukey 1958).
fn standard_error(nodes: &[NodeSums]) -> Option<f64> {
    if nodes.len() < LEAST_NODES {
        return None;
    }
    let total = NodeSums::total(nodes);
    let slope = |one: &NodeSums| -(total.with_levels - one.with_levels) / (total.logs - one.logs) / 10.0;
    let without: Vec<f64> = nodes.iter().map(slope).collect();
    let count = without.len() as f64;
    let mean = without.iter().sum::<f64>() / count;
    let squares: f64 = without.iter().map(|slope| (slope - mean) * (slope - mean)).sum();
    Some((squares * (count - 1.0) / count).sqrt()).filter(|error| error.is_finite())
}
