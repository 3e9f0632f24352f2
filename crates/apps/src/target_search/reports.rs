//! What a sink makes of the detections of a target that it doubts.

use std::collections::BTreeMap;
use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{SimTime, StationId};

use super::doubt::CONFIRMING;
use super::message::FirstDetection;

/// How long a report is kept.
const MEMORY: Duration = Duration::from_secs(5);
/// How long a sink waits for enough nodes before it tells the largest group that there is.
pub(super) const GRACE: Duration = Duration::from_secs(5);
/// How long a confirmed alarm holds: nodes report again afterwards.
pub(super) const HOLDS: Duration = Duration::from_secs(10);

/// The latest reports of a target.
#[derive(Clone, Debug, Default)]
pub(super) struct Reports {
    latest: Vec<FirstDetection>,
    /// When the last alarm was confirmed.
    confirmed: Option<SimTime>,
    /// When the last alarm was, or the first report.
    told: Option<SimTime>,
}

/// Nodes that detected a target together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sighted {
    /// When the first one did.
    pub(super) time: SimTime,
    /// Mean of their places on the map (m).
    pub(super) place: Position,
    pub(super) nodes: u8,
}

impl Reports {
    /// Adds a report. Returns what to tell all, if `confirming` nodes within `reach_m` of each other agree now, and no
    /// alarm holds.
    pub(super) fn add(
        &mut self,
        report: FirstDetection,
        confirming: u8,
        reach_m: f64,
        now: SimTime,
    ) -> Option<Sighted> {
        self.latest.retain(|other| now.saturating_since(other.time) <= MEMORY);
        self.latest.push(report);
        self.told.get_or_insert(now);
        let holds = self.confirmed.is_some_and(|confirmed| now.saturating_since(confirmed) < HOLDS);
        let sighted = self.around(&report, reach_m);
        (sighted.nodes >= confirming && !holds).then(|| {
            (self.confirmed, self.told) = (Some(now), Some(now));
            sighted
        })
    }

    /// What to tell all if no alarm was confirmed for a while: the largest group of nodes.
    pub(super) fn best_so_far(&mut self, reach_m: f64, now: SimTime) -> Option<Sighted> {
        self.latest.retain(|other| now.saturating_since(other.time) <= MEMORY);
        if self.told.is_none_or(|told| now.saturating_since(told) < GRACE) {
            return None;
        }
        let groups = self.latest.iter().map(|report| self.around(report, reach_m));
        let best = groups.max_by(|a, b| a.nodes.cmp(&b.nodes).then(a.time.cmp(&b.time)))?;
        self.told = Some(now);
        Some(best)
    }

    /// The nodes that detected the target with a report.
    fn around(&self, report: &FirstDetection, reach_m: f64) -> Sighted {
        let apart = |other: &FirstDetection| {
            other.time.saturating_since(report.time).max(report.time.saturating_since(other.time))
        };
        let is_near =
            |other: &&FirstDetection| apart(other) <= CONFIRMING && other.place.distance_m(report.place) <= reach_m;
        let group: Vec<&FirstDetection> = self.latest.iter().filter(is_near).collect();
        let places: BTreeMap<StationId, Position> = group.iter().map(|other| (other.node, other.place)).collect();
        let sum = places.values().fold(Position::ORIGIN, |sum, &place| sum + place);
        Sighted {
            time: group.iter().map(|other| other.time).min().unwrap_or(report.time),
            place: sum * (1.0 / places.len() as f64),
            nodes: u8::try_from(places.len()).unwrap_or(u8::MAX),
        }
    }
}

#[cfg(test)]
mod tests {
    use sextant_sim::TargetId;

    use super::*;

    fn at(seconds: f64) -> SimTime {
        SimTime::ZERO + Duration::from_secs_f64(seconds)
    }

    fn report(node: u32, x_m: f64, seconds: f64) -> FirstDetection {
        let place = Position::new(x_m, 0.0, 0.0);
        FirstDetection { node: StationId(node), target: TargetId(0), time: at(seconds), place }
    }

    #[test]
    fn lone_reports_far_apart_confirm_nothing_and_enough_near_ones_do() {
        let mut reports = Reports::default();
        let mut add = |node, x_m, seconds| reports.add(report(node, x_m, seconds), 3, 3.0, at(seconds + 0.1));
        assert_eq!(add(1, 50.0, 0.0), None);
        assert_eq!(add(2, 1.0, 0.2), None);
        assert_eq!(add(2, 1.0, 0.3), None, "the same node counts once");
        assert_eq!(add(3, 2.0, 0.4), None);
        assert_eq!(add(4, 3.0, 1.2), Some(Sighted { time: at(0.2), place: Position::new(2.0, 0.0, 0.0), nodes: 3 }));
        // It holds for ten seconds.
        assert!([5, 6, 7, 8].iter().all(|&node| add(node, 3.0, 9.0).is_none()));
        assert_eq!(add(9, 3.0, 11.5), None, "the others are too old");
        assert_eq!(
            [add(10, 3.0, 11.6), add(11, 3.0, 11.7)].map(|sighted| sighted.map(|of| of.nodes)),
            [None, Some(3)]
        );
    }

    #[test]
    fn the_largest_group_is_told_if_none_is_confirmed_in_time() {
        let mut reports = Reports::default();
        assert_eq!(reports.best_so_far(3.0, at(9.0)), None);
        for (node, x_m, seconds) in [(1, 50.0, 2.0), (2, 1.0, 3.0), (3, 2.0, 3.5), (4, 70.0, 4.0)] {
            assert_eq!(reports.add(report(node, x_m, seconds), 5, 3.0, at(seconds)), None);
        }
        assert_eq!(reports.best_so_far(3.0, at(6.9)), None, "too early");
        let best = reports.best_so_far(3.0, at(7.0)).expect("a group");
        assert_eq!((best.nodes, best.place), (2, Position::new(1.5, 0.0, 0.0)));
        assert_eq!(reports.best_so_far(3.0, at(7.5)), None, "once in a while");
        assert_eq!(reports.best_so_far(3.0, at(20.0)), None, "nothing was reported since");
    }
}
