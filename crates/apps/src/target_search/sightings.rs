//! Measured places of a target, from what the nodes detected.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use sextant_channel::{Bounds, Position};
use sextant_kernel::{NodeId, SimTime};

use super::target_state::Fix;

/// How much the first guess of the scatter counts, in degrees of freedom.
const GUESS_WEIGHT: f64 = 4.0;

/// How measured places are worked out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SightingsSettings {
    /// Time between sample times, which are its multiples. Not zero.
    pub period: Duration,
    /// First guess of the variance of a node's place about the target that it detects, along each axis (m²). What the
    /// nodes say soon outweighs it. A disc of radius r has r²/4.
    pub scatter_m2: f64,
    /// Least variance of a measured place along each axis (m²), for the errors of the map. Above 0.
    pub least_variance_m2: f64,
}

impl Default for SightingsSettings {
    fn default() -> Self {
        Self { period: Duration::from_secs(1), scatter_m2: 1.0, least_variance_m2: 0.01 }
    }
}

/// A time during which a node detected the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Sighting {
    /// When the target entered the radius of detection.
    pub entered: SimTime,
    /// When it left; `None` if it was still inside when the node answered.
    pub left: Option<SimTime>,
}

/// What one node answered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeSightings<'a> {
    /// The node.
    pub node: NodeId,
    /// Its place on the map (m).
    pub place: Position,
    /// The answer tells all sightings from this instant on.
    pub since: SimTime,
    /// When the node answered.
    pub until: SimTime,
    /// The sightings, in any order.
    pub sightings: &'a [Sighting],
}

/// All that is known of the nodes that detected one target.
///
/// The place of the target at a sample time is the mean of the places of the nodes that detected it then, each counted
/// once, however often it answered. Answers may come in any order, and more than once: the result is the same.
#[derive(Clone, Debug)]
pub(crate) struct Sightings {
    settings: SightingsSettings,
    places: BTreeMap<NodeId, Position>,
    /// The nodes that detected the target at a sample time.
    detecting: BTreeMap<u64, BTreeSet<NodeId>>,
    /// The nodes whose answers tell of a sample time.
    answered: BTreeMap<u64, BTreeSet<NodeId>>,
}

impl Sightings {
    /// Nothing is known.
    #[must_use]
    pub(crate) fn new(settings: SightingsSettings) -> Self {
        Self { settings, places: BTreeMap::new(), detecting: BTreeMap::new(), answered: BTreeMap::new() }
    }

    /// Adds what a node answered. A sighting between two sample times counts for the one nearest to its middle, once
    /// it has ended.
    pub(crate) fn add(&mut self, told: &NodeSightings<'_>) {
        self.places.insert(told.node, told.place);
        for sample in self.first_from(told.since)..=self.last_until(told.until) {
            self.answered.entry(sample).or_default().insert(told.node);
        }
        for sighting in told.sightings {
            let end = sighting.left.unwrap_or(told.until);
            let (first, last) = (self.first_from(sighting.entered), self.last_until(end));
            for sample in first..=last {
                self.detecting.entry(sample).or_default().insert(told.node);
            }
            if first > last && sighting.left.is_some() {
                let to_last = sighting.entered.saturating_since(self.time(last));
                let from_first = self.time(first).saturating_since(end);
                let nearest = if to_last <= from_first { last } else { first };
                self.detecting.entry(nearest).or_default().insert(told.node);
            }
        }
    }

    /// The measured places at all sample times at which a node detected the target, in order of time.
    #[must_use]
    pub(crate) fn fixes(&self) -> Vec<(SimTime, Fix)> {
        let scatter_m2 = self.scatter_m2();
        let fix = |nodes: &BTreeSet<NodeId>| Fix {
            place: self.mean(nodes),
            variance_m2: (scatter_m2 / nodes.len() as f64).max(self.settings.least_variance_m2),
        };
        self.detecting.iter().map(|(&sample, nodes)| (self.time(sample), fix(nodes))).collect()
    }

    /// The nodes that detected the target at each sample time, by where they are: in groups whose nodes are within one and a
    /// half times `radius_m` of their mean.
    pub(super) fn groups(&self, radius_m: f64) -> Vec<(SimTime, Position, BTreeSet<NodeId>)> {
        let mut groups = Vec::new();
        for (&sample, nodes) in &self.detecting {
            let mut left = nodes.clone();
            while let Some(group) = self.densest(&left, radius_m) {
                left.retain(|node| !group.contains(node));
                groups.push((self.time(sample), self.mean(&group), group));
            }
        }
        groups
    }

    /// The nodes around the one of `nodes` that has the most others near it.
    fn densest(&self, nodes: &BTreeSet<NodeId>, radius_m: f64) -> Option<BTreeSet<NodeId>> {
        let near = |place: Position, reach_m: f64| -> BTreeSet<NodeId> {
            nodes.iter().copied().filter(|node| self.places[node].distance_m(place) <= reach_m).collect()
        };
        let core = nodes.iter().map(|node| near(self.places[node], radius_m)).max_by_key(BTreeSet::len)?;
        let group = near(self.mean(&core), 1.5 * radius_m);
        Some(if group.is_empty() { core } else { group })
    }

    /// The same with these detections alone: nothing is known of the others.
    pub(super) fn only(&self, kept: &[(SimTime, BTreeSet<NodeId>)]) -> Self {
        let detecting: BTreeMap<u64, BTreeSet<NodeId>> =
            kept.iter().map(|(time, nodes)| (self.last_until(*time), nodes.clone())).collect();
        let mut answered = self.answered.clone();
        for (sample, nodes) in &self.detecting {
            if let Some(answered) = answered.get_mut(sample) {
                answered.retain(|node| {
                    !nodes.contains(node) || detecting.get(sample).is_some_and(|of| of.contains(node))
                });
            }
        }
        Self { settings: self.settings, places: self.places.clone(), detecting, answered }
    }

    /// The last sample time at which a node is known to have detected the target.
    #[must_use]
    pub(crate) fn latest(&self) -> Option<SimTime> {
        self.detecting.keys().next_back().map(|&sample| self.time(sample))
    }

    /// Places of the nodes that detected the target at a sample time (m).
    pub(crate) fn detecting_at(&self, time: SimTime) -> impl Iterator<Item = Position> {
        self.detecting.get(&self.last_until(time)).into_iter().flatten().map(|node| self.places[node])
    }

    /// Places of the nodes that are known not to have detected the target at a sample time (m).
    pub(crate) fn silent_at(&self, time: SimTime) -> impl Iterator<Item = Position> {
        let sample = self.last_until(time);
        let detecting = self.detecting.get(&sample);
        let answered = self.answered.get(&sample).into_iter().flatten();
        answered.filter(move |node| detecting.is_none_or(|nodes| !nodes.contains(node))).map(|node| self.places[node])
    }

    /// Variance of a node's place about the mean of those that detect the target with it, along each axis (m²): that
    /// of all sample times together, and the first guess.
    fn scatter_m2(&self) -> f64 {
        let axes = match Bounds::of(self.places.values().copied()) {
            Some(Bounds { min, max }) if max.z_m > min.z_m => 3.0,
            _ => 2.0,
        };
        let (mut squares_m2, mut freedom) = (GUESS_WEIGHT * self.settings.scatter_m2, GUESS_WEIGHT);
        for nodes in self.detecting.values() {
            let mean = self.mean(nodes);
            squares_m2 += nodes.iter().map(|node| self.places[node] - mean).map(|off| off.dot(off)).sum::<f64>();
            freedom += axes * (nodes.len() - 1) as f64;
        }
        squares_m2 / freedom
    }

    /// Mean place of `nodes`, which are not none.
    fn mean(&self, nodes: &BTreeSet<NodeId>) -> Position {
        let sum = nodes.iter().fold(Position::ORIGIN, |sum, node| sum + self.places[node]);
        sum * (1.0 / nodes.len() as f64)
    }

    fn period_nanos(&self) -> u64 {
        u64::try_from(self.settings.period.as_nanos()).unwrap_or(u64::MAX).max(1)
    }

    /// The last sample time at `time` or earlier.
    pub(super) fn sample_time(&self, time: SimTime) -> SimTime {
        self.time(self.last_until(time))
    }

    /// Number of the first sample time at `time` or later.
    fn first_from(&self, time: SimTime) -> u64 {
        time.as_nanos().div_ceil(self.period_nanos())
    }

    /// Number of the last sample time at `time` or earlier.
    fn last_until(&self, time: SimTime) -> u64 {
        time.as_nanos() / self.period_nanos()
    }

    fn time(&self, sample: u64) -> SimTime {
        SimTime::from_nanos(sample.saturating_mul(self.period_nanos()))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn at(millis: u64) -> SimTime {
        SimTime::ZERO + Duration::from_millis(millis)
    }

    /// An answer at `until` of the node at x = `node`.
    fn add(sightings: &mut Sightings, node: u32, until: u64, told: &[(u64, Option<u64>)]) {
        let told: Vec<_> =
            told.iter().map(|&(entered, left)| Sighting { entered: at(entered), left: left.map(at) }).collect();
        sightings.add(&NodeSightings {
            node: NodeId(node),
            place: Position::new(f64::from(node), 0.0, 0.0),
            since: SimTime::ZERO,
            until: at(until),
            sightings: &told,
        });
    }

    fn empty() -> Sightings {
        Sightings::new(SightingsSettings::default())
    }

    /// Sample times in seconds and the measured x.
    fn xs(sightings: &Sightings) -> Vec<(f64, f64)> {
        sightings.fixes().iter().map(|(time, fix)| (time.as_secs_f64(), fix.place.x_m)).collect()
    }

    #[test]
    fn a_place_is_the_mean_of_the_nodes_that_detected_the_target_each_counted_once() {
        let mut sightings = empty();
        add(&mut sightings, 2, 5000, &[(900, Some(2100))]);
        add(&mut sightings, 4, 5000, &[(1500, Some(3200))]);
        let once = xs(&sightings);
        assert_eq!(once, [(1.0, 2.0), (2.0, 3.0), (3.0, 4.0)]);
        add(&mut sightings, 2, 6000, &[(900, Some(2100))]);
        assert_eq!(xs(&sightings), once, "an answer that is repeated");
        assert_eq!(sightings.latest(), Some(at(3000)));
    }

    #[test]
    fn a_sighting_that_goes_on_counts_until_the_answer() {
        let mut sightings = empty();
        add(&mut sightings, 1, 2500, &[(500, None)]);
        assert_eq!(xs(&sightings), [(1.0, 1.0), (2.0, 1.0)]);
        add(&mut sightings, 1, 9000, &[(500, Some(4100))]);
        assert_eq!(xs(&sightings).len(), 4);
    }

    #[test]
    fn a_short_sighting_counts_for_the_nearest_sample_time_once_it_has_ended() {
        let mut sightings = empty();
        add(&mut sightings, 1, 1500, &[(1300, None)]);
        assert_eq!(xs(&sightings), []);
        add(&mut sightings, 1, 8000, &[(1300, Some(1600)), (5500, Some(5900))]);
        assert_eq!(xs(&sightings), [(1.0, 1.0), (6.0, 1.0)]);
    }

    #[test]
    fn nodes_that_answered_without_a_sighting_are_silent() {
        let mut sightings = empty();
        add(&mut sightings, 1, 3000, &[(1900, Some(2500))]);
        add(&mut sightings, 2, 3000, &[]);
        let silent = |millis| sightings.silent_at(at(millis)).map(|place| place.x_m).collect::<Vec<_>>();
        assert_eq!(silent(2000), [2.0]);
        assert_eq!(silent(3000), [1.0, 2.0]);
        assert_eq!(silent(4000), [0.0; 0]);
        assert_eq!(sightings.detecting_at(at(2000)).map(|place| place.x_m).collect::<Vec<_>>(), [1.0]);
    }

    #[test]
    fn the_variance_is_that_of_the_mean_of_nodes_scattered_over_a_disc() {
        // Nodes on a fine lattice in a disc of 3 m: r²/4 along each axis.
        let mut sightings = Sightings::new(SightingsSettings { least_variance_m2: 1e-9, ..Default::default() });
        let lattice = (-30..=30).flat_map(|x| (-30..=30).map(move |y| (0.1 * f64::from(x), 0.1 * f64::from(y))));
        let disc = lattice.map(|(x, y)| Position::new(x, y, 0.0)).filter(|place| place.length_m() <= 3.0);
        let mut count = 0;
        for (node, place) in disc.enumerate() {
            let sighting = [Sighting { entered: SimTime::ZERO, left: None }];
            let node = NodeId::from_index(node);
            sightings.add(&NodeSightings {
                node,
                place,
                since: SimTime::ZERO,
                until: SimTime::ZERO,
                sightings: &sighting,
            });
            count += 1;
        }
        let (_, fix) = sightings.fixes()[0];
        let expected = 2.25 / f64::from(count);
        assert!((fix.variance_m2 / expected - 1.0).abs() < 0.01, "{} for {expected}", fix.variance_m2);
        assert!(fix.place.length_m() < 1e-12);
    }

    #[test]
    fn one_node_alone_has_the_variance_of_the_first_guess() {
        let mut sightings = empty();
        add(&mut sightings, 3, 1000, &[(1000, None)]);
        assert_eq!(sightings.fixes(), [(at(1000), Fix { place: Position::new(3.0, 0.0, 0.0), variance_m2: 1.0 })]);
    }

    proptest! {
        #[test]
        fn the_order_of_the_answers_does_not_matter(
            answers in prop::collection::vec((0_u32..5, 0_u64..9000, 1_u64..3000, 0_u64..12000), 1..12),
            turn in 0_usize..12,
        ) {
            let told = |order: &mut dyn Iterator<Item = &(u32, u64, u64, u64)>| {
                let mut sightings = empty();
                for &(node, entered, length, until) in order {
                    if entered <= until {
                        let left = entered + length;
                        add(&mut sightings, node, until, &[(entered, (left <= until).then_some(left))]);
                    }
                }
                let fixes = sightings.fixes();
                let silent: Vec<_> = (0..12).map(|k| sightings.silent_at(at(1000 * k)).count()).collect();
                (fixes, silent)
            };
            let mut turned = answers.clone();
            turned.rotate_left(turn % answers.len());
            prop_assert_eq!(told(&mut answers.iter()), told(&mut turned.iter()));
            prop_assert_eq!(told(&mut answers.iter()), told(&mut answers.iter().rev().chain(&answers)));
        }
    }
}
