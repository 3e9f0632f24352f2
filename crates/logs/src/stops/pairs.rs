//! The rows of `receptions.csv` as receptions: rows of one pair are added up, and pairs without a row get what the log says of
//! others at the stop.

use sextant_channel::{Reception, ReceptionLogBuilder};
use sextant_kernel::NodeId;

use super::pair_notes::{Listing, PairNotes, PartNames};
use super::stated::Stated;
use crate::packets::gathered::{Gathered, Keyed};
use crate::packets::gatherer::{MOST_SILENT_PAIRS, silent};
use crate::packets::signal::{OfSector, Signal, Strength, merged};

/// The packets of a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairCount {
    pub(crate) received: u32,
    /// As the row states it.
    pub(crate) sent: Option<u32>,
}

/// What is kept of the signal of a row: nothing if the file has no such columns.
pub(crate) trait Kept: Copy {
    fn of(signal: Signal) -> Self;
    fn signal(&self) -> Option<Signal>;
    fn add(&mut self, later: &Self);
}

impl Kept for () {
    fn of(_: Signal) -> Self {}

    fn signal(&self) -> Option<Signal> {
        None
    }

    fn add(&mut self, (): &Self) {}
}

impl Kept for Strength {
    fn of(signal: Signal) -> Self {
        signal.into()
    }

    fn signal(&self) -> Option<Signal> {
        Some((*self).into())
    }

    fn add(&mut self, later: &Self) {
        let mut all = Signal::from(*self);
        all.add(&(*later).into());
        *self = all.into();
    }
}

impl Kept for Signal {
    fn of(signal: Signal) -> Self {
        signal
    }

    fn signal(&self) -> Option<Signal> {
        Some(*self)
    }

    fn add(&mut self, later: &Self) {
        Signal::add(self, later);
    }
}

/// The rows of a node at a stop in one sector.
#[derive(Clone, Copy, Debug)]
struct Entry<S> {
    node: u32,
    stop: u32,
    received: u32,
    /// Packets sent, or [`UNSTATED`].
    sent: u32,
    signal: S,
}

/// No row of the pair states the packets sent, though the file has a column for them.
const UNSTATED: u32 = u32::MAX;

impl<S: Kept> Keyed for Entry<S> {
    type Key = (u32, u32, Option<u8>);

    fn key(&self) -> Self::Key {
        (self.node, self.stop, self.signal.signal().and_then(|signal| signal.sector))
    }

    fn add(&mut self, later: &Self) {
        self.sent = self.packets().sent_with(later.packets());
        self.received = self.received.saturating_add(later.received).min(UNSTATED - 1);
        self.signal.add(&later.signal);
    }
}

impl<S> Entry<S> {
    fn packets(&self) -> RowPackets {
        RowPackets { received: self.received, sent: self.sent }
    }
}

/// The packets of a row.
#[derive(Clone, Copy)]
struct RowPackets {
    received: u32,
    /// [`UNSTATED`] if the row does not state it.
    sent: u32,
}

impl RowPackets {
    /// The packets sent of two rows. A row that does not state them counts as one, or as those that were received, if another
    /// row states them.
    fn sent_with(self, later: Self) -> u32 {
        let at_least = |row: Self| if row.sent == UNSTATED { row.received.max(1) } else { row.sent };
        if self.sent == UNSTATED && later.sent == UNSTATED {
            return UNSTATED;
        }
        at_least(self).saturating_add(at_least(later)).min(UNSTATED - 1)
    }
}

/// The packets of a pair of a node and a stop, in all sectors.
struct Pair {
    node: u32,
    stop: u32,
    received: u32,
    sent: u32,
    signal: Option<Signal>,
}

impl Pair {
    fn of<S: Kept>(entries: &[Entry<S>]) -> Self {
        let [Entry { node, stop, .. }, ..] = entries else { unreachable!("a pair has a row") };
        let mut sum = RowPackets { received: 0, sent: entries[0].sent };
        for (at, entry) in entries.iter().enumerate() {
            if at > 0 {
                sum.sent = sum.sent_with(entry.packets());
            }
            sum.received = sum.received.saturating_add(entry.received).min(UNSTATED - 1);
        }
        let of_sector =
            |entry: &Entry<S>| Some(OfSector { received: entry.received, signal: entry.signal.signal()? });
        let signal = merged(entries.iter().filter_map(of_sector));
        Self { node: *node, stop: *stop, received: sum.received, sent: sum.sent, signal }
    }
}

/// Takes rows and gives receptions.
pub(crate) struct Collector<S> {
    listing: Listing,
    entries: Gathered<Entry<S>>,
    /// Whether some row has more than one packet.
    has_counts: bool,
    /// Rows that do not state the packets sent, though the file has a column for them.
    unstated: usize,
}

impl<S: Kept> Collector<S> {
    pub(crate) fn new(listing: Listing) -> Self {
        Self { listing, entries: Gathered::new(), has_counts: false, unstated: 0 }
    }

    /// Adds a row.
    pub(crate) fn push(&mut self, node: u32, stop: u32, PairCount { received, sent }: PairCount, signal: Signal) {
        self.has_counts |= received > 1;
        let sent = match (sent, self.listing) {
            (Some(sent), _) => sent,
            (None, Listing::ReceivedOfSent) => {
                self.unstated += 1;
                UNSTATED
            }
            (None, Listing::Reports | Listing::Packets | Listing::Received) => received.max(1),
        };
        self.entries.push(Entry { node, stop, received, sent, signal: S::of(signal) });
    }

    /// The rows that came.
    pub(crate) fn collect(self) -> Collected<S> {
        let Self { listing, has_counts, unstated, .. } = self;
        let (entries, repeated) = self.entries.finish();
        Collected { listing, entries, has_counts, unstated, repeated }
    }

    /// The receptions of `nodes` nodes. `at_stop` are the packets that a node sent at each stop, where the file of stops says
    /// so.
    pub(crate) fn finish(
        self,
        nodes: usize,
        at_stop: &[Option<u32>],
        parts: PartNames<'_>,
        notes: &mut Vec<String>,
    ) -> ReceptionLogBuilder {
        let collected = self.collect();
        let mut seen = Seen::new(collected.listing, at_stop.len());
        seen.add(&collected);
        collected.receptions(&seen.rule(nodes, at_stop, parts, notes))
    }
}

/// The rows of some nodes, sorted, with those of one pair and sector added up.
pub(crate) struct Collected<S> {
    listing: Listing,
    entries: Vec<Entry<S>>,
    has_counts: bool,
    unstated: usize,
    /// Rows that were added to others.
    repeated: usize,
}

impl<S: Kept> Collected<S> {
    fn pairs(&self) -> impl Iterator<Item = Pair> {
        self.entries.chunk_by(|a, b| (a.node, a.stop) == (b.node, b.stop)).map(Pair::of)
    }

    /// The receptions, by the rule of the whole log.
    pub(crate) fn receptions(&self, rule: &Rule) -> ReceptionLogBuilder {
        let Rule { listing, usual, fills, is_lossless, is_counted, is_stated } = rule;
        let mut receptions = ReceptionLogBuilder::default();
        let mut pairs = self.pairs().peekable();
        while let Some(node) = pairs.peek().map(|pair| pair.node) {
            let mut next_stop = 0;
            let mut pass_to = |stop: u32, receptions: &mut ReceptionLogBuilder| {
                if *fills {
                    for stop in (next_stop..stop).filter(|&stop| usual[stop as usize] != 1) {
                        receptions.push(silent(NodeId(node), stop, usual[stop as usize]));
                    }
                }
                next_stop = stop + 1;
            };
            while let Some(pair) = pairs.next_if(|pair| pair.node == node) {
                pass_to(pair.stop, &mut receptions);
                let usual = usual[pair.stop as usize];
                let is_open =
                    pair.sent == UNSTATED || *is_counted || *listing != Listing::ReceivedOfSent && *is_stated;
                let sent = if is_open || *is_lossless { usual.max(pair.received) } else { pair.sent };
                // 0 of 1 packets means the same as an absent pair.
                if (pair.received, sent, pair.signal.is_some_and(|signal| !signal.is_unknown())) != (0, 1, false) {
                    receptions.push(pair.reception(sent));
                }
            }
            pass_to(u32::try_from(usual.len()).expect("fewer than 2^32 stops"), &mut receptions);
        }
        receptions
    }
}

/// How pairs become receptions, by all rows of a log.
#[derive(Debug)]
pub(crate) struct Rule {
    listing: Listing,
    /// Packets that a node usually sends at each stop.
    usual: Vec<u32>,
    /// Whether pairs without a row are listed where another number of packets than one is usual.
    fills: bool,
    is_lossless: bool,
    is_counted: bool,
    is_stated: bool,
}

impl Pair {
    fn reception(&self, sent: u32) -> Reception {
        Reception {
            node: NodeId(self.node),
            stop: self.stop,
            received: self.received,
            sent,
            sector: self.signal.and_then(|signal| signal.sector),
            rssi_dbm: self.signal.and_then(|signal| signal.rssi_dbm()),
            snr_db: self.signal.and_then(|signal| signal.snr_db()),
        }
    }
}

/// What the pairs with rows say of each stop.
#[derive(Debug)]
pub(crate) struct Seen {
    listing: Listing,
    has_counts: bool,
    unstated: usize,
    repeated: usize,
    /// Pairs with a row at each stop.
    pairs: Vec<usize>,
    /// Most packets received of a node at each stop; of reports, those of noise count too.
    most: Vec<u32>,
    /// The numbers of packets sent that pairs state.
    stated: Stated,
    /// Pairs of which nothing was received, of nodes that were heard at another stop.
    zeros: usize,
    /// Pairs of which something was received, and those of them that have a strength.
    heard: usize,
    with_strength: usize,
}

impl Seen {
    /// Nothing yet, at so many stops.
    pub(crate) fn new(listing: Listing, stops: usize) -> Self {
        Self {
            listing,
            has_counts: false,
            unstated: 0,
            repeated: 0,
            pairs: vec![0; stops],
            most: vec![0; stops],
            stated: Stated::new(stops),
            zeros: 0,
            heard: 0,
            with_strength: 0,
        }
    }

    /// Adds all rows of some nodes.
    pub(crate) fn add<S: Kept>(&mut self, collected: &Collected<S>) {
        let seen = self;
        seen.has_counts |= collected.has_counts;
        seen.unstated += collected.unstated;
        seen.repeated += collected.repeated;
        let (mut node, mut is_heard, mut zeros) = (None, false, 0);
        for pair in collected.pairs() {
            if node.replace(pair.node) != Some(pair.node) {
                seen.zeros += if is_heard { zeros } else { 0 };
                (is_heard, zeros) = (false, 0);
            }
            is_heard |= pair.received > 0;
            if pair.received > 0 {
                seen.heard += 1;
                seen.with_strength += usize::from(pair.signal.is_some_and(|signal| signal.rssi_dbm().is_some()));
            }
            zeros += usize::from(pair.received == 0 && pair.sent > 0);
            let stop = pair.stop as usize;
            seen.pairs[stop] += 1;
            let reported = if seen.listing == Listing::Reports { pair.sent } else { pair.received };
            seen.most[stop] = seen.most[stop].max(reported);
            if seen.listing == Listing::ReceivedOfSent && pair.sent != UNSTATED && pair.sent > 0 {
                seen.stated.add(pair.stop, pair.sent);
            }
        }
        seen.zeros += if is_heard { zeros } else { 0 };
    }

    /// How pairs become receptions, in a log of `nodes` nodes. `at_stop` are the packets that a node sent at each stop, where
    /// the file of stops says so.
    pub(crate) fn rule(
        &self,
        nodes: usize,
        at_stop: &[Option<u32>],
        parts: PartNames<'_>,
        notes: &mut Vec<String>,
    ) -> Rule {
        let Self { listing, has_counts, unstated, repeated, zeros, .. } = *self;
        let is_stated = at_stop.iter().any(Option::is_some);
        // Where nothing states the packets sent, a strength tells how far a node is, and a loss would be invented.
        let is_lossless =
            matches!(listing, Listing::Packets | Listing::Received) && !is_stated && self.has_strengths();
        let is_counted = !is_lossless
            && (matches!(listing, Listing::Reports | Listing::Packets) || listing == Listing::Received && has_counts);
        let usual: Vec<u32> = match listing {
            _ if is_lossless => vec![1; at_stop.len()],
            Listing::ReceivedOfSent => self.stated.medians(),
            Listing::Received if !has_counts => vec![1; at_stop.len()],
            Listing::Reports | Listing::Packets | Listing::Received => {
                self.most.iter().map(|&most| most.max(1)).collect()
            }
        };
        // A row that states what was sent is checked as it is read.
        let exceeded =
            at_stop.iter().zip(&self.most).filter(|(sent, most)| sent.is_some_and(|sent| sent < **most)).count();
        let usual: Vec<u32> = at_stop.iter().zip(usual).map(|(stated, usual)| stated.unwrap_or(usual)).collect();
        let absent_at = |stop: usize| nodes - self.pairs[stop];
        let silent_pairs: usize = (0..usual.len()).filter(|&stop| usual[stop] != 1).map(&absent_at).sum();
        let fills = silent_pairs <= MOST_SILENT_PAIRS;
        let absent = (0..usual.len()).map(absent_at).sum();
        PairNotes {
            listing,
            has_counts,
            unstated,
            repeated,
            silent_pairs,
            fills,
            absent,
            zeros,
            is_stated,
            exceeded: if listing == Listing::ReceivedOfSent { 0 } else { exceeded },
            is_lossless,
        }
        .tell(parts, notes);
        Rule { listing, usual, fills: fills && silent_pairs > 0, is_lossless, is_counted, is_stated }
    }

    /// Whether most of the pairs that were heard have a strength.
    fn has_strengths(&self) -> bool {
        2 * self.with_strength > self.heard
    }
}
