//! What the sensors of the nodes sense, and when: targets that enter and leave their radius, samples of fields.
//!
//! A target moves on straight legs, so the instants at which it crosses the rim of a disc, or comes out of the shadow of an
//! obstacle, are known when a leg begins. They become events then; nothing is polled. Only nodes near a leg are looked at.

mod crossing;
mod errors;
mod index;
mod readings;
mod sight;
mod tracked;

use std::collections::BTreeMap;

use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{NodeId, Seed, SimTime, StationId};

use crate::event::Event;
use crate::scene::Scene;
use crate::service::sensed::{FieldId, Sensed, TargetId};
use crate::world::World;
use crate::world::field::Field;
use crate::world::sensors::TargetSensor;
use crate::world::target::Leg;
use crossing::Passage;
use errors::SensorErrors;
use index::NodeIndex;
use readings::Readings;
use sight::Sight;
use tracked::{Stay, Tracked};

/// The targets on their ways, and the sensors of the nodes.
pub(crate) struct Sensing {
    targets: Vec<Tracked>,
    /// The nodes that detect targets, if any does.
    detectors: Option<Detectors>,
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

/// The nodes that detect targets.
struct Detectors {
    nodes: NodeIndex,
    errors: SensorErrors,
    /// Whether solid obstacles hide targets.
    walls_hide: bool,
    /// Number of false alarms so far, by node; empty without false alarms.
    alarms: BTreeMap<NodeId, u64>,
}

impl Detectors {
    fn new(nodes: NodeIndex, sensor: TargetSensor, targets: usize, seed: Seed) -> Self {
        let errors = SensorErrors::new(sensor, targets, seed);
        let alarms =
            if errors.raise_alarms() { nodes.nodes().map(|node| (node, 0)).collect() } else { BTreeMap::new() };
        Self { nodes, errors, walls_hide: sensor.walls_hide, alarms }
    }

    /// A target begins a leg: schedules what the nodes `near` it are going to say.
    fn follow(
        &self,
        target: TargetId,
        tracked: &mut Tracked,
        near: &[NodeId],
        obstacles: &ObstacleField,
        scene: &mut Scene,
    ) {
        let before = std::mem::take(&mut tracked.stays);
        for &node in near {
            let stay = before.binary_search_by_key(&node, |stay| stay.node).ok().map(|at| before[at]);
            let passage = Passage::of(&tracked.leg, self.nodes.place(node), self.nodes.radius_m(), stay.is_some());
            if stay.is_none() && passage.entered.is_none() {
                continue;
            }
            let mut stay = stay.unwrap_or_else(|| Stay::new(node, self.is_missed(node, target, tracked)));
            let sight = if self.walls_hide {
                Sight::among(obstacles, self.nodes.place(node), &tracked.leg, &passage, stay.in_sight)
            } else {
                Sight::free(&tracked.leg, &passage, stay.in_sight)
            };
            let station = StationId(node.0);
            for &(time, appears) in &sight.changes {
                if !stay.is_missed {
                    let event = if appears { Event::TargetEntered } else { Event::TargetLeft };
                    scene.at(time, event(station, target));
                } else if appears && !stay.is_counted {
                    scene.at(time, Event::TargetMissed(station, target));
                    stay.is_counted = true;
                }
            }
            stay.in_sight = sight.ends_in_sight;
            if passage.ends_inside {
                tracked.stays.push(stay);
            }
        }
    }

    /// Whether a node misses the passage of a target that begins.
    fn is_missed(&self, node: NodeId, target: TargetId, tracked: &mut Tracked) -> bool {
        if !self.errors.miss() {
            return false;
        }
        let passages = tracked.passages.entry(node).or_default();
        *passages += 1;
        self.errors.misses(node, target, *passages - 1)
    }
}

impl Sensing {
    /// The sensors of the nodes in `world`; `senses` tells whose application looks at what its sensors say.
    pub(crate) fn new(world: &World, senses: &[bool], scene: &Scene) -> Self {
        let nodes = || (0..world.nodes.len()).filter(|&node| senses[node]).map(NodeId::from_index);
        let place = |node: NodeId| world.nodes[node.index()].position;
        let detectors = world.sensors.targets.filter(|_| !world.targets.is_empty() && nodes().next().is_some());
        let samplers = world.sensors.fields.filter(|_| !world.fields.is_empty());
        let tracked = |target: &crate::world::target::Target| {
            Tracked::new(target.course(scene.seed), Leg::standing(target.start(), SimTime::ZERO))
        };
        let detectors = detectors.map(|sensor| {
            let index = NodeIndex::new(nodes().map(|node| (node, place(node))), sensor.radius_m());
            Detectors::new(index, sensor, world.targets.len(), scene.seed)
        });
        Self {
            targets: world.targets.iter().map(tracked).collect(),
            detectors,
            readings: samplers.map(|sensor| Readings::new(sensor, world, nodes().collect(), scene.seed)),
            near: Vec::new(),
            robots: Vec::new(),
        }
    }

    /// Schedules the first events.
    pub(crate) fn begin(&self, scene: &mut Scene) {
        for (target, tracked) in self.target_ids().zip(&self.targets) {
            scene.at(SimTime::ZERO, Event::TargetTurned(target));
            scene.body_moves(target.index(), Some(tracked.leg.motion()));
        }
        if let Some(detectors) = &self.detectors {
            for &node in detectors.alarms.keys() {
                scene.after(detectors.errors.until_alarm(node, 0), Event::FalseAlarmRaised(StationId(node.0)));
            }
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
        scene.body_moves(target.index(), Some(tracked.leg.motion()));
        if let Some(detectors) = &self.detectors {
            self.near.clear();
            self.near.extend(tracked.stays.iter().map(|stay| stay.node));
            detectors.nodes.add_near(&tracked.leg, &mut self.near);
            detectors.follow(target, tracked, &self.near, obstacles, scene);
        }
        Some(Turned::At(here))
    }

    /// A target is gone from the world now: the sensors that detect it say at once that it has left. Returns where it
    /// was.
    pub(crate) fn vanish(&mut self, target: TargetId, scene: &mut Scene) -> Position {
        let tracked = &mut self.targets[target.index()];
        tracked.is_gone = true;
        scene.body_moves(target.index(), None);
        for node in tracked.detected.truly() {
            scene.at(scene.now, Event::TargetLeft(StationId(node.0), target));
        }
        tracked.leg.at(scene.now)
    }

    /// Whether a node detects a target from now on that enters its radius: not if the target is gone, or the node says that
    /// it is there already.
    pub(crate) fn enter(&mut self, station: StationId, target: TargetId) -> bool {
        let tracked = &mut self.targets[target.index()];
        !tracked.is_gone && tracked.detected.enter(NodeId(station.0))
    }

    /// Whether a node has detected a target until now that leaves its radius: not if it has said so before, or still raises
    /// a false alarm.
    pub(crate) fn leave(&mut self, station: StationId, target: TargetId) -> bool {
        self.targets[target.index()].detected.leave(NodeId(station.0))
    }

    /// Whether a target is in the world.
    pub(crate) fn is_there(&self, target: TargetId) -> bool {
        !self.targets[target.index()].is_gone
    }

    /// A node raises a false alarm, and the next one is scheduled. Returns the target that it names, unless the node says
    /// already that it is there.
    pub(crate) fn raise_false_alarm(&mut self, station: StationId, scene: &mut Scene) -> Option<TargetId> {
        let (detectors, node) = (self.detectors.as_mut()?, NodeId(station.0));
        let number = detectors.alarms.get_mut(&node)?;
        let target = detectors.errors.named(node, *number);
        *number += 1;
        scene.after(detectors.errors.until_alarm(node, *number), Event::FalseAlarmRaised(station));
        scene.after(detectors.errors.alarm_lasts(), Event::FalseAlarmEnded(station, target));
        self.targets[target.index()].detected.raise_false_alarm(node).then_some(target)
    }

    /// Whether a node has detected a target until now whose false alarm is over.
    pub(crate) fn end_false_alarm(&mut self, station: StationId, target: TargetId) -> bool {
        self.targets[target.index()].detected.end_false_alarm(NodeId(station.0))
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
