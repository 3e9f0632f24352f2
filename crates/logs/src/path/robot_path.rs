//! The path of a robot over time.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;

use crate::error::path_error::PathError;
use crate::median::median_by;

/// Where a robot was at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// When.
    pub time: SimTime,
    /// Where (m).
    pub position: Position,
}

/// The path of one robot: straight lines between its poses.
///
/// Between two poses that are far apart in time the place is unknown if the robot moved meanwhile. Such a gap is longer
/// than [`GAP`](Self::GAP) and ten times the usual (median) time between two poses, and the robot moved by more than
/// [`STANDSTILL_M`](Self::STANDSTILL_M), or it is longer than [`REST`](Self::REST).
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// At least two, in increasing order of time.
    poses: Vec<Pose>,
    /// Indices of the poses before a gap, in increasing order.
    gaps: Vec<usize>,
    /// Poses that came later than a pose with a later time.
    late: usize,
}

/// A time span without a known place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gap {
    pub(crate) from: SimTime,
    pub(crate) to: SimTime,
}

impl Path {
    /// A pose may come this much later than a pose with a later time; poses are sorted.
    pub const JITTER: Duration = PathError::MOST_LATE;
    /// A gap is longer than this.
    pub const GAP: Duration = Duration::from_secs(2);
    /// A robot whose two poses are at most this far apart stood still between them (m).
    pub const STANDSTILL_M: f64 = 0.5;
    /// A robot may rest this long without a pose.
    pub const REST: Duration = Duration::from_mins(10);
    /// Two places at the same time may be this far apart (m); the later one counts.
    const SAME_PLACE_M: f64 = 1.0;

    /// The distance (m) and the time between two poses where the robot drives: half of its way is between poses that are at least as
    /// far apart. Gaps are left out. `None` if it never moved.
    pub(crate) fn usual_leg(&self) -> Option<(f64, Duration)> {
        let leg = |pair: &[Pose]| {
            (pair[0].position.distance_m(pair[1].position), pair[1].time.saturating_since(pair[0].time))
        };
        let mut legs: Vec<(f64, Duration)> = self.pieces().flat_map(|piece| piece.windows(2)).map(leg).collect();
        legs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let whole_m: f64 = legs.iter().map(|(length_m, _)| length_m).sum();
        let mut passed_m = 0.0;
        legs.into_iter().filter(|(length_m, _)| *length_m > 0.0).find(|(length_m, _)| {
            passed_m += length_m;
            2.0 * passed_m >= whole_m
        })
    }

    /// The path through `poses`.
    ///
    /// # Errors
    /// If there are fewer than two poses, a place is not finite, the time goes back by more than
    /// [`JITTER`](Self::JITTER), or two poses at the same time are in different places.
    pub fn new(poses: Vec<Pose>) -> Result<Self, PathError> {
        let mut latest = SimTime::ZERO;
        let mut late = 0;
        for (index, &Pose { time, position }) in poses.iter().enumerate() {
            if !position.is_within_reason() {
                return Err(PathError::NotFinite { index, position });
            }
            if latest.saturating_since(time) > Self::JITTER {
                return Err(PathError::Backwards { index, from: latest, to: time });
            }
            late += usize::from(time < latest);
            latest = latest.max(time);
        }
        let mut order: Vec<usize> = (0..poses.len()).collect();
        order.sort_by_key(|&index| poses[index].time);
        let mut sorted: Vec<Pose> = Vec::with_capacity(poses.len());
        for index in order {
            let pose = poses[index];
            match sorted.last_mut() {
                Some(last) if last.time == pose.time => {
                    let distance_m = last.position.distance_m(pose.position);
                    if distance_m > Self::SAME_PLACE_M {
                        return Err(PathError::TwoPlaces { index, time: pose.time, distance_m });
                    }
                    *last = pose;
                }
                _ => sorted.push(pose),
            }
        }
        if sorted.len() < 2 {
            return Err(PathError::TooFew { poses: sorted.len() });
        }
        let gaps = gaps(&sorted);
        Ok(Self { poses: sorted, gaps, late })
    }

    /// Where the robot was at a time; `None` outside of the path and in a gap.
    #[must_use]
    pub fn at(&self, time: SimTime) -> Option<Position> {
        let after = self.poses.partition_point(|pose| pose.time <= time);
        let before = &self.poses[after.checked_sub(1)?];
        if before.time == time {
            return Some(before.position);
        }
        let next = self.poses.get(after)?;
        if self.gaps.binary_search(&(after - 1)).is_ok() {
            return None;
        }
        let share = between(before.time, next.time, time);
        Some(before.position + (next.position - before.position) * share)
    }

    /// How fast the robot drives at a time (m/s): over half a second, less at the ends of its path.
    pub(crate) fn velocity_m_per_s(&self, time: SimTime) -> Position {
        const SPAN: Duration = Duration::from_millis(250);
        let (start, end) = self.span();
        let span_ns = u64::try_from(SPAN.as_nanos()).unwrap_or(0);
        let from = SimTime::from_nanos(time.as_nanos().saturating_sub(span_ns)).max(start);
        let to = later(time, SPAN).min(end);
        let span_s = to.saturating_since(from).as_secs_f64();
        match (self.at(from), self.at(to)) {
            (Some(before), Some(after)) if span_s > 0.0 => (after - before) * (1.0 / span_s),
            _ => Position::ORIGIN,
        }
    }

    /// The first and the last time.
    #[must_use]
    pub fn span(&self) -> (SimTime, SimTime) {
        (self.poses[0].time, self.poses[self.poses.len() - 1].time)
    }

    /// The poses in the order of time, at least two.
    #[must_use]
    pub fn poses(&self) -> &[Pose] {
        &self.poses
    }

    /// The parts of the path between gaps.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = &[Pose]> {
        let starts = std::iter::once(0).chain(self.gaps.iter().map(|before| before + 1));
        let ends = self.gaps.iter().map(|before| before + 1).chain([self.poses.len()]);
        starts.zip(ends).map(|(start, end)| &self.poses[start..end])
    }

    /// The gaps.
    pub(crate) fn gaps(&self) -> impl Iterator<Item = Gap> {
        self.gaps.iter().map(|&before| Gap { from: self.poses[before].time, to: self.poses[before + 1].time })
    }

    /// Number of poses that came later than a pose with a later time.
    pub(crate) fn late(&self) -> usize {
        self.late
    }
}

/// The time from the start of the first of `paths` to the end of the last.
pub(crate) fn span_of<'a>(paths: impl Iterator<Item = &'a Path> + Clone) -> (SimTime, SimTime) {
    let start = paths.clone().map(|path| path.span().0).min();
    let end = paths.map(|path| path.span().1).max();
    (start.unwrap_or_default(), end.unwrap_or_default())
}

/// The instant a span after another one, or the last instant that there is.
pub(crate) fn later(time: SimTime, span: Duration) -> SimTime {
    let span_ns = u64::try_from(span.as_nanos()).unwrap_or(u64::MAX);
    SimTime::from_nanos(time.as_nanos().saturating_add(span_ns))
}

/// The share of the span from `from` to `to` that has passed at `time`.
pub(crate) fn between(from: SimTime, to: SimTime, time: SimTime) -> f64 {
    time.saturating_since(from).as_secs_f64() / to.saturating_since(from).as_secs_f64()
}

/// Indices of the poses before a gap.
fn gaps(poses: &[Pose]) -> Vec<usize> {
    let span = |pair: &[Pose]| pair[1].time.saturating_since(pair[0].time);
    let mut spans: Vec<Duration> = poses.windows(2).map(span).collect();
    let Some(usual) = median_by(&mut spans, Ord::cmp) else { return Vec::new() };
    let longest = Path::GAP.max(usual.saturating_mul(10));
    let is_gap = |pair: &[Pose]| {
        let moved_m = pair[0].position.distance_m(pair[1].position);
        span(pair) > longest && (moved_m > Path::STANDSTILL_M || span(pair) > Path::REST)
    };
    poses.windows(2).enumerate().filter(|(_, pair)| is_gap(pair)).map(|(before, _)| before).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A robot with a pose every `step_s` that drives at 0.5 m/s, but for what `place` changes.
    fn path(step_s: f64, count: u32, place: impl Fn(f64) -> f64) -> Path {
        let pose = |i: u32| {
            let time_s = step_s * f64::from(i);
            let time = crate::time::instant::shifted(SimTime::ZERO, time_s).unwrap();
            Pose { time, position: Position::new(place(time_s), 0.0, 0.0) }
        };
        Path::new((0..count).map(pose).collect()).unwrap()
    }

    #[test]
    fn the_usual_leg_is_that_of_most_of_the_way() {
        let of = |path: Path| path.usual_leg().unwrap();
        let (length_m, span) = of(path(0.2, 400, |time_s| 0.5 * time_s));
        assert!((length_m - 0.1).abs() < 1e-9 && span == Duration::from_millis(200), "{length_m} {span:?}");
        // One jump of 8 m.
        let (length_m, _) = of(path(0.2, 400, |time_s| 0.5 * time_s + if time_s > 30.0 { 8.0 } else { 0.0 }));
        assert!(length_m < 0.11, "{length_m}");
        // A gap of a minute.
        let dense = path(0.2, 100, |time_s| 0.5 * time_s);
        let last = dense.poses()[99];
        let after = |i: u64| Pose {
            time: later(last.time, Duration::from_secs(60) + Duration::from_millis(200 * i)),
            position: last.position + Position::new(30.0 + 0.1 * i as f64, 0.0, 0.0),
        };
        let (length_m, _) = of(Path::new(dense.poses().iter().copied().chain((0..9).map(after)).collect()).unwrap());
        assert!(length_m < 0.11, "{length_m}");
        // A robot that stands most of the time, with a pose a minute where it drives.
        let (length_m, span) =
            of(path(60.0, 40, |time_s| if time_s < 1200.0 { 0.0 } else { 0.5 * (time_s - 1200.0) }));
        assert!((length_m - 30.0).abs() < 1e-9 && span == Duration::from_mins(1), "{length_m}");
    }
}
