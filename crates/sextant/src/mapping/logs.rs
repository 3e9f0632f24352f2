//! The logs of the networks that robots surveyed.

use sextant_channel::{NetworkLog, NetworkLogs, ReceptionLog};
use sextant_mapper::{FrameKnowledge, Knowledge};

use sextant_scenario::MapJob;

/// The logs of the networks that robots surveyed, at least one. The name of a network is empty if it has none.
#[derive(Clone, Debug)]
pub(crate) struct MapLogs<'a> {
    logs: Vec<(&'a str, &'a ReceptionLog)>,
}

impl<'a> From<&'a NetworkLogs> for MapLogs<'a> {
    fn from(logs: &'a NetworkLogs) -> Self {
        let named = |of: &'a NetworkLog| (of.network.as_deref().unwrap_or_default(), &of.log);
        Self { logs: logs.iter().map(named).collect() }
    }
}

impl<'a> MapLogs<'a> {
    /// The log of a network without a name.
    pub(super) fn alone(log: &'a ReceptionLog) -> Self {
        Self { logs: vec![("", log)] }
    }

    /// The log of the network of `map`. For a joint map it is that of its first network. A log that is alone is that of
    /// any network.
    #[must_use]
    pub(crate) fn of(&self, map: &MapJob) -> &'a ReceptionLog {
        let name = map.mapper.networks().first().copied().or(map.network.as_deref());
        name.and_then(|name| self.named(name)).unwrap_or(self.logs[0].1)
    }

    /// The log of the network `name`.
    pub(super) fn named(&self, name: &str) -> Option<&'a ReceptionLog> {
        self.logs.iter().find(|(other, _)| *other == name).map(|(_, log)| *log)
    }

    /// What `map` may know of the logs.
    #[must_use]
    pub(crate) fn knowledge<'b>(&'b self, map: &'b MapJob) -> Knowledge<'b> {
        let frames = FrameKnowledge::Shared(&map.robots_in_world);
        Knowledge { logs: &self.logs, frames, ..Knowledge::from(self.of(map)) }
    }
}
