//! The signal-to-noise ratios of all sectors of a sweep.

use sextant_kernel::NodeId;

use super::{LogError, ReceptionLog};
use crate::antenna::sector_table::SectorTable;

/// Signal-to-noise ratio of one sector of a listener, as a node measured it in a sector sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectorSnr {
    /// Identity of the sector.
    pub sector: u8,
    /// Signal-to-noise ratio at the node (dB).
    pub snr_db: f32,
}

/// What a node reported of one sector of the listener at a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectorReport {
    /// The node that reported it.
    pub node: NodeId,
    /// Index of the stop.
    pub stop: u32,
    /// Identity of the sector.
    pub sector: u8,
    /// Signal-to-noise ratio at the node (dB). A log keeps it in single precision: reports are rounded to a quarter of a
    /// decibel or coarser.
    pub snr_db: f64,
}

impl SectorReport {
    /// The mean of all reports of the same sector by the same node at the same stop (dB), in the order of nodes, stops and
    /// sectors: of sweeps that were repeated at a stop.
    #[must_use]
    pub fn averaged(mut reports: Vec<Self>) -> Vec<Self> {
        let key = |report: &Self| (report.node, report.stop, report.sector);
        reports.sort_by_key(key);
        let of_sector = |same: &[Self]| {
            let sum_db: f64 = same.iter().map(|report| report.snr_db).sum();
            Self { snr_db: sum_db / same.len() as f64, ..same[0] }
        };
        reports.chunk_by(|one, other| key(one) == key(other)).map(of_sector).collect()
    }
}

/// The reports of all nodes: a sorted list of pairs of node and stop, each with a range of sectors.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct SectorSnrs {
    /// Pairs with a report, ascending, each with the place where its sectors begin.
    pairs: Vec<(NodeId, u32, usize)>,
    /// By pair, then by sector.
    snrs: Vec<SectorSnr>,
}

impl SectorSnrs {
    /// The reports of receptions of `log`, in any order.
    pub(super) fn new(log: &ReceptionLog, mut reports: Vec<SectorReport>) -> Result<Self, LogError> {
        reports.sort_by_key(|report| (report.node, report.stop, report.sector));
        let mut all = Self { snrs: Vec::with_capacity(reports.len()), ..Self::default() };
        let mut last = None;
        for &SectorReport { node, stop, sector, snr_db } in &reports {
            if last != Some((node, stop)) {
                check_heard(log, node, stop)?;
                all.pairs.push((node, stop, all.snrs.len()));
            } else if all.snrs.last().is_some_and(|before| before.sector == sector) {
                return Err(LogError::SectorTwice { node: log.names()[node.index()].clone(), stop, sector });
            }
            last = Some((node, stop));
            #[expect(clippy::cast_possible_truncation, reason = "single precision is finer than any report")]
            let ratio = snr_db as f32;
            if !ratio.is_finite() {
                let node = log.names()[node.index()].clone();
                return Err(LogError::SnrNotFinite { node, stop, sector, snr_db });
            }
            all.snrs.push(SectorSnr { sector, snr_db: ratio });
        }
        all.pairs.shrink_to_fit();
        Ok(all)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// The sectors that a node reported at a stop, ascending.
    pub(super) fn of(&self, node: NodeId, stop: u32) -> &[SectorSnr] {
        let place = self.pairs.binary_search_by_key(&(node, stop), |&(node, stop, _)| (node, stop));
        place.map_or(&[], |pair| self.of_pair(pair))
    }

    fn of_pair(&self, pair: usize) -> &[SectorSnr] {
        let end = self.pairs.get(pair + 1).map_or(self.snrs.len(), |&(_, _, start)| start);
        &self.snrs[self.pairs[pair].2..end]
    }

    /// All reports, by node, stop and sector.
    pub(super) fn reports(&self) -> impl Iterator<Item = SectorReport> {
        self.pairs.iter().enumerate().flat_map(|(pair, &(node, stop, _))| {
            let report = move |&SectorSnr { sector, snr_db }: &SectorSnr| SectorReport {
                node,
                stop,
                sector,
                snr_db: f64::from(snr_db),
            };
            self.of_pair(pair).iter().map(report)
        })
    }

    /// Whether every sector is among `sectors`.
    pub(super) fn check_sectors(&self, names: &[String], sectors: &SectorTable) -> Result<(), LogError> {
        match self.reports().find(|report| !sectors.contains(report.sector)) {
            None => Ok(()),
            Some(SectorReport { node, stop, sector, .. }) => {
                let node = names[node.index()].clone();
                Err(LogError::UnknownSector { node, stop, sector, known: sectors.identities() })
            }
        }
    }
}

/// Whether a packet of `node` was received at `stop`.
fn check_heard(log: &ReceptionLog, node: NodeId, stop: u32) -> Result<(), LogError> {
    let nodes = log.node_count();
    let name = log.names().get(node.index()).ok_or(LogError::UnknownNode { node: node.0, nodes })?;
    if stop as usize >= log.stops().len() {
        return Err(LogError::UnknownStop { node: name.clone(), stop, stops: log.stops().len() });
    }
    if log.at(node, stop).is_some_and(|reception| reception.received > 0) {
        Ok(())
    } else {
        Err(LogError::NotHeard { node: name.clone(), stop })
    }
}

#[cfg(test)]
mod tests {
    use sextant_kernel::SimTime;

    use super::*;
    use crate::antenna::sector::EvenSectorsConfig;
    use crate::geometry::position::Position;
    use crate::reception::builder::ReceptionLogBuilder;
    use crate::reception::{Reception, Stop};

    fn stops(nanos: &[u64]) -> Vec<Stop> {
        let stop = |&nanos| Stop { time: SimTime::from_nanos(nanos), ..Stop::at(Position::ORIGIN) };
        nanos.iter().map(stop).collect()
    }

    fn heard(node: u32, stop: u32, received: u32) -> Reception {
        Reception { sector: Some(1), ..Reception::heard(NodeId(node), stop, received, 2) }
    }

    fn report(node: u32, stop: u32, sector: u8) -> SectorReport {
        let snr_db = f64::from(100 * node + 10 * stop) + f64::from(sector) / 4.0;
        SectorReport { node: NodeId(node), stop, sector, snr_db }
    }

    /// Two nodes; the first one was heard at all of three stops, the second at the last only.
    fn log() -> ReceptionLog {
        let receptions = vec![heard(0, 0, 2), heard(0, 1, 1), heard(0, 2, 1), heard(1, 0, 0), heard(1, 2, 2)];
        ReceptionLog::new(vec!["a".into(), "b".into()], stops(&[1, 2, 3]), receptions, Vec::new()).unwrap()
    }

    fn reports() -> Vec<SectorReport> {
        vec![report(1, 2, 3), report(0, 1, 7), report(0, 0, 2), report(0, 1, 0), report(1, 2, 1), report(0, 1, 4)]
    }

    fn table(azimuth_sectors: u8) -> SectorTable {
        let config =
            EvenSectorsConfig { azimuth_sectors, first_azimuth_deg: 0.0, elevations_deg: vec![[-90.0, 90.0]] };
        config.try_into().unwrap()
    }

    #[test]
    fn reports_in_any_order_are_found_by_node_and_stop() {
        assert!(!log().has_sector_snrs());
        let log = log().with_sector_snrs(reports()).unwrap();
        assert!(log.has_sector_snrs());
        let pair = |node, stop| log.sector_snrs(NodeId(node), stop).to_vec();
        let snr = |sector, snr_db| SectorSnr { sector, snr_db };
        assert_eq!(pair(0, 0), [snr(2, 0.5)]);
        assert_eq!(pair(0, 1), [snr(0, 10.0), snr(4, 11.0), snr(7, 11.75)]);
        assert_eq!(pair(1, 2), [snr(1, 120.25), snr(3, 120.75)]);
        for (node, stop) in [(0, 2), (1, 0), (1, 1), (1, 9), (9, 0)] {
            assert!(pair(node, stop).is_empty(), "{node} {stop}");
        }
        let mut sorted = reports();
        sorted.sort_by_key(|report| (report.node, report.stop, report.sector));
        assert_eq!(log.sector_reports().collect::<Vec<_>>(), sorted);
    }

    #[test]
    fn reports_pass_to_every_log_that_is_made_of_a_log() {
        let log = log().with_sector_snrs(reports()).unwrap().with_sectors(table(8)).unwrap();
        let all = |log: &ReceptionLog| log.sector_reports().collect::<Vec<_>>();
        assert_eq!(all(&log.at_least_one()), all(&log));
        assert_eq!(all(&log.clone().with_names(vec!["x".into(), "y".into()])), all(&log));
        let cut = log.until(SimTime::from_nanos(3));
        assert_eq!(all(&cut), [report(0, 0, 2), report(0, 1, 0), report(0, 1, 4), report(0, 1, 7)]);
        let mut of_second = ReceptionLogBuilder::default();
        of_second.push(heard(0, 2, 2));
        of_second.report(report(0, 2, 5));
        assert_eq!(all(&log.part(vec!["b".into()], of_second).unwrap()), [report(0, 2, 5)]);
        let mut early = ReceptionLogBuilder::default();
        early.extend(log.receptions());
        reports().into_iter().for_each(|report| early.report(report));
        early.forget_from(1);
        let early = early.build(log.names().to_vec(), log.stops().to_vec(), Vec::new()).unwrap();
        assert_eq!(all(&early), [report(0, 0, 2)]);
    }

    #[test]
    fn repeated_reports_are_averaged() {
        let again = |snr_db, report: SectorReport| SectorReport { snr_db, ..report };
        let (one, other) = (report(0, 1, 7), report(0, 2, 0));
        let averaged = SectorReport::averaged(vec![again(3.0, one), other, again(5.5, one), again(-1.0, one)]);
        assert_eq!(averaged, [again(2.5, one), other]);
    }

    #[test]
    fn impossible_reports_are_rejected() {
        let with = |report| log().with_sector_snrs(vec![report]).unwrap_err();
        assert_eq!(with(report(2, 0, 0)), LogError::UnknownNode { node: 2, nodes: 2 });
        assert_eq!(with(report(0, 3, 0)), LogError::UnknownStop { node: "a".into(), stop: 3, stops: 3 });
        for stop in [0, 1] {
            assert_eq!(with(report(1, stop, 0)), LogError::NotHeard { node: "b".into(), stop });
        }
        for snr_db in [f64::NAN, f64::NEG_INFINITY, 1e300] {
            let found = with(SectorReport { snr_db, ..report(0, 1, 4) });
            assert!(matches!(found, LogError::SnrNotFinite { stop: 1, sector: 4, .. }), "{found}");
        }
        let twice = log().with_sector_snrs(vec![report(0, 1, 4), report(0, 0, 4), report(0, 1, 4)]);
        assert_eq!(twice, Err(LogError::SectorTwice { node: "a".into(), stop: 1, sector: 4 }));
        let unknown = LogError::UnknownSector { node: "a".into(), stop: 1, sector: 7, known: "0 to 6".into() };
        let late = log().with_sector_snrs(reports()).unwrap().with_sectors(table(7));
        let early = log().with_sectors(table(7)).unwrap().with_sector_snrs(reports());
        assert_eq!((late, early), (Err(unknown.clone()), Err(unknown)));
    }
}
