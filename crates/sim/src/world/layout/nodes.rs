//! The nodes of a world.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position, Storeys};
use sextant_kernel::{Files, Seed, SettingError};

use super::explicit::ExplicitConfig;
use super::file::CsvConfig;
use super::lattice::LatticeConfig;
use super::placed::PlacedNode;
use super::random::RandomConfig;

/// The layout of the nodes, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum NodesConfig {
    /// A list of places.
    Explicit(ExplicitConfig),
    /// The sites of a square or cubic lattice within a region, each moved a little.
    Lattice(LatticeConfig),
    /// Uniform at random within a region.
    Random(RandomConfig),
    /// A table in a file.
    Csv(CsvConfig),
}

impl NodesConfig {
    /// The same layout with heights from zero, of nodes that are in a storey.
    ///
    /// # Errors
    /// If a storey or a node in it is unknown. The key is relative to the table of the nodes.
    pub(crate) fn above_zero(&self, storeys: &Storeys) -> Result<Self, SettingError> {
        Ok(match self {
            Self::Explicit(config) => {
                Self::Explicit(config.above_zero(storeys).map_err(|error| error.within("explicit"))?)
            }
            Self::Lattice(config) => {
                Self::Lattice(config.above_zero(storeys).map_err(|error| error.within("lattice"))?)
            }
            Self::Random(config) => Self::Random(config.above_zero(storeys).map_err(|error| error.within("random"))?),
            Self::Csv(_) => self.clone(),
        })
    }

    /// The file that it names, if it names one, and its key.
    pub(crate) fn file_mut(&mut self) -> Option<(&'static str, &mut PathBuf)> {
        match self {
            Self::Csv(config) => Some(("csv.file", &mut config.file)),
            Self::Explicit(_) | Self::Lattice(_) | Self::Random(_) => None,
        }
    }

    /// Places the nodes among `obstacles`; paths are relative to `base_dir`. The same seed gives the same places.
    ///
    /// # Errors
    /// If a value is invalid, a node is in an obstacle, two nodes have the same name, there is no node at all,
    /// fewer nodes fit than requested, or a file cannot be read. The key is relative to the table of the nodes.
    pub fn place(
        &self,
        obstacles: &ObstacleField,
        seed: Seed,
        files: &Files,
    ) -> Result<Vec<PlacedNode>, SettingError> {
        match self {
            Self::Explicit(config) => config.place(obstacles).map_err(|error| error.within("explicit")),
            Self::Lattice(config) => {
                config.place(obstacles, seed).map(numbered).map_err(|error| error.within("lattice"))
            }
            Self::Random(config) => {
                config.place(obstacles, seed).map(numbered).map_err(|error| error.within("random"))
            }
            Self::Csv(config) => config.place(obstacles, files).map_err(|error| error.within("csv")),
        }
    }
}

/// Nodes at `positions`, named by their index: `n0`, `n1` and so on.
fn numbered(positions: Vec<Position>) -> Vec<PlacedNode> {
    positions.into_iter().enumerate().map(|(i, position)| PlacedNode { name: format!("n{i}"), position }).collect()
}
