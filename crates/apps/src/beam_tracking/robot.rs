//! A robot that drives along its way and keeps a link.

use std::sync::Arc;
use std::time::Duration;

use sextant_channel::Db;
use sextant_kernel::NodeId;
use sextant_mac::dmg::data::Mcs;
use sextant_mac::dmg::retraining::{Retraining, Training};
use sextant_sim::{Application, DriveEnd, Driving, NetworkId, Port, SectorPowers, Timer};

use super::link::{HeldLink, ideal_bits};
use super::prediction::{predict, sectors_towards};
use super::settings::BeamTracking;
use super::training::{Found, Search, search, try_near};
use crate::mission::LinkRecord;
use crate::navigation::NavigationMap;

/// The powers of a link are taken anew at least this often.
const STEP: Duration = Duration::from_millis(10);
/// A node that a training passed over is not predicted in so many of the next beacon intervals.
const AVOIDED_INTERVALS: u64 = 10;

const INTERVAL: Timer = Timer(0);
const DATA: Timer = Timer(1);

/// A robot that drives along its way and keeps a link.
#[derive(Debug)]
pub(super) struct BeamRobot {
    mission: Arc<BeamTracking>,
    map: Arc<NavigationMap>,
    network: NetworkId,
    nodes: usize,
    machine: Retraining,
    link: Option<HeldLink>,
    /// A node that was not the best although it is near, and the last beacon interval in which it is avoided.
    avoided: Option<(NodeId, u64)>,
    /// Beacon intervals so far.
    intervals: u64,
    /// Places of the way that were reached.
    reached: usize,
    /// Whether it drives no more: it is at the last place, or something is in its way.
    is_over: bool,
    /// Data time that is left of the beacon interval, and the length of its steps.
    left: Duration,
    step: Duration,
    /// Whether the last data was acknowledged, and at which ratio.
    heard: Option<Db>,
    record: LinkRecord,
}

impl BeamRobot {
    /// A robot among `nodes` nodes, of which it knows `map`.
    #[must_use]
    pub(super) fn new(mission: Arc<BeamTracking>, map: Arc<NavigationMap>, network: NetworkId, nodes: usize) -> Self {
        Self {
            machine: Retraining::new(mission.rule),
            mission,
            map,
            network,
            nodes,
            link: None,
            avoided: None,
            intervals: 0,
            reached: 0,
            is_over: false,
            left: Duration::ZERO,
            step: Duration::ZERO,
            heard: None,
            record: LinkRecord { robots: 1, ..LinkRecord::default() },
        }
    }

    /// What became of its links.
    #[must_use]
    pub(super) fn into_record(self) -> LinkRecord {
        self.record
    }

    /// Drives on to the next place that it is not at.
    fn go_on(&mut self, port: &mut Port<'_>) {
        while let Some(&place) = self.mission.way.get(self.reached) {
            match port.drive(place) {
                Driving::UnderWay => return,
                Driving::Over(DriveEnd::Arrived) => self.reached += 1,
                Driving::Over(DriveEnd::Blocked(_)) => {
                    self.is_over = true;
                    return;
                }
            }
        }
        self.is_over = true;
        self.record.arrived = 1;
        self.record.last_arrival = port.now();
    }

    /// The powers of the links to all nodes now.
    fn powers(&self, port: &mut Port<'_>) -> Vec<Option<SectorPowers>> {
        (0..self.nodes).map(|node| port.sector_powers(self.network, NodeId::from_index(node))).collect()
    }

    /// The ratio of a link now; `None` if the node is beyond the radius of communication.
    fn snr_of(&self, link: HeldLink, powers: &[Option<SectorPowers>]) -> Option<Db> {
        let powers = powers[link.node.index()].as_ref()?;
        Some(powers.pair(link.pair) - self.mission.noise)
    }

    /// A beacon interval begins: trains the beam if it is time for it.
    fn begin_interval(&mut self, port: &mut Port<'_>) {
        if self.intervals > 0 {
            self.machine.heard(self.heard);
        }
        self.intervals += 1;
        let (pose, intervals, avoided) = (port.pose(), self.intervals, self.avoided);
        let avoids = |node| is_avoided(avoided, node, intervals);
        let serving = self.link.map(|link| link.node);
        let prediction = predict(&self.mission, &self.map, pose, serving, avoids);
        let training = self.machine.begin(prediction);
        let powers = self.powers(port);
        match training {
            Training::Keep => {}
            Training::All => {
                let Search { found, collided } = search(&self.mission, &powers);
                self.record.searches += 1;
                self.record.collided += collided;
                let passed_over = prediction.map(|prediction| NodeId(prediction.node));
                let passed_over = passed_over.filter(|&node| found.is_some_and(|found| found.node != node));
                self.avoided = passed_over.map(|node| (node, intervals + AVOIDED_INTERVALS));
                self.take(found, training);
            }
            Training::Near(prediction) => {
                self.record.near_trainings += 1;
                let node = NodeId(prediction.node);
                let place = self.map.place(node).expect("a node is predicted where the map has it");
                let mut swept = sectors_towards(&self.mission, pose, place);
                swept.truncate(self.mission.near.into());
                let found = try_near(&self.mission, node, powers[node.index()].as_ref(), &swept);
                match self.link.and_then(|link| Some((link, self.snr_of(link, &powers)?))) {
                    // The link as it is, which data tells, is better than what was tried.
                    Some((link, snr)) if found.is_none_or(|found| found.power - self.mission.noise < snr) => {
                        if link.node != node {
                            self.avoided = Some((node, intervals + AVOIDED_INTERVALS));
                        }
                        self.machine.trained(training, Some(snr));
                    }
                    _ => self.take(found, training),
                }
            }
        }
        let spent = self.mission.training_time(training);
        self.record.time += spent;
        self.record.training += spent;
        self.account_ideal(&powers, spent);
        self.left = self.mission.interval - spent;
        let steps = self.left.as_nanos().div_ceil(STEP.as_nanos()).max(1);
        self.step = self.left / u32::try_from(steps).expect("few steps in a beacon interval");
        self.heard = None;
        port.after(spent, DATA);
    }

    /// The link is what a training found.
    fn take(&mut self, found: Option<Found>, training: Training) {
        let snr = found.map(|found| found.power - self.mission.noise);
        self.machine.trained(training, snr);
        let before = self.link.map(|link| link.node);
        self.link = found.zip(snr).map(|(Found { node, pair, .. }, snr)| HeldLink {
            node,
            pair,
            mcs: Mcs::fastest_at(snr).unwrap_or(Mcs::SLOWEST),
        });
        self.record.failed_trainings += u64::from(found.is_none());
        self.record.handovers += u64::from(before.zip(found).is_some_and(|(before, found)| before != found.node));
    }

    /// Sends data until the powers are taken anew.
    fn send_data(&mut self, port: &mut Port<'_>) {
        let span = if self.left < self.step * 2 { self.left } else { self.step };
        self.record.time += span;
        let powers = self.powers(port);
        let best = self.account_ideal(&powers, span);
        let snr = self.link.and_then(|link| self.snr_of(link, &powers));
        self.heard = None;
        let fastest = snr.and_then(Mcs::fastest_at);
        self.record.by_mcs[fastest.map_or(0, |mcs| usize::from(mcs.number()))] += span;
        if fastest.is_none() {
            self.record.outage += span;
        }
        if let (Some(link), Some(snr)) = (&mut self.link, snr) {
            let sent = link.send(snr, span);
            self.record.bits += sent.bits;
            self.record.frames += sent.frames;
            self.record.lost_frames += sent.lost;
            self.heard = sent.is_heard.then_some(snr);
            if fastest.is_some() {
                self.record.loss_db_s += (best - snr).0 * span.as_secs_f64();
                self.record.loss_s += span.as_secs_f64();
            }
        }
        self.left -= span;
        port.after(span, if self.left.is_zero() { INTERVAL } else { DATA });
    }

    /// Counts what the best pair of sectors brings in `span`. Returns its ratio.
    fn account_ideal(&mut self, powers: &[Option<SectorPowers>], span: Duration) -> Db {
        let ratios = powers.iter().flatten().map(|powers| powers.best() - self.mission.noise);
        let best = ratios.fold(Db(f64::NEG_INFINITY), |best, snr| if snr.0 > best.0 { snr } else { best });
        self.record.ideal_bits += ideal_bits(best, span);
        if Mcs::fastest_at(best).is_none() {
            self.record.ideal_outage += span;
        }
        best
    }
}

/// Whether `node` is avoided in this beacon interval.
fn is_avoided(avoided: Option<(NodeId, u64)>, node: NodeId, interval: u64) -> bool {
    avoided.is_some_and(|(known, until)| known == node && interval <= until)
}

impl Application for BeamRobot {
    fn has_task(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        self.go_on(port);
        self.begin_interval(port);
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        if timer == DATA {
            self.send_data(port);
        } else if self.is_over {
            port.finish();
        } else {
            self.begin_interval(port);
        }
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        match end {
            DriveEnd::Arrived => {
                self.reached += 1;
                self.go_on(port);
            }
            DriveEnd::Blocked(_) => self.is_over = true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_is_avoided_in_ten_beacon_intervals_after_its_training() {
        let avoided = Some((NodeId(1), 3 + AVOIDED_INTERVALS));
        let intervals: Vec<u64> = (4..30).filter(|&interval| is_avoided(avoided, NodeId(1), interval)).collect();
        assert_eq!(intervals, (4..=13).collect::<Vec<_>>());
        assert!(!is_avoided(avoided, NodeId(2), 4) && !is_avoided(None, NodeId(1), 4));
    }
}
