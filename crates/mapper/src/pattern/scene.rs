//! What of a log the map of each node depends on, beside the law.

use sextant_channel::{Reception, ReceptionLog, SectorGains, Stop};
use sextant_kernel::NodeId;

use super::PatternMap;
use super::evidence::{SectorColumns, SurveyedArea};
use super::gain_map::{Directions, GainMap};
use super::ways::{KnownObstacles, KnownWays};
use crate::log_facts::SoughtHeights;
use crate::log_facts::reach::{HeardNode, known_reach_m, reach_of_m};
use crate::log_facts::search_box::{Limits, SearchBox};

/// Strengths and directions tell where a node is outside the stops: boxes are wider by this share of the reach.
const WIDER: f64 = 0.5;
/// Places whose heights differ by less have the same height (m).
const LEVEL_M: f64 = 1e-6;

/// The least strengths in a log (dB); none without strengths.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LeastStrengths {
    /// Of a sector that a node reported: weaker ones are absent.
    sector_db: Option<f64>,
    /// Of the best sector of a link: weaker links are not heard.
    link_db: Option<f64>,
}

impl LeastStrengths {
    pub(super) fn of(log: &ReceptionLog) -> Self {
        let strongest = |entry: &Reception| {
            let reported = log.sector_snrs(entry.node, entry.stop).iter().map(|sector| f64::from(sector.snr_db));
            reported.chain(entry.snr_db).max_by(f64::total_cmp)
        };
        let heard = log.receptions().iter().filter(|entry| entry.received > 0);
        let link_db = heard.filter_map(|entry| strongest(&entry)).min_by(f64::total_cmp);
        Self { sector_db: log.sector_reports().map(|report| report.snr_db).min_by(f64::total_cmp), link_db }
    }

    /// Those of two parts of a log.
    pub(super) fn and(self, other: Self) -> Self {
        let least = |one: Option<f64>, other| [one, other].into_iter().flatten().min_by(f64::total_cmp);
        Self { sector_db: least(self.sector_db, other.sector_db), link_db: least(self.link_db, other.link_db) }
    }
}

/// The antenna of a log, and where its nodes are searched for.
#[derive(Debug)]
pub(super) struct AntennaScene {
    pub(super) map: GainMap,
    pub(super) columns: SectorColumns,
    /// How far nodes are heard, as the log says without a model (m).
    pub(super) reach_m: f64,
    /// Whether the log says so.
    pub(super) is_reach_known: bool,
    pub(super) heights: SoughtHeights,
    pub(super) surveyed: SurveyedArea,
    /// The ways among known obstacles, if any are known.
    pub(super) ways: Option<KnownWays>,
    /// The least strength of a link that is heard (dB).
    pub(super) least_link_db: f64,
    limits: Limits,
    /// Boxes are wider by this (m).
    wider_m: f64,
}

impl AntennaScene {
    /// That of a log of which each node that was heard is within so many metres of its farthest stop; `None` if none was.
    /// `least` are the least strengths in the log.
    pub(super) fn of(
        settings: &PatternMap,
        log: &ReceptionLog,
        gains: &SectorGains,
        farthest_m: &[f64],
        least: LeastStrengths,
    ) -> Option<Self> {
        if farthest_m.is_empty() {
            return None;
        }
        let reach_m = reach_of_m(log, farthest_m.iter().copied());
        let heights = SoughtHeights::of_log(log.stops(), settings.z_range_m, reach_m, settings.grid_step_m)?;
        let mut places = vec![None; 256];
        for (at, &id) in gains.identities().iter().enumerate() {
            places[usize::from(id)] = Some(at);
        }
        let is_level =
            |stop: &Stop| heights.low_m >= heights.high_m && (stop.position.z_m - heights.low_m).abs() < LEVEL_M;
        let is_planar = log.stops().iter().all(is_level);
        let directions = if is_planar { Directions::Horizon } else { Directions::Sphere };
        let link_db = least.link_db.or(least.sector_db);
        let least_db = least.sector_db.or(link_db).unwrap_or(0.0);
        Some(Self {
            map: GainMap::new(gains, directions),
            columns: SectorColumns { places, count: gains.identities().len(), least_db },
            reach_m,
            is_reach_known: known_reach_m(farthest_m.iter().copied()).is_some(),
            heights,
            least_link_db: link_db.unwrap_or(0.0),
            surveyed: SurveyedArea::of(log, reach_m),
            ways: None,
            limits: Limits::new(log, reach_m, heights),
            wider_m: if link_db.is_some() { WIDER * reach_m } else { 0.0 },
        })
    }

    /// The same among known obstacles, if any are known, for the stops of `log`.
    pub(super) fn among(self, known: Option<KnownObstacles<'_>>, log: &ReceptionLog) -> Self {
        let Some(known) = known else { return self };
        let stops = log.stops().iter().map(|stop| stop.position).collect();
        let reach_m = self.reach_m + self.wider_m;
        let heights = [self.heights.low_m, self.heights.high_m];
        let ways = Some(KnownWays::new(&known, stops, reach_m, heights));
        Self { map: self.map.with_powers(), ways, ..self }
    }

    /// The box of each node.
    pub(super) fn boxes(&self, heard: &[HeardNode]) -> Vec<(NodeId, SearchBox)> {
        heard.iter().map(|heard| (heard.node, self.limits.of(heard).widened(self.wider_m))).collect()
    }
}
