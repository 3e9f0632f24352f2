//! Building a log from receptions that come one by one.

use std::sync::Arc;

use sextant_kernel::NodeId;

use super::columns::{ReceptionColumns, scatter};
use super::{Contact, LogError, RangeSample, Reception, ReceptionLog, SectorReport, Stop};
use crate::geometry::position::Position;

/// Builds a [`ReceptionLog`]. Needs the memory of the log, half as much again while the receptions are sorted,
/// and four octets per reception if they do not come node by node.
///
/// ```
/// use sextant_channel::{Position, Reception, ReceptionLogBuilder, Stop};
/// use sextant_kernel::{NodeId, RobotId, SimTime};
///
/// let mut builder = ReceptionLogBuilder::default();
/// for (stop, node) in [(0, 1), (1, 0), (1, 1)] {
///     let node = NodeId(node);
///     builder.push(Reception { node, stop, received: 1, sent: 1, sector: None, rssi_dbm: None, snr_db: None });
/// }
/// let stop = Stop { robot: RobotId(0), time: SimTime::ZERO, position: Position::ORIGIN, heading_rad: None };
/// let log = builder.build(vec!["a".into(), "b".into()], vec![stop; 2], Vec::new())?;
/// assert_eq!(log.of(NodeId(1)).stops(), [0, 1]);
/// # Ok::<(), sextant_channel::LogError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct ReceptionLogBuilder {
    columns: ReceptionColumns,
    nodes: Nodes,
    /// Whether the log has antenna sectors even if no reception names one.
    has_sectors: bool,
    reports: Vec<SectorReport>,
    /// Measured ranges, each with its stop.
    ranges: Vec<(u32, RangeSample)>,
}

/// The node of each reception.
#[derive(Clone, Debug)]
enum Nodes {
    /// In ascending order: each node with the end of its receptions.
    Ascending(Vec<(NodeId, usize)>),
    /// In any order, one by one.
    Mixed(Vec<NodeId>),
}

impl Default for Nodes {
    fn default() -> Self {
        Self::Ascending(Vec::new())
    }
}

impl Nodes {
    /// Appends the node of a reception that comes after `before` others.
    fn push(&mut self, before: usize, node: NodeId) {
        match self {
            Self::Mixed(nodes) => nodes.push(node),
            Self::Ascending(runs) => match runs.last_mut() {
                Some((last, end)) if *last == node => *end += 1,
                Some((last, _)) if *last > node => {
                    let mut nodes = self.listed();
                    nodes.push(node);
                    *self = Self::Mixed(nodes);
                }
                _ => runs.push((node, before + 1)),
            },
        }
    }

    fn listed(&self) -> Vec<NodeId> {
        match self {
            Self::Mixed(nodes) => nodes.clone(),
            Self::Ascending(runs) => {
                let mut nodes = Vec::with_capacity(runs.last().map_or(0, |&(_, end)| end + 1));
                for &(node, end) in runs {
                    nodes.resize(end, node);
                }
                nodes
            }
        }
    }

    /// Each node, with the number of its receptions in a row.
    fn runs(&self) -> impl Iterator<Item = (NodeId, usize)> {
        let (runs, mixed) = match self {
            Self::Ascending(runs) => (runs.as_slice(), [].as_slice()),
            Self::Mixed(nodes) => ([].as_slice(), nodes.as_slice()),
        };
        let starts = std::iter::once(0).chain(runs.iter().map(|&(_, end)| end));
        let lengths = runs.iter().zip(starts).map(|(&(node, end), start)| (node, end - start));
        lengths.chain(mixed.iter().map(|&node| (node, 1)))
    }
}

impl Extend<Reception> for ReceptionLogBuilder {
    fn extend<T: IntoIterator<Item = Reception>>(&mut self, receptions: T) {
        receptions.into_iter().for_each(|reception| self.push(reception));
    }
}

impl ReceptionLogBuilder {
    /// Adds a reception. Receptions may come in any order; node by node and stop by stop is fastest.
    pub fn push(&mut self, reception: Reception) {
        self.nodes.push(self.columns.len(), reception.node);
        self.columns.push(&reception);
    }

    /// The log has antenna sectors, even if none of its receptions names one: it is a part of a log where some do.
    pub fn keep_sectors(&mut self) {
        self.has_sectors = true;
    }

    /// Adds the signal-to-noise ratio of a sector that a node reported beside its reception, before or after that one.
    pub fn report(&mut self, report: SectorReport) {
        self.reports.push(report);
    }

    /// Adds a range that a robot measured while it was at a stop, or on its way from there.
    pub fn range(&mut self, stop: u32, sample: RangeSample) {
        self.ranges.push((stop, sample));
    }

    /// Number of receptions added.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether no reception was added.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Removes the receptions and ranges at the stop `first` and at later stops.
    pub fn forget_from(&mut self, first: u32) {
        let mut reports = std::mem::take(&mut self.reports);
        reports.retain(|report| report.stop < first);
        let mut ranges = std::mem::take(&mut self.ranges);
        ranges.retain(|&(stop, _)| stop < first);
        let mut kept = Self { has_sectors: self.has_sectors, reports, ranges, ..Self::default() };
        let nodes = self.nodes.runs().flat_map(|(node, count)| std::iter::repeat_n(node, count));
        for (at, node) in nodes.enumerate() {
            if self.columns.stops[at] < first {
                kept.push(self.columns.get(node, at));
            }
        }
        *self = kept;
    }

    /// The log of the nodes `names` (index = [`NodeId`]), the `stops` and the `contacts`.
    ///
    /// # Errors
    /// If a reception names a node or stop that does not exist, appears twice, or has more packets than were sent;
    /// if a stop or its heading is not finite, or a stop is farther than 10⁹ m from zero along an axis; if a report of sectors is not of a reception,
    /// appears twice or is not finite; if a range is to a node that does not exist, or is not finite.
    pub fn build(
        self,
        names: Vec<String>,
        stops: Vec<Stop>,
        contacts: Vec<Contact>,
    ) -> Result<ReceptionLog, LogError> {
        for (stop, &Stop { position, heading_rad, .. }) in stops.iter().enumerate() {
            if !position.is_within_reason() {
                let Position { x_m, y_m, z_m } = position;
                return Err(LogError::NotFinite { stop, x_m, y_m, z_m });
            }
            if let Some(heading_rad) = heading_rad.filter(|heading_rad| !heading_rad.is_finite()) {
                return Err(LogError::HeadingNotFinite { stop, heading_rad });
            }
        }
        self.build_at(names, Arc::new(stops), contacts)
    }

    /// The same at stops that have been checked.
    pub(super) fn build_at(
        self,
        names: Vec<String>,
        stops: Arc<Vec<Stop>>,
        contacts: Vec<Contact>,
    ) -> Result<ReceptionLog, LogError> {
        let first = self.check(&names, &stops)?;
        let mut columns = self.columns;
        if self.has_sectors {
            columns.fill_sectors();
        }
        columns.shrink_to_fit();
        if let Nodes::Mixed(mut nodes) = self.nodes {
            // A stable counting sort by stop, then one by node.
            if !columns.stops.is_sorted() {
                let keys = columns.stops.clone();
                let next = starts(stops.len(), keys.iter().map(|&stop| (stop as usize, 1)));
                columns.scatter(|| places(next.clone(), keys.iter().map(|&stop| stop as usize)));
                scatter(&mut nodes, places(next, keys.iter().map(|&stop| stop as usize)));
            }
            columns.scatter(|| places(first.clone(), nodes.iter().map(|node| node.index())));
        } else {
            sort_each(&mut columns, &first);
        }
        for (name, range) in names.iter().zip(first.windows(2)) {
            if let Some(pair) = columns.stops[range[0]..range[1]].windows(2).find(|pair| pair[0] == pair[1]) {
                return Err(LogError::Twice { node: name.clone(), stop: pair[0] });
            }
        }
        let log = ReceptionLog { names, stops, columns, first, contacts, ..ReceptionLog::default() };
        let log = if self.reports.is_empty() { log } else { log.with_sector_snrs(self.reports)? };
        if self.ranges.is_empty() {
            return Ok(log);
        }
        // Robots write a stop when it is over: ranges of several robots come in turns.
        let mut ranges: Vec<RangeSample> = self.ranges.into_iter().map(|(_, sample)| sample).collect();
        ranges.sort_by_key(|sample| sample.time);
        log.with_ranges(ranges)
    }

    /// Checks each reception on its own. Returns where those of each node will begin.
    fn check(&self, names: &[String], stops: &[Stop]) -> Result<Vec<usize>, LogError> {
        let mut at = 0;
        for (node, count) in self.nodes.runs() {
            let name = names.get(node.index()).ok_or(LogError::UnknownNode { node: node.0, nodes: names.len() })?;
            for at in at..at + count {
                let Reception { stop, received, sent, .. } = self.columns.get(node, at);
                if stop as usize >= stops.len() {
                    return Err(LogError::UnknownStop { node: name.clone(), stop, stops: stops.len() });
                }
                if received > sent {
                    return Err(LogError::MoreThanSent { node: name.clone(), stop, received, sent });
                }
            }
            at += count;
        }
        Ok(starts(names.len(), self.nodes.runs().map(|(node, count)| (node.index(), count))))
    }
}

/// Where the values of each of `keys` keys begin after sorting, and where the last ones end.
fn starts(keys: usize, counts: impl Iterator<Item = (usize, usize)>) -> Vec<usize> {
    let mut first = vec![0; keys + 1];
    for (key, count) in counts {
        first[key + 1] += count;
    }
    for key in 1..first.len() {
        first[key] += first[key - 1];
    }
    first
}

/// Where each value goes if values are sorted by their keys; equal keys keep their order.
fn places(mut next: Vec<usize>, keys: impl Iterator<Item = usize>) -> impl Iterator<Item = usize> {
    keys.map(move |key| {
        let place = next[key];
        next[key] += 1;
        place
    })
}

/// Sorts the receptions of each node by stop.
fn sort_each(columns: &mut ReceptionColumns, first: &[usize]) {
    let mut order = Vec::new();
    for range in first.windows(2) {
        if !columns.stops[range[0]..range[1]].is_sorted() {
            order.clear();
            order.extend(range[0]..range[1]);
            order.sort_by_key(|&at| columns.stops[at]);
            columns.gather(range[0], &order);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed};

    /// All pairs of a few nodes and stops, with entries of all kinds.
    fn entries() -> Vec<Reception> {
        let draw = |address| Seed(7).uniform(Purpose::new(8), address);
        let mut all = Vec::new();
        for node in (0..30).filter(|node| node % 7 != 3) {
            for stop in (0..40).filter(|&stop| draw([u64::from(node), stop, 0]) < 0.5) {
                let chance = |kind| draw([u64::from(node), stop, kind]);
                let rssi_dbm = (chance(1) < 0.3).then(|| -40.0 - 60.0 * chance(2));
                let sector = (chance(3) < 0.3).then(|| u8::try_from(node).expect("a small number"));
                let sent = if chance(4) < 0.7 { 1 } else { 3 };
                let stop = u32::try_from(stop).unwrap();
                all.push(Reception { node: NodeId(node), stop, received: 1, sent, sector, rssi_dbm, snr_db: None });
            }
        }
        all
    }

    fn build(receptions: impl IntoIterator<Item = Reception>) -> Result<ReceptionLog, LogError> {
        let mut builder = ReceptionLogBuilder::default();
        builder.extend(receptions);
        let stops = vec![Stop::at(Position::ORIGIN); 40];
        builder.build((0..30).map(|node| format!("n{node}")).collect(), stops, Vec::new())
    }

    #[test]
    fn receptions_in_any_order_give_the_same_log_as_a_comparison_sort() {
        let mut sorted = entries();
        sorted.sort_by_key(|r| (r.node, r.stop));
        let expected = build(sorted.iter().copied()).unwrap();
        assert_eq!(expected.receptions(), sorted);
        for (i, &reception) in sorted.iter().enumerate() {
            assert_eq!(expected.receptions().get(i), Some(reception));
        }
        assert_eq!(expected.receptions().get(sorted.len()), None);
        let by = |key: &dyn Fn(&Reception) -> u64| {
            let mut receptions = entries();
            receptions.sort_by_key(|r| key(r));
            receptions
        };
        let mix = |r: &Reception| {
            let address = [u64::from(r.node.0), u64::from(r.stop), 9];
            Seed(1).uniform(Purpose::new(8), address).to_bits() >> 32
        };
        let by_stop = by(&|r| u64::from(r.stop));
        let backwards = by(&|r| u64::from(u32::MAX - r.stop));
        let nodes_with_mixed_stops = by(&|r| (u64::from(r.node.0) << 32) + mix(r));
        for order in [by_stop, backwards, nodes_with_mixed_stops, by(&mix)] {
            let log = build(order).unwrap();
            assert_eq!(log, expected);
            for node in (0..30).map(NodeId) {
                let of: Vec<Reception> = sorted.iter().copied().filter(|r| r.node == node).collect();
                assert_eq!(log.of(node), of);
                assert_eq!(log.of(node).iter().len(), of.len());
            }
        }
    }

    #[test]
    fn a_repeated_pair_is_found_in_any_order() {
        for repeated in entries().into_iter().step_by(29) {
            let twice = Err(LogError::Twice { node: format!("n{}", repeated.node.0), stop: repeated.stop });
            assert_eq!(build(entries().into_iter().chain([repeated])), twice);
            assert_eq!(build([repeated].into_iter().chain(entries())), twice);
        }
    }

    #[test]
    fn receptions_at_later_stops_are_removed() {
        let mut builder = ReceptionLogBuilder::default();
        builder.extend(entries());
        builder.forget_from(13);
        let stops = vec![Stop::at(Position::ORIGIN); 13];
        let log = builder.build((0..30).map(|node| format!("n{node}")).collect(), stops, Vec::new()).unwrap();
        let kept: Vec<Reception> = entries().into_iter().filter(|r| r.stop < 13).collect();
        assert_eq!(log.receptions(), kept);
    }
}
