//! RSSI triangle centroid: circles round the strongest anchors, three by three. Reconstructed from descriptions in
//! later work. How the original smoothed signal strengths is not known.

use sextant_channel::Position;
use sextant_kernel::{SettingError, Watch};

use super::centroid::weighted_mean;
use super::heard_anchors::HeardAnchors;
use super::node_by_node;
use crate::comparators::Comparator;
use crate::comparators::lateration::{Range, multilaterate_linear};
use crate::error::MapError;
use crate::estimator::{EstimatorSettings, Mapper, Messages};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::ranging::{Ranging, RangingConfig};
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// The RSSI triangle centroid as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TriangleCentroidConfig {
    /// How signal strengths become distances.
    pub ranging: RangingConfig,
    /// How many of the anchors heard are used, the strongest first: 3 to 20, in space at least 4.
    #[cfg_attr(feature = "schema", schemars(range(min = 3, max = 20)))]
    pub strongest: usize,
    /// Whether distances are corrected for shadowing, which makes distances from one packet too long on average.
    pub unbias: bool,
    /// How the triangles of a node are averaged.
    pub weights: TriangleWeights,
}

/// How the triangles of a node are averaged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum TriangleWeights {
    /// All triangles have the same weight.
    #[default]
    Equal,
    /// Each triangle is weighted by the inverse of the sum of its distances.
    InverseDistance,
}

impl Default for TriangleCentroidConfig {
    fn default() -> Self {
        Self { ranging: RangingConfig::default(), strongest: 6, unbias: false, weights: TriangleWeights::default() }
    }
}

/// The RSSI triangle centroid.
///
/// It takes all triples of the strongest anchors that are not nearly on one line. Each pair of circles of a triple
/// gives one point: the intersection that fits the third circle best, or the point between the circles if they do not
/// meet. The centroid of the three points is the estimate of the triple. The estimate of the node is the mean over
/// the triples. In space, four anchors and the linear solution replace three anchors and their circles. A node with
/// fewer anchors gets their centroid, weighted by the inverse distance. A node that heard none is not placed. Anchors
/// keep their known places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleCentroid {
    ranging: Ranging,
    strongest: usize,
    divisor: f64,
    weights: TriangleWeights,
}

impl TryFrom<TriangleCentroidConfig> for TriangleCentroid {
    type Error = SettingError;

    fn try_from(config: TriangleCentroidConfig) -> Result<Self, SettingError> {
        let TriangleCentroidConfig { ranging, strongest, unbias, weights } = config;
        if !(3..=20).contains(&strongest) {
            return Err(SettingError::new("strongest", strongest, "3 to 20"));
        }
        let ranging = Ranging::try_from(ranging).map_err(|error| error.within("ranging"))?;
        Ok(Self { ranging, strongest, divisor: if unbias { ranging.bias() } else { 1.0 }, weights })
    }
}

/// Least area of a triangle, divided by the square of its longest side.
const LEAST_AREA: f64 = 1e-3;

/// A circle, or a sphere, round an anchor.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Circle {
    centre: Position,
    radius_m: f64,
}

impl Comparator for TriangleCentroid {
    const NAME: &'static str = "rssi-triangle-centroid";

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::AnchorRssi, KnowledgeKind::Anchors, KnowledgeKind::PathLoss]
    }

    fn least_anchors(&self, dimensions: usize) -> usize {
        dimensions + 1
    }

    fn messages(&self) -> Messages {
        Messages::Beacons
    }

    /// The map.
    ///
    /// # Errors
    /// [`MapError::Missing`] without what was heard of anchors; [`MapError::TooFewAnchors`] below three, in space four;
    /// [`MapError::Interrupted`].
    fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let dimensions = knowledge.dimensions();
        let anchors = HeardAnchors::new(knowledge, Self::NAME, dimensions + 1)?;
        let place = |node| {
            anchors.own_place(node).or_else(|| {
                let circles: Vec<Circle> = anchors
                    .of(node)
                    .iter()
                    .take(self.strongest.max(dimensions + 1))
                    .map(|heard| Circle {
                        centre: heard.position,
                        radius_m: self.ranging.distance_m(heard.rssi_dbm) / self.divisor,
                    })
                    .collect();
                self.place(&circles, dimensions)
            })
        };
        // Three or four of so many anchors.
        let circles = u32::try_from(self.strongest).map_or(f64::INFINITY, f64::from);
        let operations = circles.powi(if dimensions == 2 { 3 } else { 4 });
        let places = node_by_node(Self::NAME, anchors.node_count(), operations, watch, place)?;
        Ok(TopologyMap::of_places(Self::NAME, places, CoordinateFrame::World))
    }
}

impl TriangleCentroid {
    fn place(&self, circles: &[Circle], dimensions: usize) -> Option<Position> {
        let weight = |circles: &[Circle]| match self.weights {
            TriangleWeights::Equal => 1.0,
            TriangleWeights::InverseDistance => 1.0 / circles.iter().map(|circle| circle.radius_m).sum::<f64>(),
        };
        let mut estimates = Vec::new();
        for (i, &a) in circles.iter().enumerate() {
            for (j, &b) in circles.iter().enumerate().skip(i + 1) {
                for (k, &c) in circles.iter().enumerate().skip(j + 1) {
                    if dimensions == 2 {
                        estimates.extend(triangle([a, b, c]).map(|place| (place, weight(&[a, b, c]))));
                    } else {
                        for &d in &circles[k + 1..] {
                            estimates.extend(tetrahedron([a, b, c, d]).map(|place| (place, weight(&[a, b, c, d]))));
                        }
                    }
                }
            }
        }
        if estimates.is_empty() {
            estimates = circles.iter().map(|circle| (circle.centre, 1.0 / circle.radius_m)).collect();
        }
        weighted_mean(&estimates)
    }
}

/// The estimate of three circles in the plane; `None` if their centres nearly lie on one line.
fn triangle(circles: [Circle; 3]) -> Option<Position> {
    let [a, b, c] = circles.map(|circle| circle.centre);
    let double_area = ((b.x_m - a.x_m) * (c.y_m - a.y_m) - (b.y_m - a.y_m) * (c.x_m - a.x_m)).abs();
    let longest_m = a.distance_m(b).max(b.distance_m(c)).max(c.distance_m(a));
    if 0.5 * double_area < LEAST_AREA * longest_m * longest_m {
        return None;
    }
    let points = [0, 1, 2].map(|k| meeting(circles[(k + 1) % 3], circles[(k + 2) % 3], circles[k]));
    Some((points[0] + points[1] + points[2]) * (1.0 / 3.0))
}

/// Where the circles `a` and `b` meet: of two points the one whose distance to the third centre fits the third circle
/// best; between the circles if they do not meet.
fn meeting(a: Circle, b: Circle, third: Circle) -> Position {
    let between = b.centre - a.centre;
    let apart_m = between.length_m();
    let along = between * (1.0 / apart_m);
    if apart_m > a.radius_m + b.radius_m {
        return a.centre + along * (a.radius_m + 0.5 * (apart_m - a.radius_m - b.radius_m));
    }
    if apart_m < (a.radius_m - b.radius_m).abs() {
        // One circle holds the other: half way between them where they are nearest.
        let (outer, inner, along) = if a.radius_m > b.radius_m { (a, b, along) } else { (b, a, along * -1.0) };
        return outer.centre + along * (0.5 * (outer.radius_m + apart_m + inner.radius_m));
    }
    let foot_m = (a.radius_m.powi(2) - b.radius_m.powi(2) + apart_m.powi(2)) / (2.0 * apart_m);
    let height_m = (a.radius_m.powi(2) - foot_m.powi(2)).max(0.0).sqrt();
    let across = Position::new(-along.y_m, along.x_m, 0.0);
    let misfit = |point: Position| (point.distance_m(third.centre) - third.radius_m).abs();
    let foot = a.centre + along * foot_m;
    let (left, right) = (foot + across * height_m, foot - across * height_m);
    if misfit(right) < misfit(left) { right } else { left }
}

/// The estimate of four spheres; `None` if their centres nearly lie in one plane.
fn tetrahedron(spheres: [Circle; 4]) -> Option<Position> {
    let [a, b, c, d] = spheres.map(|sphere| sphere.centre);
    let centres = [a, b, c, d];
    let longest_m = centres.iter().flat_map(|p| centres.map(|q| p.distance_m(q))).fold(0.0, f64::max);
    let volume = (b - a).cross(c - a).dot(d - a).abs() / 6.0;
    if volume < LEAST_AREA * longest_m.powi(3) {
        return None;
    }
    multilaterate_linear(&spheres.map(|sphere| Range::new(sphere.centre, sphere.radius_m)), 3).ok()
}

impl EstimatorSettings for TriangleCentroidConfig {
    fn mapper(self) -> Result<Mapper, SettingError> {
        TriangleCentroid::try_from(self).map(Mapper::new)
    }

    fn ranging_mut(&mut self) -> Option<&mut RangingConfig> {
        Some(&mut self.ranging)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(x_m: f64, y_m: f64, radius_m: f64) -> Circle {
        Circle { centre: Position::new(x_m, y_m, 0.0), radius_m }
    }

    #[test]
    fn circles_meet_beside_between_or_within_each_other() {
        let third = circle(0.0, 10.0, 7.0);
        assert!(
            meeting(circle(0.0, 0.0, 5.0), circle(8.0, 0.0, 5.0), third).distance_m(Position::new(4.0, 3.0, 0.0))
                < 1e-12
        );
        let below = circle(0.0, -10.0, 7.0);
        assert!(
            meeting(circle(0.0, 0.0, 5.0), circle(8.0, 0.0, 5.0), below).distance_m(Position::new(4.0, -3.0, 0.0))
                < 1e-12
        );
        // Gap from 1 to 4.
        assert!(
            meeting(circle(0.0, 0.0, 1.0), circle(6.0, 0.0, 2.0), third).distance_m(Position::new(2.5, 0.0, 0.0))
                < 1e-12
        );
        // The inner circle reaches to 3, the outer to 8, in either order.
        let (outer, inner) = (circle(0.0, 0.0, 8.0), circle(2.0, 0.0, 1.0));
        for (a, b) in [(outer, inner), (inner, outer)] {
            assert!(meeting(a, b, third).distance_m(Position::new(5.5, 0.0, 0.0)) < 1e-12);
        }
    }

    #[test]
    fn centres_on_a_line_or_in_a_plane_make_no_triangle() {
        assert_eq!(triangle([circle(0.0, 0.0, 1.0), circle(1.0, 0.0, 1.0), circle(2.0, 1e-4, 1.0)]), None);
        let sphere = |x, y, z| Circle { centre: Position::new(x, y, z), radius_m: 1.0 };
        let flat = [sphere(0.0, 0.0, 0.0), sphere(1.0, 0.0, 0.0), sphere(0.0, 1.0, 0.0), sphere(1.0, 1.0, 1e-4)];
        assert_eq!(tetrahedron(flat), None);
    }
}
