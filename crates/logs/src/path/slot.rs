//! A path cut into slots: each is a stop of the log.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;

use super::robot_path::{Path, Pose, between, later};
use crate::error::robot_log_error::RobotLogError;
use crate::options::read_options::StopRule;

/// A part of a path: a stop of the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slot {
    /// When it begins.
    pub(crate) start: SimTime,
    /// When it ends; not part of it.
    pub(crate) end: SimTime,
    /// The mean place over its time (m).
    pub(crate) position: Position,
}

/// A leg is not cut this close to its end: by rounding, the last slot would be nothing but an instant.
const SLIVER: Duration = Duration::from_micros(1);

/// Cuts `path` by `rule`; returns the slots in the order of time, and the rule that was used. `None` if there would be
/// more than [`RobotLogError::MOST_STOPS`].
pub(crate) fn cut(path: &Path, rule: StopRule) -> Option<(Vec<Slot>, StopRule)> {
    if rule != StopRule::Automatic {
        return cut_by(path, rule, RobotLogError::MOST_STOPS).map(|slots| (slots, rule));
    }
    let ladder = (0..).flat_map(|decade| [0.5, 1.0, 2.0].map(|step| step * 10_f64.powi(decade)));
    // Pieces between gaps have a slot each, however long the distance is.
    let most = StopRule::USUAL.max(2 * path.pieces().count());
    let cuts = ladder.map(StopRule::Distance).map(|rule| Some((cut_by(path, rule, most)?, rule)));
    cuts.take(30).find(Option::is_some).flatten()
}

fn cut_by(path: &Path, rule: StopRule, most: usize) -> Option<Vec<Slot>> {
    let mut slots = Vec::new();
    for piece in path.pieces() {
        cut_piece(piece, rule, most, &mut slots)?;
    }
    Some(slots)
}

/// Adds the slots of a piece without gaps to `slots`.
fn cut_piece(piece: &[Pose], rule: StopRule, most: usize, slots: &mut Vec<Slot>) -> Option<()> {
    let mut open = Open::at(piece[0]);
    for leg in piece.windows(2) {
        let mut from = leg[0];
        while let Some(cut) = open.end_on(from, leg[1], rule) {
            open.drive(from, cut);
            slots.push(open.close(cut.time));
            if slots.len() > most {
                return None;
            }
            open = Open::at(cut);
            from = cut;
        }
        open.drive(from, leg[1]);
    }
    // The last instant belongs to the path too.
    let end = piece[piece.len() - 1].time;
    let is_new = open.start.time < end || slots.last().is_none_or(|slot| slot.end < end);
    if is_new {
        slots.push(open.close(later(end, Duration::from_nanos(1))));
    } else if let Some(last) = slots.last_mut() {
        last.end = later(end, Duration::from_nanos(1));
    }
    Some(())
}

/// A slot that has not ended.
struct Open {
    start: Pose,
    /// Places times seconds (m s), relative to the start.
    sum: Position,
    /// Seconds so far.
    span_s: f64,
}

impl Open {
    fn at(start: Pose) -> Self {
        Self { start, sum: Position::ORIGIN, span_s: 0.0 }
    }

    /// Adds the way from `from` to `to`.
    fn drive(&mut self, from: Pose, to: Pose) {
        let span_s = to.time.saturating_since(from.time).as_secs_f64();
        let middle = (from.position - self.start.position) * 0.5 + (to.position - self.start.position) * 0.5;
        self.sum = self.sum + middle * span_s;
        self.span_s += span_s;
    }

    /// Where the slot ends between `from` and `to`, if it does.
    fn end_on(&self, from: Pose, to: Pose, rule: StopRule) -> Option<Pose> {
        let span_ns = to.time.as_nanos() - from.time.as_nanos();
        let end = match rule {
            StopRule::Time(span) => later(self.start.time, span),
            StopRule::Distance(distance_m) => {
                let share = leaves(from.position - self.start.position, to.position - from.position, distance_m)?;
                later(from.time, Duration::from_nanos(span_ns).mul_f64(share))
            }
            StopRule::Automatic => return None,
        };
        // A slot takes a nanosecond or more, however fast the robot is.
        let end = end.max(later(self.start.time, Duration::from_nanos(1)));
        let share = between(from.time, to.time, end);
        let position = from.position + (to.position - from.position) * share;
        (later(end, SLIVER) < to.time).then_some(Pose { time: end, position })
    }

    fn close(&self, end: SimTime) -> Slot {
        let offset = if self.span_s > 0.0 { self.sum * (1.0 / self.span_s) } else { Position::ORIGIN };
        Slot { start: self.start.time, end, position: self.start.position + offset }
    }
}

/// The share of `way` at which a place that starts at `offset` leaves the ball of this radius around zero; `None` if it
/// stays inside.
fn leaves(offset: Position, way: Position, radius_m: f64) -> Option<f64> {
    let (a, b, c) = (way.dot(way), offset.dot(way), offset.dot(offset) - radius_m * radius_m);
    if a <= 0.0 {
        return None;
    }
    let root = (b * b - a * c).max(0.0).sqrt();
    let share = ((root - b) / a).max(0.0);
    (share < 1.0).then_some(share)
}
