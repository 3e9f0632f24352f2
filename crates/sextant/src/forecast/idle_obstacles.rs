//! Obstacles that change nothing: likely a mistake in their place, their size or their material.

use sextant_channel::{Bounds, Channel, Obstacle, ObstacleField, Position, Ray, Shape};
use sextant_kernel::Seed;
use sextant_scenario::Scenario;
use sextant_sim::{Interferer, Setup, TargetMotionConfig};

use super::network::Reach;
use super::way::Way;

/// At most so many ways by reflections are tried to find out whether an obstacle changes one. Beyond it, an obstacle has
/// the benefit of the doubt.
const MOST_TRIES: usize = 10_000_000;

/// Losses that differ by less are the same (dB).
const ROUNDING_DB: f64 = 1e-6;

const NOTHING_TO_DO: &str = "it neither absorbs nor stops robots; give it a `material`";
pub(super) const APART: &str = "it lies beside, above or below all stations, targets and interferers and what is between them; check its place and size";

/// Those whom an obstacle may stand in the way of.
pub(super) struct Audience<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) setup: &'a Setup,
    pub(super) reaches: &'a [Reach<'a>],
    /// The ways that are known before the start.
    pub(super) planned: &'a [Way<'a>],
}

impl Audience<'_> {
    /// The obstacles that change nothing, each with the reason.
    pub(super) fn idle_obstacles(&self) -> Vec<(usize, &'static str)> {
        let Some(stations) = self.stations() else { return Vec::new() };
        let radius_m = self.scenario.bodies().iter().map(|body| body.radius_m).fold(0.0, f64::max);
        // A robot that finds its way itself may leave the nodes by as far as it hears them.
        let far_m = self.reaches.iter().map(|reach| reach.range.hundredth_m).fold(0.0, f64::max);
        let margin_m = if self.knows_all_ways() { radius_m } else { far_m };
        let by = Position::new(margin_m, margin_m, radius_m);
        let reached = Bounds { min: stations.min - by, max: stations.max + by };
        let attenuate = self.reaches.iter().any(|reach| reach.law().obstacles_attenuate());
        // Where a target that walks at random goes is not known before the start.
        let roam = self.targets().any(|places_m| places_m.is_none());
        let mut tries = MOST_TRIES;
        let mut idle = Vec::new();
        for (i, obstacle) in self.setup.world.obstacles.obstacles().iter().enumerate() {
            let absorbs = attenuate && (obstacle.absorption_per_m() > 0.0 || obstacle.loss().0 > 0.0);
            let bounds = obstacle.shape().bounds();
            if !absorbs && !obstacle.is_solid() {
                idle.push((i, NOTHING_TO_DO));
            } else if !roam
                && is_apart(&bounds, &reached)
                && !self.may_change_rays(i, &stations.grown(far_m), &mut tries)
            {
                idle.push((i, APART));
            }
        }
        idle
    }

    /// Whether all robots drive on ways that are known before the start.
    fn knows_all_ways(&self) -> bool {
        self.planned.len() == self.scenario.bodies().len()
    }

    /// The places of each target; `None` if it walks at random.
    fn targets(&self) -> impl Iterator<Item = Option<&[Position]>> {
        self.scenario.config().world.targets.iter().map(|target| match &target.motion {
            TargetMotionConfig::Waypoints(way) => Some(&way.places_m[..]),
            TargetMotionConfig::RandomWalk(_) | TargetMotionConfig::Wander(_) | TargetMotionConfig::Evade(_) => None,
        })
    }

    /// The box around all places that are known of stations, of targets and of sources of noise.
    fn stations(&self) -> Option<Bounds> {
        let places = self.setup.world.nodes.iter().map(|node| node.position);
        let sinks = self.setup.sinks.iter().map(|sink| sink.position);
        let starts = self.scenario.bodies().iter().map(|body| body.start);
        let stops = self.planned.iter().flat_map(|way| way.stops().iter().copied());
        let targets = self.targets().flatten().flatten().copied();
        let noise = self.setup.world.interferers.iter().map(Interferer::position);
        Bounds::of(places.chain(sinks).chain(starts).chain(stops).chain(targets).chain(noise))
    }

    /// Whether an obstacle that no straight link crosses may change the rays of a link: it reflects, or stands in the way of
    /// a reflection. `heard` is where stations hear each other.
    fn may_change_rays(&self, obstacle: usize, heard: &Bounds, tries: &mut usize) -> bool {
        let all = &self.setup.world.obstacles;
        let bounds = all.obstacles()[obstacle].shape().bounds();
        self.reaches.iter().filter(|reach| reach.channel().reflects()).any(|reach| {
            if !self.knows_all_ways() {
                return !is_apart(&bounds, heard);
            }
            let without = without(all, obstacle, reach, self.setup.seed);
            let is_near = |a: Position, b: Position| {
                bounds.distance_m(a) + bounds.distance_m(b) <= 2.0 * reach.range.hundredth_m
            };
            let mut links = self.links(reach).filter(|&(a, b)| a != b && is_near(a, b));
            links.any(|(a, b)| {
                let Some(left) = tries.checked_sub(1 + reach.channel().tries()) else { return true };
                *tries = left;
                let (mut with, mut other) = (Vec::new(), Vec::new());
                reach.channel().rays(a, b, &mut with);
                without.rays(a, b, &mut other);
                are_different(&with, &other)
            })
        })
    }

    /// The places of two stations of a network that may hear each other.
    fn links<'b>(&'b self, reach: &'b Reach<'b>) -> impl Iterator<Item = (Position, Position)> + 'b {
        let nodes = reach.nodes.iter().map(|(_, place)| *place);
        let sinks = self.setup.sinks.iter().filter(move |sink| sink.is_in(reach.id)).map(|sink| sink.position);
        let surveys = self.planned.iter().filter(move |way| way.body().networks.contains(&reach.id));
        let stops = surveys.flat_map(|way| way.stops().iter().copied());
        let ends = nodes.chain(sinks).chain(stops);
        ends.flat_map(move |to| reach.in_reach(to).map(move |(_, from)| (*from, to)))
    }
}

/// The channel of a network in a world without one of its obstacles.
fn without(all: &ObstacleField, obstacle: usize, reach: &Reach<'_>, seed: Seed) -> Channel {
    let others = all.obstacles().iter().enumerate().filter(|(i, _)| *i != obstacle);
    let others: Vec<Obstacle> = others.map(|(_, other)| other.clone()).collect();
    Channel::new(*reach.law(), ObstacleField::new(others), seed)
}

/// Whether rays differ by more than the rounding of sums over obstacles in another order.
fn are_different(one: &[Ray], other: &[Ray]) -> bool {
    let differ = |(one, other): (&Ray, &Ray)| (one.loss - other.loss).0.abs() > ROUNDING_DB;
    one.len() != other.len() || one.iter().zip(other).any(differ)
}

/// Whether a solid in one box is in no way of lines in another one: side faces and roofs do not belong to solids.
fn is_apart(solid: &Bounds, lines: &Bounds) -> bool {
    let is_beside = |solid: (f64, f64), lines: (f64, f64)| solid.1 <= lines.0 || lines.1 <= solid.0;
    is_beside((solid.min.x_m, solid.max.x_m), (lines.min.x_m, lines.max.x_m))
        || is_beside((solid.min.y_m, solid.max.y_m), (lines.min.y_m, lines.max.y_m))
        || solid.max.z_m <= lines.min.z_m
        || lines.max.z_m < solid.min.z_m - Shape::LEVEL_M
}
