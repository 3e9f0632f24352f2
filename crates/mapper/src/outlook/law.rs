//! What a stop hears of a node over a distance.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

use crate::learned::EstimatorFindings;
use crate::link_dependence::LinkDependence;
use crate::numerics::whole;
use crate::topology_map::TopologyMap;

/// Intervals of the table of the probability of a packet.
const SAMPLES: usize = 256;
/// A node is out of reach where fewer packets than this share arrive.
const LEAST_SHARE: f64 = 0.02;
/// The curve is looked at up to so many times the distance of the farthest reception.
const FAR: f64 = 2.0;
const FARTHEST: f64 = 64.0;
/// A stop is worth at most so many independent packets of a node: the next ones change little.
const MOST_PACKETS: f64 = 8.0;
/// Strengths tell their noise if there are so many more of them than nodes.
const LEAST_STRENGTHS: usize = 10;
/// Distances count as at least this share of the reach, because places are not known better.
const NEAREST: f64 = 0.01;

/// What a stop hears of a node over a distance: how many packets, and how strong they are.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StopLaw {
    /// Probability of a packet at equal distances from 0 to the reach.
    curve: Vec<f64>,
    step_m: f64,
    /// How many independent packets a stop is worth.
    pub(super) packets: u32,
    /// How strengths fall with the distance, if the map was made of strengths.
    pub(super) strengths: Option<StrengthLaw>,
    /// Distance over which two stops hear the same shadowing (m); 0 if they share none.
    correlation_m: f64,
}

/// How the strengths at a stop fall with the distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StrengthLaw {
    /// Fall over a factor of e in distance (dB).
    pub(super) per_e_db: f64,
    /// Standard deviation of the strength of a link about the law (dB): of shadowing, fading and places.
    pub(super) noise_db: f64,
    /// Nearer places are as strong as this one (m).
    nearest_m: f64,
}

impl StrengthLaw {
    /// The strength over a distance, but for a constant (dB).
    pub(super) fn strength_db(&self, distance_m: f64) -> f64 {
        -self.per_e_db * libm::log(distance_m.max(self.nearest_m))
    }
}

impl StopLaw {
    /// The law of the log of `map`, if a packet arrives over a distance with the probability `curve`; `None` if none would arrive.
    pub(super) fn of(
        log: &ReceptionLog,
        map: &TopologyMap,
        learned: Option<&EstimatorFindings>,
        curve: &dyn Fn(f64) -> f64,
    ) -> Option<Self> {
        let links = Links::of(log, map);
        let farthest_m = links.heard.iter().map(|link| link.distance_m).fold(0.0, f64::max);
        let mut far_m = FAR * farthest_m;
        while far_m < FARTHEST * farthest_m && curve(far_m) >= LEAST_SHARE {
            far_m *= FAR;
        }
        let mut samples = (0..=SAMPLES).rev().map(|sample| far_m * sample as f64 / SAMPLES as f64);
        let reach_m = samples.find(|&distance_m| curve(distance_m) >= LEAST_SHARE)?;
        if reach_m <= 0.0 {
            return None;
        }
        let correlation = LinkDependence::of(log, map, |place, _, stop| curve(place.distance_m(stop.position)));
        let shared = correlation.map_or(1.0, |dependence| dependence.correlation.clamp(0.0, 1.0));
        let independent = links.packets / (1.0 + (links.packets - 1.0) * shared);
        let exponent = learned.and_then(|learned| learned.path_loss_exponent());
        let strengths = exponent.filter(|exponent| *exponent > 0.0).and_then(|exponent| {
            let per_e_db = 10.0 * exponent / std::f64::consts::LN_10;
            let law = StrengthLaw { per_e_db, noise_db: 0.0, nearest_m: NEAREST * reach_m };
            Some(StrengthLaw { noise_db: links.noise_db(&law)?, ..law })
        });
        let shadowing = learned.and_then(|learned| learned.shadowing());
        let step_m = reach_m / SAMPLES as f64;
        Some(Self {
            curve: (0..=SAMPLES).map(|sample| curve(step_m * sample as f64).clamp(0.0, 1.0)).collect(),
            step_m,
            packets: u32::try_from(whole(independent.round().clamp(1.0, MOST_PACKETS))).unwrap_or(1),
            strengths,
            correlation_m: shadowing.map_or(0.0, |shadowing| shadowing.range_m),
        })
    }

    /// A law with the probability `curve` up to `reach_m`, of stops that are worth one packet.
    #[cfg(test)]
    pub(super) fn of_curve(reach_m: f64, strengths: Option<[f64; 2]>, curve: impl Fn(f64) -> f64) -> Self {
        let step_m = reach_m / SAMPLES as f64;
        let strengths =
            strengths.map(|[per_e_db, noise_db]| StrengthLaw { per_e_db, noise_db, nearest_m: NEAREST * reach_m });
        let curve = (0..=SAMPLES).map(|sample| curve(step_m * sample as f64)).collect();
        Self { curve, step_m, packets: 1, strengths, correlation_m: 0.0 }
    }

    /// The same law with shadowing that is the same over this distance (m).
    #[cfg(test)]
    pub(super) fn correlated(self, correlation_m: f64) -> Self {
        Self { correlation_m, ..self }
    }

    /// Beyond this distance next to nothing is heard (m).
    pub(super) fn reach_m(&self) -> f64 {
        self.step_m * SAMPLES as f64
    }

    /// Probability that a packet arrives over a distance.
    pub(super) fn probability(&self, distance_m: f64) -> f64 {
        let along = distance_m / self.step_m;
        let below = whole(along);
        match self.curve.get(below..).and_then(<[f64]>::first_chunk) {
            Some(&[near, far]) => near + (far - near) * (along - below as f64),
            None => 0.0,
        }
    }

    /// Probability that a stop hears nothing over a distance.
    pub(super) fn silence(&self, distance_m: f64) -> f64 {
        (1.0 - self.probability(distance_m)).powi(self.packets.cast_signed())
    }

    /// The share of what a stop hears that is new, if the nearest other stop is this far away: the shadowing of neighbouring
    /// places is the same up to exp(−d / l) (Gudmundson 1991).
    pub(super) fn new_share(&self, nearest_stop_m: f64) -> f64 {
        if self.correlation_m > 0.0 { 1.0 - libm::exp(-nearest_stop_m / self.correlation_m) } else { 1.0 }
    }
}

/// A pair of a node and a stop that heard it.
struct HeardLink {
    node: usize,
    distance_m: f64,
    rssi_dbm: Option<f64>,
}

/// The links that were heard.
struct Links {
    heard: Vec<HeardLink>,
    /// Mean number of packets of a link.
    packets: f64,
}

impl Links {
    fn of(log: &ReceptionLog, map: &TopologyMap) -> Self {
        let stops = log.stops();
        let place = |node: NodeId| Some(map.estimates.get(node.index())?.as_ref()?.position);
        let mut heard = Vec::new();
        let mut packets = 0.0;
        for reception in log.receptions().iter().filter(|reception| reception.received > 0) {
            let at: Option<Position> = place(reception.node);
            let Some(at) = at else { continue };
            let distance_m = at.distance_m(stops[reception.stop as usize].position);
            packets += f64::from(reception.sent);
            heard.push(HeardLink { node: reception.node.index(), distance_m, rssi_dbm: reception.rssi_dbm });
        }
        let packets = (packets / heard.len().max(1) as f64).max(1.0);
        Self { heard, packets }
    }

    /// Standard deviation of the strengths of a node about `law` (dB), whatever its power; `None` if there are too few.
    fn noise_db(&self, law: &StrengthLaw) -> Option<f64> {
        let (mut square, mut freedom) = (0.0, 0);
        // Receptions are sorted by node.
        for node in self.heard.chunk_by(|a, b| a.node == b.node) {
            let excess = |link: &HeardLink| Some(link.rssi_dbm? - law.strength_db(link.distance_m));
            let excesses: Vec<f64> = node.iter().filter_map(excess).collect();
            let mean = excesses.iter().sum::<f64>() / excesses.len().max(1) as f64;
            square += excesses.iter().map(|excess| (excess - mean) * (excess - mean)).sum::<f64>();
            freedom += excesses.len().saturating_sub(1);
        }
        (freedom >= LEAST_STRENGTHS && square > 0.0).then(|| (square / freedom as f64).sqrt())
    }
}
