//! What a node has found, and what it took.

use sextant_channel::Position;
use sextant_mapper::{Estimate, RingOrientation};
use sextant_sim::sum_fields;

use super::filtration::{Category, Scattering};
use super::message::Message;

/// The part that a node plays in a map which the nodes compute themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MappingRole {
    /// It knows its place.
    InitialAnchor,
    /// It has become an anchor.
    NewAnchor {
        /// In this iteration.
        iteration: u32,
    },
    /// It is no anchor.
    #[default]
    Node,
}

/// What a node has found, and what it took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MappingRecord {
    /// Its part.
    pub role: MappingRole,
    /// Where it believes to be (m); `None` if it could not be placed.
    pub place: Option<Position>,
    /// How it came to that; `None` for an initial anchor.
    pub estimate: Option<Estimate>,
    /// The directions of its sectors, if it is an anchor that others have heard.
    pub directions: Option<RingOrientation>,
    /// The last comparison with its neighbours.
    pub scattering: Scattering,
    /// What became of that.
    pub category: Category,
    /// Conditions that its place breaks: it lies outside the range or the sector of so many anchors that it heard.
    pub violations: usize,
    /// Anchors heard that stand still.
    pub anchors_heard: usize,
    /// Places from which mobile anchors were heard.
    pub mobile_stops_heard: usize,
    /// Whether it was an initial anchor and has given up its place, because the bearings to other anchors contradict it.
    pub gave_up: bool,
    /// The last iteration in which its place or its part has changed.
    pub last_change: u32,
    /// Messages that it sent at least once.
    pub messages: MessageCounts,
    /// Frames with messages that were sent, repeats included.
    pub sent: u64,
    /// Frames with messages that the link did not take, or gave up because the channel was busy.
    pub unsent: u64,
    /// Frames received, one for each sector heard.
    pub frames_received: u64,
    /// Frames received that are no such message.
    pub frames_unread: u64,
    /// Grid vertices whose likelihood was computed.
    pub vertices: u64,
    /// Memory of the largest grid (octets).
    pub grid_octets: usize,
    /// Memory of the tables of neighbours at the end (octets).
    pub table_octets: usize,
}

/// Numbers of messages by kind, and their size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MessageCounts {
    /// PLACE.
    pub place: u64,
    /// REPORT.
    pub report: u64,
    /// BEACON.
    pub beacon: u64,
    /// COORDINATES.
    pub coordinates: u64,
    /// Octets of all of them.
    pub octets: u64,
}

impl MessageCounts {
    /// One message of this size.
    pub(super) fn of(message: &Message, octets: usize) -> Self {
        let mut one = Self { octets: octets as u64, ..Self::default() };
        *match message {
            Message::Place(_) => &mut one.place,
            Message::Report(..) => &mut one.report,
            Message::Beacon(_) => &mut one.beacon,
            Message::Coordinates { .. } => &mut one.coordinates,
        } = 1;
        one
    }

    /// Messages of all kinds.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.place + self.report + self.beacon + self.coordinates
    }
}

sum_fields!(MessageCounts { place, report, beacon, coordinates, octets });
