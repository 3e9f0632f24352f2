//! Targets, fields, and what sensors said.

use std::io::Write;

use sextant_channel::Position;
use sextant_kernel::{NodeId, SimTime};

use super::super::drawing::{self, GridPlane};
use super::super::error::RecordingError;
use super::super::messages::{SensedMessage, SensorsMessage};
use super::Recorder;
use crate::messages::names::{FIELDS_TOPICS, SENSED_TOPIC, SENSORS_TOPIC, TARGETS_TOPICS};
use crate::messages::sensation::Sensation;

impl<W: Write> Recorder<W> {
    /// Writes which sensors the nodes have.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn sensors(&mut self, sensors: &SensorsMessage) -> Result<(), RecordingError> {
        self.write(SimTime::ZERO, SENSORS_TOPIC, sensors)
    }

    /// Writes what a sensor of `node` said of the target or field called `name`.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn sensed(
        &mut self,
        time: SimTime,
        node: NodeId,
        name: &str,
        sensation: Sensation,
    ) -> Result<(), RecordingError> {
        let message = SensedMessage {
            time_ns: time.as_nanos(),
            node: node.0,
            what: sensation.word().to_owned(),
            name: name.to_owned(),
            value: sensation.value(),
        };
        self.write(time, SENSED_TOPIC, &message)
    }

    /// Writes the position of the target called `name`.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn target(&mut self, time: SimTime, name: &str, position: Position) -> Result<(), RecordingError> {
        self.write(time, &format!("{TARGETS_TOPICS}{name}"), &drawing::transform(time, name, position, 0.0))
    }

    /// Writes the field called `name` as it was at `time`.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn field(&mut self, time: SimTime, name: &str, plane: &GridPlane) -> Result<(), RecordingError> {
        self.write(time, &format!("{FIELDS_TOPICS}{name}"), &drawing::grid(time, plane, "value"))
    }
}
