//! The event loop.

mod coordination;
mod frames;
mod robots;

use std::time::Duration;

use sextant_channel::{Channel, ChannelLaw, Contact, Db, Position, ReceptionLogBuilder, Stop};
use sextant_kernel::{EventQueue, NodeId, RobotId, Seed, SettingError, SimTime};
use sextant_mac::coordinator::Coordinator;
use sextant_mac::csma::Outcome;
use sextant_mac::frame::{Address, Frame as MacFrame, FrameBody, NodeFrame};
use sextant_mac::responder::{Responder, Verdict};
use sextant_mac::{EnergySpent, Phy, RadioState, RadioStates, csma};

use crate::air::{Air, AirSettings, Arrival};
use crate::event::{Event, RobotEvent};
use crate::mac::NodeMac;
use crate::node::{Network, Node};
use crate::pilot::Pilot;
use crate::purpose;
use crate::receiver::ReceptionRules;
use crate::survey::{Packets, RobotRecord, Survey};
use crate::{FrameOutcome, HeardFrame, Mac, Observer, Progress, Radio, ReceptionModel, Robot, Traffic, World};

use robots::RobotRadio;

/// PAN of all stations.
pub(crate) const PAN: u16 = 0x5E87;

/// Events between two looks at whether to go on.
const LOOK: u64 = 1000;

/// Signals this far below the noise may be neglected.
pub(crate) const NEGLECTED_BELOW_NOISE: Db = Db(10.0);

/// Everything that a simulation needs.
#[derive(Clone)]
pub struct Setup {
    /// The world.
    pub world: World,
    /// The law of the radio channel.
    pub channel: ChannelLaw,
    /// The radios.
    pub radio: Radio,
    /// The rule that decides whether a frame is received.
    pub reception: ReceptionModel,
    /// The physical layer.
    pub phy: Phy,
    /// Channel access of the nodes.
    pub mac: Mac,
    /// Traffic of the nodes.
    pub traffic: Traffic,
    /// Energy model of the nodes' radios.
    pub radio_states: RadioStates,
    /// The robots.
    pub robots: Vec<Robot>,
    /// The seed of all randomness.
    pub seed: Seed,
}

/// A simulation that runs once, to its end.
pub struct Simulation {
    world: World,
    network: Network,
    macs: Vec<NodeMac>,
    /// The state machine of the first robot as coordinator, with a beacon-enabled MAC.
    coordinator: Option<Coordinator>,
    pilots: Vec<Pilot>,
    traffic: Traffic,
    sink: Option<NodeId>,
    radio_states: RadioStates,
    power: sextant_channel::Dbm,
    packets: Packets,
    stops: Vec<Stop>,
    receptions: ReceptionLogBuilder,
    contacts: Vec<Contact>,
    heard: Vec<bool>,
    nodes_heard: usize,
    arrivals: Vec<Arrival>,
    told: Vec<HeardFrame>,
    mpdu: Vec<u8>,
    events: u64,
}

impl Simulation {
    /// A simulation, ready to run.
    ///
    /// # Errors
    /// If the frames are too small for the addresses, there are several robots but frames are sent to one of them,
    /// or the superframes do not fit the world, robots and traffic.
    pub fn new(setup: Setup) -> Result<Self, SettingError> {
        let Setup { world, channel, radio, reception, phy, mac, traffic, radio_states, robots, seed } = setup;
        let nodes = world.nodes.len();
        if traffic.is_acknowledged() && robots.len() > 1 {
            let allowed = format!(
                "one robot with `{}`: nodes send to the first robot, and the others do not hear them",
                traffic.key()
            );
            return Err(SettingError::new("robots", format!("a list of {}", robots.len()), allowed));
        }
        let last = NodeId::from_index((nodes + robots.len()).saturating_sub(1));
        let longest = if traffic.is_acknowledged() {
            NodeFrame::acknowledged(PAN, last, last, traffic.mpdu_octets())
        } else {
            NodeFrame::broadcast(PAN, last, traffic.mpdu_octets())
        };
        longest.map_err(|error| error.within(traffic.key()))?;
        let channel = Channel::new(channel, world.obstacles.clone(), seed);
        let places = || world.nodes.iter().map(|node| node.position);
        let air = Air::new(
            AirSettings {
                channel,
                power: radio.tx_power(),
                floor: radio.noise_floor() - NEGLECTED_BELOW_NOISE,
                rules: ReceptionRules {
                    model: reception,
                    sensitivity: radio.sensitivity().to_milliwatts(),
                    noise: radio.noise_floor().to_milliwatts(),
                    preamble: phy.synchronisation_header() - phy.octet(),
                    bit_rate_hz: phy.bit_rate_per_s(),
                },
                sensing: phy.cca(),
                first_packet: 0,
                seed,
            },
            places(),
            nodes,
            robots.len(),
        );
        let initial_state = mac.initial_state();
        let first_number = |station: usize| (seed.bits(purpose::SEQUENCE, [station as u64, 0, 0]) >> 56) as u8;
        let coordinator = match &mac {
            Mac::CsmaUnslotted(_) => None,
            Mac::BeaconEnabled(settings) => {
                coordination::coordinator(settings, phy, &world, &robots, &traffic, first_number(nodes))?
            }
        };
        let new_node = |(i, position): (usize, Position)| Node::new(position, initial_state, first_number(i));
        let acknowledgements = vec![None; robots.len()];
        let network = Network {
            acknowledgements,
            beacon: None,
            now: SimTime::ZERO,
            queue: EventQueue::new(),
            nodes: places().enumerate().map(new_node).collect(),
            air,
            phy,
            seed,
            cca_threshold: radio.cca_threshold().to_milliwatts(),
            hears_always: initial_state == RadioState::Receive,
        };
        let address = |robot: usize| Address::of(NodeId::from_index(nodes + robot));
        let sink = (traffic.is_acknowledged() && !robots.is_empty()).then(|| NodeId::from_index(nodes));
        let pilots = (robots.into_iter().enumerate())
            .map(|(i, robot)| Pilot::new(RobotId::from_index(i), robot, Responder::new(phy, PAN, address(i)), nodes))
            .collect();
        Ok(Self {
            macs: (0..nodes).map(|i| mac.of(NodeId::from_index(i), phy)).collect(),
            coordinator,
            network,
            pilots,
            traffic,
            sink,
            radio_states,
            power: radio.tx_power(),
            packets: Packets::default(),
            stops: Vec::new(),
            receptions: ReceptionLogBuilder::default(),
            contacts: Vec::new(),
            heard: vec![false; nodes],
            nodes_heard: 0,
            arrivals: Vec::new(),
            told: Vec::new(),
            mpdu: Vec::with_capacity(127),
            events: 0,
            world,
        })
    }

    /// Runs until the last robot has finished, or the observer ends the simulation.
    pub fn run(mut self, observer: &mut impl Observer) -> Survey {
        self.begin();
        let mut interrupted = false;
        while !interrupted && !self.pilots.iter().all(Pilot::is_finished) {
            let Some((now, event)) = self.network.queue.pop() else { break };
            self.network.now = now;
            self.events += 1;
            match event {
                Event::FrameDue(node) => self.offer(node),
                Event::Mac(node, event) => self.handle_mac(node, event, observer),
                Event::CcaEnded(node) => {
                    let busy = self.network.senses_busy(node);
                    self.handle_mac(node, csma::Event::CcaEnded { busy }, observer);
                }
                Event::Tracking(node, event) => self.handle_tracking(node, event),
                Event::Robot(robot, event) => interrupted = !self.handle_robot(robot as usize, event, observer),
            }
            // A robot may listen for long.
            interrupted |= self.events.is_multiple_of(LOOK) && !observer.goes_on(self.progress());
        }
        self.finish(interrupted)
    }

    fn progress(&self) -> Progress {
        Progress {
            time: self.network.now,
            stops: self.stops.len(),
            nodes_heard: self.nodes_heard,
            nodes: self.macs.len(),
        }
    }

    fn begin(&mut self) {
        for i in 0..self.macs.len() {
            let node = NodeId::from_index(i);
            self.schedule_frame(node);
            if self.network.nodes[i].meter.state() == RadioState::Receive {
                let place = self.network.nodes[i].position;
                self.network.air.listen(SimTime::ZERO, node, place);
            }
        }
        for robot in 0..self.pilots.len() {
            self.network.after(Duration::ZERO, Event::of_robot(robot, RobotEvent::Arrived));
        }
        if self.coordinator.is_some() {
            self.network.after(Duration::ZERO, Event::of_robot(coordination::COORDINATOR, RobotEvent::BeaconDue));
        }
    }

    /// Schedules the next frame of a node's application.
    fn schedule_frame(&mut self, node: NodeId) {
        let count = self.network.nodes[node.index()].frames;
        if let Some(due) = self.traffic.due(self.network.seed, node, count) {
            self.network.after(due.saturating_since(self.network.now), Event::FrameDue(node));
        }
    }

    /// A node's application gives a frame to its MAC.
    fn offer(&mut self, node: NodeId) {
        let state = &mut self.network.nodes[node.index()];
        state.frames += 1;
        self.packets.offered += 1;
        let mac = &mut self.macs[node.index()];
        if mac.is_busy() {
            self.packets.lost_queue += 1;
        } else {
            state.sequence = state.sequence.wrapping_add(1);
            state.outcome = FrameOutcome::NotListened;
            let frame = csma::OutgoingFrame {
                mpdu_octets: self.traffic.mpdu_octets(),
                ack_request: self.sink.is_some(),
                sequence: state.sequence,
            };
            mac.start(self.network.now, frame, &mut self.network.radio(node, false));
        }
        self.schedule_frame(node);
    }

    fn handle_mac(&mut self, node: NodeId, event: csma::Event, observer: &mut impl Observer) {
        if event == csma::Event::TransmissionEnded {
            self.end_frame(node, observer);
        }
        let awaits_ack = event == csma::Event::ReceiveReady;
        let now = self.network.now;
        let report = self.macs[node.index()].handle(now, event, &mut self.network.radio(node, awaits_ack));
        if let Some(report) = report {
            self.count(node, report);
        }
    }

    /// A node's frame ends: finds its outcome at the robots.
    fn end_frame(&mut self, node: NodeId, observer: &mut impl Observer) {
        let state = &mut self.network.nodes[node.index()];
        let transmission = state.transmission.take().expect("only a frame on air ends");
        let best = self.network.air.end(self.network.now, &transmission, &mut self.arrivals);
        let state = &mut self.network.nodes[node.index()];
        state.outcome = state.outcome.max(best);
        let first_robot = self.macs.len();
        let is_received =
            |arrival: &Arrival| arrival.outcome == FrameOutcome::Received && arrival.station.index() >= first_robot;
        if !observer.wants_frames() && !self.arrivals.iter().any(is_received) {
            return;
        }
        self.write_frame(node);
        if observer.wants_frames() {
            self.tell_frame(&transmission, best, observer);
        }
        for i in 0..self.arrivals.len() {
            if is_received(&self.arrivals[i]) {
                self.deliver(self.arrivals[i]);
            }
        }
    }

    fn write_frame(&mut self, node: NodeId) {
        let sequence = self.network.nodes[node.index()].sequence;
        let octets = self.traffic.mpdu_octets();
        let frame = match self.sink {
            None => NodeFrame::broadcast(PAN, node, octets),
            Some(sink) => NodeFrame::acknowledged(PAN, node, sink, octets),
        };
        frame.expect("the size was checked at the start").write(sequence, &mut self.mpdu);
    }

    /// A robot has received the frame in `mpdu`.
    fn deliver(&mut self, arrival: Arrival) {
        let robot = arrival.station.index() - self.macs.len();
        let frame = MacFrame::parse(&self.mpdu).expect("stations write what they can read");
        let source = frame.source.and_then(|source| source.address.node());
        let is_data = matches!(frame.body, FrameBody::Data(_));
        let gap = self.ack_gap(robot);
        let pilot = &mut self.pilots[robot];
        let mut radio = RobotRadio { network: &mut self.network, robot, place: pilot.position() };
        let verdict = pilot.responder.receive_and_respond(&frame, gap, &mut radio);
        if let (Verdict::Deliver, true, Some(node)) = (verdict, is_data, source) {
            pilot.note(node, frame.sequence, arrival.power);
        }
    }

    fn count(&mut self, node: NodeId, report: csma::Report) {
        let fate = self.network.nodes[node.index()].outcome;
        let packets = &mut self.packets;
        packets.sent += u64::from(report.transmissions > 0);
        packets.channel_access_failures += u64::from(report.outcome == Outcome::ChannelAccessFailure);
        if report.transmissions == 0 {
            debug_assert_eq!(report.outcome, Outcome::ChannelAccessFailure);
            packets.lost_channel_access += 1;
        } else {
            *match fate {
                FrameOutcome::Received => &mut packets.received,
                FrameOutcome::Collided => &mut packets.lost_collision,
                FrameOutcome::Weak => &mut packets.lost_signal,
                FrameOutcome::OutOfRange => &mut packets.out_of_range,
                FrameOutcome::NotListened => &mut packets.not_listened,
            } += 1;
        }
    }

    fn finish(mut self, interrupted: bool) -> Survey {
        let mut energy = EnergySpent::default();
        for (node, mac) in self.network.nodes.iter_mut().zip(&self.macs) {
            let state = node.meter.state();
            node.meter.enter(state, self.network.now);
            energy += node.meter.spent(&self.radio_states, self.power);
            self.packets.pending += u64::from(mac.is_busy());
        }
        let names = self.world.nodes.into_iter().map(|node| node.name).collect();
        let log = self
            .receptions
            .build(names, self.stops, self.contacts)
            .expect("a simulation hears each node at most once a stop");
        let robots: Vec<RobotRecord> = self.pilots.into_iter().map(Pilot::into_record).collect();
        let named = robots.iter().map(|robot| robot.name.clone()).collect();
        Survey {
            log: log.with_robots(named).expect("each stop and contact is of a robot"),
            robots,
            packets: self.packets,
            energy,
            end: self.network.now,
            events: self.events,
            interrupted,
        }
    }
}
