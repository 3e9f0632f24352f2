//! Errors of neighbour scattering, E_NS (Gunathillake 2018, eq. 5.8), against position errors.

use sextant_apps::distributed::MappingRecord;
use sextant_channel::{CellIndex, Position};
use sextant_mapper::PositionError;

/// Number of bins of the E_NS that nodes compute: each is 0.05 wide.
const BINS: usize = 20;
/// Upper edges of the bins of the E_NS of near neighbours.
const NEAR_EDGES: [f64; 5] = [0.05, 0.1, 0.2, 0.4, 1.0];

/// A bin: its upper edge, number of nodes, and mean and 90th percentile of their position errors (m).
pub(super) type Bin = (f64, usize, f64, f64);

/// Position errors by the E_NS that each node computed, of the nodes that computed a place and have neighbours. The
/// neighbours are those that it heard, and its radius is that of communication.
pub(super) fn of_heard(nodes: &[MappingRecord], truth: &[Position]) -> Vec<Bin> {
    let edges: Vec<f64> = (1..=BINS).map(|bin| 0.05 * bin as f64).collect();
    let shares = nodes.iter().zip(truth).filter_map(|(node, truth)| {
        let place = node.estimate.as_ref()?.position;
        Some((node.scattering.share()?, place.distance_m(*truth)))
    });
    bins(&edges, shares)
}

/// The same with the nodes that are truly within `radius_m` of the node as neighbours, and with this radius: the share of
/// them that the map has farther away. Nodes without a place do not count.
pub(super) fn of_near(nodes: &[MappingRecord], truth: &[Position], radius_m: f64) -> Vec<Bin> {
    let index = CellIndex::new(truth, radius_m);
    let shares = nodes.iter().enumerate().filter_map(|(node, record)| {
        let place = record.estimate.as_ref()?.position;
        let (mut near, mut scattered) = (0_u32, 0_u32);
        index.within(truth[node], radius_m, |other| {
            let other = other as usize;
            if let Some(image) = nodes[other].place.filter(|_| other != node) {
                near += 1;
                scattered += u32::from(place.distance_m(image) > radius_m);
            }
        });
        (near > 0).then(|| (f64::from(scattered) / f64::from(near), place.distance_m(truth[node])))
    });
    bins(&NEAR_EDGES, shares)
}

/// Pairs of an E_NS and a position error, in bins with these upper edges; those without nodes are left out.
fn bins(edges: &[f64], shares: impl Iterator<Item = (f64, f64)>) -> Vec<Bin> {
    let mut errors_m: Vec<Vec<f64>> = vec![Vec::new(); edges.len()];
    for (share, error_m) in shares {
        let bin = edges.iter().position(|edge| share <= edge + 1e-9).unwrap_or(edges.len() - 1);
        errors_m[bin].push(error_m);
    }
    let row = |(&edge, errors_m): (&f64, &Vec<f64>)| {
        let PositionError { mean, p90, .. } = PositionError::of(errors_m)?;
        Some((edge, errors_m.len(), mean, p90))
    };
    edges.iter().zip(&errors_m).filter_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_mapper::Estimate;

    fn record(place: Option<Position>, is_computed: bool) -> MappingRecord {
        MappingRecord {
            place,
            estimate: place.filter(|_| is_computed).map(Estimate::of_place),
            ..MappingRecord::default()
        }
    }

    #[test]
    fn near_neighbours_that_the_map_has_farther_away_are_scattered() {
        // On a line, a metre apart. The last one is 5 m off its place; the first is an anchor; one has no place.
        let truth: Vec<Position> = (0..5).map(|x| Position::new(f64::from(x), 0.0, 0.0)).collect();
        let mut places: Vec<Option<Position>> = truth.iter().copied().map(Some).collect();
        places[3] = None;
        places[4] = Some(Position::new(4.0, 5.0, 0.0));
        let nodes: Vec<MappingRecord> = places.iter().enumerate().map(|(i, &place)| record(place, i > 0)).collect();
        // Within 2 m: the node at 1 has 0 and 2, both in place. The node at 2 has 0, 1 and 4, of which one is scattered.
        // The node at 4 has only that at 2 besides the one without a place.
        assert_eq!(of_near(&nodes, &truth, 2.0), [(0.05, 1, 0.0, 0.0), (0.4, 1, 0.0, 0.0), (1.0, 1, 5.0, 5.0)]);
        assert_eq!(of_near(&nodes, &truth, 0.5), []);
        assert_eq!(of_heard(&nodes, &truth), [], "none has computed an E_NS");
    }
}
