//! The path of the robot from the fixes of a satellite receiver.

use super::clock::Moment;
use super::poses::{TimedPosition, rows};
use super::selection::Value;
use super::topics::{Bag, Topic};
use crate::error::bag_error::BagError;
use crate::place::local_plane::LocalPlane;

/// Where the robot was, in the plane around its first fix.
#[derive(Clone, Debug, Default)]
pub(super) struct Fixes {
    pub(super) positions: Vec<TimedPosition>,
    /// `None` if there are no positions.
    pub(super) plane: Option<LocalPlane>,
    /// Messages without a fix.
    pub(super) missing: u64,
}

/// The positions of the messages of `topic`, in their order. Messages without a fix are skipped; those at 0, 0 only if
/// `skips_no_fix`, because their receiver says that it has one.
///
/// # Errors
/// If a message does not fit its definition or is at a pole or far from the first one, or a file cannot be read.
pub(super) fn read(bag: &Bag, topic: &Topic, skips_no_fix: bool) -> Result<Fixes, BagError> {
    let paths = ["header.stamp", "status.status", "latitude", "longitude", "altitude"].map(str::to_owned);
    let mut fixes = Fixes::default();
    rows(bag, topic, &paths, |log_ns, row| {
        let [
            Value::Instant(stamp_ns),
            Value::Integer(status),
            Value::Real(lat_deg),
            Value::Real(lon_deg),
            Value::Real(alt_m),
        ] = *row
        else {
            return Ok(());
        };
        // A receiver without a fix has a status below 0, and as a rule no numbers.
        let is_zero = lat_deg.abs() <= 0.0 && lon_deg.abs() <= 0.0;
        if status < 0 || !lat_deg.is_finite() || !lon_deg.is_finite() || skips_no_fix && is_zero {
            fixes.missing += 1;
            return Ok(());
        }
        let largest_deg = LocalPlane::LARGEST_LAT_DEG;
        if lat_deg.abs() > largest_deg || lon_deg.abs() > 360.0 {
            return Err(format!(
                "a fix is at latitude {lat_deg} and longitude {lon_deg}; allowed: latitudes from -{largest_deg} to \
                 {largest_deg} and longitudes from -180 to 180"
            ));
        }
        let height_m = if alt_m.is_finite() { alt_m } else { 0.0 };
        let plane = fixes.plane.get_or_insert_with(|| LocalPlane::new(lat_deg, lon_deg, height_m));
        let position = plane.to_local(lat_deg, lon_deg, height_m);
        if libm::hypot(position.x_m, position.y_m) > LocalPlane::RADIUS_M {
            return Err(format!(
                "a fix at latitude {lat_deg} and longitude {lon_deg} is more than {} km from the first one; a receiver \
                 without a fix often writes 0, 0: option `skip_no_fix` leaves such messages out",
                LocalPlane::RADIUS_M / 1000.0
            ));
        }
        let moment = Moment { stamp_ns: Some(stamp_ns), log_ns };
        fixes.positions.push(TimedPosition { moment, position });
        Ok(())
    })?;
    Ok(fixes)
}
