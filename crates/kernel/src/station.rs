//! The identity of a station.

use std::fmt;

use crate::NodeId;

/// Identity of a station: everything that has a radio, a node, a robot or a sink. Dense: an index from zero, nodes
/// first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct StationId(pub u32);

impl StationId {
    /// The identity as an index into per-station tables.
    #[must_use]
    #[inline]
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// The identity of the station at `index` of a per-station table.
    ///
    /// # Panics
    /// If the index does not fit in 32 bits.
    #[must_use]
    pub fn from_index(index: usize) -> Self {
        Self(u32::try_from(index).expect("at most 2^32 stations"))
    }
}

/// Nodes are the first stations.
impl From<NodeId> for StationId {
    #[inline]
    fn from(node: NodeId) -> Self {
        Self(node.0)
    }
}

impl fmt::Display for StationId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "station {}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_identity_is_an_index() {
        assert_eq!(StationId::from_index(7), StationId(7));
        assert_eq!(StationId(7).index(), 7);
        assert_eq!(StationId::from(NodeId(5)), StationId(5));
        assert_eq!(StationId(5).to_string(), "station 5");
    }
}
