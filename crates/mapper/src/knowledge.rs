//! The knowledge that an algorithm is given, and the kinds of knowledge that it uses.

#[cfg(feature = "obstacles")]
use sextant_channel::ObstacleField;
use sextant_channel::{Anchor, NeighbourLog, Position, ReceptionLog};
use sextant_kernel::Seed;

use crate::error::MapError;
use crate::posterior::PlacePrior;

/// Everything that an algorithm may use. Maximum likelihood needs only the reception log; most algorithms for
/// comparison need more.
#[derive(Clone, Copy, Debug)]
pub struct Knowledge<'a> {
    /// What the robots recorded.
    pub log: &'a ReceptionLog,
    /// What they recorded in each network by name, if there are several, for maps from several logs.
    pub logs: &'a [(&'a str, &'a ReceptionLog)],
    /// What the nodes heard of each other's hello packets.
    pub neighbours: Option<&'a NeighbourLog>,
    /// What the nodes heard of the anchors' packets.
    pub beacons: Option<&'a NeighbourLog>,
    /// The nodes that know their place, by node.
    pub anchors: &'a [Anchor],
    /// The obstacles, if they are known. Only a simulation knows them.
    #[cfg(feature = "obstacles")]
    pub obstacles: Option<&'a ObstacleField>,
    /// Where nodes can be, if somebody knows it.
    pub prior: Option<&'a PlacePrior>,
    /// What is known of the frames of coordinates in which the robots wrote their logs.
    pub frames: FrameKnowledge<'a>,
    /// Seed of the algorithm's own choices, such as the nodes from which hops are counted.
    pub seed: Seed,
}

/// What is known of the frames of coordinates in which robots wrote their logs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameKnowledge<'a> {
    /// The robots of these names share one; nobody knows those of the others.
    Shared(&'a [String]),
    /// All robots share one, such as that of the earth.
    SharedByAll,
}

impl Default for FrameKnowledge<'_> {
    /// Nothing is known.
    fn default() -> Self {
        Self::Shared(&[])
    }
}

impl<'a> From<&'a ReceptionLog> for Knowledge<'a> {
    /// Only the log is known.
    fn from(log: &'a ReceptionLog) -> Self {
        Self {
            log,
            logs: &[],
            neighbours: None,
            beacons: None,
            anchors: &[],
            #[cfg(feature = "obstacles")]
            obstacles: None,
            prior: None,
            frames: FrameKnowledge::default(),
            seed: Seed(1),
        }
    }
}

/// A kind of knowledge that an algorithm uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "config", derive(serde::Serialize))]
#[cfg_attr(feature = "config", serde(rename_all = "kebab-case"))]
pub enum KnowledgeKind {
    /// Which packets the robot heard where, and where it was.
    RobotReceptions,
    /// With what strength it heard them.
    RobotRssi,
    /// Distances to nodes that the robot measured.
    RobotRanges,
    /// Where the robot drove, and which obstacles it met.
    RobotPath,
    /// Which nodes heard each other.
    Neighbours,
    /// With what strength they heard each other.
    NeighbourRssi,
    /// Which nodes heard which anchors.
    AnchorReceptions,
    /// With what strength they heard the anchors.
    AnchorRssi,
    /// Where the anchors are.
    Anchors,
    /// How power falls with distance.
    PathLoss,
    /// The obstacles.
    Obstacles,
}

impl KnowledgeKind {
    /// The name in tables, for example `anchor RSSI`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::RobotReceptions => "robot",
            Self::RobotRssi => "robot RSSI",
            Self::RobotRanges => "robot ranges",
            Self::RobotPath => "robot path",
            Self::Neighbours => "neighbours",
            Self::NeighbourRssi => "neighbour RSSI",
            Self::AnchorReceptions => "anchors heard",
            Self::AnchorRssi => "anchor RSSI",
            Self::Anchors => "anchors",
            Self::PathLoss => "path loss",
            Self::Obstacles => "obstacles",
        }
    }

    /// Whether nodes must have heard each other's hello packets.
    #[must_use]
    pub fn needs_neighbours(self) -> bool {
        matches!(self, Self::Neighbours | Self::NeighbourRssi)
    }

    /// Whether nodes must have heard the anchors' packets.
    #[must_use]
    pub fn needs_beacons(self) -> bool {
        matches!(self, Self::AnchorReceptions | Self::AnchorRssi)
    }
}

impl<'a> Knowledge<'a> {
    /// 2 if all anchors have the same height, otherwise 3. Without anchors, the heights of the stops decide.
    #[must_use]
    pub fn dimensions(&self) -> usize {
        let anchors = self.anchors.iter().map(|anchor| anchor.position);
        let is_planar = if self.anchors.is_empty() {
            share_one_height(self.log.stops().iter().map(|stop| stop.position))
        } else {
            share_one_height(anchors)
        };
        if is_planar { 2 } else { 3 }
    }

    /// What the robots recorded in the network called `name`.
    pub(crate) fn log_of(&self, name: &str) -> Result<&'a ReceptionLog, MapError> {
        let found = self.logs.iter().find(|(other, _)| *other == name).map(|(_, log)| *log);
        found.ok_or_else(|| {
            let known: Vec<String> = self.logs.iter().map(|(name, _)| format!("`{name}`")).collect();
            let known = if known.is_empty() { "one log without a name".to_owned() } else { known.join(", ") };
            MapError::NoLog { network: name.to_owned(), known }
        })
    }

    /// What the nodes heard of each other.
    pub(crate) fn neighbours(&self, algorithm: &'static str) -> Result<&'a NeighbourLog, MapError> {
        self.neighbours.ok_or(MapError::Missing {
            algorithm,
            what: "what the nodes heard of each other",
            remedy: "a simulation finds it out as `discovery` says",
        })
    }

    /// What the nodes heard of the anchors.
    pub(crate) fn beacons(&self, algorithm: &'static str) -> Result<&'a NeighbourLog, MapError> {
        self.beacons.ok_or(MapError::Missing {
            algorithm,
            what: "what the nodes heard of the anchors",
            remedy: "a simulation finds it out as `anchors` and `discovery` say",
        })
    }

    /// The obstacles.
    #[cfg(feature = "obstacles")]
    pub(crate) fn obstacles(&self, algorithm: &'static str) -> Result<&'a ObstacleField, MapError> {
        self.obstacles.ok_or(MapError::Missing {
            algorithm,
            what: "the obstacles of the world",
            remedy: "only a scenario tells; without one, take `obstacles = \"unknown\"`",
        })
    }

    /// The anchors, if there are at least `needed`.
    pub(crate) fn anchors(&self, algorithm: &'static str, needed: usize) -> Result<&'a [Anchor], MapError> {
        let found = self.anchors.len();
        if found < needed { Err(MapError::TooFewAnchors { algorithm, found, needed }) } else { Ok(self.anchors) }
    }

    /// The places of the anchors, by node.
    pub(crate) fn known_places(&self) -> Vec<Option<Position>> {
        let mut places = vec![None; self.log.node_count()];
        for anchor in self.anchors {
            places[anchor.node.index()] = Some(anchor.position);
        }
        places
    }
}

fn share_one_height(mut places: impl Iterator<Item = Position>) -> bool {
    let first = places.next().map_or(0.0, |place| place.z_m);
    places.all(|place| (place.z_m - first).abs() <= 1e-9)
}
