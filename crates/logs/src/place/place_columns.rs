//! Places in CSV files: in metres, or by latitude and longitude.

use sextant_channel::Position;

use super::local_plane::LocalPlane;
use crate::csv::table::{Column, Table, TableRow};
use crate::error::robot_log_error::RobotLogError;

/// The columns of a place that a file may have.
pub(crate) const COLUMNS: [&str; 6] = ["x_m", "y_m", "z_m", "lat", "lon", "alt_m"];

/// How a file gives places.
#[derive(Clone, Copy)]
pub(crate) enum Places {
    /// East, north and up (m).
    Metres { x: Column, y: Column, z: Column },
    /// WGS 84, and the height beside it.
    Geodetic { lat: Column, lon: Column, height: Height },
}

/// How a file with latitude and longitude gives heights.
#[derive(Clone, Copy)]
pub(crate) enum Height {
    /// Above the origin of the plane (m).
    AboveOrigin(Column),
    /// Above the sea or the ellipsoid (m).
    Altitude(Column),
    /// Not at all: all places are at the height of the origin.
    Level,
}

/// Which places a file may give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Frame {
    /// Either: the file decides.
    Any,
    /// In metres, as the log.
    Metres,
    /// By latitude and longitude, as the log.
    Geodetic,
}

impl Frame {
    /// The frame of the other files of a log whose places are in `plane`.
    pub(crate) fn of(plane: Option<&LocalPlane>) -> Self {
        if plane.is_some() { Self::Geodetic } else { Self::Metres }
    }
}

impl Places {
    /// How `table` gives places. Of a file that gives both, those in metres count, or those of the log's frame; then
    /// `notes` says so.
    pub(crate) fn of(table: &Table<'_>, frame: Frame, notes: &mut Vec<String>) -> Result<Self, RobotLogError> {
        let [x, y, z, lat, lon, alt] = COLUMNS.map(|name| table.column(name));
        let (metres, geodetic) = ([x, y], [lat, lon]);
        let has = |columns: [Column; 2]| columns.into_iter().all(Column::exists);
        let has_some = |columns: [Column; 2]| columns.into_iter().any(Column::exists);
        let takes_metres = match frame {
            Frame::Any => has_some(metres) || !has_some(geodetic),
            Frame::Metres => true,
            Frame::Geodetic => false,
        };
        let (wanted, other) = if takes_metres { (metres, geodetic) } else { (geodetic, metres) };
        if !has(wanted) {
            let missing = wanted.into_iter().find(|column| !column.exists()).map_or("", |column| column.name);
            let which = match frame {
                Frame::Any => "places need the columns x_m,y_m[,z_m] or lat,lon[,alt_m]",
                Frame::Metres => "the places of the log are in metres, so these need the columns x_m,y_m[,z_m] too",
                Frame::Geodetic => {
                    "the places of the log are by latitude and longitude, so these need the columns lat,lon[,alt_m] too"
                }
            };
            let hint = table.hint(missing);
            return Err(table.wrong_header(format!("column `{missing}` is missing; {which}{hint}")));
        }
        let mut unused: Vec<&str> =
            other.into_iter().filter(|column| column.exists()).map(|column| column.name).collect();
        let height = match (z.exists(), alt.exists()) {
            (true, _) => Height::AboveOrigin(z),
            (false, true) => Height::Altitude(alt),
            (false, false) => Height::Level,
        };
        if alt.exists() && (takes_metres || z.exists()) {
            unused.push(alt.name);
        }
        if !unused.is_empty() {
            let unused: Vec<String> = unused.into_iter().map(|name| format!("`{name}`")).collect();
            notes.push(table.ignored_beside(
                &unused.join(", "),
                "the places",
                if takes_metres { "x_m, y_m" } else { "lat, lon" },
            ));
        }
        Ok(if takes_metres { Self::Metres { x, y, z } } else { Self::Geodetic { lat, lon, height } })
    }

    /// Whether the file has heights.
    pub(crate) fn has_heights(self) -> bool {
        match self {
            Self::Metres { z, .. } => z.exists(),
            Self::Geodetic { height, .. } => !matches!(height, Height::Level),
        }
    }

    /// Whether the receiver had no fix in a row: both coordinates are empty or NaN or, by latitude and longitude, 0.
    pub(crate) fn is_without_fix(self, row: &TableRow<'_>) -> bool {
        match self {
            Self::Metres { x, y, .. } => row.is_blank(x) && row.is_blank(y),
            Self::Geodetic { lat, lon, .. } => {
                row.is_blank(lat) && row.is_blank(lon) || row.is_zero(lat) && row.is_zero(lon)
            }
        }
    }

    /// The place in a row. The first place by latitude and longitude becomes the origin of `plane`.
    pub(crate) fn read(self, row: &TableRow<'_>, plane: &mut Option<LocalPlane>) -> Result<Position, RobotLogError> {
        match self {
            Self::Metres { x, y, z } => {
                let z_m = if z.exists() { metres(row, z)? } else { 0.0 };
                Ok(Position::new(metres(row, x)?, metres(row, y)?, z_m))
            }
            Self::Geodetic { lat, lon, height } => geodetic(row, lat, lon, height, plane),
        }
    }
}

/// A coordinate.
fn metres(row: &TableRow<'_>, column: Column) -> Result<f64, RobotLogError> {
    let value_m = row.finite(column)?.filter(|value_m| value_m.abs() <= Position::FARTHEST_M);
    value_m.ok_or_else(|| row.wrong(column, "a number of metres from -1e9 to 1e9"))
}

fn geodetic(
    row: &TableRow<'_>,
    lat: Column,
    lon: Column,
    height: Height,
    plane: &mut Option<LocalPlane>,
) -> Result<Position, RobotLogError> {
    const NEAR_POLE: &str = "degrees north from -89.9 to 89.9, because at a pole east and north have no meaning";
    let lat_deg = row.finite(lat)?.filter(|lat_deg| lat_deg.abs() <= LocalPlane::LARGEST_LAT_DEG);
    let lat_deg = lat_deg.ok_or_else(|| row.wrong(lat, NEAR_POLE))?;
    let lon_deg = row.finite(lon)?.filter(|lon_deg| lon_deg.abs() <= 180.0);
    let lon_deg = lon_deg.ok_or_else(|| row.wrong(lon, "degrees east from -180 to 180"))?;
    let origin_m = plane.as_ref().map(|plane| plane.origin().height_m);
    let height_m = match height {
        Height::AboveOrigin(z) => origin_m.unwrap_or(0.0) + metres(row, z)?,
        Height::Altitude(alt) => metres(row, alt)?,
        Height::Level => origin_m.unwrap_or(0.0),
    };
    let level_m = if matches!(height, Height::AboveOrigin(_)) { 0.0 } else { height_m };
    let plane = plane.get_or_insert_with(|| LocalPlane::new(lat_deg, lon_deg, level_m));
    if plane.distance_m(lat_deg, lon_deg, height_m) > LocalPlane::RADIUS_M {
        let origin = plane.origin();
        let swapped = lon_deg.abs() <= LocalPlane::LARGEST_LAT_DEG
            && plane.distance_m(lon_deg, lat_deg, height_m) <= LocalPlane::RADIUS_M;
        let hint = if swapped {
            "with `lat` and `lon` swapped it is that near, so one of the files has them swapped"
        } else {
            "a receiver without a fix often writes 0, 0: option `skip_no_fix` leaves such rows out"
        };
        let allowed =
            format!("a place at most 100 km from the first one at {}, {}; {hint}", origin.lat_deg, origin.lon_deg);
        return Err(row.wrong(lat, allowed));
    }
    Ok(plane.to_local(lat_deg, lon_deg, height_m))
}
