//! Events of a simulation.

use sextant_kernel::{NodeId, Rank};
use sextant_mac::{Class, coordinator, csma, device, responder};

/// An event of a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Event {
    /// A node's application has a frame to send.
    FrameDue(NodeId),
    /// An event of the MAC of a node.
    Mac(NodeId, csma::Event),
    /// The CCA of a node is over.
    CcaEnded(NodeId),
    /// An event of a node that follows beacons.
    Tracking(NodeId, device::Event),
    /// An event of a robot.
    Robot(u32, RobotEvent),
}

/// An event of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RobotEvent {
    /// It has arrived at its destination, or starts.
    Arrived,
    /// It has listened long enough.
    SlotEnded,
    /// An event of its acknowledgement.
    Responder(responder::Event),
    /// Its next beacon is due one turnaround from now.
    BeaconDue,
    /// An event of its beacon.
    Coordinator(coordinator::Event),
    /// The active part of its superframe is over.
    ActivePartEnded,
}

impl Event {
    /// The event of robot number `robot`.
    pub(crate) fn of_robot(robot: usize, event: RobotEvent) -> Self {
        Self::Robot(NodeId::from_index(robot).0, event)
    }

    /// Rank of the event among those of the same instant; robots are numbered after the `nodes`.
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
