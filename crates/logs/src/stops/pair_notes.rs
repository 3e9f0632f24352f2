//! What the user should know of how `receptions.csv` was read.

use sextant_kernel::text::counted;

use crate::packets::gatherer::MOST_SILENT_PAIRS;

/// What the rows of the file are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Listing {
    /// Each row is a packet that was heard or not, or several: the receiver always reports a power.
    Reports,
    /// Each row is a packet.
    Packets,
    /// Each row has the number of packets received.
    Received,
    /// Each row has the number of packets received, and most have the number of those sent.
    ReceivedOfSent,
}

/// Names of the files or tables of a log.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PartNames<'a> {
    pub(crate) stops: &'a str,
    pub(crate) receptions: &'a str,
}

/// What the user should know.
pub(crate) struct PairNotes {
    /// What the rows are.
    pub(crate) listing: Listing,
    /// Whether some row has more than one packet.
    pub(crate) has_counts: bool,
    /// Rows that do not state the packets sent, though the file has a column for them.
    pub(crate) unstated: usize,
    /// Rows of a pair that has a row above.
    pub(crate) repeated: usize,
    /// Absent pairs at stops where another number of packets than one is usual.
    pub(crate) silent_pairs: usize,
    /// Whether these are few enough to be listed.
    pub(crate) fills: bool,
    /// Absent pairs.
    pub(crate) absent: usize,
    /// Pairs of which nothing was received, of nodes that were heard at another stop.
    pub(crate) zeros: usize,
    /// Whether the file of stops states the packets sent.
    pub(crate) is_stated: bool,
    /// Stops at which more packets of a node were received than the file of stops states as sent.
    pub(crate) exceeded: usize,
    /// Whether no packet of a pair that was heard counts as lost, because nothing states the packets sent and the pairs have
    /// strengths.
    pub(crate) is_lossless: bool,
}

impl PairNotes {
    /// Adds the notes to `notes`.
    pub(crate) fn tell(&self, PartNames { stops, receptions }: PartNames<'_>, notes: &mut Vec<String>) {
        let Self { unstated, repeated, silent_pairs, absent, zeros, exceeded, .. } = *self;
        let usual = match self.listing {
            _ if self.is_stated => &format!("`sent` of {stops}"),
            Listing::Reports => "the most reports of a node at the stop",
            Listing::ReceivedOfSent => "the median of `sent` at the stop",
            Listing::Packets | Listing::Received => "the most that were received of a node at the stop",
        };
        let strengths = "have strengths, so none of their packets counts as lost; a pair that was not heard counts as one lost \
                         packet";
        match self.listing {
            Listing::Packets if self.is_lossless => notes.push(format!(
                "{receptions} has no column `received`: each row is a packet; the pairs that were heard {strengths}"
            )),
            Listing::Received if self.is_lossless && self.has_counts => {
                notes.push(format!("{receptions} has no column `sent`: the pairs that were heard {strengths}"))
            }
            Listing::Reports => notes.push(format!(
                "{receptions} has no column `sent`: with option `noise_floor` the packets sent are {usual}"
            )),
            Listing::Packets => notes.push(format!(
                "{receptions} has no column `received`: each row is a packet, and the packets sent are {usual}"
            )),
            Listing::Received if self.has_counts => {
                notes.push(format!("{receptions} has no column `sent`: the packets sent are {usual}"));
            }
            Listing::Received | Listing::ReceivedOfSent => {}
        }
        if repeated > 0 && !matches!(self.listing, Listing::Packets | Listing::Reports) {
            notes.push(format!(
                "{receptions}: {repeated} rows repeat a pair of node and stop; their packets were added up, and levels \
                 averaged over packets"
            ));
        }
        if exceeded > 0 {
            let (at, has) = (counted(exceeded, "stop"), if exceeded == 1 { "has" } else { "have" });
            notes.push(format!(
                "{at} of {stops} {has} a `sent` below the packets of {receptions} that were received there of some node: for such \
                 a node it counts as that many, with no loss; is `sent` of another span of time?"
            ));
        }
        if unstated > 0 {
            notes.push(format!(
                "{receptions}: {unstated} rows do not state `sent`; for them it is {usual}, or `received` if that is more"
            ));
        }
        if silent_pairs > 0 && self.fills {
            notes.push(format!(
                "{receptions}: {silent_pairs} absent pairs of node and stop count as missed packets, as many as {usual} \
                 (0 of 0 means that a node could not have been heard)"
            ));
        } else if silent_pairs > 0 {
            notes.push(format!(
                "{receptions}: {silent_pairs} absent pairs of node and stop are too many to list (at most \
                 {MOST_SILENT_PAIRS}); each counts as one missed packet"
            ));
        }
        if zeros > 0 && absent > 0 && !self.is_stated {
            notes.push(format!(
                "{receptions} lists {zeros} pairs of which nothing was received and leaves out {absent} others; those count \
                 as missed packets too. List all pairs, with 0 of 0 where the robot could not have heard the node"
            ));
        }
    }
}
