//! A view of some receptions of a log.

use std::fmt;
use std::ops::Range;

use sextant_kernel::NodeId;

use super::columns::Packets;
use super::{Reception, ReceptionLog};

/// Receptions of one node or of all, in the order of the log. Copies refer to the same log.
#[derive(Clone, Copy)]
pub struct Receptions<'a> {
    log: &'a ReceptionLog,
    /// Receptions of the log from `start` up to `end`, `end` excluded.
    start: usize,
    end: usize,
    /// The node of the first of these receptions, or an earlier node.
    first_node: usize,
}

impl<'a> Receptions<'a> {
    pub(super) fn of_nodes(log: &'a ReceptionLog, nodes: Range<usize>) -> Self {
        Self { log, start: log.first[nodes.start], end: log.first[nodes.end], first_node: nodes.start }
    }

    /// Number of receptions.
    #[must_use]
    pub fn len(self) -> usize {
        self.end - self.start
    }

    /// Whether there are no receptions.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.start == self.end
    }

    /// The reception at `index`; `None` beyond the last. The time grows with the logarithm of the number of nodes in
    /// the view.
    #[must_use]
    pub fn get(self, index: usize) -> Option<Reception> {
        let at = self.start.checked_add(index).filter(|&at| at < self.end)?;
        let later = &self.log.first[self.first_node + 1..];
        let node = self.first_node + later.partition_point(|&first| first <= at);
        Some(self.log.columns.get(NodeId::from_index(node), at))
    }

    /// The receptions, one after the other.
    #[must_use]
    pub fn iter(self) -> ReceptionsIter<'a> {
        ReceptionsIter { node: self.first_node, rest: self }
    }

    /// The receptions as a list.
    #[must_use]
    pub fn to_vec(self) -> Vec<Reception> {
        self.iter().collect()
    }

    /// Indices of the stops.
    #[must_use]
    pub fn stops(self) -> &'a [u32] {
        &self.log.columns.stops[self.start..self.end]
    }

    /// Packets received and sent, one pair per reception; `None` if every reception of the log is one packet of one.
    #[must_use]
    pub fn packets(self) -> Option<impl ExactSizeIterator<Item = (u32, u32)> + Clone + 'a> {
        let packets = self.log.columns.packets.slice(self.start..self.end)?;
        Some(packets.iter().map(|&Packets { received, sent }| (received, sent)))
    }

    /// Sectors with the best reception; `None` if no reception of the log has a sector.
    #[must_use]
    pub fn sectors(self) -> Option<&'a [Option<u8>]> {
        self.log.columns.sectors.slice(self.start..self.end)
    }
}

impl fmt::Debug for Receptions<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries(self.iter()).finish()
    }
}

impl PartialEq for Receptions<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

impl<T: AsRef<[Reception]>> PartialEq<T> for Receptions<'_> {
    fn eq(&self, other: &T) -> bool {
        self.iter().eq(other.as_ref().iter().copied())
    }
}

impl<'a> IntoIterator for Receptions<'a> {
    type Item = Reception;
    type IntoIter = ReceptionsIter<'a>;

    fn into_iter(self) -> ReceptionsIter<'a> {
        self.iter()
    }
}

impl<'a> IntoIterator for &Receptions<'a> {
    type Item = Reception;
    type IntoIter = ReceptionsIter<'a>;

    fn into_iter(self) -> ReceptionsIter<'a> {
        self.iter()
    }
}

/// Iterator over [`Receptions`].
#[derive(Clone, Debug)]
pub struct ReceptionsIter<'a> {
    rest: Receptions<'a>,
    /// The node of the next reception, or an earlier node.
    node: usize,
}

impl Iterator for ReceptionsIter<'_> {
    type Item = Reception;

    fn next(&mut self) -> Option<Reception> {
        let at = self.rest.start;
        if at == self.rest.end {
            return None;
        }
        while self.rest.log.first[self.node + 1] <= at {
            self.node += 1;
        }
        self.rest.start += 1;
        self.rest.first_node = self.node;
        Some(self.rest.log.columns.get(NodeId::from_index(self.node), at))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.rest.len(), Some(self.rest.len()))
    }
}

impl ExactSizeIterator for ReceptionsIter<'_> {}
