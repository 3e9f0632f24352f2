//! Who is in which network, and to whom nodes send.

use sextant_channel::Position;
use sextant_kernel::{NodeId, SettingError, StationId};
use sextant_mac::coordinator::Coordinator;

use crate::applications::robot::Robot;
use crate::applications::traffic::Traffic;
use crate::link::coordinator::{Coordination, Demand, Post};
use crate::link::radio_settings::FrameSize;
use crate::link::settings::KnownStations;
use crate::network::Network;
use crate::service::network_id::NetworkId;
use crate::service::report::Destination;
use crate::setup::Setup;
use crate::station::Roll;

/// Tells each network its stations, for settings that name them.
///
/// # Errors
/// If a station is not there, or one that is there cannot take part.
pub(super) fn know(setup: &mut Setup) -> Result<(), SettingError> {
    let Setup { world, robots, sinks, networks, .. } = setup;
    for (number, network) in networks.iter_mut().enumerate() {
        let id = NetworkId(u8::try_from(number).unwrap_or(u8::MAX));
        let robots = robots.iter().map(|robot| robot.body.networks.contains(&id)).collect();
        let stations = KnownStations { nodes: &world.nodes, robots, sinks, network: id };
        let name = network.name.clone();
        let known = network.technology.settings_mut().know_stations(&stations);
        known.map_err(|error| name.map_or(error.clone(), |name| error.within(format!("networks.{name}"))))?;
    }
    Ok(())
}

/// The stations of a simulation, and the networks that they are in.
#[derive(Clone, Copy)]
pub(super) struct Stations<'a> {
    setup: &'a Setup,
    pub(super) roll: Roll,
}

impl<'a> Stations<'a> {
    pub(super) fn of(setup: &'a Setup) -> Self {
        Self { setup, roll: setup.roll() }
    }

    /// Length of the diagonal of a box round all stations at the start (m).
    pub(super) fn extent_m(&self) -> f64 {
        let Setup { world, robots, sinks, .. } = self.setup;
        let places = (world.nodes.iter().map(|node| node.position))
            .chain(robots.iter().map(|robot| robot.body.start))
            .chain(sinks.iter().map(|sink| sink.position));
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for place in places {
            for (axis, value) in <[f64; 3]>::from(place).into_iter().enumerate() {
                low[axis] = low[axis].min(value);
                high[axis] = high[axis].max(value);
            }
        }
        if low[0] > high[0] { 0.0 } else { Position::from(low).distance_m(Position::from(high)) }
    }

    /// Refuses frames that are too small for the addresses, and frames to one of several robots.
    pub(super) fn check_frames(&self, id: NetworkId, network: &Network) -> Result<(), SettingError> {
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
            let (mpdu_octets, acknowledged) = (traffic.mpdu_octets(), traffic.is_acknowledged());
            let longest = FrameSize { network: id, from: last, mpdu_octets, acknowledged };
            network.technology.settings().check_frame(longest).map_err(|error| error.within(traffic.key()))?;
        }
        Ok(())
    }

    /// Refuses mobile anchors in networks whose robots send nothing.
    pub(super) fn check_mobile_anchors(&self) -> Result<(), SettingError> {
        for (i, robot) in self.setup.robots.iter().enumerate().filter(|(_, robot)| robot.is_mobile_anchor()) {
            if robot.body.networks.iter().any(|id| self.setup.networks[id.index()].technology.has_coordinator()) {
                let found = "anchor, in a network with superframes";
                let allowed = "another network: in one with `mac.beacon_enabled` robots send nothing but beacons";
                return Err(SettingError::new(format!("robots[{i}].role"), found, allowed));
            }
            if robot.body.networks.iter().any(|id| self.setup.networks[id.index()].technology.is_programmed()) {
                let found = "anchor, in a network whose programs command the radios";
                let allowed = "another network: one with `mac.program` has no channel access for its announcements";
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
        let place = self.setup.world.nodes[node.index()].position;
        let distance_m = |&sink: &usize| place.distance_m(self.setup.sinks[sink].position);
        let nearest = (0..self.roll.sinks)
            .filter(|&sink| self.setup.sinks[sink].is_in(id))
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
        self.setup
            .robots
            .iter()
            .enumerate()
            .filter(move |(_, robot)| robot.is_surveying() && robot.body.networks.contains(&id))
            .map(|(robot, _)| robot)
    }

    /// Name and station of each robot that surveys a network, and of each sink in it.
    pub(super) fn collectors(&self, id: NetworkId) -> impl Iterator<Item = (&str, StationId)> {
        let is_in = move |robot: &Robot| robot.is_surveying() && robot.body.networks.contains(&id);
        let robots = self.setup.robots.iter().map(move |robot| (&*robot.body.name, is_in(robot)));
        let sinks = self.setup.sinks.iter().map(move |sink| (&*sink.name, sink.is_in(id)));
        let nodes = self.roll.nodes;
        robots
            .chain(sinks)
            .enumerate()
            .filter(|(_, (_, is_member))| *is_member)
            .map(move |(i, (name, _))| (name, StationId::from_index(nodes + i)))
    }

    /// The coordinator of a network with beacons: the first robot, or the first sink if there is no robot.
    pub(super) fn coordinator(&self) -> Result<Option<(StationId, Coordinator)>, SettingError> {
        let Setup { networks, seed, .. } = self.setup;
        if let Some(other) = networks.iter().skip(1).find(|network| network.technology.has_coordinator()) {
            let allowed = "beacons in the first network only";
            return Err(SettingError::new(other.key("mac"), "beacon_enabled", allowed));
        }
        let network = networks.first().filter(|network| network.technology.has_coordinator());
        let Some(network) = network else { return Ok(None) };
        if self.roll.robots + self.roll.sinks == 0 {
            return Ok(None);
        }
        let id = NetworkId::default();
        let robot = self.robots_in(id).next();
        let sink = || (0..self.roll.sinks).find(|&sink| self.setup.sinks[sink].is_in(id));
        let station = robot.or_else(|| sink().map(|sink| self.roll.robots + sink)).ok_or_else(|| {
            let with = "a network without a robot or a sink, because one of them sends the beacons";
            SettingError::conflict(network.key("mac"), with, "add a robot or a sink")
        })?;
        let listen = robot.map(|robot| (robot, self.setup.robots[robot].body.listen));
        let post = Post { station: StationId::from_index(self.roll.nodes + station), listen };
        let demand = |traffic: &Traffic| Demand {
            key: traffic.key().to_owned(),
            mpdu_octets: traffic.mpdu_octets(),
            acknowledged: traffic.is_acknowledged(),
        };
        let demands: Vec<_> =
            network.traffic.kinds().filter(|traffic| traffic.mpdu_octets() > 0).map(demand).collect();
        let nodes = &self.setup.world.nodes;
        let coordination = Coordination { network: id, seed: *seed, post, nodes, demands: &demands };
        let machine = network.technology.settings().coordinator(&coordination)?;
        Ok(machine.map(|machine| (post.station, machine)))
    }
}
