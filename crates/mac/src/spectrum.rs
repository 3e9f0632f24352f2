//! Where the channels of IEEE 802.15.4 lie in the spectrum.

use crate::{Band, Phy};

impl Phy {
    /// Middle of a channel (MHz; IEEE 802.15.4-2006, 6.1.2.1).
    #[must_use]
    pub fn center_mhz(self, channel: u8) -> f64 {
        let channel = f64::from(channel);
        match self.band() {
            Band::Mhz868 => 868.3,
            Band::Mhz915 => 906.0 + 2.0 * (channel - 1.0),
            Band::Mhz2450 => 2405.0 + 5.0 * (channel - 11.0),
        }
    }

    /// Width of the main part of its spectrum, which its receivers take in (MHz): twice the chip rate with BPSK (600 and 300
    /// kchip/s), that of the channel with ASK, and the chip rate with O-QPSK, whose half sines are shaped.
    #[must_use]
    pub const fn bandwidth_mhz(self) -> f64 {
        match self {
            Self::Bpsk868 | Self::Ask868 | Self::Oqpsk868 => 0.6,
            Self::Bpsk915 => 1.2,
            Self::Ask915 | Self::Oqpsk915 | Self::Oqpsk2450 => 2.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_lie_where_the_standard_says() {
        let center_mhz = |phy: Phy, channel| phy.center_mhz(channel).round();
        assert_eq!((center_mhz(Phy::Oqpsk2450, 11), center_mhz(Phy::Oqpsk2450, 26)), (2405.0, 2480.0));
        assert_eq!((center_mhz(Phy::Bpsk915, 1), center_mhz(Phy::Oqpsk915, 10)), (906.0, 924.0));
        assert_eq!((center_mhz(Phy::Ask868, 0), center_mhz(Phy::Bpsk868, 0)), (868.0, 868.0));
    }
}
