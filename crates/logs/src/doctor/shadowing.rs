//! Shadowing that explains more than distances do.

use sextant_mapper::StaticShadowing;

use super::finding::Finding;

/// More is usual nowhere (dB): 4 to 8 dB along streets and in buildings (ITU-R P.1411, P.1238), 10 dB at most.
const USUAL_DB: f64 = 10.0;
/// As odd is nearly that much if stops share nearly all of it.
const NEARLY_DB: f64 = 8.0;
const NEARLY_ALL: f64 = 0.95;

/// What is odd of the shadowing that a map was made with.
pub(super) fn finding(shadowing: StaticShadowing) -> Option<Finding> {
    let StaticShadowing { deviation_db, shared, range_m } = shadowing;
    let is_odd = deviation_db > USUAL_DB || deviation_db > NEARLY_DB && shared >= NEARLY_ALL;
    is_odd.then(|| Finding {
        check: "shadowing",
        odd: format!(
            "the map explains strengths by shadowing of {deviation_db:.1} dB, {:.0} % of it shared over {range_m:.1} m; real \
             surroundings have 3 to 10 dB",
            100.0 * shared
        ),
        cost: "distances explain little of what was heard, so places may be wrong by far more than their regions say"
            .to_owned(),
        remedy: "compare with `algorithm=strongest-stop`; check that strengths are those of the packets, and that stops and clocks \
                 are right (`packet_delay=auto`)"
            .to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shadowing_of_surroundings_is_not_odd_and_more_is() {
        let told = |deviation_db, shared| finding(StaticShadowing { deviation_db, shared, range_m: 24.0 });
        for (deviation_db, shared) in [(3.0, 0.99), (5.2, 0.99), (7.7, 0.3), (8.8, 0.94), (9.9, 0.5)] {
            assert_eq!(told(deviation_db, shared), None, "{deviation_db} dB, {shared}");
        }
        assert!(told(8.5, 0.97).is_some());
        let found = told(15.68, 0.97).unwrap();
        assert!(found.odd.contains("shadowing of 15.7 dB, 97 % of it shared over 24.0 m"), "{found}");
    }
}
