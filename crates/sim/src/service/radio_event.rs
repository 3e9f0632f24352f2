//! What the radio of a station says to the program that commands it.

use sextant_channel::Db;
use sextant_channel::{Dbm, Milliwatts};
use sextant_kernel::{SimTime, StationId};
use sextant_mac::oqpsk::link_quality;

use super::delivery::Delivery;
use super::network_id::NetworkId;
use super::report::Destination;

/// What the radio of a station says to the program that commands it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RadioEvent<'a> {
    /// The radio is where it was sent: awake, or with its receiver on, as its program or a window wants it.
    Ready,
    /// A look at the channel is over.
    Assessed {
        /// Whether the mean power was at or above the threshold, or the radio sent something itself meanwhile.
        busy: bool,
        /// Mean power of the signals of others, and noise.
        power: Dbm,
    },
    /// The start-of-frame delimiter of a frame has just ended: the receiver is locked on to it.
    Began {
        /// First symbol of its preamble.
        start: SimTime,
    },
    /// A frame was received, for this station or for all; for others too if the program wants to hear all.
    Received(ReceivedFrame<'a>),
    /// A frame that [began](Self::Began) has ended, and its check sequence is wrong.
    Garbled {
        /// First symbol of its preamble.
        start: SimTime,
    },
    /// A frame that [began](Self::Began) has ended, and is for another station, or an acknowledgement for one.
    Ignored {
        /// First symbol of its preamble.
        start: SimTime,
    },
    /// A window to receive is over.
    WindowOver,
    /// A frame is out; if it asks for an acknowledgement, [`Acknowledged`](Self::Acknowledged) or
    /// [`Unacknowledged`](Self::Unacknowledged) follows.
    Sent {
        /// First symbol of its preamble.
        start: SimTime,
    },
    /// The acknowledgement of the frame came.
    Acknowledged {
        /// Its power.
        rssi: Dbm,
    },
    /// No acknowledgement of the frame came in time.
    Unacknowledged,
}

/// A frame that a radio has received.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReceivedFrame<'a> {
    /// Sender, payload and power.
    pub delivery: Delivery<'a>,
    /// For whom it is.
    pub to: Destination,
    /// First symbol of its preamble.
    pub start: SimTime,
    /// Its end.
    pub end: SimTime,
    /// Quality of the link, 0 to 255, by the least ratio of signal to interference and noise: see
    /// [`link_quality`].
    pub lqi: u8,
    /// Whether the radio acknowledges it by itself.
    pub acknowledged: bool,
}

/// The same as an event, whose payload is elsewhere.
#[derive(Clone, Copy, Debug)]
pub(crate) enum RadioNews {
    Ready,
    Assessed { busy: bool, power: Dbm },
    Began { start: SimTime },
    Received(ReceivedNews),
    Garbled { start: SimTime },
    Ignored { start: SimTime },
    WindowOver,
    Sent { start: SimTime },
    Acknowledged { rssi: Dbm },
    Unacknowledged,
}

/// A frame that was received, without its payload.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReceivedNews {
    pub(crate) from: StationId,
    pub(crate) to: Destination,
    pub(crate) sequence: u8,
    pub(crate) start: SimTime,
    pub(crate) end: SimTime,
    pub(crate) power: Milliwatts,
    /// Least ratio of signal to interference and noise, as a factor.
    pub(crate) sinr: f64,
    pub(crate) acknowledged: bool,
}

impl RadioNews {
    /// The event, with the payload of the frame that has just ended.
    pub(crate) fn event(self, network: NetworkId, payload: &[u8]) -> RadioEvent<'_> {
        match self {
            Self::Ready => RadioEvent::Ready,
            Self::Assessed { busy, power } => RadioEvent::Assessed { busy, power },
            Self::Began { start } => RadioEvent::Began { start },
            Self::Received(news) => RadioEvent::Received(news.frame(network, payload)),
            Self::Garbled { start } => RadioEvent::Garbled { start },
            Self::Ignored { start } => RadioEvent::Ignored { start },
            Self::WindowOver => RadioEvent::WindowOver,
            Self::Sent { start } => RadioEvent::Sent { start },
            Self::Acknowledged { rssi } => RadioEvent::Acknowledged { rssi },
            Self::Unacknowledged => RadioEvent::Unacknowledged,
        }
    }
}

impl ReceivedNews {
    fn frame(self, network: NetworkId, payload: &[u8]) -> ReceivedFrame<'_> {
        let Self { from, to, sequence, start, end, power, sinr, acknowledged } = self;
        let delivery = Delivery { network, from, sequence, payload, rssi: power.to_dbm(), sector: None, snr: None };
        let lqi = link_quality(Db(10.0 * libm::log10(sinr)));
        ReceivedFrame { delivery, to, start, end, lqi, acknowledged }
    }
}
