//! What an application worked out, compared with the truth.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{SimTime, StationId};
use sextant_mapper::PositionError;
use sextant_sim::{Estimate, TargetId};

use crate::measure::Placement;
use crate::run::witness::Witness;
use crate::summary::ErrorSummary;

/// Time between two values of the distance to the nearest target.
const STEP: Duration = Duration::from_secs(1);
/// Largest number of these values of a robot.
const MOST: u32 = 20_000;

/// An estimate beside the truth.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scored {
    pub(super) time: SimTime,
    pub(super) station: StationId,
    pub(super) estimate: Estimate,
    /// The place in the world that the estimated place stands for (m), if it is a place.
    pub(super) place: Option<Position>,
    /// Distance from the true place (m), or the estimated value less the true one; `None` if there is no truth: a target is
    /// gone, or the station does not move.
    pub(super) error: Option<f64>,
    /// The true value, if the estimate is of one.
    pub(super) truth: Option<f64>,
}

/// Compares all estimates of an application with `nodes` nodes with the truth.
pub(super) fn score(witness: &Witness<'_>, nodes: usize, placement: &Placement) -> Vec<Scored> {
    let scored = |&(station, time, estimate): &(StationId, SimTime, Estimate)| {
        let robot = station.index().checked_sub(nodes).filter(|&robot| robot < witness.robots.len());
        let own = robot.and_then(|robot| witness.robot_at(robot, time));
        let (place, error, truth) = match estimate {
            Estimate::OwnPlace(place) => {
                let place = placement.in_world(place);
                (Some(place), own.map(|own| own.distance_m(place)), None)
            }
            Estimate::TargetPlace { target, place } => {
                let place = placement.in_world(place);
                let there = witness.target_at(target, time);
                (Some(place), there.map(|there| there.distance_m(place)), None)
            }
            Estimate::FieldValue { field, value } => {
                let truth = own.map(|own| witness.fields[field.index()].value(own, time));
                (None, truth.map(|truth| value - truth), truth)
            }
        };
        Scored { time, station, estimate, place, error, truth }
    };
    witness.estimates.iter().map(scored).collect()
}

/// Statistics of the absolute errors of the estimates that `is_one` chooses.
pub(super) fn errors(scored: &[Scored], is_one: impl Fn(&Estimate) -> bool) -> Option<ErrorSummary> {
    let chosen = scored.iter().filter(|scored| is_one(&scored.estimate));
    let errors: Vec<f64> = chosen.filter_map(|scored| scored.error.map(f64::abs)).collect();
    PositionError::of(&errors).map(ErrorSummary::from)
}

/// Distance of a robot to the nearest target that is still there, each second and whenever a target is gone (m).
pub(super) fn distances_to_target(witness: &Witness<'_>, robot: usize, end: SimTime) -> Vec<(SimTime, f64)> {
    let span = end - SimTime::ZERO;
    let step = STEP.max(span / MOST);
    let mut times: Vec<SimTime> =
        (0..=MOST).map(|i| SimTime::ZERO + step * i).take_while(|&time| time <= end).collect();
    times.extend(witness.gone.iter().flatten());
    times.sort_unstable();
    times.dedup();
    let nearest_m = |&time: &SimTime| {
        let own = witness.robot_at(robot, time)?;
        let targets = (0..witness.targets.len()).filter_map(|target| u16::try_from(target).ok().map(TargetId));
        let there = targets.filter_map(|target| witness.target_at(target, time));
        Some((time, there.map(|there| there.distance_m(own)).min_by(f64::total_cmp)?))
    };
    times.iter().filter_map(nearest_m).collect()
}
