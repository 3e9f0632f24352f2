//! The stations of a scenario by name.

use std::collections::BTreeMap;

use sextant::Scenario;
use sextant::kernel::StationId;

/// What a station is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StationKind {
    Node,
    Robot,
    Sink,
}

/// The stations of the survey of a scenario: nodes, then robots, then sinks.
#[derive(Debug, Default)]
pub(crate) struct Names {
    names: Vec<String>,
    ids: BTreeMap<String, StationId>,
    robots: usize,
    sinks: usize,
}

impl Names {
    pub(crate) fn of(scenario: &Scenario) -> Self {
        let mut names: Vec<String> = scenario.world().nodes.iter().map(|node| node.name.clone()).collect();
        let robots = names.len();
        names.extend(scenario.robots_of_survey().map(|robot| robot.name.clone()));
        let sinks = names.len();
        names.extend(scenario.config().sinks.iter().map(|sink| sink.name.clone()));
        // Of two stations with one name, the first has it.
        let mut ids = BTreeMap::new();
        for (number, name) in (0..).zip(&names) {
            ids.entry(name.clone()).or_insert(StationId(number));
        }
        Self { names, ids, robots, sinks }
    }

    /// The name of a station.
    pub(crate) fn name(&self, station: StationId) -> &str {
        self.names.get(station.0 as usize).map_or("", String::as_str)
    }

    /// The station with this name.
    pub(crate) fn station(&self, name: &str) -> Option<StationId> {
        self.ids.get(name).copied()
    }

    /// What a station is.
    pub(crate) fn kind(&self, station: StationId) -> StationKind {
        match station.index() {
            index if index < self.robots => StationKind::Node,
            index if index < self.sinks => StationKind::Robot,
            _ => StationKind::Sink,
        }
    }

    pub(crate) fn nodes(&self) -> &[String] {
        &self.names[..self.robots]
    }

    pub(crate) fn robots(&self) -> &[String] {
        &self.names[self.robots..self.sinks]
    }

    pub(crate) fn sinks(&self) -> &[String] {
        &self.names[self.sinks..]
    }
}
