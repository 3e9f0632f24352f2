//! An ideal medium in one contention access period: stations that hear each other, no delay, no noise; overlapping
//! frames are lost.

use std::time::Duration;

use sextant_kernel::{EventKey, EventQueue, Rank, SimTime, StationId};
use sextant_mac::csma::{self, CsmaSettings, OutgoingFrame, Report};
use sextant_mac::slotted::{AccessWindow, SlottedCsma};
use sextant_mac::superframe::Contention;
use sextant_mac::{Class, Phy, RadioState};

const PHY: Phy = Phy::Oqpsk2450;
/// Longer than any run.
const END: SimTime = SimTime::from_nanos(3_600_000_000_000);

/// Stations with frames of one size, all ready at boundary 0.
#[derive(Clone, Copy)]
pub(crate) struct Medium {
    pub(crate) stations: usize,
    pub(crate) mpdu_octets: u8,
}

/// Result for the frame of one station.
#[derive(Clone, Copy)]
pub(crate) struct Fate {
    pub(crate) received: bool,
    /// When the station finished the frame (ms).
    pub(crate) end_ms: f64,
    pub(crate) report: Report,
}

/// Counts over a batch of slots.
#[derive(Clone, Copy, Default)]
pub(crate) struct Accounts {
    pub(crate) slots: f64,
    pub(crate) first_ccas: f64,
    pub(crate) first_busy: f64,
    pub(crate) second_ccas: f64,
    pub(crate) second_busy: f64,
    pub(crate) received: f64,
    pub(crate) collided: f64,
    pub(crate) failed: f64,
}

struct Signal {
    from: usize,
    is_clean: bool,
}

/// An event that is due at a station.
#[derive(Clone, Copy)]
enum Due {
    Mac(csma::Event),
    /// Its CCA is over; the result is stored in the air.
    CcaEnded,
}

/// The shared state of the stations.
struct Air<D> {
    now: SimTime,
    queue: EventQueue<(usize, Due)>,
    signals: Vec<Signal>,
    timers: Vec<Option<EventKey>>,
    /// For stations in a CCA: whether they heard something in it.
    sensing: Vec<Option<bool>>,
    draw: D,
}

impl<D> Air<D> {
    fn push(&mut self, span: Duration, station: usize, event: csma::Event) -> EventKey {
        self.push_due(span, event.class(), station, Due::Mac(event))
    }

    fn push_due(&mut self, span: Duration, class: Class, station: usize, due: Due) -> EventKey {
        let rank = Rank::new(class as u8, StationId::from_index(station));
        self.queue.push(self.now + span, rank, (station, due))
    }

    /// The event that is due at a station.
    fn event(&mut self, station: usize, due: Due) -> csma::Event {
        match due {
            Due::Mac(event) => event,
            Due::CcaEnded => {
                csma::Event::CcaEnded { busy: self.sensing[station].take().expect("a CCA is under way") }
            }
        }
    }

    /// Ends the frame of a station; returns whether no other frame disturbed it.
    fn end(&mut self, station: usize) -> bool {
        let at = self.signals.iter().position(|signal| signal.from == station).expect("it is on air");
        self.signals.swap_remove(at).is_clean
    }
}

struct StationRadio<'a, D> {
    air: &'a mut Air<D>,
    station: usize,
}

impl<D: FnMut(usize, u32) -> u32> csma::Radio for StationRadio<'_, D> {
    fn backoff_periods(&mut self, max_inclusive: u32) -> u32 {
        (self.air.draw)(self.station, max_inclusive)
    }

    fn after(&mut self, span: Duration, event: csma::Event) {
        self.air.timers[self.station] = Some(self.air.push(span, self.station, event));
    }

    fn cancel_timer(&mut self) {
        if let Some(key) = self.air.timers[self.station].take() {
            self.air.queue.cancel(key);
        }
    }

    fn enter(&mut self, _: RadioState) {}

    fn start_cca(&mut self) {
        self.air.sensing[self.station] = Some(!self.air.signals.is_empty());
        self.air.push_due(PHY.cca(), Class::EndOfCca, self.station, Due::CcaEnded);
    }

    fn start_transmission(&mut self, frame: OutgoingFrame) {
        for sensed in self.air.sensing.iter_mut().flatten() {
            *sensed = true;
        }
        for other in &mut self.air.signals {
            other.is_clean = false;
        }
        let is_clean = self.air.signals.is_empty();
        self.air.signals.push(Signal { from: self.station, is_clean });
        self.air.push(PHY.airtime(frame.mpdu_octets), self.station, csma::Event::TransmissionEnded);
    }
}

impl Medium {
    fn air<D: FnMut(usize, u32) -> u32>(&self, draw: D) -> Air<D> {
        Air {
            now: SimTime::ZERO,
            queue: EventQueue::new(),
            signals: Vec::new(),
            timers: vec![None; self.stations],
            sensing: vec![None; self.stations],
            draw,
        }
    }

    fn frame(&self) -> OutgoingFrame {
        OutgoingFrame { mpdu_octets: self.mpdu_octets, ack_request: false, sequence: 0 }
    }

    /// A station that gets its frame now.
    fn station<D: FnMut(usize, u32) -> u32>(&self, air: &mut Air<D>, station: usize) -> SlottedCsma {
        let now = air.now;
        let mut radio = StationRadio { air, station };
        let mut machine = SlottedCsma::new(CsmaSettings::default(), PHY);
        let window = AccessWindow::Contention(Contention::new(PHY, SimTime::ZERO, END));
        machine.open(now, window, &mut radio);
        machine.start(now, self.frame(), &mut radio);
        machine
    }

    /// Each station has one frame; `draw` gives a station a number from zero to the given maximum.
    pub(crate) fn one_shot(&self, draw: impl FnMut(usize, u32) -> u32) -> Vec<Fate> {
        let mut air = self.air(draw);
        let mut machines: Vec<_> = (0..self.stations).map(|station| self.station(&mut air, station)).collect();
        let mut fates = vec![None; self.stations];
        while let Some((now, (station, due))) = air.queue.pop() {
            air.now = now;
            let event = air.event(station, due);
            let received = event == csma::Event::TransmissionEnded && air.end(station);
            let mut radio = StationRadio { air: &mut air, station };
            if let Some(report) = machines[station].handle(now, event, &mut radio) {
                fates[station] = Some(Fate { received, end_ms: 1e3 * now.as_secs_f64(), report });
            }
        }
        fates.into_iter().map(|fate| fate.expect("every frame ends")).collect()
    }

    /// A new station replaces each station that has finished its frame, at once and without interframe spacing.
    /// Returns the accounts of `batches` batches of `slots` backoff periods; the first batch is discarded.
    pub(crate) fn saturated(&self, batches: usize, slots: u64, draw: impl FnMut(usize, u32) -> u32) -> Vec<Accounts> {
        let mut air = self.air(draw);
        let mut machines: Vec<_> = (0..self.stations).map(|station| self.station(&mut air, station)).collect();
        let mut accounts = vec![Accounts { slots: slots as f64, ..Accounts::default() }; batches + 1];
        let mut is_second = vec![false; self.stations];
        let batch_ns = slots * u64::try_from(PHY.backoff_period().as_nanos()).expect("short");
        while let Some((now, (station, due))) = air.queue.pop() {
            let batch = usize::try_from(now.as_nanos() / batch_ns).expect("few batches");
            let Some(account) = accounts.get_mut(batch) else { break };
            air.now = now;
            let mut received = false;
            let event = air.event(station, due);
            match event {
                csma::Event::CcaEnded { busy } => {
                    let (ccas, busy_ccas) = if is_second[station] {
                        (&mut account.second_ccas, &mut account.second_busy)
                    } else {
                        (&mut account.first_ccas, &mut account.first_busy)
                    };
                    *ccas += 1.0;
                    *busy_ccas += f64::from(u8::from(busy));
                    is_second[station] = !busy && !is_second[station];
                }
                csma::Event::TransmissionEnded => received = air.end(station),
                _ => {}
            }
            let report = machines[station].handle(now, event, &mut StationRadio { air: &mut air, station });
            if let Some(report) = report {
                *match (report.transmissions, received) {
                    (0, _) => &mut account.failed,
                    (_, true) => &mut account.received,
                    (_, false) => &mut account.collided,
                } += 1.0;
                csma::Radio::cancel_timer(&mut StationRadio { air: &mut air, station });
                machines[station] = self.station(&mut air, station);
            }
        }
        accounts.split_off(1)
    }
}
