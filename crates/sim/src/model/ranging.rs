//! Ranges that robots measure.

use std::time::Duration;

use sextant_channel::{ChannelLaw, Mounting, ObstacleField, Position, RangeSample, RangeTry, RangingDevice};
use sextant_kernel::{NodeId, SimTime, StationId};

use super::Model;
use crate::service::network_id::NetworkId;
use crate::world::World;

/// How ranges are measured in a network, and what is in their way.
pub(crate) struct Ranging {
    pub(crate) device: RangingDevice,
    /// `None` if obstacles let signals through.
    obstacles: Option<ObstacleField>,
}

impl Ranging {
    /// That with a `device` in a world, over a channel of this law.
    pub(crate) fn new(device: RangingDevice, law: &ChannelLaw, world: &World) -> Self {
        let obstacles = law.obstacles_attenuate().then(|| world.obstacles.at_carrier(law.signal_ghz()));
        Self { device, obstacles }
    }

    /// Whether an obstacle blocks the straight way.
    fn is_blocked(&self, from: Position, to: Position) -> bool {
        self.obstacles.as_ref().is_some_and(|obstacles| obstacles.loss(from, to).0 > 0.0)
    }
}

impl Model {
    /// Measures the range from a robot to a node in a network: see [`Port::measure_range`](crate::Port::measure_range).
    pub(crate) fn measure_range(&self, station: StationId, network: NetworkId, node: NodeId) -> Option<RangeSample> {
        /// The velocity is that over this time, before or after.
        const STEP_NS: u64 = 1_000_000;
        let ranging = self.rangings[network.index()].as_ref()?;
        let sender = StationId(node.0);
        let (from, to) = (self.scene.place(station), self.scene.place(sender));
        let distance_m = from.distance_m(to);
        if distance_m > ranging.device.max_range_m() {
            return None;
        }
        // A dead node, and one of another network, has no radio there.
        self.networks[network.index()].transmitter(sender)?;
        let is_blocked = ranging.is_blocked(from, to);
        let time = self.scene.now;
        let attempt = RangeTry { node, station, time, distance_m, is_blocked };
        let range_m = ranging.device.range_m(self.scene.seed, &attempt)?;
        let robot = self.robot(station);
        let vehicle = &self.vehicles[robot.index()];
        let position = vehicle.believed_at(time).position;
        // A drive that ends or begins within the step is followed to the other side.
        let before = SimTime::from_nanos(time.as_nanos().saturating_sub(STEP_NS));
        let ahead = vehicle.believed_at(time + Duration::from_nanos(STEP_NS)).position - position;
        let behind = position - vehicle.believed_at(before).position;
        let length_m = |step: Position| step.distance_m(Position::ORIGIN);
        let step = if length_m(ahead) >= length_m(behind) { ahead } else { behind };
        let velocity = step * (1e9 / STEP_NS as f64);
        Some(RangeSample { node, robot, time, position, mounting: Mounting::default(), velocity, range_m })
    }
}
