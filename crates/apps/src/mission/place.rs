//! Where a mission takes place, and the robots that are to do it, as its check sees them.

use sextant_sim::{Antennas, Ieee80211ad, Radio, RobotBody, SensorsConfig, TargetConfig, World};

/// Where a mission takes place, as its check sees it.
#[derive(Clone, Copy, Debug)]
pub struct MissionPlace<'a> {
    /// The world.
    pub world: &'a World,
    /// Its targets, as written.
    pub targets: &'a [TargetConfig],
    /// The sensors of its nodes, as written.
    pub sensors: &'a SensorsConfig,
    /// Whether there is a sink in the network of the mission.
    pub has_sink: bool,
    /// The links of that network.
    pub medium: MissionMedium<'a>,
}

/// Over which links a mission works.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissionLinks {
    /// Those of IEEE 802.15.4, over which nodes and robots exchange messages.
    Messages,
    /// Those of IEEE 802.11ad, whose antennas have sectors.
    Sectors,
}

/// The links that a mission gets.
#[derive(Clone, Copy, Debug)]
pub enum MissionMedium<'a> {
    /// Radios that exchange messages.
    Messages(&'a Radio),
    /// Links with sectors, and their antennas.
    Sectors(&'a Ieee80211ad, &'a Antennas),
}

impl<'a> MissionPlace<'a> {
    /// The radios of a network that carries messages.
    ///
    /// # Panics
    /// If the mission works over other links.
    #[must_use]
    pub fn radio(&self) -> &'a Radio {
        match self.medium {
            MissionMedium::Messages(radio) => radio,
            MissionMedium::Sectors(..) => panic!("the mission works over messages"),
        }
    }

    /// The links of a network with sectors, and their antennas.
    ///
    /// # Panics
    /// If the mission works over other links.
    #[must_use]
    pub fn sectors(&self) -> (&'a Ieee80211ad, &'a Antennas) {
        match self.medium {
            MissionMedium::Sectors(links, antennas) => (links, antennas),
            MissionMedium::Messages(_) => panic!("the mission works over sectors"),
        }
    }
}

/// The robots that are to do a mission, as its check sees them.
#[derive(Clone, Copy, Debug)]
pub struct MissionRobots<'a> {
    /// The robots.
    pub bodies: &'a [&'a RobotBody],
    /// The targets of the world, as written.
    pub targets: &'a [TargetConfig],
    /// Whether they may be slower than what they search.
    pub may_be_slower: bool,
}
