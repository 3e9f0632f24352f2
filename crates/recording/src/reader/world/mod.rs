//! Reads from a recording what figures show: positions, shapes and likelihood surfaces.

pub(crate) mod applications;
pub(crate) mod distributed;
pub(crate) mod routing;
pub(crate) mod sensing;

use std::collections::BTreeMap;
use std::path::Path;

use foxglove::messages::{Grid, PointCloud, SceneUpdate};
use prost::Message as _;
use sextant_channel::Position;
use sextant_kernel::{NodeId, SimTime};

use crate::drawing::{self, GridPlane, Solid, place};
use crate::error::RecordingError;
use crate::mcap_file::Piece;
use crate::messages::names::{
    ANCHORS_TOPIC, ApplicationTopics, BATTERIES_TOPIC, FIELDS_TOPICS, MAPPED_NODES_TOPIC, PARENT_CHANGES_TOPIC,
    PHASES_METADATA, SENSED_TOPIC, SENSORS_TOPIC, TARGETS_TOPICS, TREE_TOPIC, WORLD_NODES_TOPIC, WORLD_SINKS_TOPIC,
};
use crate::messages::phase::{self, Phase};
use crate::reader::run::sound;
use applications::RecordedApplication;
use distributed::RecordedNode;
use routing::{RecordedEdge, RecordedParent};
use sensing::{Detection, RecordedField, RecordedTarget, Sample};

/// Positions by node (m).
pub type Places = BTreeMap<NodeId, Position>;

/// Everything in a recording that has a position. The last message of each topic counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedWorld {
    /// The true positions of the nodes; empty if the recording does not have them.
    pub nodes: Places,
    /// The positions of the sinks, by number.
    pub sinks: Places,
    /// The nodes that know their position, and where they believe to be.
    pub anchors: Places,
    /// The obstacles.
    pub obstacles: Vec<Solid>,
    /// Robots and their paths, in the order of the file.
    pub paths: Vec<(String, Vec<Position>)>,
    /// Robots and the paths that they believed, beside `paths`, if they were estimated again; a recording has none.
    pub believed_paths: Vec<(String, Vec<Position>)>,
    /// Maps and their positions of nodes, in the order of the file.
    pub maps: Vec<(String, Places)>,
    /// The nodes that computed a map themselves.
    pub mapped_nodes: Vec<RecordedNode>,
    /// The tree over which packets went at the end, a node each; empty without routing.
    pub tree: Vec<RecordedEdge>,
    /// The parents that nodes chose, in the order of time; empty if the tree does not change.
    pub parents: Vec<RecordedParent>,
    /// When nodes died, by a fault or of an empty battery.
    pub deaths: BTreeMap<NodeId, SimTime>,
    /// When the tree was written: at the end of the simulation.
    pub tree_end: SimTime,
    /// Likelihood surfaces in the order of the file.
    pub likelihoods: Vec<RecordedLikelihood>,
    /// The targets, in the order of the file.
    pub targets: Vec<RecordedTarget>,
    /// Radius within which nodes detect targets (m), if they do.
    pub detection_radius_m: Option<f64>,
    /// When nodes detected targets, in the order of the file.
    pub detections: Vec<Detection>,
    /// Fields at an instant, in the order of the file.
    pub fields: Vec<RecordedField>,
    /// What nodes read of the fields, in the order of the file.
    pub samples: Vec<Sample>,
    /// The applications, in the order of the file. If there are any, what sensors said, targets and fields are those of the
    /// first phase of the run.
    pub applications: Vec<RecordedApplication>,
}

/// The likelihood of one node in one map.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedLikelihood {
    /// Name of the map.
    pub map: String,
    /// Name of the node.
    pub node: String,
    /// The surface.
    pub plane: GridPlane,
}

/// Reads everything with a position from the recording `path`.
///
/// # Errors
/// If the file cannot be read, is damaged, or has a drawing with another layout than [`crate::Recorder`] writes.
pub fn read_world(path: &Path) -> Result<RecordedWorld, RecordingError> {
    let mut reading = WorldReading::default();
    sound(path, &mut |piece| reading.take(path, &piece))?;
    Ok(reading.finish())
}

/// A world that is being read.
#[derive(Default)]
pub(crate) struct WorldReading {
    drawn: RecordedWorld,
    phases: Vec<Phase>,
}

impl WorldReading {
    /// Takes a piece of the recording `path`.
    pub(crate) fn take(&mut self, path: &Path, piece: &Piece<'_>) -> Result<(), RecordingError> {
        let (channel, header, data) = match piece {
            Piece::Message { channel, header, data } => (channel, header, data),
            Piece::Metadata(record) if record.name == PHASES_METADATA => {
                self.phases = phase::read(&record.metadata).ok_or_else(|| {
                    RecordingError::message(path, PHASES_METADATA, "names and times of different lengths".to_owned())
                })?;
                return Ok(());
            }
            _ => return Ok(()),
        };
        let schema = channel.schema.as_ref().map_or("", |schema| schema.name.as_str());
        self.drawn
            .add(&channel.topic, schema, SimTime::from_nanos(header.log_time), data)
            .map_err(|problem| RecordingError::message(path, &channel.topic, problem))
    }

    /// The world, now that all pieces were taken.
    pub(crate) fn finish(mut self) -> RecordedWorld {
        self.drawn.divide(&self.phases);
        self.drawn
    }
}

impl RecordedWorld {
    /// Adds a message, if it is a drawing. Returns an error message if it is invalid.
    fn add(&mut self, topic: &str, schema: &str, time: SimTime, data: &[u8]) -> Result<(), String> {
        match schema {
            "foxglove.PointCloud" if topic == WORLD_NODES_TOPIC => self.nodes = places(data)?,
            "foxglove.PointCloud" if topic == WORLD_SINKS_TOPIC => self.sinks = places(data)?,
            "foxglove.PointCloud" => {
                if let Some(name) = topic.strip_prefix("/map/") {
                    replace(&mut self.maps, name, places(data)?);
                }
            }
            _ if topic == ANCHORS_TOPIC => {
                let anchor = super::known::anchor(data, usize::MAX)?;
                self.anchors.insert(anchor.node, anchor.position);
            }
            "foxglove.SceneUpdate" if topic == "/world/obstacles" => self.obstacles = solids(data)?,
            "foxglove.PosesInFrame" => {
                if let Some(name) = drawing::robot_of_path(topic) {
                    replace(&mut self.paths, name, drawing::path_of(data)?);
                } else if let Some((name, rest)) = ApplicationTopics::application(topic) {
                    self.add_application(name, rest, time, data)?;
                }
            }
            "foxglove.Grid" => {
                let names = topic.strip_prefix("/likelihood/").and_then(|rest| rest.split_once('/'));
                if let Some((map, node)) = names {
                    let likelihood =
                        RecordedLikelihood { map: map.to_owned(), node: node.to_owned(), plane: plane(data)? };
                    self.likelihoods.retain(|other| other.map != map || other.node != node);
                    self.likelihoods.push(likelihood);
                } else if let Some(name) = topic.strip_prefix(FIELDS_TOPICS) {
                    self.fields.push(RecordedField { name: name.to_owned(), time, plane: plane(data)? });
                }
            }
            "foxglove.FrameTransform" => {
                if let Some(name) = topic.strip_prefix(TARGETS_TOPICS) {
                    self.add_target(name, time, drawing::place_of(data)?);
                }
            }
            _ if topic == MAPPED_NODES_TOPIC => self.mapped_nodes.push(distributed::mapped_node(data)?),
            _ if topic == TREE_TOPIC => {
                let (edge, death) = routing::edge(data)?;
                self.deaths.extend(death.map(|death| (edge.node, death)));
                self.tree.push(edge);
                self.tree_end = time;
            }
            _ if topic == PARENT_CHANGES_TOPIC => self.parents.push(routing::parent(data)?),
            _ if topic == BATTERIES_TOPIC => self.deaths.extend(routing::death(data)?),
            _ if topic == SENSORS_TOPIC => self.detection_radius_m = sensing::radius_m(data)?,
            _ if topic == SENSED_TOPIC => self.add_sensed(time, data)?,
            "sextant.Metric" => self.add_metric(time, data)?,
            _ => {
                if let Some((name, rest)) = ApplicationTopics::application(topic) {
                    self.add_application(name, rest, time, data)?;
                }
            }
        }
        Ok(())
    }
}

/// Sets the value of `name`; an existing name keeps its place in the order.
fn replace<T>(list: &mut Vec<(String, T)>, name: &str, value: T) {
    match list.iter_mut().find(|(other, _)| other == name) {
        Some((_, old)) => *old = value,
        None => list.push((name.to_owned(), value)),
    }
}

pub(crate) fn places(data: &[u8]) -> Result<Places, String> {
    let cloud = PointCloud::decode(data).map_err(|why| why.to_string())?;
    let nodes = drawing::nodes_of(&cloud)?;
    nodes.into_iter().map(|(node, p)| Ok((node, place(p.x_m, p.y_m, p.z_m)?))).collect()
}

fn solids(data: &[u8]) -> Result<Vec<Solid>, String> {
    let scene = SceneUpdate::decode(data).map_err(|why| why.to_string())?;
    let mut solids = Vec::new();
    for entity in &scene.entities {
        for surface in &entity.triangles {
            let vertices: Vec<_> = surface.points.iter().map(|p| place(p.x, p.y, p.z)).collect::<Result<_, _>>()?;
            let (triangles, rest) = surface.indices.as_chunks::<3>();
            let beyond = surface.indices.iter().find(|&&index| index as usize >= vertices.len());
            if let Some(beyond) = beyond {
                return Err(format!("`{}`: corner {beyond} of {}", entity.id, vertices.len()));
            }
            if !rest.is_empty() {
                return Err(format!("`{}`: a triangle with {} corners; allowed: 3", entity.id, rest.len()));
            }
            solids.push(Solid { name: entity.id.clone(), vertices, triangles: triangles.to_vec() });
        }
    }
    Ok(solids)
}

pub(crate) fn plane(data: &[u8]) -> Result<GridPlane, String> {
    let grid = Grid::decode(data).map_err(|why| why.to_string())?;
    let (Some(corner), Some(cell)) = (grid.pose.and_then(|pose| pose.position), grid.cell_size) else {
        return Err("a grid without a pose or a cell size".to_owned());
    };
    let step_m = cell.x;
    if !(step_m > 0.0 && step_m <= Position::FARTHEST_M && (cell.y - step_m).abs() <= 1e-9 * step_m) {
        return Err(format!("cells of {} m by {} m; allowed: square cells", cell.x, cell.y));
    }
    let (values, rest) = grid.data.as_chunks::<4>();
    let columns = grid.column_count as usize;
    if grid.cell_stride != 4 || columns == 0 || values.is_empty() || !rest.is_empty() || values.len() % columns != 0 {
        let octets = grid.data.len();
        return Err(format!(
            "{octets} octets in {columns} columns; allowed: complete rows with four octets per cell"
        ));
    }
    let values: Vec<f64> = values.iter().map(|&octets| f64::from(f32::from_le_bytes(octets))).collect();
    let first = place(corner.x + step_m / 2.0, corner.y + step_m / 2.0, corner.z)?;
    Ok(GridPlane { first, step_m, columns: grid.column_count, values })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_likelihood_plane_is_read_back_equal() {
        let plane = GridPlane {
            first: Position::new(1.0, 2.0, 0.5),
            step_m: 0.25,
            columns: 2,
            values: vec![-1.5, f64::NEG_INFINITY, 0.0, -3.25],
        };
        let data = drawing::grid(SimTime::ZERO, &plane, "value").encode_to_vec();
        assert_eq!(super::plane(&data), Ok(plane));
    }

    #[test]
    fn a_grid_with_an_incomplete_row_is_rejected() {
        let plane = GridPlane { first: Position::ORIGIN, step_m: 0.25, columns: 2, values: vec![0.0; 3] };
        assert!(super::plane(&drawing::grid(SimTime::ZERO, &plane, "value").encode_to_vec()).is_err());
    }

    #[test]
    fn a_triangle_with_a_missing_corner_is_rejected() {
        let solid = Solid { name: "wall".to_owned(), vertices: vec![Position::ORIGIN], triangles: vec![[0, 0, 1]] };
        let problem = solids(&drawing::scene(SimTime::ZERO, &[solid]).encode_to_vec()).unwrap_err();
        assert!(problem.contains("corner 1 of 1"), "{problem}");
    }

    #[test]
    fn the_last_message_of_a_topic_counts_and_the_order_stays() {
        let mut list = Vec::new();
        for (name, value) in [("a", 1), ("b", 2), ("a", 3)] {
            replace(&mut list, name, value);
        }
        assert_eq!(list, [("a".to_owned(), 3), ("b".to_owned(), 2)]);
    }
}
