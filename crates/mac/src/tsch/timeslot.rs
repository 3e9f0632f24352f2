//! What happens when within a slot.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

use crate::Phy;
use crate::timing::MAX_MPDU_OCTETS;

/// Longest slot (us).
const LONGEST_SLOT_US: u32 = 1_000_000;

/// The template of a slot, as written in a scenario. All spans are in microseconds. That of a frame or an acknowledgement is up
/// to the end of its start-of-frame delimiter, as radios time-stamp it. Defaults are those of a slot of 10 ms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct TimeslotConfig {
    /// Length of a slot (us) (macTsTimeslotLength): at most 1000000, and so much that the longest frame and its
    /// acknowledgement fit.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 1000000)))]
    pub length_us: u32,
    /// From the start of the slot to the frame (us) (macTsTxOffset).
    pub tx_offset_us: u32,
    /// From the start of the slot to when the receiver is on (us) (macTsRxOffset). The standard has 1120; with 1020 the
    /// window is as long before the frame as after it.
    pub rx_offset_us: u32,
    /// How long the receiver waits for the start of a frame (us) (macTsRxWait): twice the guard time.
    pub rx_wait_us: u32,
    /// From the end of the frame to its acknowledgement (us) (macTsTxAckDelay).
    pub tx_ack_delay_us: u32,
    /// From the end of the frame to when its sender listens for the acknowledgement (us) (macTsRxAckDelay).
    pub rx_ack_delay_us: u32,
    /// How long it waits for the start of the acknowledgement (us) (macTsAckWait).
    pub ack_wait_us: u32,
}

impl Default for TimeslotConfig {
    fn default() -> Self {
        Self {
            length_us: 10_000,
            tx_offset_us: 2120,
            rx_offset_us: 1020,
            rx_wait_us: 2200,
            tx_ack_delay_us: 1000,
            rx_ack_delay_us: 800,
            ack_wait_us: 400,
        }
    }
}

/// The template of a slot, checked (IEEE 802.15.4-2015, 6.5.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timeslot {
    written: TimeslotConfig,
    phy: Phy,
}

impl Timeslot {
    /// The template for the frames of a physical layer.
    ///
    /// # Errors
    /// If the longest frame and an acknowledgement of `ack_octets` do not fit, or a window does not hold what it is for. The keys
    /// are those of the table.
    pub fn new(config: TimeslotConfig, phy: Phy, ack_octets: u8) -> Result<Self, SettingError> {
        let TimeslotConfig { length_us, tx_offset_us, rx_offset_us, rx_wait_us, .. } = config;
        let TimeslotConfig { tx_ack_delay_us, rx_ack_delay_us, ack_wait_us, .. } = config;
        let slot = Self { written: config, phy };
        let header_us = micros(phy.synchronisation_header());
        let delimiter_us = micros(slot.delimiter());
        if tx_offset_us < header_us {
            let allowed = format!("at least {header_us}, the synchronisation header before the frame");
            return Err(SettingError::new("tx_offset_us", tx_offset_us, allowed));
        }
        // A frame at its instant is heard: its delimiter begins within the window.
        let begins_us = tx_offset_us - delimiter_us;
        if rx_offset_us > begins_us {
            return Err(SettingError::new("rx_offset_us", rx_offset_us, format!("at most {begins_us}")));
        }
        let least_us = begins_us - rx_offset_us + 1;
        if rx_wait_us < least_us || rx_wait_us > length_us {
            let allowed = format!("{least_us}, so that a frame at its instant is heard, to `length_us`");
            return Err(SettingError::new("rx_wait_us", rx_wait_us, allowed));
        }
        let least_us = header_us.max(micros(phy.turnaround()));
        if tx_ack_delay_us < least_us {
            let allowed = format!("at least {least_us}: a turnaround and the synchronisation header");
            return Err(SettingError::new("tx_ack_delay_us", tx_ack_delay_us, allowed));
        }
        let begins_us = tx_ack_delay_us - delimiter_us;
        if rx_ack_delay_us > begins_us {
            return Err(SettingError::new("rx_ack_delay_us", rx_ack_delay_us, format!("at most {begins_us}")));
        }
        let least_us = begins_us - rx_ack_delay_us + 1;
        if ack_wait_us < least_us || ack_wait_us > length_us {
            let allowed = format!("{least_us}, so that an acknowledgement at its instant is heard, to `length_us`");
            return Err(SettingError::new("ack_wait_us", ack_wait_us, allowed));
        }
        let after_delimiter = |octets: u8| phy.airtime(octets) - phy.synchronisation_header();
        let frame_end_us = tx_offset_us + micros(after_delimiter(MAX_MPDU_OCTETS));
        let ack_end_us = tx_ack_delay_us + micros(after_delimiter(ack_octets));
        let least_us = frame_end_us + ack_end_us.max(rx_ack_delay_us + ack_wait_us);
        if length_us < least_us || length_us > LONGEST_SLOT_US {
            let allowed =
                format!("{least_us}, so that the longest frame and its acknowledgement fit, to {LONGEST_SLOT_US}");
            return Err(SettingError::new("length_us", length_us, allowed));
        }
        Ok(slot)
    }

    /// Length of a slot.
    #[must_use]
    #[inline]
    pub const fn length(&self) -> Duration {
        Duration::from_micros(self.written.length_us as u64)
    }

    /// From the start of the slot to the first symbol of a frame.
    #[must_use]
    #[inline]
    pub fn frame_begins(&self) -> Duration {
        Duration::from_micros(self.written.tx_offset_us.into()) - self.phy.synchronisation_header()
    }

    /// From the start of the slot to when the receiver is on.
    #[must_use]
    #[inline]
    pub const fn window_opens(&self) -> Duration {
        Duration::from_micros(self.written.rx_offset_us as u64)
    }

    /// How long the receiver waits for the start of a frame.
    #[must_use]
    #[inline]
    pub const fn window(&self) -> Duration {
        Duration::from_micros(self.written.rx_wait_us as u64)
    }

    /// From the end of a frame to the first symbol of its acknowledgement.
    #[must_use]
    #[inline]
    pub fn ack_begins(&self) -> Duration {
        Duration::from_micros(self.written.tx_ack_delay_us.into()) - self.phy.synchronisation_header()
    }

    /// From the end of a frame to when its sender listens for the acknowledgement.
    #[must_use]
    #[inline]
    pub const fn ack_window_opens(&self) -> Duration {
        Duration::from_micros(self.written.rx_ack_delay_us as u64)
    }

    /// How long it waits for the start of the acknowledgement.
    #[must_use]
    #[inline]
    pub const fn ack_window(&self) -> Duration {
        Duration::from_micros(self.written.ack_wait_us as u64)
    }

    /// From the first symbol of a frame to its delimiter: that must begin while the receiver is on.
    #[must_use]
    #[inline]
    pub fn preamble(&self) -> Duration {
        self.phy.synchronisation_header() - self.delimiter()
    }

    /// The delimiter at the end of the synchronisation header.
    fn delimiter(&self) -> Duration {
        self.phy.octet()
    }
}

/// A span of less than an hour in whole microseconds, rounded up.
fn micros(span: Duration) -> u32 {
    u32::try_from(span.as_nanos().div_ceil(1000)).expect("less than an hour")
}

#[cfg(test)]
mod tests {
    use super::*;

    const ACK_OCTETS: u8 = 19;

    #[test]
    fn the_default_slot_holds_the_longest_frame_and_its_acknowledgement() {
        let slot = Timeslot::new(TimeslotConfig::default(), Phy::Oqpsk2450, ACK_OCTETS).expect("a good slot");
        let us = Duration::from_micros;
        assert_eq!((slot.length(), slot.frame_begins(), slot.preamble()), (us(10_000), us(1960), us(128)));
        assert_eq!((slot.window_opens(), slot.window()), (us(1020), us(2200)));
        assert_eq!(slot.ack_begins(), us(840));
        // 2120 + 128 octets, 1000 + 20 octets after the delimiters, at 32 us each.
        let tight = |length_us| {
            let config = TimeslotConfig { length_us, ..TimeslotConfig::default() };
            Timeslot::new(config, Phy::Oqpsk2450, ACK_OCTETS).map(drop).map_err(|error| error.key)
        };
        assert_eq!(tight(2120 + 4096 + 1000 + 640), Ok(()));
        assert_eq!(tight(2120 + 4096 + 1000 + 639), Err("length_us".to_owned()));
    }

    #[test]
    fn slow_radios_need_long_slots() {
        let with = |phy, length_us| {
            let config =
                TimeslotConfig { length_us, tx_offset_us: 4000, rx_offset_us: 1000, ..TimeslotConfig::default() };
            let config = TimeslotConfig { rx_wait_us: 5000, tx_ack_delay_us: 4000, rx_ack_delay_us: 2000, ..config };
            Timeslot::new(TimeslotConfig { ack_wait_us: 3000, ..config }, phy, ACK_OCTETS)
                .err()
                .map(|error| error.key)
        };
        assert_eq!(with(Phy::Bpsk915, 10_000).as_deref(), Some("length_us"));
        assert_eq!(with(Phy::Bpsk915, 40_000), None);
        // The synchronisation header of 868 MHz takes 2 ms.
        assert_eq!(with(Phy::Bpsk868, 80_000), None);
    }

    #[test]
    fn windows_that_hold_nothing_are_rejected() {
        let good = TimeslotConfig::default();
        let key = |config| Timeslot::new(config, Phy::Oqpsk2450, ACK_OCTETS).err().map(|error| error.key);
        assert_eq!(key(TimeslotConfig { tx_offset_us: 100, ..good }).as_deref(), Some("tx_offset_us"));
        assert_eq!(key(TimeslotConfig { rx_offset_us: 2089, ..good }).as_deref(), Some("rx_offset_us"));
        assert_eq!(key(TimeslotConfig { rx_wait_us: 1000, ..good }).as_deref(), Some("rx_wait_us"));
        assert_eq!(key(TimeslotConfig { tx_ack_delay_us: 100, ..good }).as_deref(), Some("tx_ack_delay_us"));
        assert_eq!(key(TimeslotConfig { rx_ack_delay_us: 969, ..good }).as_deref(), Some("rx_ack_delay_us"));
        assert_eq!(key(TimeslotConfig { ack_wait_us: 168, ..good }).as_deref(), Some("ack_wait_us"));
        assert_eq!(key(TimeslotConfig { length_us: 2_000_000, ..good }).as_deref(), Some("length_us"));
    }
}
