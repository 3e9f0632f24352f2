//! Events of targets and sensors.

use sextant_kernel::{NodeId, StationId};

use super::Engine;
use crate::application::{Application, Port};
use crate::observer::Observer;
use crate::sensing::Turned;
use crate::service::sensed::{FieldId, Sensed, TargetId};

impl<A: Application> Engine<A> {
    /// A target begins its next leg.
    pub(super) fn turn(&mut self, target: TargetId, observer: &mut impl Observer) {
        let model = &mut self.model;
        let Some(turned) = model.sensing.turn(target, &mut model.scene, &model.world.obstacles) else { return };
        let now = model.scene.now;
        match turned {
            Turned::At(place) => observer.target_moved(target, now, place),
            Turned::Gone(place) => {
                observer.target_moved(target, now, place);
                observer.target_gone(target, now);
            }
        }
    }

    /// A target enters the radius of detection of a node.
    pub(super) fn enter(&mut self, station: StationId, target: TargetId, observer: &mut impl Observer) {
        if self.model.sensing.enter(station, target) {
            self.tell_sensed(station, &Sensed::Entered(target), observer);
        }
    }

    /// A target leaves the radius of detection of a node, or is gone.
    pub(super) fn leave(&mut self, station: StationId, target: TargetId, observer: &mut impl Observer) {
        if self.model.sensing.leave(station, target) {
            self.tell_sensed(station, &Sensed::Left(target), observer);
        }
    }

    /// A target enters the radius of detection of a node, whose sensor misses it.
    pub(super) fn miss(&mut self, target: TargetId) {
        self.sensed.missed += u64::from(self.model.sensing.is_there(target));
    }

    /// The sensor of a node says that a target is there, which is not.
    pub(super) fn raise_false_alarm(&mut self, station: StationId, observer: &mut impl Observer) {
        if let Some(target) = self.model.sensing.raise_false_alarm(station, &mut self.model.scene) {
            self.sensed.false_alarms += 1;
            self.tell_sensed(station, &Sensed::Entered(target), observer);
        }
    }

    /// A false alarm is over.
    pub(super) fn end_false_alarm(&mut self, station: StationId, target: TargetId, observer: &mut impl Observer) {
        if self.model.sensing.end_false_alarm(station, target) {
            self.tell_sensed(station, &Sensed::Left(target), observer);
        }
    }

    /// A node samples the fields.
    pub(super) fn sample(&mut self, station: StationId, observer: &mut impl Observer) {
        for number in 0..self.model.world.fields.len() {
            let model = &mut self.model;
            let sampled =
                model.sensing.read(station, FieldId::from_index(number), &model.world.fields[number], &model.scene);
            self.tell_sensed(station, &sampled, observer);
        }
        self.model.sensing.sample_later(station, &mut self.model.scene);
    }

    /// A sensor says something to its node.
    pub(super) fn tell_sensed(&mut self, station: StationId, sensed: &Sensed, observer: &mut impl Observer) {
        observer.sensed(NodeId(station.0), self.model.scene.now, sensed);
        self.sensed.add(sensed);
        let mut port = Port { model: &mut self.model, station };
        self.applications[station.index()].sensed(sensed, &mut port);
    }

    /// Says where the targets are at the end.
    pub(super) fn tell_targets(&self, observer: &mut impl Observer) {
        let now = self.model.scene.now;
        self.model.sensing.places(now).for_each(|(target, place)| observer.target_moved(target, now, place));
    }
}
