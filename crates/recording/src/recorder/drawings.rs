//! What viewers and figures draw: places, paths, shapes, maps and surfaces.

use std::io::Write;

use sextant_channel::Position;
use sextant_kernel::SimTime;

use super::super::drawing::{self, GridPlane, PlacedNode, Solid};
use super::super::error::RecordingError;
use super::Recorder;
use crate::messages::names::{WORLD_NODES_TOPIC, WORLD_SINKS_TOPIC};

impl<W: Write> Recorder<W> {
    /// Writes the position of `robot` and its heading (rad, counterclockwise from x).
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn robot(
        &mut self,
        time: SimTime,
        robot: &str,
        position: Position,
        heading_rad: f64,
    ) -> Result<(), RecordingError> {
        self.write(time, "/tf", &drawing::transform(time, robot, position, heading_rad))
    }

    /// Writes where `robot` believes to be by its odometry, and its believed heading (rad, counterclockwise from x).
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn odometry(
        &mut self,
        time: SimTime,
        robot: &str,
        position: Position,
        heading_rad: f64,
    ) -> Result<(), RecordingError> {
        let topic = format!("/robot/{robot}/odometry");
        self.write(time, &topic, &drawing::pose_in_world(time, position, heading_rad))
    }

    /// Writes the path of `robot` from its start to now (m).
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn path(&mut self, time: SimTime, robot: &str, places: &[Position]) -> Result<(), RecordingError> {
        self.write(time, &format!("/robot/{robot}/path"), &drawing::path(time, places))
    }

    /// Writes the obstacles of the world.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn obstacles(&mut self, time: SimTime, solids: &[Solid]) -> Result<(), RecordingError> {
        self.write(time, "/world/obstacles", &drawing::scene(time, solids))
    }

    /// Writes the true positions of the nodes, for viewers and metrics but never for a mapper.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn world_nodes(&mut self, time: SimTime, nodes: &[PlacedNode]) -> Result<(), RecordingError> {
        self.write(time, WORLD_NODES_TOPIC, &drawing::cloud(time, nodes))
    }

    /// Writes the positions of the sinks, by number, for viewers.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn world_sinks(&mut self, time: SimTime, sinks: &[PlacedNode]) -> Result<(), RecordingError> {
        self.write(time, WORLD_SINKS_TOPIC, &drawing::cloud(time, sinks))
    }

    /// Writes the map by `algorithm`; nodes without a position are absent.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn map(&mut self, time: SimTime, algorithm: &str, nodes: &[PlacedNode]) -> Result<(), RecordingError> {
        self.write(time, &format!("/map/{algorithm}"), &drawing::cloud(time, nodes))
    }

    /// Writes the likelihood of `node` by `algorithm`.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn likelihood(
        &mut self,
        time: SimTime,
        algorithm: &str,
        node: &str,
        plane: &GridPlane,
    ) -> Result<(), RecordingError> {
        self.write(time, &format!("/likelihood/{algorithm}/{node}"), &drawing::grid(time, plane, "log_likelihood"))
    }
}
