//! A path-loss exponent that no surroundings have.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

use super::finding::Finding;

/// Exponents of real surroundings, from a waveguide-like corridor to obstructed factories (Rappaport 2002, table 4.2).
const USUAL: [f64; 2] = [1.5, 6.0];
/// Nearer than this a place is not known (m).
const LEAST_M: f64 = 0.5;
/// The standard error is at least this, because the places come from the same strengths.
const LEAST_ERROR: f64 = 0.1;
/// Fewer nodes do not tell the uncertainty.
const LEAST_NODES: usize = 3;

/// What is odd of the `exponent` that a map of `log` was made with; `places` are those of the map.
pub(super) fn finding(log: &ReceptionLog, places: &[Option<Position>], exponent: f64) -> Option<Finding> {
    if (USUAL[0]..=USUAL[1]).contains(&exponent) {
        return None;
    }
    let error = standard_error(log, places).map(|error| error.max(LEAST_ERROR));
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
        remedy:
            "check that `rssi_dbm` are dBm of the packet (not noise, not a controlled power), that the clocks agree \
                 (`packet_delay=auto`), and compare with `algorithm=packet-centroid`"
                .to_owned(),
    })
}

/// The standard error of the exponent, from how the nodes disagree: that of the slope of strengths over the logarithm of
/// distance within each node, by leaving out one node after the other (jackknife; Tukey 1958).
fn standard_error(log: &ReceptionLog, places: &[Option<Position>]) -> Option<f64> {
    let of_node = |node: usize| sums(log, NodeId::from_index(node), (*places.get(node)?)?);
    let sums: Vec<[f64; 2]> = (0..log.node_count()).filter_map(of_node).collect();
    if sums.len() < LEAST_NODES {
        return None;
    }
    let total = sums.iter().fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
    let without: Vec<f64> = sums.iter().map(|one| -(total[1] - one[1]) / (total[0] - one[0]) / 10.0).collect();
    let count = without.len() as f64;
    let mean = without.iter().sum::<f64>() / count;
    let squares: f64 = without.iter().map(|slope| (slope - mean) * (slope - mean)).sum();
    Some((squares * (count - 1.0) / count).sqrt()).filter(|error| error.is_finite())
}

/// The sums of squares of the logarithms of distance of a node, and of their products with its strengths, about their means.
fn sums(log: &ReceptionLog, node: NodeId, place: Position) -> Option<[f64; 2]> {
    let heard = log.of(node);
    let heard = heard.iter().filter(|row| row.received > 0);
    let point = |stop: u32| libm::log10(log.stops()[stop as usize].position.distance_m(place).max(LEAST_M));
    let points: Vec<[f64; 2]> = heard.filter_map(|row| Some([point(row.stop), row.rssi_dbm?])).collect();
    let share = 1.0 / points.len() as f64;
    let mean = points.iter().fold([0.0; 2], |mean, [x, y]| [mean[0] + x * share, mean[1] + y * share]);
    let sum = points.iter().fold([0.0; 2], |sum, [x, y]| {
        let (x, y) = (x - mean[0], y - mean[1]);
        [sum[0] + x * x, sum[1] + x * y]
    });
    (points.len() >= 3 && sum[0] > 0.0).then_some(sum)
}
