//! A signal on air.

use sextant_channel::{Dbm, Position};
use sextant_kernel::{SimTime, StationId};

use super::receiver_id::ReceiverId;

/// How an antenna points now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Aim {
    /// The same gain in all directions, which the transmit power includes.
    Omnidirectional,
    /// Along this sector of the antenna that is mounted at the receiver of the same radio.
    Sector(u8),
}

/// What a transmitter radiates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Emission {
    pub(crate) power: Dbm,
    pub(crate) aim: Aim,
}

/// A frame on air: `[start, end)`, in the band of its air.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Signal {
    pub(crate) packet: u64,
    pub(crate) source: StationId,
    /// The receiver of the radio that sends it, which does not hear it. Another radio of the station does.
    pub(crate) sender: ReceiverId,
    /// Where its transmitter was at its start.
    pub(crate) position: Position,
    pub(crate) emission: Emission,
    pub(crate) start: SimTime,
    pub(crate) end: SimTime,
}
