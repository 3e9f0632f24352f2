//! A network of IEEE 802.15.4: the links of all its stations.

mod acknowledging;
mod beacons;
mod dying;
mod frames;
mod quiet;
mod receiving;
mod sending;

use std::time::Duration;

use sextant_kernel::{EventKey, NodeId, SimTime, StationId};
use sextant_mac::coordinator::Coordinator;
use sextant_mac::frame::Address;
use sextant_mac::responder::Responder;
use sextant_mac::{Phy, RadioState, csma, responder};

use super::addressing::{first_sequence, pan};
use super::mac::NodeMac;
use super::settings::Ieee802154;
use super::stack::Stack;
use super::transceiver::Transceiver;
use crate::air::{Arrival, Transmission};
use crate::event::ieee802154::Event;
use crate::event::link::LinkEvent;
use crate::link::books::{Books, FrameSpans, RadioUse};
use crate::link::clock::Clock;
use crate::link::frame_buffer::FrameBuffer;
use crate::link::ledger::Ledger;
use crate::link::links::{Cut, NetworkLinks};
use crate::link::payloads::Payloads;
use crate::link::radios::Radios;
use crate::link::settings::Placement;
use crate::link::transmitter::Transmitter;
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::report::{Destination, FrameId, Payload, SendError};
use crate::service::upcall::Upcall;
use crate::station::StationKind;

/// Spans of channel access (ns).
#[derive(Clone, Copy, Debug)]
struct Spans {
    cca_ns: u64,
    backoff_ns: u64,
    turnaround_ns: u64,
}

impl Spans {
    fn new(phy: Phy) -> Self {
        let [cca_ns, backoff_ns, turnaround_ns] =
            [phy.cca(), phy.backoff_period(), phy.turnaround()].map(|span| (SimTime::ZERO + span).as_nanos());
        Self { cca_ns, backoff_ns, turnaround_ns }
    }
}

/// A network of IEEE 802.15.4: the links of all its stations.
pub(crate) struct Links {
    pan: u16,
    radios: Radios<Phy>,
    spans: Spans,
    macs: Vec<NodeMac>,
    stacks: Vec<Stack>,
    responders: Vec<Responder>,
    /// Whether the application of a station looks at what is delivered to it.
    hears: Vec<bool>,
    coordinator: Option<(StationId, Coordinator)>,
    /// The beacon that is on air.
    beacon: Option<Transmission>,
    /// Whether there is no other network.
    is_only: bool,
    /// The state of the radio of a node that sends nothing.
    rests_in: RadioState,
    nodes: usize,
    queue_frames: usize,
    payloads: Payloads,
    ledger: Ledger,
    arrivals: Vec<Arrival>,
    frame: FrameBuffer,
}

impl Links {
    /// The links of all stations of `scene`.
    pub(in crate::link) fn new(settings: &Ieee802154, placement: Placement, scene: &Scene) -> Self {
        let Ieee802154 { radio, mac, .. } = settings;
        let ledger = Ledger::new(&placement, scene.roll);
        let Placement { network, is_only, air, first_receiver, hears, coordinator, .. } = placement;
        let phy = radio.phy();
        let pan = pan(network);
        let stations = || scene.roll.stations();
        let is_node = |station| scene.roll.is_node(station);
        let stack = |station: StationId| {
            let state = if is_node(station) { mac.initial_state() } else { RadioState::Receive };
            let (clock, levels) = match scene.roll.kind(station) {
                StationKind::Node(node) => {
                    let node = NodeId::from_index(node);
                    (radio.clock(scene.seed, network, node), radio.levels(node))
                }
                StationKind::Robot(_) | StationKind::Sink(_) => (Clock::default(), radio.common_levels()),
            };
            let mut stack = Stack::new(state, first_sequence(scene.seed, station, network), clock, levels);
            stack.lead = radio.lead();
            if mac.csma().has_idle_turnarounds() {
                stack.meter = stack.meter.with_fall(phy.turnaround());
            }
            stack
        };
        Self {
            pan,
            radios: Radios { network, air, first_receiver, radio: phy },
            spans: Spans::new(phy),
            macs: stations()
                .map(|station| if is_node(station) { mac.of(station, phy) } else { mac.of_collector(phy) })
                .collect(),
            stacks: stations().map(stack).collect(),
            responders: stations().map(|station| Responder::new(phy, pan, Address::of(station))).collect(),
            hears,
            coordinator,
            beacon: None,
            is_only,
            rests_in: mac.initial_state(),
            nodes: scene.roll.nodes,
            queue_frames: mac.csma().queue_frames().into(),
            payloads: Payloads::default(),
            ledger,
            arrivals: Vec::new(),
            frame: FrameBuffer::new(),
        }
    }

    /// Whether what a station hears at rest is looked at, without a command to listen.
    fn listens_at_rest(&self, station: StationId, scene: &Scene) -> bool {
        match scene.roll.kind(station) {
            // What a node with superframes hears are beacons.
            StationKind::Node(_) => self.macs[station.index()].follows_beacons() || self.hears[station.index()],
            StationKind::Robot(_) => false,
            StationKind::Sink(_) => true,
        }
    }

    fn stop_listening(&mut self, station: StationId, scene: &mut Scene) {
        let listening = self.listens_at_rest(station, scene);
        let stack = &mut self.stacks[station.index()];
        stack.listening = listening;
        stack.leaving = false;
        self.transceiver(station, scene).tune();
    }

    fn transceiver<'a>(&'a mut self, station: StationId, scene: &'a mut Scene) -> Transceiver<'a> {
        let stack = &mut self.stacks[station.index()];
        Transceiver { radios: &self.radios, stack, scene, station, awaits_ack: false }
    }

    fn schedule(&self, station: StationId, span: Duration, event: Event, scene: &mut Scene) -> EventKey {
        self.radios.after(span, station, LinkEvent::Ieee802154(event), scene)
    }
}

impl NetworkLinks for Links {
    type Event = Event;

    fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    fn ledger_mut(&mut self) -> &mut Ledger {
        &mut self.ledger
    }

    fn frame(&mut self) -> &mut FrameBuffer {
        &mut self.frame
    }

    fn trace(&mut self) {
        self.stacks.iter_mut().for_each(|stack| stack.track = Some(Box::default()));
    }

    fn begin(&mut self, station: StationId, scene: &mut Scene) {
        if !self.ledger.has(station) {
            return;
        }
        self.stacks[station.index()].listening = self.listens_at_rest(station, scene);
        self.stacks[station.index()].is_quiet = self.is_quiet(station, scene);
        self.transceiver(station, scene).tune();
    }

    fn catch_up(&mut self, cut: Cut, scene: &mut Scene) -> SimTime {
        let roll = scene.roll;
        let last = roll.stations().map(|station| self.catch_up_station(station, cut, scene)).max();
        last.unwrap_or(SimTime::ZERO)
    }

    fn restart_meters(&mut self, now: SimTime) {
        self.stacks.iter_mut().for_each(|stack| stack.meter.restart(now));
    }

    #[inline]
    fn handle(&mut self, station: StationId, event: Event, scene: &mut Scene, observer: &mut impl Observer) {
        match event {
            Event::Csma(event) => self.handle_csma(station, event, scene, observer),
            Event::CcaEnded => {
                self.take_steps(station, event, scene);
                let busy = self.transceiver(station, scene).senses_busy();
                if let Some(track) = &mut self.stacks[station.index()].track {
                    track.end_assessment(busy);
                }
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

    fn listen(&mut self, station: StationId, span: Duration, scene: &mut Scene) {
        self.rouse(station, scene);
        let over = self.schedule(station, span, Event::ListeningOver, scene);
        let stack = &mut self.stacks[station.index()];
        stack.listening = true;
        stack.leaving = false;
        if let Some(earlier) = stack.listening_over.replace(over) {
            scene.queue.cancel(earlier);
        }
        self.transceiver(station, scene).tune();
    }

    fn moves(&self, station: StationId, scene: &mut Scene) {
        self.radios.moves(station, scene);
    }

    fn finish(mut self, now: SimTime) -> Books {
        let mut radios = Vec::with_capacity(self.stacks.len());
        for (i, stack) in self.stacks.iter_mut().enumerate() {
            let station = StationId::from_index(i);
            if self.ledger.died(station).is_none() {
                stack.meter.enter(stack.state(), now);
            }
            let rests_in = if i < self.nodes { self.rests_in } else { RadioState::Receive };
            let (meter, tx_power) = (stack.meter, stack.tx_power);
            radios.push(RadioUse { meter, tx_power, other_powers: Vec::new(), rests_in });
        }
        let phy = self.radios.phy();
        // To receiving, and from there to transmitting.
        let access = 2 * phy.turnaround() + phy.cca();
        self.ledger.close(radios, FrameSpans { header: phy.header(), octet: phy.octet(), access })
    }

    fn begin_schedule(&mut self, scene: &mut Scene) {
        if let Some((station, _)) = self.coordinator {
            self.schedule(station, Duration::ZERO, Event::BeaconDue, scene);
        }
    }

    fn offer(
        &mut self,
        station: StationId,
        to: Destination,
        payload: Payload<'_>,
        scene: &mut Scene,
    ) -> Result<FrameId, SendError> {
        self.take_frame(station, to, payload, scene)
    }

    fn skip(&mut self, station: StationId, frames: u64) {
        let stack = &mut self.stacks[station.index()];
        // The next frame has the numbers that it would have had.
        #[expect(clippy::cast_possible_truncation, reason = "numbers of frames go round")]
        {
            stack.sequence = stack.sequence.wrapping_add(frames as u8);
            stack.frames = stack.frames.wrapping_add(frames as u32);
        }
    }

    fn transmitter(&self, station: StationId) -> Option<Transmitter> {
        let stack = &self.stacks[station.index()];
        let radio = self.radios.interface(station);
        let is_there = self.ledger.has(station) && !stack.is_dead;
        is_there.then_some(Transmitter { air: self.radios.air, radio, tx_power: stack.tx_power, sectors: None })
    }

    fn metered_j(&mut self, station: StationId, scene: &mut Scene) -> f64 {
        if !self.ledger.has(station) {
            return 0.0;
        }
        self.catch_up_now(station, scene);
        let stack = &self.stacks[station.index()];
        let mut meter = stack.meter;
        meter.enter(stack.state(), scene.now);
        meter.spent(&self.ledger.radio_states, stack.tx_power).total_j()
    }

    fn ends_frame(&self, station: StationId, event: Event) -> bool {
        let stack = &self.stacks[station.index()];
        match event {
            Event::Csma(csma::Event::TransmissionEnded) => stack.transmission.is_some(),
            Event::Responder(responder::Event::TransmissionEnded) => stack.acknowledgement.is_some(),
            _ => false,
        }
    }
}
