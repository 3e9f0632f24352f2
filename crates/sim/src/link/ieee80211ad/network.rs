//! A network of IEEE 802.11ad: the links of all its stations.

mod broadcasting;
mod dying;
mod ending;
mod sweeping;

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use sextant_channel::{Milliwatts, SectorTable};
use sextant_kernel::{SimTime, StationId};
use sextant_mac::dmg::{self, Answer, Initiator, MacAddress, Responder, SectorLayout};
use sextant_mac::{EnergySpent, RadioStates};

use super::Ieee80211ad;
use super::antennas::{Antennas, layout};
use super::stack::{RadioStack, Role, Stack};
use super::transceiver::{Radios, Transceiver};
use crate::air::{Arrival, CarrierChange};
use crate::event::ieee80211ad::Event;
use crate::link::payloads::Payloads;
use crate::observer::{HeardFrame, Observer};
use crate::scene::Scene;
use crate::service::delays::Delays;
use crate::service::network_id::NetworkId;
use crate::service::outcome::FrameOutcome;
use crate::service::packets::{NetworkRecord, Packets};
use crate::service::sweep::{SweepAnswer, SweepError, SweepKind};
use crate::service::upcall::Upcall;
use crate::station::Roll;

/// What a network of IEEE 802.11ad needs.
pub(crate) struct Settings<'a> {
    pub(crate) network: NetworkId,
    pub(crate) links: &'a Ieee80211ad,
    pub(crate) radio_states: RadioStates,
    /// Number of the air of its band.
    pub(crate) air: usize,
    /// Number of the first station's receiver there.
    pub(crate) first_receiver: u32,
    /// Whether each station is in the network; `None` if all are.
    pub(crate) members: Option<Vec<bool>>,
}

/// A network of IEEE 802.11ad: the links of all its stations.
pub(crate) struct Network {
    radios: Radios,
    antennas: Antennas,
    roll: Roll,
    stacks: Vec<Stack>,
    /// The sweeps under way, and those that wait for the end of a broadcast, by station.
    sweeps: BTreeMap<StationId, Gathered>,
    /// Sweeps of each station so far.
    swept: Vec<u64>,
    /// Whether the application of a station looks at what it hears.
    hears: Vec<bool>,
    packets: Vec<Packets>,
    deliveries: Vec<u64>,
    /// Time from offer to first reception of the broadcasts of each station that were received, if there are sinks.
    delays: Vec<Delays>,
    members: Option<Vec<bool>>,
    radio_states: RadioStates,
    arrivals: Vec<Arrival>,
    changes: Vec<CarrierChange>,
    told: Vec<HeardFrame>,
    octets: Vec<u8>,
    /// Whether a broadcast was ever offered.
    has_broadcasts: bool,
    /// The payloads of the broadcasts that wait or are under way.
    payloads: Payloads,
    /// The payload of the frame that was received last.
    payload: Vec<u8>,
}

/// What a station has gathered by the sweep under way.
#[derive(Debug, Default)]
struct Gathered {
    /// The best answer of each station so far, from earlier tilts of a steered antenna.
    answers: BTreeMap<StationId, SweepAnswer>,
    /// The greatest power of a frame of each station in the sweep of this tilt.
    powers: BTreeMap<StationId, Milliwatts>,
}

impl Network {
    /// The links of all stations of `scene`; `hears` tells whose application looks at what it hears.
    pub(crate) fn new(settings: Settings<'_>, scene: &mut Scene, hears: Vec<bool>) -> Self {
        let Settings { network, links, radio_states, air, first_receiver, members } = settings;
        let radios = Radios { network, power: links.radio.tx_power(), air, first_receiver };
        let roll = scene.roll;
        let layouts = [links.antennas.nodes(), links.antennas.robots()]
            .map(|antenna| layout(antenna).expect("the antennas were checked"));
        for station in roll.stations() {
            let mount = links.antennas.mount(&roll, station, scene.seed);
            scene.airs[air].mount(radios.receiver(station), mount);
        }
        let sweep = links.sweep.with_longest_answer(layouts[0].sweep_duration());
        let stack = |station: StationId| {
            let address = MacAddress::of(station);
            let layout = layouts[usize::from(!roll.is_node(station))];
            // Only nodes answer, and their sectors were checked against the slots.
            let responder = Responder::new(address, layouts[0], sweep).expect("the antennas were checked");
            Stack {
                initiator: Initiator::new(address, layout, sweep),
                responder,
                radio: RadioStack::new(),
                task: None,
                next_sweep: None,
                waiting: VecDeque::new(),
                broadcasts: 0,
                reached: Vec::new(),
                tilt: 0,
                first_sectors: first_sectors(&layout),
                listening_over: None,
                outcome: FrameOutcome::WORST,
                frames: 0,
            }
        };
        Self {
            radios,
            antennas: links.antennas.clone(),
            roll,
            stacks: roll.stations().map(stack).collect(),
            sweeps: BTreeMap::new(),
            swept: vec![0; roll.len()],
            hears,
            packets: vec![Packets::default(); roll.len()],
            deliveries: vec![0; roll.len()],
            delays: vec![Delays::default(); if roll.sinks > 0 { roll.len() } else { 0 }],
            members,
            radio_states,
            arrivals: Vec::new(),
            changes: Vec::new(),
            told: Vec::new(),
            octets: Vec::with_capacity(32),
            has_broadcasts: false,
            payloads: Payloads::default(),
            payload: Vec::new(),
        }
    }

    /// The network starts to work at a station: it listens in all directions.
    pub(crate) fn begin(&mut self, station: StationId, scene: &mut Scene) {
        if self.has(station) {
            self.transceiver(station, Role::Responder, scene).0.tune();
        }
    }

    /// Handles an event of a station's link.
    pub(crate) fn handle(
        &mut self,
        station: StationId,
        event: Event,
        scene: &mut Scene,
        observer: &mut impl Observer,
    ) {
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

    /// Begins a sector sweep of a station. If it broadcasts, the sweep begins once that is over, before the broadcasts
    /// that wait.
    ///
    /// # Errors
    /// If a sweep of the station is under way or waits, it answers one, or it is not in the network.
    pub(crate) fn sweep(&mut self, station: StationId, kind: SweepKind, scene: &mut Scene) -> Result<(), SweepError> {
        if !self.has(station) {
            return Err(SweepError::NoSectors);
        }
        let stack = &mut self.stacks[station.index()];
        if self.sweeps.contains_key(&station) || stack.responder.is_busy() {
            return Err(SweepError::Busy);
        }
        stack.next_sweep = Some(kind);
        scene.offered += 1;
        self.swept[station.index()] += 1;
        self.packets[station.index()].offered += 1;
        self.sweeps.insert(station, Gathered::default());
        self.proceed(station, scene);
        self.tell_carrier(scene);
        Ok(())
    }

    /// The answers to the sweep of a station that has just ended, by station.
    pub(crate) fn take_answers(&mut self, station: StationId) -> Vec<SweepAnswer> {
        let gathered = self.sweeps.remove(&station);
        gathered.map_or_else(Vec::new, |gathered| gathered.answers.into_values().collect())
    }

    /// Number of sectors of the antenna of a station; `None` if it has none.
    pub(crate) fn sectors(&self, station: StationId) -> Option<u8> {
        let antenna = self.antennas.of(self.roll.kind(station));
        (!antenna.is_omnidirectional()).then(|| antenna.sector_count())
    }

    /// The directions of the sectors of robots; `None` if their antenna has no sectors.
    pub(crate) fn robot_sectors(&self) -> Option<SectorTable> {
        let antenna = self.antennas.robots();
        (!antenna.is_omnidirectional()).then(|| antenna.sectors())
    }

    /// A station listens for `span` from now, instead of what is left of an earlier time to listen. Its receiver is on
    /// anyway.
    pub(crate) fn listen(&mut self, station: StationId, span: Duration, scene: &mut Scene) {
        let event = crate::event::link::LinkEvent::Ieee80211ad(Event::ListeningOver);
        let over = scene.after(span, crate::event::Event::Link(station, self.radios.network, event));
        if let Some(earlier) = self.stacks[station.index()].listening_over.replace(over) {
            scene.queue.cancel(earlier);
        }
    }

    /// A station moves differently from now on.
    pub(crate) fn moves(&self, station: StationId, scene: &mut Scene) {
        let motion = &scene.motions[station.index()];
        scene.airs[self.radios.air].moves(self.radios.receiver(station), station, motion);
    }

    /// The packets and the energy of each station.
    pub(crate) fn finish(mut self, now: SimTime) -> NetworkRecord {
        let mut energy = Vec::with_capacity(self.stacks.len());
        for (i, stack) in self.stacks.iter_mut().enumerate() {
            let state = stack.radio.state;
            stack.radio.meter.enter(state, now);
            let is_member = self.members.as_ref().is_none_or(|members| members[i]);
            let spent = stack.radio.meter.spent(&self.radio_states, self.radios.power);
            energy.push(if is_member { spent } else { EnergySpent::default() });
            let Packets { offered, received, lost_collision, lost_channel_access, lost_signal, .. } = self.packets[i];
            let Packets { out_of_range, not_listened, lost_queue, .. } = self.packets[i];
            let ended = received + lost_collision + lost_channel_access + lost_signal + out_of_range + not_listened;
            self.packets[i].pending = offered - ended - lost_queue;
        }
        NetworkRecord { packets: self.packets, energy, deliveries: self.deliveries, delays: self.delays }
    }

    /// Whether a station is in the network.
    fn has(&self, station: StationId) -> bool {
        self.members.as_ref().is_none_or(|members| members[station.index()])
    }

    /// Whether frames of other stations go to the machine that sweeps: that of a robot or sink, or one that is busy.
    fn has_initiator(&self, station: StationId) -> bool {
        !self.roll.is_node(station) || self.stacks[station.index()].initiator.is_busy()
    }

    fn transceiver<'a>(
        &'a mut self,
        station: StationId,
        role: Role,
        scene: &'a mut Scene,
    ) -> (Transceiver<'a>, &'a mut Initiator, &'a mut Responder) {
        let Stack { initiator, responder, radio, first_sectors, .. } = &mut self.stacks[station.index()];
        let transceiver =
            Transceiver { radios: &self.radios, stack: radio, scene, station, role, first_sectors: *first_sectors };
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

/// Number of the first sector of each DMG antenna among those of a sweep.
fn first_sectors(layout: &SectorLayout) -> [u8; 4] {
    let mut first = [0; 4];
    for index in (0..layout.total()).rev() {
        first[usize::from(layout.sector(index).antenna)] = u8::try_from(index).expect("at most 128 sectors");
    }
    first
}

/// What an answer says to the station that swept; `sector` is the number of its sector that the answer names, if it has
/// sectors.
fn read(answer: &Answer, sector: Option<u8>, rssi: Milliwatts, from: StationId) -> SweepAnswer {
    SweepAnswer {
        from,
        sector,
        snr: answer.select_snr.snr(),
        rssi: rssi.to_dbm(),
        node_sector: answer.responder_sector.sector,
    }
}
