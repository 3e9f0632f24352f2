//! Silence that says nothing: links that are dead whatever their power.

use super::links::PlaceLinks;

/// Probability of an outage before anything is heard, and its weight as a number of pairs.
const USUAL: f64 = 0.02;
const USUAL_PAIRS: f64 = 20.0;
/// The same where silence is doubted.
const DOUBTED: f64 = 0.04;
/// Outages that are rarer are silence that the law explains badly, and half of them count at most.
const RARE: f64 = 0.03;
/// Outages are frequent from here on.
const FREQUENT: f64 = 0.05;
/// Weight of what the log says for one of its places, and for one of its nodes, as a number of pairs.
const OF_PLACE: f64 = 4.0;
const OF_NODE: f64 = 8.0;
/// Least and most probable outage.
const LEAST: f64 = 0.002;
const MOST: f64 = 0.9;
/// Most rounds of the estimate, and the change relative to which that of a node has settled.
const ROUNDS: usize = 25;
const SETTLED: f64 = 1e-4;

/// How probable it is that a link is dead: a receiver that was off, a node without power, a gateway that did not forward.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outages {
    /// Over all pairs of node and place.
    pub(super) of_log: f64,
    of_place: Vec<f64>,
}

/// What is known of a pair of node and place: whether it is silent by power alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeAndPlace {
    /// Number of the place.
    pub(super) place: usize,
    /// The probability of silence if the link is alive.
    pub(super) silence: f64,
    /// Whether it was silent.
    pub(super) is_silent: bool,
}

impl Outages {
    /// Those with which the search for a law begins. Where strengths tell places too, silence begins with little weight:
    /// otherwise law and places would explain it as weakness, and outages would never show.
    pub(super) fn start(links: &PlaceLinks, has_strengths: bool) -> Self {
        let of_log = if has_strengths { DOUBTED } else { USUAL };
        Self { of_log, of_place: vec![of_log; links.places.len()] }
    }

    /// Those of highest likelihood given `pairs`, by expectation maximisation.
    pub(super) fn estimated(&self, pairs: &[NodeAndPlace]) -> Self {
        let mut found = self.clone();
        for _ in 0..ROUNDS {
            let mut all = (USUAL * USUAL_PAIRS, USUAL_PAIRS);
            let mut each = vec![(0.0, 0.0); found.of_place.len()];
            for pair in pairs {
                let (dead, weight) = pair.dead(found.of_place[pair.place]);
                all = (all.0 + dead, all.1 + weight);
                each[pair.place] = (each[pair.place].0 + dead, each[pair.place].1 + weight);
            }
            let share = all.0 / all.1;
            found.of_log = (share * share / (share + RARE)).clamp(LEAST, MOST);
            for (place, (dead, weight)) in found.of_place.iter_mut().zip(each) {
                *place = ((OF_PLACE * found.of_log + dead) / (OF_PLACE + weight)).min(MOST);
            }
        }
        found
    }

    /// Whether outages are more than single cases that a law misses.
    pub(super) fn are_frequent(&self) -> bool {
        self.of_log > FREQUENT
    }

    /// The probability of an outage of one node at each of its `pairs`: its own part comes from these pairs.
    pub(super) fn of_node(&self, pairs: &[NodeAndPlace]) -> Vec<f64> {
        let mut own = self.of_log;
        for _ in 0..ROUNDS {
            let mut sum = (OF_NODE * self.of_log, OF_NODE);
            for pair in pairs {
                let (dead, weight) = pair.dead(self.at(pair.place, own));
                sum = (sum.0 + dead, sum.1 + weight);
            }
            let before = std::mem::replace(&mut own, (sum.0 / sum.1).min(MOST));
            if (own - before).abs() < SETTLED * before {
                break;
            }
        }
        pairs.iter().map(|pair| self.at(pair.place, own)).collect()
    }

    /// The probability at a place for a node with the outage `own`: the odds of both, relative to those of the log.
    fn at(&self, place: usize, own: f64) -> f64 {
        let odds = |share: f64| share / (1.0 - share);
        let odds = odds(self.of_place[place]) * odds(own) / odds(self.of_log);
        (odds / (1.0 + odds)).min(MOST)
    }
}

impl NodeAndPlace {
    /// How much of the pair is dead, and how much it counts: by the sixth power of the probability with which it would have been
    /// heard. Silence that power may have caused tells nothing of outages.
    fn dead(&self, outage: f64) -> (f64, f64) {
        let square = (1.0 - self.silence) * (1.0 - self.silence);
        let weight = square * square * square;
        let dead = outage / (outage + (1.0 - outage) * self.silence);
        (if self.is_silent { weight * dead } else { 0.0 }, weight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_that_are_silent_though_signals_are_strong_have_outages() {
        let usual = Outages { of_log: USUAL, of_place: vec![USUAL; 20] };
        // Each of 30 nodes would be heard at each place with a probability of 0.99. Half of the places hear nothing.
        let pair = |place: usize| NodeAndPlace { place, silence: 0.01, is_silent: place.is_multiple_of(2) };
        let pairs: Vec<NodeAndPlace> = (0..600).map(|number| pair(number % 20)).collect();
        let found = usual.estimated(&pairs);
        assert!((found.of_log - 0.47).abs() < 0.03, "{}", found.of_log);
        assert!(found.are_frequent());
        assert!(found.of_place[0] > 0.85 && found.of_place[1] < 0.1, "{:?}", found.of_place);
    }

    #[test]
    fn silence_that_power_explains_is_no_outage() {
        let usual = Outages { of_log: USUAL, of_place: vec![USUAL; 10] };
        let pairs: Vec<NodeAndPlace> = (0..400)
            .map(|number| NodeAndPlace { place: number % 10, silence: 0.7, is_silent: number % 10 < 7 })
            .collect();
        let found = usual.estimated(&pairs);
        assert!(found.of_log < 0.01 && !found.are_frequent(), "{}", found.of_log);
        // A node that is silent where it should be heard is dead more often than others.
        let silent: Vec<NodeAndPlace> =
            (0..10).map(|place| NodeAndPlace { place, silence: 0.02, is_silent: true }).collect();
        let of_node = found.of_node(&silent);
        assert!(of_node.iter().all(|outage| *outage > 3.0 * found.of_log), "{of_node:?}");
    }
}
