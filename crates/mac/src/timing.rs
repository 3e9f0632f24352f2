//! Durations of IEEE 802.15.4: the only place where they are calculated, exact in nanoseconds.

use std::ops::RangeInclusive;
use std::time::Duration;

use serde::{Deserialize, Serialize};

/// Largest MPDU (octets), FCS included (aMaxPHYPacketSize; IEEE 802.15.4-2011, 9.2).
pub(crate) const MAX_MPDU_OCTETS: u8 = 127;
/// Size of an acknowledgement's MPDU (octets): frame control, sequence number, FCS.
pub(crate) const ACK_MPDU_OCTETS: u8 = 5;
/// Largest MPDU that is followed by the short interframe spacing (octets) (aMaxSIFSFrameSize).
const MAX_SIFS_MPDU_OCTETS: u8 = 18;

/// A physical layer of IEEE 802.15.4: band and modulation (IEEE 802.15.4-2006, clause 6).
///
/// All spans of the MAC are counted in its symbols.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Phy {
    /// 2450 MHz, O-QPSK with 32 chips per symbol, 250 kb/s: channels 11 to 26.
    #[default]
    Oqpsk2450,
    /// 868 MHz, BPSK, 20 kb/s: channel 0.
    Bpsk868,
    /// 915 MHz, BPSK, 40 kb/s: channels 1 to 10.
    Bpsk915,
    /// 868 MHz, ASK, 250 kb/s: channel page 1.
    Ask868,
    /// 915 MHz, ASK, 250 kb/s: channel page 1.
    Ask915,
    /// 868 MHz, O-QPSK, 100 kb/s: channel page 2.
    Oqpsk868,
    /// 915 MHz, O-QPSK, 250 kb/s: channel page 2.
    Oqpsk915,
}

/// A band of the radio spectrum in which IEEE 802.15.4 has channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Band {
    /// 868 MHz, Europe.
    Mhz868,
    /// 915 MHz, North America.
    Mhz915,
    /// 2450 MHz, worldwide.
    Mhz2450,
}

/// The numbers from which the spans of a physical layer follow.
struct Numbers {
    /// Length of a symbol (ns).
    symbol_ns: u64,
    /// Preamble and start-of-frame delimiter (symbols).
    shr_symbols: u64,
    /// PHY header (tenths of a symbol).
    phr_tenths: u64,
    /// One octet (tenths of a symbol).
    octet_tenths: u64,
}

impl Phy {
    /// Every physical layer.
    pub const ALL: [Self; 7] =
        [Self::Oqpsk2450, Self::Bpsk868, Self::Bpsk915, Self::Ask868, Self::Ask915, Self::Oqpsk868, Self::Oqpsk915];

    /// Its name in scenarios.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Oqpsk2450 => "oqpsk2450",
            Self::Bpsk868 => "bpsk868",
            Self::Bpsk915 => "bpsk915",
            Self::Ask868 => "ask868",
            Self::Ask915 => "ask915",
            Self::Oqpsk868 => "oqpsk868",
            Self::Oqpsk915 => "oqpsk915",
        }
    }

    /// Its band.
    #[must_use]
    pub const fn band(self) -> Band {
        match self {
            Self::Oqpsk2450 => Band::Mhz2450,
            Self::Bpsk868 | Self::Ask868 | Self::Oqpsk868 => Band::Mhz868,
            Self::Bpsk915 | Self::Ask915 | Self::Oqpsk915 => Band::Mhz915,
        }
    }

    /// Its channel page (IEEE 802.15.4-2006, 6.1.2.2): 0, or 1 for ASK and 2 for O-QPSK below 1 GHz.
    #[must_use]
    pub const fn page(self) -> u8 {
        match self {
            Self::Oqpsk2450 | Self::Bpsk868 | Self::Bpsk915 => 0,
            Self::Ask868 | Self::Ask915 => 1,
            Self::Oqpsk868 | Self::Oqpsk915 => 2,
        }
    }

    /// Its channels (IEEE 802.15.4-2006, 6.1.2.1).
    #[must_use]
    pub const fn channels(self) -> RangeInclusive<u8> {
        match self.band() {
            Band::Mhz868 => 0..=0,
            Band::Mhz915 => 1..=10,
            Band::Mhz2450 => 11..=26,
        }
    }

    #[inline]
    const fn numbers(self) -> Numbers {
        let (symbol_ns, shr_symbols, phr_tenths, octet_tenths) = match self {
            Self::Oqpsk2450 | Self::Oqpsk915 => (16_000, 8 + 2, 20, 20),
            Self::Bpsk868 => (50_000, 32 + 8, 80, 80),
            Self::Bpsk915 => (25_000, 32 + 8, 80, 80),
            Self::Ask868 => (80_000, 2 + 1, 4, 4),
            Self::Ask915 => (20_000, 6 + 1, 16, 16),
            Self::Oqpsk868 => (40_000, 8 + 2, 20, 20),
        };
        Numbers { symbol_ns, shr_symbols, phr_tenths, octet_tenths }
    }

    /// Span of `count` symbols.
    #[must_use]
    #[inline]
    pub const fn symbols(self, count: u64) -> Duration {
        Duration::from_nanos(self.numbers().symbol_ns * count)
    }

    /// Length of one symbol.
    #[must_use]
    pub const fn symbol(self) -> Duration {
        self.symbols(1)
    }

    /// Time of one octet on the air.
    #[must_use]
    #[inline]
    pub const fn octet(self) -> Duration {
        let n = self.numbers();
        Duration::from_nanos(n.symbol_ns * n.octet_tenths / 10)
    }

    /// Bits per second on the air.
    #[must_use]
    pub fn bit_rate_per_s(self) -> f64 {
        8.0 / self.octet().as_secs_f64()
    }

    /// Synchronisation header: preamble and start-of-frame delimiter.
    #[must_use]
    pub const fn synchronisation_header(self) -> Duration {
        self.symbols(self.numbers().shr_symbols)
    }

    /// Synchronisation header and PHY header: the time before the first bit of the MPDU.
    #[must_use]
    pub const fn header(self) -> Duration {
        let n = self.numbers();
        Duration::from_nanos(n.symbol_ns * (10 * n.shr_symbols + n.phr_tenths) / 10)
    }

    /// Time on the air of a frame with an MPDU of `mpdu_octets`, first bit of the preamble to last
    /// bit of the FCS.
    #[must_use]
    #[inline]
    pub const fn airtime(self, mpdu_octets: u8) -> Duration {
        let n = self.numbers();
        let tenths = 10 * n.shr_symbols + n.phr_tenths + n.octet_tenths * mpdu_octets as u64;
        Duration::from_nanos(n.symbol_ns * tenths / 10)
    }

    /// Time on the air of an acknowledgement.
    #[must_use]
    pub const fn ack_airtime(self) -> Duration {
        self.airtime(ACK_MPDU_OCTETS)
    }

    /// Time from receiving to transmitting or back, and from the end of a frame to the start of its
    /// acknowledgement (aTurnaroundTime, 12 symbols).
    #[must_use]
    #[inline]
    pub const fn turnaround(self) -> Duration {
        self.symbols(12)
    }

    /// Length of a clear channel assessment (8 symbols).
    #[must_use]
    #[inline]
    pub const fn cca(self) -> Duration {
        self.symbols(8)
    }

    /// Unit of the backoff (aUnitBackoffPeriod, 20 symbols).
    #[must_use]
    #[inline]
    pub const fn backoff_period(self) -> Duration {
        self.symbols(20)
    }

    /// How long after the end of a frame a station waits for its acknowledgement (macAckWaitDuration:
    /// one backoff period, one turnaround, the synchronisation header and six octets, the octets
    /// rounded up to whole symbols).
    #[must_use]
    #[inline]
    pub(crate) const fn ack_wait(self) -> Duration {
        let n = self.numbers();
        self.symbols(20 + 12 + n.shr_symbols + (6 * n.octet_tenths).div_ceil(10))
    }

    /// Short interframe spacing (macMinSIFSPeriod, 12 symbols).
    #[must_use]
    #[inline]
    pub(crate) const fn short_spacing(self) -> Duration {
        self.symbols(12)
    }

    /// Long interframe spacing (macMinLIFSPeriod, 40 symbols).
    #[must_use]
    #[inline]
    pub(crate) const fn long_spacing(self) -> Duration {
        self.symbols(40)
    }

    /// Interframe spacing that a sender must keep after a frame of `mpdu_octets`, or after its acknowledgement.
    #[must_use]
    #[inline]
    pub(crate) const fn interframe_spacing(self, mpdu_octets: u8) -> Duration {
        if mpdu_octets <= MAX_SIFS_MPDU_OCTETS { self.short_spacing() } else { self.long_spacing() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn us(micros: u64) -> Duration {
        Duration::from_micros(micros)
    }

    #[test]
    fn the_2450_mhz_layer_has_the_spans_of_the_standard() {
        let phy = Phy::Oqpsk2450;
        assert_eq!((phy.symbol(), phy.octet()), (us(16), us(32)));
        assert_eq!((phy.synchronisation_header(), phy.header()), (us(160), us(192)));
        assert_eq!((phy.cca(), phy.turnaround(), phy.backoff_period()), (us(128), us(192), us(320)));
        assert_eq!((phy.ack_wait(), phy.ack_airtime()), (us(864), us(352)));
        assert_eq!((phy.short_spacing(), phy.long_spacing()), (us(192), us(640)));
        for octets in 5..=127 {
            assert_eq!(phy.airtime(octets), us((6 + u64::from(octets)) * 32));
        }
        assert_eq!((phy.airtime(20), phy.airtime(127)), (us(832), us(4256)));
    }

    #[test]
    fn the_other_layers_have_their_own_spans() {
        let spans = |phy: Phy| [phy.backoff_period(), phy.cca(), phy.turnaround(), phy.airtime(20)];
        assert_eq!(spans(Phy::Bpsk915), [us(500), us(200), us(300), us((48 + 160) * 25)]);
        assert_eq!(spans(Phy::Bpsk868), [us(1000), us(400), us(600), us((48 + 160) * 50)]);
        // 3.4 + 20 * 0.4 symbols of 80 us; 8.6 + 20 * 1.6 symbols of 20 us.
        assert_eq!(spans(Phy::Ask868), [us(1600), us(640), us(960), us(912)]);
        assert_eq!(spans(Phy::Ask915), [us(400), us(160), us(240), us(812)]);
        assert_eq!(spans(Phy::Oqpsk868), [us(800), us(320), us(480), us((12 + 40) * 40)]);
        assert_eq!(spans(Phy::Oqpsk915), spans(Phy::Oqpsk2450));
        let wait = |phy: Phy, symbols| assert_eq!(phy.ack_wait(), phy.symbols(symbols), "{phy:?}");
        wait(Phy::Bpsk868, 120);
        wait(Phy::Bpsk915, 120);
        wait(Phy::Ask868, 20 + 12 + 3 + 3);
        wait(Phy::Ask915, 20 + 12 + 7 + 10);
        wait(Phy::Oqpsk868, 54);
    }

    #[test]
    fn each_layer_is_read_by_its_name() {
        use serde::de::IntoDeserializer;
        for phy in Phy::ALL {
            let name: serde::de::value::StrDeserializer<'_, serde::de::value::Error> = phy.name().into_deserializer();
            assert_eq!(Phy::deserialize(name), Ok(phy));
        }
    }

    #[test]
    fn no_span_is_rounded() {
        let kb_per_s = [250, 20, 40, 250, 250, 100, 250];
        for (phy, rate) in Phy::ALL.into_iter().zip(kb_per_s) {
            assert_eq!(phy.octet() * rate, Duration::from_millis(8), "{phy:?}");
            assert_eq!(phy.airtime(127), phy.header() + 127 * phy.octet(), "{phy:?}");
            assert!((phy.bit_rate_per_s() - 1e3 * f64::from(rate)).abs() < 1e-6, "{phy:?}");
            // The acknowledgement is over before the wait for it is.
            assert!(phy.turnaround() + phy.ack_airtime() < phy.ack_wait(), "{phy:?}");
        }
    }
}
