//! Frames for observers.

use sextant_kernel::StationId;

use super::Links;
use crate::air::Transmission;
use crate::link::fate::Fate;
use crate::link::frame_buffer::FrameEnd;
use crate::observer::Observer;
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

    /// Tells the observer of the frame in the buffer, which ends now, with its fate.
    pub(super) fn tell_frame(
        &mut self,
        transmission: &Transmission,
        fate: Fate,
        scene: &Scene,
        observer: &mut impl Observer,
    ) {
        let (network, channel) = (self.radios.network, None);
        let end = FrameEnd { network, channel, transmission, fate, arrivals: &self.arrivals };
        self.frame.tell(end, scene, observer);
    }
}
