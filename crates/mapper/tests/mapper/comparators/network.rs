//! Networks without packet loss. There is no shadowing unless a test asks for it.

use sextant_channel::{Anchor, Link, NeighbourLog, Position, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Purpose, Seed};
use sextant_mapper::{Knowledge, RangingConfig};

/// Path loss of the tests: −50 dBm at 1 m, exponent 2.7.
pub(crate) const RANGING: RangingConfig =
    RangingConfig { exponent: Some(2.7), tx_power_dbm: Some(-50.0), reference_distance_m: None, sigma_db: Some(0.0) };

/// A network and what its nodes heard.
pub(crate) struct Network {
    pub(crate) places: Vec<Position>,
    pub(crate) anchors: Vec<Anchor>,
    log: ReceptionLog,
    neighbours: NeighbourLog,
    beacons: NeighbourLog,
}

impl Network {
    /// Nodes at `places`, each `every`-th of them an anchor; nodes hear each other within `hop_m`, anchors within
    /// `beacon_m`, with shadowing of `sigma_db`.
    pub(crate) fn new(places: Vec<Position>, every: usize, hop_m: f64, beacon_m: f64, sigma_db: f64) -> Self {
        let anchors: Vec<Anchor> = (0..places.len())
            .step_by(every)
            .map(|i| Anchor { node: NodeId::from_index(i), position: places[i] })
            .collect();
        let names = (0..places.len()).map(|i| format!("n{i}")).collect();
        let stops = vec![Stop::at(Position::new(0.0, 0.0, places[0].z_m))];
        let log = ReceptionLog::new(names, stops, Vec::new(), Vec::new()).expect("a log");
        let neighbours = heard(&places, hop_m, sigma_db, 1, |_| true);
        let beacons = heard(&places, beacon_m, sigma_db, 2, |i| i % every == 0);
        Self { places, anchors, log, neighbours, beacons }
    }

    pub(crate) fn knowledge(&self) -> Knowledge<'_> {
        Knowledge {
            neighbours: Some(&self.neighbours),
            beacons: Some(&self.beacons),
            anchors: &self.anchors,
            ..Knowledge::from(&self.log)
        }
    }

    /// Only the robot's log.
    pub(crate) fn robot_only(&self) -> Knowledge<'_> {
        Knowledge::from(&self.log)
    }

    /// The true places with their nodes.
    pub(crate) fn truth(&self) -> Vec<(NodeId, Position)> {
        self.places.iter().enumerate().map(|(i, &place)| (NodeId::from_index(i), place)).collect()
    }
}

fn heard(
    places: &[Position],
    range_m: f64,
    sigma_db: f64,
    round: u64,
    sends: impl Fn(usize) -> bool,
) -> NeighbourLog {
    let mut links = Vec::new();
    for (i, a) in places.iter().enumerate() {
        for (j, b) in places.iter().enumerate().filter(|&(j, _)| j != i && sends(j)) {
            let distance_m = a.distance_m(*b);
            if distance_m <= range_m {
                let shadow_db = sigma_db * Seed(77).normal(Purpose::new(8), [i as u64, j as u64, round]);
                links.push(Link {
                    listener: NodeId::from_index(i),
                    sender: NodeId::from_index(j),
                    received: 1,
                    sent: 1,
                    rssi_dbm: Some(-50.0 - 27.0 * distance_m.log10() + shadow_db),
                });
            }
        }
    }
    NeighbourLog::new(places.len(), links).expect("distinct nodes")
}

/// A lattice of unit spacing, each node moved by up to `jitter_m`.
pub(crate) fn lattice([nx, ny, nz]: [u32; 3], jitter_m: f64) -> Vec<Position> {
    let draw = |i, axis| jitter_m * (2.0 * Seed(31).uniform(Purpose::new(8), [i, axis, 9]) - 1.0);
    let sites = (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z].map(f64::from))));
    let is_planar = nz == 1;
    (0..)
        .zip(sites)
        .map(|(i, [x, y, z])| {
            Position::new(x + draw(i, 0), y + draw(i, 1), if is_planar { z } else { z + draw(i, 2) })
        })
        .collect()
}

/// Mean distance of the nodes that are no anchors from their places (m); each of them must be mapped.
pub(crate) fn mean_error_m(network: &Network, map: &sextant_mapper::TopologyMap) -> f64 {
    let mut errors = Vec::new();
    for (i, (place, found)) in network.places.iter().zip(map.positions()).enumerate() {
        if !network.anchors.iter().any(|anchor| anchor.node.index() == i) {
            errors.push(found.expect("every node is mapped").distance_m(*place));
        }
    }
    errors.iter().sum::<f64>() / errors.len() as f64
}
