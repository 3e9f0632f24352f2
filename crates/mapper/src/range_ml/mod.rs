//! Maximum likelihood on measured ranges: the places of nodes, and what is wrong with the ranges, all from one log.

pub(crate) mod error_law;
mod explained;
mod few;
mod fit;
mod groups;
mod heights;
mod late;
mod modes;
mod offset;
mod places;
mod problem;
mod report;
mod shared;
mod solution;
mod spread;
mod sums;
mod unit;

use sextant_channel::{RangeSample, ReceptionLog};
use sextant_kernel::{SettingError, Watch};

use self::groups::RangeGroups;
use self::places::are_two;
use self::problem::HeightPrior;
use self::problem::Problem;
pub use self::report::{AmbiguousNode, RangeFit, RangeUnit};
use self::solution::{ErrorShares, Solution};
pub(crate) use self::unit::UNITS;
use crate::error::MapError;
use crate::estimator::{AnyLog, Estimator, EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::EstimatorFindings;
use crate::log_facts::heights::check_z_range;
use crate::numerics::median;
use crate::posterior::{Concern, Estimate};
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// The standard deviation of the bias of a node where no law was learned (m).
const USUAL_BIAS_M: f64 = 1.0;

/// Maximum likelihood on ranges as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

/// What is wrong with all ranges by far more than usual.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct FarOff {
    /// By how much they are too long (m).
    offset_m: f64,
    /// How late they are (s).
    late_s: f64,
}

/// The log with ranges that are so much shorter (m).
fn less(log: &ReceptionLog, offset_m: f64) -> ReceptionLog {
    let shorter = |range: &RangeSample| RangeSample { range_m: range.range_m - offset_m, ..*range };
    let ranges = log.ranges().iter().map(shorter).collect();
    log.clone().with_ranges(ranges).unwrap_or_else(|error| unreachable!("the ranges of a log: {error}"))
}

impl RangeMl {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "range-ml";

    /// The map of the nodes of `log` that have ranges, and the law of these; `None` if no node has enough of them, at least one more than
    /// there are coordinates. The result is bit-identical for any number of threads.
    ///
    /// # Errors
    /// [`MapError::Interrupted`] if `watch` ends the work.
    pub fn map(&self, log: &ReceptionLog, watch: &dyn Watch) -> Result<(TopologyMap, Option<RangeFit>), MapError> {
        let Some(heights) = self.heights(log) else { return Ok((Self::nothing(log), None)) };
        let found = self.map_at(log, heights, FarOff::default(), watch)?;
        let (Some(fit), Some(usual_m)) = (&found.1, found.2) else { return Ok((found.0, found.1)) };
        // What is wrong by far more than usual is found first, and what is left of it then.
        let offset_m = if fit.bias_is_assumed || fit.is_beyond_prior || fit.is_odd(usual_m) {
            let groups = RangeGroups::of(log, |count| count >= heights.least());
            offset::offset_m(&self.settings, &groups, heights, watch)?.unwrap_or_default()
        } else {
            0.0
        };
        let late_s = if late::is_suspect(fit, usual_m) {
            let shorter = less(log, offset_m);
            late::delay_s(&self.settings, &shorter, heights, watch)?.unwrap_or_default()
        } else {
            0.0
        };
        let far_off = FarOff { offset_m, late_s };
        let (map, fit, _) =
            if far_off == FarOff::default() { found } else { self.map_at(log, heights, far_off, watch)? };
        Ok((map, fit))
    }

    /// The same of ranges that are wrong by no more than usual.
    pub(crate) fn usual_map(
        &self,
        log: &ReceptionLog,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<RangeFit>), MapError> {
        let Some(heights) = self.heights(log) else { return Ok((Self::nothing(log), None)) };
        let (map, fit, _) = self.map_at(log, heights, FarOff::default(), watch)?;
        Ok((map, fit))
    }

    /// The map of a log without ranges.
    fn nothing(log: &ReceptionLog) -> TopologyMap {
        TopologyMap::of_places(Self::NAME, vec![None; log.node_count()], CoordinateFrame::World)
    }

    /// The map of ranges that are wrong by so much, what was learned of all ranges, and how long these usually are (m).
    fn map_at(
        &self,
        log: &ReceptionLog,
        heights: HeightPrior,
        far_off: FarOff,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<RangeFit>, Option<f64>), MapError> {
        let mut map = Self::nothing(log);
        let right;
        let log = if far_off == FarOff::default() {
            log
        } else {
            right = less(&late::Paths::of(log).late_by(log, far_off.late_s), far_off.offset_m);
            &right
        };
        let groups = RangeGroups::of(log, |count| count >= heights.least());
        let few = RangeGroups::of(log, |count| (1..heights.least()).contains(&count));
        let samples = groups.nodes.iter().map(|&node| log.ranges_to(node).len()).sum();
        let solution = solution::solve(&self.settings, &groups, samples, heights, watch)?;
        // By the law of the others, or by what is thought before a log is seen.
        let prior = self.settings.prior(ErrorShares::ALL);
        let law = solution.as_ref().map(|solution| (solution.shared, solution.bias_deviation_m));
        let (shared, node_bias_m) = law.unwrap_or((prior.mean, USUAL_BIAS_M));
        let few = few::estimates(&Problem { groups: &few, prior, heights, node_bias_m, worth: 1.0 }, &shared);
        let mut ambiguous = Vec::new();
        for (node, estimate, places) in few {
            map.estimates[node.index()] = Some(estimate);
            if are_two(&places) {
                ambiguous.push((node, places));
            }
        }
        let Some(Solution { estimates, ambiguous: of_solution, mut fit, .. }) = solution else {
            return Ok((map, None, None));
        };
        if fit.is_odd(groups.usual_m()) {
            fit.unit = unit::other_unit(&self.settings, &groups, heights, watch)?;
        }
        (fit.bias_m, fit.delay_s) = (fit.bias_m + far_off.offset_m, fit.delay_s + far_off.late_s);
        fit.is_beyond_prior = self.settings.is_beyond(&fit);
        if fit.unit.is_none() && fit.seems_higher() && heights.is_given() {
            fit.higher_m = heights::higher(&self.settings, &groups, heights, watch)?;
        }
        fit.unexplained = (estimates.iter().enumerate())
            .filter(|&(number, _)| fit.explained.is_no_place(number))
            .map(|(_, (node, _))| log.names()[node.index()].clone())
            .collect();
        let is_beside = |estimate: &Estimate| estimate.concern == Some(Concern::NoEvidence);
        fit.beside = (estimates.iter().enumerate())
            .filter(|(number, (_, estimate))| {
                is_beside(estimate) && !fit.explained.is_nothing() && !fit.explained.is_no_place(*number)
            })
            .map(|(_, (node, _))| log.names()[node.index()].clone())
            .collect();
        for (number, (node, estimate)) in estimates.into_iter().enumerate() {
            let is_nothing = fit.explained.is_nothing() || fit.explained.is_no_place(number);
            let concern = if fit.unit.is_some() {
                Some(Concern::Unsettled)
            } else if is_nothing {
                Some(Concern::NoEvidence)
            } else {
                estimate.concern
            };
            map.estimates[node.index()] = Some(Estimate { concern, ..estimate });
        }
        ambiguous.extend(of_solution);
        fit.ambiguous = ambiguous
            .into_iter()
            .map(|(node, places)| AmbiguousNode::of(&log.names()[node.index()], &places))
            .collect();
        Ok((map, Some(fit), Some(groups.usual_m())))
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

impl Settings {
    /// Whether the bias or the scale is far beyond what was thought possible.
    fn is_beyond(&self, fit: &RangeFit) -> bool {
        const FAR: f64 = 3.0;
        // Without a bias or a scale, rounding is none.
        const LEAST: [f64; 2] = [0.1, 0.01];
        let prior = self.prior(ErrorShares::ALL).deviation;
        fit.bias_m.abs() > FAR * prior[problem::BIAS].max(LEAST[0])
            || fit.scale.abs() > FAR * prior[problem::SCALE].max(LEAST[1])
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
mod tests;
