//! What the user knows of the places of nodes.

use std::path::Path;

use sextant_kernel::SettingError;
use sextant_logs::{self as robot_log, LocalPlane};
use sextant_mapper::{Area, MapError, PlacePrior};
use sextant_scenario::MapJob;

use super::error::MapLogError;

/// The prior of an `area` (four numbers `x0,y0,x1,y1` or a file) and of a distance to the stops (m); `None` if neither is
/// given. `plane` is that of the log, if its places are by latitude and longitude.
///
/// # Errors
/// If the area or the length is invalid, or one of `maps` cannot use a prior.
pub fn place_prior(
    area: Option<&str>,
    near_stops_m: Option<f64>,
    plane: Option<&LocalPlane>,
    maps: &[MapJob],
) -> Result<Option<PlacePrior>, MapLogError> {
    if area.is_none() && near_stops_m.is_none() {
        return Ok(None);
    }
    let area = area.map(|text| read_area(text, plane)).transpose()?;
    let refused = |error: SettingError| MapLogError::Prior {
        what: NEAR_STOPS,
        found: error.found().to_owned(),
        allowed: error.allowed().to_owned(),
    };
    let prior = PlacePrior::new(area, near_stops_m).map_err(refused)?;
    let what = if prior.area.is_some() { AREA } else { NEAR_STOPS };
    let refused = |why: MapError| MapLogError::UnusedPrior { what, why };
    maps.iter().try_for_each(|map| map.mapper.check_prior(Some(&prior))).map_err(refused)?;
    Ok(Some(prior))
}

const AREA: &str = "area";
const NEAR_STOPS: &str = "distance to the stops";

/// The area in four numbers `x0,y0,x1,y1` or in a file with the corners of a polygon. `plane` is that of the log, if its places are by
/// latitude and longitude.
///
/// # Errors
/// If the numbers are no area, or the file cannot be read.
pub fn read_area(text: &str, plane: Option<&LocalPlane>) -> Result<Area, MapLogError> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    let refused = |found: String| MapLogError::Prior {
        what: AREA,
        found,
        allowed: "four numbers x0,y0,x1,y1 in metres, with x0 below x1 and y0 below y1, or a file with the corners"
            .to_owned(),
    };
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) => Area::rectangle([x0, y0], [x1, y1]).map_err(|_| refused(format!("`{text}`"))),
        _ if Path::new(text).exists() => Ok(robot_log::read_area(Path::new(text), plane)?),
        Some(_) => Err(refused(format!("`{text}`"))),
        None => Err(refused(format!("`{text}`, and there is no such file"))),
    }
}
