//! Nodes that move: over listed places, as a file says, or by the random waypoint model.

mod files;
mod random_waypoint;
mod track;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{Files, NodeId, Seed, SettingError, SimTime};

use super::layout::{NodesOfGroup, PlacedNode};
use super::target::{AtEnd, Leg, Waypoints, WaypointsConfig};

pub use files::{MotionFileConfig, MotionFormat};
pub use random_waypoint::RandomWaypointConfig;
use random_waypoint::Wanderer;
use track::Track;

/// Nodes that move, as written in a scenario. The layout says where they are only if no motion says it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct NodeMotionConfig {
    /// Which nodes; no other entry has them.
    pub nodes: NodesOfGroup,
    /// How each of them moves.
    pub motion: NodeWayConfig,
}

/// How a node moves, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum NodeWayConfig {
    /// Over listed places, at one speed.
    Waypoints(WaypointsConfig),
    /// As a file says, which has a way for each node of the entry.
    File(MotionFileConfig),
    /// From one random place of a rectangle to the next, each time at a random speed.
    RandomWaypoint(RandomWaypointConfig),
}

/// How a node moves.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeMotion {
    /// The node.
    pub node: NodeId,
    way: NodeWay,
}

#[derive(Clone, Debug, PartialEq)]
enum NodeWay {
    Waypoints(Waypoints),
    Track(Track),
    RandomWaypoint(RandomWaypointConfig),
}

/// A node on its way: its legs, one after the other.
#[derive(Clone, Debug)]
pub(crate) struct NodeCourse {
    place: Position,
    time: SimTime,
    legs: Legs,
}

#[derive(Clone, Debug)]
enum Legs {
    Waypoints { way: Waypoints, begun: usize },
    Track { track: Track, begun: usize },
    RandomWaypoint(Wanderer),
}

impl NodeMotionConfig {
    /// The file that it names, and its key.
    pub(super) fn file_mut(&mut self) -> Option<(String, &mut PathBuf)> {
        match &mut self.motion {
            NodeWayConfig::File(config) => Some(("motion.file.file".to_owned(), &mut config.file)),
            NodeWayConfig::Waypoints(_) | NodeWayConfig::RandomWaypoint(_) => None,
        }
    }

    /// How each chosen node moves; `is_taken` tells those of entries before.
    fn build(
        &self,
        nodes: &[PlacedNode],
        is_taken: impl Fn(usize) -> bool,
        obstacles: &ObstacleField,
        files: &Files,
    ) -> Result<Vec<NodeMotion>, SettingError> {
        let members = self.nodes.choose(nodes, is_taken)?;
        let motion = |node: usize, way: NodeWay| NodeMotion { node: NodeId::from_index(node), way };
        match &self.motion {
            NodeWayConfig::Waypoints(config) => {
                let way = config.build(obstacles).map_err(|error| error.within("motion.waypoints"))?;
                if config.at_end == AtEnd::Leave {
                    let allowed = "`stay` or `loop`: a node stays in the world";
                    return Err(SettingError::new("motion.waypoints.at_end", "leave", allowed));
                }
                Ok(members.into_iter().map(|node| motion(node, NodeWay::Waypoints(way.clone()))).collect())
            }
            NodeWayConfig::RandomWaypoint(config) => {
                config.check().map_err(|error| error.within("motion.random_waypoint"))?;
                Ok(members.into_iter().map(|node| motion(node, NodeWay::RandomWaypoint(*config))).collect())
            }
            NodeWayConfig::File(config) => {
                let names: Vec<&str> = members.iter().map(|&node| &*nodes[node].name).collect();
                let tracks = config.read(&names, files).map_err(|error| error.within("motion.file"))?;
                Ok(members.into_iter().zip(tracks).map(|(node, track)| motion(node, NodeWay::Track(track))).collect())
            }
        }
    }
}

/// How nodes move by all entries of a scenario, by node. The nodes are put where they start.
///
/// # Errors
/// If an entry is invalid. The key begins with `motions`.
pub(super) fn build(
    configs: &[NodeMotionConfig],
    nodes: &mut [PlacedNode],
    obstacles: &ObstacleField,
    seed: Seed,
    files: &Files,
) -> Result<Vec<NodeMotion>, SettingError> {
    let mut motions: Vec<NodeMotion> = Vec::new();
    for (i, config) in configs.iter().enumerate() {
        let is_taken = |node: usize| motions.iter().any(|motion| motion.node.index() == node);
        let built = config.build(nodes, is_taken, obstacles, files);
        motions.extend(built.map_err(|error| error.within(format!("motions[{i}]")))?);
    }
    motions.sort_by_key(|motion| motion.node);
    for motion in &motions {
        nodes[motion.node.index()].position = motion.course(seed).place;
    }
    Ok(motions)
}

impl NodeMotion {
    /// Its way from the start of time.
    pub(crate) fn course(&self, seed: Seed) -> NodeCourse {
        let (place, legs) = match &self.way {
            NodeWay::Waypoints(way) => (way.start(), Legs::Waypoints { way: way.clone(), begun: 0 }),
            NodeWay::Track(track) => (track.start(), Legs::Track { track: track.clone(), begun: 0 }),
            NodeWay::RandomWaypoint(config) => {
                let wanderer = Wanderer::new(*config, self.node, seed);
                (wanderer.start(), Legs::RandomWaypoint(wanderer))
            }
        };
        NodeCourse { place, time: SimTime::ZERO, legs }
    }
}

impl NodeCourse {
    /// Where the last leg ends, or where it stays if there is no other.
    pub(crate) fn place(&self) -> Position {
        self.place
    }

    /// The next leg, which begins when the one before it ends; `None` if the node stays where it is.
    pub(crate) fn next_leg(&mut self) -> Option<Leg> {
        let leg = match &mut self.legs {
            Legs::Waypoints { way, begun } => {
                *begun += 1;
                way.leg(*begun - 1, self.time)?
            }
            Legs::Track { track, begun } => {
                *begun += 1;
                let Some(leg) = track.leg(*begun - 1) else {
                    // The last row may be a jump, which takes no time.
                    self.place = track.end();
                    return None;
                };
                leg
            }
            Legs::RandomWaypoint(wanderer) => wanderer.next_leg(self.place, self.time),
        };
        let leg = leg.that_takes_time();
        (self.place, self.time) = (leg.to, leg.end);
        Some(leg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_leg_of_a_node_ends_after_its_start() {
        let tiny = RandomWaypointConfig {
            min_m: [0.0; 2],
            max_m: [1e-9; 2],
            speed_m_per_s: [1e3; 2],
            pause_s: 0.0,
            height_m: 0.0,
        };
        let mut course = NodeMotion { node: NodeId(0), way: NodeWay::RandomWaypoint(tiny) }.course(Seed(1));
        for _ in 0..100 {
            let leg = course.next_leg().expect("it wanders for ever");
            assert!(leg.end > leg.start, "{leg:?}");
        }
    }
}
