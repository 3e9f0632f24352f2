//! Whether the ranges are later by far than clocks of logs differ: then a step along the velocity is not enough.

use std::collections::BTreeMap;

use sextant_channel::{Position, RangeSample, ReceptionLog};
use sextant_kernel::{Interrupted, RobotId, Watch};

use super::Settings;
use super::fit::fitted;
use super::groups::RangeGroups;
use super::problem::{HeightPrior, Problem};
use super::report::RangeFit;
use super::solution::{ErrorShares, NODE_BIAS_M, by_least_squares};

/// Where the search begins (s).
const STARTS_S: [f64; 5] = [0.0, 1.0, -1.0, 2.5, -2.5];
/// Fits from where the last one has the clock, and the step that ends them (s).
const ROUNDS: u32 = 5;
const LEAST_STEP_S: f64 = 0.03;
/// The longest delay that is sought (s).
const LONGEST_S: f64 = 6.0;
/// A delay is told if the ranges are more probable by so much with it: a group, and all of them (nats).
const CLEAR_OF_ONE: f64 = 0.1;
const CLEAR: f64 = 20.0;
/// It is sought if a step along the velocity finds so much (s).
const SUSPECT_S: f64 = 0.2;

/// Whether the clock may be wrong by more than a step along the velocity can tell.
pub(super) fn is_suspect(fit: &RangeFit, usual_m: f64) -> bool {
    fit.delay_s.abs() > SUSPECT_S || fit.is_odd(usual_m)
}

/// How late the ranges are (s), if much later than clocks of logs usually are, and clearly so.
pub(super) fn delay_s(
    settings: &Settings,
    log: &ReceptionLog,
    heights: HeightPrior,
    watch: &dyn Watch,
) -> Result<Option<f64>, Interrupted> {
    let paths = Paths::of(log);
    if settings.delay_error_s <= 0.0 || paths.is_still {
        return Ok(None);
    }
    let mut best: Option<Tried> = None;
    let mut usual: Option<Tried> = None;
    for start_s in STARTS_S {
        let mut late_s = start_s;
        for round in 0..ROUNDS {
            let Some(tried) = Tried::of(settings, &paths.late_by(log, late_s), late_s, heights, watch)? else {
                break;
            };
            let step_s = tried.step_s;
            if round == 0 && start_s.abs() <= 0.0 {
                usual = Some(tried);
            }
            if best.is_none_or(|best| tried.mean > best.mean) {
                best = Some(tried);
            }
            late_s += step_s;
            if step_s.abs() < LEAST_STEP_S || late_s.abs() > LONGEST_S {
                break;
            }
        }
    }
    let (Some(best), Some(usual)) = (best, usual) else { return Ok(None) };
    let gain = best.mean - usual.mean;
    let is_clear = gain > CLEAR_OF_ONE && gain * best.groups.min(usual.groups) > CLEAR;
    Ok(is_clear.then_some(best.late_s))
}

/// A delay that was tried.
#[derive(Clone, Copy)]
struct Tried {
    late_s: f64,
    /// How much later the ranges are by a step along the velocity (s).
    step_s: f64,
    /// The logarithm of the marginal likelihood, for each of so many groups.
    mean: f64,
    groups: f64,
}

impl Tried {
    fn of(
        settings: &Settings,
        log: &ReceptionLog,
        late_s: f64,
        heights: HeightPrior,
        watch: &dyn Watch,
    ) -> Result<Option<Self>, Interrupted> {
        let groups = RangeGroups::of(log, |count| count >= heights.least());
        if groups.nodes.is_empty() {
            return Ok(None);
        }
        let prior = settings.prior(ErrorShares::ALL);
        let problem = Problem { groups: &groups, prior, heights, node_bias_m: NODE_BIAS_M, worth: 1.0 };
        let found = fitted(&problem, by_least_squares(&problem, prior.mean), watch)?;
        let count = groups.len() as f64;
        let of = |fitted: super::fit::Fitted| Self {
            late_s,
            step_s: fitted.point.delay_s(),
            mean: fitted.log_evidence / count,
            groups: count,
        };
        Ok(found.map(of))
    }
}

/// Where each robot was, by its ranges.
pub(super) struct Paths {
    /// Time (s), place and direction (rad), in the order of time.
    of_robots: BTreeMap<RobotId, Vec<(f64, Position, f64)>>,
    /// Whether no robot moved.
    is_still: bool,
}

impl Paths {
    pub(super) fn of(log: &ReceptionLog) -> Self {
        let mut of_robots: BTreeMap<RobotId, Vec<(f64, Position, f64)>> = BTreeMap::new();
        for sample in log.ranges() {
            let RangeSample { position, mounting, velocity, .. } = sample;
            let heading = libm::atan2(velocity.y_m, velocity.x_m);
            let here = (sample.time.as_secs_f64(), *position - mounting.arm, heading);
            of_robots.entry(sample.robot).or_default().push(here);
        }
        for path in of_robots.values_mut() {
            path.sort_by(|a, b| a.0.total_cmp(&b.0));
            path.dedup_by(|a, b| a.0.to_bits() == b.0.to_bits());
        }
        let is_still = log.ranges().iter().all(|sample| sample.velocity == Position::ORIGIN);
        Self { of_robots, is_still }
    }

    /// Place and direction of a robot at a time (s), if the path holds it.
    fn at(&self, robot: RobotId, time_s: f64) -> Option<(Position, f64)> {
        let path = self.of_robots.get(&robot)?;
        let next = path.partition_point(|(time, ..)| *time < time_s);
        let (after, before) = (path.get(next)?, path.get(next.saturating_sub(1))?);
        let share = if after.0 > before.0 { (time_s - before.0) / (after.0 - before.0) } else { 0.0 };
        (share >= 0.0).then(|| (before.1 + (after.1 - before.1) * share, after.2))
    }

    /// The log with each range where its robot was so much earlier (s). Ranges from before the path are left out.
    pub(super) fn late_by(&self, log: &ReceptionLog, late_s: f64) -> ReceptionLog {
        let earlier = |sample: &RangeSample| {
            let time_s = sample.time.as_secs_f64();
            let (now, heading) = self.at(sample.robot, time_s)?;
            let (then, heading_then) = self.at(sample.robot, time_s - late_s)?;
            let (sin, cos) = libm::sincos(heading_then - heading);
            let turned = |Position { x_m, y_m, z_m }: Position| {
                Position::new(cos * x_m - sin * y_m, sin * x_m + cos * y_m, z_m)
            };
            let arm = turned(sample.mounting.arm);
            let position = sample.position - sample.mounting.arm + (then - now) + arm;
            let mounting = sextant_channel::Mounting { arm, ..sample.mounting };
            Some(RangeSample { position, velocity: turned(sample.velocity), mounting, ..*sample })
        };
        let ranges = log.ranges().iter().filter_map(earlier).collect();
        log.clone().with_ranges(ranges).unwrap_or_else(|error| unreachable!("a part of the ranges of a log: {error}"))
    }
}
