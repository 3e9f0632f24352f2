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
    /// The address of its random draws, which is that of no other signal of its source. It is a function of its start,
    /// so that the draws do not depend on what others send.
    pub(crate) draw: u64,
    pub(crate) source: StationId,
    /// The receiver of the radio that sends it, which does not hear it. Another radio of the station does.
    pub(crate) sender: ReceiverId,
    /// Where its transmitter was at its start.
    pub(crate) position: Position,
    pub(crate) emission: Emission,
    pub(crate) start: SimTime,
    pub(crate) end: SimTime,
}

/// What is asked of a signal when it ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outline {
    pub(crate) packet: u64,
    pub(crate) draw: u64,
    pub(crate) source: StationId,
    pub(crate) sender: ReceiverId,
    pub(crate) start: SimTime,
    pub(crate) end: SimTime,
}

impl Signal {
    /// What is asked of it when it ends.
    pub(crate) const fn outline(&self) -> Outline {
        let &Self { packet, draw, source, sender, start, end, .. } = self;
        Outline { packet, draw, source, sender, start, end }
    }
}

impl Outline {
    /// The address of its draws at a receiver.
    #[inline]
    pub(super) fn draw_at(&self, receiver: ReceiverId) -> [u64; 3] {
        [self.draw, receiver.0.into(), self.source.0.into()]
    }
}
