//! A network of IEEE 802.11ad: the links of all its stations.

mod broadcasting;
mod dying;
mod ending;
mod sweeping;
mod tracing;

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use sextant_channel::{Dbm, Milliwatts};
use sextant_kernel::{SimTime, StationId};
use sextant_mac::RadioState;
use sextant_mac::dmg::{self, Answer, Initiator, MacAddress, Responder, SectorMeasurement, TxSector};

use super::settings::Ieee80211ad;
use super::stack::{RadioStack, Role, SectorNumbers, Stack};
use super::transceiver::Transceiver;
use crate::air::{Arrival, CarrierChange};
use crate::event::ieee80211ad::Event;
use crate::event::link::LinkEvent;
use crate::link::antennas::Antennas;
use crate::link::books::{Books, FrameSpans, RadioUse};
use crate::link::frame_buffer::FrameBuffer;
use crate::link::ledger::Ledger;
use crate::link::links::NetworkLinks;
use crate::link::payloads::Payloads;
use crate::link::radios::Radios;
use crate::link::settings::Placement;
use crate::link::transmitter::Transmitter;
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::report::{Destination, FrameId, Payload, SendError};
use crate::service::sweep::{SweepAnswer, SweepError, SweepKind};
use crate::service::upcall::Upcall;
use crate::station::{Roll, StationKind};

/// A network of IEEE 802.11ad: the links of all its stations.
pub(crate) struct Links {
    radios: Radios<Dbm>,
    antennas: Antennas,
    roll: Roll,
    stacks: Vec<Stack>,
    /// The sweeps under way, and those that wait for the end of a broadcast, by station.
    sweeps: BTreeMap<StationId, Gathered>,
    /// Sweeps of each station so far.
    swept: Vec<u64>,
    /// Whether the application of a station looks at what it hears.
    hears: Vec<bool>,
    ledger: Ledger,
    arrivals: Vec<Arrival>,
    changes: Vec<CarrierChange>,
    frame: FrameBuffer,
    /// Whether a broadcast was ever offered.
    has_broadcasts: bool,
    /// The payloads of the broadcasts that wait or are under way.
    payloads: Payloads,
}

/// What a station has gathered by the sweep under way.
#[derive(Debug, Default)]
struct Gathered {
    /// The best answer of each station so far, from earlier tilts of a steered antenna.
    answers: BTreeMap<StationId, SweepAnswer>,
    /// The greatest power of a frame of each station in the sweep of this tilt.
    powers: BTreeMap<StationId, Milliwatts>,
    /// The sectors that each station reported in the sweep of this tilt.
    reports: BTreeMap<StationId, Vec<SectorMeasurement>>,
}

impl Links {
    /// The links of all stations of `scene`.
    pub(in crate::link) fn new(settings: &Ieee80211ad, placement: Placement, scene: &mut Scene) -> Self {
        let Ieee80211ad { radio, answers, antennas, .. } = settings;
        let roll = scene.roll;
        let ledger = Ledger::new(&placement, roll);
        let Placement { network, air, first_receiver, hears, .. } = placement;
        let radios = Radios { network, air, first_receiver, radio: radio.tx_power() };
        for station in roll.stations() {
            let mount = antennas.mount(&roll, station, scene.seed);
            scene.airs[air].mount(radios.receiver(station), mount);
        }
        let moves = |station| matches!(roll.kind(station), StationKind::Robot(_)) || scene.is_moving_node(station);
        let standing = roll.stations().filter(|&station| !moves(station));
        let interface = |station| radios.interface(station);
        let standing: Vec<_> = standing.map(|station| (interface(station), scene.place(station))).collect();
        scene.airs[air].know_standing(standing.into_iter());
        let stack = |station: StationId| {
            let address = MacAddress::of(station);
            let layout = if roll.is_node(station) { antennas.node_layout() } else { antennas.robot_layout() };
            Stack {
                initiator: Initiator::new(address, layout, answers.sweep()),
                // Only nodes answer.
                responder: Responder::new(address, *answers),
                radio: RadioStack::new(),
                task: None,
                next_sweep: None,
                waiting: VecDeque::new(),
                broadcasts: 0,
                reached: Vec::new(),
                tilt: 0,
                numbers: SectorNumbers { layout, first: 0 },
                listening_over: None,
                is_answering: false,
                outcome: FrameOutcome::WORST,
                has_answered: false,
                tracks: None,
            }
        };
        Self {
            radios,
            antennas: antennas.clone(),
            roll,
            stacks: roll.stations().map(stack).collect(),
            sweeps: BTreeMap::new(),
            swept: vec![0; roll.len()],
            hears,
            ledger,
            arrivals: Vec::new(),
            changes: Vec::new(),
            frame: FrameBuffer::new(),
            has_broadcasts: false,
            payloads: Payloads::default(),
        }
    }

    /// Whether frames of other stations go to the machine that sweeps: that of a robot or sink, or one that is busy.
    fn has_initiator(&self, station: StationId) -> bool {
        !self.roll.is_node(station) || self.stacks[station.index()].initiator.is_busy()
    }

    /// The identity in logs of a sector of the sweep of `station` under way: that of a code book, or its number. `None`
    /// if its antenna has no sectors, or no such sector.
    fn identity(&self, station: StationId, sector: TxSector) -> Option<u8> {
        let antenna = self.antennas.of(self.roll.kind(station));
        let number = self.stacks[station.index()].numbers.of(sector)?;
        (!antenna.is_omnidirectional()).then(|| antenna.identity(number))
    }

    fn transceiver<'a>(
        &'a mut self,
        station: StationId,
        role: Role,
        scene: &'a mut Scene,
    ) -> (Transceiver<'a>, &'a mut Initiator, &'a mut Responder) {
        let Stack { initiator, responder, radio, numbers, .. } = &mut self.stacks[station.index()];
        let transceiver = Transceiver { radios: &self.radios, stack: radio, scene, station, role, numbers: *numbers };
        (transceiver, initiator, responder)
    }

    fn handle_initiator(&mut self, station: StationId, event: dmg::Event, scene: &mut Scene) {
        let now = scene.now;
        self.forget_timer(station, Role::Initiator, event);
        let (mut radio, initiator, _) = self.transceiver(station, Role::Initiator, scene);
        if let Some(report) = initiator.handle(now, event, &mut radio) {
            self.end_sweep(station, report, scene);
        }
    }

    fn handle_responder(&mut self, station: StationId, event: dmg::Event, scene: &mut Scene) {
        let now = scene.now;
        self.forget_timer(station, Role::Responder, event);
        let (mut radio, _, responder) = self.transceiver(station, Role::Responder, scene);
        if let Some(report) = responder.handle(now, event, &mut radio) {
            self.note_answer(station, report, scene);
        }
        self.proceed(station, scene);
    }

    /// A timer that is due is not pending any more.
    fn forget_timer(&mut self, station: StationId, role: Role, event: dmg::Event) {
        if matches!(event, dmg::Event::TransmitReady | dmg::Event::WaitExpired) {
            self.stacks[station.index()].radio.timers[role as usize] = None;
        }
    }

    /// Tells the machines how the carrier has changed. What they do then may change it again.
    fn tell_carrier(&mut self, scene: &mut Scene) {
        loop {
            let mut changes = std::mem::take(&mut self.changes);
            scene.airs[self.radios.air].take_carrier_changes(&mut changes);
            for &CarrierChange { station, is_busy } in &changes {
                if self.ledger.died(station).is_some() {
                    continue;
                }
                let event = if is_busy { dmg::Event::CarrierBusy } else { dmg::Event::CarrierIdle };
                self.handle_initiator(station, event, scene);
                if self.roll.is_node(station) {
                    self.handle_responder(station, event, scene);
                }
            }
            let is_over = changes.is_empty();
            self.changes = changes;
            if is_over {
                return;
            }
        }
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
        self.stacks.iter_mut().for_each(|stack| stack.tracks = Some(Box::default()));
    }

    fn begin(&mut self, station: StationId, scene: &mut Scene) {
        if self.ledger.has(station) {
            self.transceiver(station, Role::Responder, scene).0.tune();
        }
    }

    /// All sweeps and broadcasts count.
    fn count_from(&mut self, _: SimTime) {}

    fn handle(&mut self, station: StationId, event: Event, scene: &mut Scene, observer: &mut impl Observer) {
        match event {
            Event::InitiatorReady => self.handle_initiator(station, dmg::Event::TransmitReady, scene),
            Event::InitiatorWaited => self.handle_initiator(station, dmg::Event::WaitExpired, scene),
            Event::ResponderReady => self.handle_responder(station, dmg::Event::TransmitReady, scene),
            Event::ResponderWaited => self.handle_responder(station, dmg::Event::WaitExpired, scene),
            Event::InitiatorTransmitted => {
                self.end_frame(station, scene, observer);
                self.handle_initiator(station, dmg::Event::TransmissionEnded, scene);
            }
            Event::ResponderTransmitted => {
                self.end_frame(station, scene, observer);
                self.handle_responder(station, dmg::Event::TransmissionEnded, scene);
            }
            Event::ListeningOver => {
                self.stacks[station.index()].listening_over = None;
                scene.upcalls.push(Upcall::Listened { station });
            }
        }
        self.tell_carrier(scene);
    }

    fn transmitter(&self, station: StationId) -> Option<Transmitter> {
        let (air, power) = (self.radios.air, self.radios.power());
        let radio = self.radios.interface(station);
        // A radio that does not sweep listens: only that of a dead station is asleep.
        let is_there = self.ledger.has(station) && self.stacks[station.index()].radio.state != RadioState::Sleep;
        let sectors = self.antennas.of(self.roll.kind(station)).sector_count();
        is_there.then_some(Transmitter { air, radio, tx_power: power, sectors: Some(sectors) })
    }

    fn sweep(&mut self, station: StationId, kind: SweepKind, scene: &mut Scene) -> Result<(), SweepError> {
        if !self.ledger.has(station) {
            return Err(SweepError::NoSectors);
        }
        let stack = &mut self.stacks[station.index()];
        if self.sweeps.contains_key(&station) || stack.responder.is_busy() {
            return Err(SweepError::Busy);
        }
        stack.next_sweep = Some(kind);
        if let Some(tracks) = &mut stack.tracks {
            tracks.sweep_offered = scene.now;
        }
        scene.offered += 1;
        self.swept[station.index()] += 1;
        self.ledger.packets[station.index()].offered += 1;
        self.sweeps.insert(station, Gathered::default());
        self.proceed(station, scene);
        self.tell_carrier(scene);
        Ok(())
    }

    fn take_answers(&mut self, station: StationId) -> Vec<SweepAnswer> {
        let gathered = self.sweeps.remove(&station);
        gathered.map_or_else(Vec::new, |gathered| gathered.answers.into_values().collect())
    }

    fn turns_antennas(&self) -> bool {
        self.antennas.turn_with_robots()
    }

    fn sectors(&self, station: StationId) -> Option<u8> {
        let antenna = self.antennas.of(self.roll.kind(station));
        (!antenna.is_omnidirectional()).then(|| antenna.sector_count())
    }

    fn listen(&mut self, station: StationId, span: Duration, scene: &mut Scene) {
        let event = LinkEvent::Ieee80211ad(Event::ListeningOver);
        let over = self.radios.after(span, station, event, scene);
        if let Some(earlier) = self.stacks[station.index()].listening_over.replace(over) {
            scene.queue.cancel(earlier);
        }
    }

    fn moves(&self, station: StationId, scene: &mut Scene) {
        self.radios.moves(station, scene);
    }

    fn finish(mut self, now: SimTime) -> Books {
        let mut radios = Vec::with_capacity(self.stacks.len());
        for (i, stack) in self.stacks.iter_mut().enumerate() {
            if self.ledger.died(StationId::from_index(i)).is_none() {
                stack.radio.meter.enter(stack.radio.state, now);
            }
            let (meter, tx_power) = (stack.radio.meter, self.radios.power());
            let rests_in = sextant_mac::RadioState::Receive;
            radios.push(RadioUse { meter, tx_power, other_powers: Vec::new(), rests_in });
        }
        // Nodes that answer do not rest.
        self.ledger.close(radios, FrameSpans::default())
    }

    fn sweeps_sectors(&self) -> bool {
        true
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

    fn metered_j(&mut self, station: StationId, scene: &mut Scene) -> f64 {
        let radio = &self.stacks[station.index()].radio;
        let mut meter = radio.meter;
        meter.enter(radio.state, scene.now);
        meter.spent(&self.ledger.radio_states, self.radios.power()).total_j()
    }

    fn ends_frame(&self, station: StationId, event: Event) -> bool {
        matches!(event, Event::InitiatorTransmitted | Event::ResponderTransmitted)
            && self.stacks[station.index()].radio.on_air.is_some()
    }
}

/// What an answer says to the station that swept; `sector` is the identity of its sector that the answer names, if it has
/// sectors.
fn read(answer: &Answer, sector: Option<u8>, rssi: Milliwatts, from: StationId) -> SweepAnswer {
    SweepAnswer {
        from,
        sector,
        snr: answer.select_snr.snr(),
        rssi: rssi.to_dbm(),
        node_sector: answer.responder_sector.sector,
        sectors: Vec::new(),
    }
}
