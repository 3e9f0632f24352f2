//! Shadowing that explains more than distances do.

use sextant_mapper::StaticShadowing;

use super::explained::{NodeSums, explained};
use super::finding::Finding;
use super::placed_by::PlacedBy;

/// More is usual nowhere (dB): 4 to 8 dB along streets and in buildings (ITU-R P.1411, P.1238), 10 dB at most.
const USUAL_DB: f64 = 10.0;
/// As odd is nearly that much if stops share nearly all of it.
const NEARLY_DB: f64 = 8.0;
const NEARLY_ALL: f64 = 0.95;
/// Distances explain little if less than this share of what the strengths of nodes differ: of logs whose maps are good they explain
/// half and more where shadowing is so large.
const LITTLE: f64 = 0.4;

/// What is odd of the shadowing that a map was made with, if the distances of its `nodes` explain little.
pub(super) fn finding(shadowing: StaticShadowing, nodes: &[NodeSums], placed_by: PlacedBy) -> Option<Finding> {
    let StaticShadowing { deviation_db, shared, range_m } = shadowing;
    let is_large = deviation_db > USUAL_DB || deviation_db > NEARLY_DB && shared >= NEARLY_ALL;
    let explained = explained(nodes).filter(|explained| is_large && *explained < LITTLE)?;
    Some(Finding {
        check: "shadowing",
        odd: format!(
            "distances explain {:.0} % of how the strengths of each node differ; the map explains the rest by shadowing of \
             {deviation_db:.1} dB, {:.0} % of it shared over {range_m:.1} m",
            100.0 * explained,
            100.0 * shared
        ),
        cost: "places come from little evidence, and may be wrong by far more than their regions say".to_owned(),
        remedy: format!(
            "check that strengths are those of the packets, that stops are right{}, and compare with `algorithm=strongest-stop`",
            placed_by.clocks()
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shadowing_is_odd_if_it_is_large_and_distances_explain_little() {
        let told = |deviation_db, shared, explained: f64| {
            let nodes = [NodeSums { logs: 1.0, with_levels: -explained.sqrt() * 10.0, levels: 100.0 }];
            finding(StaticShadowing { deviation_db, shared, range_m: 24.0 }, &nodes, PlacedBy::Rows)
        };
        for (deviation_db, shared) in [(3.0, 0.99), (5.2, 0.99), (7.7, 0.3), (8.8, 0.94), (9.9, 0.5)] {
            assert_eq!(told(deviation_db, shared, 0.1), None, "{deviation_db} dB, {shared}");
        }
        assert!(told(8.5, 0.97, 0.3).is_some());
        // Walls of 10 dB, and a building with floors: the law of distances holds beside them.
        assert_eq!((told(9.2, 0.99, 0.65), told(12.1, 0.99, 0.72)), (None, None));
        let found = told(15.68, 0.97, 0.07).unwrap();
        assert!(found.odd.starts_with("distances explain 7 % of how"), "{found}");
        assert!(found.odd.ends_with("shadowing of 15.7 dB, 97 % of it shared over 24.0 m"), "{found}");
    }

    #[test]
    fn clocks_are_named_only_where_times_place_packets() {
        let shadowing = StaticShadowing { deviation_db: 15.0, shared: 0.97, range_m: 24.0 };
        let nodes = [NodeSums { logs: 1.0, with_levels: 0.0, levels: 100.0 }];
        let remedy = |placed_by| finding(shadowing, &nodes, placed_by).unwrap().remedy;
        assert!(remedy(PlacedBy::Times).contains("`packet_delay=auto`"));
        assert!(!remedy(PlacedBy::Rows).contains("packet_delay"));
    }
}
