//! The antennas of a network of IEEE 802.11ad: those of its nodes, and those of its robots and sinks.

use std::f64::consts::TAU;
use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use sextant_channel::{
    Antenna, AntennaConfig, Db, Orientation, OrientationConfig, SectorAddress, SectorGains, SectorTable,
};
use sextant_kernel::{Files, Seed, SettingError, StationId};
use sextant_mac::dmg::{SectorLayout, TxSector};

use crate::air::{Holder, Mount};
use crate::purpose;
use crate::station::{Roll, StationKind};

/// Most tilts of the antennas of nodes.
const MOST_TILTS: usize = 256;

/// The antennas of a network with sector sweeps, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct AntennasConfig {
    /// The antenna of each node; if they are raised by several angles, by the first one.
    pub nodes: AntennaConfig,
    /// The antenna of each robot and each sink.
    pub robots: AntennaConfig,
    /// What the antennas of robots keep their directions in while the robots turn.
    #[serde(default)]
    pub robot_headings: RobotHeadingsConfig,
    /// How the antennas of robots are mounted: turned in the frame of the robot, whose x points ahead, or in the world if
    /// the robots have a compass. The log knows it. Sinks have theirs level.
    #[serde(default, skip_serializing_if = "is_level")]
    pub robot_mount: OrientationConfig,
    /// How the antennas of nodes are turned.
    #[serde(default)]
    pub node_headings: HeadingsConfig,
    /// Angles by which the antennas of nodes are raised (degrees): each node has one of them, at random, for all its
    /// sectors (Gunathillake 2018, chapter 5). Only antennas of the kind `sectors` can be raised.
    #[serde(default = "not_tilted", skip_serializing_if = "is_not_tilted")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [0.0])))]
    pub node_tilts_deg: Vec<f64>,
    /// Probability that an answer to a sweep of a steered antenna is lost because the antenna has moved on; 0 leaves only
    /// the losses of the link (Gunathillake 2018, chapter 4: 0.6).
    #[serde(default)]
    pub misalignment_loss: f64,
}

fn is_level(mount: &OrientationConfig) -> bool {
    *mount == OrientationConfig::default()
}

fn not_tilted() -> Vec<f64> {
    vec![0.0]
}

fn is_not_tilted(tilts_deg: &[f64]) -> bool {
    tilts_deg == not_tilted()
}

/// How the antennas of nodes are turned, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum HeadingsConfig {
    /// Each node by another angle about the vertical, which is unknown: nodes have no compass.
    #[default]
    Random,
    /// All alike: sector 0 points along x.
    Aligned,
}

/// What the antennas of robots keep their directions in, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RobotHeadingsConfig {
    /// The world: robots have a compass by which they turn their antennas back, as in the thesis.
    #[default]
    Compass,
    /// The robot: the antenna turns with it. The log has the robot's heading at each stop, by its odometry, and the map
    /// uses the gains of the antenna.
    Body,
}

impl AntennasConfig {
    /// The files that it names, with their keys.
    pub fn files_mut(&mut self) -> impl Iterator<Item = (String, &mut PathBuf)> {
        let Self { nodes, robots, .. } = self;
        let nodes = nodes.file_mut().map(|(key, file)| (format!("nodes.{key}"), file));
        let robots = robots.file_mut().map(|(key, file)| (format!("robots.{key}"), file));
        nodes.into_iter().chain(robots)
    }
}

/// The antennas of a network with sector sweeps.
#[derive(Clone, Debug)]
pub struct Antennas {
    /// The antenna of nodes at each tilt: at least one. All have the same sectors, in other directions.
    nodes: Vec<Arc<Antenna>>,
    /// The tilts (rad).
    tilts_rad: Vec<f64>,
    robots: Arc<Antenna>,
    /// The directions of the sectors of robots in what holds them, with their gains; none without sectors.
    robot_sectors: SectorTable,
    /// The sectors of one sweep of a node.
    node_layout: SectorLayout,
    /// The sectors of one sweep of a robot.
    robot_layout: SectorLayout,
    headings: HeadingsConfig,
    robot_holder: Holder,
    robot_mount: Orientation,
    misalignment_loss: f64,
}

impl Antennas {
    /// The antennas that `config` describes; its file paths are among `files`.
    ///
    /// # Errors
    /// If a value is invalid, a file has a flaw, or a sweep of a robot has more sectors than frames can name.
    pub fn read(config: &AntennasConfig, files: &Files) -> Result<Self, SettingError> {
        let antenna = |key: &str, config| -> Result<(Arc<Antenna>, SectorLayout), SettingError> {
            let antenna = Antenna::read(config, files).map_err(|error| error.within(key))?;
            let layout = layout(&antenna).map_err(|error| error.within(key))?;
            Ok((Arc::new(antenna), layout))
        };
        let (nodes, node_layout) = antenna("nodes", &config.nodes)?;
        if nodes.sweeps() > 1 {
            let found = "a steered antenna";
            return Err(SettingError::new("nodes.sectors.vertical", found, "\"array\": nodes answer with one sweep"));
        }
        let nodes = tilted(config, &nodes)?;
        let tilts_rad = config.node_tilts_deg.iter().map(|deg| deg.to_radians()).collect();
        let (robots, robot_layout) = antenna("robots", &config.robots)?;
        let misalignment_loss = SettingError::in_range("misalignment_loss", config.misalignment_loss, 0.0, 1.0)?;
        let mount = Orientation::try_from(config.robot_mount);
        let robot_mount = mount.map_err(|error| error.within("robot_mount"))?;
        let robot_sectors = if robots.is_omnidirectional() {
            SectorTable::default()
        } else {
            SectorTable::from(SectorGains::new(Arc::clone(&robots), robot_mount))
        };
        let robot_holder = match config.robot_headings {
            RobotHeadingsConfig::Compass => Holder::World,
            RobotHeadingsConfig::Body => Holder::Station,
        };
        Ok(Self {
            nodes,
            tilts_rad,
            robots,
            robot_sectors,
            node_layout,
            robot_layout,
            headings: config.node_headings,
            robot_holder,
            robot_mount,
            misalignment_loss,
        })
    }

    /// Whether the antennas of robots turn with them.
    #[must_use]
    pub fn turn_with_robots(&self) -> bool {
        self.robot_holder == Holder::Station
    }

    /// The sectors of one sweep of a node, by DMG antenna.
    pub(super) fn node_layout(&self) -> SectorLayout {
        self.node_layout
    }

    /// The sectors of one sweep of a robot or a sink, by DMG antenna.
    #[must_use]
    pub fn robot_layout(&self) -> SectorLayout {
        self.robot_layout
    }

    /// The antenna of each node.
    #[must_use]
    pub fn nodes(&self) -> &Antenna {
        &self.nodes[0]
    }

    /// The antenna of each robot and each sink.
    #[must_use]
    pub fn robots(&self) -> &Antenna {
        &self.robots
    }

    /// The directions of the sectors of a robot, in the world or, if its antenna turns with it, in its own frame, with the
    /// gains of its antenna: those of the pattern, because the ripple of single antennas is not known to anybody. All robots
    /// have the same antenna, mounted alike.
    #[must_use]
    pub fn robot_sectors(&self) -> &SectorTable {
        &self.robot_sectors
    }

    /// Gain of both antennas of a link together where the best sector points along it, in the weaker direction of a sweep: from
    /// a sector of the robot to a node that hears in all directions, or from a sector of the node to a robot that does. A
    /// node is heard only if both directions work.
    #[must_use]
    pub(crate) fn sweep_gain(&self) -> Db {
        let robots = self.robots.greatest_gain().0 + self.nodes().quasi_omni().0;
        Db(robots.min(self.greatest_gain_of_nodes() + self.robots.quasi_omni().0))
    }

    /// The heading of the antenna of each of `nodes` nodes, counterclockwise from x (rad).
    #[must_use]
    pub fn node_headings_rad(&self, seed: Seed, nodes: usize) -> Vec<f64> {
        (0..nodes).map(|node| self.heading_rad(seed, StationId::from_index(node))).collect()
    }

    fn heading_rad(&self, seed: Seed, node: StationId) -> f64 {
        match self.headings {
            HeadingsConfig::Random => TAU * seed.uniform(purpose::HEADING, [node.0.into(), 0, 0]),
            HeadingsConfig::Aligned => 0.0,
        }
    }

    /// The angle by which the antenna of each of `nodes` nodes is raised (rad).
    #[must_use]
    pub fn node_tilts_rad(&self, seed: Seed, nodes: usize) -> Vec<f64> {
        (0..nodes).map(|node| self.tilts_rad[self.tilt(seed, StationId::from_index(node))]).collect()
    }

    /// The antenna of each of `nodes` nodes, raised by its angle.
    #[must_use]
    pub fn node_antennas(&self, seed: Seed, nodes: usize) -> Vec<&Antenna> {
        (0..nodes).map(|node| &*self.nodes[self.tilt(seed, StationId::from_index(node))]).collect()
    }

    /// The number of the tilt of a node: each is equally likely.
    fn tilt(&self, seed: Seed, node: StationId) -> usize {
        if self.nodes.len() == 1 {
            return 0;
        }
        // The upper 32 bits scaled to the range.
        let bits = seed.bits(purpose::TILT, [node.0.into(), 0, 0]);
        usize::try_from(((bits >> 32) * self.nodes.len() as u64) >> 32).expect("below 2^32")
    }

    /// Probability that an answer to a sweep of a steered antenna is lost.
    pub(crate) fn misalignment_loss(&self) -> f64 {
        if self.robots.sweeps() > 1 { self.misalignment_loss } else { 0.0 }
    }

    /// Largest gain of both antennas of a link together.
    pub(crate) fn greatest_gain(&self) -> Db {
        Db(2.0 * self.greatest_gain_of_nodes().max(self.robots.greatest_gain().0))
    }

    fn greatest_gain_of_nodes(&self) -> f64 {
        self.nodes.iter().map(|antenna| antenna.greatest_gain().0).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The antenna of a kind of stations; if it is raised by several angles, by the first one.
    pub(crate) fn of(&self, kind: StationKind) -> &Arc<Antenna> {
        match kind {
            StationKind::Node(_) => &self.nodes[0],
            StationKind::Robot(_) | StationKind::Sink(_) => &self.robots,
        }
    }

    /// The antenna of a station as it is mounted.
    pub(crate) fn mount(&self, roll: &Roll, station: StationId, seed: Seed) -> Mount {
        let kind = roll.kind(station);
        let (antenna, orientation, holder) = match kind {
            StationKind::Node(_) => {
                let orientation = Orientation::heading(self.heading_rad(seed, station));
                (&self.nodes[self.tilt(seed, station)], orientation, Holder::World)
            }
            StationKind::Robot(_) => (&self.robots, self.robot_mount, self.robot_holder),
            StationKind::Sink(_) => (&self.robots, Orientation::LEVEL, Holder::World),
        };
        let antenna = Arc::clone(antenna);
        Mount { ripple: antenna.ripple(seed, station), antenna, orientation, holder }
    }
}

/// The antenna of nodes at each of its tilts; `level` is the one at none. The folder of files is not needed, because only
/// antennas without files can be raised.
///
/// # Errors
/// If there is no tilt, the antenna cannot be raised, or a ring of sectors would point beyond the vertical.
fn tilted(config: &AntennasConfig, level: &Arc<Antenna>) -> Result<Vec<Arc<Antenna>>, SettingError> {
    if config.node_tilts_deg.is_empty() || config.node_tilts_deg.len() > MOST_TILTS {
        let found = format!("a list of {}", config.node_tilts_deg.len());
        return Err(SettingError::new("node_tilts_deg", found, format!("1 to {MOST_TILTS} angles")));
    }
    let raised = |(i, &tilt_deg): (usize, &f64)| {
        let key = format!("node_tilts_deg[{i}]");
        SettingError::in_range(&key, tilt_deg, -180.0, 180.0)?;
        if tilt_deg == 0.0 {
            return Ok(Arc::clone(level));
        }
        let AntennaConfig::Sectors(sectors) = &config.nodes else {
            let allowed = "0: only an antenna of the kind `nodes.sectors` can be raised";
            return Err(SettingError::new(key, tilt_deg, allowed));
        };
        let mut sectors = sectors.clone();
        for elevation_deg in &mut sectors.elevations_deg {
            *elevation_deg += tilt_deg;
            if !(-90.0..=90.0).contains(elevation_deg) {
                let found = format!("{tilt_deg}, which raises a ring of sectors to {elevation_deg} degrees");
                return Err(SettingError::new(key, found, "elevations of -90 to 90 degrees"));
            }
        }
        let antenna = Antenna::try_from(AntennaConfig::Sectors(sectors)).map_err(|error| error.within("nodes"))?;
        Ok(Arc::new(antenna))
    };
    config.node_tilts_deg.iter().enumerate().map(raised).collect()
}

/// The sectors of one sweep of an antenna, by their identities on air.
///
/// # Errors
/// If there are more than frames can name.
fn layout(antenna: &Antenna) -> Result<SectorLayout, SettingError> {
    SectorLayout::of(antenna.sectors_of_sweep(0).map(|sector| {
        let SectorAddress { dmg_antenna, sector } = antenna.address(sector);
        TxSector { antenna: dmg_antenna, sector }
    }))
}
