//! What of a log the map of each node depends on, beside the law.

use sextant_channel::{ReceptionLog, SectorGains};
use sextant_kernel::NodeId;

use super::PatternMap;
use super::gain_map::GainMap;
use crate::log_facts::SoughtHeights;
use crate::log_facts::reach::{HeardNode, known_reach_m, reach_of_m};
use crate::log_facts::search_box::{Limits, SearchBox};

/// The antenna of a log, and where its nodes are searched for.
#[derive(Debug)]
pub(super) struct AntennaScene {
    pub(super) map: GainMap,
    /// The place of each sector among the gains, by its identity.
    pub(super) columns: Vec<Option<usize>>,
    /// How far nodes are heard, as the log says without a model (m).
    pub(super) reach_m: f64,
    /// Whether the log says so.
    pub(super) is_reach_known: bool,
    pub(super) heights: SoughtHeights,
    limits: Limits,
}

impl AntennaScene {
    /// That of a log of which each node that was heard is within so many metres of its farthest stop; `None` if none was.
    pub(super) fn of(
        settings: &PatternMap,
        log: &ReceptionLog,
        gains: &SectorGains,
        farthest_m: &[f64],
    ) -> Option<Self> {
        if farthest_m.is_empty() {
            return None;
        }
        let reach_m = reach_of_m(log, farthest_m.iter().copied());
        let heights = SoughtHeights::of_log(log.stops(), settings.z_range_m, reach_m, settings.grid_step_m)?;
        let mut columns = vec![None; 256];
        for (at, &id) in gains.identities().iter().enumerate() {
            columns[usize::from(id)] = Some(at);
        }
        Some(Self {
            map: GainMap::new(gains),
            columns,
            reach_m,
            is_reach_known: known_reach_m(farthest_m.iter().copied()).is_some(),
            heights,
            limits: Limits::new(log, reach_m, heights),
        })
    }

    /// The box of each node.
    pub(super) fn boxes(&self, heard: &[HeardNode]) -> Vec<(NodeId, SearchBox)> {
        heard.iter().map(|heard| (heard.node, self.limits.of(heard))).collect()
    }
}
