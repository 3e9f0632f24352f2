//! What an application may know without frames: for studies of laws apart from channel access.

use sextant_kernel::NodeId;

use super::Port;
use crate::service::ideal::{IdealReception, SectorPowers};
use crate::service::network_id::NetworkId;
use crate::service::sensed::FieldId;

impl Port<'_> {
    /// What the station would receive if each node of a network sent it a frame now with ideal channel access: at once,
    /// without contention, collisions or interference, and without time on air or energy. By node.
    ///
    /// The powers are those of frames that begin now: the same links, shadowing and antennas. A node with sectors uses
    /// the one that gives the greatest power. A node is left out if its power is below the least at which a frame is
    /// received, or if it is beyond the radius of communication, not in the network, or dead. The share of messages that
    /// faults, bursts of loss or measured links lose does not matter. Nobody notices anything, and nothing is counted.
    ///
    /// The time is proportional to the number of nodes in the world.
    ///
    /// # Panics
    /// If there is no such network.
    #[must_use]
    pub fn ideal_receptions(&mut self, network: NetworkId) -> Vec<IdealReception> {
        let (links, scene) = (&self.model.networks[network.index()], &mut self.model.scene);
        let Some(receiver) = links.transmitter(self.station) else { return Vec::new() };
        let receive = |node: NodeId| {
            let transmitter = links.transmitter(node.into())?;
            let rssi = transmitter.power_at(receiver.radio, scene)?;
            Some(IdealReception { node, tx_power: transmitter.tx_power, rssi })
        };
        let nodes = (0..self.model.world.nodes.len()).map(NodeId::from_index);
        nodes.filter(|&node| self.station != node.into()).filter_map(receive).collect()
    }

    /// The powers of frames from the station to a node that begin now, with each sector of the two: those that sweeps meet, with
    /// shadowing, reflections, fading and bodies in the way. `None` if one of the two is not in the network or dead, if they
    /// are beyond the radius of communication, or if an antenna has no sectors. Nobody notices anything.
    ///
    /// The time is proportional to the product of the numbers of sectors.
    ///
    /// # Panics
    /// If there is no such network.
    #[must_use]
    pub fn sector_powers(&mut self, network: NetworkId, node: NodeId) -> Option<SectorPowers> {
        let (links, scene) = (&self.model.networks[network.index()], &mut self.model.scene);
        let (own, peer) = (links.transmitter(self.station)?, links.transmitter(node.into())?);
        own.sector_powers(&peer, scene)
    }

    /// The latest sample of a field that a node has taken, with its offset and its noise, in the unit of the field. `None`
    /// before the first one, and of a node whose application does not look at its sensors.
    #[must_use]
    pub fn latest_sample(&self, node: NodeId, field: FieldId) -> Option<f64> {
        self.model.sensing.latest(node, field)
    }
}
