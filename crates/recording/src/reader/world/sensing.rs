//! Targets, fields, and what sensors said, as figures show them.

use prost::Message as _;
use sextant_channel::Position;
use sextant_kernel::{NodeId, SimTime};

use super::super::way::Way;
use super::RecordedWorld;
use crate::drawing::GridPlane;
use crate::messages::sensation::Sensation;
use crate::messages::{SensedMessage, SensorsMessage};

/// A target and its way.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedTarget {
    /// Name of the target.
    pub name: String,
    /// Where it was, and when.
    pub way: Way,
}

/// A node that began or ceased to detect a target.
#[derive(Clone, Debug, PartialEq)]
pub struct Detection {
    /// When.
    pub time: SimTime,
    /// The node.
    pub node: NodeId,
    /// Name of the target.
    pub target: String,
    /// Whether the target entered or left.
    pub sensation: Sensation,
}

/// A sample of a field by a node.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// When.
    pub time: SimTime,
    /// The node.
    pub node: NodeId,
    /// Name of the field.
    pub field: String,
    /// What the node read, in the unit of the field.
    pub value: f64,
}

/// A field at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedField {
    /// Name of the field.
    pub name: String,
    /// The instant.
    pub time: SimTime,
    /// The values, in the unit of the field.
    pub plane: GridPlane,
}

impl RecordedWorld {
    pub(super) fn add_target(&mut self, name: &str, time: SimTime, place: Position) {
        match self.targets.iter_mut().find(|target| target.name == name) {
            Some(target) => target.way.push(time, place),
            None => self.targets.push(RecordedTarget { name: name.to_owned(), way: Way::from_iter([(time, place)]) }),
        }
    }

    pub(super) fn add_sensed(&mut self, time: SimTime, data: &[u8]) -> Result<(), String> {
        let SensedMessage { node, what, name, value, .. } =
            SensedMessage::decode(data).map_err(|why| why.to_string())?;
        let node = NodeId(node);
        match Sensation::read(&what, value) {
            Some(Sensation::Sampled(value)) => self.samples.push(Sample { time, node, field: name, value }),
            Some(sensation) => self.detections.push(Detection { time, node, target: name, sensation }),
            None => {
                return Err(format!("`{what}` with value {value:?}; allowed: entered, left, sampled with a value"));
            }
        }
        Ok(())
    }
}

/// Radius within which nodes detect targets (m).
pub(super) fn radius_m(data: &[u8]) -> Result<Option<f64>, String> {
    let radius_m = SensorsMessage::decode(data).map_err(|why| why.to_string())?.target_radius_m;
    match radius_m {
        Some(radius_m) if !(radius_m > 0.0 && radius_m <= Position::FARTHEST_M) => {
            Err(format!("a radius of detection of {radius_m} m; allowed: above 0"))
        }
        other => Ok(other),
    }
}
