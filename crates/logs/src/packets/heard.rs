//! The packets of a node that were heard at a stop.

use sextant_channel::Reception;
use sextant_kernel::{NodeId, SimTime};

use super::gathered::Keyed;
use super::signal::{OfSector, Signal, merged};

/// The packets of one sector of a node that were heard at a stop.
#[derive(Clone, Debug)]
pub(crate) struct HeardPackets {
    pub(crate) node: u32,
    pub(crate) stop: u32,
    pub(crate) received: u32,
    /// Packets of which nothing but noise was received.
    pub(crate) missed: u32,
    pub(crate) signal: Signal,
    /// When the first and the last of them were heard.
    pub(crate) first: SimTime,
    pub(crate) last: SimTime,
}

impl Keyed for HeardPackets {
    type Key = (u32, u32, Option<u8>);

    fn key(&self) -> Self::Key {
        (self.node, self.stop, self.signal.sector)
    }

    fn add(&mut self, later: &Self) {
        self.received = self.received.saturating_add(later.received);
        self.missed = self.missed.saturating_add(later.missed);
        self.signal.add(&later.signal);
        self.first = self.first.min(later.first);
        self.last = self.last.max(later.last);
    }
}

/// What was heard of a node at a stop, in each sector. `sent` is `None` if it is unknown.
pub(crate) fn reception(pair: &[HeardPackets], sent: Option<u32>) -> Reception {
    let received = pair.iter().fold(0, |sum: u32, row| sum.saturating_add(row.received));
    let reported = pair.iter().fold(received, |sum, row| sum.saturating_add(row.missed));
    let sectors = pair.iter().map(|row| OfSector { received: row.received, signal: row.signal });
    let signal = merged(sectors);
    Reception {
        node: NodeId(pair[0].node),
        stop: pair[0].stop,
        received: if sent.is_some() { received } else { received.min(1) },
        sent: sent.map_or(1, |sent| sent.max(reported)),
        sector: signal.and_then(|signal| signal.sector),
        rssi_dbm: signal.and_then(|signal| signal.rssi_dbm()),
        snr_db: signal.and_then(|signal| signal.snr_db()),
    }
}
