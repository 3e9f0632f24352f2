//! How late the clock of the packets is by that of the path, estimated from the packets themselves.
//!
//! A robot that passes a place in two directions hears a node there alike. If the packets are late, the places of the
//! one passage are shifted one way and those of the other the other way, and no place of the node explains both. So for each
//! delay the nodes are placed anew, with the front and back of the robot ([`super::track`]), and the delay of least loss is the
//! estimate: that of highest likelihood with places and antenna profiled out. Its uncertainty comes from how parts of the log disagree (the sandwich estimate over nodes and
//! thirds of their packets), not from the law, whose errors are correlated.

use sextant_kernel::SimTime;

use super::finding::Finding;
use super::route::Route;
use super::samples::Samples;
use super::track::{AtDelay, COVERED, PacketTrack, background, profile};
use crate::path::robot_path::Path;
use crate::place::distance::{extent_m, plane_m};

/// Steps of the search on either side of 0: as many as leave most nodes on the path. Each is divided into so many finer ones
/// around the best of them.
const STEPS: [f64; 8] = [40.0, 30.0, 24.0, 18.0, 12.0, 9.0, 6.0, 4.0];
const FINE: i32 = 4;
/// A step is the time in which the robot drives this far (m), or this share of the extent of its path.
const STEP_M: f64 = 0.5;
const STEP_SHARE: f64 = 1.0 / 80.0;
/// The delay is at most this share of the time of the path.
const LONGEST: f64 = 0.25;
/// With fewer packets in all, there is no estimate.
const LEAST: usize = 60;
/// A dip of the loss is deep if it reaches down by this share of the deepest, from the median.
const DEEP: f64 = 0.6;
/// What a body does is no first harmonic, and the rest looks like a way of about so much for each decibel of it (m).
const PATTERN_M: f64 = 0.06;
/// A body that is not estimated, because packets have no strengths, looks like a way of about so much (m).
const BODY_M: f64 = 0.35;
/// A dip is the least of so many steps on either side.
const BESIDE: usize = 3;
/// The finer steps are moved at most so many times.
const MOVES: u32 = 3;
/// Another deep dip is a rival if its delay is at most so many times as long.
const RIVAL: f64 = 2.0;
/// A delay is clear if it is so many times its uncertainty, if the parts of the log prefer it over none by so many times
/// theirs, and if it moves the robot by so much (m).
const CLEAR: f64 = 4.0;
const GAIN: f64 = 3.0;
pub(super) const NOTABLE_M: f64 = 0.25;

/// How late the clock of the packets is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockOffset {
    /// The times of packets minus those of the path for the same instant (s).
    pub delay_s: f64,
    /// Its standard error (s).
    pub error_s: f64,
    /// Whether it is clearly not 0.
    pub is_clear: bool,
    /// Another delay that explains about as much (s): a robot on lanes to and fro that is late by half a lane is at the mirror
    /// images of the places at which it would be if it were early by as much.
    pub rival_s: Option<f64>,
    /// How fast the robot usually drives (m/s).
    pub speed_m_per_s: f64,
}

impl ClockOffset {
    /// The delay, if it is clear and there is no rival (s).
    #[must_use]
    pub(crate) fn told_s(&self) -> Option<f64> {
        (self.is_clear && self.rival_s.is_none()).then_some(self.delay_s)
    }

    /// What the user should know of it, if it is clear.
    pub(crate) fn finding(&self) -> Option<Finding> {
        let Self { delay_s, error_s, is_clear, rival_s, speed_m_per_s } = *self;
        let which = |delay_s: f64| if delay_s > 0.0 { "late" } else { "early" };
        let or = rival_s.map_or_else(String::new, |rival_s| {
            format!(", or {:.2} s {}, which explains about as much", rival_s.abs(), which(rival_s))
        });
        is_clear.then(|| Finding {
            check: "clock-offset",
            odd: format!(
                "the times of the packets seem to be {:.2} ± {:.2} s {} by the clock of the path{or}",
                delay_s.abs(),
                2.0 * error_s,
                which(delay_s)
            ),
            cost: format!(
                "at {speed_m_per_s:.2} m/s the robot is taken to be {:.1} m from where it heard them, and nodes are misplaced \
                 by up to as much",
                delay_s.abs() * speed_m_per_s
            ),
            remedy: match rival_s {
                None => format!("`packet_delay=auto` takes it off, as does `packet_delay={delay_s:.2}`"),
                Some(rival_s) => format!(
                    "`packet_delay={delay_s:.2}` or `packet_delay={rival_s:.2}` takes it off; compare the clocks to know which"
                ),
            },
        })
    }
}

/// What tells a delay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sense {
    /// The strengths of packets.
    Strengths,
    /// Which packets were heard.
    Presence,
}

/// The delay of the packets `samples` by the clock of `paths`, which are by robot. `None` if there are too few packets, or no
/// delay in the range of the search is best.
pub(crate) fn offset(samples: &Samples, paths: &[&Path]) -> Option<ClockOffset> {
    estimate(samples, paths).map(|(offset, _)| offset)
}

/// The same, and what told it.
pub(super) fn estimate(samples: &Samples, paths: &[&Path]) -> Option<(ClockOffset, Sense)> {
    let speed_m_per_s = usual_speed(paths)?;
    let extent_m = extent_m(paths.iter().flat_map(|path| path.poses()).map(|pose| pose.position));
    let step_s = STEP_M.max(STEP_SHARE * extent_m) / speed_m_per_s;
    let span_s = paths.iter().map(|path| seconds(path.span().1) - seconds(path.span().0)).fold(0.0, f64::max);
    let routes: Vec<Route<'_>> = paths.iter().map(|path| Route::new(path)).collect();
    let background = background(&routes);
    let tracks = || samples.nodes().map(|packets| PacketTrack::of(packets, &routes, &background));
    let mut tracks: Vec<PacketTrack<'_>> = tracks().flatten().collect();
    // One antenna for all: decibels of strengths, or shares of packets.
    let strong = tracks.iter().filter(|track| track.has_strengths()).count();
    let has_strengths = 2 * strong >= tracks.len();
    tracks.retain(|track| track.has_strengths() == has_strengths);
    // Of short paths, only small delays leave the packets on the path.
    let covers = |track: &PacketTrack<'_>, steps: f64| {
        [-steps - 2.0, steps + 2.0].iter().all(|steps| track.observations(steps * step_s).is_some())
    };
    let is_wide = |steps: &f64| {
        let covered = tracks.iter().filter(|track| covers(track, *steps)).count();
        steps * step_s <= LONGEST * span_s && covered as f64 >= COVERED * tracks.len() as f64
    };
    let most = STEPS.into_iter().find(is_wide)?;
    tracks.retain(|track| covers(track, most));
    if tracks.iter().map(|track| track.packets.len()).sum::<usize>() < LEAST {
        return None;
    }
    let coarse: Vec<f64> = (-100..=100).map(f64::from).filter(|step: &f64| step.abs() <= most).collect();
    let coarse: Vec<f64> = coarse.into_iter().map(|step| step * step_s).collect();
    let first = profile(&tracks, &coarse);
    let dips = dips(&coarse, &sums(&first));
    let best = *dips.first()?;
    let rival_s = dips.get(1).map(|&at| coarse[at]).filter(|rival_s| rival_s.abs() <= RIVAL * coarse[best].abs());
    let fine_s = step_s / f64::from(FINE);
    let around = |middle_s: f64| {
        let fine: Vec<f64> = (-2 * FINE..=2 * FINE).map(|step| middle_s + f64::from(step) * fine_s).collect();
        let second = profile(&tracks, &fine);
        let totals = sums(&second);
        let at = least(&totals)?;
        Some((fine, second, totals, at))
    };
    let is_inside = |(fine, _, _, at): &(Vec<f64>, _, _, usize)| *at > 0 && at + 1 < fine.len();
    // The least may lie beside the best of the coarse steps.
    let mut found = around(coarse[best])?;
    for _ in 0..MOVES {
        if is_inside(&found) {
            break;
        }
        found = around(found.0[found.3])?;
    }
    let (fine, second, totals, at) = Some(found).filter(is_inside)?;
    let delay_s = fine[at] + fine_s * vertex([totals[at - 1], totals[at], totals[at + 1]]);
    // Slopes over a step of the robot, which is smoother than the finest steps.
    let (low, high) = (at.saturating_sub(2), (at + 2).min(fine.len() - 1));
    let width_s = fine[high] - fine[low];
    let curvature = (totals[high] - 2.0 * totals[at] + totals[low]) / (0.5 * width_s).powi(2);
    let slopes = second[high].losses.iter().zip(&second[low].losses).map(|(high, low)| (high - low) / width_s);
    let mean = (totals[high] - totals[low]) / width_s / second[low].losses.len() as f64;
    let spread: f64 = slopes.map(|slope| (slope - mean) * (slope - mean)).sum();
    if !(curvature > 0.0 && curvature.is_finite()) {
        return None;
    }
    let of_body_m = if has_strengths { PATTERN_M * second[at].pattern.norm() } else { BODY_M };
    let of_body_s = of_body_m / speed_m_per_s;
    let error_s = libm::hypot(libm::hypot(spread.sqrt() / curvature, 0.1 * fine_s), of_body_s);
    let none = profile(&tracks, &[0.0]);
    let gains: Vec<f64> = none[0].losses.iter().zip(&second[at].losses).map(|(none, best)| none - best).collect();
    let gain: f64 = gains.iter().sum();
    let usual = gain / gains.len() as f64;
    let doubt = gains.iter().map(|gain| (gain - usual) * (gain - usual)).sum::<f64>().sqrt();
    let is_clear =
        delay_s.abs() > CLEAR * error_s && gain > GAIN * doubt && delay_s.abs() * speed_m_per_s > NOTABLE_M;
    let sense = if has_strengths { Sense::Strengths } else { Sense::Presence };
    Some((ClockOffset { delay_s, error_s, is_clear, rival_s, speed_m_per_s }, sense))
}

/// The sums of the losses at each delay.
fn sums(profile: &[AtDelay]) -> Vec<f64> {
    profile.iter().map(|at| at.losses.iter().sum()).collect()
}

/// The index of the least value.
fn least(values: &[f64]) -> Option<usize> {
    values.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map(|(at, _)| at)
}

/// The dips of `losses` that are nearly as deep as the deepest, from the one whose delay is nearest to 0: a robot on lanes to and
/// fro that is late by a whole lane is at the mirror images of its places, which explain as much. Where losses only begin to fall
/// at the ends, there is no dip.
fn dips(delays_s: &[f64], losses: &[f64]) -> Vec<usize> {
    let is_least = |&at: &usize| {
        let mut near = (at - BESIDE..=at + BESIDE).filter(|&other| other != at);
        near.all(|other| (losses[at], at) < (losses[other], other))
    };
    let mut dips: Vec<usize> = (BESIDE..losses.len().saturating_sub(BESIDE)).filter(is_least).collect();
    let mut sorted = losses.to_vec();
    sorted.sort_by(f64::total_cmp);
    let lowest = dips.iter().map(|&at| losses[at]).fold(f64::INFINITY, f64::min);
    let deep = sorted.get(sorted.len() / 2).map_or(lowest, |middle| middle - DEEP * (middle - lowest));
    dips.retain(|&at| losses[at] <= deep);
    dips.sort_by(|&a, &b| delays_s[a].abs().total_cmp(&delays_s[b].abs()));
    dips
}

/// Where the parabola through three neighbouring values has its vertex, in steps from the middle one.
fn vertex([left, middle, right]: [f64; 3]) -> f64 {
    let bend = left - 2.0 * middle + right;
    if bend > 0.0 { (0.5 * (left - right) / bend).clamp(-0.5, 0.5) } else { 0.0 }
}

fn seconds(time: SimTime) -> f64 {
    time.as_secs_f64()
}

/// The median speed of moving robots, over time (m/s); `None` if none moves.
fn usual_speed(paths: &[&Path]) -> Option<f64> {
    let legs = paths.iter().flat_map(|path| path.poses().windows(2));
    let mut speeds: Vec<(f64, f64)> = legs
        .map(|leg| {
            let span_s = leg[1].time.saturating_since(leg[0].time).as_secs_f64();
            (plane_m(leg[0].position, leg[1].position) / span_s, span_s)
        })
        .filter(|(speed, _)| *speed > 0.0)
        .collect();
    let fastest = speeds.iter().map(|(speed, _)| *speed).fold(0.0, f64::max);
    speeds.retain(|(speed, _)| *speed > 0.02 * fastest);
    speeds.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total_s: f64 = speeds.iter().map(|(_, span_s)| span_s).sum();
    let mut passed_s = 0.0;
    let middle = speeds.iter().find(|(_, span_s)| {
        passed_s += span_s;
        2.0 * passed_s >= total_s
    });
    middle.map(|(speed, _)| *speed)
}
