//! What a robot does in a slot of its survey: it listens, and in networks with sector sweeps it sweeps.

mod tally;

use sextant_channel::Reception;

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

    pub(super) fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        self.sweep(usize::from(timer.0 - FIRST_SWEEP), port);
    }

    pub(super) fn delivered(&mut self, delivery: &Delivery<'_>, port: &Port<'_>) {
        // Where it sweeps, it counts the answers.
        if port.has_sectors(delivery.network) {
            return;
        }
        if let (Some(node), Some(number)) = (port.node(delivery.from), self.number(delivery.network)) {
            self.networks[number].tally.note(node, delivery.sequence, delivery.rssi);
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
