//! A frame of a capture.

use sextant_kernel::SimTime;

/// A frame as captured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Captured<'a> {
    /// `None` if the format does not tell it.
    pub(super) time: Option<SimTime>,
    /// Type of the link-layer header, as tcpdump.org numbers them.
    pub(super) link: u16,
    pub(super) octets: &'a [u8],
    /// Whether the frame was longer.
    pub(super) is_cut: bool,
}

/// How a capture ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Whole,
    /// In the middle of a packet, as after a crash of the sniffer.
    Truncated,
}
