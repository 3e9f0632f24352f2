//! What a sweep is for, when it starts, and what an initiator tells its station at its end.

use crate::dmg::address::MacAddress;
use crate::dmg::sector::SectorLayout;

/// What a sweep is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SweepPurpose {
    /// All stations that hear it answer.
    Gather,
    /// One station answers, which has these sectors: the full procedure with SSW-Feedback and SSW-ACK.
    Train {
        /// The station.
        responder: MacAddress,
        /// Its sectors.
        layout: SectorLayout,
    },
    /// The station announces itself; there are no answers.
    Announce,
    /// All stations get a payload, in a DMG Beacon frame from each sector; no one answers.
    Broadcast {
        /// Number of the payload, modulo 256.
        sequence: u8,
        /// Size of the payload (octets), at most [`MAX_BEACON_PAYLOAD_OCTETS`](crate::dmg::MAX_BEACON_PAYLOAD_OCTETS).
        payload_octets: u16,
    },
}

/// When a sweep starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// At once, whatever the channel.
    AtOnce,
    /// By carrier sense and backoff.
    Contend,
}

/// How a sweep ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InitiatorOutcome {
    /// The window for answers is over; of a sweep that no one answers, its last frame.
    Over,
    /// The named station answered, and acknowledged the feedback.
    Trained,
    /// The named station did not answer any of the sweeps.
    NoAnswer,
    /// The named station answered, but never acknowledged the feedback.
    NoAck,
}

/// The end of a sweep. [`Initiator::answers`](crate::dmg::Initiator::answers) has the answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InitiatorReport {
    /// What it was for.
    pub purpose: SweepPurpose,
    /// How it ended.
    pub outcome: InitiatorOutcome,
    /// Frames sent in the sweep, without feedback.
    pub frames: u32,
    /// Reports of all sectors that stations were asked for.
    pub asked: u32,
    /// Those of them that were decoded.
    pub reported: u32,
}
