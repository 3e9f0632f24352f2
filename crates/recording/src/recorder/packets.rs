//! The packet trace.

use std::io::Write;

use sextant_kernel::SimTime;

use super::super::error::RecordingError;
use super::super::messages::{
    AssessmentMessage, BatteryMessage, CellMessage, CheckMessage, HopMessage, PacketMessage, ParentChangeMessage,
    TransmissionMessage, TreeEdgeMessage,
};
use super::Recorder;
use crate::messages::names::{
    ASSESSMENTS_TOPIC, BATTERIES_TOPIC, CELLS_TOPIC, CHECKS_TOPIC, HOPS_TOPIC, PACKETS_TOPIC, PARENT_CHANGES_TOPIC,
    TRANSMISSIONS_TOPIC, TREE_TOPIC,
};

impl<W: Write> Recorder<W> {
    /// Writes a packet at the time of its end, with its assessments and transmissions. A chunk never ends within it.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn packet(
        &mut self,
        packet: &PacketMessage,
        assessments: &[AssessmentMessage],
        transmissions: &[TransmissionMessage],
    ) -> Result<(), RecordingError> {
        let time = SimTime::from_nanos(packet.ended_ns);
        self.append(time, PACKETS_TOPIC, packet)?;
        assessments.iter().try_for_each(|assessment| self.append(time, ASSESSMENTS_TOPIC, assessment))?;
        transmissions.iter().try_for_each(|transmission| self.append(time, TRANSMISSIONS_TOPIC, transmission))?;
        self.sink.settle()
    }

    /// Writes the hop that the packet written last is.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn hop(&mut self, ended_ns: u64, hop: &HopMessage) -> Result<(), RecordingError> {
        self.append(SimTime::from_nanos(ended_ns), HOPS_TOPIC, hop)
    }

    /// Writes the tree along which packets went, as it is at `end`.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn tree(&mut self, end: SimTime, edges: &[TreeEdgeMessage]) -> Result<(), RecordingError> {
        edges.iter().try_for_each(|edge| self.append(end, TREE_TOPIC, edge))
    }

    /// Writes the parents that nodes chose until `end`, in the order of time.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn parent_changes(&mut self, end: SimTime, changes: &[ParentChangeMessage]) -> Result<(), RecordingError> {
        changes.iter().try_for_each(|change| self.append(end, PARENT_CHANGES_TOPIC, change))
    }

    /// Writes a cell in the schedule of a station, as it is at `end`.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn cell(&mut self, end: SimTime, cell: &CellMessage) -> Result<(), RecordingError> {
        self.append(end, CELLS_TOPIC, cell)
    }

    /// Writes when a station checks the channel, as it did until `end`.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn check(&mut self, end: SimTime, check: &CheckMessage) -> Result<(), RecordingError> {
        self.append(end, CHECKS_TOPIC, check)
    }

    /// Writes the batteries of the nodes, as they are at `end`.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn batteries(&mut self, end: SimTime, batteries: &[BatteryMessage]) -> Result<(), RecordingError> {
        batteries.iter().try_for_each(|battery| self.append(end, BATTERIES_TOPIC, battery))
    }
}
