//! The graph of neighbours, and numbers of hops between nodes.

use std::collections::VecDeque;

use sextant_channel::NeighbourLog;
use sextant_kernel::{Interrupted, NodeId, Watch, Work};

/// Hops to a node that is out of reach.
pub(crate) const UNREACHED: u32 = u32::MAX;

/// An undirected graph of nodes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Graph {
    first: Vec<usize>,
    neighbours: Vec<u32>,
}

impl Graph {
    /// The graph of the pairs of nodes that each received at least the share `link_share` of the other's packets.
    pub(crate) fn of(log: &NeighbourLog, link_share: f64) -> Self {
        let holds = |received: u32, sent: u32| f64::from(received) >= link_share * f64::from(sent);
        let edges = log.links().iter().filter(|link| {
            holds(link.received, link.sent)
                && log.link(link.sender, link.listener).is_some_and(|back| holds(back.received, back.sent))
        });
        // Links are sorted by listener, then by sender. Each edge consists of two links.
        let mut first = vec![0; log.node_count() + 1];
        let mut neighbours = Vec::new();
        for edge in edges {
            first[edge.listener.index() + 1] += 1;
            neighbours.push(edge.sender.0);
        }
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        Self { first, neighbours }
    }

    pub(crate) fn node_count(&self) -> usize {
        self.first.len() - 1
    }

    /// The neighbours of `node`, in rising order.
    pub(crate) fn neighbours(&self, node: usize) -> &[u32] {
        &self.neighbours[self.first[node]..self.first[node + 1]]
    }

    /// Hops from `source` to each node, [`UNREACHED`] where there is no way; breadth first.
    pub(crate) fn hops_from(&self, source: usize) -> Vec<u32> {
        let mut hops = vec![UNREACHED; self.node_count()];
        let mut queue = VecDeque::from([NodeId::from_index(source).0]);
        hops[source] = 0;
        while let Some(node) = queue.pop_front() {
            let next = hops[node as usize] + 1;
            for &neighbour in self.neighbours(node as usize) {
                if hops[neighbour as usize] == UNREACHED {
                    hops[neighbour as usize] = next;
                    queue.push_back(neighbour);
                }
            }
        }
        hops
    }

    /// The same from each of `sources`. `algorithm` is the name for progress messages.
    pub(crate) fn hops_from_each(
        &self,
        sources: impl ExactSizeIterator<Item = usize>,
        algorithm: &'static str,
        watch: &dyn Watch,
    ) -> Result<Vec<Vec<u32>>, Interrupted> {
        let steps = sources.len() as u64;
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let operations = steps as f64 * self.neighbours.len() as f64;
        watch.begin(Work { name: algorithm, unit: "source of hops", steps, operations });
        sources
            .map(|source| {
                watch.check()?;
                watch.advance(1);
                Ok(self.hops_from(source))
            })
            .collect()
    }

    /// The connected parts of the graph, each with its nodes in rising order. The part of the lowest node comes
    /// first.
    pub(crate) fn parts(&self) -> Vec<Vec<usize>> {
        let mut seen = vec![false; self.node_count()];
        let mut parts = Vec::new();
        for start in 0..self.node_count() {
            if seen[start] {
                continue;
            }
            seen[start] = true;
            let mut part = vec![start];
            let mut next = 0;
            while let Some(&node) = part.get(next) {
                next += 1;
                for &neighbour in self.neighbours(node) {
                    if !std::mem::replace(&mut seen[neighbour as usize], true) {
                        part.push(neighbour as usize);
                    }
                }
            }
            part.sort_unstable();
            parts.push(part);
        }
        parts
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use sextant_channel::{Link, Position};
    use sextant_kernel::{Purpose, Seed};

    /// What nodes at `places` would hear within `range_m` without losses, at −50 dBm at 1 m and exponent 2.
    pub(crate) fn heard_within(places: &[Position], range_m: f64) -> NeighbourLog {
        let mut links = Vec::new();
        for (i, a) in places.iter().enumerate() {
            for (j, b) in places.iter().enumerate() {
                let distance_m = a.distance_m(*b);
                if i != j && distance_m <= range_m {
                    links.push(Link {
                        listener: NodeId::from_index(i),
                        sender: NodeId::from_index(j),
                        received: 10,
                        sent: 10,
                        rssi_dbm: Some(-50.0 - 20.0 * distance_m.log10()),
                    });
                }
            }
        }
        NeighbourLog::new(places.len(), links).expect("distinct nodes")
    }

    #[test]
    fn hops_are_those_of_all_pairs_shortest_paths() {
        let draw = |i, axis| 20.0 * Seed(8).uniform(Purpose::new(8), [i, axis, 2]);
        let places: Vec<Position> = (0..70).map(|i| Position::new(draw(i, 0), draw(i, 1), 0.0)).collect();
        let graph = Graph::of(&heard_within(&places, 3.0), 0.5);
        // Floyd and Warshall.
        let mut hops = vec![vec![UNREACHED; 70]; 70];
        for (i, row) in hops.iter_mut().enumerate() {
            row[i] = 0;
            for &j in graph.neighbours(i) {
                row[j as usize] = 1;
            }
        }
        for k in 0..70 {
            for i in 0..70 {
                for j in 0..70 {
                    hops[i][j] = hops[i][j].min(hops[i][k].saturating_add(hops[k][j]));
                }
            }
        }
        for (i, row) in hops.iter().enumerate() {
            assert_eq!(&graph.hops_from(i), row);
        }
        let parts = graph.parts();
        assert!(parts.len() > 1, "the network falls apart");
        assert_eq!(parts.iter().map(Vec::len).sum::<usize>(), 70);
        for part in &parts {
            assert!(part.iter().all(|&node| hops[part[0]][node] != UNREACHED));
        }
    }

    #[test]
    fn a_link_counts_if_both_ends_heard_enough() {
        let link = |listener, sender, received| Link {
            listener: NodeId(listener),
            sender: NodeId(sender),
            received,
            sent: 10,
            rssi_dbm: None,
        };
        let links = vec![link(0, 1, 5), link(1, 0, 9), link(1, 2, 10), link(2, 1, 4), link(0, 2, 10)];
        let log = NeighbourLog::new(3, links).unwrap();
        assert_eq!(Graph::of(&log, 0.5).neighbours(1), [0]);
        assert_eq!(Graph::of(&log, 0.4).neighbours(1), [0, 2]);
        assert_eq!(Graph::of(&log, 0.6).parts().len(), 3);
        assert_eq!(Graph::of(&log, 0.0).neighbours(0), [1], "a node that heard nothing is no neighbour");
    }
}
