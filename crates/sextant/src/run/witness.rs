//! What happens in a mission: where everybody truly is, and what the mission works out.

use sextant_channel::Position;
use sextant_kernel::{SimTime, StationId};
use sextant_sim::{Estimate, Field, FieldId, Observer, TargetId};

use sextant_recording::Way;
use sextant_scenario::Scenario;

/// What happened in a mission; instants are those of its simulation.
#[derive(Clone, Debug)]
pub(super) struct Witness {
    /// The true ways of the robots.
    pub(super) robots: Vec<Way>,
    /// The true ways of the targets.
    pub(super) targets: Vec<Way>,
    /// When each target was gone from the world, if it was.
    pub(super) gone: Vec<Option<SimTime>>,
    /// Who captured which target, and when.
    pub(super) captures: Vec<Captured>,
    /// What stations worked out.
    pub(super) estimates: Vec<(StationId, SimTime, Estimate)>,
    /// The fields, with the sources that were removed.
    pub(super) fields: Vec<Field>,
}

/// A captured target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Captured {
    pub(super) robot: usize,
    pub(super) target: TargetId,
    pub(super) time: SimTime,
}

impl Witness {
    /// Of a mission of this many robots in the world of `scenario`.
    pub(super) fn new(scenario: &Scenario, robots: usize) -> Self {
        let targets = scenario.world().targets.len();
        Self {
            robots: vec![Way::default(); robots],
            targets: vec![Way::default(); targets],
            gone: vec![None; targets],
            captures: Vec::new(),
            estimates: Vec::new(),
            fields: scenario.world().fields.clone(),
        }
    }

    /// The place of a robot, which was seen where the simulation began (m).
    pub(super) fn robot_at(&self, robot: usize, time: SimTime) -> Option<Position> {
        self.robots[robot].at(time)
    }

    /// The place of a target (m); `None` if it is gone.
    pub(super) fn target_at(&self, target: TargetId, time: SimTime) -> Option<Position> {
        let target = target.index();
        self.targets[target].at(time).filter(|_| self.gone[target].is_none_or(|gone| time <= gone))
    }
}

impl Observer for Witness {
    fn moved(&mut self, robot: usize, time: SimTime, position: Position) {
        self.robots[robot].push(time, position);
    }

    fn estimated(&mut self, station: StationId, time: SimTime, estimate: &Estimate) {
        self.estimates.push((station, time, *estimate));
    }

    fn target_moved(&mut self, target: TargetId, time: SimTime, position: Position) {
        self.targets[target.index()].push(time, position);
    }

    fn captured(&mut self, robot: usize, target: TargetId, time: SimTime) {
        self.captures.push(Captured { robot, target, time });
    }

    fn target_gone(&mut self, target: TargetId, time: SimTime) {
        self.gone[target.index()] = Some(time);
    }

    fn source_removed(&mut self, field: FieldId, source: usize, time: SimTime) {
        self.fields[field.index()].remove(source, time);
    }
}
