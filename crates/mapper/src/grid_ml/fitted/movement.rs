//! How far the rounds of a fit move the nodes.

use sextant_channel::Position;

use super::belief::FittedBelief;

/// Rounds after which places are compared.
const ROUNDS: u32 = 10;

/// How far the rounds of a fit move the nodes.
///
/// A curve may go on changing although no node moves: posteriors are computed on grids that follow the beliefs, so that
/// counts fluctuate. Then the places are reliable, whatever becomes of the curve.
#[derive(Debug)]
pub(super) struct Movement {
    rounds: u32,
    /// Where nodes were when places were compared last.
    places: Vec<Position>,
    share: Option<f64>,
}

impl Movement {
    /// That of nodes that begin with these beliefs.
    pub(super) fn from(beliefs: &[FittedBelief]) -> Self {
        Self { rounds: 0, places: places(beliefs), share: None }
    }

    /// Takes the beliefs after a round.
    pub(super) fn take(&mut self, beliefs: &[FittedBelief]) {
        self.rounds += 1;
        if self.rounds.is_multiple_of(ROUNDS) {
            self.share = Some(moved(&self.places, beliefs));
            self.places = places(beliefs);
        }
    }

    /// How far ten rounds moved the nodes, over how uncertain their places are (root mean squares), the last time that
    /// places were compared; `None` before ten rounds.
    pub(super) fn share(&self) -> Option<f64> {
        self.share
    }
}

fn places(beliefs: &[FittedBelief]) -> Vec<Position> {
    beliefs.iter().map(|belief| belief.mean).collect()
}

fn moved(from: &[Position], to: &[FittedBelief]) -> f64 {
    let way: f64 = from.iter().zip(to).map(|(from, to)| from.distance_m(to.mean).powi(2)).sum();
    let spread: f64 = to.iter().flat_map(|belief| belief.spread_m).map(|spread_m| spread_m * spread_m).sum();
    if way > 0.0 { (way / spread).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_compared_every_ten_rounds_with_how_uncertain_they_are() {
        let belief = |x_m: f64| FittedBelief { mean: Position::new(x_m, 0.0, 0.0), spread_m: [0.3, 0.4, 0.0] };
        let mut movement = Movement::from(&[belief(5.0)]);
        let mut shares = Vec::new();
        for round in 1..=25_u32 {
            // One metre in the first ten rounds; then it swings by 10 cm.
            let x_m = if round <= 10 { 6.0 } else { 6.0 + 0.1 * f64::from(round % 4) };
            movement.take(&[belief(x_m)]);
            shares.push(movement.share());
        }
        assert_eq!((shares[8], shares[9]), (None, Some(2.0)), "1 m over a spread of 0.5 m");
        assert!(shares[19..].iter().all(|share| share.unwrap() < 1e-9), "round 20 swings back: {shares:?}");
    }
}
