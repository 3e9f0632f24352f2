//! The frame of a network that ends now, for those that have received it and for observers.

use std::ops::Range;

use super::fate::Fate;
use crate::air::{Arrival, Transmission};
use crate::observer::{FrameOnAir, HeardFrame, Observer};
use crate::scene::Scene;
use crate::service::network_id::NetworkId;
use crate::service::outcome::FrameOutcome;

/// The octets of the frame that ends now.
#[derive(Debug)]
pub(crate) struct FrameBuffer {
    /// The frame, or only its payload if nobody looks at more.
    pub(super) octets: Vec<u8>,
    /// Where its payload is.
    pub(super) payload: Range<usize>,
    /// The robots and sinks that have received it.
    heard: Vec<HeardFrame>,
}

/// How a frame ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameEnd<'a> {
    pub(super) network: NetworkId,
    /// Number of its channel, if the network has several or names its one.
    pub(super) channel: Option<u8>,
    pub(super) transmission: &'a Transmission,
    pub(super) fate: Fate,
    pub(super) arrivals: &'a [Arrival],
}

impl FrameBuffer {
    pub(super) fn new() -> Self {
        Self { octets: Vec::with_capacity(127), payload: 0..0, heard: Vec::new() }
    }

    /// Keeps a payload without a frame.
    pub(super) fn keep_payload(&mut self, payload: &[u8]) {
        self.octets.clear();
        self.octets.extend_from_slice(payload);
        self.payload = 0..payload.len();
    }

    /// Tells the observer of the frame, which ends now.
    pub(super) fn tell(&mut self, end: FrameEnd<'_>, scene: &Scene, observer: &mut impl Observer) {
        let FrameEnd { network, channel, transmission, fate, arrivals } = end;
        let received =
            |arrival: &&Arrival| !scene.roll.is_node(arrival.station) && arrival.outcome == FrameOutcome::Received;
        self.heard.clear();
        self.heard.extend(arrivals.iter().filter(received).map(|arrival| HeardFrame {
            collector: arrival.station.index() - scene.roll.nodes,
            power: arrival.power.to_dbm(),
        }));
        observer.framed(FrameOnAir {
            network,
            channel,
            start: transmission.start(),
            airtime: scene.now - transmission.start(),
            source: transmission.source(),
            bytes: &self.octets,
            outcome: fate.outcome,
            power: fate.power(),
            heard: &self.heard,
        });
    }
}
