//! Lateration: a node is where its distances, or their differences, say.

use sextant_channel::Position;
use sextant_kernel::{NodeId, SettingError, Watch};

use crate::comparators::lateration::{
    LaterationError, Range, differences_tell_distance, locate_by_differences, multilaterate,
};
use crate::comparators::{Comparator, node_by_node};
use crate::error::MapError;
use crate::estimator::{AnyLog, EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::posterior::Concern;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// Lateration as written in a scenario. It has no settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TimeOfArrivalConfig {}

/// Lateration by differences as written in a scenario. It has no settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TimeDifferenceConfig {}

/// A node is where its measured ranges fit best by least squares, by [`multilaterate`]: the maximum of the likelihood of normal errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeOfArrival;

/// A node is where the differences of its measured ranges fit best by least squares, by [`locate_by_differences`]: all ranges of a node
/// may be wrong by one length, as those by a clock that is not that of the robot are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeDifference;

/// How ranges place a node in two or three dimensions.
type Locate = fn(&[Range], usize) -> Result<Position, LaterationError>;

/// Whether ranges tell a place that was found in two or three dimensions.
type Tells = fn(&[Range], usize, Position) -> bool;

/// The map of the nodes of a log by `locate`. Nodes with too few ranges are not placed.
fn map_by_ranges(
    algorithm: &'static str,
    (locate, tells): (Locate, Tells),
    knowledge: &Knowledge<'_>,
    watch: &dyn Watch,
) -> Result<TopologyMap, MapError> {
    let log = knowledge.log;
    if log.ranges().is_empty() {
        return Err(MapError::Missing {
            algorithm,
            what: "measured ranges",
            remedy: "they stand in `ranges.csv` beside the stops or the path",
        });
    }
    let level_m = log.ranges()[0].position.z_m;
    let is_level = log.ranges().iter().all(|range| (range.position.z_m - level_m).abs() <= 1e-9);
    let dimensions = if is_level { 2 } else { 3 };
    let operations = log.ranges().len() as f64 / log.node_count().max(1) as f64;
    let ranges = |node: usize| -> Vec<Range> {
        let samples = log.ranges_to(NodeId::from_index(node));
        samples.iter().map(|range| Range::new(range.position, range.range_m)).collect()
    };
    let places =
        node_by_node(algorithm, log.node_count(), operations, watch, |node| locate(&ranges(node), dimensions).ok())?;
    let mut map = TopologyMap::of_places(algorithm, places, CoordinateFrame::World);
    for (node, estimate) in map.estimates.iter_mut().enumerate() {
        if let Some(estimate) = estimate {
            let is_told = tells(&ranges(node), dimensions, estimate.position);
            estimate.concern = (!is_told).then_some(Concern::NoEvidence);
        }
    }
    Ok(map)
}

/// An estimator by measured ranges.
macro_rules! by_ranges {
    ($estimator:ident, $config:ident, $name:literal, $rank:literal, $locate:path, $tells:expr, $description:literal) => {
        impl Comparator for $estimator {
            const NAME: &'static str = $name;

            fn uses(&self) -> &'static [KnowledgeKind] {
                &[KnowledgeKind::RobotRanges]
            }

            fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
                map_by_ranges(Self::NAME, ($locate, $tells), knowledge, watch)
            }
        }

        impl EstimatorSettings for $config {
            const ANY_LOG: Option<AnyLog> =
                Some(AnyLog { name: $name, rank: $rank, description: $description, settings: "{}" });

            fn mapper(self) -> Result<Mapper, SettingError> {
                Ok(Mapper::new($estimator))
            }
        }
    };
}

by_ranges!(
    TimeOfArrival,
    TimeOfArrivalConfig,
    "time-of-arrival",
    11,
    multilaterate,
    |_, _, _| true,
    "Least squares on measured ranges, which are taken to be right on average"
);
by_ranges!(
    TimeDifference,
    TimeDifferenceConfig,
    "time-difference",
    12,
    locate_by_differences,
    differences_tell_distance,
    "Least squares on the differences of measured ranges, of which all of a node may be wrong by one length"
);

#[cfg(test)]
mod tests {
    use sextant_channel::{RangeSample, ReceptionLog, Stop};
    use sextant_kernel::SimTime;

    use super::*;

    /// Ranges that are `longer_m` too long, from the sides of a square.
    fn log(node: Position, longer_m: f64, up_m: f64) -> ReceptionLog {
        let position = |i: u32| {
            let along = f64::from(i % 10);
            let (x_m, y_m) = [(along, 0.0), (10.0, along), (10.0 - along, 10.0)][(i / 10) as usize];
            Position::new(x_m, y_m, 0.4 + up_m * f64::from(i % 3))
        };
        let sample = |i: u32| RangeSample {
            time: SimTime::from_nanos(u64::from(i)),
            ..RangeSample::of(NodeId(0), position(i), position(i).distance_m(node) + longer_m)
        };
        let stop = Stop::at(position(0));
        let log = ReceptionLog::new(vec!["n0".into(), "unheard".into()], vec![stop], vec![], vec![]).unwrap();
        log.with_ranges((0..30).map(sample).collect()).unwrap()
    }

    #[test]
    fn right_ranges_give_the_place_and_differences_do_so_whatever_the_clock_says() {
        for (node, up_m) in [(Position::new(3.0, 4.0, 0.4), 0.0), (Position::new(13.0, 4.0, 2.0), 0.7)] {
            let off = |mapper: Mapper, longer_m: f64| {
                let map = mapper.map(&log(node, longer_m, up_m)).unwrap();
                assert_eq!(map.unmapped(), 1);
                assert_eq!(map.estimates[0].as_ref().unwrap().concern, None);
                map.positions()[0].unwrap().distance_m(node)
            };
            assert!(off(Mapper::new(TimeOfArrival), 0.0) < 1e-6);
            assert!(off(Mapper::new(TimeOfArrival), 2.0) > 0.1);
            assert!(off(Mapper::new(TimeDifference), 0.0) < 1e-6);
            assert!(off(Mapper::new(TimeDifference), 25.0) < 1e-6);
        }
    }

    #[test]
    fn a_place_far_beyond_all_stops_has_no_evidence() {
        // On a way that is nearly straight, ranges that grow by as much as the robot drives are those of any far place ahead.
        let sample = |i: u32| {
            let along = f64::from(i);
            RangeSample {
                time: SimTime::from_nanos(u64::from(i)),
                ..RangeSample::of(
                    NodeId(0),
                    Position::new(along, 0.01 * f64::from(i % 3), 0.0),
                    40.0 + 0.999 * along + 0.1 * f64::from(i % 2),
                )
            }
        };
        let stop = Stop::at(Position::ORIGIN);
        let log = ReceptionLog::new(vec!["n0".into()], vec![stop], vec![], vec![]).unwrap();
        let log = log.with_ranges((0..30).map(sample).collect()).unwrap();
        let map = Mapper::new(TimeDifference).map(&log).unwrap();
        assert_eq!(map.estimates[0].as_ref().unwrap().concern, Some(Concern::NoEvidence), "{:?}", map.estimates[0]);
    }

    #[test]
    fn a_log_without_ranges_is_refused() {
        let without = log(Position::ORIGIN, 0.0, 0.0).with_ranges(vec![]).unwrap();
        for mapper in [Mapper::new(TimeOfArrival), Mapper::new(TimeDifference)] {
            let refused = mapper.map(&without).unwrap_err().to_string();
            assert!(refused.contains(mapper.name()) && refused.contains("ranges.csv"), "{refused}");
        }
    }
}
