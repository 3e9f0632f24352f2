//! Frames of captures: those that are written, and those of any capture that is read.

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::SimTime;

use crate::link_quality::link_quality;

/// Maximum length of a record that is written (octets).
pub(super) const SNAP_LENGTH: u32 = 65_535;

/// A frame of IEEE 802.15.4 in a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapturedFrame<'a> {
    /// First symbol on air.
    pub start: SimTime,
    /// Time on air.
    pub airtime: Duration,
    /// The MAC frame (MPDU) with its check sequence.
    pub mpdu: &'a [u8],
    /// Number of the radio channel.
    pub channel: u8,
    /// Channel page: 0, or 1 for ASK and 2 for O-QPSK below 1 GHz.
    pub page: u8,
    /// How it was received, if the capture is by one receiver.
    pub signal: Option<Signal>,
}

/// How a frame was received.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signal {
    /// Received signal strength (dBm).
    pub power: Dbm,
    /// The lowest power that this receiver can receive (dBm).
    pub sensitivity: Dbm,
}

impl Signal {
    /// Its link quality: see [`link_quality`].
    #[must_use]
    pub fn link_quality(&self) -> u8 {
        link_quality(self.power, self.sensitivity)
    }
}

/// A frame of IEEE 802.11ad in a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapturedDmgFrame<'a> {
    /// First symbol on air.
    pub start: SimTime,
    /// Time on air.
    pub airtime: Duration,
    /// The MAC frame with its check sequence.
    pub octets: &'a [u8],
    /// Carrier frequency (Hz).
    pub carrier_hz: f64,
    /// Received power, if the capture is by one receiver (dBm).
    pub power: Option<Dbm>,
}

/// A frame of a capture that is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaptureRecord<'a> {
    /// When it was captured; `None` if the format does not tell it.
    pub time: Option<SimTime>,
    /// Type of the link-layer header, as tcpdump.org numbers them: see [`link_type`](super::link_type).
    pub link: u16,
    /// Header and frame.
    pub octets: &'a [u8],
    /// Whether the frame was longer.
    pub is_cut: bool,
}

/// How a capture ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaptureEnd {
    /// After a packet.
    Whole,
    /// In the middle of a packet, as after a crash of the sniffer.
    Truncated,
}
