//! Who is in which network, and to whom nodes send.

use sextant_kernel::{NodeId, Seed, SettingError, StationId};
use sextant_mac::Phy;
use sextant_mac::coordinator::Coordinator;
use sextant_mac::frame::DataFrame;
use sextant_mac::superframe::BeaconEnabled;

use super::setup::BusyNetwork;
use crate::applications::robot::Robot;
use crate::applications::traffic::Traffic;
use crate::engine::NetworkSetup;
use crate::link::ieee802154::network::pan;
use crate::link::ieee802154::{self, Demand, Mac, Post};
use crate::service::network_id::NetworkId;
use crate::service::report::Destination;
use crate::station::{Roll, Sink};
use crate::world::World;

/// The stations of a simulation.
#[derive(Clone, Copy)]
pub(super) struct Stations<'a> {
    pub(super) world: &'a World,
    pub(super) robots: &'a [Robot],
    pub(super) sinks: &'a [Sink],
    pub(super) roll: Roll,
}

/// The superframes of a network with beacons, and its physical layer.
fn beacons(network: &BusyNetwork) -> Option<(&BeaconEnabled, Phy)> {
    let settings = network.link.technology.ieee802154()?;
    match &settings.mac {
        Mac::BeaconEnabled(beacons) => Some((beacons, settings.radio.phy())),
        Mac::CsmaUnslotted(_) => None,
    }
}

pub(super) fn too_many(networks: usize) -> SettingError {
    SettingError::new("networks", networks, "at most 256 networks")
}

impl Stations<'_> {
    /// Refuses frames that are too small for the addresses, and frames to one of several robots.
    pub(super) fn check_frames(&self, id: NetworkId, network: &BusyNetwork) -> Result<(), SettingError> {
        let last = StationId::from_index(self.roll.len().saturating_sub(1));
        for traffic in network.traffic.kinds().filter(|traffic| traffic.mpdu_octets() > 0) {
            let robots = self.robots_in(id).count();
            if traffic.is_acknowledged() && traffic.to().is_none() && robots > 1 {
                let allowed = format!(
                    "one robot with `{}`, or `to` there: nodes send to one robot, and the others do not hear them",
                    traffic.key()
                );
                return Err(SettingError::new("robots", format!("a list of {robots}"), allowed));
            }
            let pan = pan(id);
            let longest = if traffic.is_acknowledged() {
                DataFrame::unicast(pan, last, last)
            } else {
                DataFrame::broadcast(pan, last)
            };
            longest.filler(traffic.mpdu_octets()).map_err(|error| error.within(traffic.key()))?;
        }
        Ok(())
    }

    /// Refuses mobile anchors in networks whose robots send nothing.
    pub(super) fn check_mobile_anchors(&self, networks: &[BusyNetwork]) -> Result<(), SettingError> {
        for (i, robot) in self.robots.iter().enumerate().filter(|(_, robot)| robot.is_mobile_anchor()) {
            if robot.body.networks.iter().any(|id| beacons(&networks[id.index()]).is_some()) {
                let found = "anchor, in a network with superframes";
                let allowed = "another network: in one with `mac.beacon_enabled` robots send nothing but beacons";
                return Err(SettingError::new(format!("robots[{i}].role"), found, allowed));
            }
        }
        Ok(())
    }

    /// To whom a node sends.
    pub(super) fn destination(
        &self,
        id: NetworkId,
        traffic: &Traffic,
        node: NodeId,
    ) -> Result<Destination, SettingError> {
        if !traffic.is_acknowledged() {
            return Ok(Destination::All);
        }
        let collectors = || self.collectors(id);
        if let Some(name) = traffic.to() {
            let found = collectors().find(|(other, _)| *other == name);
            let (_, station) = found.ok_or_else(|| {
                let known: Vec<_> = collectors().map(|(name, _)| format!("`{name}`")).collect();
                let allowed = format!("the name of a robot or sink in the network: {}", known.join(", "));
                SettingError::new(format!("{}.to", traffic.key()), format!("`{name}`"), allowed)
            })?;
            return Ok(Destination::Station(station));
        }
        if let Some(robot) = self.robots_in(id).next() {
            return Ok(Destination::Station(self.roll.robot(robot)));
        }
        let place = self.world.nodes[node.index()].position;
        let distance_m = |&sink: &usize| place.distance_m(self.sinks[sink].position);
        let nearest = (0..self.roll.sinks)
            .filter(|&sink| self.sinks[sink].is_in(id))
            .min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
        let nearest = nearest.ok_or_else(|| {
            let found = "true, without a robot or sink in the network";
            let allowed = "false, or a robot or a sink that acknowledges";
            SettingError::new(format!("{}.acknowledged", traffic.key()), found, allowed)
        })?;
        Ok(Destination::Station(StationId::from_index(self.roll.nodes + self.roll.robots + nearest)))
    }

    /// The numbers of the robots that survey a network.
    fn robots_in(&self, id: NetworkId) -> impl Iterator<Item = usize> {
        self.robots
            .iter()
            .enumerate()
            .filter(move |(_, robot)| robot.is_surveying() && robot.body.networks.contains(&id))
            .map(|(robot, _)| robot)
    }

    /// Name and station of each robot that surveys a network, and of each sink in it.
    fn collectors(&self, id: NetworkId) -> impl Iterator<Item = (&str, StationId)> {
        let is_in = move |robot: &Robot| robot.is_surveying() && robot.body.networks.contains(&id);
        let robots = self.robots.iter().map(move |robot| (&*robot.body.name, is_in(robot)));
        let sinks = self.sinks.iter().map(move |sink| (&*sink.name, sink.is_in(id)));
        let nodes = self.roll.nodes;
        robots
            .chain(sinks)
            .enumerate()
            .filter(|(_, (_, is_member))| *is_member)
            .map(move |(i, (name, _))| (name, StationId::from_index(nodes + i)))
    }

    /// The links of network number `number`, with its members.
    pub(super) fn joined(&self, number: usize, network: BusyNetwork) -> NetworkSetup {
        let is_all = network.nodes.is_none()
            && self.robots.iter().all(|robot| robot.body.networks.iter().any(|id| id.index() == number))
            && self.sinks.iter().all(|sink| sink.networks.is_none());
        if is_all {
            return network.link;
        }
        let in_number = |id: NetworkId| id.index() == number;
        let nodes = network.nodes.unwrap_or_else(|| vec![true; self.roll.nodes]);
        let robots = self.robots.iter().map(|robot| robot.body.networks.iter().any(|&id| in_number(id)));
        let is_in = |sink: &Sink| sink.networks.as_ref().is_none_or(|ids| ids.iter().any(|&id| in_number(id)));
        let sinks = self.sinks.iter().map(is_in);
        NetworkSetup { members: Some(nodes.into_iter().chain(robots).chain(sinks).collect()), ..network.link }
    }

    /// The coordinator of a network with beacons: the first robot, or the first sink if there is no robot.
    pub(super) fn coordinator(
        &self,
        networks: &[BusyNetwork],
        seed: Seed,
    ) -> Result<Option<(StationId, Coordinator)>, SettingError> {
        if let Some(other) = networks.iter().skip(1).find(|network| beacons(network).is_some()) {
            let name = other.name.as_deref().unwrap_or_default();
            let allowed = "beacons in the first network only";
            return Err(SettingError::new(format!("networks.{name}.mac"), "beacon_enabled", allowed));
        }
        let Some(network) = networks.first() else { return Ok(None) };
        let Some((settings, phy)) = beacons(network) else { return Ok(None) };
        if self.roll.robots + self.roll.sinks == 0 {
            return Ok(None);
        }
        let id = NetworkId::default();
        let robot = self.robots_in(id).next();
        let sink = || (0..self.roll.sinks).find(|&sink| self.sinks[sink].is_in(id));
        let station = robot.or_else(|| sink().map(|sink| self.roll.robots + sink)).ok_or_else(|| {
            let name = network.name.as_deref().unwrap_or_default();
            let allowed = "a robot or a sink in the network, to send the beacons";
            SettingError::new(format!("networks.{name}.mac"), "beacon_enabled, without a robot or sink", allowed)
        })?;
        let listen = robot.map(|robot| (robot, self.robots[robot].body.listen));
        let post = Post { station: StationId::from_index(self.roll.nodes + station), listen };
        let demand = |traffic: &Traffic| Demand {
            key: traffic.key().to_owned(),
            mpdu_octets: traffic.mpdu_octets(),
            acknowledged: traffic.is_acknowledged(),
        };
        let demands: Vec<_> =
            network.traffic.kinds().filter(|traffic| traffic.mpdu_octets() > 0).map(demand).collect();
        let names = self.world.nodes.iter().map(|node| &*node.name);
        let machine = ieee802154::coordinator(settings, phy, (NetworkId::default(), seed), post, names, &demands)?;
        Ok(Some((post.station, machine)))
    }
}
