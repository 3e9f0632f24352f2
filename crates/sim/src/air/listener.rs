//! A receiver that listens.

use sextant_kernel::StationId;

use super::receiver_id::ReceiverId;

/// A receiver that listens, and where its station is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Listener<P> {
    pub(crate) receiver: ReceiverId,
    pub(crate) station: StationId,
    pub(crate) place: P,
}
