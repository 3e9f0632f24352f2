//! Data over a link: which rate it has, and what it brings in a time in which nothing changes.

use std::time::Duration;

use sextant_channel::Db;
use sextant_kernel::NodeId;
use sextant_mac::dmg::data::{Exchange, Mcs};
use sextant_sim::SectorPair;

/// A link that is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeldLink {
    pub(super) node: NodeId,
    pub(super) pair: SectorPair,
    /// The scheme of the next frame: the fastest one at the ratio that was heard last.
    pub(super) mcs: Mcs,
}

/// What the data of a span came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sent {
    /// Bits of payload that arrived, ...
    pub(super) bits: u64,
    /// ... frames on air, and those of them that did not.
    pub(super) frames: u64,
    pub(super) lost: u64,
    /// Whether the last frame was acknowledged.
    pub(super) is_heard: bool,
}

/// What arrives in `left` with the scheme of all frames.
fn steady(mcs: Mcs, mut left: Duration) -> Sent {
    let mut sent = Sent { is_heard: true, ..Sent::default() };
    while let Some(exchange) = Exchange::within(mcs, left) {
        // As many as fit, and then a shorter one.
        let count = left.as_nanos() / exchange.span.as_nanos();
        let count = u32::try_from(count).expect("a span has few exchanges");
        sent.bits += exchange.bits() * u64::from(count);
        sent.frames += u64::from(count);
        left -= exchange.span * count;
    }
    sent
}

/// What arrives in `span` at this ratio if the scheme is always the fastest one.
pub(super) fn ideal_bits(snr: Db, span: Duration) -> u64 {
    Mcs::fastest_at(snr).map_or(0, |mcs| steady(mcs, span).bits)
}

impl HeldLink {
    /// Sends for `span` at this ratio. Each frame that is not acknowledged is followed by one with the next slower scheme.
    /// If the slowest is not acknowledged, the rest of the span is over.
    pub(super) fn send(&mut self, snr: Db, span: Duration) -> Sent {
        let (mut left, mut lost) = (span, 0);
        while self.mcs.least_snr().0 > snr.0 {
            let Some(exchange) = Exchange::within(self.mcs, left) else { break };
            left -= exchange.span;
            lost += 1;
            match self.mcs.slower() {
                Some(slower) => self.mcs = slower,
                None => return Sent { frames: lost, lost, ..Sent::default() },
            }
        }
        let Some(first) = Exchange::within(self.mcs, left).filter(|_| self.mcs.least_snr().0 <= snr.0) else {
            return Sent { frames: lost, lost, ..Sent::default() };
        };
        // Its acknowledgement tells the ratio.
        let fastest = Mcs::fastest_at(snr).unwrap_or(self.mcs);
        let rest = steady(fastest, left - first.span);
        self.mcs = fastest;
        Sent { bits: first.bits() + rest.bits, frames: 1 + rest.frames + lost, lost, is_heard: true }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(mcs: Mcs) -> HeldLink {
        HeldLink { node: NodeId(0), pair: SectorPair { own: 0, peer: 0 }, mcs }
    }

    #[test]
    fn a_steady_link_brings_what_is_counted_by_hand() {
        // MCS 12 needs 18.5 dB. An exchange of 64 MPDUs takes 182.364 us: 54 of them in 10 ms leave 152.4 us, and 53 MPDUs more.
        let mut fast = link(Mcs::fastest_at(Db(18.5)).expect("a scheme"));
        let sent = fast.send(Db(18.5), Duration::from_millis(10));
        let rest = Exchange::within(fast.mcs, Duration::from_millis(10) - Duration::from_nanos(182_364) * 54);
        let rest = rest.expect("a shorter one fits");
        assert_eq!(rest.mpdus, 52);
        assert_eq!((sent.bits, sent.frames, sent.lost), ((54 * 64 + 52) * 12_000, 55, 0));
        assert_eq!(ideal_bits(Db(18.5), Duration::from_millis(10)), sent.bits);
    }

    #[test]
    fn frames_that_are_too_fast_are_lost_and_the_next_ones_are_slower() {
        let mut falling = link(Mcs::fastest_at(Db(30.0)).expect("a scheme"));
        let sent = falling.send(Db(10.6), Duration::from_millis(10));
        // From MCS 12 down to MCS 8, which needs 10.5 dB.
        assert_eq!((sent.lost, falling.mcs.number(), sent.is_heard), (4, 8, true));
        assert!(sent.bits < ideal_bits(Db(10.6), Duration::from_millis(10)));
        let silent = falling.send(Db(3.4), Duration::from_millis(20));
        assert_eq!((silent.bits, silent.lost, silent.is_heard), (0, 8, false));
        // A slow link finds its rate with the first acknowledgement.
        let rising = falling.send(Db(18.6), Duration::from_millis(10));
        assert_eq!((falling.mcs.number(), rising.frames > 40), (12, true));
        assert_eq!(ideal_bits(Db(3.4), Duration::from_millis(10)), 0);
    }
}
