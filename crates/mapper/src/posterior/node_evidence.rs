//! The evidence on one node near a place.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

/// The stops that are evidence on one node, with the packets that they received and missed.
#[derive(Clone, Debug)]
pub(crate) struct NodeEvidence {
    /// Index of the stop, packets received, packets missed.
    listeners: Vec<(u32, i32, i32)>,
}

impl NodeEvidence {
    /// The evidence on `node` for places within a few metres of `near`: the stops that heard it, and those within 1.5
    /// `reach_m`. Nothing is heard beyond `reach_m` (m). `None` if the node was never heard.
    pub(crate) fn near(log: &ReceptionLog, node: NodeId, near: Position, reach_m: f64) -> Option<Self> {
        if log.of(node).iter().all(|reception| reception.received == 0) {
            return None;
        }
        let mut listeners = Vec::new();
        let mut entries = log.of(node).iter().peekable();
        for (index, stop) in (0_u32..).zip(log.stops()) {
            let entry = entries.next_if(|entry| entry.stop == index);
            let (received, sent) = entry.map_or((0, 1), |entry| (entry.received, entry.sent));
            if received > 0 || stop.position.distance_m(near) <= 1.5 * reach_m {
                let count = |packets: u32| i32::try_from(packets).unwrap_or(i32::MAX);
                listeners.push((index, count(received), count(sent - received)));
            }
        }
        Some(Self { listeners })
    }

    /// The evidence of the stops that heard the node, and of those that are `wanted`.
    pub(crate) fn of_stops(&self, wanted: impl Fn(usize) -> bool) -> Self {
        let listeners = self.listeners.iter().copied();
        Self { listeners: listeners.filter(|&(stop, received, _)| received > 0 || wanted(stop as usize)).collect() }
    }

    /// Log-likelihood of a place from which a packet is heard at each stop with `probability`.
    #[inline]
    pub(crate) fn log_likelihood(&self, probability: impl Fn(u32) -> f64) -> f64 {
        let (mut sum, mut product) = (0.0, 1.0);
        for &(stop, received, missed) in &self.listeners {
            let s = probability(stop);
            product *= power(s, received);
            product *= power(1.0 - s, missed);
            if product <= 0.0 {
                return f64::NEG_INFINITY;
            }
            if product < 1e-200 {
                sum += libm::log(product);
                product = 1.0;
            }
        }
        sum + libm::log(product)
    }
}

/// `base` to the power of a number of packets, which is mostly 0 or 1.
#[inline]
fn power(base: f64, packets: i32) -> f64 {
    match packets {
        0 => 1.0,
        1 => base,
        packets => base.powi(packets),
    }
}
