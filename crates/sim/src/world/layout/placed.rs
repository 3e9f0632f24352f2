//! A node with its place, and the checks of names and places.

use std::collections::BTreeMap;

use sextant_channel::{ObstacleField, Position};

/// A node with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedNode {
    /// Its name, unique in the network.
    pub name: String,
    /// Where it is (m).
    pub position: Position,
}

/// What is wrong with a node or a target at `position`, if anything: the value found, and the values allowed.
pub(in crate::world) fn fault(position: Position, obstacles: &ObstacleField) -> Option<(String, &'static str)> {
    let [x, y, z] = position.into();
    if !position.is_finite() {
        return Some((format!("[{x}, {y}, {z}]"), "finite coordinates in metres"));
    }
    let inside = obstacles.containing(position)?;
    let obstacle = match obstacles.obstacles().get(inside).and_then(|obstacle| obstacle.name()) {
        Some(name) => format!("obstacle `{name}`"),
        None => format!("obstacle {inside}"),
    };
    Some((format!("[{x}, {y}, {z}], inside {obstacle}"), "a place outside all obstacles"))
}

/// The two indices of the first name that appears twice.
pub(in crate::world) fn twin<'a>(names: impl Iterator<Item = &'a str>) -> Option<(usize, usize)> {
    let mut first = BTreeMap::new();
    names.enumerate().find_map(|(i, name)| first.insert(name, i).map(|before| (before, i)))
}
