//! How the radio of a station was used.

use std::time::Duration;

use sextant_kernel::SimTime;
use sextant_mac::EnergyMeter;
use sextant_mac::tsch::{Asn, Schedule, SlotKind};

use crate::link::radio_spans::RadioSpans;
use crate::service::slots::SlotUse;

/// How a radio was used since a slot, but for slots in which it listened and nobody sent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Usage {
    pub(super) slots: SlotUse,
    spans: RadioSpans,
    since: SimTime,
    /// Slots count from this one on, ...
    from: Asn,
    /// ... and these of them are no longer those of the schedule: it sent in them, or somebody sent to it.
    taken: u64,
    /// When the scan under way began.
    scans_since: Option<SimTime>,
}

impl Usage {
    pub(super) fn new(since: SimTime, from: Asn) -> Self {
        Self { slots: SlotUse::default(), spans: RadioSpans::default(), since, from, taken: 0, scans_since: None }
    }

    /// A slot of the schedule was used otherwise than for listening in vain.
    #[inline]
    pub(super) fn take_slot(&mut self) {
        self.taken += 1;
    }

    /// The radio turned around and sent for so long.
    #[inline]
    pub(super) fn sent(&mut self, turnaround: Duration, airtime: Duration) {
        self.spans.turning += turnaround;
        self.spans.transmitting += airtime;
    }

    /// The receiver was on for so long.
    #[inline]
    pub(super) fn received(&mut self, span: Duration) {
        self.spans.receiving += span;
    }

    /// The slots so far, up to but not including `until`, in which it listened and nobody sent, are counted: each with a window of
    /// this length.
    pub(super) fn count_idle(&mut self, schedule: &Schedule, until: Asn, window: Duration) {
        let idle = schedule.listens_within(self.from, until).saturating_sub(std::mem::take(&mut self.taken));
        self.slots.counts.add(SlotKind::IdleListen, idle);
        let nanos = (SimTime::ZERO + window).as_nanos().saturating_mul(idle);
        self.spans.receiving += Duration::from_nanos(nanos);
        self.from = self.from.max(until);
    }

    /// Slots count again from this one on.
    pub(super) fn go_on(&mut self, from: Asn) {
        self.from = from;
        self.taken = 0;
    }

    /// A scan begins.
    pub(super) fn begin_scan(&mut self, now: SimTime) {
        self.scans_since = Some(now);
    }

    /// The scan under way, if one is, is counted up to `now`; returns whether one was.
    pub(super) fn count_scan(&mut self, now: SimTime) -> bool {
        let since = self.scans_since.take();
        if let Some(since) = since {
            let span = now.saturating_since(since.max(self.since));
            self.spans.receiving += span;
            self.slots.scanned += span;
        }
        since.is_some()
    }

    /// All so far is forgotten.
    pub(super) fn restart(&mut self, now: SimTime, from: Asn) {
        let scans_since = self.scans_since.map(|_| now);
        let slots = SlotUse { lost: self.slots.lost, joined_after: self.slots.joined_after, ..SlotUse::default() };
        *self = Self { slots, scans_since, ..Self::new(now, from) };
    }

    /// The meter of the radio, and its slots with what share of the time it was on.
    pub(super) fn close(mut self, now: SimTime) -> (EnergyMeter, SlotUse) {
        self.slots.on = self.spans.transmitting + self.spans.receiving;
        self.slots.span = now.saturating_since(self.since);
        (self.spans.meter(self.since, now), self.slots)
    }
}
