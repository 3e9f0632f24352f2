//! How robots get the readings of nodes, as written in a scenario and checked.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

/// How robots ask nodes for their readings, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct PollConfig {
    /// Whether a robot has the latest reading and the received power of each node in radio range at each decision, with
    /// ideal channel access and without frames. If false, it asks over the simulated channel access. True with the
    /// preset `thesis` if absent, otherwise false.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ideal: Option<bool>,
    /// Time between two polls (s); 1 if absent. Not beside `ideal = true`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval_s: Option<f64>,
    /// Nodes within this distance of the robot on the map answer, in the unit of the map (m). If absent, 5.5 times the
    /// spacing of the nodes, and with `ideal = true` all in radio range.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reach_m: Option<f64>,
    /// A reading counts for so long after it was heard (s); 5 if absent. Not beside `ideal = true`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub memory_s: Option<f64>,
}

/// How robots get the readings of nodes, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Poll {
    pub(super) access: Access,
    /// How far nodes may be from the robot on the map (m).
    pub(super) reach_m: Option<f64>,
}

/// How a poll uses the channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Access {
    /// It does not: the robot has all readings at each decision.
    Ideal,
    /// By frames, so often, and a reading counts for so long.
    Frames { interval: Duration, memory: Duration },
}

/// Longest times (s).
const LONGEST_INTERVAL_S: f64 = 60.0;
const LONGEST_S: f64 = 1e6;
/// Times that are absent (s).
const INTERVAL_S: f64 = 1.0;
const MEMORY_S: f64 = 5.0;

impl PollConfig {
    /// The checked form. Whether it is ideal, if that is absent, is as in `preset`.
    pub(super) fn checked(self, preset: Access) -> Result<Poll, SettingError> {
        let Self { ideal, interval_s, reach_m, memory_s } = self;
        let reach_m = reach_m.map(|reach_m| SettingError::positive("reach_m", reach_m)).transpose()?;
        if ideal.unwrap_or(preset == Access::Ideal) {
            let with =
                if ideal.is_some() { "`ideal = true`" } else { "`preset = \"thesis\"`, whose polls are ideal" };
            let remedy = "leave it out, or set `ideal = false`";
            let times = [("interval_s", interval_s), ("memory_s", memory_s)];
            if let Some((key, _)) = times.into_iter().find(|(_, seconds)| seconds.is_some()) {
                return Err(SettingError::conflict(key, with, remedy));
            }
            return Ok(Poll { access: Access::Ideal, reach_m });
        }
        let span =
            |key, seconds, most_s| SettingError::in_range(key, seconds, 0.05, most_s).map(Duration::from_secs_f64);
        let (interval_s, memory_s) = (interval_s.unwrap_or(INTERVAL_S), memory_s.unwrap_or(MEMORY_S));
        let interval = span("interval_s", interval_s, LONGEST_INTERVAL_S)?;
        let memory = span("memory_s", memory_s, LONGEST_S)?;
        if memory < interval {
            let allowed = format!("at least {interval_s}, the value of `interval_s`");
            return Err(SettingError::new("memory_s", memory_s, allowed));
        }
        Ok(Poll { access: Access::Frames { interval, memory }, reach_m })
    }
}

impl Access {
    /// What is used if nothing is written.
    pub(super) fn frames() -> Self {
        let [interval, memory] = [INTERVAL_S, MEMORY_S].map(Duration::from_secs_f64);
        Self::Frames { interval, memory }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(settings: &str, preset: Access) -> Result<Poll, String> {
        let config: PollConfig = toml::from_str(settings).expect("settings");
        config.checked(preset).map_err(|error| error.to_string())
    }

    #[test]
    fn times_of_frames_are_refused_beside_an_ideal_poll() {
        let remedy = "leave it out, or set `ideal = false`";
        assert_eq!(
            checked("ideal = true\ninterval_s = 1.0", Access::frames()),
            Err(format!("`interval_s` conflicts with `ideal = true`; {remedy}"))
        );
        assert_eq!(
            checked("memory_s = 5.0", Access::Ideal),
            Err(format!("`memory_s` conflicts with `preset = \"thesis\"`, whose polls are ideal; {remedy}"))
        );
        assert_eq!(checked("", Access::Ideal), Ok(Poll { access: Access::Ideal, reach_m: None }));
        let frames = checked("ideal = false\ninterval_s = 2.0\nreach_m = 3.0", Access::Ideal);
        let [interval, memory] = [2, 5].map(Duration::from_secs);
        assert_eq!(frames, Ok(Poll { access: Access::Frames { interval, memory }, reach_m: Some(3.0) }));
        assert_eq!(checked("", Access::frames()), Ok(Poll { access: Access::frames(), reach_m: None }));
        let short = checked("interval_s = 7.0", Access::frames());
        assert_eq!(short, Err("`memory_s` is 5; allowed: at least 7, the value of `interval_s`".into()));
    }
}
