//! Who takes part in a mission.

use std::time::Duration;

use sextant_sim::{NetworkId, Radio, RobotBody};

/// Who takes part in a mission.
#[derive(Clone, Copy, Debug)]
pub struct MissionTeam<'a> {
    /// Number of nodes.
    pub nodes: usize,
    /// The robots.
    pub robots: &'a [RobotBody],
    /// Number of sinks.
    pub sinks: usize,
    /// Number of targets.
    pub targets: usize,
    /// The network over which they exchange messages.
    pub network: NetworkId,
    /// Its radios, if they exchange messages.
    pub radio: Option<&'a Radio>,
    /// When the mission ends at the latest.
    pub duration: Duration,
}

impl<'a> MissionTeam<'a> {
    /// The radios of a network that carries messages.
    ///
    /// # Panics
    /// If the mission works over other links.
    #[must_use]
    pub fn messages(&self) -> &'a Radio {
        self.radio.expect("a mission with messages is refused over other links")
    }
}
