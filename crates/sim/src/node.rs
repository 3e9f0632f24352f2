//! The nodes: each has a MAC, a radio and frames to send.

use std::time::Duration;

use sextant_channel::{Milliwatts, Position};
use sextant_kernel::{EventKey, EventQueue, NodeId, Seed, SimTime};
use sextant_mac::{EnergyMeter, Phy, RadioState, csma, device};

use crate::FrameOutcome;
use crate::air::{Air, Transmission};
use crate::event::Event;
use crate::purpose;

/// A node, apart from its MAC.
pub(crate) struct Node {
    pub(crate) position: Position,
    pub(crate) meter: EnergyMeter,
    /// Number of frames that its application has given to the MAC so far.
    pub(crate) frames: u64,
    /// Sequence number of the frame under way.
    pub(crate) sequence: u8,
    /// The transmission on air.
    pub(crate) transmission: Option<Transmission>,
    /// The best outcome so far of the frame under way.
    pub(crate) outcome: FrameOutcome,
    timer: Option<EventKey>,
    /// The pending event of following beacons.
    tracking: Option<EventKey>,
    backoffs: u64,
}

impl Node {
    pub(crate) fn new(position: Position, state: RadioState, sequence: u8) -> Self {
        Self {
            position,
            meter: EnergyMeter::new(state, SimTime::ZERO),
            frames: 0,
            sequence,
            transmission: None,
            outcome: FrameOutcome::NotListened,
            timer: None,
            tracking: None,
            backoffs: 0,
        }
    }
}

/// The state that the MACs of all nodes share.
pub(crate) struct Network {
    pub(crate) now: SimTime,
    pub(crate) queue: EventQueue<Event>,
    pub(crate) nodes: Vec<Node>,
    pub(crate) air: Air,
    pub(crate) phy: Phy,
    pub(crate) seed: Seed,
    pub(crate) cca_threshold: Milliwatts,
    /// Whether nodes can receive whenever their receiver is on; otherwise only while they wait for an
    /// acknowledgement.
    pub(crate) hears_always: bool,
    /// The acknowledgement that each robot has on air, with its sequence number.
    pub(crate) acknowledgements: Vec<Option<(Transmission, u8)>>,
    /// The beacon that is on air.
    pub(crate) beacon: Option<Transmission>,
}

impl Network {
    /// Schedules an event `span` from now.
    pub(crate) fn after(&mut self, span: Duration, event: Event) -> EventKey {
        let nodes = NodeId::from_index(self.nodes.len()).0;
        self.queue.push(self.now + span, event.rank(nodes), event)
    }

    /// The radio of `node`, as its MAC sees it; `awaits_ack` is true from the end of a frame to its acknowledgement.
    pub(crate) fn radio(&mut self, node: NodeId, awaits_ack: bool) -> NodeRadio<'_> {
        NodeRadio { network: self, node, awaits_ack }
    }

    /// Whether `node` finds the channel busy in the window that ends now.
    pub(crate) fn senses_busy(&mut self, node: NodeId) -> bool {
        let place = self.nodes[node.index()].position;
        let from = self.now.saturating_sub(self.phy.cca());
        self.air.is_busy(node, place, from, self.now, self.cca_threshold)
    }
}

/// The radio of one node, as its MAC sees it.
pub(crate) struct NodeRadio<'a> {
    network: &'a mut Network,
    node: NodeId,
    awaits_ack: bool,
}

impl NodeRadio<'_> {
    fn state(&mut self) -> &mut Node {
        &mut self.network.nodes[self.node.index()]
    }
}

impl csma::Radio for NodeRadio<'_> {
    fn backoff_periods(&mut self, max_inclusive: u32) -> u32 {
        let (seed, node) = (self.network.seed, self.node);
        let drawn = &mut self.state().backoffs;
        *drawn += 1;
        let bits = seed.bits(purpose::BACKOFF, [node.0.into(), *drawn, 0]);
        // The upper 32 bits scaled to the range: exact for 2^BE equally likely numbers.
        u32::try_from(((bits >> 32) * (u64::from(max_inclusive) + 1)) >> 32).expect("below 2^32")
    }

    fn after(&mut self, span: Duration, event: csma::Event) {
        let key = self.network.after(span, Event::Mac(self.node, event));
        self.state().timer = Some(key);
    }

    fn cancel_timer(&mut self) {
        if let Some(key) = self.state().timer.take() {
            self.network.queue.cancel(key);
        }
    }

    fn enter(&mut self, state: RadioState) {
        let (now, node, awaits_ack) = (self.network.now, self.node, self.awaits_ack);
        let place = self.state().position;
        self.state().meter.enter(state, now);
        // A node whose receiver is off at rest hears frames only while it waits for an acknowledgement: carrier sense
        // is too short for a whole frame.
        let listens = state == RadioState::Receive && (awaits_ack || self.network.hears_always);
        if listens {
            self.network.air.listen(now, node, place);
        } else {
            self.network.air.deafen(node, place);
        }
    }

    fn start_cca(&mut self) {
        let cca = self.network.phy.cca();
        self.network.after(cca, Event::CcaEnded(self.node));
    }

    fn start_transmission(&mut self, frame: csma::OutgoingFrame) {
        let (now, node) = (self.network.now, self.node);
        let airtime = self.network.phy.airtime(frame.mpdu_octets);
        let place = self.state().position;
        let transmission = self.network.air.begin(now, node, place, airtime);
        self.state().transmission = Some(transmission);
        self.network.after(airtime, Event::Mac(node, csma::Event::TransmissionEnded));
    }
}

impl device::Radio for NodeRadio<'_> {
    fn track_after(&mut self, span: Duration, event: device::Event) {
        let key = self.network.after(span, Event::Tracking(self.node, event));
        self.state().tracking = Some(key);
    }

    fn cancel_tracking(&mut self) {
        if let Some(key) = self.state().tracking.take() {
            self.network.queue.cancel(key);
        }
    }
}
