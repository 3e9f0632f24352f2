//! A node with its place, and the check of names.

use std::collections::BTreeMap;

use sextant_channel::Position;

/// A node with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedNode {
    /// Its name, unique in the network.
    pub name: String,
    /// Where it is (m).
    pub position: Position,
}

/// The two indices of the first name that appears twice.
pub(in crate::world) fn twin<'a>(names: impl Iterator<Item = &'a str>) -> Option<(usize, usize)> {
    let mut first = BTreeMap::new();
    names.enumerate().find_map(|(i, name)| first.insert(name, i).map(|before| (before, i)))
}
