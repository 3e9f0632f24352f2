//! Neighbour discovery before the survey, if the maps of a scenario need it.

use sextant_kernel::{NodeId, Watch};
use sextant_mac::EnergySpent;
use sextant_mapper::{Knowledge, KnowledgeKind};
use sextant_scenario::{MapJob, Scenario};
use sextant_sim::{Discovered, Round, discover};

use super::error::RunError;
use crate::mapping::MapLogs;
use crate::summary::{DiscoverySummary, EnergySummary, RoundSummary};

/// The results of discovery before the survey.
#[derive(Clone, Debug, Default)]
pub struct Discoveries {
    /// Receptions of hello packets between nodes.
    pub neighbours: Option<Discovered>,
    /// Receptions of the anchors' packets by nodes.
    pub beacons: Option<Discovered>,
}

impl Discoveries {
    /// Simulates the rounds of discovery that the maps of `scenario` need: none, one or both.
    ///
    /// # Errors
    /// If the settings of channel and packets do not fit together, or `watch` stops the work.
    pub fn of(scenario: &Scenario, watch: &dyn Watch) -> Result<Self, RunError> {
        let needs = |kind: fn(KnowledgeKind) -> bool| {
            scenario.maps().iter().any(|map| map.mapper.uses().iter().any(|&uses| kind(uses)))
        };
        let (neighbours, beacons) = (needs(KnowledgeKind::needs_neighbours), needs(KnowledgeKind::needs_beacons));
        if !(neighbours || beacons) {
            return Ok(Self::default());
        }
        let setup = scenario.setup();
        let simulate = |round| discover(&setup, scenario.discovery(), round, watch);
        let anchors: Vec<NodeId> = scenario.anchors().iter().map(|anchor| anchor.node).collect();
        Ok(Self {
            neighbours: neighbours.then(|| simulate(Round::Neighbours)).transpose()?,
            beacons: beacons.then(|| simulate(Round::Beacons(&anchors))).transpose()?,
        })
    }

    /// Everything that `map` of `scenario` may use of the `logs` of its survey.
    #[must_use]
    pub(crate) fn knowledge<'a>(
        &'a self,
        scenario: &'a Scenario,
        logs: &'a MapLogs<'a>,
        map: &'a MapJob,
    ) -> Knowledge<'a> {
        Knowledge {
            neighbours: self.neighbours.as_ref().map(|round| &round.log),
            beacons: self.beacons.as_ref().map(|round| &round.log),
            anchors: scenario.anchors(),
            obstacles: Some(&scenario.world().obstacles),
            seed: scenario.seed(),
            ..logs.knowledge(map)
        }
    }

    /// The summary of the rounds; `None` if there were none.
    #[must_use]
    pub fn summary(&self, scenario: &Scenario) -> Option<DiscoverySummary> {
        if self.neighbours.is_none() && self.beacons.is_none() {
            return None;
        }
        let round = |discovered: &Discovered, senders| RoundSummary {
            senders,
            packets_sent: discovered.sent,
            packets_unsent: discovered.unsent,
            links: discovered.log.links().len(),
            duration_s: discovered.duration().as_secs_f64(),
            energy_j: energy(discovered.energy),
        };
        Some(DiscoverySummary {
            neighbours: self.neighbours.as_ref().map(|found| round(found, scenario.world().nodes.len())),
            anchors: self.beacons.as_ref().map(|found| round(found, scenario.anchors().len())),
        })
    }
}

fn energy(spent: EnergySpent) -> EnergySummary {
    EnergySummary { tx: spent.tx_j, rx: spent.rx_j, idle: spent.idle_j + spent.sleep_j }
}
