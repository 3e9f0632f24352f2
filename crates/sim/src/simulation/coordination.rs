//! The first robot as coordinator: it sends beacons while it stands and listens, and nodes follow the beacons.

use std::time::Duration;

use sextant_kernel::{NodeId, SettingError};
use sextant_mac::coordinator::{self, Coordinator};
use sextant_mac::device;
use sextant_mac::frame::{Address, Endpoint, Frame, FrameBody};
use sextant_mac::superframe::BeaconEnabled;

use super::robots::RobotRadio;
use super::{PAN, Simulation};
use crate::FrameOutcome;
use crate::event::{Event, RobotEvent};
use crate::mac::short_address;
use crate::{Observer, Robot, Traffic, World};

/// Index of the robot that is the coordinator.
pub(super) const COORDINATOR: usize = 0;

/// The key of the table of the settings.
const KEY: &str = "mac.beacon_enabled";

/// The coordinator, with settings checked against world, robots and traffic.
pub(super) fn coordinator(
    settings: &BeaconEnabled,
    phy: sextant_mac::Phy,
    world: &World,
    robots: &[Robot],
    traffic: &Traffic,
    sequence: u8,
) -> Result<Option<Coordinator>, SettingError> {
    let Some(robot) = robots.get(COORDINATOR) else {
        return Ok(None);
    };
    let devices = (settings.gts().iter().enumerate())
        .map(|(i, gts)| {
            let refusal =
                |allowed| SettingError::new(format!("{KEY}.gts[{i}].node"), format!("`{}`", gts.node), allowed);
            let node = world.nodes.iter().position(|node| node.name == gts.node);
            let node = node.ok_or_else(|| refusal("the name of a node"))?;
            short_address(NodeId::from_index(node))
                .ok_or_else(|| refusal("one of the nodes that have a short address"))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let source = Endpoint { pan: PAN, address: Address::of(NodeId::from_index(world.nodes.len() + COORDINATOR)) };
    let coordinator =
        Coordinator::new(settings, phy, source, &devices, sequence).map_err(|error| error.within(KEY))?;
    let (octets, ack) = (traffic.mpdu_octets(), traffic.is_acknowledged());
    for (i, gts) in settings.gts().iter().enumerate() {
        if !coordinator.slot_carries(i, octets, ack) {
            let allowed = format!("enough slots for a frame of {octets} octets and what must follow it");
            return Err(SettingError::new(format!("{KEY}.gts[{i}].slots"), gts.slots, allowed));
        }
    }
    if !coordinator.contention_carries(octets, ack) {
        let allowed =
            "a size that fits into the contention access period with assessments, acknowledgement and spacing";
        return Err(SettingError::new(format!("{}.mpdu_octets", traffic.key()), octets, allowed));
    }
    let interval = coordinator.timing().beacon_interval();
    if robot.body.listen < interval {
        let found = robot.body.listen.as_secs_f64();
        let allowed = format!(
            "at least the beacon interval, {} s: a stop without a beacon hears nobody",
            interval.as_secs_f64()
        );
        return Err(SettingError::new(format!("robots[{COORDINATOR}].listen_s"), found, allowed));
    }
    Ok(Some(coordinator))
}

impl Simulation {
    /// A beacon is due one turnaround from now. The schedule of beacons never stops. The robot sends the beacons that
    /// are due while it listens, and opens no superframe after the end of its time at a stop.
    pub(super) fn prepare_beacon(&mut self) {
        let Some(coordinator) = &mut self.coordinator else { return };
        let interval = coordinator.timing().beacon_interval();
        self.network.after(interval, Event::of_robot(COORDINATOR, RobotEvent::BeaconDue));
        let pilot = &self.pilots[COORDINATOR];
        let is_free = !pilot.responder.is_responding() && !coordinator.is_sending();
        if pilot.is_listening() && !pilot.slot_is_over && is_free {
            let place = pilot.position();
            coordinator.prepare(&mut RobotRadio { network: &mut self.network, robot: COORDINATOR, place });
        }
    }

    pub(super) fn handle_coordinator(&mut self, event: coordinator::Event, observer: &mut impl Observer) {
        if event == coordinator::Event::TransmissionEnded {
            self.end_beacon(observer);
        }
        let (now, place) = (self.network.now, self.pilots[COORDINATOR].position());
        let coordinator = self.coordinator.as_mut().expect("a coordinator has events");
        let mut radio = RobotRadio { network: &mut self.network, robot: COORDINATOR, place };
        coordinator.handle(now, event, &mut radio);
        if event == coordinator::Event::TransmitReady {
            let active = coordinator.timing().active();
            self.network.after(active, Event::of_robot(COORDINATOR, RobotEvent::ActivePartEnded));
        }
    }

    /// A beacon ends: the nodes that received it follow it.
    fn end_beacon(&mut self, observer: &mut impl Observer) {
        let transmission = self.network.beacon.take().expect("only a beacon on air ends");
        self.network.air.end(self.network.now, &transmission, &mut self.arrivals);
        self.coordinator.as_ref().expect("a coordinator sends").write_beacon(&mut self.mpdu);
        if observer.wants_frames() {
            self.tell_frame(&transmission, self.best_at_nodes(), observer);
        }
        let now = self.network.now;
        let octets = u8::try_from(self.mpdu.len()).expect("at most 127 octets");
        let frame = Frame::parse(&self.mpdu).expect("stations write what they can read");
        let FrameBody::Beacon(beacon) = frame.body else { unreachable!("a coordinator writes beacons") };
        for arrival in self.arrivals.iter().filter(|arrival| arrival.outcome == FrameOutcome::Received) {
            if let Some(mac) = self.macs.get_mut(arrival.station.index()) {
                mac.receive_beacon(now, octets, &beacon, &mut self.network.radio(arrival.station, true));
            }
        }
    }

    /// Handles an event of a node that follows beacons.
    pub(super) fn handle_tracking(&mut self, node: NodeId, event: device::Event) {
        let now = self.network.now;
        self.macs[node.index()].track(now, event, &mut self.network.radio(node, true));
    }

    /// Whether a robot that has listened long enough may leave: no acknowledgement, beacon or superframe is under
    /// way.
    pub(super) fn may_leave(&self, robot: usize) -> bool {
        let superframe_is_over = match &self.coordinator {
            Some(coordinator) if robot == COORDINATOR => {
                !coordinator.is_sending() && coordinator.active_end().is_none_or(|end| end <= self.network.now)
            }
            _ => true,
        };
        superframe_is_over && !self.pilots[robot].responder.is_responding()
    }

    /// Time from a frame that ends now at `robot` to its acknowledgement.
    pub(super) fn ack_gap(&self, robot: usize) -> Duration {
        match &self.coordinator {
            Some(coordinator) if robot == COORDINATOR => coordinator.ack_gap(self.network.now),
            _ => self.network.phy.turnaround(),
        }
    }
}
