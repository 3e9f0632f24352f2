//! What a mission worked out, compared with the truth.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{SimTime, StationId};
use sextant_mapper::PositionError;
use sextant_sim::{Estimate, TargetId};

use crate::measure::Placement;
use crate::run::witness::Witness;
use crate::summary::{ErrorSummary, SEARCH_INSTANTS_S, SearchInstant};

/// Time between two values of the distance to the nearest target.
const STEP: Duration = Duration::from_secs(1);
/// Largest number of these values of a robot.
const MOST: u32 = 20_000;

/// An estimate beside the truth.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::run) struct Scored {
    pub(in crate::run) time: SimTime,
    pub(in crate::run) station: StationId,
    pub(in crate::run) estimate: Estimate,
    /// The place in the world that the estimated place stands for (m), if it is a place.
    pub(in crate::run) place: Option<Position>,
    /// Distance from the true place (m), or the estimated value less the true one; `None` if there is no truth: a target is
    /// gone, or the station does not move.
    pub(in crate::run) error: Option<f64>,
    /// The true value, if the estimate is of one.
    pub(in crate::run) truth: Option<f64>,
}

/// Compares all estimates of a mission with `nodes` nodes with the truth.
pub(super) fn score(witness: &Witness, nodes: usize, placement: &Placement) -> Vec<Scored> {
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

/// The course of a search of this duration that ended at `end`, with all targets captured if `captured`.
pub(super) fn course(
    witness: &Witness,
    scored: &[Scored],
    duration: Duration,
    end: SimTime,
    captured: bool,
) -> Vec<SearchInstant> {
    let instants = SEARCH_INSTANTS_S.map(|time_s| SimTime::ZERO + Duration::from_secs(u64::from(time_s)));
    let mut previous = SimTime::ZERO;
    let mut course = Vec::new();
    for time in instants {
        let since = |scored: &&Scored| previous < scored.time && scored.time <= time;
        let of_targets = scored.iter().filter(since);
        let of_targets = of_targets.filter(|scored| matches!(scored.estimate, Estimate::TargetPlace { .. }));
        let errors_m: Vec<f64> = of_targets.filter_map(|scored| scored.error).collect();
        let to_targets = || (0..witness.robots.len()).filter_map(|robot| nearest_m(witness, robot, time));
        let distance_m = if time <= end { to_targets().min_by(f64::total_cmp) } else { None };
        let all_captured = captured && time >= end && time - SimTime::ZERO <= duration;
        course.push(SearchInstant {
            distance_to_target_m: if all_captured { Some(0.0) } else { distance_m },
            prediction_error_m: (!errors_m.is_empty()).then(|| errors_m.iter().sum::<f64>() / errors_m.len() as f64),
        });
        previous = time;
    }
    course
}

/// Distance of a robot to the nearest target that is still there (m).
fn nearest_m(witness: &Witness, robot: usize, time: SimTime) -> Option<f64> {
    let own = witness.robot_at(robot, time)?;
    let targets = (0..witness.targets.len()).filter_map(|target| u16::try_from(target).ok().map(TargetId));
    let there = targets.filter_map(|target| witness.target_at(target, time));
    there.map(|there| there.distance_m(own)).min_by(f64::total_cmp)
}

/// Distance of a robot to the nearest target that is still there, each second and whenever a target is gone (m).
pub(in crate::run) fn distances_to_target(witness: &Witness, robot: usize, end: SimTime) -> Vec<(SimTime, f64)> {
    let span = end - SimTime::ZERO;
    let step = STEP.max(span / MOST);
    let mut times: Vec<SimTime> =
        (0..=MOST).map(|i| SimTime::ZERO + step * i).take_while(|&time| time <= end).collect();
    times.extend(witness.gone.iter().flatten());
    times.sort_unstable();
    times.dedup();
    times.iter().filter_map(|&time| Some((time, nearest_m(witness, robot, time)?))).collect()
}
