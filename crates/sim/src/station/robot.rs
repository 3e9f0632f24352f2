//! The bodies of robots: how fast they drive, how long they listen, where they believe to be.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_channel::Position;
use sextant_kernel::SettingError;

use super::motion::Pose;
use super::odometry::{Odometry, OdometryConfig};
use super::own_frame::{OwnFrame, OwnFrameConfig};
use crate::service::network_id::NetworkId;

/// A robot, as written in a scenario; `C` is the configuration of its controller.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RobotConfig<C> {
    /// Name, also used in its topics of the recording.
    pub name: String,
    /// Where it starts (m).
    pub start_m: Position,
    /// What it does at its stops.
    #[serde(default, skip_serializing_if = "RoleConfig::is_survey")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = "survey")))]
    pub role: RoleConfig,
    /// How fast it drives (m/s).
    #[serde(default = "default_speed_m_per_s")]
    pub speed_m_per_s: f64,
    /// Radius of its hull: its minimum distance from obstacles (m).
    #[serde(default = "default_radius_m")]
    pub radius_m: f64,
    /// How long it listens at each stop (s).
    #[serde(default = "default_listen_s")]
    pub listen_s: f64,
    /// Name of the network whose nodes it surveys; the first one if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<String>,
    /// Names of several networks whose nodes it surveys at the same stops, instead of `network`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub networks: Vec<String>,
    /// Number of sector sweeps at each stop, in equal intervals, in networks that have them, or of messages of a mobile
    /// anchor; 1 to 10000.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 1)))]
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 10000)))]
    pub sweeps_per_stop: u32,
    /// Whether it also listens while it drives. A drive has as many equal slots of at least `listen_s` as fit into it;
    /// each is a stop of the log, at the time of its start and the place in its middle.
    #[serde(default)]
    pub listen_while_driving: bool,
    /// Errors of its odometry; exact if absent.
    #[serde(default)]
    pub odometry: OdometryConfig,
    /// The frame of coordinates in which it writes its log; that of the world if absent. For a robot that surveys.
    #[serde(default, skip_serializing_if = "OwnFrameConfig::is_world")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = {})))]
    pub frame: OwnFrameConfig,
    /// What drives it; an agent has none.
    #[serde(default = "no_controller", skip_serializing_if = "Option::<C>::is_none")]
    pub controller: Option<C>,
}

impl<C> RobotConfig<C> {
    /// A robot that surveys from `start_m`, with defaults for all other settings.
    #[must_use]
    pub fn new(name: String, start_m: Position, controller: C) -> Self {
        Self {
            name,
            start_m,
            role: RoleConfig::Survey,
            speed_m_per_s: default_speed_m_per_s(),
            radius_m: default_radius_m(),
            listen_s: default_listen_s(),
            network: None,
            networks: Vec::new(),
            sweeps_per_stop: one(),
            listen_while_driving: false,
            odometry: OdometryConfig::default(),
            frame: OwnFrameConfig::default(),
            controller: Some(controller),
        }
    }
}

/// What a robot does at its stops, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RoleConfig {
    /// It listens, and logs what it hears.
    #[default]
    Survey,
    /// It is a mobile anchor: it tells all who hear it where it is, as often as `sweeps_per_stop` says, and listens to
    /// nobody. Its stops are in no log.
    Anchor,
    /// It takes part in the applications, and does nothing before.
    Agent,
}

impl RoleConfig {
    fn is_survey(&self) -> bool {
        *self == Self::Survey
    }
}

fn no_controller<C>() -> Option<C> {
    None
}

fn one() -> u32 {
    1
}

fn is_one(count: &u32) -> bool {
    *count == 1
}

fn default_speed_m_per_s() -> f64 {
    1.0
}

fn default_radius_m() -> f64 {
    0.2
}

fn default_listen_s() -> f64 {
    1.2
}

/// The body of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotBody {
    /// Name.
    pub name: String,
    /// Where it starts (m). It looks along x.
    pub start: Position,
    /// Where it believes to start, if its odometry has erred before.
    pub believed_start: Option<Pose>,
    /// How fast it drives (m/s).
    pub speed_m_per_s: f64,
    /// Radius of its hull (m).
    pub radius_m: f64,
    /// How long it listens at each stop.
    pub listen: Duration,
    /// The networks whose nodes it surveys, or to which it sends: at least one.
    pub networks: Vec<NetworkId>,
    /// Number of sector sweeps at each stop, or of messages of a mobile anchor: at least one.
    pub sweeps_per_stop: u32,
    /// When it listens.
    pub listening: Listening,
    /// Where it believes to be.
    pub odometry: Odometry,
    /// The frame of coordinates in which it writes its log.
    pub frame: OwnFrame,
}

/// When a robot on a survey listens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Listening {
    /// Where its controller says.
    AtStops,
    /// There, and while it drives.
    AlsoWhileDriving,
}

impl<C> TryFrom<&RobotConfig<C>> for RobotBody {
    type Error = SettingError;

    fn try_from(config: &RobotConfig<C>) -> Result<Self, SettingError> {
        check_name(&config.name)?;
        check_place("start_m", config.start_m)?;
        Ok(Self {
            name: config.name.clone(),
            start: config.start_m,
            believed_start: None,
            speed_m_per_s: SettingError::in_range("speed_m_per_s", config.speed_m_per_s, 1e-3, 1e3)?,
            radius_m: SettingError::in_range("radius_m", config.radius_m, 0.0, 1e3)?,
            listen: Duration::from_secs_f64(SettingError::in_range("listen_s", config.listen_s, 1e-3, 1e6)?),
            networks: vec![NetworkId::default()],
            sweeps_per_stop: sweeps_per_stop(config.sweeps_per_stop)?,
            listening: if config.listen_while_driving { Listening::AlsoWhileDriving } else { Listening::AtStops },
            odometry: Odometry::try_from(config.odometry).map_err(|error| error.within("odometry"))?,
            frame: own_frame(config.frame, config.role)?,
        })
    }
}

/// The frame of the log of a robot; others than those that survey write none.
fn own_frame(config: OwnFrameConfig, role: RoleConfig) -> Result<OwnFrame, SettingError> {
    if !config.is_world() && role != RoleConfig::Survey {
        let remedy = "remove the table, because only a robot that surveys writes a log";
        return Err(SettingError::conflict("frame", "another `role` than \"survey\"", remedy));
    }
    OwnFrame::try_from(config).map_err(|error| error.within("frame"))
}

/// Refuses a stop without sweeps, and numbers that are certain to be a mistake.
fn sweeps_per_stop(count: u32) -> Result<u32, SettingError> {
    if (1..=10_000).contains(&count) {
        Ok(count)
    } else {
        Err(SettingError::new("sweeps_per_stop", count, "1 to 10000"))
    }
}

/// Refuses names that cannot stand in a topic of a recording.
pub(crate) fn check_name(name: &str) -> Result<(), SettingError> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    if name.is_empty() || !name.chars().all(is_plain) {
        let allowed = "letters, digits, `-`, `_` and `.`, at least one";
        return Err(SettingError::new("name", format!("`{name}`"), allowed));
    }
    Ok(())
}

/// Refuses coordinates that are not finite.
pub(super) fn check_place(key: &str, place: Position) -> Result<(), SettingError> {
    if !place.is_finite() {
        let [x, y, z] = place.into();
        return Err(SettingError::new(key, format!("[{x}, {y}, {z}]"), "finite coordinates"));
    }
    Ok(())
}
