//! Which node a robot serves next, and in which sector it is, by its map and its odometry.

use sextant_channel::Position;
use sextant_kernel::NodeId;
use sextant_mac::dmg::retraining::Prediction;
use sextant_sim::Pose;

use super::settings::BeamTracking;
use crate::navigation::{MapFrame, NavigationMap};

/// Another node must be nearer by this factor: 3 dB in free space.
const NEARER: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The node that a robot at `pose` serves next, and the sector of its antenna with the greatest gain there: the node of the
/// link, unless another one of those that it does not `avoid` is much nearer. `None` if the map does not tell.
pub(super) fn predict(
    mission: &BeamTracking,
    map: &NavigationMap,
    pose: Pose,
    serving: Option<NodeId>,
    avoid: impl Fn(NodeId) -> bool,
) -> Option<Prediction> {
    if map.frame() == MapFrame::Unknown {
        return None;
    }
    let distance_m = |node: NodeId| map.place(node).map(|place| place.distance_m(pose.position));
    let nodes = (0..map.places().len()).map(NodeId::from_index).filter(|&node| !avoid(node));
    let nearest = nodes.filter_map(|node| Some((node, distance_m(node)?))).min_by(|a, b| a.1.total_cmp(&b.1));
    let served = serving.and_then(|node| Some((node, distance_m(node)?)));
    let (node, _) = match (nearest, served) {
        (Some(nearest), Some(served)) if nearest.1 >= served.1 * NEARER => served,
        (nearest, served) => nearest.or(served)?,
    };
    let sector = *sectors_towards(mission, pose, map.place(node)?).first()?;
    Some(Prediction { node: node.0, sector })
}

/// The sectors of a robot at `pose`, those with the greatest gain towards `place` first.
pub(super) fn sectors_towards(mission: &BeamTracking, pose: Pose, place: Position) -> Vec<u8> {
    let apart = place - pose.position;
    let turn_rad = if mission.turns_with_robot { -pose.heading_rad } else { 0.0 };
    let (sin, cos) = libm::sincos(turn_rad);
    let apart = Position::new(cos * apart.x_m - sin * apart.y_m, sin * apart.x_m + cos * apart.y_m, apart.z_m);
    let length_m = apart.length_m();
    let direction = if length_m > 0.0 { apart * (1.0 / length_m) } else { Position::new(1.0, 0.0, 0.0) };
    let mut gains = Vec::new();
    mission.gains.all_dbi(direction, &mut gains);
    let mut sectors: Vec<u8> = (0..=u8::MAX).take(gains.len()).collect();
    sectors.sort_by(|&a, &b| gains[usize::from(b)].total_cmp(&gains[usize::from(a)]));
    sectors
}
