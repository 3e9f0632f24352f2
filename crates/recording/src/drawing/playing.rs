//! Drawings that change while a recording plays: ways, stops, what was heard, names, marks. Frame `world` (m).

use std::time::Duration;

use foxglove::messages::line_primitive::Type as LineType;
use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::scene_entity_deletion::Type as DeletionType;
use foxglove::messages::{
    Color, Duration as Lifetime, LinePrimitive, Point3, PointCloud, SceneEntity, SceneEntityDeletion, SceneUpdate,
    SpherePrimitive, TextPrimitive, Vector3,
};
use prost::bytes::Bytes;
use sextant_channel::Position;
use sextant_kernel::SimTime;

use super::{WORLD, field, pose, timestamp};

/// Ways of robots: blue.
const WAY_COLOR: Color = Color { r: 0.12, g: 0.47, b: 0.71, a: 1.0 };
/// Lines to the nodes that were heard: orange, so that many are still readable.
const HEARD_COLOR: Color = Color { r: 1.0, g: 0.6, b: 0.1, a: 0.5 };
/// Names of nodes: grey, readable on a light and on a dark background.
const NAME_COLOR: Color = Color { r: 0.5, g: 0.5, b: 0.5, a: 1.0 };
/// Captured targets: green.
const CAPTURE_COLOR: Color = Color { r: 0.17, g: 0.63, b: 0.17, a: 1.0 };

/// Thickness of lines on the screen (pixels).
const LINE_PX: f64 = 2.0;
/// Height of letters on the screen (pixels).
const LETTER_PX: f64 = 12.0;
/// Diameter of the mark of a captured target (m).
const CAPTURE_M: f64 = 0.5;

fn point(p: Position) -> Point3 {
    Point3 { x: p.x_m, y: p.y_m, z: p.z_m }
}

/// An entity without anything to draw; one with the same `id` on the same topic is replaced by it.
fn entity(time: SimTime, id: &str) -> SceneEntity {
    SceneEntity {
        timestamp: Some(timestamp(time)),
        frame_id: WORLD.to_owned(),
        id: id.to_owned(),
        ..SceneEntity::default()
    }
}

fn scene(entity: SceneEntity) -> SceneUpdate {
    SceneUpdate { deletions: Vec::new(), entities: vec![entity] }
}

/// Lines through `points`; with `indices`, each pair of these is a line.
fn lines(kind: LineType, points: Vec<Point3>, indices: Vec<u32>, color: Color) -> LinePrimitive {
    LinePrimitive {
        r#type: kind.into(),
        pose: Some(pose(Position::ORIGIN)),
        thickness: LINE_PX,
        scale_invariant: true,
        points,
        color: Some(color),
        colors: Vec::new(),
        indices,
    }
}

/// The way of a robot so far.
pub(crate) fn way(time: SimTime, robot: &str, places: &[Position]) -> SceneUpdate {
    let points = places.iter().copied().map(point).collect();
    scene(SceneEntity {
        lines: vec![lines(LineType::LineStrip, points, Vec::new(), WAY_COLOR)],
        ..entity(time, robot)
    })
}

/// One leg of the way of a robot, by its number.
pub(crate) fn leg(time: SimTime, robot: &str, number: usize, ends: [Position; 2]) -> SceneUpdate {
    let points = ends.map(point).to_vec();
    scene(SceneEntity {
        lines: vec![lines(LineType::LineStrip, points, Vec::new(), WAY_COLOR)],
        ..entity(time, &format!("{robot} {number}"))
    })
}

/// Removes everything that was drawn on a topic.
pub(crate) fn nothing(time: SimTime) -> SceneUpdate {
    let all =
        SceneEntityDeletion { timestamp: Some(timestamp(time)), r#type: DeletionType::All.into(), id: String::new() };
    SceneUpdate { deletions: vec![all], entities: Vec::new() }
}

/// Lines from a place to each of the nodes that were heard there, for as long as the robot listened.
pub(crate) fn heard(time: SimTime, id: &str, place: Position, nodes: &[Position], span: Duration) -> SceneUpdate {
    let points = std::iter::once(place).chain(nodes.iter().copied()).map(point).collect();
    let indices = (1..).take(nodes.len()).flat_map(|node| [0, node]).collect();
    scene(SceneEntity {
        lifetime: Some(lifetime(span)),
        lines: vec![lines(LineType::LineList, points, indices, HEARD_COLOR)],
        ..entity(time, id)
    })
}

/// How long a drawing is shown, at most 68 years.
fn lifetime(span: Duration) -> Lifetime {
    Lifetime::new(i32::try_from(span.as_secs()).unwrap_or(i32::MAX), span.subsec_nanos())
}

/// Names beside places.
pub(crate) fn names<'a>(time: SimTime, named: impl Iterator<Item = (&'a str, Position)>) -> SceneUpdate {
    let texts = named.map(|(name, place)| text(name, place, NAME_COLOR)).collect();
    scene(SceneEntity { texts, ..entity(time, "names") })
}

fn text(text: &str, place: Position, color: Color) -> TextPrimitive {
    TextPrimitive {
        pose: Some(pose(place)),
        billboard: true,
        font_size: LETTER_PX,
        scale_invariant: true,
        color: Some(color),
        text: text.to_owned(),
    }
}

/// The mark of a captured target.
pub(crate) fn capture(time: SimTime, robot: &str, target: &str, place: Position) -> SceneUpdate {
    let size = Vector3 { x: CAPTURE_M, y: CAPTURE_M, z: CAPTURE_M };
    let ball = SpherePrimitive { pose: Some(pose(place)), size: Some(size), color: Some(CAPTURE_COLOR) };
    let words = text(&format!("{robot} captured {target}"), place, CAPTURE_COLOR);
    scene(SceneEntity { spheres: vec![ball], texts: vec![words], ..entity(time, target) })
}

/// Frames as lines from their senders to their receivers, by outcome.
pub(crate) fn on_air(time: SimTime, frames: &[(&str, Vec<[Position; 2]>)], span: Duration) -> SceneUpdate {
    let of_outcome = |(outcome, ends): &(&str, Vec<[Position; 2]>)| {
        let points = ends.iter().flatten().copied().map(point).collect();
        lines(LineType::LineList, points, Vec::new(), outcome_color(outcome))
    };
    let drawn = frames.iter().map(of_outcome).collect();
    scene(SceneEntity { lifetime: Some(lifetime(span)), lines: drawn, ..entity(time, "air") })
}

/// Received frames are green, collided ones red, others orange.
fn outcome_color(outcome: &str) -> Color {
    match outcome {
        "received" => Color { r: 0.17, g: 0.63, b: 0.17, a: 1.0 },
        "collided" => Color { r: 0.84, g: 0.15, b: 0.16, a: 1.0 },
        _ => Color { r: 1.0, g: 0.5, b: 0.05, a: 1.0 },
    }
}

/// A stop as a cloud of one point, with the number of nodes heard there in the field `heard`.
pub(crate) fn stop(time: SimTime, place: Position, heard: u32) -> PointCloud {
    one_point(time, place, "heard", NumericType::Uint32, &heard.to_le_bytes())
}

/// An estimated place as a cloud of one point, with the field `error` (m); an unknown error is NaN.
pub(crate) fn estimated(time: SimTime, place: Position, error_m: Option<f64>) -> PointCloud {
    one_point(time, place, "error", NumericType::Float64, &error_m.unwrap_or(f64::NAN).to_le_bytes())
}

/// A cloud of one point with one value beside x, y and z.
fn one_point(time: SimTime, p: Position, name: &str, kind: NumericType, value: &[u8]) -> PointCloud {
    let mut data = Vec::with_capacity(32);
    for coordinate in [p.x_m, p.y_m, p.z_m] {
        data.extend_from_slice(&coordinate.to_le_bytes());
    }
    data.extend_from_slice(value);
    PointCloud {
        timestamp: Some(timestamp(time)),
        frame_id: WORLD.to_owned(),
        pose: Some(pose(Position::ORIGIN)),
        point_stride: u32::try_from(data.len()).expect("a point has at most 32 octets"),
        fields: vec![
            field("x", 0, NumericType::Float64),
            field("y", 8, NumericType::Float64),
            field("z", 16, NumericType::Float64),
            field(name, 24, kind),
        ],
        data: Bytes::from(data),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_to_heard_nodes_share_the_place_of_the_robot() {
        let at = |x| Position::new(x, 0.0, 0.0);
        let scene = heard(SimTime::ZERO, "robot", at(1.0), &[at(2.0), at(3.0)], Duration::from_millis(1500));
        let [entity] = &scene.entities[..] else { panic!("one entity") };
        assert_eq!(entity.lifetime, Some(Lifetime::new(1, 500_000_000)));
        let [line] = &entity.lines[..] else { panic!("one primitive") };
        let ends: Vec<f64> = line.indices.iter().map(|&index| line.points[index as usize].x).collect();
        assert!(ends.iter().zip([1.0, 2.0, 1.0, 3.0]).all(|(x, expected)| (x - expected).abs() < 1e-12), "{ends:?}");
        assert_eq!(ends.len(), 4);
    }
}
