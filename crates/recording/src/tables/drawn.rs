//! Rows of drawings: places, paths, surfaces and texts.

use foxglove::messages::{FrameTransform, Log, PointCloud, PoseInFrame, Quaternion};
use prost::Message as _;
use sextant_channel::Position;

use super::declared::name_of;
use super::row::{Cell, CellKind, TableColumn};
use super::{Message, TableRows};
use crate::drawing;
use crate::messages::names::{
    ApplicationTopics, FIELDS_TOPICS, TARGETS_TOPICS, WORLD_NODES_TOPIC, WORLD_SINKS_TOPIC,
};
use crate::reader::world::plane;

use CellKind::{Integer, Real, Text};

const PLACE: [(&str, CellKind); 3] = [("x_m", Real), ("y_m", Real), ("z_m", Real)];

/// The rows that a drawing is; `None` if it is no table.
pub(super) fn rows(message: &Message<'_>, names: &[String]) -> Result<Option<TableRows>, String> {
    let &Message { topic, schema, time_ns, data } = message;
    let time = Cell::Nanos(time_ns);
    let map = topic.strip_prefix("/map/");
    let rows = match schema {
        "foxglove.PointCloud" if topic == WORLD_NODES_TOPIC => {
            let columns = columns(&[("node", Text)], &PLACE, &[]);
            let row = |(node, place, _)| [vec![Cell::Text(name_of(names, node))], cells(place)].concat();
            table("nodes", &columns, points(data)?.into_iter().map(row))
        }
        "foxglove.PointCloud" if topic == WORLD_SINKS_TOPIC => {
            let columns = columns(&[("sink", Integer)], &PLACE, &[]);
            let row = |(sink, place, _)| [vec![Cell::Integer(sink)], cells(place)].concat();
            table("sinks", &columns, points(data)?.into_iter().map(row))
        }
        "foxglove.PointCloud" if map.is_some() => {
            let columns = columns(&[("node", Text)], &PLACE, &[("error_m", Real), ("t_s", Real)]);
            let row = |(node, place, error_m)| {
                [vec![Cell::Text(name_of(names, node))], cells(place), vec![Cell::Real(error_m), time.clone()]]
                    .concat()
            };
            let name = format!("map-{}", map.unwrap_or_default());
            table(&name, &columns, points(data)?.into_iter().map(row))
        }
        "foxglove.PosesInFrame" => {
            let application = ApplicationTopics::application(topic);
            let of_application = application
                .and_then(|(name, rest)| Some((name, rest.strip_prefix("path/")?)))
                .map(|(name, robot)| (Cell::Text(name.to_owned()), robot));
            let of_survey = || drawing::robot_of_path(topic).map(|robot| (Cell::Missing, robot));
            let Some((application, robot)) = of_application.or_else(of_survey) else { return Ok(None) };
            let columns =
                columns(&[("robot", Text), ("point", Integer)], &PLACE, &[("application", Text), ("t_s", Real)]);
            let row = |(point, place)| {
                let first = vec![Cell::Text(robot.to_owned()), Cell::Integer(point)];
                [first, cells(place), vec![application.clone(), time.clone()]].concat()
            };
            table("robot_paths", &columns, (0..).zip(drawing::path_of(data)?).map(row))
        }
        "foxglove.FrameTransform" => {
            let transform = FrameTransform::decode(data).map_err(|why| why.to_string())?;
            let place = drawing::place_of(data)?;
            if let Some(target) = topic.strip_prefix(TARGETS_TOPICS) {
                let columns = columns(&[("t_s", Real), ("target", Text)], &PLACE, &[]);
                let row = [vec![time, Cell::Text(target.to_owned())], cells(place)].concat();
                table("targets", &columns, [row])
            } else if topic == "/tf" {
                let first = vec![time, Cell::Text(transform.child_frame_id)];
                poses("robot_poses", first, place, transform.rotation)
            } else {
                return Ok(None);
            }
        }
        "foxglove.PoseInFrame" => {
            let robot = topic.strip_prefix("/robot/").and_then(|rest| rest.strip_suffix("/odometry"));
            let pose = PoseInFrame::decode(data).map_err(|why| why.to_string())?.pose;
            let (Some(robot), Some(pose)) = (robot, pose) else { return Ok(None) };
            let at = pose.position.ok_or("a pose without a position")?;
            let place = drawing::place(at.x, at.y, at.z)?;
            poses("robot_odometry", vec![time, Cell::Text(robot.to_owned())], place, pose.orientation)
        }
        "foxglove.Grid" => {
            let likelihood = topic.strip_prefix("/likelihood/").and_then(|rest| rest.split_once('/'));
            let (name, first, value) = match (likelihood, topic.strip_prefix(FIELDS_TOPICS)) {
                (Some((map, node)), _) => {
                    ("likelihoods", [("map", map), ("node", node)].to_vec(), ("log_likelihood", Real))
                }
                (None, Some(field)) => ("fields", [("field", field)].to_vec(), ("value", Real)),
                (None, None) => return Ok(None),
            };
            let kinds: Vec<_> = first.iter().map(|&(column, _)| (column, Text)).collect();
            let columns = columns(&kinds, &PLACE, &[value, ("t_s", Real)]);
            let first: Vec<_> = first.iter().map(|&(_, text)| Cell::Text(text.to_owned())).collect();
            let plane = plane(data)?;
            let vertex = |(i, &value): (u32, &f64)| {
                let (column, line) = (i % plane.columns, i / plane.columns);
                let Position { x_m, y_m, z_m } = plane.first;
                let step = |count: u32| f64::from(count) * plane.step_m;
                let place = Position::new(x_m + step(column), y_m + step(line), z_m);
                [first.clone(), cells(place), vec![Cell::Real(value), time.clone()]].concat()
            };
            table(name, &columns, (0..).zip(&plane.values).map(vertex))
        }
        "foxglove.Log" => {
            let log = Log::decode(data).map_err(|why| why.to_string())?;
            let level = log.level().as_str_name().to_lowercase();
            let columns = columns(&[("t_s", Real), ("level", Text), ("source", Text), ("message", Text)], &[], &[]);
            table("log", &columns, [vec![time, Cell::Text(level), Cell::Text(log.name), Cell::Text(log.message)]])
        }
        _ => return Ok(None),
    };
    Ok(Some(rows))
}

fn columns(
    first: &[(&'static str, CellKind)],
    place: &[(&'static str, CellKind)],
    last: &[(&'static str, CellKind)],
) -> Vec<TableColumn> {
    [first, place, last].concat().into_iter().map(|(name, kind)| TableColumn::new(name, kind)).collect()
}

fn table(name: &str, columns: &[TableColumn], rows: impl IntoIterator<Item = Vec<Cell>>) -> TableRows {
    TableRows { table: name.to_owned(), columns: columns.to_vec(), cells: rows.into_iter().collect() }
}

/// The row of a pose with its heading, counterclockwise from x.
fn poses(name: &str, first: Vec<Cell>, place: Position, rotation: Option<Quaternion>) -> TableRows {
    let columns = columns(&[("t_s", Real), ("robot", Text)], &PLACE, &[("heading_rad", Real)]);
    let heading = rotation.map_or(Cell::Missing, |turn| Cell::Real(2.0 * libm::atan2(turn.z, turn.w)));
    table(name, &columns, [[first, cells(place), vec![heading]].concat()])
}

fn cells(place: Position) -> Vec<Cell> {
    [place.x_m, place.y_m, place.z_m].map(Cell::Real).to_vec()
}

/// The points of a cloud: the number of the node, its place and its error, which may be none (m).
fn points(data: &[u8]) -> Result<Vec<(i64, Position, f64)>, String> {
    let cloud = PointCloud::decode(data).map_err(|why| why.to_string())?;
    let nodes = drawing::nodes_of(&cloud)?;
    let errors = cloud.data.as_chunks::<{ drawing::POINT_OCTETS as usize }>().0;
    let error = |point: &[u8; drawing::POINT_OCTETS as usize]| {
        f64::from_le_bytes(std::array::from_fn(|i| point[drawing::ERROR_AT + i]))
    };
    Ok(nodes.into_iter().zip(errors).map(|((node, place), point)| (node.0.into(), place, error(point))).collect())
}
