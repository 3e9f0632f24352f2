//! A log without some of its stops.

use sextant_channel::{Position, Reception, ReceptionLog, SectorReport, Stop};
use sextant_kernel::NodeId;

use crate::numerics::halves::halve;

/// At most so many nodes are mapped without a fold, in the plane and in space.
const NODES: [usize; 2] = [32, 14];
/// Number of folds, and of blocks of neighbouring stops that each has.
const FOLDS: usize = 2;
const BLOCKS: usize = 6;
/// Fewer stops than this cannot be cut into folds.
const LEAST_STOPS: usize = 8;

/// A log of some of the nodes, and the fold of each of its stops.
#[derive(Debug)]
pub(super) struct Folds {
    log: ReceptionLog,
    fold_of: Vec<usize>,
}

/// The stops of one fold.
#[derive(Debug)]
pub(super) struct Fold<'a> {
    all: &'a ReceptionLog,
    fold_of: &'a [usize],
    number: usize,
    /// The log without them.
    pub(super) rest: ReceptionLog,
}

/// A pair of node and stop.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeAndStop {
    pub(super) stop: Stop,
    pub(super) received: u32,
    pub(super) sent: u32,
    /// Mean strength of the packets received (dBm), if it was measured.
    pub(super) rssi_dbm: Option<f64>,
}

impl Folds {
    /// The folds of `log`, whose nodes are in a plane or in space; `None` if it has too few stops or nodes.
    pub(super) fn of(log: &ReceptionLog, is_spatial: bool) -> Option<Self> {
        let is_heard = |node: &NodeId| log.of(*node).iter().any(|reception| reception.received > 0);
        let heard: Vec<NodeId> = (0..log.node_count()).map(NodeId::from_index).filter(is_heard).collect();
        if heard.len() < 2 || log.stops().len() < LEAST_STOPS {
            return None;
        }
        let nodes: Vec<NodeId> =
            heard.iter().copied().step_by(heard.len().div_ceil(NODES[usize::from(is_spatial)])).collect();
        let names = nodes.iter().map(|node| log.names()[node.index()].clone()).collect();
        let receptions = nodes.iter().enumerate().flat_map(|(number, &node)| {
            log.of(node).iter().map(move |reception| Reception { node: NodeId::from_index(number), ..reception })
        });
        let reports = log.sector_reports().filter_map(|report| {
            let number = nodes.binary_search(&report.node).ok()?;
            Some(SectorReport { node: NodeId::from_index(number), ..report })
        });
        let places: Vec<Position> = log.stops().iter().map(|stop| stop.position).collect();
        let log = part(log, names, receptions.collect(), reports.collect());
        Some(Self { fold_of: folds(&places), log })
    }

    pub(super) fn nodes(&self) -> usize {
        self.log.node_count()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = Fold<'_>> {
        (0..FOLDS).map(|number| Fold { all: &self.log, fold_of: &self.fold_of, number, rest: self.without(number) })
    }

    /// The log as if no node could have been heard at the stops of a fold. The stops themselves stay, because the robot's way
    /// tells where there is no obstacle.
    fn without(&self, fold: usize) -> ReceptionLog {
        let is_left_out = |stop: u32| self.fold_of[stop as usize] == fold;
        let kept = self.log.receptions().iter().filter(|reception| !is_left_out(reception.stop));
        let left_out = (0..).zip(&self.fold_of).filter(|&(_, &of)| of == fold).flat_map(|(stop, _)| {
            (0..self.log.node_count()).map(NodeId::from_index).map(move |node| Reception {
                node,
                stop,
                received: 0,
                sent: 0,
                sector: None,
                rssi_dbm: None,
                snr_db: None,
            })
        });
        let reports = self.log.sector_reports().filter(|report| !is_left_out(report.stop));
        part(&self.log, self.log.names().to_vec(), kept.chain(left_out).collect(), reports.collect())
    }
}

impl Fold<'_> {
    /// The pairs of `node` and the stops of the fold, without those that were not tried.
    pub(super) fn pairs(&self, node: usize) -> impl Iterator<Item = NodeAndStop> {
        self.pairs_at(node, true)
    }

    /// The pairs of `node` and the other stops, without those that were not tried.
    pub(super) fn others(&self, node: usize) -> impl Iterator<Item = NodeAndStop> {
        self.pairs_at(node, false)
    }

    fn pairs_at(&self, node: usize, is_left_out: bool) -> impl Iterator<Item = NodeAndStop> {
        let mut heard = self.all.of(NodeId::from_index(node)).iter().peekable();
        let stops = self.all.stops().iter().zip(self.fold_of).enumerate();
        let pairs: Vec<NodeAndStop> = stops
            .filter_map(|(number, (stop, &of))| {
                let listed = heard.next_if(|reception| reception.stop as usize == number);
                let (received, sent) = listed.map_or((0, 1), |reception| (reception.received, reception.sent));
                let rssi_dbm = listed.and_then(|reception| reception.rssi_dbm).filter(|_| received > 0);
                let pair = NodeAndStop { stop: *stop, received, sent, rssi_dbm };
                ((of == self.number) == is_left_out && sent > 0).then_some(pair)
            })
            .collect();
        pairs.into_iter()
    }

    /// Share of the packets that arrived at the other stops.
    pub(super) fn usual_share(&self) -> f64 {
        let counts = self.rest.receptions().iter().map(|reception| (reception.received, reception.sent));
        let (received, sent) = counts
            .fold((0.0, 0.0), |(received, sent), (more, of)| (received + f64::from(more), sent + f64::from(of)));
        let listed = self.rest.receptions().iter().count() as f64;
        let absent = (self.rest.node_count() as f64 * self.rest.stops().len() as f64 - listed).max(0.0);
        (received + 0.5) / (sent + absent + 1.0)
    }
}

/// A log of parts of `log`, with its stops, contacts, robots and sectors.
fn part(
    log: &ReceptionLog,
    names: Vec<String>,
    receptions: Vec<Reception>,
    reports: Vec<SectorReport>,
) -> ReceptionLog {
    let part = ReceptionLog::new(names, log.stops().to_vec(), receptions, log.contacts().to_vec())
        .and_then(|part| part.with_sector_snrs(reports))
        .and_then(|part| part.with_robots(log.robots().to_vec()))
        .and_then(|part| match log.sectors() {
            Some(sectors) => part.with_sectors(sectors.clone()),
            None => Ok(part),
        });
    part.unwrap_or_else(|error| unreachable!("a part of a log is a log: {error}"))
}

/// The fold of each place. Blocks of neighbours are dealt out in turn.
fn folds(places: &[Position]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..places.len()).collect();
    halve(&mut order, places);
    let mut fold_of = vec![0; places.len()];
    for (rank, &place) in order.iter().enumerate() {
        fold_of[place] = rank * FOLDS * BLOCKS / places.len() % FOLDS;
    }
    fold_of
}
