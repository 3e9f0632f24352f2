//! A team of robots as written in a scenario.

use serde::{Deserialize, Serialize};
use sextant_apps::{ControllerConfig, PartitionConfig};
use sextant_channel::Position;
use sextant_sim::{OdometryConfig, OwnFrameConfig, RobotConfig};

/// Largest number of robots.
pub(crate) const MOST_ROBOTS: u32 = 256;

/// A team of robots that divide a region among them, as written in a scenario. They are alike, and share nothing on the way:
/// their receptions go into one log. What is not said here is as in `[[robots]]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TeamConfig {
    /// Number of robots: 1 to 256, and at most one for each stop.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 256)))]
    pub robots: u32,
    /// What their names begin with: the first one is `surveyor-1`.
    #[serde(default = "default_name")]
    pub name: String,
    /// How the region of the controller is divided among them.
    #[serde(default)]
    pub partition: PartitionConfig,
    /// Width of the strips along the cuts that both neighbours survey (m). Maps are stitched by the nodes there.
    #[serde(default)]
    pub overlap_m: f64,
    /// Where all robots start (m). If absent, each starts at the corner of its part that is nearest to the lower left one of
    /// the region.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_m: Option<Position>,
    /// The frames of coordinates in which the robots write their logs.
    #[serde(default)]
    pub frames: FramesConfig,
    /// How fast they drive (m/s); 1 if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed_m_per_s: Option<f64>,
    /// Radius of their hulls (m); 0.2 if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius_m: Option<f64>,
    /// How long they listen at each stop (s); 1.2 if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub listen_s: Option<f64>,
    /// Name of the network whose nodes they survey; the first one if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<String>,
    /// Names of several networks whose nodes they survey at the same stops, instead of `network`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub networks: Vec<String>,
    /// Number of sector sweeps at each stop; 1 if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 10000)))]
    pub sweeps_per_stop: Option<u32>,
    /// Whether they also listen while they drive.
    #[serde(default)]
    pub listen_while_driving: bool,
    /// Errors of their odometry; exact if absent.
    #[serde(default)]
    pub odometry: OdometryConfig,
    /// What drives each of them in its part: `automated_s`, `s_path`, `spiral` or `hilbert`. Its region, or the `area` of
    /// `automated_s`, is divided.
    pub controller: ControllerConfig,
}

/// The frames of coordinates of a team, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum FramesConfig {
    /// All robots know where they are in the world.
    #[default]
    Shared,
    /// The frames of all but the first robot are shifted, turned, and mirrored or not, at random. No robot knows how.
    Unknown,
}

fn default_name() -> String {
    "surveyor".to_owned()
}

impl TeamConfig {
    /// The robot `number` of the team, from 0, that starts at `start_m`.
    pub(crate) fn robot(
        &self,
        number: u32,
        start_m: Position,
        controller: ControllerConfig,
        frame: OwnFrameConfig,
    ) -> RobotConfig<ControllerConfig> {
        let usual = RobotConfig::new(format!("{}-{}", self.name, number + 1), start_m, controller);
        RobotConfig {
            speed_m_per_s: self.speed_m_per_s.unwrap_or(usual.speed_m_per_s),
            radius_m: self.radius_m.unwrap_or(usual.radius_m),
            listen_s: self.listen_s.unwrap_or(usual.listen_s),
            network: self.network.clone(),
            networks: self.networks.clone(),
            sweeps_per_stop: self.sweeps_per_stop.unwrap_or(usual.sweeps_per_stop),
            listen_while_driving: self.listen_while_driving,
            odometry: self.odometry,
            frame,
            ..usual
        }
    }

    /// A robot of the team that surveys all of its region.
    pub(crate) fn any_robot(&self) -> RobotConfig<ControllerConfig> {
        self.surveying_all(0)
    }

    /// The robots of the team that know where they are in the world, each as if it surveyed all of the region: what maps may
    /// know of the team.
    pub(crate) fn robots_in_world(&self) -> Vec<RobotConfig<ControllerConfig>> {
        let last = match self.frames {
            FramesConfig::Shared => self.robots.clamp(1, MOST_ROBOTS),
            FramesConfig::Unknown => 1,
        };
        (0..last).map(|number| self.surveying_all(number)).collect()
    }

    fn surveying_all(&self, number: u32) -> RobotConfig<ControllerConfig> {
        let start_m = self.start_m.unwrap_or(Position::ORIGIN);
        self.robot(number, start_m, self.controller.clone(), OwnFrameConfig::default())
    }
}
