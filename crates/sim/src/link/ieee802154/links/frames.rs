//! Frames for observers.

use sextant_kernel::StationId;

use super::Links;
use crate::air::Transmission;
use crate::link::collectors::tell_collectors;
use crate::link::fate::Fate;
use crate::observer::{FrameOnAir, Observer};
use crate::scene::Scene;

impl Links {
    /// What became of a transmission at the stations that it `is_for`.
    pub(super) fn fate(
        &self,
        transmission: &Transmission,
        scene: &Scene,
        is_for: impl Fn(StationId) -> bool,
    ) -> Fate {
        Fate::of(transmission, &self.arrivals, &scene.airs[self.radios.air], is_for)
    }

    /// What became of a transmission of a robot or a sink at the nodes.
    pub(super) fn fate_at_nodes(&self, transmission: &Transmission, scene: &Scene) -> Fate {
        let nodes = (0..scene.roll.nodes).map(|node| self.radios.receiver(StationId::from_index(node)));
        let missed = scene.airs[self.radios.air].missed_by(transmission, nodes);
        (self.arrivals.iter().filter(|arrival| scene.roll.is_node(arrival.station)))
            .fold(Fate::missed(missed), Fate::or)
    }

    /// Tells the observer of the frame in `mpdu`, which ends now, with its fate.
    pub(super) fn tell_frame(
        &mut self,
        transmission: &Transmission,
        fate: Fate,
        scene: &Scene,
        observer: &mut impl Observer,
    ) {
        tell_collectors(&self.arrivals, &scene.roll, &mut self.told);
        observer.framed(FrameOnAir {
            network: self.radios.network,
            channel: None,
            start: transmission.start(),
            airtime: scene.now - transmission.start(),
            source: transmission.source(),
            bytes: &self.mpdu,
            outcome: fate.outcome,
            power: fate.power(),
            heard: &self.told,
        });
    }
}
