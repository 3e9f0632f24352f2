//! What happens in a simulation.

use sextant_kernel::{NodeId, Rank};
use sextant_mac::{Class, coordinator, csma, device, responder};

/// What happens in a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Event {
    /// A node's application has a frame to send.
    FrameDue(NodeId),
    /// Something happened to the MAC of a node.
    Mac(NodeId, csma::Event),
    /// The CCA of a node is over.
    CcaEnded(NodeId),
    /// Something happened to a node that follows beacons.
    Tracking(NodeId, device::Event),
    /// Something happened to a robot.
    Robot(u32, RobotEvent),
}

/// What happens to a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RobotEvent {
    /// It is where it drove to, or starts.
    Arrived,
    /// It has listened long enough.
    SlotEnded,
    /// Something happened to its acknowledgement.
    Responder(responder::Event),
    /// A beacon of it is due one turnaround from now.
    BeaconDue,
    /// Something happened to its beacon.
    Coordinator(coordinator::Event),
    /// The active part of its superframe is over.
    ActivePartEnded,
}

impl Event {
    /// What happens to robot number `robot`.
    pub(crate) fn of_robot(robot: usize, event: RobotEvent) -> Self {
        Self::Robot(NodeId::from_index(robot).0, event)
    }

    /// Where the event stands among those of the same instant; robots are numbered after the `nodes`.
    pub(crate) fn rank(self, nodes: u32) -> Rank {
        match self {
            Self::FrameDue(node) => Class::Application.rank(node),
            Self::Mac(node, event) => event.class().rank(node),
            Self::CcaEnded(node) => Class::EndOfCca.rank(node),
            Self::Tracking(node, event) => event.class().rank(node),
            Self::Robot(robot, event) => {
                let class = match event {
                    RobotEvent::Arrived
                    | RobotEvent::SlotEnded
                    | RobotEvent::BeaconDue
                    | RobotEvent::ActivePartEnded => Class::Application,
                    RobotEvent::Coordinator(event) => event.class(),
                    RobotEvent::Responder(event) => event.class(),
                };
                class.rank(NodeId(nodes + robot))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn an_event_fits_in_eight_bytes() {
        assert!(size_of::<super::Event>() <= 8, "{} bytes", size_of::<super::Event>());
    }
}
