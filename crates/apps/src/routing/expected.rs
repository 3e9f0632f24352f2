//! How many frames packets take over all hops, as far as the links at the start say.

use sextant_kernel::StationId;
use sextant_mac::routing::fragment;

use super::config::{RoutedTo, TreeMetric};
use super::settings::{MOST_PAYLOAD_OCTETS, Plan, Routing};
use super::tree::Tree;

/// What a packet takes on its way, as it goes on.
#[derive(Clone, Copy, Debug)]
struct Course {
    /// Frames so far, on average.
    frames: f64,
    /// Probability that it is still on its way.
    alive: f64,
}

impl Routing {
    /// Frames that a packet of each node takes on average: over all hops, with its fragments, with its answer, and with
    /// the tries that links need as they are at the start. The MAC tries a frame `mac_tries` times. What is sent besides is not in
    /// it: acknowledgements, messages of the tree, tries after collisions. A tree that the stations build is taken as one of
    /// fewest hops. A node without a way takes none.
    #[must_use]
    pub fn expected_frames(&self, mac_tries: u8) -> Vec<f64> {
        let nodes = self.nodes as usize;
        let roots: Vec<StationId> = (nodes..self.links.stations()).map(StationId::from_index).collect();
        let fewest;
        let tree = match &self.plan {
            Plan::Fixed(tree) => &**tree,
            Plan::Built { .. } | Plan::Rpl(_) => {
                fewest = Tree::shortest(&self.links, &roots, TreeMetric::Hops);
                &fewest
            }
        };
        let tries = f64::from(mac_tries) * (1.0 + f64::from(self.resends));
        let ways: Vec<Vec<StationId>> =
            (0..nodes).map(|node| way_up(tree, StationId::from_index(node), self.links.stations())).collect();
        let depths: usize = ways.iter().map(Vec::len).sum();
        let of_node = |way: &Vec<StationId>| {
            let up =
                way.windows(2).fold(Course { frames: 0.0, alive: 1.0 }, |course, hop| self.over(course, hop, tries));
            match self.to {
                RoutedTo::Sink => up.frames,
                RoutedTo::SinkAndBack => {
                    way.windows(2).rev().fold(up, |course, hop| self.over(course, hop, tries)).frames
                }
                // Down to any other node that is not on the way up: as long as a mean way.
                RoutedTo::Nodes => {
                    let hops_up = way.len().saturating_sub(1);
                    let on_the_way: usize = (1..=hops_up).sum();
                    let all_hops = depths - ways.iter().filter(|way| !way.is_empty()).count();
                    let down = all_hops.saturating_sub(on_the_way) as f64 / (nodes.max(2) - 1) as f64;
                    let a_hop = if hops_up == 0 { 1.0 } else { up.frames / hops_up as f64 };
                    up.frames + up.alive * down * a_hop
                }
            }
        };
        ways.iter().map(of_node).collect()
    }

    /// A packet goes over a hop, if it is still on its way.
    fn over(&self, course: Course, hop: &[StationId], tries: f64) -> Course {
        // Shares of the frames that arrive, with and without their acknowledgements: alike in both directions.
        let acknowledged = self.links.etx(hop[0], hop[1]).map_or(1.0, |etx| 1.0 / etx);
        let arrives = 1.0 - libm::pow(1.0 - libm::sqrt(acknowledged), tries);
        let frames = (1.0 - libm::pow(1.0 - acknowledged, tries)) / acknowledged;
        let pieces = self.fragments.map_or(1, |how| fragment::pieces(how.packet_octets, MOST_PAYLOAD_OCTETS));
        (0..pieces).fold(course, |Course { frames: sent, alive }, _| Course {
            frames: sent + alive * frames,
            alive: alive * arrives,
        })
    }
}

/// The stations from a node up to its sink, both included; none if it has no way.
fn way_up(tree: &Tree, from: StationId, most: usize) -> Vec<StationId> {
    let mut way = vec![from];
    while let Some(parent) = tree.parent(way[way.len() - 1]).filter(|_| way.len() <= most) {
        way.push(parent);
    }
    if way.len() < 2 { Vec::new() } else { way }
}
