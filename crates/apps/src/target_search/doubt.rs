//! How much detections are believed whose sensors raise false alarms.

use std::f64::consts::PI;
use std::time::Duration;

use sextant_channel::{Bounds, Position};
use sextant_kernel::SimTime;
use sextant_sim::TargetSensor;

/// Detections within this time of each other confirm each other.
pub(super) const CONFIRMING: Duration = Duration::from_secs(1);
/// Time in which false alarms alone confirm a target once, on average (s).
const FALSE_CONFIRMATION_S: f64 = 600.0;
/// Most nodes that are asked for.
const MOST_NODES: u8 = 32;
/// A sensor detects a target within its radius with this probability at most: places on a map are not exact.
const SUREST: f64 = 0.9;
/// Least probability that a sensor raises a false alarm at an instant.
const RAREST: f64 = 1e-6;
/// The score of a group that may be a target if nothing else is known.
const LEAST_SCORE: f64 = 0.1;

/// What is known of sensors that raise false alarms, and of the network that they are in.
///
/// A group of nodes that detect a target at the same time has a score: the logarithm of the likelihood ratio of "the target
/// is there" and "all are false alarms" (track score, Sittler 1964; Bar-Shalom, Li, Kirubarajan 2001). Nodes that should
/// detect the target with the group, and do not, count against it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubt {
    radius_m: f64,
    /// Area of the network, seen from above (m²).
    area_m2: f64,
    /// Mean number of nodes within the radius of a place.
    expected: f64,
    /// What a node that detects the target adds to the score, and one that does not takes from it.
    detecting: f64,
    silent: f64,
    confirming: u8,
}

impl Doubt {
    /// Of nodes at these places with such sensors; `None` if these raise no false alarms.
    #[must_use]
    pub fn new(sensor: &TargetSensor, places: impl Iterator<Item = Position> + Clone) -> Option<Self> {
        let rate_per_s = sensor.false_alarms_per_s();
        let area_m2 = area_m2(Bounds::of(places.clone())?);
        if rate_per_s <= 0.0 || area_m2 <= 0.0 {
            return None;
        }
        let (nodes, radius_m) = (places.count() as f64, sensor.radius_m());
        let expected = (nodes / area_m2 * PI * radius_m * radius_m).min(nodes);
        let is_false = (rate_per_s * sensor.false_alarm().as_secs_f64()).clamp(RAREST, 0.5);
        let is_true = (1.0 - sensor.miss_probability()).clamp(is_false, SUREST);
        // Nodes within two radii of a node: all that may detect the target with it.
        let others = (4.0 * expected).min(nodes) * rate_per_s * CONFIRMING.as_secs_f64();
        Some(Self {
            radius_m,
            area_m2,
            expected,
            detecting: libm::log(is_true / is_false),
            silent: libm::log((1.0 - is_false) / (1.0 - is_true)),
            confirming: confirming(nodes * rate_per_s, others),
        })
    }

    /// Number of nodes that have to detect a target within [`CONFIRMING`] of each other.
    pub(super) fn confirming(&self) -> u8 {
        self.confirming
    }

    /// The score of a group of `nodes` that detect the target.
    pub(super) fn score(&self, nodes: usize) -> f64 {
        let nodes = nodes as f64;
        nodes * self.detecting - (self.expected - nodes).max(0.0) * self.silent
    }

    /// The score of what a sink told, which is looked at if nothing else is known.
    pub(super) fn told_score(&self, nodes: u8) -> f64 {
        self.score(nodes.into()).max(LEAST_SCORE)
    }

    /// Two nodes that detect the target at the same time are at most this far apart, where one metre is `scale` long (m).
    pub(super) fn reach_m(&self, scale: f64) -> f64 {
        2.0 * self.radius_m * scale
    }

    /// Length of one metre on a map with these bounds, if the whole network is on it.
    pub(super) fn scale_of(&self, map: Bounds) -> f64 {
        (area_m2(map) / self.area_m2).sqrt()
    }
}

/// The least number of nodes in a group that false alarms alone make up only rarely. There are `rate_per_s` of them in
/// the network, and `others` on average with each of them: n more with the probability of a Poisson distribution, `others^n
/// / n!` at most.
fn confirming(rate_per_s: f64, others: f64) -> u8 {
    let (mut nodes, mut groups_per_s) = (1, rate_per_s);
    while (groups_per_s * FALSE_CONFIRMATION_S > 1.0 || nodes < 2) && nodes < MOST_NODES {
        groups_per_s *= others / f64::from(nodes);
        nodes += 1;
    }
    nodes
}

fn area_m2(bounds: Bounds) -> f64 {
    let size = bounds.max - bounds.min;
    size.x_m * size.y_m
}

/// A group of nodes that detect a target at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Group {
    pub(super) time: SimTime,
    /// Mean place of its nodes (m).
    pub(super) place: Position,
    pub(super) score: f64,
}

/// The numbers of the groups that a target can visit in turn with the largest sum of scores, by dynamic programming (Wolf,
/// Viterbi, Dixon 1989). `groups` are in order of time. From one to the next, the target covers at most `speed_m_per_s`
/// times the time between them, and `reach_m`. Groups that do not score are left out.
pub(super) fn best_track(groups: &[Group], speed_m_per_s: f64, reach_m: f64) -> Vec<usize> {
    let mut best: Vec<(f64, Option<usize>)> = Vec::with_capacity(groups.len());
    for (i, group) in groups.iter().enumerate() {
        let follows = |before: &Group| {
            let span_s = group.time.saturating_since(before.time).as_secs_f64();
            before.time < group.time && before.place.distance_m(group.place) <= speed_m_per_s * span_s + reach_m
        };
        let before = (0..i).filter(|&j| best[j].0 > 0.0 && follows(&groups[j]));
        let before = before.max_by(|&a, &b| best[a].0.total_cmp(&best[b].0));
        let so_far = before.map_or(0.0, |j| best[j].0);
        best.push((if group.score > 0.0 { so_far + group.score } else { f64::NEG_INFINITY }, before));
    }
    let mut at = (0..groups.len()).filter(|&i| best[i].0 > 0.0).max_by(|&a, &b| best[a].0.total_cmp(&best[b].0));
    let mut track = Vec::new();
    while let Some(i) = at {
        track.push(i);
        at = best[i].1;
    }
    track.reverse();
    track
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use sextant_sim::TargetSensorConfig;

    use super::*;

    fn at(seconds: f64) -> SimTime {
        SimTime::ZERO + Duration::from_secs_f64(seconds)
    }

    fn group(seconds: f64, x_m: f64, score: f64) -> Group {
        Group { time: at(seconds), place: Position::new(x_m, 0.0, 0.0), score }
    }

    /// 1400 nodes on 60 m x 30 m.
    fn doubt(false_alarms_per_h: f64) -> Option<Doubt> {
        let sensor = TargetSensorConfig { false_alarms_per_h, ..TargetSensorConfig::perfect(1.5) };
        let places =
            (0..1400).map(|i| Position::new(f64::from(i % 56) / 55.0 * 60.0, f64::from(i / 56) / 24.0 * 30.0, 0.0));
        Doubt::new(&sensor.try_into().expect("a good sensor"), places)
    }

    #[test]
    fn more_nodes_have_to_agree_the_more_false_alarms_there_are() {
        assert_eq!(doubt(0.0), None);
        let confirming = |per_h| doubt(per_h).expect("doubt").confirming();
        // 0.39 a second, 22 nodes within two radii: 0.39 · 0.0061 = 0.0024 pairs a second, and 7e-6 groups of three.
        assert_eq!(confirming(1.0), 3);
        assert_eq!((confirming(0.001), confirming(10.0), confirming(60.0)), (2, 4, 6));
    }

    #[test]
    fn a_lone_detection_among_silent_nodes_is_no_target_and_three_are() {
        let doubt = doubt(60.0).expect("doubt");
        assert!(doubt.score(1) < 0.0, "{}", doubt.score(1));
        assert!(doubt.score(3) > 0.0 && doubt.score(5) > doubt.score(3));
        assert!(doubt.told_score(1) > 0.0);
        let bounds = Bounds { min: Position::ORIGIN, max: Position::new(120.0, 60.0, 0.0) };
        assert!((doubt.scale_of(bounds) - 2.0).abs() < 1e-9);
        assert!((doubt.reach_m(2.0) - 6.0).abs() < 1e-12);
    }

    #[test]
    fn a_false_alarm_far_from_the_track_is_left_out_even_as_the_first_one() {
        let track = |groups: &[Group]| best_track(groups, 2.0, 3.0);
        let groups = [
            group(0.0, 50.0, 2.0),
            group(0.5, 0.0, 5.0),
            group(1.0, 1.0, 5.0),
            group(1.5, 40.0, 3.0),
            group(2.0, 2.0, 5.0),
        ];
        assert_eq!(track(&groups), [1, 2, 4]);
        // Until the true one is known, the false one is all that there is.
        assert_eq!(track(&groups[..1]), [0]);
        // Groups of an instant exclude each other, and those without a score are left out.
        assert_eq!(track(&[group(1.0, 0.0, 1.0), group(1.0, 0.1, 2.0), group(2.0, 0.0, -1.0)]), [1]);
        assert_eq!(track(&[]), [0; 0]);
    }

    proptest! {
        #[test]
        fn the_track_is_the_best_of_all_that_groups_with_a_score_allow(
            drawn in prop::collection::vec((0_u32..6, -9.0..9.0_f64, -1.0..3.0_f64), 0..9),
        ) {
            let mut groups: Vec<Group> = drawn.iter().map(|&(t, x, score)| group(t.into(), x, score)).collect();
            groups.sort_by_key(|group| group.time);
            let is_possible = |track: &[usize]| track.windows(2).all(|pair| {
                let (a, b) = (groups[pair[0]], groups[pair[1]]);
                let span_s = b.time.saturating_since(a.time).as_secs_f64();
                b.time > a.time && a.place.distance_m(b.place) <= 2.0 * span_s + 3.0
            });
            let sum = |track: &[usize]| track.iter().map(|&i| groups[i].score).sum::<f64>();
            let scoring: Vec<usize> = (0..groups.len()).filter(|&i| groups[i].score > 0.0).collect();
            let subsets = (0_u32..1 << scoring.len()).map(|set| {
                let chosen = scoring.iter().enumerate().filter(|(k, _)| set >> k & 1 == 1);
                chosen.map(|(_, &i)| i).collect::<Vec<_>>()
            });
            let most = subsets.filter(|track| is_possible(track)).map(|track| sum(&track)).fold(0.0, f64::max);
            let found = best_track(&groups, 2.0, 3.0);
            prop_assert!(is_possible(&found));
            prop_assert!((sum(&found) - most).abs() < 1e-9, "{} of {most}", sum(&found));
        }
    }
}
