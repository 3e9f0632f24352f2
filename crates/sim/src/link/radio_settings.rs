//! What the simulator asks of the radios of a network.

use std::time::Duration;

use sextant_channel::{Dbm, FadingBand};
use sextant_kernel::{NodeId, Seed, SettingError, StationId};

use super::capture::FrameFormat;
use super::clock::Clock;
use crate::air::ReceptionRules;
use crate::service::network_id::NetworkId;
use crate::world::interferer::Interferer;

/// A frame of a network that a station wants to send.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameSize {
    pub(crate) network: NetworkId,
    pub(crate) from: StationId,
    /// The whole frame (octets).
    pub(crate) mpdu_octets: u8,
    /// Whether it goes to one station, which acknowledges it.
    pub(crate) acknowledged: bool,
}

/// What the simulator asks of the radios of a network. What has a default is right for radios that are all alike.
pub(crate) trait RadioSettings {
    /// Transmit power, without antennas.
    fn tx_power(&self) -> Dbm;

    /// The greatest transmit power of any station, without antennas.
    fn greatest_tx_power(&self) -> Dbm {
        self.tx_power()
    }

    /// Transmit power of a node, without antennas.
    fn tx_power_of(&self, _node: NodeId) -> Dbm {
        self.tx_power()
    }

    /// Power of a signal from which on a station finds the channel busy: that of a node, or of robots and sinks.
    fn busy_from(&self, node: Option<NodeId>) -> Dbm;

    /// Minimum power of a frame that can be received.
    fn sensitivity(&self) -> Dbm;

    /// Least noise in the bandwidth of the receivers.
    fn noise_floor(&self) -> Dbm;

    /// Where links fade on its radio channel `channel`: the same frequency for all of its band, and that of the channel.
    fn fading_band(&self, channel: u8) -> FadingBand;

    /// The rules of its receivers.
    fn reception_rules(&self) -> Vec<ReceptionRules>;

    /// Number of the rules of a node's receiver among the [`reception_rules`](Self::reception_rules); those of robots and
    /// sinks are the first ones.
    fn rule_of(&self, _node: NodeId) -> u16 {
        0
    }

    /// Power of an interferer in a channel, if there is any.
    fn power_of(&self, _interferer: &Interferer, _channel: u8) -> Option<Dbm> {
        None
    }

    /// The clock of a node.
    fn clock(&self, _seed: Seed, _network: NetworkId, _node: NodeId) -> Clock {
        Clock::default()
    }

    /// How its frames are written into a capture.
    fn frame_format(&self) -> FrameFormat;

    /// Size of the frame to all that carries a payload of this size (octets).
    fn frame_octets(&self, payload_octets: u16) -> u16;

    /// Time on air of a frame of this size (octets); `None` if no frame is so long.
    fn airtime(&self, frame_octets: u16) -> Option<Duration>;

    /// Refuses settings that do not fit together.
    ///
    /// # Errors
    /// With a key below the network.
    fn check(&self) -> Result<(), SettingError>;

    /// Refuses frames without room for the addresses.
    ///
    /// # Errors
    /// With the key `mpdu_octets`.
    fn check_frame(&self, _frame: FrameSize) -> Result<(), SettingError> {
        Ok(())
    }
}
