//! What a station learns of a link by the frames that it sends over it.

use std::time::Duration;

use sextant_kernel::SimTime;

/// One transmission in the fixed-point numbers of ETX (RFC 6551, 4.3.2).
pub const ETX_UNIT: u16 = 128;

/// Expected transmissions before the first frame.
const INITIAL_ETX: u16 = 2 * ETX_UNIT;
/// Transmissions for which a frame without an acknowledgement counts.
const LOST_TRANSMISSIONS: u32 = 12;
/// Weight of a new sample (%) ...
const WEIGHT_PERCENT: u32 = 10;
/// ... as long as few transmissions are known.
const EARLY_WEIGHT_PERCENT: u32 = 25;
/// Transmissions from which on a link is known well enough, ...
const FRESH: u32 = 4;
/// ... the most that are remembered, ...
const MOST_REMEMBERED: u32 = 16;
/// ... and how long after the last one.
const FRESH_FOR: Duration = Duration::from_secs(600);

/// How the transmissions of a frame to one station ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkOutcome {
    /// The last one was acknowledged.
    Acknowledged,
    /// None was acknowledged.
    Lost,
    /// The channel was never free: that says nothing of the link.
    Unsent,
}

/// Expected transmissions (ETX) over a link, as Contiki-NG learns them: each frame is a sample, with a weight of 0.25 as long as
/// less than four transmissions are known, and of 0.1 later. A frame without an acknowledgement counts as 12 transmissions.
/// All numbers are whole 128ths, rounded down.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkStatistics {
    etx: u16,
    remembered: u32,
    last: Option<SimTime>,
}

impl Default for LinkStatistics {
    fn default() -> Self {
        Self { etx: INITIAL_ETX, remembered: 0, last: None }
    }
}

impl LinkStatistics {
    /// Expected transmissions [1/128].
    #[must_use]
    pub fn etx(&self) -> u16 {
        self.etx
    }

    /// Whether it is known well enough: by four transmissions, and one in the last ten minutes.
    #[must_use]
    pub fn is_fresh(&self, now: SimTime) -> bool {
        self.remembered >= FRESH && self.last.is_some_and(|last| now.saturating_since(last) < FRESH_FOR)
    }

    /// When a frame was sent last.
    #[must_use]
    pub fn last(&self) -> Option<SimTime> {
        self.last
    }

    /// A frame was sent so many times until `now`.
    pub fn sent(&mut self, transmissions: u32, outcome: LinkOutcome, now: SimTime) {
        let counted = match outcome {
            LinkOutcome::Acknowledged => transmissions,
            LinkOutcome::Lost => LOST_TRANSMISSIONS,
            LinkOutcome::Unsent => return,
        };
        self.last = Some(now);
        self.remembered = self.remembered.saturating_add(transmissions).min(MOST_REMEMBERED);
        let weight = if self.is_fresh(now) { WEIGHT_PERCENT } else { EARLY_WEIGHT_PERCENT };
        self.etx = averaged(self.etx, counted, weight);
    }

    /// Half of what is remembered is forgotten: each 15 minutes.
    pub fn age(&mut self) {
        self.remembered /= 2;
    }
}

/// The mean of the old estimate and a sample with this weight (%).
fn averaged(etx: u16, transmissions: u32, weight_percent: u32) -> u16 {
    let sample = transmissions.saturating_mul(ETX_UNIT.into()).min(u16::MAX.into());
    let sum = u32::from(etx) * (100 - weight_percent) + sample * weight_percent;
    u16::try_from(sum / 100).unwrap_or(u16::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means of samples of one transmission, worked out outside of this program.
    #[test]
    fn the_estimate_of_a_perfect_link_falls_as_published_numbers_do() {
        let falls = |weight, count| {
            std::iter::successors(Some(INITIAL_ETX), |&etx| Some(averaged(etx, 1, weight)))
                .skip(1)
                .take(count)
                .collect::<Vec<_>>()
        };
        assert_eq!(falls(10, 10), [243, 231, 220, 210, 201, 193, 186, 180, 174, 169]);
        assert_eq!(falls(25, 5), [224, 200, 182, 168, 158]);
        let mut link = LinkStatistics::default();
        let found: Vec<u16> = (0..6)
            .map(|s| {
                link.sent(1, LinkOutcome::Acknowledged, SimTime::from_secs(s));
                link.etx()
            })
            .collect();
        // Three samples have the weight 0.25, and then each 0.1.
        assert_eq!(found, [224, 200, 182, 176, 171, 166]);
    }

    #[test]
    fn a_lost_frame_counts_as_twelve_transmissions() {
        let mut link = LinkStatistics::default();
        link.sent(8, LinkOutcome::Lost, SimTime::ZERO);
        // Eight transmissions are enough for the smaller weight: 0.9 of 256 and 0.1 of 12 times 128.
        assert_eq!(link.etx(), 384);
        link.sent(1, LinkOutcome::Lost, SimTime::ZERO);
        assert_eq!(link.etx(), 499);
        link.sent(0, LinkOutcome::Unsent, SimTime::ZERO);
        assert_eq!(link.etx(), 499);
    }

    #[test]
    fn a_link_is_known_for_ten_minutes_after_four_transmissions() {
        let mut link = LinkStatistics::default();
        let at = SimTime::from_secs;
        link.sent(3, LinkOutcome::Acknowledged, at(0));
        assert!(!link.is_fresh(at(1)));
        link.sent(1, LinkOutcome::Acknowledged, at(10));
        assert!(link.is_fresh(at(609)) && !link.is_fresh(at(610)));
        link.age();
        assert!(!link.is_fresh(at(11)));
    }
}
