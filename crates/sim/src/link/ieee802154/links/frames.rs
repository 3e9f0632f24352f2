//! Frames for observers.

use sextant_channel::Dbm;
use sextant_kernel::StationId;

use super::Links;
use crate::air::{Arrival, Transmission};
use crate::link::collectors::tell_collectors;
use crate::observer::{FrameOnAir, Observer};
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;

/// What became of a transmission at the stations that it is for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fate {
    /// The best outcome.
    pub(super) outcome: FrameOutcome,
    /// The first station with that outcome, if a signal was measured.
    pub(super) arrival: Option<Arrival>,
}

impl Fate {
    fn missed(outcome: FrameOutcome) -> Self {
        Self { outcome, arrival: None }
    }

    fn or(self, arrival: &Arrival) -> Self {
        let is_better = arrival.outcome > self.outcome || arrival.outcome == self.outcome && self.arrival.is_none();
        if is_better { Self { outcome: arrival.outcome, arrival: Some(*arrival) } } else { self }
    }

    fn power(&self) -> Option<Dbm> {
        self.arrival.map(|arrival| arrival.power.to_dbm())
    }
}

impl Links {
    /// What became of a transmission at the stations that it `is_for`.
    pub(super) fn fate(
        &self,
        transmission: &Transmission,
        scene: &Scene,
        is_for: impl Fn(StationId) -> bool,
    ) -> Fate {
        let arrivals = self.arrivals.iter().filter(|arrival| is_for(arrival.station));
        let fate = arrivals.fold(Fate::missed(FrameOutcome::WORST), Fate::or);
        if fate.outcome.deafness().is_none() {
            return fate;
        }
        let missed = scene.airs[self.radios.air].missed(transmission);
        if missed > fate.outcome { Fate::missed(missed) } else { fate }
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
