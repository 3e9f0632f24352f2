//! What the user knows of the places of nodes.

use std::path::Path;

use sextant_kernel::SettingError;
use sextant_mapper::{Area, MapError, PlacePrior};

use crate::diagnostic::Failure;
use crate::robot_log::{self, LocalPlane};
use crate::scenario::NamedMap;

/// The prior of the flags `--area` (four numbers `x0,y0,x1,y1` or a file) and `--near-stops`; `None` if neither is given.
/// `plane` is that of the log, if its places are by latitude and longitude.
///
/// # Errors
/// If the area or the length is invalid, or one of `maps` cannot use a prior.
pub fn place_prior(
    area: Option<&str>,
    near_stops_m: Option<f64>,
    plane: Option<&LocalPlane>,
    maps: &[NamedMap],
) -> Result<Option<PlacePrior>, Failure> {
    if area.is_none() && near_stops_m.is_none() {
        return Ok(None);
    }
    let area = area.map(|text| read(text, plane)).transpose()?;
    let refused = |error: SettingError| {
        Failure::bad_input(format!("--near-stops is {}; allowed: {}", error.found, error.allowed))
    };
    let prior = PlacePrior::new(area, near_stops_m).map_err(refused)?;
    let flag = if prior.area.is_some() { "--area" } else { "--near-stops" };
    let refused = |error: MapError| Failure::bad_input(format!("{flag}: {error}"));
    maps.iter().try_for_each(|map| map.mapper.check_prior(Some(&prior))).map_err(refused)?;
    Ok(Some(prior))
}

/// The area in four numbers or in a file.
fn read(text: &str, plane: Option<&LocalPlane>) -> Result<Area, Failure> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    let allowed = "four numbers x0,y0,x1,y1 in metres, with x0 below x1 and y0 below y1, or a file with the corners";
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) => Area::rectangle([x0, y0], [x1, y1])
            .map_err(|_| Failure::bad_input(format!("--area is `{text}`; allowed: {allowed}"))),
        _ if Path::new(text).exists() => Ok(robot_log::read_area(Path::new(text), plane)?),
        Some(_) => Err(Failure::bad_input(format!("--area is `{text}`; allowed: {allowed}"))),
        None => Err(Failure::bad_input(format!("--area is `{text}`, and there is no such file; allowed: {allowed}"))),
    }
}
