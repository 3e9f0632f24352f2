//! Messages for viewers: positions and shapes in the Foxglove schemas, in the frame `world` (m).

pub(super) mod playing;

use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{
    Color, FrameTransform, Grid, PackedElementField, Point3, PointCloud, Pose, PoseInFrame, PosesInFrame, Quaternion,
    SceneEntity, SceneUpdate, Timestamp, TriangleListPrimitive, Vector2, Vector3,
};
use prost::Message as _;
use prost::bytes::Bytes;
use sextant_channel::{Obstacle, Position};
use sextant_kernel::{NodeId, SimTime};

/// The coordinate frame of every position in a recording.
const WORLD: &str = "world";

/// Colour of obstacles: like concrete, slightly transparent.
const OBSTACLE_COLOR: Color = Color { r: 0.55, g: 0.53, b: 0.50, a: 0.85 };

/// The surface of an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Name of the obstacle, unique in the world.
    pub name: String,
    /// Corners of the surface (m).
    pub vertices: Vec<Position>,
    /// Triangles as three indices into `vertices`, counterclockwise when seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Solid {
    /// The surface of `obstacle`. If the obstacle has no name, it is named by its `index` in the world.
    #[must_use]
    pub fn of(obstacle: &Obstacle, index: usize) -> Self {
        let (vertices, triangles) = obstacle.mesh();
        let name = obstacle.name().map_or_else(|| format!("obstacle {index}"), str::to_owned);
        Self { name, vertices, triangles }
    }
}

/// A node in the world or on a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedNode {
    /// The node.
    pub node: NodeId,
    /// Its true or estimated position (m).
    pub position: Position,
    /// Distance between map and truth (m), if known.
    pub error_m: Option<f64>,
}

/// Values on a plane of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct GridPlane {
    /// The first vertex, with the lowest x and y (m).
    pub first: Position,
    /// Distance between neighbouring vertices (m).
    pub step_m: f64,
    /// Vertices along x.
    pub columns: u32,
    /// The value at each vertex; x varies fastest.
    pub values: Vec<f64>,
}

/// Simulated time as a timestamp for viewers, at most 136 years.
pub(super) fn timestamp(time: SimTime) -> Timestamp {
    const SECOND_NS: u64 = 1_000_000_000;
    let nanos = u32::try_from(time.as_nanos() % SECOND_NS).expect("less than a second");
    match u32::try_from(time.as_nanos() / SECOND_NS) {
        Ok(seconds) => Timestamp::new(seconds, nanos),
        Err(_) => Timestamp::MAX,
    }
}

fn vector(p: Position) -> Vector3 {
    Vector3 { x: p.x_m, y: p.y_m, z: p.z_m }
}

/// A rotation about the vertical axis, counterclockwise when seen from above.
fn yaw(heading_rad: f64) -> Quaternion {
    Quaternion { x: 0.0, y: 0.0, z: libm::sin(heading_rad / 2.0), w: libm::cos(heading_rad / 2.0) }
}

fn pose(position: Position) -> Pose {
    Pose { position: Some(vector(position)), orientation: Some(yaw(0.0)) }
}

/// The frame of a robot or target in the world.
pub(super) fn transform(time: SimTime, name: &str, position: Position, heading_rad: f64) -> FrameTransform {
    FrameTransform {
        timestamp: Some(timestamp(time)),
        parent_frame_id: WORLD.to_owned(),
        child_frame_id: name.to_owned(),
        translation: Some(vector(position)),
        rotation: Some(yaw(heading_rad)),
    }
}

/// A pose in the world.
pub(super) fn pose_in_world(time: SimTime, position: Position, heading_rad: f64) -> PoseInFrame {
    PoseInFrame {
        timestamp: Some(timestamp(time)),
        frame_id: WORLD.to_owned(),
        pose: Some(Pose { position: Some(vector(position)), orientation: Some(yaw(heading_rad)) }),
    }
}

/// The path of a robot.
pub(super) fn path(time: SimTime, places: &[Position]) -> PosesInFrame {
    PosesInFrame {
        timestamp: Some(timestamp(time)),
        frame_id: WORLD.to_owned(),
        poses: places.iter().copied().map(pose).collect(),
    }
}

/// The robot whose path is on `topic`; `None` if it is not the topic of a path.
pub(super) fn robot_of_path(topic: &str) -> Option<&str> {
    topic.strip_prefix("/robot/")?.strip_suffix("/path")
}

/// The positions of a path that [`path`] wrote, or an error message.
pub(super) fn path_of(data: &[u8]) -> Result<Vec<Position>, String> {
    let poses = PosesInFrame::decode(data).map_err(|why| why.to_string())?.poses;
    poses
        .iter()
        .map(|pose| pose.position.as_ref().ok_or_else(|| "a pose without a position".to_owned()))
        .map(|position| position.and_then(|p| place(p.x, p.y, p.z)))
        .collect()
}

/// The place of a robot or target that [`transform`] wrote, or an error message.
pub(super) fn place_of(data: &[u8]) -> Result<Position, String> {
    let translation = FrameTransform::decode(data).map_err(|why| why.to_string())?.translation;
    let p = translation.ok_or_else(|| "a transform without a translation".to_owned())?;
    place(p.x, p.y, p.z)
}

/// A valid position, or an error message.
pub(super) fn place(x_m: f64, y_m: f64, z_m: f64) -> Result<Position, String> {
    let position = Position::new(x_m, y_m, z_m);
    if position.is_within_reason() {
        Ok(position)
    } else {
        let farthest_m = Position::FARTHEST_M;
        Err(format!("position [{x_m}, {y_m}, {z_m}]; allowed: coordinates of at most {farthest_m:e} m"))
    }
}

/// One entity per obstacle, so that a viewer can show the name of an obstacle.
pub(super) fn scene(time: SimTime, solids: &[Solid]) -> SceneUpdate {
    let entity = |solid: &Solid| SceneEntity {
        timestamp: Some(timestamp(time)),
        frame_id: WORLD.to_owned(),
        id: solid.name.clone(),
        triangles: vec![TriangleListPrimitive {
            pose: Some(pose(Position::ORIGIN)),
            points: solid.vertices.iter().map(|p| Point3 { x: p.x_m, y: p.y_m, z: p.z_m }).collect(),
            color: Some(OBSTACLE_COLOR),
            colors: Vec::new(),
            indices: solid.triangles.iter().flatten().copied().collect(),
        }],
        ..SceneEntity::default()
    };
    SceneUpdate { deletions: Vec::new(), entities: solids.iter().map(entity).collect() }
}

/// Octets per point of [`cloud`]: eight each for x, y, z and error, and four for the node.
pub(super) const POINT_OCTETS: u32 = 36;
/// Where the error of a point begins.
pub(super) const ERROR_AT: usize = 24;

/// Nodes as points with the fields x, y, z, error (m) and node (index); an unknown error is NaN.
pub(super) fn cloud(time: SimTime, nodes: &[PlacedNode]) -> PointCloud {
    let mut data = Vec::with_capacity(nodes.len() * POINT_OCTETS as usize);
    for &PlacedNode { node, position: p, error_m } in nodes {
        for value in [p.x_m, p.y_m, p.z_m, error_m.unwrap_or(f64::NAN)] {
            data.extend_from_slice(&value.to_le_bytes());
        }
        data.extend_from_slice(&node.0.to_le_bytes());
    }
    PointCloud {
        timestamp: Some(timestamp(time)),
        frame_id: WORLD.to_owned(),
        pose: Some(pose(Position::ORIGIN)),
        point_stride: POINT_OCTETS,
        fields: vec![
            field("x", 0, NumericType::Float64),
            field("y", 8, NumericType::Float64),
            field("z", 16, NumericType::Float64),
            field("error", 24, NumericType::Float64),
            field("node", 32, NumericType::Uint32),
        ],
        data: Bytes::from(data),
    }
}

/// The nodes of a cloud that [`cloud`] wrote, or an error message.
pub(super) fn nodes_of(cloud: &PointCloud) -> Result<Vec<(NodeId, Position)>, String> {
    let (points, rest) = cloud.data.as_chunks::<{ POINT_OCTETS as usize }>();
    if cloud.point_stride != POINT_OCTETS || !rest.is_empty() {
        return Err(format!("points have a stride of {}; allowed: {POINT_OCTETS}", cloud.point_stride));
    }
    Ok(points
        .iter()
        .map(|point| {
            let double = |at: usize| f64::from_le_bytes(std::array::from_fn(|i| point[at + i]));
            let node = u32::from_le_bytes(std::array::from_fn(|i| point[32 + i]));
            (NodeId(node), Position::new(double(0), double(8), double(16)))
        })
        .collect())
}

/// A plane of values called `name`, with one cell per vertex and the vertex in the middle of its cell.
pub(super) fn grid(time: SimTime, plane: &GridPlane, name: &str) -> Grid {
    const OCTETS: u32 = 4;
    let half = plane.step_m / 2.0;
    #[expect(clippy::cast_possible_truncation, reason = "seven digits are enough for a picture")]
    let data: Vec<u8> = plane.values.iter().flat_map(|&value| (value as f32).to_le_bytes()).collect();
    Grid {
        timestamp: Some(timestamp(time)),
        frame_id: WORLD.to_owned(),
        pose: Some(pose(plane.first - Position::new(half, half, 0.0))),
        column_count: plane.columns,
        cell_size: Some(Vector2 { x: plane.step_m, y: plane.step_m }),
        row_stride: plane.columns * OCTETS,
        cell_stride: OCTETS,
        fields: vec![field(name, 0, NumericType::Float32)],
        data: Bytes::from(data),
    }
}

fn field(name: &str, offset: u32, kind: NumericType) -> PackedElementField {
    PackedElementField { name: name.to_owned(), offset, r#type: kind.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nodes_of_a_cloud_are_read_back_exactly() {
        let nodes = [
            PlacedNode { node: NodeId(7), position: Position::new(0.1, -2e-300, 1e9), error_m: Some(0.5) },
            PlacedNode { node: NodeId(0), position: Position::ORIGIN, error_m: None },
        ];
        let restored = nodes_of(&cloud(SimTime::ZERO, &nodes)).unwrap();
        assert_eq!(restored, nodes.map(|n| (n.node, n.position)));
    }

    #[test]
    fn a_cloud_of_another_layout_is_rejected() {
        let mut foreign = cloud(SimTime::ZERO, &[]);
        foreign.point_stride = 16;
        assert!(nodes_of(&foreign).is_err());
        let mut cut =
            cloud(SimTime::ZERO, &[PlacedNode { node: NodeId(7), position: Position::ORIGIN, error_m: None }]);
        cut.data.truncate(35);
        assert!(nodes_of(&cut).is_err());
    }

    #[test]
    fn times_beyond_the_range_of_timestamps_are_clamped() {
        assert_eq!(timestamp(SimTime::from_nanos(1_500_000_007)), Timestamp::new(1, 500_000_007));
        assert_eq!(timestamp(SimTime::MAX), Timestamp::MAX);
    }

    #[test]
    fn a_grid_cell_has_its_vertex_in_the_middle() {
        let plane = GridPlane { first: Position::new(1.0, 2.0, 0.0), step_m: 0.5, columns: 2, values: vec![0.0; 6] };
        let grid = grid(SimTime::ZERO, &plane, "value");
        let corner = grid.pose.unwrap().position.unwrap();
        assert!((corner.x - 0.75).abs() < 1e-15 && (corner.y - 1.75).abs() < 1e-15);
        assert_eq!(grid.data.len(), 3 * grid.row_stride as usize);
    }
}
