//! Reads from a recording what moves or grows: the ways of robots, and maps at each instant at which they were written.

use std::path::Path;

use foxglove::messages::FrameTransform;
use prost::Message as _;
use sextant_kernel::SimTime;

use super::run::sound;
use super::way::Way;
use super::world::{Places, places};
use crate::drawing;
use crate::error::RecordingError;
use crate::mcap_file::Piece;
use crate::messages::MappedNodeMessage;
use crate::messages::names::{MAPPED_NODES_TOPIC, PHASES_METADATA};
use crate::messages::phase::{self, Phase};

/// Everything in a recording that has a time and a place, except targets and applications.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedCourse {
    /// Where robots really were, by name, in the order of the file.
    pub robots: Vec<(String, Way)>,
    /// Each map at each instant at which it was written, in the order of the file.
    pub maps: Vec<(String, Vec<(SimTime, Places)>)>,
    /// What nodes found that computed their own place.
    pub mapped_nodes: Vec<MappedNodeMessage>,
    /// The simulations of the run, if there are several.
    pub phases: Vec<Phase>,
}

/// Reads everything that moves or grows from the recording `path`.
///
/// # Errors
/// If the file cannot be read, is damaged, or has a drawing with another layout than [`crate::Recorder`] writes.
pub fn read_course(path: &Path) -> Result<RecordedCourse, RecordingError> {
    let mut course = RecordedCourse::default();
    sound(path, &mut |piece| match piece {
        Piece::Message { channel, header, data } => {
            let schema = channel.schema.as_ref().map_or("", |schema| schema.name.as_str());
            course
                .add(&channel.topic, schema, SimTime::from_nanos(header.log_time), data)
                .map_err(|problem| RecordingError::message(path, &channel.topic, problem))
        }
        Piece::Metadata(record) if record.name == PHASES_METADATA => {
            course.phases = phase::read(&record.metadata).unwrap_or_default();
            Ok(())
        }
        _ => Ok(()),
    })?;
    Ok(course)
}

impl RecordedCourse {
    /// Adds a message, if it says where something was. Returns an error message if it is invalid.
    fn add(&mut self, topic: &str, schema: &str, time: SimTime, data: &[u8]) -> Result<(), String> {
        match (topic, schema) {
            ("/tf", "foxglove.FrameTransform") => {
                let robot = FrameTransform::decode(data).map_err(|why| why.to_string())?.child_frame_id;
                let place = drawing::place_of(data)?;
                entry(&mut self.robots, &robot).push(time, place);
            }
            (_, "foxglove.PointCloud") => {
                if let Some(name) = topic.strip_prefix("/map/") {
                    let map = places(data)?;
                    entry(&mut self.maps, name).push((time, map));
                }
            }
            (MAPPED_NODES_TOPIC, _) => {
                self.mapped_nodes.push(MappedNodeMessage::decode(data).map_err(|why| why.to_string())?);
            }
            _ => {}
        }
        Ok(())
    }
}

/// The value of `name`; a new name is put at the end.
fn entry<'a, T: Default>(list: &'a mut Vec<(String, T)>, name: &str) -> &'a mut T {
    let at = list.iter().position(|(other, _)| other == name).unwrap_or_else(|| {
        list.push((name.to_owned(), T::default()));
        list.len() - 1
    });
    &mut list[at].1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::PlacedNode;
    use sextant_channel::Position;
    use sextant_kernel::NodeId;

    #[test]
    fn a_map_that_is_written_twice_is_kept_at_both_instants() {
        let mut course = RecordedCourse::default();
        for (seconds, x_m) in [(1, 0.5), (2, 0.75)] {
            let time = SimTime::from_nanos(seconds * 1_000_000_000);
            let node = PlacedNode { node: NodeId(3), position: Position::new(x_m, 0.0, 0.0), error_m: None };
            let data = drawing::cloud(time, &[node]).encode_to_vec();
            course.add("/map/ml-tm", "foxglove.PointCloud", time, &data).unwrap();
            course.add("/world/nodes", "foxglove.PointCloud", time, &data).unwrap();
        }
        let [(name, snapshots)] = &course.maps[..] else { panic!("one map") };
        let places: Vec<_> = snapshots.iter().map(|(_, places)| places[&NodeId(3)].x_m).collect();
        assert_eq!((name.as_str(), places), ("ml-tm", vec![0.5, 0.75]));
        assert!(snapshots[0].0 < snapshots[1].0);
    }

    #[test]
    fn a_robot_is_where_its_transforms_say() {
        let mut course = RecordedCourse::default();
        let at = SimTime::from_nanos;
        for (time, x_m) in [(at(0), 0.0), (at(10), 4.0)] {
            let transform = drawing::transform(time, "r", Position::new(x_m, 0.0, 0.0), 0.0);
            course.add("/tf", "foxglove.FrameTransform", time, &transform.encode_to_vec()).unwrap();
        }
        assert_eq!(course.robots[0].1.at(at(5)), Some(Position::new(2.0, 0.0, 0.0)));
    }
}
