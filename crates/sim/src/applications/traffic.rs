//! Traffic: when the nodes have frames to send.

use std::time::Duration;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_kernel::{NodeId, Seed, SettingError, SimTime};

use crate::purpose;

/// The nodes' traffic, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum TrafficConfig {
    /// Each node broadcasts a short frame once per interval, with its own phase. With a beacon-enabled MAC the frame
    /// waits for the next superframe whose beacon the node hears; another frame that comes in the meantime is lost.
    /// An interval near the beacon interval gives about one frame per node in each superframe.
    Beacon(BeaconConfig),
    /// All nodes have one frame at the same instant, as if a robot had asked. With a beacon-enabled MAC each node
    /// sends it once, in the first superframe whose beacon it hears. For studies of contention; not enough for
    /// surveys.
    Query(QueryConfig),
}

/// Periodic broadcasts, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BeaconConfig {
    /// Length of the frame, header and frame check sequence included (octets): 11 to 127.
    #[serde(default = "default_mpdu_octets")]
    pub mpdu_octets: u8,
    /// Mean time between two broadcasts of a node (s).
    #[serde(default = "default_interval_s")]
    pub interval_s: f64,
    /// Each broadcast is early or late by up to this share of the interval, uniformly distributed: 0 to 0.5.
    #[serde(default = "default_jitter")]
    pub jitter: f64,
}

/// One frame per node, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct QueryConfig {
    /// Length of the frame, header and frame check sequence included (octets): 11 to 127.
    #[serde(default = "default_mpdu_octets")]
    pub mpdu_octets: u8,
    /// When all nodes get their frame (s).
    #[serde(default)]
    pub at_s: f64,
    /// Whether the frame is sent to the first robot and requests an acknowledgement; otherwise it is broadcast.
    #[serde(default)]
    pub acknowledged: bool,
}

fn default_mpdu_octets() -> u8 {
    20
}

fn default_interval_s() -> f64 {
    1.0
}

fn default_jitter() -> f64 {
    0.1
}

/// The traffic of the nodes: their frames, and when these are due.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traffic {
    mpdu_octets: u8,
    acknowledged: bool,
    schedule: Schedule,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Schedule {
    Periodic { interval: Duration, jitter: f64 },
    Once { at: SimTime },
}

impl TryFrom<TrafficConfig> for Traffic {
    type Error = SettingError;

    fn try_from(config: TrafficConfig) -> Result<Self, SettingError> {
        let octets = |key: &str, octets: u8| {
            if (11..=127).contains(&octets) { Ok(octets) } else { Err(SettingError::new(key, octets, "11 to 127")) }
        };
        match config {
            TrafficConfig::Beacon(BeaconConfig { mpdu_octets, interval_s, jitter }) => Ok(Self {
                mpdu_octets: octets("beacon.mpdu_octets", mpdu_octets)?,
                acknowledged: false,
                schedule: Schedule::Periodic {
                    interval: Duration::from_secs_f64(SettingError::in_range(
                        "beacon.interval_s",
                        interval_s,
                        1e-3,
                        1e6,
                    )?),
                    jitter: SettingError::in_range("beacon.jitter", jitter, 0.0, 0.5)?,
                },
            }),
            TrafficConfig::Query(QueryConfig { mpdu_octets, at_s, acknowledged }) => Ok(Self {
                mpdu_octets: octets("query.mpdu_octets", mpdu_octets)?,
                acknowledged,
                schedule: Schedule::Once {
                    at: SimTime::ZERO
                        + Duration::from_secs_f64(SettingError::in_range("query.at_s", at_s, 0.0, 1e6)?),
                },
            }),
        }
    }
}

impl Traffic {
    /// Length of each frame, header and frame check sequence included (octets).
    #[must_use]
    pub fn mpdu_octets(&self) -> u8 {
        self.mpdu_octets
    }

    /// Whether frames go to the first robot and request an acknowledgement.
    #[must_use]
    pub fn is_acknowledged(&self) -> bool {
        self.acknowledged
    }

    /// The key of its table in a scenario.
    pub(crate) fn key(&self) -> &'static str {
        match self.schedule {
            Schedule::Periodic { .. } => "traffic.beacon",
            Schedule::Once { .. } => "traffic.query",
        }
    }

    /// When `node` gets its frame number `count` (from zero); `None` if it gets no such frame.
    ///
    /// Broadcast k is due at (k + phase + jitter u) intervals. The phase is drawn once per node, u in (-1, 1) once
    /// per broadcast. Jitter does not accumulate, so each window of (1 + 2 jitter) intervals has at least one
    /// broadcast.
    #[must_use]
    pub fn due(&self, seed: Seed, node: NodeId, count: u64) -> Option<SimTime> {
        match self.schedule {
            Schedule::Once { at } => (count == 0).then_some(at),
            Schedule::Periodic { interval, jitter } => {
                let phase = seed.uniform(purpose::TRAFFIC, [node.0.into(), 0, 0]);
                let shift = 2.0 * seed.uniform(purpose::TRAFFIC, [node.0.into(), 1, count]) - 1.0;
                // The start is later by the jitter, so that the first broadcast is not before zero.
                let periods = interval * u32::try_from(count).ok()?;
                let offset = interval.mul_f64(phase + jitter * (1.0 + shift));
                Some(SimTime::ZERO + periods + offset)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_window_of_an_interval_and_twice_the_jitter_has_a_broadcast() {
        let traffic =
            Traffic::try_from(TrafficConfig::Beacon(BeaconConfig { mpdu_octets: 20, interval_s: 1.0, jitter: 0.1 }))
                .unwrap();
        for node in 0..50 {
            let due = |count| traffic.due(Seed(3), NodeId(node), count).unwrap();
            for count in 0..200 {
                let gap = due(count + 1) - due(count);
                assert!(gap >= Duration::from_millis(800) && gap <= Duration::from_millis(1200), "{gap:?}");
            }
        }
    }

    #[test]
    fn invalid_traffic_is_rejected() {
        let beacon = |mpdu_octets, interval_s, jitter| {
            Traffic::try_from(TrafficConfig::Beacon(BeaconConfig { mpdu_octets, interval_s, jitter }))
                .map_err(|error| error.key)
        };
        assert_eq!(beacon(10, 1.0, 0.1), Err("beacon.mpdu_octets".into()));
        assert_eq!(beacon(20, f64::NAN, 0.1), Err("beacon.interval_s".into()));
        assert_eq!(beacon(20, 1.0, 0.6), Err("beacon.jitter".into()));
    }
}
