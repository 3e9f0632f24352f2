//! A network of IEEE 802.15.4: the links of all its stations.

mod acknowledging;
mod beacons;
mod dying;
mod frames;
mod receiving;
mod sending;

use std::ops::Range;
use std::time::Duration;

use sextant_kernel::{EventKey, NodeId, SimTime, StationId};
use sextant_mac::coordinator::Coordinator;
use sextant_mac::frame::Address;
use sextant_mac::responder::Responder;
use sextant_mac::{EnergySpent, RadioState, RadioStates, csma};

use super::clock::Clock;
use super::frame_queue::QueuedFrame;
use super::mac::{Mac, NodeMac};
use super::radio::Radio;
use super::stack::Stack;
use super::transceiver::{Radios, Transceiver};
use crate::air::{Arrival, Transmission};
use crate::event::ieee802154::Event;
use crate::link::payloads::Payloads;
use crate::observer::{HeardFrame, Observer};
use crate::purpose;
use crate::scene::Scene;
use crate::service::delays::Delays;
use crate::service::network_id::NetworkId;
use crate::service::outcome::FrameOutcome;
use crate::service::packets::{NetworkRecord, Packets};
use crate::service::upcall::Upcall;
use crate::station::Kind;
use sending::data_frame;

/// PAN of the first network; the others follow.
const FIRST_PAN: u16 = 0x5E87;

/// What a network of IEEE 802.15.4 needs.
pub(crate) struct Settings<'a> {
    pub(crate) network: NetworkId,
    pub(crate) radio: &'a Radio,
    pub(crate) mac: &'a Mac,
    pub(crate) radio_states: RadioStates,
    /// Number of the air of its band.
    pub(crate) air: usize,
    /// Number of the first station's receiver there.
    pub(crate) first_receiver: u32,
    /// The state machine of the station that sends beacons, if one does.
    pub(crate) coordinator: Option<(StationId, Coordinator)>,
    /// Whether the time from offer to reception of each frame is kept.
    pub(crate) keeps_delays: bool,
    /// Whether each station is in the network; `None` if all are.
    pub(crate) members: Option<Vec<bool>>,
}

/// A network of IEEE 802.15.4: the links of all its stations.
pub(crate) struct Network {
    pan: u16,
    radios: Radios,
    macs: Vec<NodeMac>,
    stacks: Vec<Stack>,
    responders: Vec<Responder>,
    /// Whether the application of a station looks at what is delivered to it.
    hears: Vec<bool>,
    coordinator: Option<(StationId, Coordinator)>,
    /// The beacon that is on air.
    beacon: Option<Transmission>,
    queue_frames: usize,
    payloads: Payloads,
    packets: Vec<Packets>,
    /// By station, if there are sinks.
    delays: Vec<Delays>,
    /// Number of frames that were delivered to each station.
    deliveries: Vec<u64>,
    /// Packets that were offered before are not counted.
    counted_from: SimTime,
    members: Option<Vec<bool>>,
    radio_states: RadioStates,
    arrivals: Vec<Arrival>,
    told: Vec<HeardFrame>,
    mpdu: Vec<u8>,
    payload: Range<usize>,
}

/// PAN of a network.
pub(crate) fn pan(network: NetworkId) -> u16 {
    FIRST_PAN + u16::from(network.0)
}

/// The number before that of the first frame of a station.
pub(crate) fn first_sequence(scene_seed: sextant_kernel::Seed, station: StationId, network: NetworkId) -> u8 {
    let place = [station.0.into(), network.0.into(), 0];
    scene_seed.bits(purpose::SEQUENCE, place).to_be_bytes()[0]
}

impl Network {
    /// The links of all stations of `scene`; `hears` tells whose application looks at what is delivered to it.
    pub(crate) fn new(settings: Settings<'_>, scene: &Scene, hears: Vec<bool>) -> Self {
        let Settings { network, radio, mac, radio_states, air, first_receiver, .. } = settings;
        let phy = radio.phy();
        let pan = pan(network);
        let stations = || scene.roll.stations();
        let is_node = |station| scene.roll.is_node(station);
        let stack = |station: StationId| {
            let state = if is_node(station) { mac.initial_state() } else { RadioState::Receive };
            let (clock, levels) = match scene.roll.kind(station) {
                Kind::Node(node) => {
                    let node = NodeId::from_index(node);
                    (radio.clock(scene.seed, network, node), radio.levels(node))
                }
                Kind::Robot(_) | Kind::Sink(_) => (Clock::default(), radio.common_levels()),
            };
            let mut stack = Stack::new(state, first_sequence(scene.seed, station, network), clock, levels);
            if mac.csma().has_idle_turnarounds() {
                stack.meter = stack.meter.with_fall(phy.turnaround());
            }
            stack
        };
        Self {
            pan,
            radios: Radios { network, phy, air, first_receiver },
            macs: stations()
                .map(|station| if is_node(station) { mac.of(station, phy) } else { mac.of_collector(phy) })
                .collect(),
            stacks: stations().map(stack).collect(),
            responders: stations().map(|station| Responder::new(phy, pan, Address::of(station))).collect(),
            hears,
            coordinator: settings.coordinator,
            beacon: None,
            queue_frames: mac.csma().queue_frames().into(),
            payloads: Payloads::default(),
            packets: vec![Packets::default(); scene.roll.len()],
            delays: vec![Delays::default(); if settings.keeps_delays { scene.roll.len() } else { 0 }],
            deliveries: vec![0; scene.roll.len()],
            counted_from: SimTime::ZERO,
            members: settings.members,
            radio_states,
            arrivals: Vec::new(),
            told: Vec::new(),
            mpdu: Vec::with_capacity(127),
            payload: 0..0,
        }
    }

    /// The network starts to work at a station.
    pub(crate) fn begin(&mut self, station: StationId, scene: &mut Scene) {
        if !self.has(station) {
            return;
        }
        self.stacks[station.index()].listening = self.listens_at_rest(station, scene);
        self.transceiver(station, scene).tune();
    }

    /// Whether what a station hears at rest is looked at, without a command to listen.
    fn listens_at_rest(&self, station: StationId, scene: &Scene) -> bool {
        match scene.roll.kind(station) {
            // What a node with superframes hears are beacons.
            Kind::Node(_) => self.macs[station.index()].follows_beacons() || self.hears[station.index()],
            Kind::Robot(_) => false,
            Kind::Sink(_) => true,
        }
    }

    /// Starts the schedule of beacons, if there is one.
    pub(crate) fn begin_beacons(&mut self, scene: &mut Scene) {
        if let Some((station, _)) = self.coordinator {
            self.schedule(station, Duration::ZERO, Event::BeaconDue, scene);
        }
    }

    /// Packets count that are offered from this instant on.
    pub(crate) fn count_from(&mut self, instant: SimTime) {
        self.counted_from = instant;
    }

    /// Energy counts from now on.
    pub(crate) fn restart_meters(&mut self, now: SimTime) {
        self.stacks.iter_mut().for_each(|stack| stack.meter.restart(now));
    }

    /// Handles an event of a station's link.
    #[inline]
    pub(crate) fn handle(
        &mut self,
        station: StationId,
        event: Event,
        scene: &mut Scene,
        observer: &mut impl Observer,
    ) {
        match event {
            Event::Csma(event) => self.handle_csma(station, event, scene, observer),
            Event::CcaEnded => {
                let busy = self.transceiver(station, scene).senses_busy();
                self.handle_csma(station, csma::Event::CcaEnded { busy }, scene, observer);
            }
            Event::Tracking(event) => self.handle_tracking(station, event, scene),
            Event::Responder(event) => self.handle_responder(station, event, scene, observer),
            Event::Coordinator(event) => self.handle_coordinator(station, event, scene, observer),
            Event::BeaconDue => self.prepare_beacon(scene),
            Event::ActivePartEnded => {}
            Event::ListeningOver => {
                let stack = &mut self.stacks[station.index()];
                stack.listening_over = None;
                stack.leaving = true;
            }
        }
        if self.stacks[station.index()].leaving && self.may_leave(station, scene.now) {
            self.stop_listening(station, scene);
            scene.upcalls.push(Upcall::Listened { station });
        }
    }

    /// A station listens for `span` from now, instead of what is left of an earlier time to listen.
    pub(crate) fn listen(&mut self, station: StationId, span: Duration, scene: &mut Scene) {
        let over = self.schedule(station, span, Event::ListeningOver, scene);
        let stack = &mut self.stacks[station.index()];
        stack.listening = true;
        stack.leaving = false;
        if let Some(earlier) = stack.listening_over.replace(over) {
            scene.queue.cancel(earlier);
        }
        self.transceiver(station, scene).tune();
    }

    fn stop_listening(&mut self, station: StationId, scene: &mut Scene) {
        let listening = self.listens_at_rest(station, scene);
        let stack = &mut self.stacks[station.index()];
        stack.listening = listening;
        stack.leaving = false;
        self.transceiver(station, scene).tune();
    }

    /// A station moves differently from now on.
    pub(crate) fn moves(&self, station: StationId, scene: &mut Scene) {
        let motion = &scene.motions[station.index()];
        scene.airs[self.radios.air].moves(self.radios.receiver(station), station, motion);
    }

    /// The frame that was received last.
    pub(crate) fn take_payload(&mut self) -> (Vec<u8>, Range<usize>) {
        (std::mem::take(&mut self.mpdu), self.payload.clone())
    }

    /// Gives the buffer of [`Network::take_payload`] back.
    pub(crate) fn give_back(&mut self, mpdu: Vec<u8>) {
        self.mpdu = mpdu;
    }

    /// Counts what is still to be sent, and returns the packets and the energy of each station.
    pub(crate) fn finish(mut self, now: SimTime) -> NetworkRecord {
        let mut energy = Vec::with_capacity(self.stacks.len());
        for (i, stack) in self.stacks.iter_mut().enumerate() {
            let state = stack.state();
            stack.meter.enter(state, now);
            let is_member = self.members.as_ref().is_none_or(|members| members[i]);
            let spent = stack.meter.spent(&self.radio_states, stack.tx_power);
            energy.push(if is_member { spent } else { EnergySpent::default() });
            let packets = &mut self.packets[i];
            let counts = |frame: &QueuedFrame| frame.offered >= self.counted_from;
            packets.pending = stack.waiting.iter().filter(|frame| counts(frame)).count() as u64;
            if let Some(frame) = stack.frame.filter(counts) {
                // A frame that was received counts so, even if its acknowledgement is still under way.
                let station = StationId::from_index(i);
                let header = data_frame(self.pan, station, frame.to);
                if stack.outcome == FrameOutcome::Received {
                    packets.sent += 1;
                    packets.transmissions += 1;
                    packets.received += 1;
                    packets.octets_received += u64::from(frame.mpdu_octets - header.overhead_octets());
                } else {
                    packets.pending += 1;
                }
            }
        }
        NetworkRecord { packets: self.packets, energy, deliveries: self.deliveries, delays: self.delays }
    }

    /// Whether a station is in the network.
    pub(super) fn has(&self, station: StationId) -> bool {
        self.members.as_ref().is_none_or(|members| members[station.index()])
    }

    fn transceiver<'a>(&'a mut self, station: StationId, scene: &'a mut Scene) -> Transceiver<'a> {
        let stack = &mut self.stacks[station.index()];
        Transceiver { radios: &self.radios, stack, scene, station, awaits_ack: false }
    }

    fn schedule(&self, station: StationId, span: Duration, event: Event, scene: &mut Scene) -> EventKey {
        let event = crate::event::link::LinkEvent::Ieee802154(event);
        scene.after(span, crate::event::Event::Link(station, self.radios.network, event))
    }
}
