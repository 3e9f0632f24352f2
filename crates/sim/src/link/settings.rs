//! What the simulator asks of the settings of a technology, before anything is sent.

use std::time::Duration;

use sextant_channel::Db;
use sextant_kernel::{SettingError, StationId};
use sextant_mac::RadioStates;
use sextant_mac::coordinator::Coordinator;

use super::antennas::Antennas;
use super::coordinator::Coordination;
use super::radio_settings::{FrameSize, RadioSettings};
use crate::service::network_id::NetworkId;
use crate::station::Sink;
use crate::world::layout::PlacedNode;

/// Where the links of a network are: what a technology gets when they are set up.
#[derive(Clone)]
pub(crate) struct Placement {
    pub(crate) network: NetworkId,
    /// Whether there is no other network.
    pub(crate) is_only: bool,
    /// Energy model of the radios.
    pub(crate) radio_states: RadioStates,
    /// Number of the air of its band.
    pub(crate) air: usize,
    /// Number of the first station's receiver there.
    pub(crate) first_receiver: u32,
    /// The same for the other parts of the spectrum that its radios may change to.
    pub(crate) further: Vec<Berth>,
    /// Whether each station is in the network; `None` if all are.
    pub(crate) members: Option<Vec<bool>>,
    /// Whether the application of each station looks at what is delivered to it.
    pub(crate) hears: Vec<bool>,
    /// The station that sends beacons, if one does, and its state machine.
    pub(crate) coordinator: Option<(StationId, Coordinator)>,
}

/// Where the receivers of a network are in an air.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Berth {
    /// Number of the air.
    pub(crate) air: usize,
    /// Number of the first station's receiver there.
    pub(crate) first_receiver: u32,
}

/// A part of the radio spectrum: networks that share it disturb each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Spectrum {
    /// The name of the band.
    pub(crate) band: &'static str,
    /// Number of the channel in the band.
    pub(crate) channel: u8,
}

/// The stations of a network, for settings that name them.
#[derive(Clone, Debug)]
pub(crate) struct KnownStations<'a> {
    pub(crate) nodes: &'a [PlacedNode],
    /// Whether each robot is in the network.
    pub(crate) robots: Vec<bool>,
    /// Those that are not in the network have no name there.
    pub(crate) sinks: &'a [Sink],
    pub(crate) network: NetworkId,
}

impl KnownStations<'_> {
    /// Number of stations, in the network or not.
    pub(crate) fn count(&self) -> usize {
        self.first_sink() + self.sinks.len()
    }

    /// Number of the first sink.
    pub(crate) fn first_sink(&self) -> usize {
        self.nodes.len() + self.robots.len()
    }

    /// Whether a robot is in the network.
    pub(crate) fn has_robots(&self) -> bool {
        self.robots.contains(&true)
    }

    /// The names of nodes and of the sinks in the network.
    pub(crate) fn names(&self) -> impl Iterator<Item = (&str, StationId)> {
        let nodes = self.nodes.iter().enumerate().map(|(i, node)| (node.name.as_str(), StationId::from_index(i)));
        let first = self.first_sink();
        let sinks = self.sinks.iter().enumerate().filter(|(_, sink)| sink.is_in(self.network));
        nodes.chain(sinks.map(move |(i, sink)| (sink.name.as_str(), StationId::from_index(first + i))))
    }

    /// The sink in the network that is nearest to a node; `None` if there is no sink, or the station is no node.
    pub(crate) fn nearest_sink(&self, station: StationId) -> Option<StationId> {
        let place = self.nodes.get(station.index())?.position;
        let distance_m = |&sink: &usize| place.distance_m(self.sinks[sink].position);
        let sinks = (0..self.sinks.len()).filter(|&sink| self.sinks[sink].is_in(self.network));
        let nearest = sinks.min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)))?;
        Some(StationId::from_index(self.first_sink() + nearest))
    }
}

/// What the simulator asks of the settings of a technology. What has a default is right for omnidirectional antennas
/// without a schedule.
pub(crate) trait LinkSettings {
    /// The radios of its stations.
    fn radio(&self) -> &dyn RadioSettings;

    /// The part of the spectrum that it uses.
    fn spectrum(&self) -> Spectrum;

    /// The other parts of the spectrum that its radios may change to.
    fn further_spectra(&self) -> Vec<Spectrum> {
        Vec::new()
    }

    /// Whether links ask what a radio hears only when a frame has ended, or by carrier sense.
    fn asks_at_ends(&self) -> bool {
        false
    }

    /// Whether stations may change their transmit power, up to that of the settings.
    fn powers_vary(&self) -> bool {
        false
    }

    /// Whether networks may share a part of the spectrum; if not, why they do not: what the network has.
    fn unshared(&self) -> Option<&'static str> {
        None
    }

    /// How far back carrier sense looks; zero if radios say when the carrier changes.
    fn carrier_sense(&self) -> Duration {
        Duration::ZERO
    }

    /// Whether receivers listen for the links themselves, whatever the applications hear.
    fn always_receives(&self) -> bool {
        false
    }

    /// Refuses settings that do not fit together.
    ///
    /// # Errors
    /// With a key below the network.
    fn check(&self) -> Result<(), SettingError> {
        self.radio().check()
    }

    /// Refuses frames without room for the addresses.
    ///
    /// # Errors
    /// With the key `mpdu_octets`.
    fn check_frame(&self, frame: FrameSize) -> Result<(), SettingError> {
        self.radio().check_frame(frame)
    }

    /// The antennas; `None` if all are omnidirectional.
    fn antennas(&self) -> Option<&Antennas> {
        None
    }

    /// Along which tree packets go, if that is known before the start.
    fn know_tree(&mut self, _tree: &KnownTree) {}

    /// Resolves what names stations.
    ///
    /// # Errors
    /// If a station is not there, or one that is there cannot take part. The key is below the network.
    fn know_stations(&mut self, _stations: &KnownStations<'_>) -> Result<(), SettingError> {
        Ok(())
    }

    /// Whether nodes wait for the beacons of a coordinator, and all other stations send nothing else.
    fn has_coordinator(&self) -> bool {
        false
    }

    /// The state machine of the station that sends beacons.
    ///
    /// # Errors
    /// If the schedule does not fit the stations and their traffic.
    fn coordinator(&self, _coordination: &Coordination<'_>) -> Result<Option<Coordinator>, SettingError> {
        Ok(None)
    }

    /// The settings before any robot or sink is there: receivers always on, no coordinator.
    fn listen_always(&mut self) {}

    /// Gain of both antennas of a link together where the best sector points along it, in the weaker direction.
    fn link_gain(&self) -> Db {
        self.antennas().map_or(Db(0.0), Antennas::sweep_gain)
    }

    /// Largest gain of both antennas of a link together.
    fn greatest_gain(&self) -> Db {
        self.antennas().map_or(Db(0.0), Antennas::greatest_gain)
    }
}

/// The tree along which packets go, if it is known before the start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KnownTree {
    /// The next station of each; `None` if it has none.
    pub parents: Vec<Option<StationId>>,
    /// Which ways packets go along it.
    pub traffic: TreeTraffic,
}

/// Which ways packets go along a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TreeTraffic {
    /// To its roots alone.
    Up,
    /// To its roots, and from there to nodes.
    UpAndDown,
}
