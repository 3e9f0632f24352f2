//! How well an estimator maps a log whose nodes have known places.

use std::time::Instant;

use serde::Serialize;
use sextant_channel::Position;
use sextant_kernel::Unwatched;
use sextant_mapper::{Choice, EstimatorFindings, MapError, Mapper, PositionError, Region};

use crate::laws::KnownLog;

/// The map of a log, measured.
#[derive(Clone, Debug, Serialize)]
pub struct Measured {
    /// Errors seen from above (m).
    pub in_plane_m: PositionError,
    /// Errors in space (m).
    pub in_space_m: PositionError,
    /// Nodes whose true place is in their 95 % region.
    pub held: usize,
    /// Nodes with a 95 % region.
    pub regions: usize,
    /// Median over these of the longer half axis seen from above (m).
    pub half_axis_m: Option<f64>,
    /// Nodes whose place is not reliable by the estimator's own account.
    pub concerns: usize,
    /// The estimator that was chosen, if this one chooses.
    pub chosen: Option<String>,
    /// Time that the map took (s), on a machine that may do other work.
    pub seconds: f64,
}

#[expect(clippy::disallowed_methods, reason = "a stopwatch")]
fn now() -> Instant {
    Instant::now()
}

/// Maps the log and compares it with the truth; `None` if the log lacks what the estimator needs, or no node of known place
/// was mapped.
///
/// # Errors
/// If the map cannot be computed for another reason.
pub fn measure(mapper: &Mapper, known: &KnownLog) -> Result<Option<Measured>, MapError> {
    let start = now();
    let (map, learned) = match mapper.map_and_learn(&known.log, &Unwatched) {
        Err(MapError::Missing { .. }) => return Ok(None),
        mapped => mapped?,
    };
    let seconds = start.elapsed().as_secs_f64();
    let pairs = || {
        let both = map.estimates.iter().zip(&known.truth);
        both.filter_map(|(estimate, place)| Some((estimate.as_ref()?, (*place)?)))
    };
    let flat = |place: Position| Position::new(place.x_m, place.y_m, 0.0);
    let errors_m = |seen: &dyn Fn(Position) -> Position| {
        let errors: Vec<f64> =
            pairs().map(|(estimate, place)| seen(estimate.position).distance_m(seen(place))).collect();
        PositionError::of(&errors)
    };
    let (Some(in_plane_m), Some(in_space_m)) = (errors_m(&flat), errors_m(&|place| place)) else { return Ok(None) };
    let with_regions =
        || pairs().filter_map(|(estimate, place)| Some((Region::of_95(estimate)?, estimate.position, place)));
    let held: Vec<bool> = with_regions().map(|(region, _, place)| region.contains(place)).collect();
    let mut axes_m: Vec<f64> = with_regions().map(|(region, middle, _)| half_axis_m(&region, middle)).collect();
    axes_m.sort_by(f64::total_cmp);
    let chosen = learned.as_ref().and_then(EstimatorFindings::get::<Choice>).map(|choice| choice.chosen.to_owned());
    Ok(Some(Measured {
        in_plane_m,
        in_space_m,
        held: held.iter().filter(|held| **held).count(),
        regions: held.len(),
        half_axis_m: axes_m.get(axes_m.len() / 2).copied(),
        concerns: map.concerns().count(),
        chosen,
        seconds,
    }))
}

/// The longer half axis of a region round `middle`, seen from above (m).
fn half_axis_m(region: &Region, middle: Position) -> f64 {
    let outline = region.outline([0, 1], 72);
    outline.iter().map(|[x_m, y_m]| libm::hypot(x_m - middle.x_m, y_m - middle.y_m)).fold(0.0, f64::max)
}

/// The geometric mean; `None` of no values. Values below a millimetre count as one.
#[must_use]
pub fn geometric_mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, count) =
        values.into_iter().fold((0.0, 0.0), |(sum, count), value| (sum + libm::log(value.max(1e-3)), count + 1.0));
    (count > 0.0).then(|| libm::exp(sum / count))
}
