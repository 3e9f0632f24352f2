//! Settings of a target search.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

/// Settings of DeTarSK, as written in a scenario (Gunathillake 2018, chapter 6).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct DetarskConfig {
    /// The values of the settings that are absent.
    pub preset: SearchPreset,
    /// A robot that touches a target at this distance between their centres has captured it (m).
    pub capture_m: f64,
    /// How long after the first detection of a target the robots start (s).
    pub start_delay_s: f64,
    /// Time between two polls and two decisions of a robot (s).
    pub step_s: f64,
    /// Time between two instants at which the place of a target is worked out (s). Presets: `default` 0.25, `thesis` that of
    /// a step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample_s: Option<f64>,
    /// Nodes within this distance of a robot on the map always answer it, and their powers tell the robot its place (m).
    /// If absent, one and a half times the way of the robot in one step (thesis, neighbourhood V + ε with ε = V/2).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbourhood_m: Option<f64>,
    /// Which nodes tell a robot what they detected. Presets: `default` all that hear, `thesis` neighbourhood.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub informants: Option<Informants>,
    /// How a robot works out where it is on the map. Presets: `default` fused, `thesis` received power.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub own_place: Option<OwnPlaceRule>,
    /// How the detected places of a target are smoothed.
    pub filter: FilterConfig,
    /// How the place of a target is predicted from the past. Presets: `default` waves, `thesis` integral.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prediction: Option<PredictionConfig>,
    /// Where a robot drives. Presets: `default` interception, `thesis` pursuit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aim: Option<Aim>,
    /// Where a robot drives after a poll in which no node knew a newer detection. Presets: `default` on, `thesis` back.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub without_news: Option<WithoutNews>,
    /// How it gets there. Presets: `default` A*, `thesis` greedy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<PathRule>,
    /// Whether it drives on between two decisions as it likes, or in whole steps. Presets: `default` continuous, `thesis`
    /// discrete.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<SearchMotion>,
    /// Largest speed that a target is believed to have (m/s).
    pub max_target_speed_m_per_s: f64,
    /// Whether detections are believed. If absent, they are doubted exactly if the sensors raise false alarms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detections: Option<Belief>,
    /// What robots do before a target is detected.
    pub before_detection: BeforeDetection,
}

/// Whether detections are believed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Belief {
    /// Each of them.
    Trusted,
    /// Those of several nodes that agree, along a way that a target can go.
    Doubted,
}

/// What robots do before a target is detected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum BeforeDetection {
    /// They stand (thesis), and capture nothing before their search has started. A robot that too few nodes answer drives to
    /// the nearest node, or looks for nodes, as with the others.
    #[default]
    Wait,
    /// They drive to the place on the map with the least mean distance to the nodes, and capture what they meet.
    Center,
    /// They drive along lanes over the map, and capture what they meet.
    Patrol,
}

/// The values of settings of a search that are absent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SearchPreset {
    /// Those with which robots capture soonest.
    #[default]
    Default,
    /// Those of the thesis, as its text states them.
    Thesis,
}

/// How a robot moves between two decisions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SearchMotion {
    /// Along its way at its speed; it captures a target at any time.
    #[default]
    Continuous,
    /// In whole steps, as long as it can drive between two decisions, to one of the eight places around it; it captures a
    /// target only at the end of a step (thesis, section 6.1: the search is discrete).
    Discrete,
}

/// Which nodes tell a robot what they detected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Informants {
    /// Those in its neighbourhood on the map (thesis).
    Neighbourhood,
    /// All that hear it and have something new to tell.
    #[default]
    AllThatHear,
}

/// How a robot works out where it is on the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum OwnPlaceRule {
    /// From the mean of the places of its neighbours, weighted by received power (thesis).
    ReceivedPower,
    /// From these means along its way and its odometry.
    #[default]
    Fused,
}

/// How the detected places of a target are smoothed, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum FilterConfig {
    /// A robust Kalman filter (thesis).
    RobustKalman(RobustKalmanConfig),
    /// A particle filter.
    Particles(ParticlesConfig),
}

/// Settings of the robust Kalman filter, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct RobustKalmanConfig {
    /// The speed of the target along an axis is uncertain by this share of itself: 0 (a Kalman filter) to below 1.
    pub zeta: f64,
    /// Standard deviation of its acceleration (m/s²).
    pub acceleration_sigma_m_per_s2: f64,
}

/// Settings of the particle filter, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct ParticlesConfig {
    /// Number of particles.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 1000000)))]
    pub particles: u32,
    /// Radius within which nodes detect a target, as the robots believe (m).
    pub sensing_radius_m: f64,
    /// Mean number of turns of a target in a second.
    pub turns_per_s: f64,
    /// Standard deviation of the acceleration of the target between two turns (m/s²).
    pub acceleration_sigma_m_per_s2: f64,
    /// Likelihood of a sensor that says the opposite, above 0 and below 1: for the errors of the map.
    pub contradiction: f64,
}

/// How the place of a target is predicted from the past. Curves go through the turns of the target, and through those
/// that it is expected to make at the mean interval between turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum PredictionConfig {
    /// Straight on, as the filter says.
    Straight,
    /// Along half waves from turn to turn.
    #[default]
    Waves,
    /// Along a polynomial whose velocity is zero at the turns (thesis, as its text describes it).
    Integral,
    /// Along a polynomial with one and the same value at all turns (thesis, as printed).
    Product,
}

/// Where a robot drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Aim {
    /// To where the target is predicted to be now (thesis).
    Pursuit,
    /// To the first place where it can meet the target on its predicted way.
    #[default]
    Interception,
}

/// Where a robot drives after a poll in which no node knew a newer detection than it knows already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum WithoutNews {
    /// On: what it knows is enough for `aim`.
    #[default]
    On,
    /// Back to the place of the newest detection that it knows, if it is farther from there than a step: nodes near that
    /// know where the target went. The thesis does not say what its robot does.
    Back,
}

/// How a robot gets to where it drives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum PathRule {
    /// On the shortest way round the obstacles that it has seen (A*).
    #[default]
    AStar,
    /// To the best of the eight places around it (thesis, as printed): it cannot leave a bay.
    Greedy,
}

/// Settings of P-G, as written in a scenario (Deshpande, Grant, Henderson, "Target localization and autonomous navigation
/// using wireless sensor networks: a pseudogradient algorithm approach", IEEE Systems Journal 8(1), reconstructed).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct PGConfig {
    /// The values of the settings that are absent.
    pub preset: SearchPreset,
    /// A robot that touches a target at this distance between their centres has captured it (m).
    pub capture_m: f64,
    /// How long after the first detection of a target the robots start (s).
    pub start_delay_s: f64,
    /// Time between two decisions of a robot (s).
    pub step_s: f64,
    /// Time between two rounds in which the pseudo-gradient is worked out anew (s). Presets: `default` 2, `thesis` 1.75: a step,
    /// and the time in which a round comes to a robot near the target.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub update_s: Option<f64>,
    /// Whether a robot stands after each step until it has heard a round that began since then. Presets: `default` false,
    /// `thesis` true (section 6.4.1: the pseudo-gradient is worked out in each step of the robot).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wait_for_round: Option<bool>,
    /// Which nodes are zero hops away from the target. Presets: `default` detecting, `thesis` detected.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sources: Option<GradientSources>,
    /// How a robot works out where it is on the map.
    pub own_place: OwnPlaceRule,
    /// How it gets to a node. Presets: `default` A*, `thesis` greedy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<PathRule>,
    /// Whether it drives on between two decisions as it likes, or in whole steps. Presets: `default` continuous, `thesis`
    /// discrete.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<SearchMotion>,
    /// What robots do before a target is detected.
    pub before_detection: BeforeDetection,
}

/// Which nodes are zero hops away from a target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum GradientSources {
    /// Those that detect it, or did since the last round: a robot drives towards the target.
    #[default]
    Detecting,
    /// All that ever detected it: a robot drives to the nearest part of its trail, and then along the trail to the newest
    /// detection that is in reach. The thesis says that the path of P-G follows all steps of the target.
    Detected,
}

impl Default for DetarskConfig {
    fn default() -> Self {
        Self {
            preset: SearchPreset::default(),
            capture_m: 1.0,
            start_delay_s: 5.0,
            step_s: 1.0,
            sample_s: None,
            neighbourhood_m: None,
            informants: None,
            own_place: None,
            filter: FilterConfig::RobustKalman(RobustKalmanConfig::default()),
            prediction: None,
            aim: None,
            without_news: None,
            path: None,
            motion: None,
            max_target_speed_m_per_s: 2.0,
            detections: None,
            before_detection: BeforeDetection::default(),
        }
    }
}

impl Default for RobustKalmanConfig {
    fn default() -> Self {
        Self { zeta: 0.3, acceleration_sigma_m_per_s2: 0.5 }
    }
}

impl Default for ParticlesConfig {
    fn default() -> Self {
        Self {
            particles: 1000,
            sensing_radius_m: 1.5,
            turns_per_s: 0.1,
            acceleration_sigma_m_per_s2: 0.2,
            contradiction: 0.05,
        }
    }
}

impl Default for PGConfig {
    fn default() -> Self {
        Self {
            preset: SearchPreset::default(),
            capture_m: 1.0,
            start_delay_s: 5.0,
            step_s: 1.0,
            update_s: None,
            wait_for_round: None,
            sources: None,
            own_place: OwnPlaceRule::default(),
            path: None,
            motion: None,
            before_detection: BeforeDetection::default(),
        }
    }
}

impl SearchPreset {
    /// The value of a setting: `set` if the user set it, else that of this preset.
    pub(super) fn or<T>(self, set: Option<T>, default: T, thesis: T) -> T {
        set.unwrap_or(match self {
            Self::Default => default,
            Self::Thesis => thesis,
        })
    }
}

/// A time in a scenario (s).
pub(super) fn span(key: &str, seconds: f64, [least, most]: [f64; 2]) -> Result<Duration, SettingError> {
    SettingError::in_range(key, seconds, least, most).map(Duration::from_secs_f64)
}
