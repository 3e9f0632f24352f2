//! A network with time-slotted channel hopping: the links of all its stations.

mod acknowledging;
mod agreeing;
mod dying;
mod frames;
mod listeners;
mod offering;
mod receiving;
mod sending;
mod synchronising;

use std::time::Duration;

use sextant_kernel::{EventKey, NodeId, SimTime, StationId};
use sextant_mac::tsch::{Sender, SlotClock, TschSettings};
use sextant_mac::{Phy, RadioState};

use super::plan::Plan;
use super::settings::Tsch;
use super::stack::{Membership, Planned, Stack};
use super::usage::Usage;
use crate::air::Arrival;
use crate::event::link::LinkEvent;
use crate::event::tsch::Event;
use crate::link::books::{Books, FrameSpans, RadioUse};
use crate::link::frame_buffer::FrameBuffer;
use crate::link::ieee802154::{first_sequence, pan};
use crate::link::ledger::Ledger;
use crate::link::links::NetworkLinks;
use crate::link::payloads::Payloads;
use crate::link::radios::Radios;
use crate::link::settings::{Berth, Placement};
use crate::link::transmitter::Transmitter;
use crate::link::tsch::cell_history::CellHistory;
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::outcome::Deafness;
use crate::service::report::{Destination, FrameId, Payload, SendError};
use crate::service::rhythm::Rhythm;
use crate::service::slots::SlotUse;
use crate::service::upcall::Upcall;
use crate::station::StationKind;
use listeners::Listeners;

/// A network with time-slotted channel hopping.
pub(crate) struct Links {
    pan: u16,
    settings: TschSettings,
    plan: Plan,
    /// The radios of all stations in each channel, by place in the sequence.
    radios: Vec<Radios<Phy>>,
    stacks: Vec<Stack>,
    listeners: Listeners,
    /// Whether the application of a station looks at what is delivered to it.
    hears: Vec<bool>,
    /// Whether clocks may drift, so that they are corrected and looked after.
    has_drift: bool,
    payloads: Payloads,
    ledger: Ledger,
    arrivals: Vec<Arrival>,
    frame: FrameBuffer,
}

impl Links {
    /// The links of all stations of `scene`.
    pub(in crate::link) fn new(settings: &Tsch, placement: Placement, scene: &Scene) -> Self {
        let Tsch { radio, tsch, plan, .. } = settings;
        let ledger = Ledger::new(&placement, scene.roll);
        let Placement { network, air, first_receiver, further, hears, .. } = placement;
        let phy = radio.phy();
        let length = tsch.timeslot.length();
        let stack = |station: StationId| {
            let (ppm, levels) = match scene.roll.kind(station) {
                StationKind::Node(node) => {
                    let node = NodeId::from_index(node);
                    (radio.clock_ppm(scene.seed, network, node), radio.levels(node))
                }
                StationKind::Robot(_) | StationKind::Sink(_) => (0.0, radio.common_levels()),
            };
            let clock = SlotClock::new(length, ppm);
            let time_source = plan.time_sources.get(station.index()).copied().flatten();
            Stack {
                usage: Usage::new(SimTime::ZERO, clock.next_from(SimTime::ZERO)),
                clock,
                tx_power: levels.tx_power,
                membership: if ledger.has(station) { Membership::Joined } else { Membership::Out },
                time_source,
                join_metric: 0,
                corrected: SimTime::ZERO,
                schedule: plan.schedule(tsch, station, time_source),
                history: CellHistory::default(),
                parent: time_source,
                msf: plan.msf(tsch, station),
                agreement: None,
                sender: Sender::new(tsch.queue_frames.into(), tsch.max_retries, tsch.exponents),
                planned: None,
                used: None,
                sending: None,
                listening: None,
                answer: None,
                deafness: Some(Deafness::Off),
                keeps_alive: false,
                beacons: false,
                check: None,
                sequence: first_sequence(scene.seed, station, network),
                frames: 0,
                backoffs: 0,
                draws: 0,
                is_traced: false,
            }
        };
        let mut stacks: Vec<Stack> = scene.roll.stations().map(stack).collect();
        let mut listeners = Listeners::new(tsch.hopping.channels().len());
        for (station, stack) in scene.roll.stations().zip(&mut stacks).filter(|(_, stack)| stack.is_joined()) {
            listeners.add(station, &stack.schedule);
            stack.history.change(stack.schedule.cells(), SimTime::ZERO);
        }
        let berths = std::iter::once(Berth { air, first_receiver }).chain(further);
        Self {
            pan: pan(network),
            settings: tsch.clone(),
            plan: plan.clone(),
            radios: berths
                .map(|Berth { air, first_receiver }| Radios { network, air, first_receiver, radio: phy })
                .collect(),
            stacks,
            listeners,
            hears,
            has_drift: radio.has_drift(),
            payloads: Payloads::default(),
            ledger,
            arrivals: Vec::new(),
            frame: FrameBuffer::new(),
        }
    }

    fn phy(&self) -> Phy {
        self.radios[0].phy()
    }

    fn schedule(&self, station: StationId, span: Duration, event: Event, scene: &mut Scene) -> EventKey {
        self.radios[0].after(span, station, LinkEvent::Tsch(event), scene)
    }

    /// Brings the receiver of a station in a channel in line with why it is deaf.
    fn tune(&mut self, station: StationId, place: usize, deafness: Option<Deafness>, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        self.radios[place].tune(station, deafness, &mut stack.deafness, scene);
    }

    /// Plans the next slot in which a station sends: what it has to send, or its clock, has changed.
    fn replan(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        let chance = if stack.is_joined() && stack.sending.is_none() {
            let next = stack.clock.next_from(scene.now);
            let from = stack.used.map_or(next, |used| next.max(used.next()));
            stack.sender.next(&stack.schedule, from)
        } else {
            None
        };
        let at = chance.map(|chance| stack.clock.start_of(chance.asn) + self.settings.timeslot.frame_begins());
        if let (Some(planned), Some(chance), Some(at)) = (&mut stack.planned, chance, at)
            && planned.at == at
        {
            planned.chance = chance;
            return;
        }
        if let Some(planned) = stack.planned.take() {
            scene.queue.cancel(planned.key);
        }
        if let (Some(chance), Some(at)) = (chance, at) {
            let event = self.radios[0].event(station, LinkEvent::Tsch(Event::FrameStarts));
            let key = scene.at(at, event);
            self.stacks[station.index()].planned = Some(Planned { chance, at, key });
        }
    }

    /// When the radio of a station was on by plan; `None` if it never followed the schedule.
    fn rhythm(&mut self, station: StationId) -> Option<Rhythm> {
        let cells = std::mem::take(&mut self.stacks[station.index()].history).into_spans();
        let slot = self.settings.timeslot.length();
        (!cells.is_empty()).then_some(Rhythm::Cells { slot, cells })
    }

    /// Counts the slots of a station up to now in which it listened and nobody sent.
    fn count_idle(&mut self, station: StationId, now: SimTime) {
        let stack = &mut self.stacks[station.index()];
        if stack.is_joined() {
            let until = stack.clock.next_from(now);
            stack.usage.count_idle(&stack.schedule, until, self.settings.timeslot.window());
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
        self.stacks.iter_mut().for_each(|stack| stack.is_traced = true);
    }

    fn begin(&mut self, station: StationId, scene: &mut Scene) {
        self.begin_station(station, scene);
    }

    fn restart_meters(&mut self, now: SimTime) {
        for i in 0..self.stacks.len() {
            self.restart_agreement(StationId::from_index(i), now);
            let stack = &mut self.stacks[i];
            let from = stack.clock.next_from(now);
            stack.usage.restart(now, from);
        }
    }

    #[inline]
    fn handle(&mut self, station: StationId, event: Event, scene: &mut Scene, observer: &mut impl Observer) {
        match event {
            Event::FrameStarts => self.start_frame(station, scene),
            Event::FrameEnds => self.end_frame(station, scene, observer),
            Event::AckStarts => self.start_acknowledgement(station, scene),
            Event::AckEnds => self.end_acknowledgement(station, scene, observer),
            Event::AckMissed => self.miss_acknowledgement(station, scene),
            Event::BeaconDue => self.offer_beacon(station, scene),
            Event::SynchronisationChecked => self.check_synchronisation(station, scene),
            Event::ChannelChanged => self.change_channel(station, scene),
            Event::CellsDue => self.act_on_cells(station, scene),
            Event::ListeningOver => scene.upcalls.push(Upcall::Listened { station }),
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

    fn take_time_from(&mut self, station: StationId, parent: StationId) {
        self.change_time_source(station, parent);
    }

    fn follow(&mut self, station: StationId, parent: Option<StationId>, scene: &mut Scene) {
        self.change_parent(station, parent, scene);
    }

    fn transmitter(&self, station: StationId) -> Option<Transmitter> {
        let stack = &self.stacks[station.index()];
        let radio = self.radios[0].interface(station);
        let is_there = !matches!(stack.membership, Membership::Out);
        is_there.then_some(Transmitter { air: self.radios[0].air, radio, tx_power: stack.tx_power, sectors: None })
    }

    fn listen(&mut self, station: StationId, span: Duration, scene: &mut Scene) {
        // It hears what its schedule lets it hear, and nothing else.
        self.schedule(station, span, Event::ListeningOver, scene);
    }

    fn metered_j(&mut self, station: StationId, scene: &mut Scene) -> f64 {
        if !self.ledger.has(station) {
            return 0.0;
        }
        self.count_idle(station, scene.now);
        let stack = &mut self.stacks[station.index()];
        if stack.usage.count_scan(scene.now) {
            stack.usage.begin_scan(scene.now);
        }
        let (meter, _) = stack.usage.close(scene.now);
        meter.spent(&self.ledger.radio_states, stack.tx_power).total_j()
    }

    fn ends_frame(&self, station: StationId, event: Event) -> bool {
        matches!(event, Event::FrameEnds | Event::AckEnds) && self.stacks[station.index()].is_on_air()
    }

    fn moves(&self, station: StationId, scene: &mut Scene) {
        self.radios.iter().for_each(|radios| radios.moves(station, scene));
    }

    fn finish(mut self, now: SimTime) -> Books {
        let mut radios = Vec::with_capacity(self.stacks.len());
        let mut slots: Vec<SlotUse> = Vec::with_capacity(self.stacks.len());
        let rhythms = (0..self.stacks.len()).map(|i| self.rhythm(StationId::from_index(i))).collect();
        for i in 0..self.stacks.len() {
            let station = StationId::from_index(i);
            self.count_idle(station, now);
            let stack = &mut self.stacks[i];
            stack.usage.count_scan(now);
            stack.usage.slots.is_member = stack.is_joined();
            let ended = self.ledger.died(station).unwrap_or(now);
            let until = stack.clock.next_from(ended);
            stack.usage.slots.msf = stack.msf.as_mut().map(|msf| msf.used(until));
            let (meter, used) = stack.usage.close(ended);
            let (tx_power, rests_in) = (stack.tx_power, RadioState::Sleep);
            radios.push(RadioUse { meter, tx_power, other_powers: Vec::new(), rests_in });
            slots.push(used);
        }
        // Nodes with slots do not rest unseen.
        self.ledger.close(radios, FrameSpans::default()).with_slots(slots).with_rhythms(rhythms)
    }
}
