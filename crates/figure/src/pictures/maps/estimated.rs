//! Maps with what else was estimated: the regions of the nodes and the reception curves.

use std::fmt;

use sextant_channel::ReceptionLog;
use sextant_kernel::NodeId;
use sextant_mapper::{AbsorptionMap, TopologyMap};

/// A map with its regions, its reception curves and the obstacles that it claims.
#[derive(Debug)]
pub struct EstimatedMap<'a> {
    /// Its name, that of one of the maps of the [`Source`](crate::Source).
    pub name: &'a str,
    /// The map, in world coordinates.
    pub map: &'a TopologyMap,
    /// The log of each network that it uses, with the curve that holds there.
    pub curves: Vec<ReceptionCurve<'a>>,
    /// What absorbs, if that was estimated with it.
    pub obstacles: Option<&'a AbsorptionMap>,
}

/// A log, and the probability of a reception that a map assumes in it.
#[derive(Debug)]
pub struct ReceptionCurve<'a> {
    /// Name of the network, if the map uses several.
    pub network: Option<&'a str>,
    /// The log.
    pub log: &'a ReceptionLog,
    /// The curve, if the map has one.
    pub model: Option<Model<'a>>,
}

/// The probability that a packet is received.
pub struct Model<'a> {
    /// What it is, for the legend: `fitted curve`.
    pub name: String,
    /// The probability over a distance (m).
    pub probability: Box<dyn Fn(f64) -> f64 + 'a>,
    /// Factor of the probability at each stop; empty if all are 1.
    pub of_stops: Vec<f64>,
    /// The distance beyond which little is received (m), if it is known.
    pub range_m: Option<f64>,
}

impl Model<'_> {
    /// The probability over `distance_m` at a stop.
    pub(crate) fn at_stop(&self, stop: usize, distance_m: f64) -> f64 {
        ((self.probability)(distance_m) * self.of_stops.get(stop).copied().unwrap_or(1.0)).clamp(0.0, 1.0)
    }
}

impl fmt::Debug for Model<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Model").field("name", &self.name).field("range_m", &self.range_m).finish_non_exhaustive()
    }
}

/// What a stop received of a node that is on the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pair {
    pub(crate) stop: usize,
    /// Distance from the stop to the place on the map (m).
    pub(crate) distance_m: f64,
    pub(crate) received: f64,
    pub(crate) sent: f64,
}

/// At most about so many pairs of a node and a stop are looked at.
const MOST_PAIRS: usize = 20_000_000;

/// One of so many nodes is looked at, so that there are not too many pairs.
pub(crate) fn one_node_in(log: &ReceptionLog) -> usize {
    log.node_count().saturating_mul(log.stops().len()).div_ceil(MOST_PAIRS).max(1)
}

/// The pairs of a mapped node and a stop that listened to it. A pair that `log` does not have is one packet that was
/// missed. Of large logs, these are the pairs of [`one_node_in`] so many nodes.
pub(crate) fn pairs(map: &TopologyMap, log: &ReceptionLog) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for (node, place) in map.positions().into_iter().enumerate().take(log.node_count()).step_by(one_node_in(log)) {
        let Some(place) = place else { continue };
        let mut entries = log.of(NodeId::from_index(node)).iter().peekable();
        for (stop, at) in log.stops().iter().enumerate() {
            let entry = entries.next_if(|entry| entry.stop as usize == stop);
            let (received, sent) = entry.map_or((0, 1), |entry| (entry.received, entry.sent));
            if sent > 0 {
                let distance_m = at.position.distance_m(place);
                pairs.push(Pair { stop, distance_m, received: received.into(), sent: sent.into() });
            }
        }
    }
    pairs
}
