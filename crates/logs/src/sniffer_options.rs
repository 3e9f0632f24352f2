//! What the user says of a capture.

/// What belongs to the capture of a sniffer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SnifferOptions {
    /// Use only frames of this IEEE 802.15.4 PAN, 0xabcd for example. The default is all; nodes with a short address are then
    /// named with their PAN if the capture has several
    pub pan: Option<u16>,
}
