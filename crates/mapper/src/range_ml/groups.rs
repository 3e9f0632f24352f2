//! Ranges that were measured at nearly one place count once, because their errors are nearly the same.

use sextant_channel::{Bounds, Position, RangeSample, ReceptionLog};
use sextant_kernel::NodeId;

use crate::numerics::median;

/// On the way, ranges over this length of path are one group (m): the errors of ultra-wideband and of round-trip times change over
/// about half a metre to a metre.
const LENGTH_M: f64 = 0.5;

/// Nodes with so many groups each have many.
const MANY: usize = 30;

/// Ranges to a node that were measured one after the other at nearly one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RangeGroup {
    /// Their median (m).
    pub(super) range_m: f64,
    /// The mean place of the robot (m).
    pub(super) position: [f64; 3],
    /// Its mean velocity (m/s).
    pub(super) velocity: [f64; 3],
}

/// The groups of the nodes that have enough of them to be placed.
#[derive(Clone, Debug, Default)]
pub(super) struct RangeGroups {
    /// These nodes.
    pub(super) nodes: Vec<NodeId>,
    groups: Vec<RangeGroup>,
    /// Where those of each node begin, and the end of the last.
    first: Vec<usize>,
}

impl RangeGroups {
    /// The groups of the ranges in `log`, of nodes with so many of them as are `wanted`.
    pub(super) fn of(log: &ReceptionLog, wanted: impl Fn(usize) -> bool) -> Self {
        let mut all = Self { nodes: Vec::new(), groups: Vec::new(), first: vec![0] };
        for node in (0..log.node_count()).map(NodeId::from_index) {
            let before = all.groups.len();
            // Each antenna has runs of its own.
            let mut samples = log.ranges_to(node).to_vec();
            samples.sort_by_key(|sample| sample.mounting.antenna);
            all.groups.extend(runs(&samples).map(group));
            if wanted(all.groups.len() - before) {
                all.nodes.push(node);
                all.first.push(all.groups.len());
            } else {
                all.groups.truncate(before);
            }
        }
        all
    }

    /// Those of the node with this number among `nodes`, in the order of time.
    pub(super) fn of_node(&self, node: usize) -> &[RangeGroup] {
        &self.groups[self.first[node]..self.first[node + 1]]
    }

    /// The same without the nodes with these numbers, in ascending order.
    pub(super) fn without(&self, left_out: &[usize]) -> Self {
        let mut all = Self { nodes: Vec::new(), groups: Vec::new(), first: vec![0] };
        for (number, &node) in self.nodes.iter().enumerate() {
            if left_out.binary_search(&number).is_err() {
                all.nodes.push(node);
                all.groups.extend_from_slice(self.of_node(number));
                all.first.push(all.groups.len());
            }
        }
        all
    }

    /// The same with ranges that are so many times as long.
    pub(super) fn times(&self, factor: f64) -> Self {
        let mut all = self.clone();
        all.groups.iter_mut().for_each(|group| group.range_m *= factor);
        all
    }

    /// Whether the ranges are so few that what is fitted to them takes away much of their errors.
    pub(super) fn are_few(&self) -> bool {
        self.len() < MANY * self.nodes.len()
    }

    /// The same with ranges that are so much longer (m).
    pub(super) fn longer_by(&self, more_m: f64) -> Self {
        let mut all = self.clone();
        all.groups.iter_mut().for_each(|group| group.range_m += more_m);
        all
    }

    /// How long the shortest ranges are (m), but for one in so many.
    pub(super) fn short_m(&self, one_in: usize) -> f64 {
        let mut ranges: Vec<f64> = self.groups.iter().map(|group| group.range_m).collect();
        let at = ranges.len() / one_in;
        ranges.select_nth_unstable_by(at, f64::total_cmp);
        ranges[at]
    }

    /// The share of the curvature of a node that is taken from the slopes that the law has on average, and not from those of its groups:
    /// a few of these tell little.
    pub(super) fn usual_slopes(&self, number: usize) -> f64 {
        /// So many slopes tell as much as the law does, and so many tell enough.
        const SLOPES: (f64, f64) = (50.0, 20.0);
        let groups = self.of_node(number).len() as f64;
        if self.are_few() || groups < SLOPES.1 { SLOPES.0 / (SLOPES.0 + groups) } else { 0.0 }
    }

    /// How large the way is on which they were measured (m).
    pub(super) fn way_m(&self) -> f64 {
        let places = self.groups.iter().map(|group| Position::from(group.position));
        Bounds::of(places).map_or(0.0, |bounds| bounds.min.distance_m(bounds.max))
    }

    /// How long the ranges usually are (m).
    pub(super) fn usual_m(&self) -> f64 {
        median(&mut self.groups.iter().map(|group| group.range_m.abs()).collect::<Vec<_>>())
    }

    /// Number of groups.
    pub(super) fn len(&self) -> usize {
        self.groups.len()
    }
}

/// Whether two ranges are of one group, of which `first` is the first.
fn is_near(first: &RangeSample, other: &RangeSample) -> bool {
    let drives = first.velocity != Position::ORIGIN || other.velocity != Position::ORIGIN;
    let apart_m = first.position.distance_m(other.position);
    let is_one = first.robot == other.robot && first.mounting.antenna == other.mounting.antenna;
    is_one && (apart_m <= 0.0 || drives && apart_m <= LENGTH_M)
}

fn group(samples: &[RangeSample]) -> RangeGroup {
    let mut ranges: Vec<f64> = samples.iter().map(|sample| sample.range_m).collect();
    let mean = |of: fn(&RangeSample) -> Position| {
        let sum = samples.iter().fold(Position::ORIGIN, |sum, sample| sum + of(sample));
        (sum * (1.0 / samples.len() as f64)).into()
    };
    RangeGroup {
        range_m: median(&mut ranges),
        position: mean(|sample| sample.position),
        velocity: mean(|sample| sample.velocity),
    }
}

/// Runs of ranges of one group each.
fn runs(samples: &[RangeSample]) -> impl Iterator<Item = &[RangeSample]> {
    let mut rest = samples;
    std::iter::from_fn(move || {
        let first = rest.first()?;
        let length = rest.iter().position(|other| !is_near(first, other)).unwrap_or(rest.len()).max(1);
        let (run, after) = rest.split_at(length);
        rest = after;
        Some(run)
    })
}

#[cfg(test)]
mod tests {
    use sextant_channel::Stop;

    use super::*;

    fn sample(node: u32, x_m: f64, speed: f64, range_m: f64) -> RangeSample {
        let (position, velocity) = (Position::new(x_m, 0.0, 0.0), Position::new(speed, 0.0, 0.0));
        RangeSample { velocity, ..RangeSample::of(NodeId(node), position, range_m) }
    }

    #[test]
    fn ranges_of_one_place_and_of_half_a_metre_of_path_are_one_group() {
        let stop = Stop::at(Position::ORIGIN);
        let log = ReceptionLog::new(vec!["a".into(), "b".into()], vec![stop], Vec::new(), Vec::new()).unwrap();
        let driving = [0.0, 0.3, 0.5, 0.9, 1.0].map(|x_m| sample(1, x_m, 1.0, 5.0 + x_m));
        let standing =
            [(0.0, 4.0), (0.0, 9.0), (0.0, 5.0), (0.4, 7.0)].map(|(x_m, range)| sample(0, x_m, 0.0, range));
        let log = log.with_ranges(driving.into_iter().chain(standing).collect()).unwrap();
        let groups = RangeGroups::of(&log, |count| count > 0);
        let ranges = |node| -> Vec<f64> { groups.of_node(node).iter().map(|group| group.range_m).collect() };
        assert_eq!(ranges(0), [5.0, 7.0]);
        assert_eq!(ranges(1).len(), 2);
        assert!((ranges(1)[0] - 5.3).abs() < 1e-12 && (ranges(1)[1] - 5.95).abs() < 1e-12);
        assert!((groups.of_node(1)[1].position[0] - 0.95).abs() < 1e-12);
    }
}
