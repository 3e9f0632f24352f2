//! What the sensors of the nodes sense, and when: targets that enter and leave their radius, samples of fields.
//!
//! A target moves on straight legs, so the instants at which it crosses the rim of a disc are known when a leg begins.
//! They become events then; nothing is polled. Only nodes near a leg are looked at.

mod crossing;
mod index;
mod readings;

use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{NodeId, SimTime, StationId};

use crate::event::Event;
use crate::scene::Scene;
use crate::service::sensed::{FieldId, Sensed, TargetId};
use crate::world::World;
use crate::world::field::Field;
use crate::world::target::{Course, Leg};
use crossing::Passage;
use index::NodeIndex;
use readings::Readings;

/// The targets on their ways, and the sensors of the nodes.
pub(crate) struct Sensing {
    targets: Vec<Tracked>,
    /// The nodes that detect targets, if any does.
    detectors: Option<NodeIndex>,
    /// How nodes sample fields, if any does.
    readings: Option<Readings>,
    near: Vec<NodeId>,
    /// The places of the robots now.
    robots: Vec<Position>,
}

/// What a target does at the end of a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Turned {
    /// It goes on or stands at a place.
    At(Position),
    /// It is gone from a place.
    Gone(Position),
}

/// A target on its way.
struct Tracked {
    course: Course,
    leg: Leg,
    /// The nodes that detect it at the end of the leg, by number.
    detected_by: Vec<NodeId>,
    /// The nodes that detect it now, by number.
    detected_now: Vec<NodeId>,
    /// Whether it is not in the world any more.
    is_gone: bool,
}

impl Sensing {
    /// The sensors of the nodes in `world`; `senses` tells whose application looks at what its sensors say.
    pub(crate) fn new(world: &World, senses: &[bool], scene: &Scene) -> Self {
        let nodes = || (0..world.nodes.len()).filter(|&node| senses[node]).map(NodeId::from_index);
        let place = |node: NodeId| world.nodes[node.index()].position;
        let detectors = world.sensors.targets.filter(|_| !world.targets.is_empty() && nodes().next().is_some());
        let samplers = world.sensors.fields.filter(|_| !world.fields.is_empty());
        let tracked = |target: &crate::world::target::Target| Tracked {
            course: target.course(scene.seed),
            leg: Leg::standing(target.start(), SimTime::ZERO),
            detected_by: Vec::new(),
            detected_now: Vec::new(),
            is_gone: false,
        };
        Self {
            targets: world.targets.iter().map(tracked).collect(),
            detectors: detectors
                .map(|sensor| NodeIndex::new(nodes().map(|node| (node, place(node))), sensor.radius_m())),
            readings: samplers.map(|sensor| Readings::new(sensor, world, nodes().collect(), scene.seed)),
            near: Vec::new(),
            robots: Vec::new(),
        }
    }

    /// Schedules the first events.
    pub(crate) fn begin(&self, scene: &mut Scene) {
        for target in self.target_ids() {
            scene.at(SimTime::ZERO, Event::TargetTurned(target));
        }
        if let Some(readings) = &self.readings {
            for node in readings.nodes() {
                scene.at(readings.first(node), Event::SampleDue(StationId(node.0)));
            }
        }
    }

    /// A target is at the end of its leg: it begins the next one, or is gone. Returns where it is, unless it was gone
    /// before.
    pub(crate) fn turn(&mut self, target: TargetId, scene: &mut Scene, obstacles: &ObstacleField) -> Option<Turned> {
        let tracked = &mut self.targets[target.index()];
        if tracked.is_gone {
            return None;
        }
        let here = tracked.leg.to;
        self.robots.clear();
        if tracked.course.sees_robots() {
            self.robots.extend(scene.robots());
        }
        match tracked.course.next_leg_among(obstacles, &self.robots) {
            Some(leg) => {
                tracked.leg = leg;
                scene.at(leg.end, Event::TargetTurned(target));
            }
            None if tracked.course.leaves() => return Some(Turned::Gone(self.vanish(target, scene))),
            None => tracked.leg = Leg::standing(here, scene.now),
        }
        if let Some(detectors) = &self.detectors {
            let before = std::mem::take(&mut tracked.detected_by);
            self.near.clear();
            self.near.extend(&before);
            detectors.add_near(&tracked.leg, &mut self.near);
            for &node in &self.near {
                let was_inside = before.binary_search(&node).is_ok();
                let passage = Passage::of(&tracked.leg, detectors.place(node), detectors.radius_m(), was_inside);
                if let Some(entered) = passage.entered {
                    scene.at(entered, Event::TargetEntered(StationId(node.0), target));
                }
                if let Some(left) = passage.left {
                    scene.at(left, Event::TargetLeft(StationId(node.0), target));
                }
                if passage.ends_inside {
                    tracked.detected_by.push(node);
                }
            }
        }
        Some(Turned::At(here))
    }

    /// A target is gone from the world now: the sensors that detect it say at once that it has left. Returns where it
    /// was.
    pub(crate) fn vanish(&mut self, target: TargetId, scene: &mut Scene) -> Position {
        let tracked = &mut self.targets[target.index()];
        tracked.is_gone = true;
        for node in &tracked.detected_now {
            scene.at(scene.now, Event::TargetLeft(StationId(node.0), target));
        }
        tracked.leg.at(scene.now)
    }

    /// Whether a node detects a target from now on that enters its radius: not if the target is gone.
    pub(crate) fn enter(&mut self, station: StationId, target: TargetId) -> bool {
        let (tracked, node) = (&mut self.targets[target.index()], NodeId(station.0));
        match tracked.detected_now.binary_search(&node) {
            Err(place) if !tracked.is_gone => {
                tracked.detected_now.insert(place, node);
                true
            }
            _ => false,
        }
    }

    /// Whether a node has detected a target until now that leaves its radius: not if it has said so before.
    pub(crate) fn leave(&mut self, station: StationId, target: TargetId) -> bool {
        let detected = &mut self.targets[target.index()].detected_now;
        detected.binary_search(&NodeId(station.0)).map(|place| detected.remove(place)).is_ok()
    }

    /// What a node reads now of the field `field` with this identity.
    ///
    /// # Panics
    /// If the node samples no fields.
    pub(crate) fn read(&mut self, station: StationId, id: FieldId, field: &Field, scene: &Scene) -> Sensed {
        let readings = self.readings.as_mut().expect("samples are scheduled for nodes with a sensor");
        let truth = field.value(scene.place(station), scene.now);
        let value = readings.read(NodeId(station.0), id.index(), truth, scene.now);
        Sensed::Sampled { field: id, value }
    }

    /// The latest sample of a field by a node, if there was any.
    pub(crate) fn latest(&self, node: NodeId, field: FieldId) -> Option<f64> {
        self.readings.as_ref()?.latest(node, field.index())
    }

    /// Schedules the next samples of a node.
    pub(crate) fn sample_later(&self, station: StationId, scene: &mut Scene) {
        if let Some(readings) = &self.readings {
            scene.after(readings.interval(), Event::SampleDue(station));
        }
    }

    /// The place of each target now that is not gone.
    pub(crate) fn places(&self, now: SimTime) -> impl Iterator<Item = (TargetId, Position)> {
        let present = self.target_ids().zip(&self.targets).filter(|(_, tracked)| !tracked.is_gone);
        present.map(move |(target, tracked)| (target, tracked.leg.at(now)))
    }

    fn target_ids(&self) -> impl Iterator<Item = TargetId> + use<> {
        (0..self.targets.len()).map(TargetId::from_index)
    }
}
