//! Nodes that die.

use sextant_kernel::{NodeId, StationId};

use super::Engine;
use crate::application::{Application, Port};
use crate::event::Event;
use crate::faults::Death;

impl<A: Application> Engine<A> {
    /// Schedules the deaths.
    pub(super) fn schedule_deaths(&mut self) {
        for &Death { node, time } in self.faults.deaths() {
            self.model.scene.at(time, Event::Died(StationId(node.0)));
        }
    }

    /// Whether a station has died.
    #[inline]
    pub(super) fn is_dead(&self, station: StationId) -> bool {
        !self.dead.is_empty() && self.dead[station.index()]
    }

    /// Whether an event does not happen, because its station has died. The frame that is on air then still ends.
    #[inline]
    pub(super) fn is_dropped(&self, event: Event) -> bool {
        !self.dead.is_empty()
            && match event {
                Event::Link(station, network, event) => {
                    self.dead[station.index()] && !self.model.networks[network.index()].ends_frame(station, event)
                }
                Event::Timer(station, _)
                | Event::DriveEnded(station)
                | Event::NodeTurned(station)
                | Event::ArcPartDriven(station)
                | Event::TargetEntered(station, _)
                | Event::TargetLeft(station, _)
                | Event::TargetMissed(station, _)
                | Event::FalseAlarmRaised(station)
                | Event::FalseAlarmEnded(station, _)
                | Event::SampleDue(station) => self.dead[station.index()],
                Event::HaloDue(_)
                | Event::TargetTurned(_)
                | Event::Died(_)
                | Event::WarmedUp
                | Event::NoiseStarted(_)
                | Event::NoiseEnded(_) => false,
            }
    }

    /// A node dies: its task is over, and its radios are off from now on, or from the end of the frame on air.
    pub(super) fn die(&mut self, station: StationId) {
        self.dead.resize(self.model.scene.roll.len(), false);
        self.dead[station.index()] = true;
        if self.model.halo.is_some() {
            self.applications[station.index()].ended(&mut Port { model: &mut self.model, station });
        }
        self.deaths.push(Death { node: NodeId(station.0), time: self.model.scene.now });
        for network in &mut self.model.networks {
            network.die(station, &mut self.model.scene);
        }
        Port { model: &mut self.model, station }.finish();
    }
}
