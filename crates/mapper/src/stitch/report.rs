//! What stitching found out, and how it reads.

#[cfg(feature = "config")]
use serde::Serialize;

use super::frame_change::{FrameChange, Handedness};
use super::joint::FrameAgreement;
use super::logs::moved_log;
use super::pair::PairFit;
#[cfg(feature = "config")]
use super::pair::PairState;
use crate::absorption::AbsorptionMap;
#[cfg(feature = "config")]
use crate::learned::one_key;
use crate::learned::{CurveFinding, EstimatorFindings, Finding, Line, Section, StaticShadowing};
use crate::topology_map::TopologyMap;
use sextant_channel::ReceptionLog;
use sextant_kernel::NodeId;
use sextant_kernel::text::{counted, listed};

/// The frames of the robots of a log, and what else the estimator learned.
#[derive(Clone, Debug, PartialEq)]
pub struct Stitching {
    /// The robots that listened, in the order of the log.
    pub robots: Vec<RobotFrame>,
    /// The names of the robots of each map that was stitched: first those in the frame of the map, then each other one.
    pub members: Vec<Vec<String>>,
    /// The members that fit together, by number: first those on the map, then those that fit to each other, but not to the map.
    pub groups: Vec<Vec<usize>>,
    /// Pairs of members.
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
    /// Its frame is that of the map.
    Known(FrameAgreement),
    /// Its stops were moved into the frame of the map.
    Joined(JoinedFrame),
    /// The map is made without it.
    LeftOut {
        /// Why.
        why: String,
    },
}

impl RobotOutcome {
    /// How the frame of the robot becomes that of the map; `None` if the map is made without it.
    const fn change(&self) -> Option<FrameChange> {
        match self {
            Self::Known(_) => Some(FrameChange::NONE),
            Self::Joined(joined) => Some(joined.change),
            Self::LeftOut { .. } => None,
        }
    }
}

/// How a robot was joined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JoinedFrame {
    /// How its frame becomes that of the map.
    pub change: FrameChange,
    /// How its map agrees with those of the others.
    pub agreement: FrameAgreement,
    /// How far errors of its frame move its nodes (m), as the root of the mean square; `None` if its nodes do not tell it.
    pub deviation_m: Option<f64>,
}

/// A robot as written in a summary.
#[cfg(feature = "config")]
#[derive(Serialize)]
struct RobotKeys<'a> {
    robot: &'a str,
    joined: bool,
    known: bool,
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
    frame_deviation_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<&'a str>,
}

/// A pair of robots as written in a summary.
#[cfg(feature = "config")]
#[derive(Serialize)]
struct PairKeys {
    robots: [String; 2],
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
    groups: Vec<Vec<&'a str>>,
    pairs: Vec<PairKeys>,
}

impl Stitching {
    /// That of robots which all have the frame of the map; `learned` is what was learned with it.
    pub(super) fn nothing(names: Vec<String>, map: &TopologyMap, learned: Option<EstimatorFindings>) -> Self {
        let robot = |name: &String| RobotFrame {
            name: name.clone(),
            placed: map.mapped(),
            outcome: RobotOutcome::Known(FrameAgreement::default()),
        };
        let robots = names.iter().map(robot).collect();
        Self { robots, members: vec![names], groups: vec![vec![0]], pairs: Vec::new(), learned }
    }

    /// Number of robots whose stops are in the map.
    #[must_use]
    pub fn joined(&self) -> usize {
        self.robots.iter().filter(|robot| !matches!(robot.outcome, RobotOutcome::LeftOut { .. })).count()
    }

    /// The part of `log` of these robots, in the frame of the map.
    #[must_use]
    pub fn joined_log(&self, log: &ReceptionLog) -> ReceptionLog {
        moved_log(log, |robot| {
            let name = log.robot_name(robot);
            self.robots.iter().find(|robot| robot.name == name).and_then(|robot| robot.outcome.change())
        })
    }

    /// The names of the robots of a group of members.
    fn names_of(&self, group: &[usize]) -> Vec<&str> {
        group.iter().flat_map(|&member| &self.members[member]).map(String::as_str).collect()
    }

    /// The line on robots that are known to have one frame, if there are several.
    fn known_line(&self, map: &str) -> Option<Line> {
        let known = self.members.first().filter(|names| names.len() > 1)?;
        let text = if self.members.len() == 1 {
            format!(
                "{map}: the frames of all {} are known, so nothing was stitched; `stitch.known = []` finds them from \
                 the nodes",
                counted(known.len(), "robot")
            )
        } else {
            format!("{map}: {} have the frame of the map", listed(known))
        };
        Some(Line { section: Section::Laws, text })
    }

    /// The warnings on robots that fit together, but not to the map.
    fn group_lines(&self, map: &str) -> Vec<Line> {
        let apart = self.groups.iter().skip(1).filter(|group| group.len() > 1).map(|group| {
            let (names, on_map) = (self.names_of(group), self.names_of(&self.groups[0]));
            let text = format!(
                "{map}: warning: {} fit together, but not to {}; `stitch.known = [\"{}\"]` makes a map of them",
                listed(&names),
                listed(&on_map),
                names[0]
            );
            Line { section: Section::Warnings, text }
        });
        apart.collect()
    }
}

#[cfg(feature = "config")]
impl Stitching {
    fn own_keys(&self) -> StitchingKeys<'_> {
        StitchingKeys {
            joined: self.joined(),
            robots: self.robots.iter().map(RobotFrame::keys).collect(),
            groups: self.groups.iter().map(|group| self.names_of(group)).collect(),
            pairs: self.pairs.iter().map(|pair| self.pair_keys(pair)).collect(),
        }
    }

    fn pair_keys(&self, pair: &PairFit) -> PairKeys {
        let (agreeing_nodes, residual_m, undecided) = match &pair.state {
            PairState::Fitted { agreeing, residual_m, .. } => (Some(*agreeing), Some(*residual_m), None),
            PairState::Undecided(fault) => (None, None, Some(fault.to_string())),
        };
        let robots = pair.robots.map(|member| listed(&self.members[member]));
        PairKeys { robots, shared_nodes: pair.shared, agreeing_nodes, residual_m, undecided }
    }
}

#[cfg(feature = "config")]
impl RobotFrame {
    fn keys(&self) -> RobotKeys<'_> {
        let keys = RobotKeys {
            robot: &self.name,
            joined: false,
            known: false,
            placed: self.placed,
            turn_deg: None,
            mirrored: None,
            scale: None,
            offset_m: None,
            shared_nodes: None,
            agreeing_nodes: None,
            residual_m: None,
            frame_deviation_m: None,
            why: None,
        };
        let joined = |change: &FrameChange, of: &FrameAgreement| RobotKeys {
            joined: true,
            turn_deg: Some(change.turn_rad.to_degrees()),
            mirrored: Some(change.handedness == Handedness::Mirrored),
            scale: Some(change.scale),
            offset_m: Some(change.offset.into()),
            shared_nodes: Some(of.shared),
            agreeing_nodes: Some(of.agreeing),
            residual_m: Some(of.residual_m),
            ..keys
        };
        match &self.outcome {
            RobotOutcome::Known(agreement) => RobotKeys { known: true, ..joined(&FrameChange::NONE, agreement) },
            RobotOutcome::Joined(JoinedFrame { change, agreement, deviation_m }) => {
                RobotKeys { frame_deviation_m: *deviation_m, ..joined(change, agreement) }
            }
            RobotOutcome::LeftOut { why } => RobotKeys { why: Some(why), ..keys },
        }
    }
}

impl RobotFrame {
    /// The line of it under a table of results that calls the map by `map`; none if its frame is that of the map.
    fn line(&self, map: &str) -> Option<Line> {
        let name = &self.name;
        match &self.outcome {
            RobotOutcome::Known(_) => None,
            RobotOutcome::Joined(JoinedFrame { change, agreement, deviation_m }) => {
                let mirrored = match change.handedness {
                    Handedness::Same => "",
                    Handedness::Mirrored => "mirrored, ",
                };
                let exact = deviation_m.map_or_else(String::new, |m| format!(", frame known to {m:.2} m"));
                let text = format!(
                    "{map}: {name} joined: {mirrored}turned by {:.1} degrees; {} of {} agree, residual {:.2} m{exact}",
                    change.turn_rad.to_degrees(),
                    agreement.agreeing,
                    counted(agreement.shared, "shared node"),
                    agreement.residual_m,
                );
                Some(Line { section: Section::Laws, text })
            }
            RobotOutcome::LeftOut { why } => {
                let text = format!("{map}: warning: {name} is not in the map: {why}");
                Some(Line { section: Section::Warnings, text })
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
        let robots = self.robots.iter().filter_map(|robot| robot.line(name));
        learned.into_iter().chain(self.known_line(name)).chain(robots).chain(self.group_lines(name)).collect()
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
