//! What a robot does in a slot of its survey: it listens, and in networks with sector sweeps it sweeps.

mod tally;

use std::time::Duration;

use sextant_channel::{Position, RangeSample, RangingDevice, Reception};
use sextant_kernel::NodeId;

use super::controller::HeardNode;
use super::slot::Slot;
use crate::application::Port;
use crate::event::Timer;
use crate::service::delivery::Delivery;
use crate::service::network_id::NetworkId;
use crate::service::sweep::{SweepAnswer, SweepKind};
use crate::station::{OwnFrame, RobotBody};
use tally::Tally;

/// The timer of the next sweep in the first network; those of the others follow.
const FIRST_SWEEP: u16 = 1;
/// The timer of the next ranges without frames in the first network; those of the others follow.
const FIRST_RANGES: u16 = 1001;

/// What a robot does in a slot of its survey.
pub(super) struct Survey {
    /// What it does in each of its networks.
    networks: Vec<Surveyed>,
    /// Number of sector sweeps in a slot.
    sweeps: u32,
    /// The frame in which the stops are written.
    frame: OwnFrame,
}

/// What a robot does in one network.
struct Surveyed {
    network: NetworkId,
    tally: Tally,
    /// Sector sweeps that are still to be made in the slot, the one under way included.
    sweeps_left: u32,
    /// Whether the time to listen is not over.
    is_listening: bool,
}

impl Survey {
    pub(super) fn new(body: &RobotBody, nodes: usize) -> Self {
        let surveyed = |&network| Surveyed { network, tally: Tally::new(nodes), sweeps_left: 0, is_listening: false };
        let networks = body.networks.iter().map(surveyed).collect();
        Self { networks, sweeps: body.sweeps_per_stop, frame: body.frame }
    }

    /// The slot begins.
    pub(super) fn begin(&mut self, slot: &Slot, port: &mut Port<'_>) {
        for number in 0..self.networks.len() {
            let surveyed = &mut self.networks[number];
            surveyed.is_listening = true;
            port.listen(surveyed.network, slot.span);
            if port.ranging(surveyed.network).is_some_and(|ranging| ranging.interval_s().is_some()) {
                self.measure_all(number, slot, port);
            }
            let surveyed = &mut self.networks[number];
            if port.has_sectors(surveyed.network) {
                surveyed.sweeps_left = self.sweeps;
                self.sweep(number, port);
            }
        }
    }

    /// Begins the next sweep in a network.
    fn sweep(&mut self, number: usize, port: &mut Port<'_>) {
        let surveyed = &mut self.networks[number];
        if port.sweep(surveyed.network, SweepKind::Gather).is_err() {
            // A robot answers no sweeps, and its last one is over.
            surveyed.sweeps_left = 0;
        }
    }

    pub(super) fn timed(&mut self, timer: Timer, slot: &Slot, port: &mut Port<'_>) {
        match timer.0.checked_sub(FIRST_RANGES) {
            Some(number) => self.measure_all(usize::from(number), slot, port),
            None => self.sweep(usize::from(timer.0 - FIRST_SWEEP), port),
        }
    }

    /// Measures the ranges to all nodes in a network without frames, and sets the timer of the next ones in the slot.
    fn measure_all(&mut self, number: usize, slot: &Slot, port: &mut Port<'_>) {
        let network = self.networks[number].network;
        let Some(interval_s) = port.ranging(network).and_then(RangingDevice::interval_s) else { return };
        for node in (0..port.node_count()).map(NodeId::from_index) {
            self.measure(number, node, port);
        }
        let interval = Duration::from_secs_f64(interval_s);
        if port.now() + interval < slot.since + slot.span {
            let number = u16::try_from(number).expect("at most 256 networks");
            port.after(interval, Timer(FIRST_RANGES + number));
        }
    }

    /// Measures the range to a node that was heard in a network, if packets bring ranges there.
    fn measure_by_packet(&mut self, number: usize, node: NodeId, port: &Port<'_>) {
        if port.ranging(self.networks[number].network).is_some_and(|ranging| ranging.interval_s().is_none()) {
            self.measure(number, node, port);
        }
    }

    fn measure(&mut self, number: usize, node: NodeId, port: &Port<'_>) {
        let surveyed = &mut self.networks[number];
        let Some(sample) = port.measure_range(surveyed.network, node) else { return };
        let position = self.frame.of_world(sample.position);
        let velocity = self.frame.of_world(sample.velocity) - self.frame.of_world(Position::ORIGIN);
        surveyed.tally.note_range(RangeSample { position, velocity, ..sample });
    }

    pub(super) fn delivered(&mut self, delivery: &Delivery<'_>, port: &Port<'_>) {
        // Where it sweeps, it counts the answers.
        if port.has_sectors(delivery.network) {
            return;
        }
        if let (Some(node), Some(number)) = (port.node(delivery.from), self.number(delivery.network)) {
            self.networks[number].tally.note(node, delivery.sequence, delivery.rssi);
            self.measure_by_packet(number, node, port);
        }
    }

    /// The time to listen in a network is over.
    pub(super) fn listened(&mut self, network: NetworkId) {
        if let Some(number) = self.number(network) {
            self.networks[number].is_listening = false;
        }
    }

    /// A sweep in a network is over: the next one begins when it is due, in equal intervals.
    pub(super) fn swept(&mut self, network: NetworkId, answers: &[SweepAnswer], slot: &Slot, port: &mut Port<'_>) {
        let Some(number) = self.number(network) else { return };
        let surveyed = &mut self.networks[number];
        let of_nodes = answers.iter().filter_map(|answer| Some((port.node(answer.from)?, answer)));
        surveyed.tally.note_sweep(of_nodes);
        for answer in answers {
            if let Some(node) = port.node(answer.from) {
                self.measure_by_packet(number, node, port);
            }
        }
        let surveyed = &mut self.networks[number];
        surveyed.sweeps_left = surveyed.sweeps_left.saturating_sub(1);
        if surveyed.sweeps_left > 0 {
            let due = slot.due(self.sweeps - surveyed.sweeps_left, self.sweeps);
            let number = u16::try_from(number).expect("at most 256 networks");
            port.after(due.saturating_since(port.now()), Timer(FIRST_SWEEP + number));
        }
    }

    /// Whether nothing is under way in any network.
    pub(super) fn is_over(&self) -> bool {
        self.networks.iter().all(|surveyed| !surveyed.is_listening && surveyed.sweeps_left == 0)
    }

    /// The slot is over: writes the stop. Returns what was heard, by node.
    pub(super) fn end(&mut self, slot: &Slot, port: &mut Port<'_>) -> Vec<HeardNode> {
        let mut heard: Vec<HeardNode> = Vec::new();
        for surveyed in &mut self.networks {
            let log = surveyed.tally.take();
            heard.extend(log.receptions.iter().map(heard_of));
            port.log_stop(surveyed.network, slot.since, self.frame.of_world(slot.place), log);
        }
        if self.networks.len() > 1 {
            heard.sort_by_key(|heard| heard.node);
            heard.dedup_by(|later, earlier| later.node == earlier.node && earlier.add(later));
        }
        heard
    }

    /// The number of a network among those that the robot surveys.
    fn number(&self, network: NetworkId) -> Option<usize> {
        self.networks.iter().position(|surveyed| surveyed.network == network)
    }

    /// Number of packets of each node, in all networks.
    pub(super) fn into_packets(self) -> Vec<u32> {
        let totals = self.networks.into_iter().map(|surveyed| surveyed.tally.total);
        let sum = |mut sum: Vec<u32>, total: Vec<u32>| {
            sum.iter_mut().zip(total).for_each(|(sum, packets)| *sum += packets);
            sum
        };
        totals.reduce(sum).unwrap_or_default()
    }
}

fn heard_of(reception: &Reception) -> HeardNode {
    let &Reception { node, received, sent, rssi_dbm, .. } = reception;
    HeardNode { node, packets: received, sent, rssi_dbm: rssi_dbm.unwrap_or(f64::NAN) }
}
