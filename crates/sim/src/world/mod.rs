//! The true world, which robots and mappers do not know.

pub(crate) mod anchors;
pub(crate) mod choice;
pub(crate) mod field;
pub(crate) mod interferer;
pub mod layout;
pub(crate) mod motion;
pub(crate) mod sensors;
pub(crate) mod target;

use std::ops::Range;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use sextant_channel::{Obstacle, ObstacleConfig, ObstacleField, StoreyConfig, Storeys, WallConfig};
use sextant_kernel::{Files, Seed, SettingError};

use field::{Field, FieldConfig};
use interferer::Interferer;
use layout::{NodesConfig, PlacedNode};
use motion::{NodeMotion, NodeMotionConfig};
use sensors::Sensors;
use target::{Target, TargetConfig};

/// Largest number of targets, and of fields.
const MOST: usize = 1 << 16;

/// The world, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct WorldConfig {
    /// The layout of the nodes.
    pub nodes: NodesConfig,
    /// Nodes that move; all others stand where the layout puts them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub motions: Vec<NodeMotionConfig>,
    /// The obstacles to radio and robots.
    #[serde(default)]
    pub obstacles: Vec<ObstacleConfig>,
    /// The storeys of a building, from the lowest to the highest, with the slabs between them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub storeys: Vec<StoreyConfig>,
    /// The walls, with their doors and windows.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub walls: Vec<WallConfig>,
    /// The bodies that move without a radio, and that sensors of nodes detect.
    #[serde(default)]
    pub targets: Vec<TargetConfig>,
    /// The scalar fields that sensors of nodes sample.
    #[serde(default)]
    pub fields: Vec<FieldConfig>,
}

/// The true world.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// The nodes; the index is the [`NodeId`](sextant_kernel::NodeId).
    pub nodes: Vec<PlacedNode>,
    /// How nodes move that do, by node. Their positions in `nodes` are those at the start.
    pub motions: Vec<NodeMotion>,
    /// The obstacles: those of `world.obstacles`, then the pieces of walls, then slabs.
    pub obstacles: ObstacleField,
    /// Which obstacles are the pieces of each wall.
    pub walls: Vec<Range<usize>>,
    /// The storey of each slab: the obstacles after the walls are these.
    pub slabs: Vec<usize>,
    /// The targets.
    pub targets: Vec<Target>,
    /// The scalar fields.
    pub fields: Vec<Field>,
    /// The sensors of the nodes.
    pub sensors: Sensors,
    /// The sources of noise.
    pub interferers: Vec<Interferer>,
}

impl World {
    /// The number of obstacles that are neither pieces of walls nor slabs: they come first.
    #[must_use]
    pub fn obstacles_alone(&self) -> usize {
        self.obstacles.len() - self.slabs.len() - self.walls.iter().map(ExactSizeIterator::len).sum::<usize>()
    }

    /// Checks that the materials of all obstacles, walls and slabs are known at the carrier (GHz).
    ///
    /// # Errors
    /// `obstacles[i].material`, `walls[i].material` or `storeys[i].slab.material` if the model of a material does not hold there.
    pub(crate) fn check_carrier(&self, carrier_ghz: f64) -> Result<(), SettingError> {
        self.obstacles.check_carrier(carrier_ghz, |obstacle| {
            let first_slab = self.obstacles.len() - self.slabs.len();
            match self.walls.iter().position(|pieces| pieces.contains(&obstacle)) {
                Some(wall) => format!("walls[{wall}]"),
                None if obstacle >= first_slab => format!("storeys[{}].slab", self.slabs[obstacle - first_slab]),
                None => format!("obstacles[{obstacle}]"),
            }
        })
    }
}

/// The obstacles of a world, before anything is placed among them.
#[derive(Clone, Debug)]
pub struct WorldObstacles {
    /// Those of `world.obstacles`, then the pieces of walls, then slabs.
    pub obstacles: ObstacleField,
    /// Which obstacles are the pieces of each wall.
    walls: Vec<Range<usize>>,
    /// The storey of each slab.
    slabs: Vec<usize>,
    storeys: Storeys,
}

impl WorldConfig {
    /// The files that it names, and the key of each.
    pub fn files_mut(&mut self) -> impl Iterator<Item = (String, &mut PathBuf)> {
        let of_nodes = self.nodes.file_mut().map(|(key, file)| (format!("nodes.{key}"), file));
        let of_obstacles = self.obstacles.iter_mut().enumerate().filter_map(|(i, obstacle)| {
            obstacle.file_mut().map(|(key, file)| (format!("obstacles[{i}].{key}"), file))
        });
        let of_motions = self
            .motions
            .iter_mut()
            .enumerate()
            .filter_map(|(i, motion)| motion.file_mut().map(|(key, file)| (format!("motions[{i}].{key}"), file)));
        of_nodes.into_iter().chain(of_obstacles).chain(of_motions)
    }

    /// Sets up the world: the obstacles first, the nodes and targets between them. The nodes sense nothing. Paths are
    /// among `files`.
    ///
    /// # Errors
    /// If an obstacle has no volume, a node or target is in an obstacle, the nodes do not fit, a target is far from all
    /// nodes or has no way, or a field is invalid.
    pub fn build(&self, seed: Seed, files: &Files) -> Result<World, SettingError> {
        let WorldObstacles { obstacles, walls, slabs, storeys } = self.set_up_obstacles(files)?;
        let within = |error: SettingError| error.within("nodes");
        let nodes = self.nodes.above_zero(&storeys).map_err(within)?;
        let mut nodes = nodes.place(&obstacles, seed, files).map_err(within)?;
        let motions = motion::build(&self.motions, &mut nodes, &obstacles, seed, files)?;
        let target = |(i, config): (usize, &TargetConfig)| {
            config.check_places(&nodes)?;
            config.build(i as u64, &obstacles, seed)
        };
        let targets = all("targets", &self.targets, target)?;
        unique("targets", targets.iter().map(Target::name))?;
        let fields = all("fields", &self.fields, |(_, config)| Field::try_from(config))?;
        unique("fields", fields.iter().map(Field::name))?;
        Ok(World {
            nodes,
            motions,
            obstacles,
            walls,
            slabs,
            targets,
            fields,
            sensors: Sensors::default(),
            interferers: Vec::new(),
        })
    }

    /// The obstacles alone, those of a mesh file with several materials in the place of its entry, then the pieces of walls and the
    /// slabs of storeys. Paths are among `files`.
    ///
    /// # Errors
    /// If an obstacle has no volume, or a storey or a wall is invalid.
    pub fn set_up_obstacles(&self, files: &Files) -> Result<WorldObstacles, SettingError> {
        let storeys = Storeys::new(&self.storeys)?;
        let mut all = Vec::new();
        for (i, config) in self.obstacles.iter().enumerate() {
            let obstacles = Obstacle::read_all(config.clone(), files);
            all.extend(obstacles.map_err(|error| error.within(format!("obstacles[{i}]")))?);
        }
        let mut walls = Vec::new();
        for (i, config) in self.walls.iter().enumerate() {
            let first = all.len();
            let name = config.name.clone().unwrap_or_else(|| format!("wall {i}"));
            let pieces = storeys.wall(&WallConfig { name: Some(name), ..config.clone() });
            let pieces = pieces.and_then(|wall| wall.obstacles(i));
            all.extend(pieces.map_err(|error| error.within(format!("walls[{i}]")))?);
            walls.push(first..all.len());
        }
        let slabs = storeys.slabs().map(|(storey, _)| storey).collect();
        all.extend(storeys.slabs().map(|(_, slab)| slab.clone()));
        Ok(WorldObstacles { obstacles: ObstacleField::new(all), walls, slabs, storeys })
    }
}

/// Builds each item of the list under `key`.
fn all<C, T>(
    key: &str,
    configs: &[C],
    build: impl Fn((usize, &C)) -> Result<T, SettingError>,
) -> Result<Vec<T>, SettingError> {
    if configs.len() > MOST {
        return Err(SettingError::new(key, format!("a list of {}", configs.len()), format!("at most {MOST}")));
    }
    let item = |(i, config)| build((i, config)).map_err(|error| error.within(format!("{key}[{i}]")));
    configs.iter().enumerate().map(item).collect()
}

/// Refuses a name that an earlier item of the list under `key` has.
fn unique<'a>(key: &str, names: impl Iterator<Item = &'a str>) -> Result<(), SettingError> {
    let names: Vec<&str> = names.collect();
    match layout::twin(names.iter().copied()) {
        Some((before, i)) => {
            let found = format!("`{}`, as {key}[{before}]", names[i]);
            Err(SettingError::new(format!("{key}[{i}].name"), found, "a unique name"))
        }
        None => Ok(()),
    }
}
