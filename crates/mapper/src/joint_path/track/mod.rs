//! The way of a moving tag among receivers whose places are known.

mod check;
mod driven;
mod epochs;
mod exponent;
mod heights;
mod moments;
mod motion;
mod outcome;
mod problem;
mod reading;
mod regions;
mod report;
mod search;
mod side;
mod start;
mod strengths;

use sextant_channel::Position;
use sextant_kernel::Watch;

use super::PathError;
use crate::error::MapError;
use check::Check;
use epochs::Epochs;
use heights::Knots;
use outcome::tracked;
use problem::Calibration;
pub use reading::{OnRobot, TagReading, TagValue};
pub use report::{
    DoubtedReceiver, PlaceUnit, RangeFault, Track, TrackFit, TrackHeight, TrackMotion, TrackPose, TrackRangeLaw,
    TrackStrengthLaw,
};
use search::Search;
use side::Line;

/// What is known of the calibration where the tag is among the receivers, and where it is beside them: there a bias moves the whole
/// track, and nothing tells it.
const AMONG: Calibration = Calibration { bias_m: 3.0, scale: 0.05, receiver_bias_m: 0.2 };
const BESIDE: Calibration = Calibration { bias_m: 0.05, scale: 0.003, receiver_bias_m: 0.03 };

/// What is known of a tag.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrackSettings {
    /// Its height (m). If absent, it is estimated where the receivers have different heights, and is theirs otherwise.
    pub height_m: Option<f64>,
    /// A place (m) on that side of a line of receivers on which it is.
    pub side: Option<[f64; 2]>,
    /// How wrong odometry is, where there is some.
    pub odometry: PathError,
}

/// The track of a tag from `readings` between it and `receivers` at known places (m), in the plane: ranges, or strengths, or both.
///
/// Without odometry, the tag moves with an acceleration that is white noise, whose strength the marginal likelihood chooses. With
/// odometry, the robot that carries it moves as that says, but for scale, drift and noise. Track, law of ranges, law of strengths and
/// height are one problem. The law of errors of ranges is that of [`RangeErrorLaw`](sextant_channel::RangeErrorLaw), and strengths fall with the logarithm of the
/// distance, with errors of Student's law. Each is raised to one over its autocorrelation time.
///
/// # Errors
/// If there are fewer than three receivers, too few readings, a side is given of receivers that are not on a line, some readings have
/// odometry and others have not, or `watch` ends the work.
pub fn track(
    receivers: &[Position],
    readings: &[TagReading],
    settings: TrackSettings,
    watch: &dyn Watch,
) -> Result<Track, MapError> {
    let found = tracked_as_given(receivers, readings, settings, Sought::AnyHeight, watch)?;
    let fault = Check { found: &found, receivers, readings, settings, watch }.fault()?;
    Ok(Track { fault, ..found })
}

/// Which heights of a tag are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sought {
    AnyHeight,
    ConstantHeight,
}

/// The track, with ranges taken as metres.
fn tracked_as_given(
    receivers: &[Position],
    readings: &[TagReading],
    settings: TrackSettings,
    sought: Sought,
    watch: &dyn Watch,
) -> Result<Track, MapError> {
    let heard: Vec<Position> = (0..receivers.len())
        .filter(|&receiver| readings.iter().any(|reading| reading.receiver == receiver))
        .map(|receiver| receivers[receiver])
        .collect();
    let line = Line::of(&heard, settings.side);
    if settings.side.is_some() && line.is_none() {
        return Err(MapError::Missing {
            algorithm: "track",
            what: "receivers on a straight line for a side of it",
            remedy: "the receivers that were heard are not on a line, so that they tell the side themselves",
        });
    }
    let is_driven = readings.iter().any(|reading| reading.on_robot.is_some());
    if is_driven && readings.iter().any(|reading| reading.on_robot.is_none()) {
        return Err(MapError::Missing {
            algorithm: "track",
            what: "odometry for all readings",
            remedy: "leave out the readings from outside of the path",
        });
    }
    let missing = MapError::Missing {
        algorithm: "track",
        what: "ranges to three receivers with known places within two seconds, or strengths",
        remedy: "`ranges.csv` has the ranges, `packets.csv` the strengths, each with its time, and option `known` the places",
    };
    let epochs = Epochs::of(readings);
    let height_m = heights::prior_m(receivers, settings.height_m);
    let needed = if is_driven { 2 } else { 3 };
    if heard.len() < needed {
        return Err(MapError::TooFewReceivers { found: heard.len(), needed });
    }
    let start = match epochs.start(receivers, height_m[0], line.as_ref()) {
        Some(start) => start,
        None if is_driven && epochs.times_s.len() >= 3 => epochs.around_middle(&heard),
        None => return Err(missing),
    };
    let (steps_s, legs) = (epochs.steps_s(), epochs.legs());
    let firsts: Vec<(usize, [f64; 2])> =
        epochs.believed.first().map(|first| (0, [first.x_m, first.y_m])).into_iter().collect();
    let search = Search {
        receivers,
        epochs: &epochs,
        start: &start,
        steps_s: &steps_s,
        legs: &legs,
        firsts: &firsts,
        line: line.as_ref(),
        height_m,
        settings,
        watch,
    };
    let knots = Knots::of(&epochs.times_s);
    let Some(found) = search.of_most_likely_height(&knots, sought)? else { return Err(missing) };
    let may_be_mirrored = line.is_some() && settings.side.is_none() && !is_driven;
    Ok(tracked(&epochs, &found, settings.height_m.is_some(), may_be_mirrored))
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_in_space;
