//! Strengths that distances do not explain.

use super::distance_law::DistanceLaw;
use super::finding::Finding;
use super::placed_by::PlacedBy;

/// A law is of no use if it predicts stops that are left out worse than no law by this (nats a link), and by so many standard
/// errors.
const WORSE: f64 = 0.01;
const CLEAR: f64 = 2.0;

/// What is odd of strengths that a law of distances explains no better than no law.
pub(super) fn finding(law: &DistanceLaw, placed_by: PlacedBy) -> Option<Finding> {
    let DistanceLaw { gain, gain_error, .. } = *law;
    (gain < -WORSE && gain + CLEAR * gain_error < 0.0).then(|| Finding {
        check: "no-distance",
        odd: format!(
            "distances explain nothing here: at stops that are left out, a law that falls with distance predicts strengths worse \
             than one that does not ({gain:.2} ± {:.2} nats a link)",
            CLEAR * gain_error
        ),
        cost: "strengths hardly tell where nodes are, and regions of maps are too small".to_owned(),
        remedy: format!(
            "check that each strength is that of its node at its stop{}, and compare with `algorithm=strongest-stop`",
            placed_by.clocks()
        ),
    })
}
