//! Where a mission takes place, and the robots that are to do it, as its check sees them.

use sextant_sim::{Radio, RobotBody, SensorsConfig, TargetConfig, World};

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
    /// The radios of that network.
    pub radio: &'a Radio,
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
