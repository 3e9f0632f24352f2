//! A network whose programs command the radios: the radios of all its stations.

mod dying;
mod packets;
mod receiving;
mod sending;

use std::time::Duration;

use sextant_kernel::{NodeId, SimTime, StationId};
use sextant_mac::program::{self, News, ProgramRadio, Rest, Timers, Whole};
use sextant_mac::{Phy, RadioState};

use super::settings::Programmed;
use super::stack::{Clockwork, Stack};
use crate::air::{Arrival, ReceiverId, Sense};
use crate::event::link::LinkEvent;
use crate::event::programmed::Event;
use crate::link::books::{Books, FrameSpans, RadioUse};
use crate::link::frame_buffer::FrameBuffer;
use crate::link::ieee802154::{first_sequence, pan};
use crate::link::ledger::Ledger;
use crate::link::links::NetworkLinks;
use crate::link::payloads::Payloads;
use crate::link::radios::Radios;
use crate::link::settings::{Berth, Placement};
use crate::link::transmitter::Transmitter;
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::radio_event::RadioNews;
use crate::service::report::{Destination, FrameId, Payload, SendError};
use crate::service::upcall::Upcall;
use crate::station::StationKind;

/// A network whose programs command the radios.
pub(crate) struct Links {
    pub(super) pan: u16,
    /// The numbers of the channels, ...
    pub(super) channels: Vec<u8>,
    /// ... and the radios of all stations in each of them.
    pub(super) radios: Vec<Radios<Phy>>,
    pub(super) longest_assessment: Duration,
    pub(super) stacks: Vec<Stack>,
    pub(super) payloads: Payloads,
    pub(super) ledger: Ledger,
    arrivals: Vec<Arrival>,
    reached: Vec<(ReceiverId, StationId)>,
    frame: FrameBuffer,
}

impl Links {
    /// The radios of all stations of `scene`.
    pub(in crate::link) fn new(settings: &Programmed, placement: Placement, scene: &Scene) -> Self {
        let Programmed { radio, program, .. } = settings;
        let ledger = Ledger::new(&placement, scene.roll);
        let Placement { network, air, first_receiver, further, .. } = placement;
        let phy = radio.phy();
        let berths = std::iter::once(Berth { air, first_receiver }).chain(further);
        let stack = |station: StationId| {
            let levels = match scene.roll.kind(station) {
                StationKind::Node(node) => radio.levels(NodeId::from_index(node)),
                StationKind::Robot(_) | StationKind::Sink(_) => radio.common_levels(),
            };
            let machine = match scene.roll.kind(station) {
                // A sink listens from the start.
                StationKind::Sink(_) => ProgramRadio::new(program, phy).receiving(),
                StationKind::Node(_) | StationKind::Robot(_) => ProgramRadio::new(program, phy),
            };
            Stack::new(machine, first_sequence(scene.seed, station, network), levels)
        };
        Self {
            pan: pan(network),
            channels: program.channels().to_vec(),
            radios: berths
                .map(|Berth { air, first_receiver }| Radios { network, air, first_receiver, radio: phy })
                .collect(),
            longest_assessment: settings.longest_assessment(),
            stacks: scene.roll.stations().map(stack).collect(),
            payloads: Payloads::default(),
            ledger,
            arrivals: Vec::new(),
            reached: Vec::new(),
            frame: FrameBuffer::new(),
        }
    }

    /// Commands the radio of a station, or tells it of an event, and brings the air in line with what it does then.
    pub(super) fn command<T>(
        &mut self,
        station: StationId,
        scene: &mut Scene,
        command: impl FnOnce(&mut ProgramRadio, SimTime, &mut Clockwork<'_>) -> T,
    ) -> T {
        let now = scene.now;
        let stack = &mut self.stacks[station.index()];
        let (radio, mut timers) = stack.machine(&self.radios[stack.channel], station, scene);
        let answer = command(radio, now, &mut timers);
        self.settle(station, scene);
        answer
    }

    /// Brings meter and receiver of a station in line with the state of its radio.
    pub(super) fn settle(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        stack.meter.enter(stack.radio.state(), scene.now);
        let deafness = stack.deafness_now();
        if deafness.is_some() {
            stack.followed = None;
        }
        self.radios[stack.channel].tune(station, deafness, &mut stack.deafness, scene);
    }

    /// Handles an event of the radio of a station.
    fn handle_radio(
        &mut self,
        station: StationId,
        event: program::Event,
        scene: &mut Scene,
        observer: &mut impl Observer,
    ) {
        self.stacks[station.index()].forget_timer(event);
        if event == program::Event::WindowOver && self.hold_window(station, scene) {
            return;
        }
        if matches!(event, program::Event::FrameEnded | program::Event::AcknowledgementEnded) {
            self.end_on_air(station, scene, observer);
        }
        let news = self.command(station, scene, |radio, now, timers| radio.handle(event, now, timers));
        let told = match news {
            None | Some(News::AcknowledgementSent) => return,
            Some(News::FrameBegins) => return self.begin_frame(station, scene),
            Some(News::AcknowledgementBegins) => return self.begin_acknowledgement(station, scene),
            Some(News::Ready) => RadioNews::Ready,
            Some(News::WindowOver) => RadioNews::WindowOver,
            Some(News::Unacknowledged) => RadioNews::Unacknowledged,
            Some(News::Sent) => RadioNews::Sent { start: self.stacks[station.index()].sent_from },
            Some(News::Assessed(whole)) => self.assessed(station, whole, scene),
        };
        scene.upcalls.push(Upcall::Radio { station, news: told });
    }

    /// Holds a window open that is over, if the receiver follows a frame that began in it. Returns whether it does.
    fn hold_window(&mut self, station: StationId, scene: &mut Scene) -> bool {
        let (now, stack) = (scene.now, &mut self.stacks[station.index()]);
        let radios = &self.radios[stack.channel];
        let end = *stack.held_from.get_or_insert(now);
        let followed = match stack.radio.state() {
            RadioState::Receive if !stack.radio.is_awaiting() => {
                scene.airs[radios.air].followed_until(now, radios.receiver(station), end)
            }
            _ => None,
        };
        match followed.filter(|&until| until > now) {
            Some(until) => {
                let (_, mut timers) = stack.machine(radios, station, scene);
                timers.set(program::Event::WindowOver, until);
                true
            }
            None => {
                stack.held_from = None;
                false
            }
        }
    }

    /// What a look at the channel, which is over now, has found.
    fn assessed(&mut self, station: StationId, whole: Whole, scene: &mut Scene) -> RadioNews {
        let stack = &self.stacks[station.index()];
        let radios = &self.radios[stack.channel];
        let sense = Sense {
            radio: radios.interface(station),
            place: scene.place(station),
            from: stack.assessed_from,
            to: scene.now,
            threshold: stack.cca_threshold,
        };
        let air = &mut scene.airs[radios.air];
        let busy = whole == Whole::Broken || air.is_busy(&sense);
        let mut power = air.mean_power(&sense);
        power += stack.noise;
        self.end_assessment(station, busy);
        RadioNews::Assessed { busy, power: power.to_dbm() }
    }

    /// Whether a station is in the network and alive.
    pub(super) fn has(&self, station: StationId) -> bool {
        self.ledger.has(station) && !self.stacks[station.index()].is_dead
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
        if self.ledger.has(station) {
            self.settle(station, scene);
        }
    }

    fn restart_meters(&mut self, now: SimTime) {
        for stack in &mut self.stacks {
            stack.meter.restart(now);
            stack.other_powers.clear();
            stack.metered_from = now;
        }
    }

    fn handle(&mut self, station: StationId, event: Event, scene: &mut Scene, observer: &mut impl Observer) {
        match event {
            Event::Radio(event) => self.handle_radio(station, event, scene, observer),
            Event::Delimited => self.end_delimiter(station, scene),
            Event::ListeningOver => {
                self.stacks[station.index()].listening_over = None;
                self.command(station, scene, |radio, now, timers| radio.rest(Rest::Off, now, timers));
                scene.upcalls.push(Upcall::Listened { station });
            }
        }
    }

    fn offer(
        &mut self,
        _station: StationId,
        _to: Destination,
        _payload: Payload<'_>,
        _scene: &mut Scene,
    ) -> Result<FrameId, SendError> {
        Err(SendError::NoChannelAccess)
    }

    fn transmitter(&self, station: StationId) -> Option<Transmitter> {
        let stack = &self.stacks[station.index()];
        let radios = &self.radios[stack.channel];
        let radio = radios.interface(station);
        self.has(station).then_some(Transmitter { air: radios.air, radio, tx_power: stack.power, sectors: None })
    }

    fn listen(&mut self, station: StationId, span: Duration, scene: &mut Scene) {
        let over = LinkEvent::Programmed(Event::ListeningOver);
        let over = self.radios[0].after(span, station, over, scene);
        if let Some(earlier) = self.stacks[station.index()].listening_over.replace(over) {
            scene.queue.cancel(earlier);
        }
        self.command(station, scene, |radio, now, timers| radio.rest(Rest::Receive, now, timers));
    }

    fn metered_j(&mut self, station: StationId, scene: &mut Scene) -> f64 {
        if self.ledger.has(station) { self.energy_j(station, scene.now) } else { 0.0 }
    }

    fn ends_frame(&self, station: StationId, event: Event) -> bool {
        let ends = match event {
            Event::Radio(event) => {
                matches!(event, program::Event::FrameEnded | program::Event::AcknowledgementEnded)
            }
            Event::Delimited => true,
            Event::ListeningOver => false,
        };
        ends && self.stacks[station.index()].on_air.is_some()
    }

    fn moves(&self, station: StationId, scene: &mut Scene) {
        self.radios[self.stacks[station.index()].channel].moves(station, scene);
    }

    fn finish(mut self, now: SimTime) -> Books {
        let mut radios = Vec::with_capacity(self.stacks.len());
        for i in 0..self.stacks.len() {
            let stack = &mut self.stacks[i];
            if self.ledger.died(StationId::from_index(i)).is_none() {
                stack.meter_until(now);
            }
            radios.push(RadioUse {
                meter: stack.meter,
                tx_power: stack.most_power,
                other_powers: std::mem::take(&mut stack.other_powers),
                rests_in: RadioState::Sleep,
            });
        }
        // Nodes with programs do not rest unseen.
        self.ledger.close(radios, FrameSpans::default())
    }
}
