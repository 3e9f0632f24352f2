//! When a target on a leg crosses the rim of a disc.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;

use crate::world::target::Leg;

/// How a target on a leg passes a disc, or a ball in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Passage {
    /// When it enters, if it does.
    pub(super) entered: Option<SimTime>,
    /// When it leaves, if it does.
    pub(super) left: Option<SimTime>,
    pub(super) ends_inside: bool,
}

impl Passage {
    /// The passage through the disc of `radius_m` around `center`. `was_inside` is what the leg before it said at its
    /// end: rounding may say otherwise about a target that turns on the rim. A target that touches the rim without
    /// crossing it does not enter, and neither does one that leaves within the same nanosecond.
    pub(super) fn of(leg: &Leg, center: Position, radius_m: f64, was_inside: bool) -> Self {
        let (enters, leaves) = match shares_within(leg, center, radius_m) {
            Some((enters, leaves)) if enters < 1.0 && leaves > 0.0 => (enters, leaves),
            _ if was_inside => (0.0, 0.0),
            _ => return Self { entered: None, left: None, ends_inside: false },
        };
        let entered = (!was_inside).then(|| instant(leg, enters));
        let left = (leaves < 1.0).then(|| instant(leg, leaves));
        if entered.is_some() && entered == left {
            return Self { entered: None, left: None, ends_inside: false };
        }
        Self { entered, left, ends_inside: left.is_none() }
    }
}

/// The part of a leg that is within `radius_m` of `center`, as shares of the leg: 0 at its start, 1 at its end; they
/// may lie beyond. `None` if the line of the leg does not cross the rim.
fn shares_within(leg: &Leg, center: Position, radius_m: f64) -> Option<(f64, f64)> {
    let (step, to_center) = (leg.to - leg.from, center - leg.from);
    let length_m = step.length_m();
    if length_m <= 0.0 {
        return (to_center.length_m() < radius_m).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let ahead = step * (1.0 / length_m);
    let along_m = to_center.dot(ahead);
    // The distance from the line, and not |to_center|² - along², which cancels for a centre far away.
    let aside_m = (to_center - ahead * along_m).length_m();
    let half_m = ((radius_m - aside_m) * (radius_m + aside_m)).sqrt();
    (half_m > 0.0).then(|| ((along_m - half_m) / length_m, (along_m + half_m) / length_m))
}

/// The instant at which a share of a leg is done.
pub(super) fn instant(leg: &Leg, share: f64) -> SimTime {
    let span = leg.end - leg.start;
    leg.start + Duration::from_secs_f64(share.max(0.0) * span.as_secs_f64()).min(span)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From x = 0 to x = 10 along y = 0, from 100 s to 105 s.
    fn leg() -> Leg {
        let at = |seconds| SimTime::ZERO + Duration::from_secs(seconds);
        Leg { from: Position::ORIGIN, to: Position::new(10.0, 0.0, 0.0), start: at(100), end: at(105) }
    }

    fn passage(center: [f64; 3], radius_m: f64, was_inside: bool) -> (Option<f64>, Option<f64>, bool) {
        let Passage { entered, left, ends_inside } = Passage::of(&leg(), center.into(), radius_m, was_inside);
        (entered.map(SimTime::as_secs_f64), left.map(SimTime::as_secs_f64), ends_inside)
    }

    #[test]
    fn a_way_through_a_disc_enters_and_leaves_where_pythagoras_says() {
        // 3, 4, 5: the chord is from x = 5 - 4 to 5 + 4.
        assert_eq!(passage([5.0, 3.0, 0.0], 5.0, false), (Some(100.5), Some(104.5), false));
        assert_eq!(passage([5.0, 0.0, -3.0], 5.0, false), (Some(100.5), Some(104.5), false));
    }

    #[test]
    fn a_way_that_touches_the_rim_does_not_enter() {
        assert_eq!(passage([5.0, 5.0, 0.0], 5.0, false), (None, None, false));
        assert_eq!(passage([5.0, 5.1, 0.0], 5.0, false), (None, None, false));
    }

    #[test]
    fn a_way_that_starts_inside_enters_at_once() {
        assert_eq!(passage([0.0, 3.0, 0.0], 5.0, false), (Some(100.0), Some(102.0), false));
        assert_eq!(passage([0.0, 3.0, 0.0], 5.0, true), (None, Some(102.0), false));
    }

    #[test]
    fn a_way_that_ends_inside_stays_inside() {
        assert_eq!(passage([10.0, 3.0, 0.0], 5.0, false), (Some(103.0), None, true));
        assert_eq!(passage([5.0, 0.0, 0.0], 50.0, true), (None, None, true));
    }

    #[test]
    fn a_target_that_turns_on_the_rim_leaves_when_it_goes_outwards() {
        // The leg begins on the rim, and the one before it said that the target was still inside.
        assert_eq!(passage([-5.0, 0.0, 0.0], 5.0, true), (None, Some(100.0), false));
        assert_eq!(passage([-5.0, 0.0, 0.0], 5.0, false), (None, None, false));
        // Inwards.
        assert_eq!(passage([5.0, 0.0, 0.0], 5.0, false), (Some(100.0), None, true));
    }

    #[test]
    fn a_target_that_stands_is_inside_or_outside() {
        let here = Leg::standing(Position::ORIGIN, SimTime::from_nanos(7));
        let passage = |x, was_inside| Passage::of(&here, Position::new(x, 0.0, 0.0), 2.0, was_inside);
        let now = Some(SimTime::from_nanos(7));
        assert_eq!(passage(1.0, false), Passage { entered: now, left: None, ends_inside: true });
        assert_eq!(passage(1.0, true), Passage { entered: None, left: None, ends_inside: true });
        assert_eq!(passage(3.0, false), Passage { entered: None, left: None, ends_inside: false });
        assert_eq!(passage(3.0, true), Passage { entered: None, left: now, ends_inside: false });
    }
}
