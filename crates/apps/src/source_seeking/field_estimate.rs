//! The value of the field at the robot, from the readings of the nodes around it.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_channel::{Db, Position};
use sextant_kernel::{SimTime, StationId};

use super::local_fit::{Axes, Degree, Fitting, LocalFit, Sample};
use crate::navigation::HeardNode;

/// How the value of the field at the robot is worked out from readings of nodes, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum EstimateConfig {
    /// The mean, weighted by the ratio of received and transmit power (thesis, chapter 7): shadowing makes it jump from
    /// poll to poll.
    PowerWeights {},
    /// A polynomial through the readings around the place of the robot on the map.
    LocalFit(LocalFitConfig),
}

/// Settings of local fits, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct LocalFitConfig {
    /// Smallest bandwidth of the Gaussian weights, as a multiple of the spacing of the nodes on the map.
    pub bandwidth_spacings: f64,
    /// The bandwidth grows until the gradient of the field is so many standard deviations (after Lepski 1991: the smallest
    /// bandwidth at which the signal stands out of the noise), or all nodes that answer are used.
    pub significance: f64,
}

impl Default for LocalFitConfig {
    fn default() -> Self {
        Self { bandwidth_spacings: 1.25, significance: 3.0 }
    }
}

impl Default for EstimateConfig {
    fn default() -> Self {
        Self::LocalFit(LocalFitConfig::default())
    }
}

/// Factor from one bandwidth to the next.
const GROWTH: f64 = 1.5;
/// Largest bandwidth, as a share of the distance from which nodes answer.
const WIDEST: f64 = 1.0;
/// Readings that weigh less than this are left out.
const LEAST_WEIGHT: f64 = 0.01;
/// Ridge of local fits: a term that few readings tell is held down.
const RIDGE: f64 = 1e-3;

/// The readings that a robot has heard.
#[derive(Clone, Debug, Default)]
pub(super) struct Readings {
    by_node: BTreeMap<StationId, (HeardNode, f64)>,
}

/// The field at the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FieldEstimate {
    /// Its value, as exactly as the readings tell it: by this a robot has arrived.
    pub(super) value: f64,
    /// Its value by a stiffer fit, which flattens peaks but varies less on the way: by this it steers.
    pub(super) smooth: f64,
    /// Its gradient (1/m on the map); `None` if the rule does not tell.
    pub(super) gradient: Option<Position>,
}

impl Readings {
    /// A reading was heard: the one before it of the same node does not count any more.
    pub(super) fn hear(&mut self, station: StationId, heard: HeardNode, value: f64) {
        self.by_node.insert(station, (heard, value));
    }

    /// Their number.
    pub(super) fn len(&self) -> usize {
        self.by_node.len()
    }

    /// Forgets readings that were heard before `time`.
    pub(super) fn forget_before(&mut self, time: SimTime) {
        self.by_node.retain(|_, (heard, _)| heard.time >= time);
    }

    /// The mean of those heard since `since`, weighted by the linear ratio of received and transmit power (thesis, chapter
    /// 7, equation of d(t)).
    pub(super) fn power_weighted(&self, since: SimTime) -> Option<f64> {
        let latest = || self.by_node.values().filter(|(heard, _)| heard.time >= since);
        // Relative to the strongest one, so that no weight underflows.
        let strongest = latest().map(|(heard, _)| heard.gain.0).max_by(f64::total_cmp)?;
        let (mut total, mut sum) = (0.0, 0.0);
        for (heard, value) in latest() {
            let weight = Db(heard.gain.0 - strongest).to_factor();
            total += weight;
            sum += weight * value;
        }
        Some(sum / total)
    }

    /// The field at `place` by local fits whose bandwidth is at least `bandwidth` (m on the map), and at most half of
    /// `reach`, the distance from which nodes answer.
    pub(super) fn fitted(
        &self,
        place: Position,
        axes: Axes,
        [bandwidth, reach]: [f64; 2],
        significance: f64,
    ) -> Option<FieldEstimate> {
        let mut bandwidth = bandwidth;
        let mut value = None;
        let mut samples = Vec::with_capacity(self.by_node.len());
        loop {
            samples.clear();
            samples.extend(self.samples(place, axes, |distance| {
                let weight = libm::exp(-0.5 * (distance / bandwidth) * (distance / bandwidth));
                if weight < LEAST_WEIGHT { 0.0 } else { weight }
            }));
            let fitting = |degree| Fitting { axes, degree, scale_m: bandwidth, ridge: RIDGE };
            let linear = fitting(Degree::Linear).best(&samples);
            let wider = GROWTH * bandwidth;
            // A wide paraboloid flattens a peak too.
            if value.is_none() || bandwidth <= 0.5 * reach {
                value = fitting(Degree::Quadratic).best(&samples).map(|fit| fit.value).or(value);
            }
            let stands_out = |fit: &LocalFit| {
                fit.degree == Degree::Linear && fit.gradient.length_m() >= significance * fit.gradient_sigma
            };
            match linear {
                Some(fit) if wider > WIDEST * reach || stands_out(&fit) => {
                    return Some(FieldEstimate {
                        value: value.unwrap_or(fit.value),
                        smooth: fit.value,
                        gradient: Some(fit.gradient),
                    });
                }
                None if wider > WIDEST * reach && samples.len() == self.by_node.len() => return None,
                _ => bandwidth = wider,
            }
        }
    }

    /// The readings as samples around `place`, with weights by distance; without those that weigh nothing.
    pub(super) fn samples(
        &self,
        place: Position,
        axes: Axes,
        weigh: impl Fn(f64) -> f64,
    ) -> impl Iterator<Item = Sample> {
        self.by_node.values().filter_map(move |(heard, value)| {
            let mut offset = heard.place - place;
            if axes == Axes::Plane {
                offset.z_m = 0.0;
            }
            let weight = weigh(offset.length_m());
            (weight > 0.0).then_some(Sample { offset, value: *value, weight })
        })
    }
}
