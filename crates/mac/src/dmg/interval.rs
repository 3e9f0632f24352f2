//! What a beacon interval spends on beams (IEEE 802.11ad-2012, 9.33.4 and 9.35): beacons of the robot in its sectors (BTI),
//! slots in which nodes answer with their sectors (A-BFT), and a refinement of the robot's sector (BRP).

use std::time::Duration;

use super::frame::brp_octets;
use super::sector::SectorLayout;
use super::timing::{MBIFS, SBIFS, SIFS, chips, control_airtime, slot_duration};

/// Octets of a beacon: 34 without elements, and an Extended Schedule element with one service period (2 and 15).
const BEACON_OCTETS: u16 = 34 + 2 + 15;
/// Time on air of a beacon.
pub const BEACON_AIRTIME: Duration = control_airtime(BEACON_OCTETS);
/// Most slots of an A-BFT (its length has three bits).
pub const MOST_SLOTS: u8 = 8;
/// Most frames of a slot (FSS has four bits).
pub const MOST_SLOT_FRAMES: u8 = 16;
/// Sectors that one training unit of a BRP frame tests.
pub const REFINED_SECTORS: usize = 4;
/// Chips of a training unit: four subfields to set the gain, a channel estimation field, and four subfields to test
/// sectors (aBRPTRNBlock).
const TRAINING_UNIT_CHIPS: u64 = 4992;
/// Longest space between the frames of a refinement (BRPIFS).
const BRPIFS: Duration = Duration::from_micros(40);

/// Time of the beacons from `sectors` sectors of one DMG antenna.
#[must_use]
pub fn beacons(sectors: u16) -> Duration {
    let gaps = u32::from(sectors.saturating_sub(1));
    BEACON_AIRTIME * u32::from(sectors) + SBIFS * gaps
}

/// Time of the beacons from all sectors of a station.
#[must_use]
pub fn all_beacons(layout: &SectorLayout) -> Duration {
    BEACON_AIRTIME + layout.remaining_after(0, BEACON_AIRTIME)
}

/// Time of `slots` slots in which nodes answer with `frames` SSW frames each, 1 to 16, with the space before them.
#[must_use]
pub fn answers(slots: u8, frames: u8) -> Duration {
    MBIFS + slot_duration(frames) * u32::from(slots)
}

/// Time of a refinement: a BRP frame with one training unit, and the answer with the SNRs of its sectors, each with the
/// longest space after it.
#[must_use]
pub fn refinement() -> Duration {
    let asked = control_airtime(brp_octets(0)) + chips(TRAINING_UNIT_CHIPS);
    let answered = control_airtime(brp_octets(4));
    SIFS + asked + BRPIFS + answered + BRPIFS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exhaustive_sweep_takes_what_is_counted_by_hand() {
        // A beacon of 51 octets: 45 octets after the first codeword are 360 bits in 3 codewords.
        let beacon_ns = f64::from(7552 + (88 + 360 + 4 * 168) * 32) / 1.76;
        assert!((BEACON_AIRTIME.as_secs_f64() * 1e9 - beacon_ns).abs() <= 0.5);
        assert_eq!(BEACON_AIRTIME, Duration::from_nanos(24_655));
        // 64 sectors and 63 gaps of 1 us; 8 slots of 290 us and 9 us before them.
        assert_eq!(beacons(64), Duration::from_nanos(64 * 24_655 + 63_000));
        assert_eq!(answers(8, 16), Duration::from_micros(9 + 8 * 290));
        assert_eq!(all_beacons(&SectorLayout::new(&[64]).expect("sectors")), beacons(64));
        // Two DMG antennas: one gap is 18 us.
        let two = SectorLayout::new(&[32, 32]).expect("sectors");
        assert_eq!(all_beacons(&two), beacons(64) + Duration::from_micros(17));
        assert_eq!((beacons(1), beacons(0)), (BEACON_AIRTIME, Duration::ZERO));
    }

    #[test]
    fn a_refinement_takes_two_frames_and_one_training_unit() {
        // BRP frames of 44 and 52 octets: 304 bits in 2, 368 bits in 3 codewords after the first.
        let ns = |bits: u32, codewords: u32| f64::from(7552 + (88 + bits + (1 + codewords) * 168) * 32) / 1.76;
        let expected = 3000.0 + ns(304, 2) + 4992.0 / 1.76 + 40_000.0 + ns(368, 3) + 40_000.0;
        assert!((refinement().as_nanos() as f64 - expected).abs() < 2.0, "{:?} {expected}", refinement());
    }
}
