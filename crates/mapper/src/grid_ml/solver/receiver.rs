//! A stop that received packets from the node.

use sextant_channel::Position;

/// A stop that received packets from the node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReceivingStop {
    pub(crate) place: Position,
    /// Packets received there, above zero.
    pub(crate) packets: u32,
    /// The sector of best reception, if sectors are evidence.
    pub(crate) sector: Option<u8>,
}
