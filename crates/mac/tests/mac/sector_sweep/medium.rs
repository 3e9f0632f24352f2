//! An ideal medium: one robot that sweeps and sensors that all hear it and each other, no delay, no noise, perfect
//! carrier sense; frames that overlap are lost.

use std::time::Duration;

use sextant_channel::Db;
use sextant_kernel::{EventKey, EventQueue, Rank, SimTime, StationId};
use sextant_mac::RadioState;
use sextant_mac::dmg::{
    Access, Aim, Event, Initiator, MacAddress, Radio, Responder, ResponderOutcome, ResponderReport, SectorLayout,
    SweepFrame, SweepPurpose, SweepSettings,
};

/// Sectors of a sensor.
const SECTORS: u8 = 8;

/// A robot (station 0) and sensors (stations 1 to N).
pub(crate) struct Medium {
    robot: Initiator,
    sensors: Vec<Responder>,
    air: Air,
}

struct Signal {
    from: usize,
    frame: SweepFrame,
    is_clean: bool,
}

struct Air {
    now: SimTime,
    queue: EventQueue<(usize, Event)>,
    timers: Vec<Option<EventKey>>,
    signals: Vec<Signal>,
    /// Whether a signal has started of which the stations do not know yet.
    started: bool,
    /// Whether each station hears a signal of another.
    is_busy: Vec<bool>,
}

struct Port<'a, D> {
    air: &'a mut Air,
    station: usize,
    draw: &'a mut D,
}

impl Air {
    fn push(&mut self, span: Duration, station: usize, event: Event) -> EventKey {
        let rank = Rank::new(event.class() as u8, StationId::from_index(station));
        self.queue.push(self.now + span, rank, (station, event))
    }
}

impl<D: FnMut(u32) -> u32> Radio for Port<'_, D> {
    fn slots(&mut self, max_inclusive: u32) -> u32 {
        (self.draw)(max_inclusive)
    }

    fn after(&mut self, span: Duration, event: Event) {
        self.air.timers[self.station] = Some(self.air.push(span, self.station, event));
    }

    fn cancel_timer(&mut self) {
        let key = self.air.timers[self.station].take().expect("a timer is set");
        self.air.queue.cancel(key).expect("the timer is pending");
    }

    fn enter(&mut self, _: RadioState) {}

    fn aim(&mut self, _: Aim) {}

    fn start_transmission(&mut self, frame: SweepFrame, airtime: Duration) {
        let air = &mut *self.air;
        for other in &mut air.signals {
            other.is_clean = false;
        }
        air.signals.push(Signal { from: self.station, frame, is_clean: air.signals.is_empty() });
        air.push(airtime, self.station, Event::TransmissionEnded);
        air.started = true;
    }
}

/// What happened in a sweep and its answers.
#[derive(Default)]
pub(crate) struct Round {
    /// Number of sensors of which the robot decoded a frame.
    pub(crate) answered: usize,
    /// From MBIFS after the sweep to the last end of an answer.
    pub(crate) span: Duration,
    /// First start of an answer, from MBIFS after the sweep.
    pub(crate) first_start: Option<Duration>,
    /// Indices of the sensors that got feedback.
    pub(crate) trained: Vec<usize>,
    /// MBIFS after the sweep.
    opens: Option<SimTime>,
    is_over: bool,
}

/// What a station is told.
#[derive(Clone, Copy)]
enum RememberingObserver {
    Event(Event),
    Frame(SweepFrame),
}

impl Medium {
    /// A robot with one sector and `sensors` sensors with eight sectors.
    pub(crate) fn new(sensors: usize, settings: SweepSettings) -> Self {
        let layout = |sectors| SectorLayout::new(&[sectors]).expect("a good layout");
        let address = |station| MacAddress::of(StationId::from_index(station));
        let sensor =
            |station| Responder::new(address(station), settings.answers(layout(SECTORS)).expect("the sectors fit"));
        Self {
            robot: Initiator::new(address(0), layout(1), settings),
            sensors: (1..=sensors).map(sensor).collect(),
            air: Air {
                now: SimTime::ZERO,
                queue: EventQueue::new(),
                timers: vec![None; sensors + 1],
                signals: Vec::new(),
                started: false,
                is_busy: vec![false; sensors + 1],
            },
        }
    }

    /// One sweep of the robot, to which the sensors in `ready` listen, and their answers.
    pub(crate) fn round(&mut self, ready: &[bool], draw: &mut impl FnMut(u32) -> u32) -> Round {
        let mut round = Round::default();
        let air = &mut self.air;
        self.robot.start(air.now, SweepPurpose::Gather, Access::AtOnce, &mut Port { air, station: 0, draw });
        self.sense(&mut round, draw);
        while let Some((now, (station, event))) = self.air.queue.pop() {
            self.air.now = now;
            let mut ended = None;
            if event == Event::TransmissionEnded {
                let index = self.air.signals.iter().position(|signal| signal.from == station);
                ended = Some(self.air.signals.swap_remove(index.expect("what ends has started")));
                if station == 0 {
                    round.opens.get_or_insert(now + Duration::from_micros(9));
                }
            } else {
                self.air.timers[station] = None;
            }
            self.tell(station, RememberingObserver::Event(event), &mut round, draw);
            if let Some(signal) = ended {
                if signal.is_clean {
                    self.deliver(&signal, ready, &mut round, draw);
                }
                self.sense(&mut round, draw);
            } else if self.air.started {
                self.sense(&mut round, draw);
            }
        }
        assert!(round.is_over, "a sweep ends");
        round.answered = self.robot.answers().len();
        round
    }

    fn tell(
        &mut self,
        station: usize,
        told: RememberingObserver,
        round: &mut Round,
        draw: &mut impl FnMut(u32) -> u32,
    ) {
        let now = self.air.now;
        let before = self.air.signals.len();
        let port = &mut Port { air: &mut self.air, station, draw };
        if station == 0 {
            let report = match told {
                RememberingObserver::Event(event) => self.robot.handle(now, event, port),
                RememberingObserver::Frame(frame) => self.robot.receive(now, &frame, Db(10.0), port),
            };
            round.is_over |= report.is_some();
            return;
        }
        let sensor = &mut self.sensors[station - 1];
        let report = match told {
            RememberingObserver::Event(event) => sensor.handle(now, event, port),
            RememberingObserver::Frame(frame) => sensor.receive(now, &frame, Db(10.0), port),
        };
        let Some(opens) = round.opens else { return };
        if self.air.signals.len() > before {
            round.first_start.get_or_insert_with(|| now - opens);
        }
        match report {
            Some(ResponderReport::Answered { outcome: ResponderOutcome::Sent, .. }) => round.span = now - opens,
            Some(ResponderReport::Answered { outcome: ResponderOutcome::Trained(_), .. }) => {
                round.span = now - opens;
                round.trained.push(station - 1);
            }
            _ => {}
        }
    }

    /// The frame reaches all stations that do not transmit.
    fn deliver(&mut self, signal: &Signal, ready: &[bool], round: &mut Round, draw: &mut impl FnMut(u32) -> u32) {
        for station in 0..=self.sensors.len() {
            let is_deaf = station == signal.from || self.air.signals.iter().any(|other| other.from == station);
            let listens = station == 0 || ready[station - 1];
            if listens && !is_deaf {
                self.tell(station, RememberingObserver::Frame(signal.frame), round, draw);
            }
        }
    }

    /// Tells each station whether the channel became busy or idle.
    fn sense(&mut self, round: &mut Round, draw: &mut impl FnMut(u32) -> u32) {
        self.air.started = false;
        for station in 0..=self.sensors.len() {
            let is_busy = self.air.signals.iter().any(|signal| signal.from != station);
            if is_busy != self.air.is_busy[station] {
                self.air.is_busy[station] = is_busy;
                let event = if is_busy { Event::CarrierBusy } else { Event::CarrierIdle };
                self.tell(station, RememberingObserver::Event(event), round, draw);
            }
        }
    }
}
