//! The state of one station's radio.

use std::time::Duration;

use sextant_channel::{Dbm, Milliwatts};
use sextant_kernel::{EventKey, SimTime, StationId};
use sextant_mac::program::{Event, ProgramRadio, Timers};
use sextant_mac::{EnergyMeter, Phy, RadioState, RadioStates};

use super::packet::{OpenPacket, Outgoing};
use crate::air::Transmission;
use crate::event::link::LinkEvent;
use crate::event::programmed;
use crate::link::books::more_j;
use crate::link::ieee802154::Levels;
use crate::link::radios::Radios;
use crate::scene::Scene;
use crate::service::outcome::Deafness;
use crate::service::report::FrameId;

/// Which frames a radio tells its program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hearing {
    /// Those for its station and for all.
    #[default]
    Own,
    /// Those for other stations too.
    All,
}

/// Whether a radio acknowledges frames for its station that ask for it, a turnaround after their end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Acknowledging {
    /// It does.
    #[default]
    Automatic,
    /// It does not.
    Off,
}

/// What a station has on air.
#[derive(Clone, Copy, Debug)]
pub(super) struct OnAir {
    pub(super) transmission: Transmission,
    pub(super) kind: Kind,
    /// The power with which it is sent.
    pub(super) power: Dbm,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// The frame under way.
    Frame,
    /// An acknowledgement of the frame with this sequence number, for its sender.
    Acknowledgement { sequence: u8, to: StationId },
}

/// The state of one station's radio.
pub(super) struct Stack {
    pub(super) radio: ProgramRadio,
    timers: [Option<EventKey>; Event::COUNT],
    /// Number of its channel among those of the network.
    pub(super) channel: usize,
    /// The power with which it sends.
    pub(super) power: Dbm,
    /// The greatest power with which it can.
    pub(super) most_power: Dbm,
    pub(super) cca_threshold: Milliwatts,
    pub(super) noise: Milliwatts,
    pub(super) hearing: Hearing,
    pub(super) acknowledging: Acknowledging,
    pub(super) meter: EnergyMeter,
    /// How long it sent with each power other than the greatest.
    pub(super) other_powers: Vec<(Dbm, Duration)>,
    /// Energy is counted from then on.
    pub(super) metered_from: SimTime,
    /// Why the air knows the receiver as deaf; `None` if it listens.
    pub(super) deafness: Option<Deafness>,
    pub(super) is_dead: bool,
    /// Start of the look at the channel under way.
    pub(super) assessed_from: SimTime,
    /// The end of the window that a frame holds open.
    pub(super) held_from: Option<SimTime>,
    /// The number in the air of the frame that the receiver is locked on to.
    pub(super) followed: Option<u64>,
    /// The frame that waits for its instant or is on air.
    pub(super) outgoing: Option<Outgoing>,
    pub(super) on_air: Option<OnAir>,
    /// When the last frame began that it sent, ...
    pub(super) sent_from: SimTime,
    /// ... and the packet that it carried.
    pub(super) sent_packet: Option<FrameId>,
    /// The frame that it will acknowledge: sender and sequence number.
    pub(super) answered: Option<(StationId, u8)>,
    /// Sequence number of the newest frame or packet.
    pub(super) sequence: u8,
    /// Number of packets offered so far.
    pub(super) packets: u32,
    /// The packets that are not done, the oldest one first.
    pub(super) open: Vec<OpenPacket>,
    /// Whether packets are traced.
    pub(super) is_traced: bool,
    /// The pending end of a time to listen.
    pub(super) listening_over: Option<EventKey>,
}

impl Stack {
    pub(super) fn new(radio: ProgramRadio, sequence: u8, levels: &Levels) -> Self {
        Self {
            meter: EnergyMeter::new(radio.state(), SimTime::ZERO),
            radio,
            timers: [None; Event::COUNT],
            channel: 0,
            power: levels.tx_power,
            most_power: levels.tx_power,
            cca_threshold: levels.cca_threshold.to_milliwatts(),
            noise: levels.noise_floor.to_milliwatts(),
            hearing: Hearing::default(),
            acknowledging: Acknowledging::default(),
            other_powers: Vec::new(),
            metered_from: SimTime::ZERO,
            deafness: Some(Deafness::Off),
            is_dead: false,
            assessed_from: SimTime::ZERO,
            held_from: None,
            followed: None,
            outgoing: None,
            on_air: None,
            sent_from: SimTime::ZERO,
            sent_packet: None,
            answered: None,
            sequence,
            packets: 0,
            open: Vec::new(),
            is_traced: false,
            listening_over: None,
        }
    }

    /// Its radio, and the timers of that.
    pub(super) fn machine<'a>(
        &'a mut self,
        radios: &'a Radios<Phy>,
        station: StationId,
        scene: &'a mut Scene,
    ) -> (&'a mut ProgramRadio, Clockwork<'a>) {
        (&mut self.radio, Clockwork { keys: &mut self.timers, radios, station, scene })
    }

    /// The timer of an event has run out.
    pub(super) fn forget_timer(&mut self, event: Event) {
        self.timers[event as usize] = None;
    }

    /// Cancels all timers: the radio does nothing any more.
    pub(super) fn cancel_all(&mut self, scene: &mut Scene) {
        let keys = self.timers.iter_mut().chain(std::iter::once(&mut self.listening_over));
        for key in keys.filter_map(Option::take) {
            scene.queue.cancel(key);
        }
    }

    /// Why frames that reach the radio are not worked out.
    pub(super) fn deafness_now(&self) -> Option<Deafness> {
        match self.radio.state() {
            RadioState::Receive => None,
            RadioState::Transmit | RadioState::Turnaround if self.radio.is_sending() => Some(Deafness::Transmitting),
            RadioState::Transmit | RadioState::Turnaround | RadioState::Idle => Some(Deafness::Asleep),
            RadioState::Sleep => Some(Deafness::Off),
        }
    }

    /// The meter is brought to `now`, and with it what was sent with other powers.
    pub(super) fn meter_until(&mut self, now: SimTime) {
        self.meter.enter(self.meter.state(), now);
        if let Some(on_air) = self.on_air
            && on_air.power != self.most_power
        {
            let span = now.saturating_since(on_air.transmission.start().max(self.metered_from));
            self.add_span(on_air.power, span);
            self.metered_from = now;
        }
    }

    fn add_span(&mut self, power: Dbm, span: Duration) {
        match self.other_powers.iter_mut().find(|(other, _)| *other == power) {
            Some((_, sum)) => *sum += span,
            None => self.other_powers.push((power, span)),
        }
    }

    /// Energy that it has used so far, of which the meter knows until `now` (J).
    pub(super) fn energy_j(&mut self, states: &RadioStates, now: SimTime) -> f64 {
        self.meter_until(now);
        self.meter.spent(states, self.most_power).total_j() + more_j(&self.other_powers, states, self.most_power)
    }
}

/// The timers of a radio, in the queue of events.
pub(super) struct Clockwork<'a> {
    keys: &'a mut [Option<EventKey>; Event::COUNT],
    radios: &'a Radios<Phy>,
    station: StationId,
    scene: &'a mut Scene,
}

impl Timers for Clockwork<'_> {
    fn set(&mut self, event: Event, at: SimTime) {
        self.cancel(event);
        let link = LinkEvent::Programmed(programmed::Event::Radio(event));
        self.keys[event as usize] = Some(self.scene.at(at, self.radios.event(self.station, link)));
    }

    fn cancel(&mut self, event: Event) {
        if let Some(key) = self.keys[event as usize].take() {
            self.scene.queue.cancel(key);
        }
    }
}
