//! Data frames of the DMG single carrier PHY (IEEE 802.11ad-2012, 21.6; IEEE 802.11-2020, 20.5 and 20.6): rates,
//! sensitivities, airtimes, and exchanges of an A-MPDU for a block acknowledgement.

use std::time::Duration;

use sextant_channel::{Db, Dbm};

use super::timing::{SIFS, chips};

/// Noise in the bandwidth of a receiver with which the sensitivities of the standard hold (dBm): 1.76 GHz at 290 K, noise
/// figure of 10 dB. The implementation loss of 5 dB is in the sensitivities.
pub(crate) const NOISE: Dbm = Dbm(-71.5);

/// A modulation and coding scheme of the single carrier PHY.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Mcs(u8);

/// What distinguishes a scheme.
struct Scheme {
    /// Coded bits of a chip.
    bits: u64,
    /// The code has rate `sixteenths` / 16.
    sixteenths: u64,
    /// How often each bit is sent.
    repetition: u64,
    /// Receiver sensitivity (dBm; table 20-3 of IEEE 802.11-2020).
    sensitivity_dbm: f64,
}

const SCHEMES: [Scheme; Mcs::COUNT] = [
    scheme(1, 8, 2, -68.0),
    scheme(1, 8, 1, -66.0),
    scheme(1, 10, 1, -65.0),
    scheme(1, 12, 1, -64.0),
    scheme(1, 13, 1, -62.0),
    scheme(2, 8, 1, -63.0),
    scheme(2, 10, 1, -62.0),
    scheme(2, 12, 1, -61.0),
    scheme(2, 13, 1, -59.0),
    scheme(4, 8, 1, -55.0),
    scheme(4, 10, 1, -54.0),
    scheme(4, 12, 1, -53.0),
];

const fn scheme(bits: u64, sixteenths: u64, repetition: u64, sensitivity_dbm: f64) -> Scheme {
    Scheme { bits, sixteenths, repetition, sensitivity_dbm }
}

/// Chips of the preamble: short training and channel estimation.
const PREAMBLE_CHIPS: u64 = 2176 + 1152;
/// Chips of the header: two blocks.
const HEADER_CHIPS: u64 = 1024;
/// Chips of a block of data with its guard interval, those of them that carry data, and those of the last guard interval.
const BLOCK_CHIPS: u64 = 512;
const BLOCK_DATA_CHIPS: u64 = 448;
const GUARD_CHIPS: u64 = 64;
/// Bits of a codeword.
const CODEWORD_BITS: u64 = 672;

impl Mcs {
    /// Number of schemes: 1 to 12.
    pub const COUNT: usize = 12;
    /// The slowest one.
    pub const SLOWEST: Self = Self(1);

    /// All schemes, the slowest first.
    pub fn all() -> impl DoubleEndedIterator<Item = Self> {
        (1..=12).map(Self)
    }

    /// Its number, 1 to 12.
    #[must_use]
    pub fn number(self) -> u8 {
        self.0
    }

    fn scheme(self) -> &'static Scheme {
        &SCHEMES[usize::from(self.0) - 1]
    }

    /// Data rate (bit/s).
    #[must_use]
    pub fn bit_per_s(self) -> f64 {
        let Scheme { bits, sixteenths, repetition, .. } = self.scheme();
        let data = (BLOCK_DATA_CHIPS * bits * sixteenths) as f64 / (16 * repetition) as f64;
        data / BLOCK_CHIPS as f64 * super::timing::CHIPS_PER_S as f64
    }

    /// Receiver sensitivity: at most 1 % of frames with 4096 octets are lost at this power.
    #[must_use]
    pub fn sensitivity(self) -> Dbm {
        Dbm(self.scheme().sensitivity_dbm)
    }

    /// The ratio of signal to noise at the sensitivity.
    #[must_use]
    pub fn least_snr(self) -> Db {
        self.sensitivity() - NOISE
    }

    /// The fastest scheme that is received at this ratio; `None` if none is.
    #[must_use]
    pub fn fastest_at(snr: Db) -> Option<Self> {
        Self::all().rev().find(|mcs| mcs.least_snr().0 <= snr.0)
    }

    /// The next slower scheme; `None` of the slowest one.
    #[must_use]
    pub fn slower(self) -> Option<Self> {
        (self > Self::SLOWEST).then(|| Self(self.0 - 1))
    }

    /// Time on air of a frame with a PSDU of `octets` (20.6.3): preamble, header, blocks of 512 chips and the last guard
    /// interval. The last codeword and the last block are filled up.
    #[must_use]
    pub fn airtime(self, octets: u32) -> Duration {
        let Scheme { bits, sixteenths, repetition, .. } = self.scheme();
        let codewords = (u64::from(octets) * 8 * 16 * repetition).div_ceil(CODEWORD_BITS * sixteenths);
        let blocks = (codewords * CODEWORD_BITS).div_ceil(BLOCK_DATA_CHIPS * bits);
        chips(PREAMBLE_CHIPS + HEADER_CHIPS + blocks * BLOCK_CHIPS + GUARD_CHIPS)
    }
}

/// Octets of the payload of an MPDU (MSDU).
pub const MSDU_OCTETS: u32 = 1500;
/// Most MPDUs of an A-MPDU: the window of a block acknowledgement.
pub const MOST_MPDUS: u32 = 64;
/// Octets of an MPDU in an A-MPDU: delimiter 4, header 26, payload, FCS 4, filled up to a multiple of 4.
const SUBFRAME_OCTETS: u32 = (4 + 26 + MSDU_OCTETS + 4).next_multiple_of(4);
/// Longest time on air of a frame (aPPDUMaxTime, table 20-32).
const LONGEST: Duration = Duration::from_millis(2);
/// Octets of a block acknowledgement, compressed: header 16, control 2, sequence control 2, bitmap 8, FCS 4.
const BLOCK_ACK_OCTETS: u32 = 32;

/// An exchange in a service period: an A-MPDU, a SIFS, a block acknowledgement with MCS 1, and a SIFS to the next frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exchange {
    /// The MPDUs of the A-MPDU, each with [`MSDU_OCTETS`].
    pub mpdus: u32,
    /// Time of the whole.
    pub span: Duration,
}

impl Exchange {
    /// The longest exchange with a scheme that ends within `left`; `None` if not even one MPDU fits.
    #[must_use]
    pub fn within(mcs: Mcs, left: Duration) -> Option<Self> {
        let beside = SIFS + Mcs::SLOWEST.airtime(BLOCK_ACK_OCTETS) + SIFS;
        let longest = LONGEST.min(left.checked_sub(beside)?);
        let of = |mpdus: u32| mcs.airtime(mpdus * SUBFRAME_OCTETS);
        // Airtimes grow with the MPDUs.
        let (mut fits, mut too_many) = (0, MOST_MPDUS + 1);
        while too_many - fits > 1 {
            let middle = u32::midpoint(fits, too_many);
            if of(middle) <= longest { fits = middle } else { too_many = middle }
        }
        (fits > 0).then(|| Self { mpdus: fits, span: of(fits) + beside })
    }

    /// Bits of payload that it carries.
    #[must_use]
    pub fn bits(&self) -> u64 {
        u64::from(self.mpdus * MSDU_OCTETS * 8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_and_sensitivities_are_those_of_the_standard() {
        let mbit = [385.0, 770.0, 962.5, 1155.0, 1251.25, 1540.0, 1925.0, 2310.0, 2502.5, 3080.0, 3850.0, 4620.0];
        for (mcs, rate) in Mcs::all().zip(mbit) {
            assert!((mcs.bit_per_s() / 1e6 - rate).abs() < 1e-9, "MCS {}", mcs.number());
        }
        // MCS 6 needs less than MCS 5, so that MCS 5 is never the fastest.
        let fastest = |dbm: f64| Mcs::fastest_at(Dbm(dbm) - NOISE).map(Mcs::number);
        let powers = [-68.1, -68.0, -65.9, -64.5, -63.5, -63.0, -62.0, -60.5, -56.0, -54.5, -53.5, -20.0];
        let expected = [0, 1, 2, 3, 4, 6, 7, 8, 9, 10, 11, 12].map(|number| (number > 0).then_some(number));
        assert_eq!(powers.map(fastest), expected);
        assert_eq!((Mcs(2).slower(), Mcs(1).slower()), (Some(Mcs(1)), None));
    }

    #[test]
    fn airtimes_are_those_counted_by_hand() {
        // 32 octets with MCS 1: 256 bits in codewords of 168 are two, 1344 coded bits in blocks of 448 are three.
        let chips = 3328 + 1024 + 3 * 512 + 64;
        assert_eq!(Mcs(1).airtime(32), Duration::from_nanos(chips * 1000 / 1760 + 1));
        // 1000 octets with MCS 12: 8000 bits in codewords of 504 are 16, 10752 coded bits in blocks of 1792 are six.
        let chips = 3328 + 1024 + 6 * 512 + 64;
        // 7488 chips of 1.76 GHz are 4254.5 ns.
        assert_eq!((chips, Mcs(12).airtime(1000)), (7488, Duration::from_nanos(4255)));
    }

    #[test]
    fn an_exchange_brings_what_is_counted_by_hand() {
        // 64 MPDUs of 1536 octets: 786432 bits in codewords of 504 are 1561, 1048992 coded bits in blocks of 1792 are 586.
        let long = Exchange::within(Mcs(12), Duration::from_millis(10)).expect("it fits");
        let frame_ns = f64::from(3328 + 1024 + 586 * 512 + 64) / 1.76;
        let ack_ns = f64::from(3328 + 1024 + 3 * 512 + 64) / 1.76;
        assert_eq!(long.mpdus, 64);
        assert!((long.span.as_nanos() as f64 - frame_ns - ack_ns - 6000.0).abs() < 2.0, "{long:?}");
        assert_eq!(long.bits(), 64 * 12_000);
        // 768000 bits in 182.3 us.
        assert!((long.bits() as f64 / long.span.as_secs_f64() / 1e9 - 4.212).abs() < 1e-3);
        // No frame is longer than 2 ms: with MCS 1, 62 MPDUs.
        assert_eq!(Exchange::within(Mcs(1), Duration::from_millis(10)).map(|exchange| exchange.mpdus), Some(62));
        assert_eq!(Exchange::within(Mcs(1), Duration::from_micros(40)), None);
        let short = Exchange::within(Mcs(12), Duration::from_micros(50)).expect("some fit");
        assert!(short.mpdus > 10 && short.span <= Duration::from_micros(50), "{short:?}");
    }
}
