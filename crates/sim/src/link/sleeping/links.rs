//! A network whose stations sleep: the links of all of them.

mod dying;
mod frames;
mod offering;
mod port;
mod receiving;
mod sending;
mod waking;

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use sextant_kernel::{EventKey, NodeId, SimTime, StationId};
use sextant_mac::sleep::{Rest, SinksConfig, SleepSettings, Sleeper};
use sextant_mac::{Phy, RadioState};

use super::checks::Checks;
use super::reach::WakeOrder;
use super::settings::Sleeping;
use super::stack::{Stack, Work};
use super::usage::Usage;
use crate::air::Arrival;
use crate::event::link::LinkEvent;
use crate::event::sleeping::Event;
use crate::link::books::{Books, FrameSpans, RadioUse};
use crate::link::clock::Clock;
use crate::link::frame_buffer::FrameBuffer;
use crate::link::ieee802154::{first_sequence, pan};
use crate::link::ledger::Ledger;
use crate::link::links::NetworkLinks;
use crate::link::payloads::Payloads;
use crate::link::radios::Radios;
use crate::link::settings::Placement;
use crate::link::transmitter::Transmitter;
use crate::observer::Observer;
use crate::purpose;
use crate::scene::Scene;
use crate::service::outcome::Deafness;
use crate::service::report::{Destination, FrameId, Payload, SendError};
use crate::service::rhythm::Rhythm;
use crate::service::sleep::SleepUse;
use crate::service::upcall::Upcall;
use crate::station::StationKind;

/// A network whose stations sleep.
pub(crate) struct Links {
    pan: u16,
    channel: u8,
    settings: SleepSettings,
    radios: Radios<Phy>,
    stacks: Vec<Stack>,
    /// Who could hear the frames of each station; `None` as long as it has sent nothing.
    reached: Vec<Option<WakeOrder>>,
    /// Stations that are looked at when a frame begins.
    candidates: Vec<StationId>,
    /// Largest deviation of a clock, as a factor.
    drift: f64,
    /// Whether some station finds a channel busy by signals that it could not receive.
    senses_weak: bool,
    /// Whether the application of a station looks at what is delivered to it.
    hears: Vec<bool>,
    payloads: Payloads,
    ledger: Ledger,
    arrivals: Vec<Arrival>,
    frame: FrameBuffer,
}

impl Links {
    /// The links of all stations of `scene`.
    pub(in crate::link) fn new(settings: &Sleeping, placement: Placement, scene: &Scene) -> Self {
        let Sleeping { radio, sleep, .. } = settings;
        let ledger = Ledger::new(&placement, scene.roll);
        let Placement { network, air, first_receiver, hears, .. } = placement;
        let phy = radio.phy();
        let mut drift: f64 = 0.0;
        let mut stack = |station: StationId| {
            let (ppm, levels) = match scene.roll.kind(station) {
                StationKind::Node(node) => {
                    let node = NodeId::from_index(node);
                    (radio.clock_ppm(scene.seed, network, node), radio.levels(node))
                }
                StationKind::Robot(_) | StationKind::Sink(_) => (0.0, radio.common_levels()),
            };
            drift = drift.max(1e-6 * ppm.abs());
            let rest = match (scene.roll.kind(station), sleep.sinks) {
                (StationKind::Sink(_), SinksConfig::AlwaysOn) => Rest::Listening,
                _ => Rest::Asleep,
            };
            let place = [station.0.into(), network.0.into(), 0];
            let phase = sleep.interval.mul_f64(scene.seed.uniform(purpose::SLEEP, place));
            Stack {
                sleeper: Sleeper::new(*sleep, rest),
                checks: Checks::new(Clock::fast_by(ppm), phase, sleep.interval),
                handled: 0,
                planned: None,
                timer: None,
                is_there: ledger.has(station),
                tx_power: levels.tx_power,
                cca_threshold: levels.cca_threshold.to_milliwatts(),
                usage: Usage::new(RadioState::Sleep, SimTime::ZERO),
                deafness: Some(Deafness::Off),
                waiting: VecDeque::new(),
                work: Work::None,
                on_air: None,
                last_start: SimTime::ZERO,
                answer_start: SimTime::ZERO,
                answered: None,
                phases: BTreeMap::new(),
                sequence: first_sequence(scene.seed, station, network),
                frames: 0,
                draws: 0,
                is_held: false,
                is_traced: false,
            }
        };
        let stacks: Vec<Stack> = scene.roll.stations().map(&mut stack).collect();
        Self {
            pan: pan(network),
            channel: radio.channel(),
            settings: *sleep,
            radios: Radios { network, air, first_receiver, radio: phy },
            reached: vec![None; stacks.len()],
            stacks,
            candidates: Vec::new(),
            drift: 1.01 * drift,
            senses_weak: radio.all_levels().any(|levels| levels.cca_threshold < levels.sensitivity),
            hears,
            payloads: Payloads::default(),
            ledger,
            arrivals: Vec::new(),
            frame: FrameBuffer::new(),
        }
    }

    fn phy(&self) -> Phy {
        self.radios.phy()
    }

    /// When the radio of a station was on by plan; `None` if it is always on, or not there.
    fn rhythm(&self, station: StationId) -> Option<Rhythm> {
        let stack = &self.stacks[station.index()];
        let (first, second) = (stack.checks.start_of(0), stack.checks.start_of(1));
        let length = self.settings.check_length();
        let checks = self.ledger.has(station) && stack.sleeper.rest() == Rest::Asleep;
        checks.then_some(Rhythm::Checks { first, interval: second - first, length })
    }

    fn schedule(&self, station: StationId, span: Duration, event: Event, scene: &mut Scene) -> EventKey {
        self.radios.after(span, station, LinkEvent::Sleeping(event), scene)
    }

    fn schedule_at(&self, station: StationId, at: SimTime, event: Event, scene: &mut Scene) -> EventKey {
        scene.at(at, self.radios.event(station, LinkEvent::Sleeping(event)))
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
        for stack in &mut self.stacks {
            stack.handled = stack.handled.max(stack.checks.next_from(now));
            stack.usage.enter(stack.usage.state(), now);
            stack.usage.restart(now);
        }
    }

    #[inline]
    fn handle(&mut self, station: StationId, event: Event, scene: &mut Scene, observer: &mut impl Observer) {
        match event {
            Event::Station(event) => self.handle_station(station, event, scene, observer),
            Event::CheckDue => self.check(station, scene),
            Event::AttemptDue => self.begin_aimed(station, scene),
            Event::BackoffOver => {
                self.stacks[station.index()].work = Work::None;
                self.go_on(station, scene);
            }
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

    fn transmitter(&self, station: StationId) -> Option<Transmitter> {
        let stack = &self.stacks[station.index()];
        let radio = self.radios.interface(station);
        stack.is_there.then_some(Transmitter { air: self.radios.air, radio, tx_power: stack.tx_power, sectors: None })
    }

    fn listen(&mut self, station: StationId, span: Duration, scene: &mut Scene) {
        // It hears what it wakes up for, and nothing else.
        self.schedule(station, span, Event::ListeningOver, scene);
    }

    fn metered_j(&mut self, station: StationId, scene: &mut Scene) -> f64 {
        if !self.ledger.has(station) {
            return 0.0;
        }
        // A look at a battery changes nothing: a check that is under way can still wake up.
        let (usage, _) = self.with_idle_checks(station, scene.now);
        let (meter, _) = usage.close(scene.now);
        meter.spent(&self.ledger.radio_states, self.stacks[station.index()].tx_power).total_j()
    }

    fn ends_frame(&self, station: StationId, event: Event) -> bool {
        event == Event::Station(sextant_mac::sleep::Event::FrameEnded)
            && self.stacks[station.index()].on_air.is_some()
    }

    fn moves(&self, station: StationId, scene: &mut Scene) {
        self.radios.moves(station, scene);
    }

    fn finish(mut self, now: SimTime) -> Books {
        let mut radios = Vec::with_capacity(self.stacks.len());
        let mut sleep: Vec<SleepUse> = Vec::with_capacity(self.stacks.len());
        let rhythms = (0..self.stacks.len()).map(|i| self.rhythm(StationId::from_index(i))).collect();
        for i in 0..self.stacks.len() {
            let station = StationId::from_index(i);
            self.count_idle(station, now);
            let stack = &mut self.stacks[i];
            let is_there = stack.is_there;
            let (meter, used) = stack.usage.close(self.ledger.died(station).unwrap_or(now));
            let rests_in = match stack.sleeper.rest() {
                Rest::Asleep => RadioState::Sleep,
                Rest::Listening => RadioState::Receive,
            };
            radios.push(RadioUse { meter, tx_power: stack.tx_power, other_powers: Vec::new(), rests_in });
            sleep.push(SleepUse { is_member: is_there, ..used });
        }
        // Nodes that sleep do not rest unseen.
        self.ledger.close(radios, FrameSpans::default()).with_sleep(sleep).with_rhythms(rhythms)
    }
}
