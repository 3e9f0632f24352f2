//! The true world, which robots and mappers do not know.

pub(crate) mod anchors;
pub mod layout;

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_channel::{Obstacle, ObstacleConfig, ObstacleField};
use sextant_kernel::{Seed, SettingError};

use layout::{NodesConfig, PlacedNode};

/// The world, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WorldConfig {
    /// The layout of the nodes.
    pub nodes: NodesConfig,
    /// The obstacles to radio and robots.
    #[serde(default)]
    pub obstacles: Vec<ObstacleConfig>,
}

/// The true world.
#[derive(Clone, Debug)]
pub struct World {
    /// The nodes; the index is the [`NodeId`](sextant_kernel::NodeId).
    pub nodes: Vec<PlacedNode>,
    /// The obstacles.
    pub obstacles: ObstacleField,
}

impl WorldConfig {
    /// The files that it names, and the key of each.
    pub fn files_mut(&mut self) -> impl Iterator<Item = (String, &mut PathBuf)> {
        let of_nodes = self.nodes.file_mut().map(|(key, file)| (format!("nodes.{key}"), file));
        let of_obstacles = self.obstacles.iter_mut().enumerate().filter_map(|(i, obstacle)| {
            obstacle.file_mut().map(|(key, file)| (format!("obstacles[{i}].{key}"), file))
        });
        of_nodes.into_iter().chain(of_obstacles)
    }

    /// Sets up the world: the obstacles first, the nodes between them. Paths are relative to `folder`.
    ///
    /// # Errors
    /// If an obstacle has no volume, a node is in an obstacle, or the nodes do not fit.
    pub fn build(&self, seed: Seed, folder: &Path) -> Result<World, SettingError> {
        let obstacles = Self::set_up_obstacles(&self.obstacles, folder)?;
        let nodes = self.nodes.place(&obstacles, seed, folder).map_err(|error| error.within("nodes"))?;
        Ok(World { nodes, obstacles })
    }

    /// The obstacles alone. Paths are relative to `folder`.
    ///
    /// # Errors
    /// If an obstacle has no volume.
    pub fn set_up_obstacles(configs: &[ObstacleConfig], folder: &Path) -> Result<ObstacleField, SettingError> {
        let obstacle = |(i, config): (usize, &ObstacleConfig)| {
            Obstacle::read(config.clone(), folder).map_err(|error| error.within(format!("obstacles[{i}]")))
        };
        configs.iter().enumerate().map(obstacle).collect::<Result<Vec<_>, _>>().map(ObstacleField::new)
    }
}
