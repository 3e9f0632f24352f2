//! Frames for observers.

use sextant_kernel::NodeId;

use super::Simulation;
use crate::air::{Arrival, Transmission};
use crate::{FrameOnAir, FrameOutcome, HeardFrame, Observer};

impl Simulation {
    /// Tells the observer of the frame in `mpdu`, which ends now, with its `arrivals` and its `best` outcome.
    pub(super) fn tell_frame(
        &mut self,
        transmission: &Transmission,
        best: FrameOutcome,
        observer: &mut impl Observer,
    ) {
        let (source, first_robot) = (transmission.source(), self.macs.len());
        let is_from_robot = source.index() >= first_robot;
        let is_at_robot = |arrival: &&Arrival| arrival.station.index() >= first_robot;
        self.told.clear();
        self.told.extend(
            (self.arrivals.iter().filter(is_at_robot).filter(|arrival| arrival.outcome == FrameOutcome::Received))
                .map(|arrival| HeardFrame {
                    robot: arrival.station.index() - first_robot,
                    power: arrival.power.to_dbm(),
                }),
        );
        let counts = |arrival: &&Arrival| is_at_robot(arrival) != is_from_robot && arrival.outcome == best;
        observer.framed(FrameOnAir {
            start: transmission.start(),
            airtime: self.network.now - transmission.start(),
            source,
            bytes: &self.mpdu,
            outcome: best,
            power: self.arrivals.iter().find(counts).map(|arrival| arrival.power.to_dbm()),
            heard: &self.told,
        });
    }

    /// The best outcome of a robot's frame at any node, by `arrivals`.
    pub(super) fn best_at_nodes(&self) -> FrameOutcome {
        let is_at_node = |arrival: &&Arrival| arrival.station < NodeId::from_index(self.macs.len());
        self.arrivals
            .iter()
            .filter(is_at_node)
            .map(|arrival| arrival.outcome)
            .max()
            .unwrap_or(FrameOutcome::NotListened)
    }
}
