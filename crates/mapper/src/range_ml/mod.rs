//! Maximum likelihood on measured ranges: the places of nodes, and what is wrong with the ranges, all from one log.

pub(crate) mod error_law;
mod fit;
mod groups;
mod modes;
mod problem;
mod report;
mod solution;
mod spread;

#[cfg(feature = "config")]
use serde::{Deserialize, Serialize};
use sextant_channel::ReceptionLog;
use sextant_kernel::{SettingError, Watch};

use self::groups::RangeGroups;
use self::problem::HeightPrior;
pub use self::report::RangeFit;
use self::solution::Solution;
use crate::error::MapError;
use crate::estimator::{AnyLog, Estimator, EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::EstimatorFindings;
use crate::log_facts::heights::check_z_range;
use crate::numerics::median;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// Maximum likelihood on ranges as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "config", serde(deny_unknown_fields, default))]
pub struct RangeMlConfig {
    /// Which biases of ranges are estimated.
    pub bias: NodeBias,
    /// Standard deviation of the share by which all ranges are too long or too short, from 0 to 0.5; 0 if they are right. Where
    /// the path is of odometry, both have one scale, which the log does not tell.
    pub scale_error: f64,
    /// Standard deviation of the time by which the clocks of ranges and path differ (s), from 0 to 10.
    pub delay_error_s: f64,
    /// Lowest and highest height of a node (m). If absent, nodes are at the height of the path if that is level, and near it
    /// otherwise.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    pub z_range_m: Option<[f64; 2]>,
}

/// Which biases of ranges are estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "config", serde(rename_all = "snake_case"))]
pub enum NodeBias {
    /// None: ranges are right on average.
    None,
    /// One of all ranges.
    Common,
    /// One of all ranges, and one of each node.
    #[default]
    Node,
}

impl Default for RangeMlConfig {
    fn default() -> Self {
        Self { bias: NodeBias::Node, scale_error: 0.05, delay_error_s: 0.15, z_range_m: None }
    }
}

/// Places from measured ranges, such as those of ultra-wideband or of Wi-Fi round-trip times.
///
/// Places, a bias of all ranges, a bias of each node, a scale, a delay of the clock, and the law of errors
/// ([`RangeErrorLaw`](sextant_channel::RangeErrorLaw)) are estimated in one problem. All of them have priors in physical units, so
/// that a log that does not tell one of them leaves it at its usual value. Ranges at one place count once. The errors along a way are
/// similar: their likelihood is raised to the power of one over the autocorrelation time. The standard deviation of the biases of
/// nodes is integrated over. Regions hold what errors by direction may have moved, and a second place that fits nearly as well, as
/// the mirror image across a straight way does ([`Concern::TwoPlaces`](crate::Concern::TwoPlaces)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeMl {
    settings: Settings,
    z_range_m: Option<[f64; 2]>,
}

/// What is known of the ranges.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Settings {
    node_bias: NodeBias,
    scale_error: f64,
    delay_error_s: f64,
}

impl RangeMl {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "range-ml";

    /// The map of the nodes of `log` that have enough ranges, at least one more than there are coordinates, and the law of their
    /// ranges; `None` if no node has. The result is bit-identical for any number of threads.
    ///
    /// # Errors
    /// [`MapError::Interrupted`] if `watch` ends the work.
    pub fn map(&self, log: &ReceptionLog, watch: &dyn Watch) -> Result<(TopologyMap, Option<RangeFit>), MapError> {
        let mut map = TopologyMap::of_places(Self::NAME, vec![None; log.node_count()], CoordinateFrame::World);
        let Some(heights) = self.heights(log) else { return Ok((map, None)) };
        let least = if heights.is_given() { 3 } else { 4 };
        let groups = RangeGroups::of(log, least);
        let samples = groups.nodes.iter().map(|&node| log.ranges_to(node).len()).sum();
        let Some(Solution { estimates, fit }) = solution::solve(&self.settings, &groups, samples, heights, watch)?
        else {
            return Ok((map, None));
        };
        for (node, estimate) in estimates {
            map.estimates[node.index()] = Some(estimate);
        }
        Ok((map, Some(fit)))
    }

    /// Where nodes are sought above and below: at the height of a level path; `None` without ranges.
    fn heights(&self, log: &ReceptionLog) -> Option<HeightPrior> {
        /// A path whose heights differ by no more than that is level (m).
        const LEVEL_M: f64 = 1e-3;
        /// Nodes are usually within about this height of a path (m).
        const USUAL_M: f64 = 1.0;
        let mut heights: Vec<f64> = log.ranges().iter().map(|sample| sample.position.z_m).collect();
        if heights.is_empty() {
            return None;
        }
        if let Some([low, high]) = self.z_range_m {
            let (mean_m, deviation_m) = (0.5 * (low + high), 0.5 * (high - low));
            return Some(HeightPrior { mean_m, deviation_m, range_m: self.z_range_m });
        }
        let middle = median(&mut heights);
        let span_m = heights[heights.len() - 1] - heights[0];
        let deviation_m = if span_m <= LEVEL_M { 0.0 } else { span_m.max(USUAL_M) };
        Some(HeightPrior { mean_m: middle, deviation_m, range_m: None })
    }
}

impl TryFrom<RangeMlConfig> for RangeMl {
    type Error = SettingError;

    fn try_from(config: RangeMlConfig) -> Result<Self, SettingError> {
        let RangeMlConfig { bias, scale_error, delay_error_s, z_range_m } = config;
        check_z_range(z_range_m)?;
        let settings = Settings {
            node_bias: bias,
            scale_error: at_most("scale_error", scale_error, 0.5)?,
            delay_error_s: at_most("delay_error_s", delay_error_s, 10.0)?,
        };
        Ok(Self { settings, z_range_m })
    }
}

/// The setting `key`, from 0 to `most`.
fn at_most(key: &str, value: f64, most: f64) -> Result<f64, SettingError> {
    if (0.0..=most).contains(&value) {
        Ok(value)
    } else {
        Err(SettingError::new(key, value, format!("a number from 0 to {most}")))
    }
}

impl Estimator for RangeMl {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::RobotRanges, KnowledgeKind::RobotPath]
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        if knowledge.log.ranges().is_empty() {
            return Err(MapError::Missing {
                algorithm: Self::NAME,
                what: "measured ranges",
                remedy: "they stand in `ranges.csv` beside the stops or the path",
            });
        }
        let (map, fit) = self.map(knowledge.log, watch)?;
        Ok((map, fit.map(EstimatorFindings::new)))
    }
}

impl EstimatorSettings for RangeMlConfig {
    const ANY_LOG: Option<AnyLog> = Some(AnyLog {
        name: "range-ml",
        rank: 10,
        description: "Places, biases, scale and clock that explain measured ranges (ultra-wideband, Wi-Fi round-trip times) best",
        settings: "{}",
    });

    fn mapper(self) -> Result<Mapper, SettingError> {
        RangeMl::try_from(self).map(Mapper::new)
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::{Mounting, Position, RangeSample, Stop};
    use sextant_kernel::{NodeId, Purpose, RobotId, Seed, SimTime, Unwatched};

    use super::*;
    use crate::posterior::Concern;

    /// How ranges are wrong.
    #[derive(Clone, Copy, Default)]
    struct Errors {
        bias_m: f64,
        scale: f64,
        delay_s: f64,
        noise_m: f64,
        late: f64,
        wild: f64,
    }

    /// A log of ranges to `nodes` from a drive at 1 m/s through `corners`, four a second and node.
    fn log(nodes: &[Position], corners: &[Position], errors: Errors) -> ReceptionLog {
        let mut samples = Vec::new();
        let mut time_s = 0.0;
        for leg in corners.windows(2) {
            let length_m = leg[0].distance_m(leg[1]);
            let velocity = (leg[1] - leg[0]) * (1.0 / length_m);
            for step in 0..crate::numerics::whole(4.0 * length_m) {
                let along_m = 0.25 * step as f64;
                let position = leg[0] + velocity * along_m;
                for (node, &place) in nodes.iter().enumerate() {
                    let draw = |which| Seed(4).uniform(Purpose::new(8), [samples.len() as u64, which, 0]);
                    let noise = errors.noise_m * Seed(4).normal(Purpose::new(8), [samples.len() as u64, 9, 0]);
                    let late = if draw(1) < errors.late { -libm::log(draw(2)) } else { 0.0 };
                    let wild = if draw(3) < errors.wild { 100.0 * draw(4) } else { 0.0 };
                    let measured_from = position - velocity * errors.delay_s;
                    let distance_m = measured_from.distance_m(place);
                    let range_m = (1.0 + errors.scale) * distance_m + errors.bias_m + noise + late + wild;
                    let time = SimTime::from_nanos(crate::numerics::whole((time_s + along_m) * 1e9) as u64);
                    let node = NodeId::from_index(node);
                    samples.push(RangeSample {
                        node,
                        robot: RobotId(0),
                        time,
                        position,
                        mounting: Mounting::default(),
                        velocity,
                        range_m,
                    });
                }
            }
            time_s += length_m;
        }
        let stop = Stop { robot: RobotId(0), time: SimTime::ZERO, position: corners[0], heading_rad: None };
        let names = (0..nodes.len()).map(|node| format!("n{node}")).collect();
        ReceptionLog::new(names, vec![stop], Vec::new(), Vec::new()).unwrap().with_ranges(samples).unwrap()
    }

    fn at(x_m: f64, y_m: f64) -> Position {
        Position::new(x_m, y_m, 0.0)
    }

    fn nodes() -> Vec<Position> {
        vec![at(3.0, 4.0), at(17.0, 6.0), at(9.0, 15.0), at(-4.0, 9.0)]
    }

    fn loops() -> Vec<Position> {
        vec![at(0.0, 0.0), at(20.0, 0.0), at(20.0, 10.0), at(0.0, 10.0), at(0.0, 18.0), at(18.0, 18.0)]
    }

    fn map(log: &ReceptionLog) -> (TopologyMap, Option<RangeFit>) {
        RangeMl::try_from(RangeMlConfig::default()).unwrap().map(log, &Unwatched).unwrap()
    }

    #[test]
    fn places_and_what_is_wrong_with_ranges_are_found_together() {
        let errors = Errors { bias_m: 1.2, scale: 0.03, delay_s: 0.3, noise_m: 0.1, late: 0.15, wild: 0.01 };
        let (map, fit) = map(&log(&nodes(), &loops(), errors));
        let fit = fit.unwrap();
        let off =
            |found: f64, truth: f64, deviation: f64| assert!((found - truth).abs() < 4.0 * deviation, "{fit:?}");
        off(fit.bias_m, 1.2, fit.bias_deviation_m);
        off(fit.scale, 0.03, fit.scale_deviation);
        off(fit.delay_s, 0.3, fit.delay_deviation_s);
        assert!(fit.settled && (fit.errors.noise_m() - 0.1).abs() < 0.03, "{fit:?}");
        for (estimate, place) in map.estimates.iter().zip(nodes()) {
            let estimate = estimate.as_ref().unwrap();
            assert!(estimate.position.distance_m(place) < 0.12, "{estimate:?}, {place}");
            assert_eq!(estimate.concern, None);
            let covariance = estimate.covariance.unwrap();
            assert!(covariance[0][0] > 0.0 && covariance[0][0].sqrt() < 0.6 && covariance[2][2] <= 0.0);
        }
    }

    #[test]
    fn exact_ranges_give_exact_places() {
        let (map, fit) = map(&log(&nodes(), &loops(), Errors::default()));
        for (estimate, place) in map.estimates.iter().zip(nodes()) {
            assert!(estimate.as_ref().unwrap().position.distance_m(place) < 2e-3, "{estimate:?}");
        }
        assert!(fit.unwrap().bias_m.abs() < 1e-2);
    }

    #[test]
    fn a_straight_way_leaves_two_places_and_a_region_that_holds_both() {
        let errors = Errors { noise_m: 0.1, ..Errors::default() };
        let (map, _) = map(&log(&nodes()[..2], &[at(0.0, 0.0), at(20.0, 0.0)], errors));
        for (estimate, place) in map.estimates.iter().zip(nodes()) {
            let estimate = estimate.as_ref().unwrap();
            assert_eq!(estimate.concern, Some(Concern::TwoPlaces));
            let mirrored = at(place.x_m, -place.y_m);
            let off_m = estimate.position.distance_m(place).min(estimate.position.distance_m(mirrored));
            assert!(off_m < 1.0, "{estimate:?}");
            assert!(estimate.covariance.unwrap()[1][1].sqrt() > 0.5 * place.y_m);
        }
    }

    #[test]
    fn a_node_above_a_path_with_heights_is_found_there() {
        let mut corners = loops();
        corners.iter_mut().enumerate().for_each(|(at, corner)| corner.z_m = [0.0, 2.0, 0.5][at % 3]);
        let nodes = [Position::new(8.0, 6.0, 3.0), Position::new(14.0, 12.0, 4.0)];
        let (map, _) = map(&log(&nodes, &corners, Errors { noise_m: 0.05, ..Errors::default() }));
        for (estimate, place) in map.estimates.iter().zip(nodes) {
            assert!(estimate.as_ref().unwrap().position.distance_m(place) < 0.3, "{estimate:?}, {place}");
        }
    }

    #[test]
    fn a_node_with_two_ranges_has_no_place() {
        let full = log(&nodes(), &loops(), Errors { noise_m: 0.1, ..Errors::default() });
        let mut few = 0;
        let kept = full.ranges().iter().filter(|range| {
            few += usize::from(range.node == NodeId(1));
            range.node != NodeId(1) || few <= 2
        });
        let kept = kept.copied().collect();
        let (map, fit) = map(&full.with_ranges(kept).unwrap());
        assert_eq!(map.estimates.iter().map(Option::is_some).collect::<Vec<_>>(), [true, false, true, true]);
        assert_eq!(fit.unwrap().nodes, 3);
    }

    #[test]
    fn ranges_in_another_unit_place_no_node_reliably() {
        // Nanoseconds there and back.
        let errors = Errors { scale: 5.67, noise_m: 0.1, ..Errors::default() };
        let (map, fit) = map(&log(&nodes(), &loops()[..4], errors));
        let fit = fit.unwrap();
        let of_nodes = map.estimates.iter().flatten();
        assert!(
            of_nodes.clone().count() == 4 && of_nodes.clone().all(|node| node.concern == Some(Concern::Unsettled))
        );
        let lines = crate::learned::Finding::lines(&fit, "a", &map);
        assert!(
            lines.iter().any(|line| line.text.contains("fit no place of their nodes: are they metres?")),
            "{fit:?}"
        );
    }

    #[test]
    fn settings_beyond_their_limits_are_refused() {
        for (config, key) in [
            (RangeMlConfig { scale_error: 0.6, ..RangeMlConfig::default() }, "scale_error"),
            (RangeMlConfig { delay_error_s: -1.0, ..RangeMlConfig::default() }, "delay_error_s"),
            (RangeMlConfig { z_range_m: Some([1.0, 0.0]), ..RangeMlConfig::default() }, "z_range_m"),
        ] {
            assert!(RangeMl::try_from(config).unwrap_err().to_string().contains(key));
        }
    }
}
