//! How an estimated path reads.

use std::fmt;

use sextant_kernel::text::counted;

use super::PathError;

/// What was learned of odometry and ranges with a path.
#[derive(Clone, Debug, PartialEq)]
pub struct PathFit {
    /// Number of poses that were estimated.
    pub poses: usize,
    /// Names of the nodes that were placed with them.
    pub nodes: Vec<String>,
    /// How many of these have a known place.
    pub known_nodes: usize,
    /// Length of the path (m).
    pub length_m: f64,
    /// How wrong the evidence finds odometry: standard deviations.
    pub odometry: PathError,
    /// The share by which odometry is too short.
    pub scale: f64,
    /// Its standard deviation.
    pub scale_deviation: f64,
    /// How much the heading of odometry drifts (rad/m).
    pub drift_rad_per_m: f64,
    /// Its standard deviation (rad/m).
    pub drift_deviation_rad_per_m: f64,
    /// What was learned of ranges, if the path was estimated by them, and not by packets.
    pub ranges: Option<PathRanges>,
    /// How far the most moved pose is from where odometry has it (m).
    pub most_moved_m: f64,
    /// What nodes that were left out gain by it; `None` if there were too few nodes to leave some out. The path is moved only if the
    /// gain is clear.
    pub held_out: Option<HeldOut>,
    /// Known places that the ranges contradict.
    pub contradicted: Vec<ContradictedPlace>,
    /// How the path was turned and shifted to known places, if that is all that was done to it.
    pub framed: Option<FrameOfNodes>,
    /// The packets are late by the clock of the path, so that it was not estimated.
    pub late_clock: Option<LateClock>,
    /// Whether the search ended by itself.
    pub settled: bool,
}

/// How late packets are by the clock of the path. A path that is estimated by them would bend to that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LateClock {
    /// By how much they are late (s).
    pub delay_s: f64,
    /// Its standard deviation (s).
    pub deviation_s: f64,
}

/// A known place that the ranges to its node contradict.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize))]
pub struct ContradictedPlace {
    /// The name of the node.
    pub node: String,
    /// How far the place that its ranges tell is from the known one (m).
    pub apart_m: f64,
    /// How far it may be (m): the 95 % region in that direction.
    pub allowed_m: f64,
}

/// What the nodes that were left out gain by a corrected path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldOut {
    /// Logarithm of how much more probable what was heard of them, or measured to them, is on the corrected path than on the
    /// believed one.
    pub gain: f64,
    /// Its standard error over nodes, or over the parts of a few nodes.
    pub error: f64,
    /// Whether the path is better by more than chance.
    pub is_clear: bool,
}

/// A gain below this one is none (nats): of many nodes by packets, and of a few by ranges. On real logs with right paths packets gain
/// up to 9 by chance.
const LEAST_GAIN: [f64; 2] = [12.0, 5.0];
/// The same of one part of them, of which one may gain less.
const LEAST_OF_PART: f64 = 1.0;

impl HeldOut {
    /// What each of many nodes gains.
    pub(super) fn of_nodes(gains: &[f64]) -> Self {
        let gain: f64 = gains.iter().sum();
        let mean = gain / gains.len().max(1) as f64;
        let error = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>().sqrt();
        Self { gain, error, is_clear: gain > LEAST_GAIN[0] && gain > 2.0 * error }
    }

    /// What each part of a few nodes gains.
    pub(super) fn of_parts(gains: &[f64]) -> Self {
        let Self { gain, error, .. } = Self::of_nodes(gains);
        let without = gains.iter().filter(|&&gain| gain <= LEAST_OF_PART).count();
        Self { gain, error, is_clear: gain > LEAST_GAIN[1] && without <= usize::from(gains.len() > 3) }
    }
}

/// How a path was turned round its origin, and then shifted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameOfNodes {
    /// Counterclockwise (rad).
    pub turn_rad: f64,
    /// East and north (m).
    pub shift_m: [f64; 2],
}

/// What was learned of ranges with a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathRanges {
    /// By how much all ranges are too long (m).
    pub bias_m: f64,
    /// The share by which all ranges are too long.
    pub scale: f64,
    /// Its standard deviation.
    pub scale_deviation: f64,
    /// The share by which ranges are longer than odometry says. The log tells it, and hardly which of both is wrong.
    pub longer_than_odometry: f64,
    /// Its standard deviation.
    pub longer_deviation: f64,
    /// How late the ranges are by the clock of the path (s).
    pub delay_s: f64,
    /// Its standard deviation (s).
    pub delay_deviation_s: f64,
}

#[cfg(feature = "config")]
/// An estimated path in a summary.
#[derive(serde::Serialize)]
struct PathKeys<'a> {
    poses: usize,
    nodes: &'a [String],
    known_nodes: usize,
    length_m: f64,
    most_moved_m: f64,
    settled: bool,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    contradicted: &'a [ContradictedPlace],
    #[serde(skip_serializing_if = "Option::is_none")]
    turned_rad: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    shifted_m: Option<[f64; 2]>,
    frame: &'static str,
    scale: f64,
    scale_sd: f64,
    drift_rad_per_m: f64,
    drift_sd_rad_per_m: f64,
    heading_rad_per_root_m: f64,
    position_m_per_root_m: f64,
    evidence: &'static str,
    moved: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    held_out_gain: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    held_out_error: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    range_bias_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    range_scale: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    range_scale_sd: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    range_delay_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    range_delay_sd_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    packets_late_s: Option<f64>,
}

impl PathFit {
    /// What fixes the frame of the path: `first-pose` or `known-nodes`.
    #[must_use]
    pub fn frame(&self) -> &'static str {
        if self.known_nodes >= 2 { "known-nodes" } else { "first-pose" }
    }

    /// Whether the path was moved: nodes that were left out gain by it, or there were too few of them to tell.
    #[must_use]
    pub fn is_moved(&self) -> bool {
        self.late_clock.is_none() && self.held_out.is_none_or(|held_out| held_out.is_clear)
    }

    /// The same as an object of a summary.
    #[cfg(feature = "config")]
    #[must_use]
    pub fn value(&self) -> serde_json::Value {
        let keys = PathKeys {
            poses: self.poses,
            nodes: &self.nodes,
            known_nodes: self.known_nodes,
            length_m: self.length_m,
            most_moved_m: self.most_moved_m,
            settled: self.settled,
            contradicted: &self.contradicted,
            turned_rad: self.framed.map(|framed| framed.turn_rad),
            shifted_m: self.framed.map(|framed| framed.shift_m),
            frame: self.frame(),
            scale: self.scale,
            scale_sd: self.scale_deviation,
            drift_rad_per_m: self.drift_rad_per_m,
            drift_sd_rad_per_m: self.drift_deviation_rad_per_m,
            heading_rad_per_root_m: self.odometry.heading_rad_per_root_m,
            position_m_per_root_m: self.odometry.position_m_per_root_m,
            moved: self.is_moved(),
            held_out_gain: self.held_out.map(|held_out| held_out.gain),
            held_out_error: self.held_out.map(|held_out| held_out.error),
            evidence: if self.ranges.is_some() { "ranges" } else { "packets" },
            range_bias_m: self.ranges.map(|ranges| ranges.bias_m),
            range_scale: self.ranges.map(|ranges| ranges.scale),
            range_scale_sd: self.ranges.map(|ranges| ranges.scale_deviation),
            range_delay_s: self.ranges.map(|ranges| ranges.delay_s),
            range_delay_sd_s: self.ranges.map(|ranges| ranges.delay_deviation_s),
            packets_late_s: self.late_clock.map(|late| late.delay_s),
        };
        serde_json::to_value(&keys).expect("plain numbers and names")
    }

    /// The share by which ranges are longer than odometry says, and its standard deviation, if both clearly have another scale and no
    /// two known nodes tell which is wrong.
    fn scales_differ(&self) -> Option<[f64; 2]> {
        /// Smaller differences matter to nobody.
        const LEAST: f64 = 0.01;
        let ranges = self.ranges.filter(|_| self.known_nodes < 2)?;
        let [longer, deviation] = [ranges.longer_than_odometry, ranges.longer_deviation];
        (longer.abs() > LEAST.max(4.0 * deviation)).then_some([longer, deviation])
    }
}

impl fmt::Display for PathFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for ContradictedPlace { node, apart_m, allowed_m } in &self.contradicted {
            write!(
                f,
                "warning: `{node}` is known {apart_m:.2} m from where its ranges place it (allowed: {allowed_m:.2} m), so its known place, \
                 its ranges, or the other known places are wrong; "
            )?;
        }
        if let Some(LateClock { delay_s, deviation_s }) = self.late_clock {
            return write!(
                f,
                "the path stays as it is: the packets seem to be {:.2} ± {:.2} s {} by its clock, and a path that is estimated by \
                 them would bend to that; take the delay off first (`packet_delay=auto`)",
                delay_s.abs(),
                2.0 * deviation_s,
                if delay_s > 0.0 { "late" } else { "early" },
            );
        }
        if let Some(FrameOfNodes { turn_rad, shift_m: [x_m, y_m] }) = self.framed {
            write!(
                f,
                "the path is turned by {:.1}° and shifted by ({x_m:.2}, {y_m:.2}) m to the places of {}; else ",
                turn_rad.to_degrees(),
                counted(self.known_nodes, "known node")
            )?;
        }
        let by = if self.ranges.is_some() { "ranges" } else { "packets" };
        if let Some(HeldOut { gain, error, .. }) = self.held_out.filter(|_| !self.is_moved()) {
            return write!(
                f,
                "the path stays as it is: on one that is estimated by {by}, what was found of nodes that were left out is not clearly more \
                 probable (gain {gain:.1} ± {:.1} nats). Drift that this does not tell may remain, and places and regions do not hold it: \
                 {} would tell",
                2.0 * error,
                match self.ranges {
                    Some(_) => "ways that cross or pass the same nodes again, or nodes at known places,",
                    None => "lanes nearer to each other, measured ranges, or a path without drift",
                }
            );
        }
        let frame = match self.frame() {
            "known-nodes" => format!("the frame is that of {}", counted(self.known_nodes, "known node")),
            _ => "the frame is that of the first pose".to_owned(),
        };
        write!(
            f,
            "the path is estimated by {} with the places of {}: {} over {:.0} m, moved by at most {:.2} m; odometry is {:.2} ± {:.2} % too \
             short and drifts by {:.4} ± {:.4} rad/m; {frame}",
            by,
            counted(self.nodes.len(), "node"),
            counted(self.poses, "pose"),
            self.length_m,
            self.most_moved_m,
            100.0 * self.scale,
            200.0 * self.scale_deviation,
            self.drift_rad_per_m,
            2.0 * self.drift_deviation_rad_per_m,
        )?;
        if let Some([longer, deviation]) = self.scales_differ() {
            write!(
                f,
                "; ranges are {:.1} ± {:.1} % {} than odometry says: one of the two has a wrong scale, and a known distance tells which",
                100.0 * longer.abs(),
                200.0 * deviation,
                if longer > 0.0 { "longer" } else { "shorter" },
            )?;
        }
        if let Some(ranges) = self.ranges.filter(|ranges| ranges.delay_s.abs() > 3.0 * ranges.delay_deviation_s) {
            let which = if ranges.delay_s > 0.0 { "late" } else { "early" };
            write!(
                f,
                "; ranges are {:.2} ± {:.2} s {which} by its clock (corrected)",
                ranges.delay_s.abs(),
                2.0 * ranges.delay_deviation_s
            )?;
        }
        if !self.settled {
            write!(f, "; warning: the search did not settle, so the path is not reliable")?;
        }
        Ok(())
    }
}
