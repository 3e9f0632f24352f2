//! Targets, fields, and what sensors said, as figures show them.

use prost::Message as _;
use sextant_channel::Position;
use sextant_kernel::{NodeId, SimTime};

use super::super::drawing::GridPlane;
use super::super::messages::{SensedMessage, SensorsMessage};
use super::super::sensation::Sensation;
use super::Drawn;

/// A target and its way.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnTarget {
    /// Name of the target.
    pub name: String,
    /// Where it was (m) and when, in the order of time; it moved straight between two places.
    pub way: Vec<(SimTime, Position)>,
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
pub struct DrawnField {
    /// Name of the field.
    pub name: String,
    /// The instant.
    pub time: SimTime,
    /// The values, in the unit of the field.
    pub plane: GridPlane,
}

impl DrawnTarget {
    /// The place at `time`: the first place before it was seen, the last one after.
    #[must_use]
    pub fn at(&self, time: SimTime) -> Option<Position> {
        let next = self.way.partition_point(|(at, _)| *at <= time);
        match (next.checked_sub(1).map(|last| self.way[last]), self.way.get(next)) {
            (Some((start, from)), Some(&(end, to))) => {
                let share = (time - start).as_secs_f64() / (end - start).as_secs_f64();
                Some(from + (to - from) * share)
            }
            (Some((_, place)), None) | (None, Some(&(_, place))) => Some(place),
            (None, None) => None,
        }
    }
}

impl Drawn {
    pub(super) fn add_target(&mut self, name: &str, time: SimTime, place: Position) {
        match self.targets.iter_mut().find(|target| target.name == name) {
            Some(target) => target.way.push((time, place)),
            None => self.targets.push(DrawnTarget { name: name.to_owned(), way: vec![(time, place)] }),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_is_between_the_places_where_it_was_seen() {
        let at = SimTime::from_nanos;
        let way = vec![(at(10), Position::ORIGIN), (at(20), Position::new(4.0, 0.0, 0.0))];
        let target = DrawnTarget { name: "t".to_owned(), way };
        for (time, x) in [(0, 0.0), (10, 0.0), (15, 2.0), (20, 4.0), (99, 4.0)] {
            assert!(target.at(at(time)).unwrap().distance_m(Position::new(x, 0.0, 0.0)) < 1e-12);
        }
        assert_eq!(DrawnTarget { name: "t".to_owned(), way: Vec::new() }.at(at(3)), None);
    }
}
