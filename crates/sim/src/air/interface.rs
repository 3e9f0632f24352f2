//! The radio of a station in an air.

use sextant_kernel::StationId;

use super::ReceiverId;

/// The radio of a station in an air: its receiver there, and the station itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Interface {
    pub(crate) receiver: ReceiverId,
    pub(crate) station: StationId,
}
