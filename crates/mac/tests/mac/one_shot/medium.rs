//! An ideal medium: stations with one frame each for a robot, no delay, no noise; overlapping frames are lost.

use std::time::Duration;

use sextant_kernel::{EventKey, EventQueue, Rank, SimTime, StationId};
use sextant_mac::csma::{self, Csma, CsmaSettings, OutgoingFrame, Report};
use sextant_mac::frame::{Address, Endpoint, Frame};
use sextant_mac::responder::{self, Responder, Verdict};
use sextant_mac::{Class, Phy, RadioState};

const PHY: Phy = Phy::Oqpsk2450;

/// Result of a CCA that starts exactly when a signal ends.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Tie {
    Idle,
    Busy,
}

/// Who hears whom.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Range {
    Everybody,
    /// The stations hear only the robot, and the robot hears them all.
    RobotOnly,
}

/// All stations get one frame for the robot at time zero.
#[derive(Clone, Copy)]
pub(crate) struct Medium {
    pub(crate) stations: u8,
    pub(crate) mpdu_octets: u8,
    pub(crate) ack_request: bool,
    pub(crate) tie: Tie,
    pub(crate) range: Range,
}

/// Result for one station.
#[derive(Clone, Copy)]
pub(crate) struct Fate {
    /// End of the first copy that the robot received.
    pub(crate) delivered: Option<SimTime>,
    /// Whether the first transmission was received.
    pub(crate) first_copy: bool,
    pub(crate) report: Report,
}

#[derive(Clone, Copy)]
enum Event {
    Mac(usize, csma::Event),
    CcaEnded(usize),
    Robot(responder::Event),
}

struct Signal {
    from: usize,
    sequence: u8,
    is_clean: bool,
}

struct Air {
    medium: Medium,
    now: SimTime,
    queue: EventQueue<Event>,
    signals: Vec<Signal>,
    timers: Vec<Option<EventKey>>,
    /// For stations in a CCA: whether they heard something in it.
    sensing: Vec<Option<bool>>,
}

impl Air {
    fn push(&mut self, span: Duration, class: u8, station: usize, event: Event) -> EventKey {
        self.queue.push(self.now + span, Rank::new(class, StationId::from_index(station)), event)
    }

    fn start(&mut self, from: usize, sequence: u8, is_clean: bool) {
        for other in &mut self.signals {
            other.is_clean = false;
        }
        let is_clean = is_clean && self.signals.is_empty();
        self.signals.push(Signal { from, sequence, is_clean });
        if self.medium.range == Range::Everybody {
            for heard in self.sensing.iter_mut().flatten() {
                *heard = true;
            }
        }
    }

    fn end(&mut self, from: usize) -> Signal {
        let index = self.signals.iter().position(|signal| signal.from == from);
        self.signals.swap_remove(index.expect("what ends has started"))
    }
}

struct StationRadio<'a, D> {
    air: &'a mut Air,
    draw: &'a mut D,
    station: usize,
    robot_is_deaf: bool,
}

impl<D: FnMut(usize, u32) -> u32> csma::Radio for StationRadio<'_, D> {
    fn backoff_periods(&mut self, max_inclusive: u32) -> u32 {
        (self.draw)(self.station, max_inclusive)
    }

    fn after(&mut self, span: Duration, event: csma::Event) {
        let class = match (event, self.air.medium.tie) {
            (csma::Event::BackoffExpired, Tie::Busy) => 0,
            _ => event.class() as u8,
        };
        let key = self.air.push(span, class, self.station, Event::Mac(self.station, event));
        self.air.timers[self.station] = Some(key);
    }

    fn cancel_timer(&mut self) {
        let key = self.air.timers[self.station].take().expect("a timer is set");
        self.air.queue.cancel(key).expect("the timer is pending");
    }

    fn enter(&mut self, _: RadioState) {}

    fn start_cca(&mut self) {
        let is_heard = match self.air.medium.range {
            Range::Everybody => !self.air.signals.is_empty(),
            Range::RobotOnly => false,
        };
        self.air.sensing[self.station] = Some(is_heard);
        self.air.push(PHY.cca(), Class::EndOfCca as u8, self.station, Event::CcaEnded(self.station));
    }

    fn start_transmission(&mut self, frame: OutgoingFrame) {
        self.air.start(self.station, frame.sequence, !self.robot_is_deaf);
        let event = csma::Event::TransmissionEnded;
        let airtime = PHY.airtime(frame.mpdu_octets);
        self.air.push(airtime, event.class() as u8, self.station, Event::Mac(self.station, event));
    }
}

impl responder::Radio for Air {
    fn after(&mut self, span: Duration, event: responder::Event) {
        self.push(span, event.class() as u8, self.sensing.len(), Event::Robot(event));
    }

    fn enter(&mut self, _: RadioState) {}

    fn start_acknowledgement(&mut self, sequence: u8) {
        self.start(self.sensing.len(), sequence, true);
        responder::Radio::after(self, PHY.ack_airtime(), responder::Event::TransmissionEnded);
    }
}

impl Medium {
    /// Stations in range of each other, without acknowledgements.
    pub(crate) const fn new(stations: u8, mpdu_octets: u8) -> Self {
        Self { stations, mpdu_octets, ack_request: false, tie: Tie::Idle, range: Range::Everybody }
    }

    /// Runs until nothing is pending; `draw` gives a station a number from zero to the given maximum.
    pub(crate) fn run(self, mut draw: impl FnMut(usize, u32) -> u32) -> Vec<Fate> {
        let stations = usize::from(self.stations);
        let endpoint = |address| Endpoint { pan: 1, address };
        let to_robot = endpoint(Address::Short(u16::from(self.stations)));
        let mut air = Air {
            medium: self,
            now: SimTime::ZERO,
            queue: EventQueue::new(),
            signals: Vec::new(),
            timers: vec![None; stations],
            sensing: vec![None; stations],
        };
        let mut machines = vec![Csma::new(CsmaSettings::default(), PHY); stations];
        let mut robot = Responder::new(PHY, to_robot.pan, to_robot.address);
        let mut delivered = vec![None; stations];
        let mut copies = vec![0_u32; stations];
        let mut first_copy = vec![false; stations];
        let mut reports = vec![None; stations];

        for (sequence, machine) in (0..self.stations).zip(&mut machines) {
            let frame = OutgoingFrame { mpdu_octets: self.mpdu_octets, ack_request: self.ack_request, sequence };
            let station = usize::from(sequence);
            let mut radio = StationRadio { air: &mut air, draw: &mut draw, station, robot_is_deaf: false };
            machine.start(frame, &mut radio);
        }
        while let Some((now, event)) = air.queue.pop() {
            air.now = now;
            let (station, event) = match event {
                Event::Mac(station, event) => (station, event),
                Event::CcaEnded(station) => {
                    let busy = air.sensing[station].take().expect("a CCA is under way");
                    (station, csma::Event::CcaEnded { busy })
                }
                Event::Robot(event) => {
                    robot.handle(event, &mut air);
                    if event != responder::Event::TransmissionEnded {
                        continue;
                    }
                    let Signal { sequence, is_clean, .. } = air.end(stations);
                    if !is_clean {
                        continue;
                    }
                    (usize::from(sequence), csma::Event::AckReceived { sequence })
                }
            };
            if event == csma::Event::TransmissionEnded {
                let Signal { sequence, is_clean, .. } = air.end(station);
                if is_clean {
                    let from = endpoint(Address::Short(u16::from(sequence)));
                    let frame = Frame::data(sequence, from, to_robot, &[]);
                    let frame = Frame { ack_request: self.ack_request, ..frame };
                    assert_eq!(robot.receive(&frame, &mut air), Verdict::Deliver);
                    if delivered[station].is_none() {
                        delivered[station] = Some(now);
                        first_copy[station] = copies[station] == 0;
                    }
                }
                copies[station] += 1;
            }
            let robot_is_deaf = robot.is_responding();
            let mut radio = StationRadio { air: &mut air, draw: &mut draw, station, robot_is_deaf };
            if let Some(report) = machines[station].handle(event, &mut radio) {
                assert!(reports[station].replace(report).is_none(), "a frame ends once");
            }
        }
        let reports = reports.into_iter().map(|report| report.expect("every frame ends"));
        let fates = reports.zip(delivered).zip(first_copy);
        fates.map(|((report, delivered), first_copy)| Fate { delivered, first_copy, report }).collect()
    }
}
