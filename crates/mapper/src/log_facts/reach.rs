//! How far nodes are heard, estimated from a log without a model.

use rayon::prelude::*;
use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

/// Share of the nodes whose farthest stop is within the reach. The others may be outliers.
const COMMON: f64 = 0.95;

/// A reception is a gross error of the log if its stop is farther from the others that heard the node than this many
/// times the usual distance from them: the fix of a receiver that jumps, or a stop at the origin of the coordinates.
/// The farthest receptions of real links are a few times as far as usual ones.
const GROSS: f64 = 20.0;

/// Where a node was heard. Receptions that are gross errors do not count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HeardNode {
    pub(crate) node: NodeId,
    /// The middle of the stops that heard it, weighted by packets (m).
    pub(crate) middle: Position,
    /// Distance from the middle to the farthest of these stops (m).
    pub(crate) farthest_m: f64,
    /// Number of these stops.
    pub(crate) stops: u32,
    /// Corners of the box that holds these stops (m).
    pub(crate) corners: [[f64; 3]; 2],
}

/// Nodes that a thread looks at in one piece, at least.
const PIECE: usize = 64;

/// The nodes that were heard, in the order of their numbers. Computed on the current rayon pool; the result is
/// bit-identical for any number of threads.
pub(crate) fn heard_nodes(log: &ReceptionLog) -> Vec<HeardNode> {
    let centres = centres(log);
    let gross_m = gross_m(centres.iter().flatten().map(|centre| centre.usual_m));
    heard_from(log, &centres, gross_m)
}

/// All nodes of a log, by number, for the threads of the pool.
fn nodes(log: &ReceptionLog) -> impl IndexedParallelIterator<Item = usize> {
    (0..log.node_count()).into_par_iter().with_min_len(PIECE)
}

/// The centre of each node; `None` if it was not heard.
pub(crate) fn centres(log: &ReceptionLog) -> Vec<Option<Centre>> {
    let of_node = |heard_at: &mut HeardAt, node| {
        heard_at.read(log, NodeId::from_index(node));
        heard_at.centre()
    };
    nodes(log).map_init(HeardAt::default, of_node).collect()
}

/// The distance beyond which a reception is a gross error, by the usual distances of all nodes of a log (m).
pub(crate) fn gross_m(usual_m: impl Iterator<Item = f64>) -> f64 {
    let mut usual_m: Vec<f64> = usual_m.filter(|&m| m > 0.0).collect();
    if usual_m.is_empty() { f64::INFINITY } else { GROSS * median(&mut usual_m) }
}

/// The nodes that were heard, without receptions beyond `gross_m` of their centre.
pub(crate) fn heard_from(log: &ReceptionLog, centres: &[Option<Centre>], gross_m: f64) -> Vec<HeardNode> {
    let of_node = |heard_at: &mut HeardAt, node: usize| {
        let Centre { place, .. } = centres[node]?;
        heard_at.read(log, NodeId::from_index(node));
        heard_at.places.retain(|(heard_at, _)| heard_at.distance_m(place) <= gross_m);
        heard_at.heard_node(NodeId::from_index(node))
    };
    let heard: Vec<Option<HeardNode>> = nodes(log).map_init(HeardAt::default, of_node).collect();
    heard.into_iter().flatten().collect()
}

/// About where a node was heard.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Centre {
    /// Of the stops that heard it, the one nearest to their median (m).
    place: Position,
    /// The usual distance of these stops from it (m).
    pub(crate) usual_m: f64,
}

/// The stops that heard a node, in memory that a thread reuses for each node.
#[derive(Debug, Default)]
struct HeardAt {
    /// With the packets heard.
    places: Vec<(Position, u32)>,
    /// Numbers whose median is wanted.
    values: Vec<f64>,
}

impl HeardAt {
    fn read(&mut self, log: &ReceptionLog, node: NodeId) {
        let receptions = log.of(node);
        let heard = receptions.stops().iter().map(|&stop| log.stops()[stop as usize].position);
        self.places.clear();
        match receptions.packets() {
            None => self.places.extend(heard.map(|place| (place, 1))),
            Some(packets) => self.places.extend(
                heard.zip(packets).filter(|&(_, (received, _))| received > 0).map(|(place, (n, _))| (place, n)),
            ),
        }
    }

    /// The stop nearest to the median along each axis; `None` if there are no stops.
    fn centre(&mut self) -> Option<Centre> {
        if self.places.is_empty() {
            return None;
        }
        let middle = [0, 1, 2].map(|axis| self.median_of(|place| <[f64; 3]>::from(place)[axis])).into();
        let nearest = |place: &Position| place.distance_m(middle);
        let place = self.places.iter().map(|&(place, _)| place);
        let place = place.min_by(|a, b| nearest(a).total_cmp(&nearest(b)))?;
        Some(Centre { place, usual_m: self.median_of(|other| other.distance_m(place)) })
    }

    fn median_of(&mut self, value: impl Fn(Position) -> f64) -> f64 {
        self.values.clear();
        self.values.extend(self.places.iter().map(|&(place, _)| value(place)));
        median(&mut self.values)
    }

    fn heard_node(&self, node: NodeId) -> Option<HeardNode> {
        let packets: f64 = self.places.iter().map(|&(_, packets)| f64::from(packets)).sum();
        if packets <= 0.0 {
            return None;
        }
        let sum = self.places.iter().fold(Position::ORIGIN, |sum, &(place, n)| sum + place * f64::from(n));
        let middle = sum * (1.0 / packets);
        let mut corners = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for &(place, _) in &self.places {
            for (axis, value) in <[f64; 3]>::from(place).into_iter().enumerate() {
                corners[0][axis] = corners[0][axis].min(value);
                corners[1][axis] = corners[1][axis].max(value);
            }
        }
        // The middle of several stops at one place may miss it by rounding.
        let is_one_place = corners[0].map(f64::to_bits) == corners[1].map(f64::to_bits);
        let farthest_m = self.places.iter().map(|(place, _)| place.distance_m(middle)).fold(0.0, f64::max);
        Some(HeardNode {
            node,
            middle,
            farthest_m: if is_one_place { 0.0 } else { farthest_m },
            stops: u32::try_from(self.places.len()).unwrap_or(u32::MAX),
            corners,
        })
    }
}

/// The distance from the middle of the stops that heard a node to the farthest of them which 95 % of the nodes do not
/// exceed, and at least one of several nodes does (m): about the range of the radios where the survey is larger than
/// that, less where it is smaller. The usual gap between stops if each node was heard at one place only, 1 m if there is
/// no gap.
pub(crate) fn reach_m(log: &ReceptionLog, heard: &[HeardNode]) -> f64 {
    reach_of_m(log, heard.iter().map(|heard| heard.farthest_m))
}

/// The same by the farthest stops of the nodes that were heard.
pub(crate) fn reach_of_m(log: &ReceptionLog, farthest_m: impl Iterator<Item = f64>) -> f64 {
    known_reach_m(farthest_m).or_else(|| gap_m(log)).unwrap_or(1.0)
}

/// Whether the log tells how far nodes are heard: nodes were heard at several places.
pub(crate) fn is_reach_known(heard: &[HeardNode]) -> bool {
    known_reach_m(heard.iter().map(|heard| heard.farthest_m)).is_some()
}

/// The reach, by the farthest stops of the nodes that were heard (m); `None` if the log does not tell.
pub(crate) fn known_reach_m(farthest_m: impl Iterator<Item = f64>) -> Option<f64> {
    let mut farthest_m: Vec<f64> = farthest_m.collect();
    farthest_m.sort_unstable_by(f64::total_cmp);
    let most = farthest_m.len().saturating_sub(if farthest_m.len() > 2 { 2 } else { 1 });
    let common = crate::numerics::whole(COMMON * farthest_m.len() as f64).min(most);
    farthest_m.get(common).copied().filter(|&reach_m| reach_m > 0.0)
}

/// The median distance from a stop of a robot to its next one, of those that differ (m); `None` if no robot moved.
pub(crate) fn gap_m(log: &ReceptionLog) -> Option<f64> {
    let mut gaps: Vec<f64> = log.drives().map(|drive| drive.length_m()).filter(|&gap| gap > 0.0).collect();
    if gaps.is_empty() { None } else { Some(median(&mut gaps)) }
}

/// The median of `values`, of two middle values the upper one. There must be at least one value.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
