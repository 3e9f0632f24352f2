//! The packets that a node has itself.

use sextant_kernel::SimTime;
use sextant_sim::{Next, Port, Traffic};

/// The packets that a node has itself, by the traffic of its network.
#[derive(Clone, Debug)]
pub(super) struct Source {
    traffic: Traffic,
    /// Packets so far.
    count: u64,
    /// Size of the frame of the next packet (octets).
    octets: u8,
    /// Whether the next packet follows the end of the last one.
    is_saturated: bool,
}

impl Source {
    pub(super) fn new(traffic: Traffic) -> Self {
        Self { traffic, count: 0, octets: 0, is_saturated: false }
    }

    /// When the next packet is due, unless it follows the end of the last one, or there is none.
    pub(super) fn next(&mut self, port: &Port<'_>) -> Option<SimTime> {
        let last = if self.count == 0 { SimTime::ZERO } else { port.now() };
        match self.traffic.next(port.seed(), port.node(port.station())?, self.count, last) {
            Next::At(due, octets) => {
                self.octets = octets;
                Some(due)
            }
            Next::AfterTheLast(octets) => {
                (self.octets, self.is_saturated) = (octets, true);
                None
            }
            Next::Never => None,
        }
    }

    /// A packet is made: the size of its frame (octets).
    pub(super) fn take(&mut self) -> u8 {
        self.count += 1;
        self.octets
    }

    /// Whether the next packet follows the end of the last one.
    pub(super) fn is_saturated(&self) -> bool {
        self.is_saturated
    }
}
