//! Frames for observers.

use sextant_kernel::StationId;

use super::Network;
use crate::air::{Arrival, FrameOutcome, Transmission};
use crate::observer::{FrameOnAir, HeardFrame, Observer};
use crate::scene::Scene;

impl Network {
    /// Tells the observer of the frame in `mpdu`, which ends now, with its outcome.
    pub(super) fn tell_frame(
        &mut self,
        transmission: &Transmission,
        outcome: FrameOutcome,
        scene: &Scene,
        observer: &mut impl Observer,
    ) {
        let (source, nodes) = (transmission.source(), scene.roll.nodes);
        let is_from_node = scene.roll.is_node(source);
        let is_at_collector = |arrival: &&Arrival| !scene.roll.is_node(arrival.station);
        self.told.clear();
        self.told.extend(
            (self.arrivals.iter().filter(is_at_collector))
                .filter(|arrival| arrival.outcome == FrameOutcome::Received)
                .map(|arrival| HeardFrame {
                    collector: arrival.station.index() - nodes,
                    power: arrival.power.to_dbm(),
                }),
        );
        let counts = |arrival: &&Arrival| is_at_collector(arrival) == is_from_node && arrival.outcome == outcome;
        observer.framed(FrameOnAir {
            network: self.radios.network,
            start: transmission.start(),
            airtime: scene.now - transmission.start(),
            source,
            bytes: &self.mpdu,
            outcome,
            power: self.arrivals.iter().find(counts).map(|arrival| arrival.power.to_dbm()),
            heard: &self.told,
        });
    }

    /// The best outcome at any station on the other side of `source`: of a robot's or a sink's frame at the nodes, of
    /// a node's frame at robots and sinks.
    pub(super) fn best_at_others(&self, source: StationId, scene: &Scene) -> FrameOutcome {
        let from_node = scene.roll.is_node(source);
        self.arrivals
            .iter()
            .filter(|arrival| scene.roll.is_node(arrival.station) != from_node)
            .map(|arrival| arrival.outcome)
            .max()
            .unwrap_or(FrameOutcome::NotListened)
    }
}
