//! Whether the packets of a link depend on each other, where a law takes them as independent.

use sextant_channel::{Position, ReceptionLog, Stop};
use sextant_kernel::NodeId;

use crate::learned::{Line, Section};
use crate::topology_map::TopologyMap;

/// How much the packets of a link share.
///
/// If packets are independent under a law, k of the n packets of a link vary as a binomial law says. A link that is better or
/// worse than the law says varies more: by `1 + (n - 1) ρ`, where ρ is the correlation of two of its packets (Williams 1982). It is
/// estimated by moments, with the uncertainty of places integrated out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkDependence {
    /// Correlation ρ of two packets of a link about what the law says. Below 0 they vary less than if they were independent.
    pub correlation: f64,
    /// Its standard error, by leaving out nodes.
    pub error: f64,
    /// Packets of a usual link that has several.
    pub packets: f64,
}

/// Links with fewer packets than this tell nothing of their dependence, nor do fewer links than this.
const LEAST_PACKETS: u32 = 2;
const LEAST_LINKS: usize = 20;
/// Probabilities count as at least so far from 0 and 1: how far in the tails of a curve says little.
const LEAST_SHARE: f64 = 0.02;
/// Regions are too small where links vary by this factor more than a law of independent packets says.
const TOO_MUCH: f64 = 2.0;

impl LinkDependence {
    /// That of the links of `log`, if nodes are where `map` has them. `share` is the share of packets that arrives from a place at a
    /// stop (its number comes with it). `None` if too few links have several packets, or nodes have sectors.
    pub(crate) fn of(
        log: &ReceptionLog,
        map: &TopologyMap,
        share: impl Fn(Position, usize, &Stop) -> f64,
    ) -> Option<Self> {
        if log.sectors().is_some() {
            return None;
        }
        let (mut links, mut packets) = (0, 0.0);
        let mut of_nodes: Vec<NodeSums> = Vec::new();
        for (node, estimate) in map.estimates.iter().enumerate() {
            let Some(estimate) = estimate else { continue };
            let places = estimate.points();
            let mut sums = NodeSums::default();
            for reception in log.of(NodeId::from_index(node)).iter().filter(|one| one.sent >= LEAST_PACKETS) {
                let number = reception.stop as usize;
                let stop = &log.stops()[number];
                let (mut mean, mut square) = (0.0, 0.0);
                for &(place, weight) in &places {
                    let share = share(place, number, stop);
                    mean += weight * share;
                    square += weight * share * share;
                }
                // The variance of the share where the place is not known for sure.
                let of_place = (square - mean * mean).max(0.0);
                let mean = mean.clamp(LEAST_SHARE, 1.0 - LEAST_SHARE);
                let (received, sent) = (f64::from(reception.received), f64::from(reception.sent));
                let single = mean * (1.0 - mean);
                let beyond = received - sent * mean;
                sums.excess += (beyond * beyond / sent - single - (sent - 1.0) * of_place) / single;
                sums.packets += sent - 1.0;
                packets += sent;
                links += 1;
            }
            of_nodes.extend(Some(sums).filter(|sums| sums.packets > 0.0));
        }
        if links < LEAST_LINKS {
            return None;
        }
        let total: f64 = of_nodes.iter().map(|sums| sums.packets).sum();
        let correlation = of_nodes.iter().map(|sums| sums.excess).sum::<f64>() / total;
        let left = |sums: &NodeSums| sums.excess - correlation * sums.packets;
        let error = of_nodes.iter().map(|sums| left(sums) * left(sums)).sum::<f64>().sqrt() / total;
        Some(Self { correlation, error, packets: packets / links as f64 })
    }

    /// How much more a usual link varies than a law of independent packets says, at least, with a probability of 98 %.
    #[must_use]
    pub fn least_factor(&self) -> f64 {
        1.0 + (self.packets - 1.0) * (self.correlation - 2.0 * self.error)
    }

    /// What is said of a map called `name` whose regions are too small for it.
    pub(crate) fn warning(&self, name: &str) -> Option<Line> {
        (self.least_factor() > TOO_MUCH).then(|| Line {
            section: Section::Warnings,
            text: format!(
                "{name}: warning: packets of a link depend on each other (correlation {:.2} ± {:.2}, {:.0} packets a link), and \
                 this estimator takes them as independent: its regions are far too small; `auto` and `link-model` know such links",
                self.correlation,
                2.0 * self.error,
                self.packets
            ),
        })
    }
}

/// Sums over the links of a node: of what they vary beyond independent packets, and of packets less one.
#[derive(Clone, Copy, Default)]
struct NodeSums {
    excess: f64,
    packets: f64,
}

#[cfg(test)]
mod tests {
    use sextant_channel::Reception;
    use sextant_kernel::{Purpose, Seed, SimTime};

    use super::*;
    use crate::topology_map::CoordinateFrame;

    /// A log of 30 nodes at 20 stops, whose links receive a packet with the probability that `share` gives of a link.
    fn dependence(sent: u32, share: impl Fn(usize, u32) -> f64) -> Option<LinkDependence> {
        let seed = Seed(5);
        let stop = |number: u32| Stop {
            time: SimTime::from_nanos(u64::from(number)),
            ..Stop::at(Position::new(f64::from(number), 0.0, 0.0))
        };
        let mut receptions = Vec::new();
        for node in 0..30 {
            for stop in 0..20 {
                let arrives = |packet: &u32| {
                    let place = [node as u64, u64::from(stop), u64::from(*packet)];
                    seed.uniform(Purpose::new(9), place) < share(node, stop)
                };
                let received = u32::try_from((0..sent).filter(arrives).count()).unwrap();
                let node = NodeId::from_index(node);
                receptions.push(Reception::heard(node, stop, received, sent));
            }
        }
        let names = (0..30).map(|node| format!("n{node}")).collect();
        let log = ReceptionLog::new(names, (0..20).map(stop).collect(), receptions, Vec::new()).unwrap();
        let places = vec![Some(Position::ORIGIN); 30];
        let map = TopologyMap::of_places("a", places, CoordinateFrame::World);
        LinkDependence::of(&log, &map, |_, _, _| 0.5)
    }

    #[test]
    fn the_correlation_of_the_packets_of_a_link_is_found() {
        let free = dependence(12, |_, _| 0.5).unwrap();
        assert!(free.correlation.abs() < 3.0 * free.error && free.least_factor() < 1.2, "{free:?}");
        assert_eq!(free.warning("map"), None);
        // Shares of 0.2 and 0.8 in turn: the variance of the share is 0.09, of 0.25 for a packet.
        let tied =
            dependence(12, |node, stop| if (node + stop as usize).is_multiple_of(2) { 0.2 } else { 0.8 }).unwrap();
        assert!((tied.correlation - 0.36).abs() < 0.03, "{tied:?}");
        let warning = tied.warning("map").unwrap();
        assert!(warning.text.contains("regions are far too small"), "{}", warning.text);
    }

    #[test]
    fn single_packets_tell_nothing() {
        assert_eq!(dependence(1, |_, _| 0.5), None);
    }
}
