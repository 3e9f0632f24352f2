//! A radio that follows a script, for tests of the machines.

use std::collections::VecDeque;
use std::time::Duration;

use sextant_kernel::{SimTime, StationId};

use super::frame::SweepFrame;
use super::port::{Aim, Event, Radio};
use super::timing::SSW_AIRTIME;
use super::{MacAddress, SectorFeedback, SectorLayout, SnrReport, SweepBody, TxSector};
use crate::{Class, EnergyMeter, RadioState};

pub(super) const ROBOT: MacAddress = MacAddress::of(StationId(1));
pub(super) const SENSOR: MacAddress = MacAddress::of(StationId(7));
pub(super) const OTHER: MacAddress = MacAddress::of(StationId(8));

pub(super) fn at(ns: u64) -> SimTime {
    SimTime::from_nanos(ns)
}

pub(super) fn us(us: u64) -> Duration {
    Duration::from_micros(us)
}

pub(super) fn layout(sectors: &[u8]) -> SectorLayout {
    SectorLayout::new(sectors).expect("a good layout")
}

/// Frame `index` of the sweep of an initiator with these sectors.
pub(super) fn iss(from: MacAddress, to: MacAddress, sweep: &SectorLayout, index: u16) -> SweepFrame {
    let (sector, total_sectors) = (sweep.sector(index), sweep.total());
    let body = SweepBody::Iss { cdown: total_sectors - 1 - index, sector, total_sectors, rx_antennas: 1 };
    SweepFrame {
        duration_us: super::timing::duration_field(sweep.remaining_after(index, SSW_AIRTIME)),
        to,
        from,
        body,
    }
}

/// Frame `index` of the sweep of a responder with eight sectors; it heard the sector `select` best. The medium is taken
/// for `tail` after it.
pub(super) fn rss(from: MacAddress, index: u8, select: TxSector, tail: Duration) -> SweepFrame {
    let sweep = layout(&[8]);
    let feedback = SectorFeedback { select, snr: SnrReport(0), poll_required: false };
    let sector = TxSector::first_antenna(index);
    let body = SweepBody::Rss { cdown: u16::from(7 - index), sector, feedback };
    let taken = sweep.remaining_after(u16::from(index), SSW_AIRTIME) + tail;
    SweepFrame { duration_us: super::timing::duration_field(taken), to: ROBOT, from, body }
}

/// A radio with given draws; after the end of the list, draws are 0.
pub(super) struct Script {
    pub(super) now: SimTime,
    draws: VecDeque<u32>,
    timer: Option<(SimTime, Event)>,
    air: Option<SimTime>,
    /// Largest values of the draws.
    pub(super) windows: Vec<u32>,
    /// How often the timer was set.
    pub(super) timers: usize,
    /// Frames sent: instant of the start (ns), frame, where the antenna pointed.
    pub(super) sent: Vec<(u64, SweepFrame, Aim)>,
    pub(super) aim: Aim,
    pub(super) meter: EnergyMeter,
}

impl Script {
    pub(super) fn new(draws: &[u32]) -> Self {
        Self {
            now: SimTime::ZERO,
            draws: draws.iter().copied().collect(),
            timer: None,
            air: None,
            windows: Vec::new(),
            timers: 0,
            sent: Vec::new(),
            aim: Aim::QuasiOmni,
            meter: EnergyMeter::new(RadioState::Receive, SimTime::ZERO),
        }
    }

    /// The next event before `class` at `until`.
    pub(super) fn next(&mut self, until: SimTime, class: Class) -> Option<Event> {
        let due = |&(at, event): &(SimTime, Event)| (at, event.class());
        let air = self.air.map(|end| (end, Event::TransmissionEnded));
        let next = self.timer.into_iter().chain(air).min_by_key(due)?;
        if due(&next) >= (until, class) {
            return None;
        }
        if self.timer == Some(next) {
            self.timer = None;
        } else {
            self.air = None;
        }
        self.now = next.0;
        Some(next.1)
    }

    /// Instants at which frames started (ns).
    pub(super) fn starts(&self) -> Vec<u64> {
        self.sent.iter().map(|sent| sent.0).collect()
    }
}

impl Radio for Script {
    fn slots(&mut self, max_inclusive: u32) -> u32 {
        self.windows.push(max_inclusive);
        self.draws.pop_front().unwrap_or(0)
    }

    fn after(&mut self, span: Duration, event: Event) {
        assert_eq!(self.timer, None, "there is one timer");
        self.timers += 1;
        self.timer = Some((self.now + span, event));
    }

    fn cancel_timer(&mut self) {
        assert!(self.timer.take().is_some(), "a timer is pending");
    }

    fn enter(&mut self, state: RadioState) {
        self.meter.enter(state, self.now);
    }

    fn aim(&mut self, aim: Aim) {
        self.aim = aim;
    }

    fn start_transmission(&mut self, frame: SweepFrame, airtime: Duration) {
        assert_eq!(self.meter.state(), RadioState::Transmit);
        assert_eq!(self.air, None, "one frame at a time");
        self.sent.push((self.now.as_nanos(), frame, self.aim));
        self.air = Some(self.now + airtime);
    }
}
