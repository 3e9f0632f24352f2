//! The identity of a receiver.

/// Number of a receiver among those of an air.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct ReceiverId(pub(crate) u32);

impl ReceiverId {
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}
