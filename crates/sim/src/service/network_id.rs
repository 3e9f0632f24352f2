//! The identity of a network.

/// Number of a network of a simulation: stations of one network hear and address each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct NetworkId(pub u8);

impl NetworkId {
    /// The number as an index into per-network tables.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}
