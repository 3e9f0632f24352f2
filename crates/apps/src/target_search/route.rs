//! The way of messages to a sink, hop by hop.

use sextant_channel::Dbm;
use sextant_kernel::StationId;
use sextant_sim::{FrameId, Port, SendOutcome, SendReport, TargetId};

use super::message::{FirstDetection, Message};
use super::outbox::Outbox;

/// Stations that are tried one after the other until one acknowledges.
const PARENTS: usize = 4;
/// Hops of a node that knows no way to a sink.
const NO_WAY: u8 = u8::MAX;

/// The way to the sink: stations that are nearer to it, by hops and then by received power.
#[derive(Clone, Debug, Default)]
pub(super) struct Route {
    parents: Vec<Parent>,
    /// Messages for which there is no way yet, or that were not acknowledged.
    waiting: Vec<FirstDetection>,
    under_way: Vec<UnderWay>,
    failures: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Parent {
    hops: u8,
    rssi: Dbm,
    station: StationId,
}

#[derive(Clone, Copy, Debug)]
struct UnderWay {
    frame: FrameId,
    message: FirstDetection,
    attempt: usize,
}

impl Route {
    /// Hops to the sink.
    pub(super) fn hops(&self) -> u8 {
        self.parents.first().map_or(NO_WAY, |parent| parent.hops.saturating_add(1))
    }

    /// Times that no station acknowledged a message.
    pub(super) fn failures(&self) -> u64 {
        self.failures
    }

    /// Whether a message waits.
    pub(super) fn is_waiting(&self) -> bool {
        !self.waiting.is_empty()
    }

    /// A target is known: messages about it are needed no more.
    pub(super) fn forget(&mut self, target: TargetId) {
        self.waiting.retain(|message| message.target != target);
    }

    /// A station that is `hops` away from the sink was heard.
    pub(super) fn learn(&mut self, station: StationId, hops: u8, rssi: Dbm) {
        if hops == NO_WAY {
            return;
        }
        self.parents.retain(|parent| parent.station != station);
        self.parents.push(Parent { hops, rssi, station });
        self.parents.sort_by(|a, b| {
            let by_power = b.rssi.0.total_cmp(&a.rssi.0);
            a.hops.cmp(&b.hops).then(by_power).then(a.station.cmp(&b.station))
        });
        self.parents.truncate(PARENTS);
    }

    /// Sends a message on its way; it waits if no way is known.
    pub(super) fn forward(&mut self, message: FirstDetection, outbox: &mut Outbox, port: &mut Port<'_>) {
        if self.parents.is_empty() {
            self.waiting.push(message);
        } else {
            self.attempt(message, 0, outbox, port);
        }
    }

    /// Sends what waited for a way.
    pub(super) fn forward_waiting(&mut self, outbox: &mut Outbox, port: &mut Port<'_>) {
        for message in std::mem::take(&mut self.waiting) {
            self.forward(message, outbox, port);
        }
    }

    /// A frame has ended: if it was not acknowledged, the next station is tried.
    pub(super) fn ended(&mut self, report: &SendReport, outbox: &mut Outbox, port: &mut Port<'_>) {
        let Some(at) = self.under_way.iter().position(|sent| sent.frame == report.frame) else { return };
        let UnderWay { message, attempt, .. } = self.under_way.swap_remove(at);
        if report.outcome != SendOutcome::Acknowledged {
            self.attempt(message, attempt + 1, outbox, port);
        }
    }

    fn attempt(&mut self, message: FirstDetection, attempt: usize, outbox: &mut Outbox, port: &mut Port<'_>) {
        let parent = self.parents.get(attempt).map(|parent| parent.station);
        match parent.and_then(|parent| outbox.unicast(&Message::Detection(message), parent, port)) {
            Some(frame) => self.under_way.push(UnderWay { frame, message, attempt }),
            None => {
                self.failures += 1;
                self.waiting.push(message);
            }
        }
    }
}
