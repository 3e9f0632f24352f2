//! What viewers draw while a recording plays. A mapper reads none of it.

use std::io::Write;
use std::time::Duration;

use sextant_channel::{Position, Stop};
use sextant_kernel::SimTime;

use super::super::drawing::playing;
use super::super::error::RecordingError;
use super::super::messages::CaptureMessage;
use super::Recorder;
use super::detail::Detail;
use crate::messages::names::{AIR_TOPIC, ApplicationTopics, WORLD_NAMES_TOPIC, WayTopics};

impl<W: Write> Recorder<W> {
    /// Writes the names of nodes beside their true places.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn world_names<'a>(
        &mut self,
        time: SimTime,
        named: impl Iterator<Item = (&'a str, Position)>,
    ) -> Result<(), RecordingError> {
        self.write(time, WORLD_NAMES_TOPIC, &playing::names(time, named))
    }

    /// Writes the way of `robot` so far, in the survey or in an `application` (m). It replaces the legs so far.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn way(
        &mut self,
        time: SimTime,
        application: Option<&str>,
        robot: &str,
        places: &[Position],
    ) -> Result<(), RecordingError> {
        let topics = WayTopics::new(application, robot);
        self.write(time, &topics.way, &playing::way(time, robot, places))?;
        self.write(time, &topics.legs, &playing::nothing(time))
    }

    /// Writes the leg `number` of the way of `robot`, in the survey or in an `application` (m).
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn leg(
        &mut self,
        time: SimTime,
        application: Option<&str>,
        robot: &str,
        number: usize,
        ends: [Position; 2],
    ) -> Result<(), RecordingError> {
        let topics = WayTopics::new(application, robot);
        self.write(time, &topics.legs, &playing::leg(time, robot, number, ends))
    }

    /// Writes a stop of `robot` as a point, and lines to the places of the `nodes` that it heard until `end` (m). If robots
    /// survey several networks, `network` says in which of them. A compact recording has no lines.
    ///
    /// # Errors
    /// If any write failed, now or before.
    ///
    /// # Panics
    /// If there are 2³² nodes.
    pub fn listening(
        &mut self,
        network: Option<&str>,
        robot: &str,
        stop: &Stop,
        end: SimTime,
        nodes: &[Position],
    ) -> Result<(), RecordingError> {
        let heard = u32::try_from(nodes.len()).expect("fewer than 2^32 nodes");
        if network.is_none() {
            let point = playing::stop(stop.time, stop.position, heard);
            self.write(stop.time, &format!("/robot/{robot}/stops"), &point)?;
        }
        if nodes.is_empty() || self.detail == Detail::Compact {
            return Ok(());
        }
        let span = end - stop.time;
        let lines = playing::heard(stop.time, network.unwrap_or(robot), stop.position, nodes, span);
        self.write(stop.time, &format!("/robot/{robot}/heard"), &lines)
    }

    /// Writes the place in the world where `station` of an application thinks that something is; `what` is `own_place` or
    /// `target_place`.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn estimated_place(
        &mut self,
        time: SimTime,
        application: &str,
        station: &str,
        what: &str,
        place: Position,
        error_m: Option<f64>,
    ) -> Result<(), RecordingError> {
        let topic = format!("{}{station}/{what}", ApplicationTopics::new(application).places);
        self.write(time, &topic, &playing::estimated(time, place, error_m))
    }

    /// Writes the mark of a captured target.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub(super) fn captured(&mut self, application: &str, capture: &CaptureMessage) -> Result<(), RecordingError> {
        let CaptureMessage { time_ns, robot, target, x_m, y_m, z_m } = capture;
        let (time, place) = (SimTime::from_nanos(*time_ns), Position::new(*x_m, *y_m, *z_m));
        let topic = ApplicationTopics::new(application).captured;
        self.write(time, &topic, &playing::capture(time, robot, target, place))
    }

    /// Writes frames that were sent within `span` from `time` on, as lines from their senders to their receivers (m), by their
    /// outcome: `received`, `collided`, `weak`.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn on_air(
        &mut self,
        time: SimTime,
        frames: &[(&str, Vec<[Position; 2]>)],
        span: Duration,
    ) -> Result<(), RecordingError> {
        self.write(time, AIR_TOPIC, &playing::on_air(time, frames, span))
    }
}
