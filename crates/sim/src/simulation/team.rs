//! Robots that never come near each other: they are simulated in parallel.
//!
//! Each group of robots has a simulation of its own, with all nodes. In it nodes rest that are far from these robots. Random
//! draws depend on who sends when, and not on what others send. So all that happens near a group is what happens there in one
//! simulation of all robots, if no node is awake in two groups at once, or so near to one that is that their signals meet.
//! That is checked afterwards, by the ways that the robots drove. Groups that met are simulated again, as one.

mod calls;
mod course;
mod progress;

use rayon::prelude::*;
use sextant_channel::SectorTable;
use sextant_kernel::{SettingError, SimTime};

use super::{Outcome, Simulation, surveyed, too_far};
use crate::applications::node_traffic::NodeTraffic;
use crate::applications::standard::Standard;
use crate::engine::{Ended, Engine};
use crate::halo::SimulatedPart;
use crate::model::log::Logs;
use crate::observer::{Observer, RememberingObserver};
use crate::outcome::Survey;
use crate::region::SimulatedRegion;
use crate::setup::Setup;
use calls::Calls;
use course::{Course, meet};
use progress::{GroupProgress, Noting, watch};

/// A survey by several robots, of which those that never come near each other are simulated in parallel. The result is that
/// of one simulation.
pub struct Team {
    setup: Setup,
    region: SimulatedRegion,
    halo_m: f64,
}

/// A group of robots, by number.
type Group = Vec<usize>;

/// What the simulation of a group leaves behind.
struct TeamPart {
    ended: Ended<Standard<NodeTraffic>>,
    calls: Calls,
    /// How far from a robot nodes were awake (m).
    reach_m: f64,
}

impl Team {
    /// The team of `setup`; `None` if its robots cannot be simulated in parallel: all nodes are simulated, something
    /// besides them acts on the whole world, or robots send.
    ///
    /// # Errors
    /// Those of [`Simulation::new`] and [`Simulation::with_region`].
    pub fn of(setup: &Setup, region: SimulatedRegion) -> Result<Option<Self>, SettingError> {
        let Setup { world, robots, sinks, networks, faults, batteries, .. } = setup;
        let is_still = world.interferers.is_empty() && world.targets.is_empty() && world.fields.is_empty();
        let is_survey = robots.len() > 1 && robots.iter().all(|robot| robot.is_surveying());
        let robots_send = networks
            .iter()
            .any(|network| network.traffic.is_acknowledged() || network.technology.antennas().is_some());
        if !is_still
            || !is_survey
            || robots_send
            || !sinks.is_empty()
            || !faults.deaths().is_empty()
            || batteries.is_some()
        {
            return Ok(None);
        }
        let simulation = Simulation::new(setup.clone())?.with_region(region)?;
        let halo_m = region.halo_m(setup.reach())?.filter(|_| simulation.engine.halo_reach_m().is_some());
        Ok(halo_m.map(|halo_m| Self { setup: setup.clone(), region, halo_m }))
    }

    /// Runs until the tasks of all robots are done, or the time is over, or the observer ends the simulation.
    ///
    /// # Panics
    /// Never: the setup was checked.
    pub fn run(self, observer: &mut dyn Observer) -> Survey {
        let mut groups = self.groups_at_the_start();
        // Frames and packets of all groups would have to be kept until the end.
        while groups.len() > 1 && !observer.wants_frames() && !observer.wants_packets() {
            let (parts, interrupted) = self.simulate(&groups, observer);
            match self.meeting(&parts, &groups) {
                Some((first, second)) if !interrupted => {
                    let joined = groups.swap_remove(second);
                    groups[first].extend(joined);
                    groups.iter_mut().for_each(|group| group.sort_unstable());
                    groups.sort();
                }
                _ => return self.join(parts, &groups, interrupted, observer),
            }
        }
        self.as_one().run(&mut &mut *observer)
    }

    /// The simulation of all robots.
    pub(super) fn as_one(&self) -> Simulation {
        self.simulation(None)
    }

    /// The simulation of these robots, or of all.
    fn simulation(&self, group: Option<&[usize]>) -> Simulation {
        let simulation = Simulation::of_robots(self.setup.clone(), group);
        simulation
            .and_then(|simulation| simulation.with_region(self.region))
            .expect("the simulation of the whole team was made, and a group needs nothing else")
    }

    /// Robots that are too near each other at the start are in one group.
    fn groups_at_the_start(&self) -> Vec<Group> {
        let least_m = 2.0 * self.halo_m + self.setup.reach().interference_m;
        let starts: Vec<_> = self.setup.robots.iter().map(|robot| robot.body.start).collect();
        let mut groups: Vec<Group> = Vec::new();
        for robot in 0..starts.len() {
            let is_near =
                |group: &Group| group.iter().any(|&other| starts[other].distance_m(starts[robot]) <= least_m);
            let (near, mut far): (Vec<_>, Vec<_>) = groups.into_iter().partition(is_near);
            let mut group: Group = near.into_iter().flatten().chain([robot]).collect();
            group.sort_unstable();
            far.push(group);
            far.sort();
            groups = far;
        }
        groups
    }

    /// Simulates the groups in parallel, each until its robots are done, then all until the last one is. Returns also whether
    /// the observer ended it.
    fn simulate(&self, groups: &[Group], observer: &mut dyn Observer) -> (Vec<TeamPart>, bool) {
        let progress: Vec<GroupProgress> = groups.iter().map(|_| GroupProgress::default()).collect();
        let begun = |(group, progress): (&Group, &GroupProgress)| {
            let mut engine = self.simulation(Some(group)).engine;
            let mut calls = Calls::default();
            engine.advance(SimTime::MAX, &mut RememberingObserver::new(&mut (&mut calls, Noting(progress))));
            (engine, calls)
        };
        let all = || groups.par_iter().zip(&progress).map(begun).collect::<Vec<_>>();
        let begun = watch(&progress, self.setup.world.nodes.len(), observer, all);
        let interrupted = begun.iter().any(|(engine, _)| engine.is_interrupted());
        let end = begun.iter().map(|(engine, _)| engine.now()).max().unwrap_or(SimTime::ZERO);
        let ended = |(mut engine, mut calls): (Engine<Standard<NodeTraffic>>, Calls)| {
            let reach_m = engine.halo_reach_m().unwrap_or(f64::INFINITY);
            let observer = &mut RememberingObserver::new(&mut calls);
            engine.go_on_until(end, observer);
            let ended = engine.conclude(end, observer);
            TeamPart { ended, calls, reach_m }
        };
        (begun.into_par_iter().map(ended).collect(), interrupted)
    }

    /// Two groups that came so near each other that they must be simulated as one.
    fn meeting(&self, parts: &[TeamPart], groups: &[Group]) -> Option<(usize, usize)> {
        let courses: Vec<Vec<Course>> = (parts.iter().zip(groups))
            .map(|(part, group)| group.iter().map(|&robot| part.calls.course(robot)).collect())
            .collect();
        let apart_m = |first: usize, second: usize| {
            parts[first].reach_m + parts[second].reach_m + self.setup.reach().interference_m
        };
        let all_meet = |first: usize, second: usize| {
            let pairs = courses[first].iter().flat_map(|a| courses[second].iter().map(move |b| (a, b)));
            pairs.into_iter().any(|(a, b)| meet(a, b, apart_m(first, second)))
        };
        (0..parts.len())
            .flat_map(|first| (first + 1..parts.len()).map(move |second| (first, second)))
            .find(|&(first, second)| all_meet(first, second))
    }

    /// Joins the parts, and tells the observer what happened in all, in the order of time.
    fn join(&self, parts: Vec<TeamPart>, groups: &[Group], interrupted: bool, observer: &mut dyn Observer) -> Survey {
        let Setup { world, robots, networks, .. } = &self.setup;
        let mut logs = Logs::new(networks.iter().map(|_| None::<SectorTable>), world.nodes.len());
        let (mut all_calls, mut all_ended) = (Vec::new(), Vec::new());
        for TeamPart { ended, calls, .. } in parts {
            all_calls.push(calls);
            all_ended.push(ended);
        }
        calls::replay(all_calls, &mut logs, observer);
        let node_names: Vec<String> = world.nodes.iter().map(|node| node.name.clone()).collect();
        let names: Vec<String> = robots.iter().map(|robot| robot.body.name.clone()).collect();
        let mut ended = all_ended.remove(0);
        for (other, group) in all_ended.into_iter().zip(&groups[1..]) {
            ended.events += other.events;
            ended.networks.iter_mut().zip(other.networks).for_each(|(sum, books)| sum.add(books));
            let mut applications: Vec<_> = other.applications.into_iter().map(Some).collect();
            for &robot in group {
                let station = world.nodes.len() + robot;
                ended.applications[station] = applications[station].take().expect("a robot is in one group");
                ended.path_lengths_m[robot] = other.path_lengths_m[robot];
                ended.end_poses[robot] = other.end_poses[robot];
            }
        }
        ended.logs = logs.build(&node_names, &names);
        ended.interrupted = interrupted;
        let simulated = SimulatedPart::NearListeners { halo_m: self.halo_m };
        let (surveyed, too_far) = (surveyed(&self.setup), too_far(&self.setup));
        Outcome { roll: self.setup.roll(), names, surveyed, too_far, simulated }.of(ended).0
    }
}
