//! The superframe of a beacon-enabled PAN: when contention, guaranteed slots and rest begin and end
//! (IEEE 802.15.4-2006, 5.5.1 and 7.5.1.1).
//!
//! ```text
//! |beacon|  contention access period  | guaranteed slots |  inactive part  |beacon|
//! 0                                  CAP end            active part        interval
//! ```

use std::time::Duration;

use sextant_kernel::SimTime;

use crate::Phy;
use crate::frame::{GuaranteedSlot, Superframe};

mod settings;
#[cfg(test)]
mod tests;

pub use settings::{BeaconEnabled, BeaconEnabledConfig, Gts, GtsConfig};

/// Largest order of a superframe that is repeated; 15 means no superframe.
pub(crate) const MAX_ORDER: u8 = 14;
/// Slots of the active part (aNumSuperframeSlots).
pub(crate) const SLOTS: u8 = 16;
/// Length of a slot of order 0 (symbols) (aBaseSlotDuration).
const BASE_SLOT_SYMBOLS: u64 = 60;
/// Minimum length of the contention access period (symbols) (aMinCAPLength).
pub(crate) const MIN_CAP_SYMBOLS: u64 = 440;
/// Largest number of guaranteed slots of a superframe (7.5.7).
pub(crate) const MAX_GUARANTEED: usize = 7;
/// Number of backoff periods after the beacon in which contention is possible, to save batteries
/// (macBattLifeExtPeriods; its minimum, which is the default at 2450 MHz).
const BATTERY_LIFE_PERIODS: u32 = 6;

/// Timing of the superframe that a beacon opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SuperframeTiming {
    phy: Phy,
    specification: Superframe,
}

impl SuperframeTiming {
    /// Timing of the superframe that a beacon with this specification opens; `None` if it opens no superframe: an
    /// order of 15, or an active part longer than the interval.
    #[must_use]
    pub const fn new(phy: Phy, specification: Superframe) -> Option<Self> {
        let Superframe { beacon_order, superframe_order, .. } = specification;
        if beacon_order > MAX_ORDER || superframe_order > beacon_order {
            return None;
        }
        Some(Self { phy, specification })
    }

    /// Time from the start of a beacon to the start of the next: 960 * 2^BO symbols.
    #[must_use]
    pub const fn beacon_interval(&self) -> Duration {
        self.slots_of_order(self.specification.beacon_order, SLOTS)
    }

    /// Length of the active part, beacon included: 960 * 2^SO symbols.
    #[must_use]
    pub const fn active(&self) -> Duration {
        self.slot_start(SLOTS)
    }

    /// Whether stations may rest between the active part and the next beacon.
    #[must_use]
    pub(crate) const fn has_inactive_part(&self) -> bool {
        self.specification.superframe_order < self.specification.beacon_order
    }

    /// Start of slot `slot` after the start of the beacon: 60 * 2^SO symbols per slot.
    #[must_use]
    pub(crate) const fn slot_start(&self, slot: u8) -> Duration {
        self.slots_of_order(self.specification.superframe_order, slot)
    }

    /// End of the contention access period after the start of the beacon.
    #[must_use]
    pub(crate) const fn cap_end(&self) -> Duration {
        self.slot_start(self.specification.final_cap_slot + 1)
    }

    const fn slots_of_order(&self, order: u8, slots: u8) -> Duration {
        self.phy.symbols((BASE_SLOT_SYMBOLS << order) * slots as u64)
    }

    /// The contention access period of the superframe whose beacon, of `beacon_octets`, started at `start`.
    ///
    /// It starts at the end of the beacon; with battery life extension, after the interframe spacing that follows.
    #[must_use]
    pub fn contention(&self, start: SimTime, beacon_octets: u8) -> Contention {
        let mut earliest = self.phy.airtime(beacon_octets);
        if self.specification.battery_life_extension {
            earliest += self.phy.interframe_spacing(beacon_octets);
        }
        let first = start + periods_to(earliest, self.phy);
        let end = start + self.cap_end();
        let contention = Contention { phy: self.phy, start, first, end, saver_end: None };
        if self.specification.battery_life_extension { contention.with_battery_life_extension() } else { contention }
    }

    /// End of a guaranteed slot after the start of the beacon.
    #[must_use]
    pub(crate) const fn guaranteed_end(&self, slot: GuaranteedSlot) -> Duration {
        self.slot_start(slot.first_slot + slot.slots)
    }

    /// Time from the end of a frame, which is `since_start` after the start of the beacon, to the start of its
    /// acknowledgement. In the contention access period: until the first backoff boundary that is at least one
    /// turnaround away. Elsewhere: one turnaround (7.5.6.4.2).
    #[must_use]
    pub fn ack_gap(&self, since_start: Duration) -> Duration {
        if since_start >= self.cap_end() { self.phy.turnaround() } else { ack_gap(self.phy, since_start) }
    }
}

/// The shortest whole number of backoff periods that is not less than `span`.
fn periods_to(span: Duration, phy: Phy) -> Duration {
    let period = phy.backoff_period();
    let periods = span.as_nanos().div_ceil(period.as_nanos());
    period * u32::try_from(periods).expect("a superframe has fewer than 2^32 backoff periods")
}

fn ack_gap(phy: Phy, since_start: Duration) -> Duration {
    periods_to(since_start + phy.turnaround(), phy) - since_start
}

/// A contention access period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contention {
    phy: Phy,
    /// Start of the beacon: backoff boundaries are whole backoff periods after it.
    start: SimTime,
    /// First boundary at which a backoff may begin.
    first: SimTime,
    end: SimTime,
    /// With battery life extension, the end of the backoff periods in which stations may count and begin to send.
    saver_end: Option<SimTime>,
}

impl Contention {
    /// A period with backoff boundaries from `start` on, all of which can be used until `end`.
    #[must_use]
    pub const fn new(phy: Phy, start: SimTime, end: SimTime) -> Self {
        Self { phy, start, first: start, end, saver_end: None }
    }

    /// The same period, but stations use only its first backoff periods (macBattLifeExt).
    #[must_use]
    pub(crate) fn with_battery_life_extension(self) -> Self {
        Self { saver_end: Some(self.first + self.phy.backoff_period() * BATTERY_LIFE_PERIODS), ..self }
    }

    /// Whether battery life extension is on.
    #[must_use]
    pub(crate) const fn is_battery_saving(&self) -> bool {
        self.saver_end.is_some()
    }

    /// End of the period.
    #[must_use]
    pub const fn end(&self) -> SimTime {
        self.end
    }

    /// The first backoff boundary of the period that is not before `now`.
    #[must_use]
    pub fn boundary(&self, now: SimTime) -> SimTime {
        self.first.max(self.start + periods_to(now.saturating_since(self.start), self.phy))
    }

    /// Number of whole backoff periods that can be counted from the boundary `from` on.
    #[must_use]
    pub(crate) fn countable(&self, from: SimTime) -> u32 {
        let left = self.saver_end.unwrap_or(self.end).min(self.end).saturating_since(from);
        let periods = left.as_nanos() / self.phy.backoff_period().as_nanos();
        u32::try_from(periods).expect("a superframe has fewer than 2^32 backoff periods")
    }

    /// Whether two clear channel assessments from the boundary `from` on, a frame, its acknowledgement if requested,
    /// and the interframe spacing end within the period.
    #[must_use]
    pub fn fits(&self, from: SimTime, mpdu_octets: u8, ack_request: bool) -> bool {
        let period = self.phy.backoff_period();
        let first_bit = from + period * 2;
        let mut end = first_bit + self.phy.airtime(mpdu_octets);
        if ack_request {
            end += ack_gap(self.phy, end - self.start) + self.phy.ack_airtime();
        }
        let starts_in_time = self.saver_end.is_none_or(|saver_end| first_bit + period <= saver_end);
        starts_in_time && end + self.phy.interframe_spacing(mpdu_octets) <= self.end
    }
}
