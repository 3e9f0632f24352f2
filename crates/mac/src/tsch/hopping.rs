//! The sequence of channels.

use sextant_kernel::SettingError;

use super::Asn;
use crate::Phy;

/// The default sequence of IEEE 802.15.4 at 2450 MHz, as Contiki-NG and the simulator of 6TiSCH have it.
const OQPSK_2450: [u8; 16] = [16, 17, 23, 18, 26, 15, 25, 22, 19, 11, 12, 13, 24, 14, 20, 21];

/// The channels that a network hops over, in their order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hopping {
    channels: Vec<u8>,
}

impl Hopping {
    /// The usual sequence of a physical layer: that of the standard at 2450 MHz, and all channels in their order elsewhere.
    #[must_use]
    pub fn usual(phy: Phy) -> Self {
        let channels = match phy {
            Phy::Oqpsk2450 => OQPSK_2450.to_vec(),
            _ => phy.channels().collect(),
        };
        Self { channels }
    }

    /// A sequence of these channels.
    ///
    /// # Errors
    /// If there is none, one is named twice, or one is not a channel of `phy`. The key is `hopping`.
    pub fn new(channels: Vec<u8>, phy: Phy) -> Result<Self, SettingError> {
        if channels.is_empty() {
            return Err(SettingError::new("hopping", "empty", "at least one channel"));
        }
        let allowed = phy.channels();
        for (i, channel) in channels.iter().enumerate() {
            let key = format!("hopping[{i}]");
            if !allowed.contains(channel) {
                let allowed = format!("{} to {} with this `phy`", allowed.start(), allowed.end());
                return Err(SettingError::new(key, channel, allowed));
            }
            if channels[..i].contains(channel) {
                return Err(SettingError::new(key, format!("{channel}, which is named before"), "each channel once"));
            }
        }
        Ok(Self { channels })
    }

    /// The channels, in their order.
    #[must_use]
    pub fn channels(&self) -> &[u8] {
        &self.channels
    }

    /// The place in the sequence of the channel of a slot (IEEE 802.15.4-2015, 6.2.6.3).
    #[must_use]
    #[inline]
    pub fn place(&self, asn: Asn, channel_offset: u16) -> usize {
        let place = (asn.0 + u64::from(channel_offset)) % self.channels.len() as u64;
        usize::try_from(place).expect("below the number of channels")
    }

    /// The channel of a slot.
    #[must_use]
    pub fn channel(&self, asn: Asn, channel_offset: u16) -> u8 {
        self.channels[self.place(asn, channel_offset)]
    }

    /// Over how many channels a cell hops that comes once in each slotframe of `length` slots.
    #[must_use]
    pub fn channels_visited(&self, length: u16) -> usize {
        let gcd = |mut a: usize, mut b: usize| {
            while b > 0 {
                (a, b) = (b, a % b);
            }
            a
        };
        self.channels.len() / gcd(self.channels.len(), length.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_channel_of_a_slot_follows_the_sequence() {
        let hopping = Hopping::usual(Phy::Oqpsk2450);
        // Slot, channel offset and channel, worked out by hand from the sequence.
        for (asn, offset, channel) in [
            (0, 0, 16),
            (1, 0, 17),
            (101, 0, 15),
            (513, 0, 17),
            (513, 3, 26),
            (1 << 32, 0, 16),
            ((1 << 40) - 1, 5, 26),
        ] {
            assert_eq!(hopping.channel(Asn(asn), offset), channel, "({asn}, {offset})");
        }
        let four = Hopping::new(vec![15, 25, 26, 20], Phy::Oqpsk2450).expect("good channels");
        assert_eq!(four.channel(Asn(101), 0), 25);
    }

    #[test]
    fn a_slotframe_visits_all_channels_if_its_length_has_no_factor_in_common() {
        let hopping = Hopping::usual(Phy::Oqpsk2450);
        assert_eq!([101, 100, 16, 7].map(|length| hopping.channels_visited(length)), [16, 4, 1, 16]);
    }

    #[test]
    fn channels_that_no_radio_has_are_rejected() {
        let key = |channels: &[u8]| Hopping::new(channels.to_vec(), Phy::Oqpsk2450).err().map(|error| error.key);
        assert_eq!(key(&[]).as_deref(), Some("hopping"));
        assert_eq!(key(&[11, 27]).as_deref(), Some("hopping[1]"));
        assert_eq!(key(&[11, 12, 11]).as_deref(), Some("hopping[2]"));
        assert_eq!(key(&[20]), None);
        assert_eq!(Hopping::usual(Phy::Oqpsk915).channels().len(), 10);
    }
}
