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

/// Sectors of the two ends of a link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SectorCounts {
    pub(crate) own: u8,
    pub(crate) peer: u8,
}

/// The powers of a link for all sectors of both ends, of frames that begin now: see
/// [`Port::sector_powers`](crate::Port::sector_powers).
#[derive(Clone, Debug, PartialEq)]
pub struct SectorPowers {
    to_peer: Vec<Dbm>,
    from_peer: Vec<Dbm>,
    /// By own sector, then by sector of the peer.
    pairs: Vec<Dbm>,
}

/// A sector of each end of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SectorPair {
    /// That of the station itself.
    pub own: u8,
    /// That of its peer.
    pub peer: u8,
}

impl SectorPowers {
    pub(crate) fn new(to_peer: Vec<Dbm>, from_peer: Vec<Dbm>, pairs: Vec<Dbm>) -> Self {
        Self { to_peer, from_peer, pairs }
    }

    /// Power at the peer, which listens in all directions, from each own sector.
    #[must_use]
    pub fn to_peer(&self) -> &[Dbm] {
        &self.to_peer
    }

    /// Power at the station, which listens in all directions, from each sector of the peer.
    #[must_use]
    pub fn from_peer(&self) -> &[Dbm] {
        &self.from_peer
    }

    /// Power if both ends point: the same in both directions with equal transmit powers.
    ///
    /// # Panics
    /// If an end has no such sector.
    #[must_use]
    pub fn pair(&self, SectorPair { own, peer }: SectorPair) -> Dbm {
        assert!(usize::from(peer) < self.from_peer.len(), "the peer has no sector {peer}");
        self.pairs[usize::from(own) * self.from_peer.len() + usize::from(peer)]
    }

    /// The greatest power of all pairs of sectors.
    #[must_use]
    pub fn best(&self) -> Dbm {
        self.pairs.iter().copied().fold(Dbm::SILENCE, |best, power| if power > best { power } else { best })
    }
}
