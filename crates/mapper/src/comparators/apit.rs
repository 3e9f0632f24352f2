//! APIT (He et al. 2003): finds the triangles of anchors that hold a node, by comparison with its neighbours.

use sextant_channel::{NeighbourLog, Position};
use sextant_kernel::{NodeId, SettingError, Watch};

use super::centroid::weighted_mean;
use super::graph::Graph;
use super::heard_anchors::{HeardAnchors, NamedAnchor};
use super::{check_link_share, default_link_share, node_by_node};
use crate::comparators::Comparator;
use crate::error::MapError;
use crate::estimator::{EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::numerics::whole;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// APIT as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ApitConfig {
    /// Distance between neighbouring grid points (m).
    pub grid_step_m: f64,
    /// How many of the anchors heard are used, the strongest first: 3 to 20.
    #[cfg_attr(feature = "schema", schemars(range(min = 3, max = 20)))]
    pub strongest: usize,
    /// Least share of each other's packets that both nodes of a link must have received; above 0, at most 1.
    pub link_share: f64,
}

impl Default for ApitConfig {
    fn default() -> Self {
        Self { grid_step_m: 0.5, strongest: 10, link_share: default_link_share() }
    }
}

/// APIT, in the plane. A node is judged to be outside a triangle of anchors if a neighbour hears all three anchors
/// more strongly than the node does, or all three more weakly; otherwise inside. Each triangle adds one to the grid
/// points inside it, or subtracts one if the node is outside. The estimate is the centroid of the points with the
/// highest sum. A node with fewer than three anchors gets their centroid; one that heard none is not placed. Anchors
/// keep their known places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apit {
    grid_step_m: f64,
    strongest: usize,
    link_share: f64,
}

impl TryFrom<ApitConfig> for Apit {
    type Error = SettingError;

    fn try_from(config: ApitConfig) -> Result<Self, SettingError> {
        let ApitConfig { grid_step_m, strongest, link_share } = config;
        if !(3..=20).contains(&strongest) {
            return Err(SettingError::new("strongest", strongest, "3 to 20"));
        }
        check_link_share(link_share)?;
        Ok(Self { grid_step_m: SettingError::positive("grid_step_m", grid_step_m)?, strongest, link_share })
    }
}

/// Maximum number of grid points along an axis.
const MOST_POINTS: usize = 2000;

impl Comparator for Apit {
    const NAME: &'static str = "apit";

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::Neighbours, KnowledgeKind::AnchorRssi, KnowledgeKind::Anchors]
    }

    fn least_anchors(&self, _: usize) -> usize {
        3
    }

    /// The map.
    ///
    /// # Errors
    /// [`MapError::Missing`] without what was heard of anchors and neighbours; [`MapError::TooFewAnchors`] below three;
    /// [`MapError::PlanarOnly`] if the anchors have different heights; [`MapError::Interrupted`].
    fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let anchors = HeardAnchors::new(knowledge, Self::NAME, 3)?;
        if knowledge.dimensions() != 2 {
            return Err(MapError::PlanarOnly(Self::NAME));
        }
        let graph = Graph::of(knowledge.neighbours(Self::NAME)?, self.link_share);
        let beacons = knowledge.beacons(Self::NAME)?;
        let place = |node: usize| {
            anchors.own_place(node).or_else(|| {
                let mut heard = anchors.of(node);
                heard.truncate(self.strongest);
                self.place(&heard, graph.neighbours(node), beacons, watch)
            })
        };
        let places = node_by_node(Self::NAME, anchors.node_count(), self.operations(knowledge), watch, place)?;
        Ok(TopologyMap::of_places(Self::NAME, places, CoordinateFrame::World))
    }
}

impl Apit {
    /// Triangles times grid points that vote on the place of one node, at most.
    fn operations(&self, knowledge: &Knowledge<'_>) -> f64 {
        let places = || knowledge.anchors.iter().map(|anchor| anchor.position);
        let extent_m = |along: fn(Position) -> f64| {
            let (low, high) = (places().map(along).fold(f64::INFINITY, f64::min), places().map(along));
            high.fold(f64::NEG_INFINITY, f64::max) - low
        };
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let (anchors, most) = (self.strongest.min(knowledge.anchors.len()) as f64, MOST_POINTS as f64);
        let points = [extent_m(|place| place.x_m), extent_m(|place| place.y_m)];
        let points = points.map(|extent_m| (extent_m / self.grid_step_m).min(most) + 1.0);
        anchors.powi(3) / 6.0 * points[0] * points[1]
    }

    /// The place of a node. If the work was ended meanwhile, the result means nothing.
    fn place(
        &self,
        heard: &[NamedAnchor],
        neighbours: &[u32],
        beacons: &NeighbourLog,
        watch: &dyn Watch,
    ) -> Option<Position> {
        // What each neighbour heard of the same anchors.
        let seen: Vec<Vec<Option<f64>>> = neighbours
            .iter()
            .map(|&neighbour| {
                let rssi = |anchor: &NamedAnchor| beacons.link(NodeId(neighbour), anchor.node)?.rssi_dbm;
                heard.iter().map(rssi).collect()
            })
            .collect();
        let mut triangles = Vec::new();
        for i in 0..heard.len() {
            for j in i + 1..heard.len() {
                for k in j + 1..heard.len() {
                    let own = [i, j, k].map(|anchor| heard[anchor].rssi_dbm);
                    let is_outside = seen.iter().any(|seen| {
                        let theirs = [i, j, k].map(|anchor| seen[anchor]);
                        departs(own, theirs)
                    });
                    let corners = [i, j, k].map(|anchor| heard[anchor].position);
                    triangles.push((corners, if is_outside { -1 } else { 1 }));
                }
            }
        }
        if triangles.is_empty() {
            return weighted_mean(&heard.iter().map(|anchor| (anchor.position, 1.0)).collect::<Vec<_>>());
        }
        Some(self.vote(&triangles, watch))
    }

    /// The centroid of the grid points with the highest sum of votes.
    fn vote(&self, triangles: &[([Position; 3], i32)], watch: &dyn Watch) -> Position {
        let corners = || triangles.iter().flat_map(|(corners, _)| corners);
        let low = corners().fold([f64::INFINITY; 2], |low, p| [low[0].min(p.x_m), low[1].min(p.y_m)]);
        let high = corners().fold([f64::NEG_INFINITY; 2], |high, p| [high[0].max(p.x_m), high[1].max(p.y_m)]);
        let counts = [0, 1].map(|axis| whole((high[axis] - low[axis]) / self.grid_step_m).min(MOST_POINTS) + 1);
        let coordinate = |axis: usize, i: usize| {
            let step_m = ((high[axis] - low[axis]) / counts[axis] as f64).max(0.0);
            low[axis] + (i as f64 + 0.5) * step_m
        };
        let z_m = triangles[0].0[0].z_m;
        let (mut highest, mut sum, mut count) = (i32::MIN, Position::ORIGIN, 0.0);
        for y in (0..counts[1]).take_while(|_| !watch.is_stopped()) {
            for x in 0..counts[0] {
                let point = Position::new(coordinate(0, x), coordinate(1, y), z_m);
                let votes =
                    triangles.iter().filter(|(corners, _)| holds(*corners, point)).map(|(_, vote)| vote).sum();
                if votes > highest {
                    (highest, sum, count) = (votes, Position::ORIGIN, 0.0);
                }
                if votes == highest {
                    sum = sum + point;
                    count += 1.0;
                }
            }
        }
        sum * (1.0 / count)
    }
}

/// Whether a neighbour that hears three anchors with the strengths `theirs` is nearer to all three, or farther from
/// all three, than a node that hears them with the strengths `own` (dBm).
fn departs(own: [f64; 3], theirs: [Option<f64>; 3]) -> bool {
    let [Some(a), Some(b), Some(c)] = theirs else { return false };
    let theirs = [a, b, c];
    let all = |is: fn(&f64, &f64) -> bool| theirs.iter().zip(&own).all(|(theirs, own)| is(theirs, own));
    all(|theirs, own| theirs > own) || all(|theirs, own| theirs < own)
}

/// Whether a triangle in the plane holds a point, its edges included.
fn holds([a, b, c]: [Position; 3], point: Position) -> bool {
    let side =
        |p: Position, q: Position| (q.x_m - p.x_m) * (point.y_m - p.y_m) - (q.y_m - p.y_m) * (point.x_m - p.x_m);
    let sides = [side(a, b), side(b, c), side(c, a)];
    sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0)
}

impl EstimatorSettings for ApitConfig {
    fn mapper(self) -> Result<Mapper, SettingError> {
        Apit::try_from(self).map(Mapper::new)
    }
}

#[cfg(test)]
mod tests {
    use sextant_kernel::Unwatched;

    use super::*;

    #[test]
    fn a_triangle_holds_its_inside_in_either_order() {
        let (a, b, c) = (Position::ORIGIN, Position::new(4.0, 0.0, 0.0), Position::new(0.0, 4.0, 0.0));
        for corners in [[a, b, c], [c, b, a]] {
            assert!(holds(corners, Position::new(1.0, 1.0, 0.0)) && holds(corners, Position::new(2.0, 2.0, 0.0)));
            assert!(!holds(corners, Position::new(2.1, 2.1, 0.0)) && !holds(corners, Position::new(-0.1, 1.0, 0.0)));
        }
    }

    #[test]
    fn a_neighbour_departs_if_all_three_anchors_get_nearer_or_farther() {
        let own = [-60.0, -70.0, -80.0];
        assert!(departs(own, [Some(-59.0), Some(-69.0), Some(-79.0)]));
        assert!(departs(own, [Some(-61.0), Some(-71.0), Some(-81.0)]));
        assert!(!departs(own, [Some(-59.0), Some(-71.0), Some(-79.0)]));
        assert!(!departs(own, [Some(-59.0), None, Some(-79.0)]));
    }

    #[test]
    fn the_votes_of_two_triangles_meet_in_their_overlap() {
        let apit = Apit::try_from(ApitConfig { grid_step_m: 0.01, ..ApitConfig::default() }).unwrap();
        let at = |x, y| Position::new(x, y, 0.0);
        let lower = [at(0.0, 0.0), at(4.0, 0.0), at(0.0, 4.0)];
        let upper = [at(4.0, 0.0), at(0.0, 0.0), at(4.0, 4.0)];
        // Both hold the triangle with the apex (2, 2) over the edge from 0 to 4. Its centroid is (2, 2/3).
        let inside = apit.vote(&[(lower, 1), (upper, 1)], &Unwatched);
        assert!(inside.distance_m(at(2.0, 2.0 / 3.0)) < 0.01, "{inside}");
        // Outside the upper one: the triangle (0,0), (0,4), (2,2), centroid (2/3, 2).
        let outside = apit.vote(&[(lower, 1), (upper, -1)], &Unwatched);
        assert!(outside.distance_m(at(2.0 / 3.0, 2.0)) < 0.01, "{outside}");
    }
}
