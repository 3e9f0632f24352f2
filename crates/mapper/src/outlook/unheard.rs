//! What is open of the nodes that were never heard.

use std::sync::Arc;

use sextant_channel::Position;

use super::law::StopLaw;
use super::told::{Told, told};

/// Nodes that the log names and that were never heard. All of them may be at the same places.
#[derive(Clone, Debug)]
pub(super) struct UnheardNodes {
    count: usize,
    /// Where they may be, with the share of each place after the silence of all stops.
    places: Arc<[(Position, f64)]>,
    /// The error of a node while it is not heard (m): the root mean square about the mean place.
    error_m: f64,
    /// Probability that a node is still not heard after the stops that were taken.
    chance: f64,
    /// The errors of a node after it was heard at one of them, each times its probability (m).
    heard_m: f64,
}

/// What a stop brings to nodes that were never heard.
pub(super) struct UnheardGain {
    pub(super) fall_m: f64,
    pub(super) in_reach_m: f64,
    pub(super) found: f64,
}

impl UnheardNodes {
    /// So many nodes at `open` places, which no one of `stops` heard; `None` without nodes or places.
    pub(super) fn new(count: usize, open: &[Position], stops: &[Position], law: &StopLaw) -> Option<Self> {
        if count == 0 {
            return None;
        }
        let silence = |place: &Position| {
            let missed = stops.iter().map(|stop| law.silence(stop.distance_m(*place)));
            (*place, missed.product::<f64>())
        };
        let mut places: Vec<(Position, f64)> = open.iter().map(silence).collect();
        let total: f64 = places.iter().map(|(_, weight)| weight).sum();
        if total <= 0.0 {
            return None;
        }
        places.iter_mut().for_each(|(_, weight)| *weight /= total);
        let error_m = error_m(&places);
        Some(Self { count, places: places.into(), error_m, chance: 1.0, heard_m: 0.0 })
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// The errors of all of them (m).
    pub(super) fn errors_m(&self) -> f64 {
        self.count as f64 * (self.chance * self.error_m + self.heard_m)
    }

    /// What a stop at `place` brings; `None` if it hears none of the places.
    pub(super) fn gain(&self, law: &StopLaw, place: Position) -> Option<UnheardGain> {
        let Told { silence, silent_m, heard_m, .. } = told(law, &self.places, place)?;
        let still = self.count as f64 * self.chance;
        let found = still * (1.0 - silence);
        let fall_m = still * (self.error_m - silence * silent_m - heard_m).max(0.0);
        Some(UnheardGain { fall_m, in_reach_m: found * self.error_m, found })
    }

    /// Takes the stop at `place`.
    pub(super) fn take(&mut self, law: &StopLaw, place: Position) {
        let Some(Told { silence, silent_m, heard_m, .. }) = told(law, &self.places, place) else { return };
        self.heard_m += self.chance * heard_m;
        self.chance *= silence;
        self.error_m = silent_m;
        let missed = |&(at, weight): &(Position, f64)| {
            let missed = law.silence(at.distance_m(place));
            (at, if silence > 0.0 { weight * missed / silence } else { weight })
        };
        self.places = self.places.iter().map(missed).collect();
    }
}

/// Root mean square of the distance to the mean place.
fn error_m(places: &[(Position, f64)]) -> f64 {
    let mean = places.iter().fold(Position::ORIGIN, |sum, &(place, weight)| sum + place * weight);
    let square: f64 = places.iter().map(|&(place, weight)| weight * (place - mean).dot(place - mean)).sum();
    square.sqrt()
}
