//! What stitching found out, and how it reads.

#[cfg(feature = "config")]
use serde::Serialize;

use super::frame_change::{FrameChange, Handedness};
use super::pair::PairFit;
#[cfg(feature = "config")]
use super::pair::PairState;
#[cfg(feature = "config")]
use crate::learned::one_key;
use crate::{AbsorptionMap, CurveFinding, EstimatorFindings, Finding, Line, Section, StaticShadowing, TopologyMap};
use sextant_kernel::NodeId;
use sextant_kernel::text::counted;

/// The frames of the robots of a log, and what else the estimator learned.
#[derive(Clone, Debug, PartialEq)]
pub struct Stitching {
    /// The robots that listened, in the order of the log.
    pub robots: Vec<RobotFrame>,
    /// Their pairs.
    pub pairs: Vec<PairFit>,
    /// What the estimator learned from the log in one frame.
    pub learned: Option<EstimatorFindings>,
}

/// The frame of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotFrame {
    /// Name of the robot.
    pub name: String,
    /// Nodes with reliable places on its own map.
    pub placed: usize,
    /// What became of it.
    pub outcome: RobotOutcome,
}

/// What became of a robot.
#[derive(Clone, Debug, PartialEq)]
pub enum RobotOutcome {
    /// Its stops are in the frame of the first robot.
    Joined {
        /// How its frame becomes that of the first robot.
        change: FrameChange,
        /// Nodes that are on the map of another robot too.
        shared: usize,
        /// Those that agree.
        agreeing: usize,
        /// Root of the mean square distance of these from where all maps together have them (m).
        residual_m: f64,
    },
    /// The map is made without it.
    LeftOut {
        /// Why.
        why: String,
    },
}

/// A robot as written in a summary.
#[cfg(feature = "config")]
#[derive(Serialize)]
struct RobotKeys<'a> {
    robot: &'a str,
    joined: bool,
    placed: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    turn_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mirrored: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scale: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    offset_m: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    shared_nodes: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    agreeing_nodes: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    residual_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<&'a str>,
}

/// A pair of robots as written in a summary.
#[cfg(feature = "config")]
#[derive(Serialize)]
struct PairKeys<'a> {
    robots: [&'a str; 2],
    shared_nodes: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    agreeing_nodes: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    residual_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    undecided: Option<String>,
}

/// Stitching as written in a summary.
#[cfg(feature = "config")]
#[derive(Serialize)]
struct StitchingKeys<'a> {
    joined: usize,
    robots: Vec<RobotKeys<'a>>,
    pairs: Vec<PairKeys<'a>>,
}

impl Stitching {
    /// Number of robots whose stops are in the map.
    #[must_use]
    pub fn joined(&self) -> usize {
        self.robots.iter().filter(|robot| matches!(robot.outcome, RobotOutcome::Joined { .. })).count()
    }
}

#[cfg(feature = "config")]
impl Stitching {
    fn own_keys(&self) -> StitchingKeys<'_> {
        StitchingKeys {
            joined: self.joined(),
            robots: self.robots.iter().map(RobotFrame::keys).collect(),
            pairs: self.pairs.iter().map(|pair| self.pair_keys(pair)).collect(),
        }
    }

    fn pair_keys(&self, pair: &PairFit) -> PairKeys<'_> {
        let (agreeing_nodes, residual_m, undecided) = match &pair.state {
            PairState::Fitted { agreeing, residual_m, .. } => (Some(*agreeing), Some(*residual_m), None),
            PairState::Undecided(fault) => (None, None, Some(fault.to_string())),
        };
        let robots = pair.robots.map(|robot| self.robots[robot].name.as_str());
        PairKeys { robots, shared_nodes: pair.shared, agreeing_nodes, residual_m, undecided }
    }
}

#[cfg(feature = "config")]
impl RobotFrame {
    fn keys(&self) -> RobotKeys<'_> {
        let keys = RobotKeys {
            robot: &self.name,
            joined: false,
            placed: self.placed,
            turn_deg: None,
            mirrored: None,
            scale: None,
            offset_m: None,
            shared_nodes: None,
            agreeing_nodes: None,
            residual_m: None,
            why: None,
        };
        match &self.outcome {
            RobotOutcome::Joined { change, shared, agreeing, residual_m } => RobotKeys {
                joined: true,
                turn_deg: Some(change.turn_rad.to_degrees()),
                mirrored: Some(change.handedness == Handedness::Mirrored),
                scale: Some(change.scale),
                offset_m: Some(change.offset.into()),
                shared_nodes: Some(*shared),
                agreeing_nodes: Some(*agreeing),
                residual_m: Some(*residual_m),
                ..keys
            },
            RobotOutcome::LeftOut { why } => RobotKeys { why: Some(why), ..keys },
        }
    }
}

impl RobotFrame {
    /// The line of it under a table of results that calls the map by `map`.
    fn line(&self, map: &str) -> Line {
        let name = &self.name;
        match &self.outcome {
            RobotOutcome::Joined { change, shared, agreeing, residual_m } => {
                let mirrored = match change.handedness {
                    Handedness::Same => "",
                    Handedness::Mirrored => "mirrored, ",
                };
                let text = format!(
                    "{map}: {name} joined: {mirrored}turned by {:.1} degrees; {agreeing} of {} agree, residual {residual_m:.2} m",
                    change.turn_rad.to_degrees(),
                    counted(*shared, "shared node"),
                );
                Line { section: Section::Laws, text }
            }
            RobotOutcome::LeftOut { why } => {
                let text = format!("{map}: warning: {name} is not in the map: {why}");
                Line { section: Section::Warnings, text }
            }
        }
    }
}

impl Finding for Stitching {
    #[cfg(feature = "config")]
    fn keys(&self, map: &TopologyMap) -> serde_json::Map<String, serde_json::Value> {
        let mut keys = self.learned.as_ref().map(|learned| learned.keys(map)).unwrap_or_default();
        keys.extend(one_key("stitching", &self.own_keys()));
        keys
    }

    fn lines(&self, name: &str, map: &TopologyMap) -> Vec<Line> {
        let learned = self.learned.as_ref().map(|learned| learned.lines(name, map)).unwrap_or_default();
        // The frame of the first robot is that of the map.
        let first = self.robots.iter().take(1).filter(|robot| matches!(robot.outcome, RobotOutcome::LeftOut { .. }));
        let others = first.chain(self.robots.iter().skip(1)).map(|robot| robot.line(name));
        learned.into_iter().chain(others).collect()
    }

    fn curves(&self) -> Vec<CurveFinding<'_>> {
        self.learned.as_ref().map(|learned| learned.curves()).unwrap_or_default()
    }

    fn obstacles(&self) -> Option<&AbsorptionMap> {
        self.learned.as_ref()?.obstacles()
    }

    fn path_loss_exponent(&self) -> Option<f64> {
        self.learned.as_ref()?.path_loss_exponent()
    }

    fn shadowing(&self) -> Option<StaticShadowing> {
        self.learned.as_ref()?.shadowing()
    }

    fn at_bound(&self) -> &[NodeId] {
        self.learned.as_ref().map(|learned| learned.at_bound()).unwrap_or_default()
    }
}
