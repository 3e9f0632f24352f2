//! What an engine is like between two of its events.

use sextant_kernel::SimTime;

use super::Engine;
use super::running::Stage;
use crate::application::Application;
use crate::link::Links;
use crate::service::packets::Packets;
use crate::snapshot::{Reached, RobotSnapshot, Snapshot};
use crate::station::RobotPose;

impl<A: Application> Engine<A> {
    /// How far it has gone.
    pub(crate) fn reached(&self) -> Reached {
        let time = match self.stage {
            Stage::Ready => SimTime::ZERO,
            Stage::Waiting { at, .. } => at,
            Stage::Ended { .. } => self.now(),
        };
        Reached { time, has_ended: matches!(self.stage, Stage::Ended { .. }) }
    }

    /// How it is now, or at its end.
    pub(crate) fn snapshot(&self) -> Snapshot {
        let Reached { time, has_ended } = self.reached();
        let robots = (0..).zip(&self.model.vehicles).map(|(robot, vehicle)| RobotSnapshot {
            name: vehicle.body.name.clone(),
            pose: self.pose_at(time, robot),
        });
        let nodes = self.model.scene.roll.nodes;
        let of_nodes =
            |network: &Links| network.packets()[..nodes].iter().map(|&packets| packets.with_pending()).sum();
        Snapshot {
            time,
            has_ended,
            robots: robots.collect(),
            stops: self.logs.stops(),
            receptions: self.logs.receptions,
            nodes_heard: self.logs.nodes_heard,
            packets: self.model.networks.iter().map(of_nodes).sum::<Packets>(),
        }
    }

    /// Where a robot is, not before the last event and not after the next one.
    pub(super) fn pose_at(&self, time: SimTime, robot: usize) -> RobotPose {
        let station = self.model.scene.roll.robot(robot);
        RobotPose {
            truth: self.model.scene.motions[station.index()].pose_at(time),
            belief: self.model.vehicles[robot].believed_at(time),
        }
    }
}
