//! The identity of a node.

use std::fmt;

/// Identity of a sensor node. Dense: an index from zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub u32);

impl NodeId {
    /// The identity as an index into per-node tables.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// The identity of the node at `index` of a per-node table.
    ///
    /// # Panics
    /// If the index does not fit in 32 bits.
    #[must_use]
    pub fn from_index(index: usize) -> Self {
        Self(u32::try_from(index).expect("at most 2^32 nodes"))
    }
}

impl fmt::Display for NodeId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "n{}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_identity_is_an_index() {
        assert_eq!(NodeId::from_index(7), NodeId(7));
        assert_eq!(NodeId(7).index(), 7);
        assert_eq!(NodeId(5).to_string(), "n5");
    }
}
