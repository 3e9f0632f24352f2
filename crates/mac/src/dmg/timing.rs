//! Durations of the DMG PHY and MAC (IEEE 802.11ad-2012, table 21-31 and 9.3.2.3): the only place where they are
//! calculated, rounded to 1 ns.

use std::time::Duration;

use sextant_kernel::SimTime;

/// Most changes of the DMG antenna in a sweep.
const MAX_CHANGES: u32 = 3;

/// A slot of the backoff (aSlotTime).
pub const SLOT: Duration = Duration::from_micros(5);
/// Short interframe space.
pub const SIFS: Duration = Duration::from_micros(3);
/// Space between two frames of a sweep (SBIFS).
pub(crate) const SBIFS: Duration = Duration::from_micros(1);
/// Space between the parts of a sector level sweep (MBIFS = 3 SIFS).
pub const MBIFS: Duration = Duration::from_micros(9);
/// Space between two frames of a sweep from different DMG antennas (LBIFS = 6 SIFS).
pub(crate) const LBIFS: Duration = Duration::from_micros(18);
/// Longest propagation that the standard counts on (aAirPropagationTime).
pub(crate) const AIR_PROPAGATION: Duration = Duration::from_nanos(100);
/// A receiver notices the preamble of a control PHY frame within this time (21.4.3.2).
pub(crate) const CCA_DETECTION: Duration = Duration::from_micros(3);

/// Preamble of a control PHY frame: short training field and channel estimation field (21.4.3.1).
pub const PREAMBLE: Duration = chips(PREAMBLE_CHIPS);

/// Chips of the preamble of a control PHY frame.
const PREAMBLE_CHIPS: u64 = 7552;

/// Chips of the single carrier and control PHY per second.
pub(crate) const CHIPS_PER_S: u64 = 1_760_000_000;

/// Octets of an SSW frame.
pub const SSW_OCTETS: u16 = 26;
/// Octets of an SSW-Feedback frame, and of an SSW-ACK frame.
pub(crate) const SSW_FEEDBACK_OCTETS: u16 = 28;

/// Time on the air of an SSW frame.
pub(crate) const SSW_AIRTIME: Duration = control_airtime(SSW_OCTETS);
/// Time on the air of an SSW-Feedback frame, and of an SSW-ACK frame.
pub(crate) const SSW_FEEDBACK_AIRTIME: Duration = control_airtime(SSW_FEEDBACK_OCTETS);

/// Further tries of an initiator whose sweep is not answered or whose feedback is not acknowledged (dot11BFRetryLimit).
pub(crate) const MAX_SLS_RETRIES: u8 = 10;
/// An initiator waits this long after the end of its SSW-Feedback for the SSW-ACK: twice the frame, and twice the
/// propagation and MBIFS.
pub(crate) const SSW_ACK_TIMEOUT: Duration = Duration::from_nanos(2 * (18_255 + 100 + 9_000));

/// Time on the air of a control PHY PPDU (MCS 0) with a PSDU of `octets`.
///
/// Preamble 7552 chips; then header, PSDU and 168 parity bits per LDPC codeword, each bit 32 chips. The first codeword
/// holds the header (40 bits) and 6 octets, each further one at most 168 bits (21.4.3).
///
/// # Panics
/// If there are fewer than 6 octets.
#[must_use]
pub const fn control_airtime(octets: u16) -> Duration {
    const CHIPS_PER_BIT: u64 = 32;
    const CODEWORD_BITS: u64 = 168;
    const FIRST_BITS: u64 = 88;
    assert!(octets >= 6, "the first codeword holds 6 octets");
    let further_bits = (octets as u64 - 6) * 8;
    let codewords = 1 + further_bits.div_ceil(CODEWORD_BITS);
    chips(PREAMBLE_CHIPS + (FIRST_BITS + further_bits + CODEWORD_BITS * codewords) * CHIPS_PER_BIT)
}

/// Time of so many chips.
pub(crate) const fn chips(count: u64) -> Duration {
    Duration::from_nanos((count * 1_000_000_000 + CHIPS_PER_S / 2) / CHIPS_PER_S)
}

/// Time for the sweep of a responder in an A-BFT slot (aSSDuration) with `frames` SSW frames, 1 to 16.
#[must_use]
pub(crate) fn slot_sweep_duration(frames: u8) -> Duration {
    SSW_AIRTIME * u32::from(frames) + SBIFS * u32::from(frames.saturating_sub(1))
}

/// Length of an A-BFT slot for `frames` SSW frames, 1 to 16 (aSSSlotTime), rounded up to 1 us.
#[must_use]
pub(crate) fn slot_duration(frames: u8) -> Duration {
    let exact = AIR_PROPAGATION + slot_sweep_duration(frames) + MBIFS + SSW_FEEDBACK_AIRTIME + MBIFS;
    Duration::from_micros(u64::from(duration_field(exact)))
}

/// The largest value of a Duration field (us; IEEE 802.11-2012, 8.2.4.2).
const MAX_DURATION_US: u16 = 32_767;

/// The value of a Duration field for `span` (us): rounded up; at most 32767. Of a sweep that lasts longer, each frame
/// claims the medium anew.
#[must_use]
pub(crate) fn duration_field(span: Duration) -> u16 {
    u16::try_from(span.as_nanos().div_ceil(1000)).unwrap_or(u16::MAX).min(MAX_DURATION_US)
}

/// The end of the sweep with SSW frames of which a frame that ended at `now` announces `cdown` more frames and a time of `duration_us`,
/// of which the last `tail` is not the sweep.
///
/// CDOWN alone gives the end only if the DMG antenna does not change any more. Each change takes LBIFS instead of
/// SBIFS; their number follows from the Duration field, which is exact to 1 us.
#[must_use]
pub(crate) fn sweep_end(now: SimTime, cdown: u16, duration_us: u16, tail: Duration) -> SimTime {
    let one_antenna = (SSW_AIRTIME + SBIFS) * u32::from(cdown);
    let announced = Duration::from_micros(u64::from(duration_us)).saturating_sub(tail);
    let changes = announced.saturating_sub(one_antenna).as_nanos() / (LBIFS - SBIFS).as_nanos();
    let changes = u32::try_from(changes).unwrap_or(u32::MAX).min(MAX_CHANGES);
    now + one_antenna + (LBIFS - SBIFS) * changes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_the_control_phy_have_the_airtimes_of_the_standard() {
        assert_eq!(PREAMBLE, Duration::from_nanos(4_291));
        for (octets, ns) in [(26, 14_909), (28, 18_255), (14, 13_164)] {
            assert_eq!(control_airtime(octets), Duration::from_nanos(ns), "{octets} octets");
        }
        // 6 octets: preamble 4.291 us and the first codeword 4.6545 us.
        assert_eq!(control_airtime(6).as_nanos(), 8945);
    }

    #[test]
    fn interframe_spaces_are_multiples_of_sifs_and_slot() {
        assert_eq!((MBIFS, LBIFS), (SIFS * 3, SIFS * 6));
    }

    #[test]
    fn slots_for_responders_hold_sweep_and_feedback() {
        for (frames, us) in [(1, 52), (2, 68), (4, 99), (8, 163), (16, 290)] {
            assert_eq!(slot_duration(frames), Duration::from_micros(us), "{frames} frames");
        }
    }

    #[test]
    fn durations_are_rounded_up_to_microseconds() {
        let field = |ns| duration_field(Duration::from_nanos(ns));
        assert_eq!([field(0), field(1), field(1000), field(1001)], [0, 1, 1, 2]);
        assert_eq!([field(32_767_000), field(32_767_001), field(70_000_000)], [32_767; 3]);
    }
}
