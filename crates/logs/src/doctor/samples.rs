//! Some of the packets of a log, kept to check their clock.

use sextant_kernel::{RobotId, SimTime};

use super::levels;

/// The packets of so many nodes are kept.
const NODES: usize = 24;
/// Of each node at most so many; when they are too many, every other one is dropped.
const PACKETS: usize = 200;

/// A packet that was kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PacketSample {
    pub(super) robot: RobotId,
    pub(super) time: SimTime,
    pub(super) rssi_dbm: Option<f64>,
}

/// Some of the packets of the first nodes, evenly over each node. Memory does not grow with packets.
#[derive(Clone, Debug, Default)]
pub(crate) struct Samples {
    nodes: Vec<OfNode>,
}

#[derive(Clone, Debug)]
struct OfNode {
    seen: u64,
    /// Every so many packets are kept.
    every: u64,
    kept: Vec<PacketSample>,
}

impl Samples {
    /// Takes a packet of the node with this number.
    pub(crate) fn take(&mut self, node: u32, robot: RobotId, time: SimTime, rssi_dbm: Option<f64>) {
        let node = node as usize;
        if node >= NODES {
            return;
        }
        if self.nodes.len() <= node {
            self.nodes.resize_with(node + 1, || OfNode { seen: 0, every: 1, kept: Vec::new() });
        }
        let of_node = &mut self.nodes[node];
        if of_node.seen.is_multiple_of(of_node.every) {
            if of_node.kept.len() == PACKETS {
                let mut number = 0_u32;
                of_node.kept.retain(|_| {
                    number += 1;
                    number % 2 == 1
                });
                of_node.every *= 2;
            }
            if of_node.seen.is_multiple_of(of_node.every) {
                // What no radio measures stands for no strength.
                let rssi_dbm = rssi_dbm.filter(|level| levels::is_usual(*level));
                of_node.kept.push(PacketSample { robot, time, rssi_dbm });
            }
        }
        of_node.seen += 1;
    }

    /// Whether any of the packets that were kept has a strength.
    pub(super) fn have_strengths(&self) -> bool {
        self.nodes().flatten().any(|packet| packet.rssi_dbm.is_some())
    }

    /// Those of the packets that were received at such times.
    pub(super) fn filtered(&self, is_wanted: impl Fn(SimTime) -> bool) -> Self {
        let of_node = |node: &OfNode| {
            let kept = node.kept.iter().copied().filter(|packet| is_wanted(packet.time)).collect();
            OfNode { kept, ..*node }
        };
        Self { nodes: self.nodes.iter().map(of_node).collect() }
    }

    /// Those of the packets that are of every second node, from this one on.
    pub(super) fn of_every_second(&self, first: usize) -> Self {
        Self { nodes: self.nodes.iter().skip(first).step_by(2).cloned().collect() }
    }

    /// The packets that were kept, by node.
    pub(super) fn nodes(&self) -> impl Iterator<Item = &[PacketSample]> {
        self.nodes.iter().map(|of_node| of_node.kept.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_strength_is_enough_to_have_some() {
        let mut samples = Samples::default();
        samples.take(0, RobotId(0), SimTime::ZERO, None);
        assert!(!samples.have_strengths());
        samples.take(1, RobotId(0), SimTime::ZERO, Some(-60.0));
        assert!(samples.have_strengths());
    }

    #[test]
    fn a_strength_that_no_radio_measures_is_none() {
        let mut samples = Samples::default();
        for (node, level_dbm) in (0..).zip([127.0, 0.0, -200.0]) {
            samples.take(node, RobotId(0), SimTime::ZERO, Some(level_dbm));
        }
        assert!(!samples.have_strengths());
    }

    #[test]
    fn what_is_kept_of_many_packets_is_spread_evenly() {
        let mut samples = Samples::default();
        for second in 0..10_000_u64 {
            samples.take(1, RobotId(0), SimTime::from_nanos(second * 1_000_000_000), None);
            samples.take(99, RobotId(0), SimTime::ZERO, None);
        }
        let nodes: Vec<_> = samples.nodes().collect();
        assert_eq!((nodes.len(), nodes[0].len()), (2, 0));
        let kept: Vec<f64> = nodes[1].iter().map(|sample| sample.time.as_secs_f64()).collect();
        assert!(kept.len() <= PACKETS && kept.len() > PACKETS / 3, "{}", kept.len());
        let steps: Vec<f64> = kept.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(steps.iter().all(|step| (step - steps[0]).abs() < 1e-9), "{steps:?}");
        assert!(kept[kept.len() - 1] > 9_900.0);
    }
}
