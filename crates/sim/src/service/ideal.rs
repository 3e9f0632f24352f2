//! What a station would receive with ideal channel access.

use sextant_channel::Dbm;
use sextant_kernel::NodeId;

/// A frame that a station would receive with ideal channel access: see
/// [`Port::ideal_receptions`](crate::Port::ideal_receptions).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdealReception {
    /// The node that sends it.
    pub node: NodeId,
    /// Transmit power of the node, without its antenna.
    pub tx_power: Dbm,
    /// Power at the receiver.
    pub rssi: Dbm,
}
